#include "pipeline/frame/paint_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "core/image/stopwatch.h"
#include "core/io/atomic_file.h"
#include "core/io/picture_file.h"
#include "measure/coherence.h"
#include "pipeline/frame/explain_frame.h"
#include "pipeline/style/finish_order.h"
#include "transfer/upsample_guides.h"

namespace scumble {
namespace {

StepSpread SpreadOf(const std::string& name, std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const std::size_t half = samples.size() / 2;
  const double median = samples.size() % 2 ? samples[half] : 0.5 * (samples[half - 1] + samples[half]);
  return {name, median, samples.front(), samples.back()};
}

ChunksReport ChunksOf(const SourceField& field) {
  std::vector<std::uint8_t> covered(field.level.size());
  std::transform(field.level.begin(), field.level.end(), covered.begin(),
                 [](std::int8_t level) { return level != SourceField::kNoSource; });
  const CoherenceReport report =
      MeasureCoherence({field.width, field.height, field.x, field.y, covered, field.exemplar});
  return {report.covered, report.share, report.chunks, report.mean_chunk_area};
}

StyleInReport ReportOf(const std::string& given, const Style& style, const PreparedStyle& prepared) {
  const PreparedExemplar& exemplar = *prepared.exemplar;
  StyleInReport report{given,
                       style.name,
                       exemplar.count(),
                       exemplar.size(),
                       exemplar.width(),
                       exemplar.height(),
                       prepared.levels,
                       prepared.blend_radius,
                       {}};
  if (prepared.illumination.active()) {
    const auto luminances = prepared.illumination.luminances();
    report.luminances.assign(luminances.begin(), luminances.end());
  }
  return report;
}

// Takes the field out of `scratch`.
KeptField TakeField(const StyleSet& styles, const std::vector<PreparedStyle>& prepared, StyleMap* map,
                    TransferScratch& scratch) {
  KeptField kept;
  kept.field = std::make_shared<const SourceField>(std::exchange(scratch.field, {}));
  if (map) kept.styles = std::make_shared<const StyleMap>(std::move(*map));
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    const Style& style = styles.styles[i];
    FieldStyle one{styles.given[i], style.name, prepared[i].exemplar->width(), prepared[i].exemplar->height(), {}};
    for (const Exemplar& exemplar : style.exemplars) {
      const glm::ivec2 origin = exemplar.Origin();
      one.exemplars.push_back({exemplar.name, origin.x, origin.y, exemplar.picture.width, exemplar.picture.height});
    }
    kept.field_styles.push_back(std::move(one));
  }
  return kept;
}

bool LooksAtLightWhenPrepared(const PreparedStyle& style) {
  return style.illumination.active() || (style.space && style.space->has_radiance());
}

// The picture underneath, if one is asked for.
Expected<const Picture*> OverFor(const PictureRequest& request, const GuideSet& guides, const std::string& guides_name,
                                 PictureState& state) {
  if (request.over.empty()) return static_cast<const Picture*>(nullptr);
  SCUMBLE_RETURN_IF_ERROR(ReadOver(request, state));
  const Picture& over = *state.over;
  if (over.width != guides.width() || over.height != guides.height()) {
    return InputError(fmt::format("--over {} is {}×{}, {} {} {}×{}: render both at one size", request.over, over.width,
                                  over.height, guides_name, request.upsample > 1 ? "upsampled is" : "is",
                                  guides.width(), guides.height()));
  }
  return &over;
}

bool IsCatcher(const StyleSet& styles) {
  return std::any_of(styles.assigned.begin(), styles.assigned.end(),
                     [](const StyleSet::Assigned& one) { return one.style == StyleMap::kShadowCatcher; }) ||
         std::any_of(styles.wanted.begin(), styles.wanted.end(),
                     [](const auto& one) { return one.second == StyleMap::kShadowCatcher; });
}

// Of what was asked for and changes nothing or is likely a slip, once in a run.
void WarnOfIdleOptions(const StyleSet& styles, const PictureRequest& request, const RunContext& context,
                       PictureState& state) {
  if (state.warned) return;
  state.warned = true;
  for (const std::string& doubt : OrderDoubts(styles)) context.Warn(doubt);
  const bool lit = std::any_of(styles.styles.begin(), styles.styles.end(), LooksAtLight);
  if (request.exposure && !lit) {
    context.Warn(fmt::format("--exposure {}", *request.exposure) + " changes nothing: style " + styles.first().name +
                 " has one exemplar and no weight for light, so it does not look at it");
  }
  if (request.fast_io && !HasEnding(request.output, {".exr"})) {
    context.Warn("--fast-io changes nothing: " + request.output +
                 " is no .exr; --png-level 1 makes PNG quick to write");
  }
  const auto shadowed = std::find_if(styles.styles.begin(), styles.styles.end(),
                                     [](const Style& style) { return style.transfer.shadow != ShadowMode::kNone; });
  if (shadowed != styles.styles.end() && !IsCatcher(styles)) {
    context.Warn("transfer.shadow of style " + shadowed->name +
                 " changes nothing, and its layer costs time: no object catches shadows; give --assign "
                 "'Ground=catcher', or leave it "
                 "out");
  }
}

// A frame of another size than those before is rarely meant.
void WarnOfOtherSize(const GuideSet& guides, const std::string& name, const RunContext& context, PictureState& state) {
  if (state.width == 0) state.width = guides.width(), state.height = guides.height();
  if (state.warned_of_size || (state.width == guides.width() && state.height == guides.height())) return;
  state.warned_of_size = true;
  context.Warn(fmt::format("{} is {}×{}, the frames before it are {}×{}: its picture has another size than theirs",
                           name, guides.width(), guides.height(), state.width, state.height));
}

// The passes of a picture that is painted by `guides`, and measured by those that were `given`, before they were
// upsampled.
FrameFinish FinishOf(const StyleSet& styles, const GuideSet& given, const GuideSet& guides, const StyleMap* map,
                     bool over, std::optional<int> frame, const RunContext& context, PictureState& state) {
  FrameFinish finish;
  finish.steps = FinishStepsOf(
      styles, guides, map, over,
      [&](const FinishRemark& remark) { state.finish_remarks.Tell(remark, frame, {}, context); },
      &state.palette_colors);
  if (finish.steps.empty()) return finish;
  state.finish_remarks.EndFrame();
  finish.reference_height = styles.first().transfer.reference_height;
  MeasureFinishOf(styles, given, {}, context, state);
  if (state.finish_measures) finish.measures = *state.finish_measures;
  if (&given != &guides) finish.small_guides = &given;
  return finish;
}

// The guides of a larger picture, where one is asked for.
Expected<std::optional<GuideSet>> LargerGuides(const GuideSet& given, const PictureRequest& request, int threads) {
  if (request.upsample > 1) {
    SCUMBLE_RETURN_IF_ERROR(CheckLargerSize(given.width(), given.height(), request.upsample));
  }
  if (request.GuideFactor() == 1) return std::optional<GuideSet>();
  SCUMBLE_ASSIGN(GuideSet larger, UpsampleGuides(given, request.GuideFactor(), threads));
  return std::optional<GuideSet>(std::move(larger));
}

// What a frame is painted from, besides the prepared styles.
struct FrameInputs {
  const GuideSet& guides;
  const StyleMap* map;  // null: one style paints all
  FrameFinish finish;
  FrameSettings settings;  // without its pointers to results
};

// The time of each step in milliseconds, a value a run, in the order of the steps.
struct RunTimes {
  std::vector<std::pair<std::string, std::vector<double>>> steps;

  void Add(const std::string& step, double ms) {
    const auto found = std::find_if(steps.begin(), steps.end(), [&](const auto& one) { return one.first == step; });
    (found == steps.end() ? steps.emplace_back(step, std::vector<double>()) : *found).second.push_back(ms);
  }
  std::vector<std::pair<std::string, double>> Sums() const {
    std::vector<std::pair<std::string, double>> sums;
    for (const auto& [step, ms] : steps) sums.emplace_back(step, std::accumulate(ms.begin(), ms.end(), 0.0));
    return sums;
  }
};

// All runs make the same picture.
struct PaintedRuns {
  Picture picture;
  FinishedLayers layers;
  RunTimes times;
};

// Paints `request.repeat` times.
Expected<PaintedRuns> PaintRuns(const FrameInputs& inputs, const PictureRequest& request, const LayersWanted& wanted,
                                const RunContext& context, const Progress& progress, PictureState& state) {
  PaintedRuns painted;
  double finish_ms = 0.0;
  FrameSettings settings = inputs.settings;
  settings.finish = inputs.finish.steps.empty() ? nullptr : &inputs.finish, settings.finish_ms = &finish_ms;
  settings.layers = &painted.layers;
  for (int run = 0; run < request.repeat; ++run) {
    const double begin = double(run) / request.repeat, end = double(run + 1) / request.repeat;
    if (run + 1 == request.repeat) settings.layers_wanted = wanted;
    SCUMBLE_RETURN_IF_ERROR(PaintFrame(state.prepared, inputs.map, inputs.guides, settings, context,
                                       Within(progress, begin, end), state.scratch, painted.picture));
    painted.times.Add("match", state.scratch.times.match_ms);
    painted.times.Add("vote", state.scratch.times.vote_ms);
    painted.times.Add("compose", state.scratch.times.compose_ms);
    if (settings.finish) painted.times.Add("finish", std::exchange(finish_ms, 0.0));
    if (request.PictureFactor() == 1) continue;
    Stopwatch watch;
    painted.picture = UpscalePicture(painted.picture, request.PictureFactor(), context.threads);
    painted.times.Add("upscale", watch.Lap());
  }
  return painted;
}

// Without the times.
PictureReport ReportOf(const StyleSet& styles, const PictureRequest& request, const PaintedPicture& made,
                       const PictureState& state) {
  PictureReport report;
  report.output = request.output, report.width = made.picture.width, report.height = made.picture.height;
  report.upsample = request.upsample, report.upscale = request.upscale, report.repeat = request.repeat;
  report.seed = request.seed;
  for (std::size_t i = 0; i < state.prepared.size(); ++i) {
    report.styles.push_back(ReportOf(styles.given[i], styles.styles[i], state.prepared[i]));
  }
  if (std::any_of(state.prepared.begin(), state.prepared.end(), LooksAtLightWhenPrepared)) {
    report.exposure = state.exposure;
  }
  report.layers_output = request.layers_out;
  for (const FinishLayer& layer : made.layers.layers) report.layers.push_back(layer.name);
  if (request.measure_chunks) report.chunks = ChunksOf(state.scratch.field);
  return report;
}

}  // namespace

Expected<Picture> ReadUnderneath(const std::string& file, const std::string& view_layer) {
  auto picture = ReadPicture(file, view_layer);
  return picture || view_layer.empty() ? std::move(picture) : ReadPicture(file);
}

Status ReadOver(const PictureRequest& request, PictureState& state) {
  if (state.over && state.over_file == request.over && state.over_view_layer == request.over_view_layer) return Ok();
  state.over.reset();
  SCUMBLE_ASSIGN(state.over, ReadUnderneath(request.over, request.over_view_layer));
  state.over_file = request.over, state.over_view_layer = request.over_view_layer;
  return Ok();
}

PictureSettings SettingsOf(const PictureRequest& request, std::optional<FrameRate> fps, std::optional<double> exposure,
                           const std::string& samples, const std::string& guides) {
  return {request.seed,
          !request.over.empty(),
          request.show,
          request.upsample,
          request.upscale,
          fps,
          exposure,
          !request.exposure,
          samples,
          request.show_finish,
          {},
          {},
          guides};
}

std::string SamplesAsked(const std::map<std::string, std::string>& attributes) {
  const auto found = attributes.find(kSamplesKey);
  if (found == attributes.end()) return "";
  // Guides may come from anywhere.
  return found->second.find_first_not_of("0123456789-") == std::string::npos ? found->second : "";
}

Expected<PaintedPicture> PaintInMemory(StyleSet& styles, const GuideSet& given, const GuideSource& source,
                                       const PictureRequest& request, const RunContext& context,
                                       const Progress& progress, PictureState& state) {
  StepTimes times = source.times;
  Stopwatch watch;
  WarnOfOtherSize(given, source.name, context, state);
  SCUMBLE_ASSIGN(const std::optional<GuideSet> larger, LargerGuides(given, request, context.threads));
  if (larger) times.emplace_back("upsample", watch.Lap());
  const GuideSet& guides = larger ? *larger : given;
  SCUMBLE_ASSIGN(const Picture* const over, OverFor(request, guides, source.name, state));
  if (over) times.emplace_back("over", watch.Lap());
  SCUMBLE_RETURN_IF_ERROR(PrepareFrame(styles, given, request, context, state));
  WarnOfIdleOptions(styles, request, context, state);
  StyleMap map;
  const bool needs_map = styles.NeedsMap(guides, source.name);
  if (needs_map) {
    SCUMBLE_ASSIGN(map, MapStyles(styles, guides, source.name));
  }
  times.emplace_back("prepare", watch.Lap());
  context.EndStage("prepare");
  const LayersWanted wanted{request.show_finish, !request.layers_out.empty()};
  SCUMBLE_RETURN_IF_ERROR(CheckLayersWanted(wanted, AllPasses(styles)));

  FrameInputs inputs{guides, needs_map ? &map : nullptr, {}, {}};
  inputs.finish = FinishOf(styles, given, guides, inputs.map, over != nullptr, request.frame, context, state);
  inputs.settings = {request.seed, request.frame.value_or(0), RateOf(request.fps, given), *state.exposure,
                     over,         request.KeepsField()};
  SCUMBLE_ASSIGN(PaintedRuns painted, PaintRuns(inputs, request, wanted, context, progress, state));
  state.palette_colors.TellNew(request.frame, context);
  PaintedPicture made;
  made.layers.layers = std::move(painted.layers.layers);
  if (wanted.all && request.IsShowing()) made.layers.merged = painted.picture;
  if (request.show) {
    painted.picture =
        Show(*request.show, {state.prepared, map, guides, state.scratch.field, *state.exposure, painted.picture});
  }
  if (painted.layers.alone) painted.picture = *std::move(painted.layers.alone);
  made.picture = std::move(painted.picture);
  context.EndStage("transfer", painted.times.Sums());

  made.write = {request.bits, request.png_level};
  made.write.fast = request.fast_io;
  PictureSettings made_with = SettingsOf(request, inputs.settings.fps, state.exposure, SamplesAsked(given.attributes),
                                         GuidesText(given.attributes, source.chosen));
  if (state.finish_measures) made_with.finish_measures = MeasuresText(*state.finish_measures);
  made_with.finish_measured = !styles.options.finish_measures;
  made.write.settings = SettingsText(styles, made_with, state.hashes);
  PictureReport report = ReportOf(styles, request, made, state);
  for (const auto& [name, ms] : times) report.steps.push_back({name, ms, ms, ms});
  for (const auto& [name, ms] : painted.times.steps) report.steps.push_back(SpreadOf(name, ms));
  made.report = {std::move(report), source.plan, source.memory, source.cost, 0, 0.0};
  if (request.keep_field) made.kept = TakeField(styles, state.prepared, needs_map ? &map : nullptr, state.scratch);
  return made;
}

FrameWrite WriteOf(PaintedPicture painted, const std::string& output, const std::string& layers_out) {
  const auto made = std::make_shared<PaintedPicture>(std::move(painted));
  return [made, output, layers_out]() -> Expected<FrameReport> {
    Stopwatch watch;
    const std::uint64_t before = BytesWrittenByThisThread();
    if (!layers_out.empty()) {
      PaintedLayers& layers = made->layers;
      SCUMBLE_RETURN_IF_ERROR(WriteLayers(layers_out, std::move(layers.layers),
                                          layers.merged ? *layers.merged : made->picture, made->write.settings));
    }
    SCUMBLE_RETURN_IF_ERROR(WritePicture(output, made->picture, made->write));
    FrameReport report = std::move(made->report);
    const double ms = report.write_ms = watch.Lap();
    std::get<PictureReport>(report.made).steps.push_back({"write", ms, ms, ms});
    report.bytes_written = BytesWrittenByThisThread() - before;
    return report;
  };
}

Expected<FrameWrite> PaintPicture(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                                  const PictureRequest& request, const RunContext& context, const Progress& progress,
                                  PictureState& state) {
  SCUMBLE_ASSIGN(PaintedPicture painted, PaintInMemory(styles, guides, source, request, context, progress, state));
  return WriteOf(std::move(painted), request.output, request.layers_out);
}

}  // namespace scumble
