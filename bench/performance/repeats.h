// Timing by repeats that take turns: A, B, A, B, …, so that whatever else the machine does slows all of them alike.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace scumble::bench {

// Median, quartiles and extremes of some values.
struct Spread {
  double median = 0.0;
  double low = 0.0;   // lower quartile
  double high = 0.0;  // upper quartile
  double least = 0.0;
  int count = 0;
};
Spread SpreadOf(std::vector<double> values);  // all 0 without values

// Milliseconds of one run.
struct RunTime {
  double wall_ms = 0.0;
  double thread_ms = 0.0;   // processor time of the calling thread
  double process_ms = 0.0;  // and of all threads
};

// Which of a run's times is meant: work on one thread is judged by its own processor time, which a busy machine
// stretches least; work on several by the clock on the wall.
enum class Clock { kThread, kWall };

// One contestant's times by round: each is the median of the runs that it had in that round.
class Times {
 public:
  void Add(const RunTime& time) { rounds_.push_back(time); }
  int rounds() const { return static_cast<int>(rounds_.size()); }
  double Of(int round, Clock clock) const {
    const RunTime& time = rounds_[std::size_t(round)];
    return clock == Clock::kThread ? time.thread_ms : time.wall_ms;
  }
  Spread Milliseconds(Clock clock) const;
  // How much longer the clock on the wall took than the thread: 1 on a quiet machine. Median.
  double Waiting() const;

 private:
  std::vector<RunTime> rounds_;
};

// How often a is of b, round by round, times `factor`: the spread of quotients within one round.
Spread Ratio(const Times& a, const Times& b, Clock clock, double factor = 1.0);

struct RepeatOptions {
  double seconds = 6.0;  // about how long all rounds together may take
  int least_rounds = 5;
  int most_rounds = 15;
  double turn_seconds = 0.1;  // within a round a quick contestant runs again until so much time is over, …
  int most_runs = 7;          // … but not more often than this
};

// Each contestant runs once unmeasured, then the rounds. Times by contestant.
std::vector<Times> TakeTurns(std::span<const std::function<void()>> contestants, const RepeatOptions& options);

}  // namespace scumble::bench
