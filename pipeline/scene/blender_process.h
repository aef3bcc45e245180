// Running Blender with a script of ours: where script and program are, temporary files, and what went wrong in words.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/run_context.h"

namespace scumble {

// A folder of its own, gone with this. The path is empty where it could not be made. While one lives, SIGINT, SIGTERM
// and SIGHUP end the program that RunProgram waits for; the folder is then removed and the signal acts as it would have
// without us, when this is destroyed. One at a time, on the main thread.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// For while a ScratchFolder lives and nobody asks CheckNotSignalled, whether a program runs or not: those signals then
// end it, remove the folder and act as they would have without us, at once. One that came before still waits to be
// asked for. To be switched off before the folder is destroyed.
void EndAtOnceOnSignals(bool at_once);

// What Blender is run for, for messages.
struct BlenderTask {
  std::string scene;
  std::string program;
  std::string failure;           // "the export by blender failed"
  bool can_be_exported = false;  // a .glb would do instead, made by hand
};

// While a ScratchFolder lives: kCancelled once one of those signals has come, which is no fault of the scene's.
Status CheckNotSignalled(const std::string& scene);

// The script of that name in blender_scripts/, beside the build or where `install` put it.
Expected<std::filesystem::path> FindBlenderScript(const std::string& name, const BlenderTask& task,
                                                  const RunContext& context);

struct ProgramEnd {
  int code = -1;   // exit code
  int signal = 0;  // that ended it, if one did
};

// A program at work beside this one. Ended and waited for, at the latest, when this goes.
class RunningProgram {
 public:
  // Both its outputs go to `log`. kUnavailable where it cannot be run.
  static Expected<std::unique_ptr<RunningProgram>> Start(const std::vector<std::string>& arguments,
                                                         const std::filesystem::path& log);
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  // How it ended, or nothing while it is at work.
  Expected<std::optional<ProgramEnd>> Poll() { return Wait(false); }
  Expected<ProgramEnd> Wait();

 private:
  RunningProgram() = default;
  Expected<std::optional<ProgramEnd>> Wait(bool patiently);

  std::string name_;
  int child_ = 0;
  std::optional<ProgramEnd> end_;
};

// Runs a program and waits for it; both its outputs go to `log`, and its temporary files beside it. It is the first of
// a process group of its own, which a signal ends as a whole, and does not see what the caller's shell says about
// Python: Blender would take the packages of a virtual environment for its own. kUnavailable where it cannot be run,
// with the system's reason.
Expected<ProgramEnd> RunProgram(const std::vector<std::string>& arguments, const std::filesystem::path& log);

std::vector<std::string> LinesOf(const std::filesystem::path& log);

// Whether the task went well, and otherwise what went wrong: kUnavailable where Blender cannot be run or its version is
// not supported; kInput where a signal ended it, where the script failed, or where it did not write `product`. The
// reason is the script's own ("scumble: error: …") with Blender's complaints after it; where the script did not come to
// speak, the last lines of `log`, without Cycles' progress.
Status CheckProgramEnd(const Expected<ProgramEnd>& ended, const BlenderTask& task, const std::filesystem::path& log,
                       const std::filesystem::path& product);

}  // namespace scumble
