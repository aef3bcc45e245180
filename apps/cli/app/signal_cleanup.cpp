#include "apps/cli/app/signal_cleanup.h"

#include <csignal>

#include "core/io/file/pending_temporaries.h"

namespace scumble {
namespace {

void CleanUpAndEnd(int signal) {
  RemovePendingTemporaries();
  std::signal(signal, SIG_DFL);
  ::raise(signal);  // is delivered when this returns
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

}  // namespace scumble
