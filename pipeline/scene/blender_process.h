// Running Blender with a script of ours: finding program and script, temporary files, and what went wrong in words.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/run_context.h"

namespace scumble {

// A folder of its own in RunContext::temporary_folder, removed when this is destroyed. The path is empty where it could
// not be made. The context's process guard follows it. Those of runs that were killed are removed when one is made.
class ScratchFolder {
 public:
  explicit ScratchFolder(const RunContext& context);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  // Ok, or a kOutput error that names the folder in which it could not be made, and the reason.
  Status Made() const;

 private:
  std::shared_ptr<ProcessGuard> guard_;
  std::filesystem::path parent_, path_;
  int failure_ = 0;
  int lock_ = -1;  // by which other runs see that the folder is in use
};

// What Blender is run for, for messages.
struct BlenderTask {
  std::string scene;
  std::string program;
  std::string failure;           // "the export by blender failed"
  bool can_be_exported = false;  // a .glb would do instead, made by hand
};

// The script of that name in blender_scripts/, beside the build or where `install` put it.
Expected<std::filesystem::path> FindBlenderScript(const std::string& name, const BlenderTask& task,
                                                  const RunContext& context);

struct ProgramEnd {
  int code = -1;   // exit code
  int signal = 0;  // that ended it, if one did
};

// A program at work beside this one. It leads a process group of its own, which is killed and waited for, at the
// latest, when this is destroyed.
//
// The program is looked for as execvp(3) does, in the PATH of RunContext::environment, and gets that environment with
// two changes. Variables of Python and its virtual environments are left out, and the PATH begins with Blender's own
// folder and /usr/bin: Blender would take the packages of the caller's Python for its own. The folder for temporary
// files is that of the log.
class RunningProgram {
 public:
  // Both its outputs go to `log`. kUnavailable where it cannot be run, with the system's reason.
  static Expected<std::unique_ptr<RunningProgram>> Start(const std::vector<std::string>& arguments,
                                                         const std::filesystem::path& log, const RunContext& context);
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  // How it ended, or nothing while it is at work. If another part of the process has collected how it ended, or SIGCHLD
  // is ignored, the code is 0: only its product tells. kCancelled where the context is cancelled, however it ended.
  Expected<std::optional<ProgramEnd>> Poll();
  // Polls until it has ended.
  Expected<ProgramEnd> Wait();

 private:
  RunningProgram(std::string name, int child, const RunContext& context);

  std::string name_;
  int child_ = 0;
  RunContext context_;
  std::optional<ProgramEnd> end_;
};

// Runs a program and waits for it.
Expected<ProgramEnd> RunProgram(const std::vector<std::string>& arguments, const std::filesystem::path& log,
                                const RunContext& context);

std::vector<std::string> LinesOf(const std::filesystem::path& log);

// Ok, or what went wrong: kUnavailable where Blender cannot be run or its version is not supported; kInput where a
// signal ended it, where the script failed, or where it did not write `product`; kCancelled as it is. The reason is the
// script's own ("scumble: error: …") with Blender's complaints after it. Without one, it is the last lines of `log`,
// but for Cycles' progress.
Status CheckProgramEnd(const Expected<ProgramEnd>& ended, const BlenderTask& task, const std::filesystem::path& log,
                       const std::filesystem::path& product);

}  // namespace scumble
