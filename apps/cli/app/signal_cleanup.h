// What a signal that ends the program leaves behind: nothing that is half written.
#pragma once

namespace scumble {

// From now on the signals of a user, a terminal, a batch system or a closed pipe remove the temporary files of outputs
// first, and then end the program as they would have. A signal that is ignored, as under nohup, stays ignored. A file
// that would grow past a limit (ulimit -f) is an error of writing, as on a full disk, instead of the program's end. To
// be called once, early.
void CleanUpOnSignals();

}  // namespace scumble
