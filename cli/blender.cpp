#include "cli/blender.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include "cli/blender_process.h"
#include "cli/options.h"
#include "guidegen/load_scene.h"

namespace scumble {

namespace fs = std::filesystem;

namespace {

Status CheckReadable(const std::string& path) {
  std::error_code failed;
  if (!fs::is_regular_file(path, failed)) {
    return InputError(path + " cannot be read: " + (fs::exists(path, failed) ? "it is no file" : "no such file"));
  }
  if (::access(path.c_str(), R_OK) != 0) return InputError(path + " cannot be read: " + std::strerror(errno));
  return Ok();
}

// Messages of the loader name the temporary file, which is none of the user's business.
std::string Renamed(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

}  // namespace

bool IsBlenderScene(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".blend";
}

Expected<Scene> LoadBlenderScene(const std::string& path, const BlenderOptions& options, const Globals& globals) {
  SCUMBLE_RETURN_IF_ERROR(CheckReadable(path));
  const std::string program = options.program.empty() ? "blender" : options.program;
  const BlenderTask task{path, program, "the export by " + program + " failed", true};
  SCUMBLE_ASSIGN(const fs::path script, FindBlenderScript("export_scene.py", task));
  const ScratchFolder scratch;
  if (scratch.path().empty())
    return OutputError("no folder can be made for temporary files: set TMPDIR to one that can");
  const fs::path exported = scratch.path() / "scene.glb", log = scratch.path() / "log";
  std::vector<std::string> arguments{program,
                                     "-b",
                                     "-noaudio",
                                     "--factory-startup",
                                     "-Y",  // the file's own scripts stay asleep
                                     fs::absolute(path).string(),
                                     "-P",
                                     script.string(),
                                     "--",
                                     "--output",
                                     exported.string()};
  if (options.frame) arguments.insert(arguments.end(), {"--frame", std::to_string(*options.frame)});
  Say(globals, path + ": " + program + " exports it" +
                   (options.frame ? " at frame " + std::to_string(*options.frame) : std::string()));
  SCUMBLE_RETURN_IF_ERROR(CheckProgramEnd(RunProgram(arguments, log), task, log, exported));
  Expected<Scene> scene = LoadScene(exported);
  if (!scene) return Error{scene.error().kind, Renamed(scene.error().message, exported.string(), path)};
  scene->name = path;
  return scene;
}

}  // namespace scumble
