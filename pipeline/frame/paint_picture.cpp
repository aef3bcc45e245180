#include "pipeline/frame/paint_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "core/image/painting/soft_edge.h"
#include "core/image/stopwatch.h"
#include "core/io/file/atomic_file.h"
#include "core/io/picture_file.h"
#include "core/style/finish_keys.h"
#include "core/style/place_sphere.h"
#include "core/style/style_keyframes.h"
#include "core/style/style_keys.h"
#include "measure/mosaic/coherence.h"
#include "measure/painting/paint_faults.h"
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

Expected<PreparedStyle> PrepareAndWarn(const Style& style, int height, const RunContext& context) {
  SCUMBLE_ASSIGN(PreparedStyle prepared, PrepareStyle(style, height, context));
  if (style.transfer.edge == EdgeMode::kExemplar && prepared.rims.empty()) {
    context.Warn(
        "style " + style.name +
        ": transfer.edge is \"exemplar\", but the exemplar has no painted edge, because its paint does not end "
        "near the rim on bare paper; outlines stay exact. Leave paper free in the corners, or set it to \"exact\"");
  }
  return prepared;
}

// Of exemplars that are used otherwise than as they stand in their files.
void NoteExemplarUse(const Style& style, const RunContext& context) {
  for (const Exemplar& exemplar : style.exemplars) {
    if (exemplar.cut) context.Note(exemplar.name + ": " + DescribeCut(*exemplar.cut));
    const int soft_edge = exemplar.is_sphere ? SoftEdge(exemplar.picture) : 0;
    if (soft_edge > style.transfer.rim) {
      context.Warn(fmt::format("{}: {}; accept this with --set transfer.rim={}, or flatten the picture on its paper",
                               exemplar.name, DescribeSoftEdge(soft_edge), soft_edge));
    }
  }
}

// The passes of a picture that is painted by `guides`, and measured by those that were `given`, before they were
// upsampled.
FrameFinish FinishOf(const StyleSet& styles, const GuideSet& given, const GuideSet& guides, const StyleMap* map,
                     bool over, std::optional<int> frame, const RunContext& context, PictureState& state) {
  FrameFinish finish;
  finish.steps = FinishStepsOf(styles, guides, map, over, [&](const FinishRemark& remark) {
    state.finish_remarks.Tell(remark, frame, {}, context);
  });
  if (finish.steps.empty()) return finish;
  state.finish_remarks.EndFrame();
  finish.reference_height = styles.first().transfer.reference_height;
  MeasureFinishOf(styles, given, {}, context, state);
  if (state.finish_measures) finish.measures = *state.finish_measures;
  if (&given != &guides) finish.small_guides = &given;
  return finish;
}

LayerSet LayersRead(const StyleSet& styles) {
  LayerSet read = LayersOverTime(styles.finish);
  for (const Style& style : styles.styles) {
    if (const Expected<LayerSet> of_style = LayersOverTime(style)) read.Add(*of_style);
  }
  return read;
}

}  // namespace

void MeasureFinishOf(const StyleSet& styles, const GuideSet& guides, std::optional<int> frame,
                     const RunContext& context, PictureState& state) {
  if (state.finish_measures || !EverLooksAtMeasures(styles)) return;
  state.finish_measures = styles.options.finish_measures;
  if (!state.finish_measures) state.finish_measures = MeasureAndTell(guides, LayersRead(styles), frame, context);
}

Expected<Picture> ReadUnderneath(const std::string& file, const std::string& view_layer) {
  auto picture = ReadPicture(file, view_layer);
  return picture || view_layer.empty() ? std::move(picture) : ReadPicture(file);
}

Status ReadOver(const PictureRequest& request, PictureState& state) {
  if (state.over && state.over_file == request.over) return Ok();
  state.over.reset();
  SCUMBLE_ASSIGN(state.over, ReadUnderneath(request.over, request.over_view_layer));
  state.over_file = request.over;
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

bool IsReadEachFrame(const std::string& key) {
  if (key.rfind(kFinishKeys, 0) == 0) return true;
  const StyleKey* const found = FindStyleKey(key);
  return found && !found->needs_preparing;
}

Status PrepareFrame(StyleSet& styles, const GuideSet& guides, const PictureRequest& request, const RunContext& context,
                    PictureState& state) {
  const int height = guides.height() * request.GuideFactor();
  const bool all = state.prepared.empty() || state.prepared.front().output_height != height;
  SCUMBLE_RETURN_IF_ERROR(SetFinishFrame(styles.finish, request.frame.value_or(0)));
  for (std::size_t i = 0; i < styles.styles.size(); ++i) {
    SCUMBLE_ASSIGN(const auto changed, SetStyleFrame(styles.styles[i], request.frame.value_or(0)));
    if (all || changed.empty() || i >= state.prepared.size()) continue;
    if (std::all_of(changed.begin(), changed.end(), IsReadEachFrame)) {
      state.prepared[i].settings = styles.styles[i].transfer;
      state.prepared[i].required = TransferLayers(styles.styles[i]);
      continue;
    }
    Expected<PreparedStyle> one = PrepareAndWarn(styles.styles[i], height, context);
    if (!one) {
      state.prepared.resize(i);  // the style has moved on: what was prepared of it is stale
      return std::move(one).error();
    }
    state.prepared[i] = *std::move(one);
  }
  if (all) state.prepared.clear();
  // All of them, or those that the scene has asked for since.
  for (std::size_t i = state.prepared.size(); i < styles.styles.size(); ++i) {
    SCUMBLE_RETURN_IF_ERROR(context.CheckNotCancelled());
    SCUMBLE_ASSIGN(PreparedStyle one, PrepareAndWarn(styles.styles[i], height, context));
    NoteExemplarUse(styles.styles[i], context);
    for (const auto& [image, what, fix] : EqualLights(styles.styles[i], one)) {
      context.Warn(image + " " + what + ": " + fix);
    }
    state.prepared.push_back(std::move(one));
  }
  if (state.exposure) return Ok();
  state.exposure = ExposureOf(request.exposure, state.prepared, guides, context.threads);
  if (!MeasuresExposure(styles, request)) return Ok();
  if (CoveredShare(guides) == 0.0) {
    context.Warn(
        "the picture shows no surface, so no exposure was measured, and it is 0 stops: where it is one of a sequence, "
        "give --exposure of a frame that shows something");
  } else {
    context.Note(fmt::format("exposure: {:.2f} stops; --exposure {:.2f} repeats it", *state.exposure, *state.exposure));
  }
  return Ok();
}

std::vector<EqualLight> EqualLights(const Style& style, const PreparedStyle& prepared) {
  std::vector<EqualLight> equal;
  const auto luminances = prepared.illumination.luminances();
  for (std::size_t later = 1; later < luminances.size(); ++later) {
    const auto first = std::find(luminances.begin(), luminances.begin() + std::ptrdiff_t(later), luminances[later]);
    const auto index = static_cast<std::size_t>(first - luminances.begin());
    if (index == later) continue;
    equal.push_back(
        {style.exemplars[later].name,
         fmt::format("has the luminance {:.4g} as {} has, which stands first and is taken, so it never shows",
                     luminances[later], style.exemplars[index].name),
         "give each [[exemplar]] its own"});
  }
  return equal;
}

std::string DescribeLuminance(const Exemplar& exemplar, double rim) {
  const bool by_guides = exemplar.guides && exemplar.guides->Has(Layer::kLuminance);
  const char* const source = exemplar.luminance ? "given"
                             : by_guides        ? "measured from its guides"
                                                : "measured from its paint";
  return fmt::format("luminance {:.4g}, {}", LuminanceOf(exemplar, rim), source);
}

bool MeasuresExposure(const StyleSet& styles, const PictureRequest& request) {
  return !request.exposure && std::any_of(styles.styles.begin(), styles.styles.end(), LooksAtLight);
}

Expected<PaintedPicture> PaintInMemory(StyleSet& styles, const GuideSet& given, const GuideSource& source,
                                       const PictureRequest& request, const RunContext& context,
                                       const Progress& progress, PictureState& state) {
  StepTimes times = source.times;
  Stopwatch watch;
  WarnOfOtherSize(given, source.name, context, state);
  if (request.upsample > 1) {
    SCUMBLE_RETURN_IF_ERROR(CheckLargerSize(given.width(), given.height(), request.upsample));
  }
  std::optional<GuideSet> larger;
  if (request.GuideFactor() > 1) {
    SCUMBLE_ASSIGN(larger, UpsampleGuides(given, request.GuideFactor(), context.threads));
    times.emplace_back("upsample", watch.Lap());
  }
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

  const FrameFinish finish =
      FinishOf(styles, given, guides, needs_map ? &map : nullptr, over != nullptr, request.frame, context, state);
  double finish_ms = 0.0;
  FrameSettings settings{request.seed, request.frame.value_or(0), RateOf(request.fps, given), *state.exposure,
                         over,         request.KeepsField()};
  settings.finish = finish.steps.empty() ? nullptr : &finish, settings.finish_ms = &finish_ms;
  FinishedLayers layers;
  settings.layers = &layers;
  TransferScratch& scratch = state.scratch;
  Picture picture;
  std::vector<double> match, vote, compose, finished, upscale;
  for (int run = 0; run < request.repeat; ++run) {
    const double begin = double(run) / request.repeat, end = double(run + 1) / request.repeat;
    if (run + 1 == request.repeat) settings.layers_wanted = wanted;
    SCUMBLE_RETURN_IF_ERROR(PaintFrame(state.prepared, needs_map ? &map : nullptr, guides, settings, context,
                                       Within(progress, begin, end), scratch, picture));
    match.push_back(scratch.times.match_ms);
    vote.push_back(scratch.times.vote_ms);
    compose.push_back(scratch.times.compose_ms);
    finished.push_back(std::exchange(finish_ms, 0.0));
    if (request.PictureFactor() == 1) continue;
    watch.Lap();
    picture = UpscalePicture(picture, request.PictureFactor(), context.threads);
    upscale.push_back(watch.Lap());
  }
  PaintedPicture made;
  made.layers.layers = std::move(layers.layers);
  if (wanted.all && request.IsShowing()) made.layers.merged = picture;
  if (request.show)
    picture = Show(*request.show, {state.prepared, map, guides, scratch.field, settings.exposure, picture});
  if (layers.alone) picture = *std::move(layers.alone);
  const auto sum = [](const std::vector<double>& ms) { return std::accumulate(ms.begin(), ms.end(), 0.0); };
  std::vector<std::pair<std::string, double>> inside{
      {"match", sum(match)}, {"vote", sum(vote)}, {"compose", sum(compose)}};
  if (!finish.steps.empty()) inside.emplace_back("finish", sum(finished));
  if (!upscale.empty()) inside.emplace_back("upscale", sum(upscale));
  context.EndStage("transfer", inside);

  made.write = {request.bits, request.png_level};
  made.write.fast = request.fast_io;
  PictureSettings made_with = SettingsOf(request, settings.fps, settings.exposure, SamplesAsked(given.attributes),
                                         GuidesText(given.attributes, source.chosen));
  if (state.finish_measures) made_with.finish_measures = MeasuresText(*state.finish_measures);
  made_with.finish_measured = !styles.options.finish_measures;
  made.write.settings = SettingsText(styles, made_with, state.hashes);
  PictureReport report{request.output,
                       picture.width,
                       picture.height,
                       request.upsample,
                       request.upscale,
                       request.repeat,
                       request.seed,
                       {},
                       {},
                       {},
                       {}};
  for (std::size_t i = 0; i < state.prepared.size(); ++i) {
    report.styles.push_back(ReportOf(styles.given[i], styles.styles[i], state.prepared[i]));
  }
  if (std::any_of(state.prepared.begin(), state.prepared.end(), LooksAtLightWhenPrepared)) {
    report.exposure = settings.exposure;
  }
  report.layers_output = request.layers_out;
  for (const FinishLayer& layer : made.layers.layers) report.layers.push_back(layer.name);
  if (request.measure_chunks) report.chunks = ChunksOf(scratch.field);
  for (const auto& [name, ms] : times) report.steps.push_back({name, ms, ms, ms});
  report.steps.push_back(SpreadOf("match", match));
  report.steps.push_back(SpreadOf("vote", vote));
  report.steps.push_back(SpreadOf("compose", compose));
  if (!finish.steps.empty()) report.steps.push_back(SpreadOf("finish", finished));
  if (!upscale.empty()) report.steps.push_back(SpreadOf("upscale", upscale));
  made.report = {std::move(report), source.plan, source.memory, source.cost, 0, 0.0};
  if (request.keep_field) made.kept = TakeField(styles, state.prepared, needs_map ? &map : nullptr, scratch);
  made.picture = std::move(picture);
  return made;
}

Expected<FrameWrite> PaintPicture(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                                  const PictureRequest& request, const RunContext& context, const Progress& progress,
                                  PictureState& state) {
  SCUMBLE_ASSIGN(PaintedPicture painted, PaintInMemory(styles, guides, source, request, context, progress, state));
  const auto made = std::make_shared<PaintedPicture>(std::move(painted));
  return FrameWrite([made, output = request.output, layers_out = request.layers_out]() -> Expected<FrameReport> {
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
  });
}

}  // namespace scumble
