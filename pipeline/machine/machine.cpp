#include "pipeline/machine/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <thread>

namespace scumble {

std::string MachineName(int threads) {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "a processor without a name";
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  const unsigned count = threads > 0 ? unsigned(threads) : std::max(1u, std::thread::hardware_concurrency());
  return fmt::format("{}, {} {}", name, count, count == 1 ? "thread" : "threads");
}

}  // namespace scumble
