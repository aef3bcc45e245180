#include "pipeline/stage_clock.h"

#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <sstream>

namespace scumble {
namespace {

double Now(clockid_t clock) {
  timespec time{};
  if (::clock_gettime(clock, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

#ifdef __linux__
double Wall() { return Now(CLOCK_BOOTTIME); }

// When the process began, on the clock of Wall (proc(5): field 22 of stat, in ticks since the machine was booted; the
// second field, a name in brackets, may hold anything).
std::optional<double> ProcessStart() {
  std::ifstream file("/proc/self/stat");
  std::string text;
  if (!std::getline(file, text)) return std::nullopt;
  const std::size_t bracket = text.rfind(')');
  if (bracket == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(bracket + 1));
  std::string field;
  for (int number = 3; number <= 22; ++number) {
    if (!(fields >> field)) return std::nullopt;
  }
  const long per_second = ::sysconf(_SC_CLK_TCK);
  if (per_second <= 0) return std::nullopt;
  return std::stod(field) * 1e3 / static_cast<double>(per_second);
}
#else
double Wall() { return Now(CLOCK_MONOTONIC); }
std::optional<double> ProcessStart() { return std::nullopt; }
#endif

}  // namespace

StageClock::StageClock() : last_wall_ms_(Wall()), last_cpu_ms_(Now(CLOCK_PROCESS_CPUTIME_ID)) {
  // A tick is coarse: what the processor has worked already on this one thread is the least that it can be.
  begun_wall_ms_ = std::min(ProcessStart().value_or(last_wall_ms_), last_wall_ms_ - last_cpu_ms_);
  stages_.push_back({"start", last_wall_ms_ - begun_wall_ms_, last_cpu_ms_});
}

Stage& StageClock::At(const std::string& name) {
  const auto found =
      std::find_if(stages_.begin(), stages_.end(), [&](const Stage& stage) { return stage.name == name; });
  return found != stages_.end() ? *found : stages_.emplace_back(Stage{name, 0.0, std::nullopt});
}

void StageClock::End(const std::string& name, const std::vector<std::pair<std::string, double>>& inside) {
  const double wall = Wall(), cpu = Now(CLOCK_PROCESS_CPUTIME_ID);
  double rest = wall - last_wall_ms_;
  for (const auto& [stage, ms] : inside) {
    At(stage).wall_ms += ms;
    rest -= ms;
  }
  Stage& stage = At(name);
  stage.wall_ms += std::max(0.0, rest);
  stage.cpu_ms = stage.cpu_ms.value_or(0.0) + cpu - last_cpu_ms_;
  last_wall_ms_ = wall, last_cpu_ms_ = cpu;
}

void StageClock::Add(const std::string& name, double wall_ms) { At(name).wall_ms += wall_ms; }

std::vector<Stage> StageClock::Stages() const {
  std::vector<Stage> stages = stages_;
  stages.push_back({"total", Wall() - begun_wall_ms_, Now(CLOCK_PROCESS_CPUTIME_ID)});
  return stages;
}

}  // namespace scumble
