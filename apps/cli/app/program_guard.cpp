#include "apps/cli/app/program_guard.h"

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <memory>
#include <mutex>
#include <string>

#include "pipeline/process_guard.h"

namespace scumble {
namespace {

// What a signal handler may touch.
constexpr int kEndingSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU};
std::atomic<pid_t> running_group = 0;
std::atomic<int> caught_signal = 0;
std::atomic<bool> ends_at_once = false;
std::atomic<bool> has_scratch_folder = false;
char scratch_folder[4096];  // never freed: a handler on another thread may still read it
static_assert(std::atomic<pid_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free);

struct sigaction actions_before[std::size(kEndingSignals)];

// A program that was killed, or works on a disk, may hang in that disk: not for long.
void AwaitEnd(pid_t program, int most_milliseconds) {
  const timespec millisecond{0, 1000000};
  for (int wait = 0; wait < most_milliseconds && ::waitpid(program, nullptr, WNOHANG) == 0; ++wait)
    ::nanosleep(&millisecond, nullptr);
}

// By another program, as nothing in this one may be called that allocates: fork() would lock the heap, _Fork() does
// not.
void RemoveWithoutHeap(const char* folder) {
  const pid_t child = ::_Fork();
  if (child == 0) {
    const char* const remove[] = {"rm", "-rf", "--", folder, nullptr};
    ::execv("/bin/rm", const_cast<char* const*>(remove));
    ::_exit(127);
  }
  if (child > 0) AwaitEnd(child, 5000);
}

void EndRunningGroup(int signal) {
  caught_signal = signal;
  const pid_t group = running_group;
  if (group) ::kill(-group, SIGKILL);
  if (!ends_at_once) return;
  if (group) AwaitEnd(group, 300);  // so that it writes nothing more
  if (has_scratch_folder) RemoveWithoutHeap(scratch_folder);
  for (std::size_t i = 0; i < std::size(kEndingSignals); ++i) {
    if (kEndingSignals[i] == signal) ::sigaction(signal, &actions_before[i], nullptr);
  }
  caught_signal = 0;  // whoever had it before has it now
  ::raise(signal);    // is delivered when this returns
}

// A signal that is ignored, as under nohup, stays ignored.
void CatchSignals() {
  for (std::size_t i = 0; i < std::size(kEndingSignals); ++i) {
    struct sigaction ours = {};
    ours.sa_handler = EndRunningGroup;
    ours.sa_flags = SA_RESTART;
    ::sigfillset(&ours.sa_mask);  // for what removes the folder, too: a second Ctrl-C does not stop it
    ::sigaction(kEndingSignals[i], nullptr, &actions_before[i]);
    if (actions_before[i].sa_handler != SIG_IGN) ::sigaction(kEndingSignals[i], &ours, nullptr);
  }
}

void ReleaseSignals() {
  for (std::size_t i = 0; i < std::size(kEndingSignals); ++i) {
    ::sigaction(kEndingSignals[i], &actions_before[i], nullptr);
  }
  if (const int signal = caught_signal.exchange(0)) ::raise(signal);
}

class SignalGuard : public ProcessGuard {
 public:
  void Begin() override {
    const std::lock_guard lock(mutex_);
    if (users_++ == 0) CatchSignals();
  }
  void FolderMade(const std::filesystem::path& folder) override {
    const std::string name = folder.string();
    if (name.size() >= sizeof(scratch_folder)) return;
    std::memcpy(scratch_folder, name.c_str(), name.size() + 1);
    has_scratch_folder = true;
  }
  void End() override {
    const std::lock_guard lock(mutex_);
    if (--users_ > 0) return;
    has_scratch_folder = false;
    ReleaseSignals();
  }
  void ProgramStarted(int group) override {
    running_group = group;
    if (caught_signal) ::kill(-group, SIGKILL);  // it came before the handler knew whom to end
  }
  void ProgramEnded() override { running_group = 0; }
  void Waits(bool waits) override { ends_at_once = !waits; }

 private:
  std::mutex mutex_;
  int users_ = 0;  // folders in use: the first catches the signals, the last releases them
};

}  // namespace

void GuardPrograms(Globals& globals) {
  globals.process_guard = std::make_shared<SignalGuard>();
  globals.is_cancelled = [] { return caught_signal != 0; };
}

}  // namespace scumble
