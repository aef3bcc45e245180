// Cleans up when a signal ends the program: no unfinished file is left.
#pragma once

namespace scumble {

// From now on the signals of a user, a terminal, a batch system or a closed pipe remove the temporary files of outputs
// first, and then end the program by their default action. An ignored signal, as under nohup, stays ignored. A file
// beyond a size limit (ulimit -f) becomes a write error, as on a full disk, instead of the program's end. Call it once,
// early.
void CleanUpOnSignals();

// From now on the signals of a user who wants the program to end (SIGINT, SIGTERM, SIGHUP) only set what
// StopIsRequested says, so that it ends by itself. A second one acts as CleanUpOnSignals has it. An ignored signal
// stays ignored.
void StopOnSignals();
bool StopIsRequested();

}  // namespace scumble
