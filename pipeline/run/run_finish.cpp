#include "pipeline/run_finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/image/hash.h"
#include "core/image/stopwatch.h"
#include "core/io/existing_output.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/finish_keys.h"
#include "finish/finish.h"
#include "finish/jitter_rate.h"
#include "pipeline/finish_files.h"
#include "pipeline/finish_layers.h"
#include "pipeline/finish_set.h"
#include "pipeline/frame/frame_painter.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/frame/provenance.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/run/kept_warnings.h"
#include "pipeline/run_inputs.h"
#include "pipeline/style/finish_order.h"

namespace scumble {
namespace {

// The passes of a run, and what it keeps from frame to frame.
struct FinishState {
  FinishChain chain;
  LayerSet required;  // in any frame
  std::optional<FinishMeasures> measures;
  PaletteColors palette_colors;
  FinishRemarks remarks;
};

LayerSet LayersOf(const FinishChain& chain) {
  LayerSet layers = LayersOverTime(chain);
  return layers.empty() ? layers : layers.Add({Layer::kCoverage, Layer::kNormal});  // every guide set holds these
}

// The view layer may be the picture's alone.
GuideReadOptions ReadOptions(const FinishRequest& request, const LayerSet& required, const std::string& guides,
                             const std::string& camera) {
  GuideReadOptions read;
  read.required = required, read.view_layer = request.view_layer, read.light_layer = request.light_layer;
  read.blender_camera = camera, read.user = GuideUser::kFinish;
  if (read.view_layer.empty()) return read;
  const auto info = InspectGuides(guides);
  const auto is_named = [](const auto& layers) { return !layers.first.empty(); };
  if (info && std::none_of(info->layers.begin(), info->layers.end(), is_named)) read.view_layer.clear();
  return read;
}

bool Jitters(const FinishPass& pass) { return JitterFpsOf(pass) > 0.0; }

// The rate that was given, or that of the guides, which need not be there.
FrameRate RateFor(const FinishRequest& request, const std::string& guides) {
  if (request.fps || guides.empty()) return request.fps.value_or(FrameRate());
  const auto info = InspectGuides(guides);
  return info ? RateOf({}, info->header) : FrameRate();
}

// Of the picture's file: a repainted picture is another one.
Expected<std::string> HashOfFile(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> block(std::size_t(1) << 20);  // files with many layers are larger than their picture
  std::uint64_t hash = 0;
  while (stream) {
    stream.read(block.data(), std::streamsize(block.size()));
    hash = HashOn(hash, HashBytes(std::span<const char>(block).first(std::size_t(stream.gcount()))));
  }
  if (!stream.eof()) return InputError(file + " cannot be read: check its permissions and its disk");
  return fmt::format("{:016x}", hash);
}

// `picture`: its HashOfFile. `measures`: those that were given or measured; empty: not known yet. `measured`: see
// PictureSettings.
std::string SettingsText(const FinishRequest& request, const FinishChain& chain, const std::string& picture,
                         const std::optional<FinishMeasures>& measures, std::optional<bool> measured, FrameRate fps) {
  std::string text;
  for (const FinishPass& pass : chain.passes) text += (text.empty() ? "" : ", ") + FinishText(pass);
  text = fmt::format("scumble {}; finish {}; seed {}; height {}; picture {}", SCUMBLE_VERSION, text, request.seed,
                     request.reference_height, picture);
  if (std::any_of(chain.passes.begin(), chain.passes.end(), Jitters)) text += "; fps " + FrameRateToText(fps);
  if (EverLooksAtMeasures(chain)) text += FinishMeasuresPart(measures ? MeasuresText(*measures) : "", measured);
  if (!request.view_layer.empty()) text += "; view_layer " + request.view_layer;
  if (!request.light_layer.empty()) text += "; light_layer " + request.light_layer;
  return text + (request.show_finish.empty() ? "" : "; show " + (kShowFinish + request.show_finish));
}

// The frame's number, which key frames go by, and its files.
struct FrameFiles {
  std::optional<int> frame;
  std::string picture, guides, camera, output, layers;
};

LayersWanted WantedOf(const FinishRequest& request) { return {request.show_finish, !request.layers_out.empty()}; }

// Before any of it is taken. Files that cannot be read take nothing; reading them is an error later.
Expected<MemoryNeed> CheckFinishMemory(const FinishRequest& request, const FrameFiles& files, const FinishState& state,
                                       const RunContext& context) {
  MemoryNeed need;
  AddProgram(context.threads, need);
  const auto header = InspectPicture(files.picture);
  if (!header) return need;
  const Size size{header->width, header->height};
  const std::uint64_t pixels = std::uint64_t(size.width) * std::uint64_t(size.height);
  need.Take("picture", 8 * pixels);
  AddPictureRead(files.picture, pixels, need);
  if (const auto info =
          files.guides.empty() ? Expected<GuideFileInfo>(InputError("none")) : InspectGuides(files.guides)) {
    AddGuidesRead(*info, ReadOptions(request, state.required, files.guides, files.camera), need);
  }
  AddFinish(state.chain, false, size, need);
  if (!files.layers.empty() || !request.show_finish.empty()) {
    AddFinishLayers(state.chain.passes.size(), !files.layers.empty(), !request.sequence.frames.empty(), size, need);
  }
  need.TakeTransient("picture file", 16 * pixels);
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, context, "take smaller pictures"));
  return need;
}

Expected<FrameWrite> Finish(const FinishRequest& request, const FrameFiles& files, const RunContext& context,
                            const Progress& progress, FinishState& state) {
  SCUMBLE_ASSIGN(MemoryNeed memory, CheckFinishMemory(request, files, state, context));
  SCUMBLE_RETURN_IF_ERROR(SetFinishFrame(state.chain, files.frame.value_or(0)));
  StepTimes times;
  Stopwatch watch;
  SCUMBLE_ASSIGN(Picture picture, ReadPicture(files.picture, request.view_layer));
  SCUMBLE_ASSIGN(const std::string picture_hash, HashOfFile(files.picture));
  std::optional<GuideSet> guides;
  if (!files.guides.empty() && state.required.empty()) SCUMBLE_RETURN_IF_ERROR(InspectGuides(files.guides));
  if (!files.guides.empty() && !state.required.empty()) {
    SCUMBLE_ASSIGN(guides, ReadGuides(files.guides, ReadOptions(request, state.required, files.guides, files.camera)));
    if (guides->width() != picture.width || guides->height() != picture.height) {
      return InputError(fmt::format("{} is {}×{}, its guides {} are {}×{}: render both at one size", files.picture,
                                    picture.width, picture.height, files.guides, guides->width(), guides->height()));
    }
  }
  times.emplace_back("read", watch.Lap());
  context.EndStage("read");
  const Size size{picture.width, picture.height};
  const std::vector<FinishStep> steps = FinishStepsOf(
      state.chain.passes, size, guides ? &*guides : nullptr,
      [&](const FinishRemark& remark) { state.remarks.Tell(remark, files.frame, files.guides, context); },
      &state.palette_colors);
  state.remarks.EndFrame();
  if (!state.measures && guides && EverLooksAtMeasures(state.chain))
    state.measures = MeasureAndTell(*guides, guides->layers(), {}, context);
  FinishFrame frame{guides ? &*guides : nullptr, state.measures.value_or(FinishMeasures()), 1.0, request.seed};
  const FrameRate fps = RateFor(request, files.guides);
  frame.frame = files.frame.value_or(0), frame.fps_numerator = fps.numerator, frame.fps_denominator = fps.denominator;
  if (request.reference_height > 0) frame.scale = double(picture.height) / request.reference_height;
  if (guides && ChangesGuides(steps)) {
    SCUMBLE_RETURN_IF_ERROR(ApplyToGuides(steps, frame, context.threads, {}, *guides));
  }
  FinishLayerOptions names;
  names.paint = "picture";
  SCUMBLE_ASSIGN(FinishedLayers layers,
                 FinishWithLayers(steps, frame, WantedOf(request), names, context.threads, progress, picture));
  state.palette_colors.TellNew(files.frame, context);
  times.emplace_back("finish", watch.Lap());
  context.EndStage("finish");
  PaintedPicture made;
  made.write = {request.bits, request.png_level};
  made.write.fast = request.fast_io,
  made.write.settings = SettingsText(request, state.chain, picture_hash, state.measures, !request.measures, fps);
  PictureReport report;
  report.output = files.output, report.width = picture.width, report.height = picture.height;
  report.seed = request.seed;
  for (const auto& [name, ms] : times) report.steps.push_back({name, ms, ms, ms});
  report.layers_output = files.layers;
  for (const FinishLayer& layer : layers.layers) report.layers.push_back(layer.name);
  made.report.made = std::move(report);
  made.report.memory = std::move(memory);
  made.layers.layers = std::move(layers.layers);
  if (layers.alone) made.layers.merged = std::exchange(picture, *std::move(layers.alone));
  made.picture = std::move(picture);
  return WriteOf(std::move(made), files.output, files.layers);
}

// What the passes read must be there before any frame is begun.
Status CheckLayers(const FinishRequest& request, const FinishState& state) {
  if (state.required.empty() || !request.guides.empty()) return Ok();
  std::vector<FinishStep> steps;
  for (std::size_t i = 0; i < state.chain.passes.size(); ++i) {
    for (FinishPass& moment : MomentsOf(state.chain, i)) steps.push_back({std::move(moment), {}});
  }
  return CheckFinish(steps, nullptr);
}

// The names of a sequence's files.
struct FrameNames {
  FrameName picture, guides, camera, layers;

  FrameFiles At(int frame, const std::string& output) const {
    return {frame, picture.At(frame), guides.At(frame), camera.At(frame), output, layers.At(frame)};
  }
};

Expected<FrameNames> NamesOfFrames(const FinishRequest& request) {
  FrameNames names;
  SCUMBLE_ASSIGN(names.picture, FrameName::Parse(request.picture));
  SCUMBLE_ASSIGN(names.guides, FrameName::Parse(request.guides));
  SCUMBLE_ASSIGN(names.camera, FrameName::Parse(request.camera));
  SCUMBLE_ASSIGN(names.layers, FrameName::Parse(request.layers_out));
  return names;
}

// Gives the files of a single picture their names, and refuses outputs that would overwrite what is read.
Status NameFiles(const std::optional<Sequence>& sequence, const FinishChain& chain, FinishRequest& request) {
  RunInputs inputs;
  for (const auto& [what, name] : {std::pair("the picture", &request.picture),
                                   {"the guides", &request.guides},
                                   {"the .camera file", &request.camera}}) {
    if (!sequence) {
      SCUMBLE_ASSIGN(*name, NameOfOne(*name, request.frame));
    }
    SCUMBLE_ASSIGN(const auto names, NamesOf(*name, sequence));
    for (const std::string& file : names) {
      if (!file.empty()) inputs.Reads(what, file);
    }
  }
  for (const std::string& file : FilesOf(chain.passes)) inputs.Reads("a file of a finish", file);
  for (const std::string& file : MaskFilesOf(chain.passes)) inputs.Reads("the mask of a finishing effect", file);
  if (!sequence) {
    SCUMBLE_ASSIGN(request.output, NameOfOne(request.output, request.frame));
    SCUMBLE_ASSIGN(request.layers_out, NameOfOne(request.layers_out, request.frame));
  }
  const bool resumes = sequence && sequence->resume;
  SCUMBLE_ASSIGN(const auto outputs, NamesOf(request.output, sequence));
  SCUMBLE_RETURN_IF_ERROR(inputs.CheckOutputs(outputs, "-o", resumes));
  SCUMBLE_ASSIGN(const auto layer_outputs, LayerNamesOf(request.layers_out, sequence));
  return inputs.CheckOutputs(layer_outputs, "--layers-out", resumes);
}

// Ok where the frame's output is whole, and made of the same files with the same settings.
Status CheckMade(const FinishRequest& request, const FrameFiles& files, FinishState& state) {
  const auto header = InspectPicture(files.picture);
  if (!header) return header.error();
  SCUMBLE_RETURN_IF_ERROR(SetFinishFrame(state.chain, *files.frame));
  const PictureWriteOptions write{request.bits, request.png_level};
  SCUMBLE_ASSIGN(const std::string picture_hash, HashOfFile(files.picture));
  const std::string settings =
      SettingsText(request, state.chain, picture_hash, request.measures,
                   request.measures ? std::optional<bool>() : true, RateFor(request, files.guides));
  SCUMBLE_RETURN_IF_ERROR(CheckWholePicture(files.output, {header->width, header->height, PictureChannels(files.output),
                                                           PictureBits(files.output, write), settings}));
  if (request.layers_out.empty()) return Ok();
  return CheckWholeLayers(files.layers, header->width, header->height, settings);
}

// Measures what a sequence measures on one of its frames. Where it is resumed, that may be a frame that is kept.
Status MeasureSequence(const FinishRequest& request, const std::vector<int>& frames, const FrameNames& names,
                       const RunContext& context, const Progress& progress, FinishState& state,
                       std::optional<int>& failed_at) {
  const bool looks = !state.measures && EverLooksAtMeasures(state.chain);
  const bool measures_colors = MeasuresColors(state.chain.passes);  // of what is painted, which is not written yet
  if (!looks && !measures_colors) return Ok();
  const std::string colors_option = "--set finish.NAME.from of a palette";
  const auto measure_colors = [&](int frame) -> Status {
    failed_at = frame;
    const Expected<FrameWrite> finished = Finish(request, names.At(frame, ""), context, progress, state);
    return finished ? Ok() : Status(CannotMeasure(finished.error(), frame, colors_option));
  };
  if (state.required.empty() || request.guides.empty()) return measure_colors(frames.front());
  std::string options = looks ? "--finish-measures" : "";
  if (measures_colors) options += (looks ? " and " : "") + colors_option;
  const auto guides_at = [&](int frame) {
    const std::string file = names.guides.At(frame);
    return ReadGuides(file, ReadOptions(request, state.required, file, names.camera.At(frame)));
  };
  const auto measure = [&](int frame, const GuideSet& set) -> Status {
    if (looks) state.measures = MeasureAndTell(set, set.layers(), frame, context);
    return measures_colors ? measure_colors(frame) : Ok();
  };
  FrameToMeasure choice;
  for (const int frame : frames) {
    failed_at = frame;
    const Expected<GuideSet> set = guides_at(frame);
    if (!set) {
      return CannotMeasure(set.error(), frame, IsBroken(names.guides.At(frame)) ? options : "");
    }
    if (choice.IsEnough(frame, *set)) return measure(frame, *set);
  }
  if (choice.best) {
    failed_at = choice.best;
    SCUMBLE_ASSIGN(const GuideSet set, guides_at(*choice.best));
    return measure(*choice.best, set);
  }
  failed_at.reset();
  if (looks) state.measures.emplace();
  context.Warn(NothingToMeasure(frames, options));
  return Ok();
}

Expected<RunReport> FinishPictures(FinishRequest request, const SequenceListener& listener, const RunContext& context) {
  FinishState state;
  SCUMBLE_ASSIGN(state.chain, OpenFinish(request.finishes, context));
  SCUMBLE_RETURN_IF_ERROR(SetFinish(request.sets, state.chain));
  SCUMBLE_RETURN_IF_ERROR(ReadFinishFiles(nullptr, context, state.chain.passes));
  state.required = LayersOf(state.chain), state.measures = request.measures;
  SCUMBLE_RETURN_IF_ERROR(CheckLayersWanted(WantedOf(request), state.chain.passes));
  SCUMBLE_RETURN_IF_ERROR(CheckLayers(request, state));
  for (const std::string& doubt : OrderDoubts(state.chain.passes)) context.Warn(doubt);
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(request.output, {request.bits}));
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(request.sequence, request.frame, request.output));
  SCUMBLE_RETURN_IF_ERROR(NameFiles(sequence, state.chain, request));
  RunReport report;
  if (!sequence) {
    SCUMBLE_ASSIGN(const FrameWrite write, Finish(request,
                                                  {request.frame, request.picture, request.guides, request.camera,
                                                   request.output, request.layers_out},
                                                  context, context.StartProgress("finish"), state));
    SCUMBLE_ASSIGN(report.frame, write());
    context.EndStage("write");
    return report;
  }
  SCUMBLE_ASSIGN(const FrameNames names, NamesOfFrames(request));
  SequenceWork work;
  work.check = [&](int frame, const std::string& output) { return CheckMade(request, names.At(frame, output), state); };
  work.begin = [&](std::span<const int>, const Progress& progress, std::optional<int>& failed_at) {
    return MeasureSequence(request, sequence->frames, names, context, progress, state, failed_at);
  };
  work.make = [&](int frame, const std::string& output, const Progress& progress) {
    return Finish(request, names.At(frame, output), context, progress, state);
  };
  SCUMBLE_ASSIGN(report.sequence, RunSequence(*sequence, work, listener, context, context.StartProgress("finish")));
  state.remarks.WarnOfFrames(context);
  return report;
}

}  // namespace

Expected<RunReport> RunFinish(FinishRequest request, const SequenceListener& listener, const RunContext& context) {
  return KeepWarnings(context,
                      [&](const RunContext& kept) { return FinishPictures(std::move(request), listener, kept); });
}

}  // namespace scumble
