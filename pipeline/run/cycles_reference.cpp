#include "pipeline/run/cycles_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "core/io/guide_file.h"
#include "pipeline/blender_scene.h"
#include "pipeline/scene/blender_process.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRenderingMark = "scumble: rendering ";
constexpr const char* kUnsupportedMark = "scumble: unsupported: ";

bool StartsWith(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

// What a render costs, in samples; each one has its own beginning.
double CostOf(int samples) { return samples + 2.0; }

// "scumble: rendering all, 64 samples" begins a render; Cycles' own "Sample 12/64" tells how far it is.
double ShareDone(const std::vector<std::string>& log, const std::vector<int>& counts, int renders) {
  double total = CostOf(1), done = 0.0, current = 0.0, within = 0.0;
  for (const int count : counts) total += renders * CostOf(count);
  for (const std::string& line : log) {
    int samples = 0, sample = 0;
    if (StartsWith(line, kRenderingMark)) {
      done += current;
      const std::size_t comma = line.find(", ");
      if (comma == std::string::npos || std::sscanf(line.c_str() + comma, ", %d", &samples) != 1) samples = 1;
      current = CostOf(samples), within = 0.0;
    } else if (const std::size_t at = line.rfind("Sample "); at != std::string::npos) {
      if (std::sscanf(line.c_str() + at, "Sample %d/%d", &sample, &samples) == 2 && samples > 0) {
        within = double(sample) / samples;
      }
    }
  }
  return std::min(1.0, (done + within * current) / total);
}

// Runs the program and reports from its log how far it is.
Expected<ProgramEnd> RunWatched(const std::vector<std::string>& arguments, const fs::path& log,
                                const ReferenceOptions& options, const RunContext& context, const Progress& progress) {
  const int renders = std::clamp(options.max_bounces + 1, 1, 3);  // at each count: all, ldde, ld12e
  SCUMBLE_ASSIGN(const auto program, RunningProgram::Start(arguments, log, context));
  constexpr int kPollsForReport = 20;
  for (int polls = 1;; ++polls) {
    SCUMBLE_ASSIGN(const std::optional<ProgramEnd> end, program->Poll());
    if (end) return *end;
    if (progress && polls % kPollsForReport == 0 && !progress(ShareDone(LinesOf(log), options.samples, renders)))
      return CancelledError();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

std::vector<std::string> Arguments(const ReferenceOptions& options, const RunContext& context, const fs::path& script,
                                   const fs::path& picture) {
  std::vector<std::string> arguments{options.blender, "-b", "-noaudio", "--factory-startup", "-Y"};
  if (context.threads > 0) arguments.insert(arguments.end(), {"-t", std::to_string(context.threads)});
  arguments.insert(arguments.end(),
                   {"-P", script.string(), "--", fs::absolute(options.scene).string(), picture.string(), "--size",
                    fmt::format("{}x{}", options.width, options.height), "--materials", "pure"});
  if (!options.camera.empty()) arguments.insert(arguments.end(), {"--camera", options.camera});
  BlenderRequest names;
  names.scene = options.blender_scene, names.view_layer = options.view_layer;
  AddBlenderNames(names, arguments);
  if (options.frame) arguments.insert(arguments.end(), {"--frame", std::to_string(*options.frame)});
  if (!options.samples.empty()) {
    arguments.insert(arguments.end(), {"--samples", fmt::format("{}", fmt::join(options.samples, ",")), "--max-bounces",
                                       std::to_string(options.max_bounces)});
  }
  return arguments;
}

void ReadLog(const std::vector<std::string>& lines, Reference& reference) {
  for (const std::string& line : lines) {
    if (reference.version.empty() && StartsWith(line, "Blender ")) {
      reference.version = line.substr(8, line.find(' ', 8) - 8);
    }
    if (StartsWith(line, kUnsupportedMark))
      reference.unsupported.push_back(line.substr(std::string(kUnsupportedMark).size()));
  }
}

}  // namespace

Expected<Reference> RenderReference(const ReferenceOptions& options, const RunContext& context,
                                    const Progress& progress) {
  const BlenderTask task{options.scene, options.blender, options.blender + " rendered no reference"};
  SCUMBLE_ASSIGN(const fs::path script, FindBlenderScript("render_guides.py", task, context));
  const ScratchFolder scratch(context);
  SCUMBLE_RETURN_IF_ERROR(scratch.Made());
  const fs::path picture = scratch.path() / "cycles.exr", log = scratch.path() / "log";
  context.Note(options.scene + ": " + options.blender + " renders the reference");
  const std::vector<std::string> arguments = Arguments(options, context, script, picture);
  SCUMBLE_RETURN_IF_ERROR(CheckProgramEnd(RunWatched(arguments, log, options, context, progress), task, log, picture));
  Reference reference;
  ReadLog(LinesOf(log), reference);
  GuideReadOptions read;
  read.required = {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kPosition, Layer::kAlbedo};
  read.blender_camera = scratch.path() / "cycles.camera";
  SCUMBLE_ASSIGN(reference.data, ReadGuides(picture, read));
  SCUMBLE_ASSIGN(reference.only_shines, CompleteAlbedo(picture, reference.data));
  for (const int count : options.samples) {
    SCUMBLE_ASSIGN(CyclesLight light, ReadCyclesLight(scratch.path() / "cycles", count));
    reference.light.push_back(std::move(light));
  }
  return reference;
}

}  // namespace scumble
