// Opens the studio's page in the user's browser.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "pipeline/run_context.h"

namespace scumble {

// A browser on its way to an address with a token. All users of the machine see the arguments of programs: the browser
// is started on a file that only this user can read, and the file sends it on.
class OpenedBrowser {
 public:
  // Starts the first program of the list $BROWSER, or xdg-open, which are looked for in PATH; both as the context's
  // environment has them. It gets no terminal and goes on without this program. The file lies in the context's
  // temporary folder. Where there is no display, no such program, or no room for the file, a note says so, and the
  // result is null.
  static std::unique_ptr<OpenedBrowser> Start(const std::string& address, const RunContext& context);

  // Removes the file, which is otherwise removed 60 s after the start.
  ~OpenedBrowser();
  OpenedBrowser(const OpenedBrowser&) = delete;
  OpenedBrowser& operator=(const OpenedBrowser&) = delete;

  // The browser has found the page: removes the file. From any thread.
  void PageWasFetched();

  const std::filesystem::path& file() const { return file_; }

 private:
  OpenedBrowser(std::filesystem::path file, pid_t program);
  void AwaitEnd();

  std::filesystem::path file_;
  pid_t program_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_done_ = false;
  std::thread waiting_;
};

}  // namespace scumble
