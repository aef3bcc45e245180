// What the program runs on.
#pragma once

#include <string>

namespace scumble {

// The processor's name, as the system has it, and how many threads are used: "AMD EPYC, 2 threads". 0 threads: all.
std::string MachineName(int threads);

}  // namespace scumble
