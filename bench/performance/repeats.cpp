#include "bench/performance/repeats.h"

#include <time.h>

#include <algorithm>
#include <cmath>

namespace scumble::bench {
namespace {

double ClockMs(clockid_t clock) {
  timespec now;
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

RunTime Now() {
  return {ClockMs(CLOCK_MONOTONIC), ClockMs(CLOCK_THREAD_CPUTIME_ID), ClockMs(CLOCK_PROCESS_CPUTIME_ID)};
}

RunTime Measure(const std::function<void()>& before, const std::function<void()>& run) {
  if (before) before();
  const RunTime start = Now();
  run();
  const RunTime end = Now();
  return {end.wall_ms - start.wall_ms, end.thread_ms - start.thread_ms, end.process_ms - start.process_ms};
}

// Linear between the two values around it, like Python's statistics.quantiles with method="inclusive".
double Quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const std::size_t below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

// The run that took the middle time.
RunTime MedianRun(std::vector<RunTime> runs) {
  std::sort(runs.begin(), runs.end(), [](const RunTime& a, const RunTime& b) { return a.wall_ms < b.wall_ms; });
  return runs[(runs.size() - 1) / 2];
}

}  // namespace

Spread SpreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {Quantile(values, 0.5), Quantile(values, 0.25), Quantile(values, 0.75), values.front(),
          static_cast<int>(values.size())};
}

Spread Times::Milliseconds(Clock clock) const {
  std::vector<double> values;
  for (int round = 0; round < rounds(); ++round) values.push_back(Of(round, clock));
  return SpreadOf(std::move(values));
}

double Times::Waiting() const {
  std::vector<double> values;
  for (const RunTime& time : rounds_) values.push_back(time.thread_ms > 0.0 ? time.wall_ms / time.thread_ms : 1.0);
  return SpreadOf(std::move(values)).median;
}

Spread Ratio(const Times& a, const Times& b, Clock clock, double factor) {
  std::vector<double> values;
  const int rounds = std::min(a.rounds(), b.rounds());
  for (int round = 0; round < rounds; ++round) values.push_back(factor * a.Of(round, clock) / b.Of(round, clock));
  return SpreadOf(std::move(values));
}

std::vector<Times> TakeTurns(std::span<const std::function<void()>> contestants, const RepeatOptions& options) {
  std::vector<Times> times(contestants.size());
  std::vector<int> runs;
  double round_seconds = 0.0;
  for (const auto& contestant : contestants) {
    const double start = Now().wall_ms, seconds = 1e-3 * Measure(options.before, contestant).wall_ms;
    runs.push_back(static_cast<int>(
        std::clamp(options.turn_seconds / std::max(seconds, 1e-6), 1.0, static_cast<double>(options.most_runs))));
    round_seconds += 1e-3 * (Now().wall_ms - start) * runs.back();  // with what goes before each run
  }
  const double wanted = std::min(options.seconds / std::max(round_seconds, 1e-6), 1e6);
  const int rounds = std::clamp(static_cast<int>(wanted), options.least_rounds, options.most_rounds);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t c = 0; c < contestants.size(); ++c) {
      std::vector<RunTime> taken;
      for (int run = 0; run < runs[c]; ++run) taken.push_back(Measure(options.before, contestants[c]));
      times[c].Add(MedianRun(std::move(taken)));
    }
  }
  return times;
}

}  // namespace scumble::bench
