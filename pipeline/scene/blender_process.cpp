#include "pipeline/scene/blender_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include "core/io/stale_temporaries.h"
#include "pipeline/process_guard.h"
#include "pipeline/scene/blender_file.h"

namespace scumble {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSupported = "Blender (3.4.1 and 4.3.2 are tested)";
constexpr int kExitVersion = 5;  // of our scripts
constexpr const char* kErrorMark = "scumble: error: ";
const std::string kPath = "PATH=";
constexpr auto kPollInterval = std::chrono::milliseconds(10);

// The file that the name of a program stands for, as execvp(3) finds it: one that may be run goes before one that may
// not. Empty where there is none.
fs::path FindProgram(const std::string& program, const std::vector<std::string>& environment) {
  if (program.find('/') != std::string::npos) return program;
  std::string path = "/bin:/usr/bin";
  for (const std::string& variable : environment) {
    if (variable.starts_with(kPath)) path = variable.substr(kPath.size());
  }
  std::error_code failed;
  fs::path forbidden;
  std::istringstream folders(path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / program;
    if (!fs::is_regular_file(candidate, failed)) continue;
    if (::access(candidate.c_str(), X_OK) == 0) return candidate;
    if (forbidden.empty()) forbidden = candidate;
  }
  return forbidden;
}

// Blender's Python looks for its packages beside the first python3 in PATH, and where these variables send it.
std::vector<std::string> EnvironmentFor(const fs::path& program, const fs::path& temporary,
                                        const std::vector<std::string>& given) {
  std::vector<std::string> environment;
  std::string path = "/usr/bin";
  std::error_code failed;
  if (const fs::path real = fs::canonical(program, failed); real.has_parent_path() && real.parent_path() != path) {
    path = real.parent_path().string() + ":" + path;
  }
  for (const std::string& text : given) {
    const std::string name = text.substr(0, text.find('='));
    if (name.starts_with("PYTHON") || name == "VIRTUAL_ENV" || name == "TMPDIR" || name == "TMP" || name == "TEMP") {
      continue;
    }
    if (text.starts_with(kPath))
      path += ":" + text.substr(kPath.size());
    else
      environment.push_back(text);
  }
  environment.push_back(kPath + path);
  // What Blender leaves behind when it is killed goes with the folder.
  for (const char* name : {"TMPDIR=", "TMP=", "TEMP="}) environment.push_back(name + temporary.string());
  return environment;
}

std::vector<char*> Pointers(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

// 0 and the child, or what failed.
int Spawn(const std::vector<std::string>& arguments, const fs::path& log, const RunContext& context, pid_t& child) {
  const fs::path program = FindProgram(arguments.front(), context.environment);
  if (program.empty()) return ENOENT;
  const std::vector<std::string> environment = EnvironmentFor(program, log.parent_path(), context.environment);
  const std::vector<char*> argv = Pointers(arguments), envp = Pointers(environment);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  const int failure = ::posix_spawn(&child, program.c_str(), &actions, &attributes, argv.data(), envp.data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  return failure;
}

// How a signal is called, and what it may mean.
std::string SignalText(int signal) {
  const bool from_outside = signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP;
  if (!from_outside) return std::string(" crashed (") + ::strsignal(signal) + "): open the file in it and look";
  return std::string(" was ended from outside (") + ::strsignal(signal) + ")" +
         (signal == SIGKILL ? ": was memory short?" : "");
}

std::string ReasonFrom(const std::vector<std::string>& lines) {
  std::string reason, complaints;
  std::vector<std::string> rest;
  for (const std::string& line : lines) {
    if (line.rfind(kErrorMark, 0) == 0) reason = line.substr(std::strlen(kErrorMark));
    if (line.rfind("Error: ", 0) == 0) complaints += "; Blender says: " + line.substr(std::strlen("Error: "));
    if (line.rfind("Fra:", 0) != 0) rest.push_back(line);  // Cycles' progress
  }
  if (!reason.empty()) return reason + complaints;
  constexpr std::size_t kLastLines = 3;
  for (std::size_t i = rest.size() - std::min(rest.size(), kLastLines); i < rest.size(); ++i) {
    reason += (reason.empty() ? "" : " | ") + rest[i];
  }
  return reason.empty() ? "it says nothing" : reason;
}

// The script of ours that another one looked for in vain; empty where none did.
std::string MissingScript(const std::vector<std::string>& lines) {
  const std::string mark = "ModuleNotFoundError: No module named '";
  for (const std::string& line : lines) {
    if (line.rfind(mark, 0) != 0) continue;
    const std::string name = line.substr(mark.size(), line.find('\'', mark.size()) - mark.size());
    for (const char* ours : {"blend_", "export_", "guide_"}) {
      if (name.rfind(ours, 0) == 0) return name + ".py";
    }
  }
  return "";
}

// What the user can do without this Blender.
std::string ByHand(const BlenderTask& task) {
  return task.can_be_exported ? ", or export the scene to .glb by hand" : "";
}

}  // namespace

ScratchFolder::ScratchFolder(const RunContext& context)
    : guard_(context.process_guard), parent_(context.temporary_folder) {
  if (guard_) guard_->Begin();
  if (parent_.empty()) return;
  const internal::LockedFolder made = internal::MakeLockedFolder(parent_);
  path_ = made.path, lock_ = made.lock, failure_ = made.failure;
  if (guard_ && !path_.empty()) guard_->FolderMade(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code failed;
  if (!path_.empty()) fs::remove_all(path_, failed);
  if (lock_ >= 0) ::close(lock_);
  if (guard_) guard_->End();
}

Status ScratchFolder::Made() const {
  if (!path_.empty()) return Ok();
  const std::string found = parent_.empty() ? "TMPDIR names no folder"
                                            : "no folder for temporary files can be made in " + parent_.string() +
                                                  " (" + std::strerror(failure_) + ")";
  return OutputError(found + ": set TMPDIR, or the library's temporary_folder, to a folder that can be written");
}

Expected<fs::path> FindBlenderScript(const std::string& name, const BlenderTask& task, const RunContext& context) {
  std::error_code failed;
  const std::vector<fs::path> folders = context.DataFolders("blender_scripts");
  for (const fs::path& folder : folders) {
    if (fs::is_regular_file(folder / name, failed)) return folder / name;
  }
  const std::string found = folders.empty() ? "blender_scripts/" + name + " is not found beside this program"
                                            : (folders.front() / name).string() + " is missing";
  return UnavailableError(task.scene + ": " + found + ": install Scumble again" + ByHand(task));
}

RunningProgram::RunningProgram(std::string name, int child, const RunContext& context)
    : name_(std::move(name)), child_(child), context_(context) {
  if (context_.process_guard) context_.process_guard->ProgramStarted(child);
}

Expected<std::unique_ptr<RunningProgram>> RunningProgram::Start(const std::vector<std::string>& arguments,
                                                                const fs::path& log, const RunContext& context) {
  pid_t child = 0;
  const int failure = Spawn(arguments, log, context, child);
  if (failure != 0) {
    return UnavailableError(arguments.front() + " cannot be run (" + std::strerror(failure) + ")");
  }
  return std::unique_ptr<RunningProgram>(new RunningProgram(arguments.front(), child, context));
}

RunningProgram::~RunningProgram() {
  if (!end_ && child_ != 0) {
    ::kill(-child_, SIGKILL);
    while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (context_.process_guard) context_.process_guard->ProgramEnded();
}

Expected<std::optional<ProgramEnd>> RunningProgram::Poll() {
  if (!end_) {
    int status = 0;
    const pid_t ended = ::waitpid(child_, &status, WNOHANG);
    if (ended < 0 && errno == ECHILD) {
      end_ = ProgramEnd{0, 0};
      if (context_.process_guard) context_.process_guard->ProgramEnded();
    } else if (ended < 0 && errno != EINTR) {
      const int failure = errno;
      child_ = 0;
      return UnavailableError(name_ + " got lost: " + std::strerror(failure));
    }
    if (ended == child_) {
      end_ = WIFSIGNALED(status) ? ProgramEnd{-1, WTERMSIG(status)} : ProgramEnd{WEXITSTATUS(status), 0};
      if (context_.process_guard) context_.process_guard->ProgramEnded();
    }
  }
  SCUMBLE_RETURN_IF_ERROR(context_.CheckNotCancelled());
  return end_;
}

Expected<ProgramEnd> RunningProgram::Wait() {
  for (;;) {
    SCUMBLE_ASSIGN(const std::optional<ProgramEnd> end, Poll());
    if (end) return *end;
    std::this_thread::sleep_for(kPollInterval);
  }
}

Expected<ProgramEnd> RunProgram(const std::vector<std::string>& arguments, const fs::path& log,
                                const RunContext& context) {
  SCUMBLE_ASSIGN(const auto program, RunningProgram::Start(arguments, log, context));
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

Status CheckProgramEnd(const Expected<ProgramEnd>& ended, const BlenderTask& task, const fs::path& log,
                       const fs::path& product) {
  if (!ended) {
    if (ended.error().kind == ErrorKind::kCancelled) return ended.error();
    return Error{ended.error().kind, task.scene + ": " + ended.error().message + ": install " + kSupported +
                                         ", or name its program with --blender" + ByHand(task)};
  }
  // How a shell that runs Blender reports its signal.
  const int signal = ended->signal != 0                                   ? ended->signal
                     : ended->code > 128 && ended->code <= 128 + SIGRTMAX ? ended->code - 128
                                                                          : 0;
  const std::vector<std::string> lines = LinesOf(log);
  const std::string newer = NewerThanBlender(task.scene, lines);
  if (signal != 0) {
    return InputError(task.scene + ": " + task.program + SignalText(signal) + (newer.empty() ? "" : "; " + newer));
  }
  if (const std::string script = MissingScript(lines); !script.empty()) {
    return UnavailableError(task.scene + ": blender_scripts/" + script + " is missing: install Scumble again" +
                            ByHand(task));
  }
  const std::string reason = ReasonFrom(lines);
  if (ended->code == kExitVersion) return UnavailableError(task.scene + ": " + reason);
  std::error_code failed;
  if (ended->code != 0 || !fs::is_regular_file(product, failed)) {
    const bool said = newer.empty() || reason.find("saved by Blender") != std::string::npos;
    return InputError(task.scene + ": " + task.failure + ": " + reason + (said ? "" : "; " + newer));
  }
  return Ok();
}

}  // namespace scumble
