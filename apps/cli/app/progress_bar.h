// A progress bar with the remaining time, on terminals, for work of more than two seconds.
#pragma once

#include <string>

#include "core/image/progress.h"

namespace scumble {

// "  1:05 left"; empty in the first second and before 2%, when it would be a guess. `share` in [0, 1].
std::string TimeLeft(double elapsed_seconds, double share);

// Shows a bar of this label until the returned callback and its copies are gone. An empty callback, which costs
// nothing, when stderr is no terminal or `quiet`.
Progress ShowProgress(const std::string& label, bool quiet);

// Takes the bar off the terminal, so that a line can be printed; it comes back with the next report.
void ClearProgress();

}  // namespace scumble
