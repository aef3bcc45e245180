#include "apps/cli/app/signal_cleanup.h"

#include <atomic>
#include <csignal>

#include "core/io/pending_temporaries.h"

namespace scumble {
namespace {

std::atomic<bool> stop_is_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void CleanUpAndEnd(int signal) {
  RemovePendingTemporaries();
  std::signal(signal, SIG_DFL);
  ::raise(signal);  // is delivered when this returns
}

void RequestStop(int signal) {
  if (stop_is_requested.exchange(true)) CleanUpAndEnd(signal);
}

void Handle(int signal, void (*handler)(int)) {
  struct sigaction before = {}, ours = {};
  if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler != SIG_DFL) return;
  ours.sa_handler = handler;
  ours.sa_flags = SA_RESTART;
  ::sigaction(signal, &ours, nullptr);
}

}  // namespace

void CleanUpOnSignals() {
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGTERM, SIGXCPU}) Handle(signal, CleanUpAndEnd);
  // A handler is not inherited by programs that this one starts, while an ignored signal is.
  Handle(SIGXFSZ, [](int) {});
}

void StopOnSignals() {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    struct sigaction action = {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = RequestStop;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
}

bool StopIsRequested() { return stop_is_requested; }

}  // namespace scumble
