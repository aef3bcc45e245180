// The number of threads that oneTBB may have.
#pragma once

namespace scumble {

// While it lives, oneTBB gives arenas up to so many threads, also beyond the machine's cores; without it, it refuses
// and prints a warning. 0 asks for none. Of several at once, in any threads, the largest number holds, where several
// tbb::global_control of our own would make it the smallest.
class MoreWorkers {
 public:
  explicit MoreWorkers(int threads);
  ~MoreWorkers();
  MoreWorkers(const MoreWorkers&) = delete;
  MoreWorkers& operator=(const MoreWorkers&) = delete;

 private:
  int threads_;
};

}  // namespace scumble
