// The message and the exit code of a program that must end early, instead of a signal.
#pragma once

#include <exception>

namespace scumble {

// Prints the exception and the remedy on stderr; returns the exit code. Allocates no memory, as there may be none.
int ReportException(std::exception_ptr thrown);

// For the exception that is being handled: does this, removes the temporary files of outputs, and ends the program at
// once. No destructors of libraries run: oneTBB's fail in their turn where it could not start a thread.
[[noreturn]] void ReportAndEnd();

// From now on an exception that no code can catch, as on a library's own thread, ends the program with that message and
// code instead of a core dump, and removes the temporary files of outputs. Call it once, early.
void ReportUncaughtExceptions();

}  // namespace scumble
