// Independent tasks on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace scumble::internal {

// Calls work(i) once for each i in [0, count), on at most `threads` threads, including this one; 0 stands for all of
// the machine. Returns when all are done. The first exception is rethrown, and no further task starts.
template <class Work>
void ForEachIndex(int count, int threads, const Work& work) {
  if (threads <= 0) threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto run = [&] {
    try {
      for (int i = next++; i < count; i = next++) work(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    try {
      for (int i = 1; i < std::min(threads, count); ++i) helpers.emplace_back(run);
    } catch (const std::system_error&) {
      // The system refused a further thread: those that run do all the work.
    }
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace scumble::internal
