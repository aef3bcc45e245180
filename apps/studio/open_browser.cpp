#include "apps/studio/open_browser.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kFileLives(60);

std::string ValueOf(const std::string& name, const RunContext& context) {
  for (const std::string& variable : context.environment) {
    if (variable.starts_with(name + "=")) return variable.substr(name.size() + 1);
  }
  return "";
}

// Empty: it is not there.
fs::path FindInPath(const std::string& program, const RunContext& context) {
  if (program.find('/') != program.npos) return ::access(program.c_str(), X_OK) == 0 ? fs::path(program) : fs::path();
  std::istringstream folders(ValueOf("PATH", context));
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / program;
    std::error_code failed;
    if (fs::is_regular_file(candidate, failed) && ::access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return {};
}

// $BROWSER is a list with ":" between, of programs that may have arguments behind a space.
fs::path FindBrowser(const RunContext& context) {
  std::istringstream browsers(ValueOf("BROWSER", context));
  for (std::string browser; std::getline(browsers, browser, ':');) {
    browser.resize(std::min(browser.size(), browser.find(' ')));
    if (const fs::path found = browser.empty() ? fs::path() : FindInPath(browser, context); !found.empty())
      return found;
  }
  const bool has_display = !ValueOf("DISPLAY", context).empty() || !ValueOf("WAYLAND_DISPLAY", context).empty();
  return has_display ? FindInPath("xdg-open", context) : fs::path();
}

// A file that only this user can read and that sends a browser on to the address; empty: it could not be written.
fs::path WriteRedirection(const std::string& address, const fs::path& folder) {
  constexpr std::string_view kEnding = ".html";
  std::string name = (folder / "scumble-XXXXXX").string() + std::string(kEnding);
  const int file = ::mkostemps(name.data(), static_cast<int>(kEnding.size()), O_CLOEXEC);  // for this user alone
  if (file < 0) return {};
  const std::string page =
      "<!doctype html><meta charset=\"utf-8\"><title>Scumble</title>\n"
      "<meta http-equiv=\"refresh\" content=\"0;url=" +
      address +
      "\">\n"
      "<a href=\"" +
      address + "\">Scumble's studio</a>\n";
  const bool written = ::write(file, page.data(), page.size()) == static_cast<ssize_t>(page.size());
  if (::close(file) == 0 && written) return name;
  ::unlink(name.c_str());
  return {};
}

std::vector<char*> PointersTo(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

// In a session of its own, so that Ctrl-C does not end it; 0 where it cannot be started.
pid_t StartDetached(const std::vector<std::string>& arguments, const RunContext& context) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDWR, 0);
  for (const int output : {1, 2}) ::posix_spawn_file_actions_adddup2(&actions, 0, output);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = 0;
  const int failure = ::posix_spawn(&child, arguments.front().c_str(), &actions, &attributes,
                                    PointersTo(arguments).data(), PointersTo(context.environment).data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  return failure == 0 ? child : 0;
}

}  // namespace

std::unique_ptr<OpenedBrowser> OpenedBrowser::Start(const std::string& address, const RunContext& context) {
  const fs::path program = FindBrowser(context);
  if (program.empty()) {
    context.Note("No browser was found to open: open the address above in one.");
    return nullptr;
  }
  const fs::path file = WriteRedirection(address, context.temporary_folder);
  if (file.empty()) {
    context.Note("No browser was opened, because " + context.temporary_folder.string() +
                 " takes no file: open the address above in one.");
    return nullptr;
  }
  const pid_t child = StartDetached({program.string(), file.string()}, context);
  if (child == 0) {
    ::unlink(file.c_str());
    context.Note(program.string() + " cannot be run: open the address above in a browser.");
    return nullptr;
  }
  return std::unique_ptr<OpenedBrowser>(new OpenedBrowser(file, child));
}

OpenedBrowser::OpenedBrowser(fs::path file, pid_t program)
    : file_(std::move(file)), program_(program), waiting_([this] { AwaitEnd(); }) {}

void OpenedBrowser::AwaitEnd() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kFileLives, [this] { return is_done_; });
  ::unlink(file_.c_str());
}

void OpenedBrowser::PageWasFetched() {
  {
    const std::lock_guard lock(mutex_);
    is_done_ = true;
  }
  changed_.notify_all();
}

OpenedBrowser::~OpenedBrowser() {
  PageWasFetched();
  waiting_.join();
  ::waitpid(program_, nullptr, WNOHANG);
}

}  // namespace scumble
