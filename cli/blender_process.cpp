#include "cli/blender_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <system_error>

#include "cli/options.h"

extern char** environ;

namespace scumble {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSupported = "Blender 3.4";
constexpr const char* kErrorMark = "scumble: error: ";

}  // namespace

ScratchFolder::ScratchFolder() {
  std::error_code failed;
  std::string name = (fs::temp_directory_path(failed) / "scumble-XXXXXX").string();
  if (!failed && ::mkdtemp(name.data())) path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code failed;
  if (!path_.empty()) fs::remove_all(path_, failed);
}

Expected<fs::path> FindBlenderScript(const std::string& name, const std::string& scene) {
  std::error_code failed;
  for (const fs::path& root : DataRoots("blender_scripts")) {
    if (fs::is_regular_file(root / name, failed)) return root / name;
  }
  return UnavailableError(scene + ": " + name + " is not found beside this program: install it again, or export to .glb");
}

Expected<std::unique_ptr<RunningProgram>> RunningProgram::Start(const std::vector<std::string>& arguments,
                                                                const fs::path& log) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failure = ::posix_spawnp(&child, argv.front(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    return UnavailableError(arguments.front() + " cannot be run (" + std::strerror(failure) + "): install " +
                            kSupported + ", name it with --blender PATH, or export the scene to .glb by hand");
  }
  std::unique_ptr<RunningProgram> program(new RunningProgram);
  program->name_ = arguments.front();
  program->child_ = child;
  return program;
}

RunningProgram::~RunningProgram() {
  if (end_) return;
  ::kill(child_, SIGTERM);
  if (!Wait()) return;  // it is no child of ours any more
}

Expected<ProgramEnd> RunningProgram::Wait() {
  SCUMBLE_ASSIGN(const std::optional<ProgramEnd> end, Wait(true));
  return *end;
}

Expected<std::optional<ProgramEnd>> RunningProgram::Wait(bool patiently) {
  if (end_) return end_;
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(child_, &status, patiently ? 0 : WNOHANG)) < 0) {
    if (errno != EINTR) return UnavailableError(name_ + " got lost: " + std::strerror(errno));
  }
  if (ended == child_) end_ = WIFSIGNALED(status) ? ProgramEnd{-1, WTERMSIG(status)} : ProgramEnd{WEXITSTATUS(status), 0};
  return end_;
}

Expected<ProgramEnd> RunProgram(const std::vector<std::string>& arguments, const fs::path& log) {
  SCUMBLE_ASSIGN(const auto program, RunningProgram::Start(arguments, log));
  return program->Wait();
}

std::vector<std::string> LinesOf(const fs::path& log) {
  std::vector<std::string> lines;
  std::ifstream stream(log);
  for (std::string line; std::getline(stream, line);) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    if (!line.empty() && line != "Blender quit") lines.push_back(line);
  }
  return lines;
}

std::string ReasonFrom(const std::vector<std::string>& lines) {
  std::string reason, complaints;
  for (const std::string& line : lines) {
    if (line.rfind(kErrorMark, 0) == 0) reason = line.substr(std::strlen(kErrorMark));
    if (line.rfind("Error: ", 0) == 0) complaints += "; Blender says: " + line.substr(std::strlen("Error: "));
  }
  if (!reason.empty()) return reason + complaints;
  constexpr std::size_t kLastLines = 3;
  for (std::size_t i = lines.size() - std::min(lines.size(), kLastLines); i < lines.size(); ++i) {
    reason += (reason.empty() ? "" : " | ") + lines[i];
  }
  return reason.empty() ? "it says nothing" : reason;
}

}  // namespace scumble
