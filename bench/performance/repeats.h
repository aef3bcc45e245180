// Timing by alternating repeats: A, B, A, B, …, so that other load of the machine slows all of them alike.
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

// The time of a run that counts. Work on one thread is compared by its own processor time, which other load changes
// least; work on several by wall-clock time.
enum class Clock { kThread, kWall };

// One contender's times by round: each is the median of its runs in that round.
class Times {
 public:
  void Add(const RunTime& time) { rounds_.push_back(time); }
  int rounds() const { return static_cast<int>(rounds_.size()); }
  double Of(int round, Clock clock) const {
    const RunTime& time = rounds_[std::size_t(round)];
    return clock == Clock::kThread ? time.thread_ms : time.wall_ms;
  }
  Spread Milliseconds(Clock clock) const;
  // The ratio of wall-clock time to the thread's time: 1 on an idle machine. Median.
  double Waiting() const;

 private:
  std::vector<RunTime> rounds_;
};

// The ratio of a to b, round by round, times `factor`: the spread of quotients within one round.
Spread Ratio(const Times& a, const Times& b, Clock clock, double factor = 1.0);

struct RepeatOptions {
  double seconds = 6.0;  // about the time of all rounds together
  int least_rounds = 5;
  int most_rounds = 15;
  double turn_seconds = 0.1;          // within a round a fast contender runs again until this much time is over, …
  int most_runs = 7;                  // … but not more often than this
  std::function<void()> before = {};  // each run; its time is not counted
};

// Each contender runs once unmeasured, then the rounds. Times by contender.
std::vector<Times> TakeTurns(std::span<const std::function<void()>> contestants, const RepeatOptions& options);

}  // namespace scumble::bench
