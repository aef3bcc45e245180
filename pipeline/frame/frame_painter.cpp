#include "pipeline/frame/frame_painter.h"

#include <utility>

#include "core/image/stopwatch.h"
#include "pipeline/machine/file_cache.h"

namespace scumble {

Expected<PreparedStyle> PrepareStyle(const Style& style, int height, const RunContext& context) {
  FileCache cache(context.cache_folder);
  PrepareOptions options;
  options.cache = &cache;
  options.threads = context.threads;
  options.is_cancelled = context.is_cancelled;
  return Prepare(style, height, options);
}

double ExposureOf(std::optional<double> given, std::span<const PreparedStyle> prepared, const GuideSet& guides,
                  int threads) {
  return given ? *given : MeasureExposure(prepared, guides, threads).value_or(0.0);
}

FrameRate RateOf(std::optional<FrameRate> given, const GuideSet& guides) {
  if (given) return *given;
  const auto told = guides.attributes.find("scumble:fps");
  if (told != guides.attributes.end()) {
    if (const auto rate = ParseFrameRate(told->second)) return *rate;  // guides may come from anywhere
  }
  return FrameRate();
}

namespace {

constexpr double kTransferShare = 0.7;  // of a frame's time that has a finish

FinishFrame FrameOf(const FrameSettings& settings, const GuideSet& guides) {
  const FrameFinish& finish = *settings.finish;
  FinishFrame frame{&guides, finish.measures, 1.0, settings.seed};
  frame.frame = settings.frame;
  frame.fps_numerator = settings.fps.numerator, frame.fps_denominator = settings.fps.denominator;
  if (!ChangesGuides(finish.steps)) frame.small_guides = finish.small_guides;  // which no pass has changed
  if (finish.reference_height > 0) frame.scale = double(guides.height()) / finish.reference_height;
  return frame;
}

Status Paint(std::span<const PreparedStyle> prepared, const StyleMap* map, const GuideSet& guides,
             const FrameSettings& settings, const RunContext& context, const Progress& progress,
             TransferScratch& scratch, Picture& picture) {
  TransferOptions options;
  options.seed = settings.seed;
  options.frame = settings.frame;
  options.fps_numerator = settings.fps.numerator, options.fps_denominator = settings.fps.denominator;
  options.exposure = settings.exposure;
  options.threads = context.threads;
  options.over = settings.over;
  options.keep_field = settings.keep_field;
  options.progress = settings.finish ? Within(progress, 0.0, kTransferShare) : progress;
  options.bare = options.keep_colors = settings.finish != nullptr;
  if (!map) {
    SCUMBLE_RETURN_IF_ERROR(Transfer(prepared.front(), guides, options, scratch, picture));
  } else {
    std::vector<const PreparedStyle*> pointers;
    for (const PreparedStyle& one : prepared) pointers.push_back(&one);
    SCUMBLE_RETURN_IF_ERROR(Transfer(pointers, *map, guides, options, scratch, picture));
  }
  if (!settings.finish) return Ok();
  Stopwatch watch;
  const FrameFinish& finish = *settings.finish;
  FinishFrame frame = FrameOf(settings, guides);
  frame.colors = &scratch.colors;
  frame.strokes = scratch.strokes;
  FinishLayerOptions names;
  if (settings.over) names.ground = "picture underneath";
  names.put_ground = [&](Picture& painted) {
    return PutBackground(prepared.front(), settings.over, context.threads, painted);
  };
  SCUMBLE_ASSIGN(FinishedLayers layers,
                 FinishWithLayers(finish.steps, frame, settings.layers_wanted, names, context.threads,
                                  Within(progress, kTransferShare, 1.0), picture));
  if (settings.layers) *settings.layers = std::move(layers);
  if (settings.finish_ms) *settings.finish_ms += watch.Lap();
  return Ok();
}

}  // namespace

Status PaintFrame(std::span<const PreparedStyle> prepared, const StyleMap* map, const GuideSet& guides,
                  const FrameSettings& settings, const RunContext& context, const Progress& progress,
                  TransferScratch& scratch, Picture& picture) {
  if (!settings.finish || !ChangesGuides(settings.finish->steps)) {
    return Paint(prepared, map, guides, settings, context, progress, scratch, picture);
  }
  Stopwatch watch;
  GuideSet changed = guides;
  SCUMBLE_RETURN_IF_ERROR(
      ApplyToGuides(settings.finish->steps, FrameOf(settings, guides), context.threads, {}, changed));
  if (settings.finish_ms) *settings.finish_ms += watch.Lap();
  return Paint(prepared, map, changed, settings, context, progress, scratch, picture);
}

}  // namespace scumble
