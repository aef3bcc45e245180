#include "apps/cli/app/fatal_error.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>

#include "apps/cli/app/command.h"
#include "core/io/pending_temporaries.h"

namespace scumble {
namespace {

// oneTBB has no error code for a refused thread, only a text.
bool IsForWantOfThreads(const std::exception& error) {
  const auto* const known = dynamic_cast<const std::system_error*>(&error);
  if (known) return known->code() == std::errc::resource_unavailable_try_again;
  return std::strstr(error.what(), "pthread_create") != nullptr;
}

}  // namespace

void ReportAndEnd() {
  const int code = ReportException(std::current_exception());
  RemovePendingTemporaries();
  ::_exit(code);  // other threads still run: nothing that they use may be destroyed
}

int ReportException(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
    // This happens if a thread could not be started while others of the same library ran.
    std::fputs(
        "scumble: error: a library gave up, as they do where memory or threads run out; allow more of both, or take "
        "fewer threads, as --threads 1\n",
        stderr);
  } catch (const std::bad_alloc&) {
    std::fputs("scumble: error: out of memory; ask for a smaller picture, or allow more memory\n", stderr);
  } catch (const std::exception& error) {
    if (IsForWantOfThreads(error)) {
      std::fprintf(stderr,
                   "scumble: error: the system starts no more threads (%s); take fewer, as --threads 1, or allow more "
                   "memory or processes\n",
                   std::strerror(EAGAIN));
    } else {
      std::fprintf(stderr, "scumble: internal error: %s; please report it with the command that led here\n",
                   error.what());
    }
  } catch (...) {
    std::fputs("scumble: internal error: of an unknown kind; please report it with the command that led here\n",
               stderr);
  }
  return static_cast<int>(ExitCode::kInternal);
}

void ReportUncaughtExceptions() { std::set_terminate(ReportAndEnd); }

}  // namespace scumble
