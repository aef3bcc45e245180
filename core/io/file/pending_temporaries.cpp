#include "core/io/pending_temporaries.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <utility>

#include "core/io/stale_temporaries.h"

namespace scumble {
namespace {

// State that a signal handler may touch. Each slot holds the name of a file, or null. The handler takes names out and
// removes their files; a writer takes its own out after its file was removed or renamed.
constexpr std::size_t kMostFiles = 64;  // written at once; any beyond are not registered here
std::array<std::atomic<const char*>, kMostFiles> pending_names{};
std::atomic<int> being_made{0};
std::atomic<bool> is_ending{false};
static_assert(std::atomic<const char*>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free);

[[noreturn]] void WaitForTheEnd() {
  for (;;) ::pause();
}

std::atomic<const char*>* TakePlace(const char* name) {
  for (auto& place : pending_names) {
    const char* nothing = nullptr;
    if (place.compare_exchange_strong(nothing, name)) return &place;
  }
  return nullptr;
}

// While it lives, no handler runs on this thread: the handler would wait for this very thread.
class NoSignals {
 public:
  NoSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~NoSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  NoSignals(const NoSignals&) = delete;
  NoSignals& operator=(const NoSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

void RemovePendingTemporaries() {
  is_ending = true;
  constexpr int kMostWaits = 1000;
  const timespec millisecond{0, 1000000};
  for (int wait = 0; wait < kMostWaits && being_made > 0; ++wait) ::nanosleep(&millisecond, nullptr);
  for (auto& place : pending_names) {
    if (const char* const name = place.exchange(nullptr)) ::unlink(name);
  }
}

namespace internal {

PendingTemporary::PendingTemporary(const std::filesystem::path& target) {
  RemoveStaleTemporariesOnce(target.parent_path());
  constexpr std::size_t kMaxStem = 200;
  const std::string stem = target.filename().string().substr(0, kMaxStem);
  const std::string wanted =
      (target.parent_path() / ("." + stem + "." + KernelMark() + "-XXXXXX" + std::string(kTemporarySuffix))).string();
  // If another run took the file for stale before it was locked, that run removes it, and a new one is made.
  constexpr int kMostTries = 100;
  for (int i = 0; i < kMostTries && !Make(wanted); ++i) {
  }
}

bool PendingTemporary::Make(const std::string& wanted) {
  name_ = wanted;
  int failure = 0;
  bool must_wait = false;
  {
    const NoSignals masked;
    ++being_made;  // incremented before the flag is read, as the handler sets the flag before it reads the count
    must_wait = is_ending;
    if (!must_wait) {
      descriptor_ = ::mkostemps(name_.data(), static_cast<int>(kTemporarySuffix.size()), O_CLOEXEC);
      failure = errno;
      is_there_ = descriptor_ >= 0;
      if (is_there_) place_ = TakePlace(name_.c_str());
    }
    --being_made;
  }
  if (must_wait) WaitForTheEnd();
  bool is_taken = false;
  if (descriptor_ >= 0) {
    lock_ = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
    failure = errno;
    is_taken = lock_ >= 0 && !Hold();
    if (lock_ < 0 || is_taken) {  // without a lock another run would remove it while it is written
      Forget();
      ::close(std::exchange(descriptor_, -1));
    }
  }
  errno = failure;
  return !is_taken;
}

bool PendingTemporary::Hold() {
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;  // others: no locks on that file system
  struct stat file;
  return ::fstat(lock_, &file) != 0 || file.st_nlink > 0;
}

void PendingTemporary::Forget() {
  // While the name has its slot: a signal after the name is taken out would leave the file behind.
  if (is_there_) ::unlink(name_.c_str());
  is_there_ = false;
  const char* name = name_.c_str();
  if (place_ && !place_->compare_exchange_strong(name, nullptr)) WaitForTheEnd();  // the handler is reading the name
  place_ = nullptr;
  if (lock_ >= 0) ::close(std::exchange(lock_, -1));
}

PendingTemporary::~PendingTemporary() { Forget(); }

int PendingTemporary::Finish(const std::filesystem::path& target) {
  if (::rename(name_.c_str(), target.c_str()) == 0) {
    is_there_ = false;
    return 0;
  }
  const int failure = errno;
  if (is_ending) WaitForTheEnd();  // the handler removed the file, which is no failure of the disk
  return failure;
}

}  // namespace internal
}  // namespace scumble
