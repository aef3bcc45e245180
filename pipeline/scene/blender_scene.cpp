#include "pipeline/blender_scene.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "guidegen/load_scene.h"
#include "pipeline/frame_range.h"
#include "pipeline/process_guard.h"
#include "pipeline/requests.h"
#include "pipeline/scene/blender_process.h"

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

// Messages of the loader name the temporary file, which the user does not know.
std::string Renamed(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string NameOfProgram(const BlenderRequest& options) {
  return options.program.empty() ? "blender" : options.program;
}

BlenderTask ExportTask(const std::string& path, const BlenderRequest& options) {
  const std::string program = NameOfProgram(options);
  return {path, program, "the export by " + program + " failed", true};
}

// What runs export_scene.py on a scene, with the script's own arguments to follow.
Expected<std::vector<std::string>> ExportCommand(const std::string& path, const BlenderRequest& options,
                                                 const fs::path& output, const RunContext& context) {
  SCUMBLE_RETURN_IF_ERROR(CheckReadable(path));
  SCUMBLE_ASSIGN(const fs::path script, FindBlenderScript("export_scene.py", ExportTask(path, options), context));
  std::vector<std::string> command{NameOfProgram(options),
                                   "-b",
                                   "-noaudio",
                                   "--factory-startup",
                                   "-Y",  // the file's own scripts do not run
                                   fs::absolute(path).string(),
                                   "-P",
                                   script.string(),
                                   "--",
                                   "--output",
                                   output.string()};
  AddBlenderNames(options, command);
  return command;
}

// Choices that the script made where nobody asked.
void PassNotesOn(const fs::path& log, const std::string& path, const RunContext& context) {
  constexpr std::string_view kMark = "scumble: note: ";
  for (const std::string& line : LinesOf(log)) {
    if (line.starts_with(kMark)) context.Note(path + ": " + line.substr(kMark.size()));
  }
}

Expected<Scene> LoadExport(const fs::path& exported, const std::string& path) {
  Expected<Scene> scene = LoadScene(exported, {TextureLoading::kWhenNeeded, {}});
  if (!scene) return Error{scene.error().kind, Renamed(scene.error().message, exported.string(), path)};
  scene->name = path;
  for (std::shared_ptr<const EncodedTexture>& texture : scene->encoded_textures) {
    auto renamed = std::make_shared<EncodedTexture>(*texture);
    renamed->decode = [decode = texture->decode, from = exported.string(), path]() -> Expected<Picture> {
      Expected<Picture> picture = decode();
      if (!picture) return Error{picture.error().kind, Renamed(picture.error().message, from, path)};
      return picture;
    };
    texture = std::move(renamed);
  }
  return scene;
}

// An empty path where no folder could be made.
fs::path In(const ScratchFolder& scratch, const char* name) {
  return scratch.path().empty() ? fs::path() : scratch.path() / name;
}

constexpr const char *kStartFile = "start.glb", *kRateFile = "fps", *kFilesFile = "files";

// A frame that is named may be one of a range, and is seen as that is. A still is seen as it stands.
void RequestBlenderAnimation(const ScratchFolder& scratch, const BlenderRequest& options, bool is_of_range,
                             std::vector<std::string>& arguments) {
  arguments.insert(arguments.end(),
                   {"--fps-file", In(scratch, kRateFile).string(), "--files-file", In(scratch, kFilesFile).string()});
  if (!is_of_range) return;
  arguments.insert(arguments.end(), {"--start-file", In(scratch, kStartFile).string()});
  if (options.wants_start) arguments.push_back("--start-always");
}

Status LoadBlenderAnimation(const ScratchFolder& scratch, const std::string& path, BlenderAnimation& animation) {
  std::ifstream(In(scratch, kRateFile)) >> animation.fps >> animation.first >> animation.last >> animation.saved;
  std::ifstream files(In(scratch, kFilesFile));
  for (std::string file; std::getline(files, file);) animation.files.push_back(file);
  std::error_code failed;
  const fs::path start = In(scratch, kStartFile);
  if (!fs::is_regular_file(start, failed)) return Ok();
  SCUMBLE_ASSIGN(animation.start, LoadExport(start, path));
  fs::remove(start, failed);
  return Ok();
}

// With more, a slow disk would still not be felt.
constexpr int kFramesAhead = 3;
constexpr const char* kRangeOutput = "scene.#.glb";

}  // namespace

bool IsBlenderScene(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".blend";
}

// With an equals sign: a name that starts with a dash would look like an option.
void AddBlenderNames(const BlenderRequest& options, std::vector<std::string>& arguments) {
  if (!options.scene.empty()) arguments.push_back("--scene=" + options.scene);
  if (!options.view_layer.empty()) arguments.push_back("--view-layer=" + options.view_layer);
}

Expected<Scene> LoadBlenderScene(const std::string& path, const BlenderRequest& options, const RunContext& context,
                                 BlenderAnimation* animation) {
  const ScratchFolder scratch(context);
  const fs::path exported = In(scratch, "scene.glb"), log = In(scratch, "log");
  SCUMBLE_ASSIGN(std::vector<std::string> arguments, ExportCommand(path, options, exported, context));
  SCUMBLE_RETURN_IF_ERROR(scratch.Made());
  if (animation) RequestBlenderAnimation(scratch, options, options.frame.has_value(), arguments);
  if (options.frame) arguments.insert(arguments.end(), {"--frame", std::to_string(*options.frame)});
  context.Note(path + ": " + arguments.front() + " exports it" +
               (options.frame ? " at frame " + std::to_string(*options.frame) : std::string()));
  SCUMBLE_RETURN_IF_ERROR(
      CheckProgramEnd(RunProgram(arguments, log, context), ExportTask(path, options), log, exported));
  PassNotesOn(log, path, context);
  if (animation) SCUMBLE_RETURN_IF_ERROR(LoadBlenderAnimation(scratch, path, *animation));
  return LoadExport(exported, path);
}

BlenderRange::BlenderRange(const RunContext& context) : context_(context) {}

BlenderRange::~BlenderRange() {
  Waits(true);
  program_.reset();  // before the folder that it writes into
}

Expected<std::unique_ptr<BlenderRange>> BlenderRange::Start(const std::string& path, const BlenderRequest& options,
                                                            std::span<const int> frames, const RunContext& context) {
  std::unique_ptr<BlenderRange> range(new BlenderRange(context));
  range->task_ = std::make_unique<BlenderTask>(ExportTask(path, options));
  range->scratch_ = std::make_unique<ScratchFolder>(context);
  SCUMBLE_ASSIGN(std::vector<std::string> arguments,
                 ExportCommand(path, options, In(*range->scratch_, kRangeOutput), context));
  SCUMBLE_RETURN_IF_ERROR(range->scratch_->Made());
  // With an equals sign: a range that starts at a negative frame would look like an option.
  arguments.push_back("--frames=" + FramesToText(frames));
  arguments.insert(arguments.end(), {"--ahead", std::to_string(kFramesAhead)});
  RequestBlenderAnimation(*range->scratch_, options, true, arguments);
  context.Note(path + ": " + arguments.front() + " exports frame" + (frames.size() == 1 ? " " : "s ") +
               FramesToText(frames));
  const fs::path log = In(*range->scratch_, "log");
  auto program = RunningProgram::Start(arguments, log, context);
  if (!program) return CheckProgramEnd(program.error(), *range->task_, log, {}).error();
  range->program_ = std::move(*program);
  SCUMBLE_RETURN_IF_ERROR(range->LeaveAlone());
  return range;
}

void BlenderRange::Waits(bool waits) {
  if (context_.process_guard) context_.process_guard->Waits(waits);
}

// Until the next Load a frame is cast, for minutes perhaps. A signal should not wait for it.
Status BlenderRange::LeaveAlone() {
  Waits(false);
  return context_.CheckNotCancelled();
}

Expected<Scene> BlenderRange::Load(int frame) {
  Waits(true);
  Expected<Scene> scene = Await(frame);
  SCUMBLE_RETURN_IF_ERROR(LeaveAlone());
  return scene;
}

Expected<Scene> BlenderRange::Await(int frame) {
  SCUMBLE_ASSIGN(const FrameName name, FrameName::Parse(In(*scratch_, kRangeOutput).string()));
  const fs::path exported = name.At(frame);
  std::error_code failed;
  for (;;) {
    // In this order: a Blender that ends between the two questions has written its last file before.
    SCUMBLE_ASSIGN(const std::optional<ProgramEnd> end, program_->Poll());
    if (fs::is_regular_file(exported, failed)) break;  // it gets this name when it is whole
    if (end) SCUMBLE_RETURN_IF_ERROR(CheckProgramEnd(*end, *task_, In(*scratch_, "log"), exported));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (!has_animation_) {
    PassNotesOn(In(*scratch_, "log"), task_->scene, context_);
    SCUMBLE_RETURN_IF_ERROR(LoadBlenderAnimation(*scratch_, task_->scene, animation_));
  }
  has_animation_ = true;
  Expected<Scene> scene = LoadExport(exported, task_->scene);
  fs::remove(exported, failed);
  return scene;
}

}  // namespace scumble
