// What a signal does while Blender works for this program: nothing of it stays behind.
#pragma once

#include "apps/cli/app/command.h"

namespace scumble {

// Sets the context's process guard and is_cancelled. From then on, while a temporary folder is in use, the signals that
// end this program end Blender first. The folder is then removed, and the signal acts as it would have otherwise. That
// waits for the run to notice; where nobody waits for Blender, the handler does it all at once. A signal that is
// ignored, as under nohup, stays ignored. Several threads may use folders at once: the handler itself then removes the
// latest one and ends the latest program, and the others are left to the runs, which see that they are cancelled. One
// context a process; on the main thread.
void GuardPrograms(Globals& globals);

}  // namespace scumble
