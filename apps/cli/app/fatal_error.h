// What the program says where it has to end, and how it ends then: by a sentence and an exit code, not by a signal.
#pragma once

#include <exception>

namespace scumble {

// Says on stderr what was thrown and how to mend it; returns the exit code. Takes no memory, as there may be none.
int ReportException(std::exception_ptr thrown);

// From now on what is thrown where nothing can catch it, as on a library's own thread, ends the program with that
// sentence and code instead of a core dump, and removes the temporary files of outputs. To be called once, early.
void ReportUncaughtExceptions();

}  // namespace scumble
