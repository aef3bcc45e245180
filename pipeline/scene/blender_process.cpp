#include "pipeline/scene/blender_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

extern char** environ;

namespace scumble {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSupported = "Blender 3.4";
constexpr int kExitVersion = 5;  // of our scripts
constexpr const char* kErrorMark = "scumble: error: ";

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
  ::raise(signal);  // is delivered when this returns
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

// Where the program of that name really is; the name itself where it is not found.
fs::path RealPathOf(const std::string& program) {
  std::error_code failed;
  if (program.find('/') != std::string::npos) return fs::canonical(program, failed);
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / program;
    if (::access(candidate.c_str(), X_OK) == 0 && fs::is_regular_file(candidate, failed)) {
      return fs::canonical(candidate, failed);
    }
  }
  return {};
}

// Blender's Python looks for its packages beside the first python3 in PATH, and where these variables send it.
std::vector<std::string> EnvironmentFor(const std::string& program, const fs::path& temporary) {
  std::vector<std::string> environment;
  std::string path = "/usr/bin";
  if (const fs::path real = RealPathOf(program); real.has_parent_path() && real.parent_path() != path) {
    path = real.parent_path().string() + ":" + path;
  }
  for (char** variable = environ; *variable; ++variable) {
    const std::string text = *variable;
    const std::string name = text.substr(0, text.find('='));
    if (name.starts_with("PYTHON") || name == "VIRTUAL_ENV" || name == "TMPDIR" || name == "TMP" || name == "TEMP") {
      continue;
    }
    if (name == "PATH")
      path += ":" + text.substr(5);
    else
      environment.push_back(text);
  }
  environment.push_back("PATH=" + path);
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
int Spawn(const std::vector<std::string>& arguments, const fs::path& log, pid_t& child) {
  const std::vector<std::string> environment = EnvironmentFor(arguments.front(), log.parent_path());
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
  const int failure = ::posix_spawnp(&child, argv.front(), &actions, &attributes, argv.data(), envp.data());
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
  std::vector<std::string> talk;
  for (const std::string& line : lines) {
    if (line.rfind(kErrorMark, 0) == 0) reason = line.substr(std::strlen(kErrorMark));
    if (line.rfind("Error: ", 0) == 0) complaints += "; Blender says: " + line.substr(std::strlen("Error: "));
    if (line.rfind("Fra:", 0) != 0) talk.push_back(line);  // Cycles' progress
  }
  if (!reason.empty()) return reason + complaints;
  constexpr std::size_t kLastLines = 3;
  for (std::size_t i = talk.size() - std::min(talk.size(), kLastLines); i < talk.size(); ++i) {
    reason += (reason.empty() ? "" : " | ") + talk[i];
  }
  return reason.empty() ? "it says nothing" : reason;
}

// Another way than by Blender here and now, where there is one.
std::string ByHand(const BlenderTask& task) {
  return task.can_be_exported ? ", or export the scene to .glb by hand" : "";
}

}  // namespace

ScratchFolder::ScratchFolder() {
  CatchSignals();
  std::error_code failed;
  std::string name = (fs::temp_directory_path(failed) / "scumble-XXXXXX").string();
  if (failed || !::mkdtemp(name.data())) return;
  path_ = name;
  if (name.size() >= sizeof(scratch_folder)) return;
  std::memcpy(scratch_folder, name.c_str(), name.size() + 1);
  has_scratch_folder = true;
}

ScratchFolder::~ScratchFolder() {
  std::error_code failed;
  if (!path_.empty()) fs::remove_all(path_, failed);
  has_scratch_folder = false;
  ReleaseSignals();
}

void EndAtOnceOnSignals(bool at_once) { ends_at_once = at_once; }

Status CheckNotSignalled(const std::string& scene) {
  const int signal = caught_signal;
  if (signal == 0) return Ok();
  return Error{ErrorKind::kCancelled, scene + ": ended by a signal (" + ::strsignal(signal) + ")"};
}

Expected<fs::path> FindBlenderScript(const std::string& name, const BlenderTask& task, const RunContext& context) {
  std::error_code failed;
  for (const fs::path& root : context.DataFolders("blender_scripts")) {
    if (fs::is_regular_file(root / name, failed)) return root / name;
  }
  return UnavailableError(task.scene + ": " + name + " is not found beside this program: install it again" +
                          ByHand(task));
}

Expected<std::unique_ptr<RunningProgram>> RunningProgram::Start(const std::vector<std::string>& arguments,
                                                                const fs::path& log) {
  pid_t child = 0;
  const int failure = Spawn(arguments, log, child);
  if (failure != 0) {
    return UnavailableError(arguments.front() + " cannot be run (" + std::strerror(failure) + ")");
  }
  std::unique_ptr<RunningProgram> program(new RunningProgram);
  program->name_ = arguments.front();
  program->child_ = child;
  running_group = child;
  if (caught_signal) ::kill(-child, SIGKILL);  // it came before the handler knew whom to end
  return program;
}

RunningProgram::~RunningProgram() {
  if (end_) return;
  ::kill(-child_, SIGTERM);
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
    if (errno == EINTR) continue;
    running_group = 0;
    return UnavailableError(name_ + " got lost: " + std::strerror(errno));
  }
  if (ended != child_) return end_;
  running_group = 0;
  end_ = WIFSIGNALED(status) ? ProgramEnd{-1, WTERMSIG(status)} : ProgramEnd{WEXITSTATUS(status), 0};
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

Status CheckProgramEnd(const Expected<ProgramEnd>& ended, const BlenderTask& task, const fs::path& log,
                       const fs::path& product) {
  SCUMBLE_RETURN_IF_ERROR(CheckNotSignalled(task.scene));
  if (!ended) {
    return Error{ended.error().kind, task.scene + ": " + ended.error().message + ": install " + kSupported +
                                         ", or say where it is with --blender PATH" + ByHand(task)};
  }
  // A shell that runs Blender tells its signal so.
  const int signal = ended->signal != 0                                   ? ended->signal
                     : ended->code > 128 && ended->code <= 128 + SIGRTMAX ? ended->code - 128
                                                                          : 0;
  if (signal != 0) return InputError(task.scene + ": " + task.program + SignalText(signal));
  const std::string reason = ReasonFrom(LinesOf(log));
  if (ended->code == kExitVersion) return UnavailableError(task.scene + ": " + reason);
  std::error_code failed;
  if (ended->code != 0 || !fs::is_regular_file(product, failed)) {
    return InputError(task.scene + ": " + task.failure + ": " + reason);
  }
  return Ok();
}

}  // namespace scumble
