// Running Blender with a script of ours: where script and program are, temporary files, and what went wrong in words.
#pragma once

#include <filesystem>
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

// Runs a program and waits for it; both its outputs go to `log`. kUnavailable where it cannot be run.
Expected<ProgramEnd> RunProgram(const std::vector<std::string>& arguments, const std::filesystem::path& log);

std::vector<std::string> LinesOf(const std::filesystem::path& log);

// The script's own reason ("scumble: error: …") with Blender's complaints after it; where the script did not come to
// speak, the last lines.
std::string ReasonFrom(const std::vector<std::string>& lines);

}  // namespace scumble
