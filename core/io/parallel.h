// Independent pieces of work on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace scumble::internal {

// Calls work(i) once for each i in [0, count), on `threads` threads at most, this one among them; 0 stands for all that
// the machine has. Returns when all are done. The first exception is thrown on, and ends what has not begun.
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
      // No more threads are to be had: those that there are do it all.
    }
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace scumble::internal
