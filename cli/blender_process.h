// Running Blender with a script of ours: where script and program are, temporary files, and what went wrong in words.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image/status.h"

namespace scumble {

// A folder of its own, gone with this. The path is empty where it could not be made.
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

// The script of that name in blender_scripts/, beside the build or where `install` put it. `scene` is for the message.
Expected<std::filesystem::path> FindBlenderScript(const std::string& name, const std::string& scene);

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

// Runs a program and waits for it; both its outputs go to `log`. kUnavailable where it cannot be run.
Expected<ProgramEnd> RunProgram(const std::vector<std::string>& arguments, const std::filesystem::path& log);

std::vector<std::string> LinesOf(const std::filesystem::path& log);

// The script's own reason ("scumble: error: …") with Blender's complaints after it; where the script did not come to
// speak, the last lines.
std::string ReasonFrom(const std::vector<std::string>& lines);

}  // namespace scumble
