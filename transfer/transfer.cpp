#include "transfer/transfer.h"

#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>

#include "image/check.h"
#include "transfer/compose.h"
#include "transfer/match.h"
#include "transfer/resample.h"
#include "transfer/vote.h"

namespace scumble {
namespace {

constexpr std::size_t kBruteForcePixels = 1 << 20;

class Stopwatch {
 public:
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// Lengths follow the height; the seed grids are powers of two, so levels follow in whole steps.
int ScaledLevels(int levels, int reference_height, int output_height) {
  if (reference_height == 0) return levels;
  const double octaves = std::log2(static_cast<double>(output_height) / reference_height);
  return std::clamp(levels + static_cast<int>(std::floor(octaves + 0.5)), 1, 16);
}

int ScaledRadius(int radius, int reference_height, int output_height) {
  if (reference_height == 0) return radius;
  const double scaled = static_cast<double>(radius) * output_height / reference_height;
  return static_cast<int>(std::min(std::floor(scaled + 0.5), 1024.0));
}

Status CheckSettings(const TransferSettings& settings) {
  if (!(settings.threshold >= 0.0f)) return UsageError("transfer.threshold must be 0 or more, infinity included");
  if (settings.levels < 1 || settings.levels > 16) return UsageError("transfer.levels must be 1 to 16");
  if (!(settings.jitter >= 0.0f && settings.jitter <= 1.0f)) return UsageError("transfer.jitter must be 0 to 1");
  if (settings.blend_radius < 0 || settings.blend_radius > 64) {
    return UsageError("transfer.blend_radius must be 0 to 64");
  }
  if (!(settings.scale > 0.0 && settings.scale <= 64.0)) return UsageError("transfer.scale must be above 0, at most 64");
  if (!(settings.rim >= 0.0 && std::isfinite(settings.rim))) return UsageError("transfer.rim must be 0 or more");
  if (settings.reference_height < 0) return UsageError("transfer.reference_height must be 0 or more");
  return Ok();
}

Picture ScaledPaper(const Picture& paper, int reference_height, int output_height) {
  return Resample(paper, ScaledSize(paper.width, 1.0, reference_height, output_height),
                  ScaledSize(paper.height, 1.0, reference_height, output_height));
}

Status CheckInputs(const PreparedStyle& style, const GuideSet& guides, const TransferOptions& options) {
  const LayerSet required = RequiredLayers(style.settings);
  for (const LayerInfo& info : AllLayers()) {
    if (required.Has(info.layer) && !guides.Has(info.layer)) {
      return InputError("the style needs layer " + std::string(info.name) + "; the guides hold " +
                        guides.layers().ToString());
    }
  }
  SCUMBLE_CHECK_EQ(guides.height(), style.output_height);
  if (options.over && (options.over->width != guides.width() || options.over->height != guides.height())) {
    return InputError("the picture underneath is " + std::to_string(options.over->width) + "×" +
                      std::to_string(options.over->height) + ", the guides are " + std::to_string(guides.width()) +
                      "×" + std::to_string(guides.height()) + ": render both at one size");
  }
  if (style.settings.method == Method::kBruteForce && guides.pixel_count() > kBruteForcePixels) {
    return UsageError("method bruteforce takes time quadratic in the pixels and is meant for pictures of at most " +
                      std::to_string(kBruteForcePixels) + " pixels; use styleblit");
  }
  return Ok();
}

bool Match(const PreparedStyle& style, const internal::MatchInput& input, SourceField& field,
           internal::RowProgress& progress) {
  switch (style.settings.method) {
    case Method::kLitSphere: return internal::MatchLitSphere(input, field, progress);
    case Method::kStyleBlit: return internal::MatchStyleBlit(input, field, progress);
    case Method::kBruteForce: return internal::MatchBruteForce(input, field, progress);
  }
  return false;
}

Status TransferInArena(const PreparedStyle& style, const GuideSet& guides, const TransferOptions& options,
                       TransferScratch& scratch, Picture& out) {
  const int width = guides.width(), height = guides.height();
  const Region whole{0, 0, width, height};
  const Region region = options.region ? options.region->GrownBy(0, width, height) : whole;
  // Chunks of the brute force depend on every pixel above them, so it always runs over the whole picture.
  const Region matched = style.settings.method == Method::kBruteForce
                             ? whole
                             : region.GrownBy(style.blend_radius, width, height);
  const internal::MatchInput input{guides,
                                   *style.exemplar,
                                   GuideTest(style.settings.threshold, style.settings.threshold_metric),
                                   SeedRules{options.seed, options.time_step, style.settings.jitter},
                                   style.levels,
                                   matched};
  Stopwatch watch;
  scratch.field.Reset(width, height);
  if (out.width != width || out.height != height || !options.region) out = Picture(width, height);
  internal::RowProgress match_progress(options.progress, 0.0, 0.6, std::max(1, matched.y1 - matched.y0));
  if (!Match(style, input, scratch.field, match_progress)) return CancelledError();
  scratch.times.match_ms = watch.Lap();

  std::optional<internal::EdgeTest> edges;
  if (style.settings.edge_aware && style.blend_radius > 0) edges.emplace(guides);
  const int rows = std::max(1, region.y1 - region.y0);
  internal::RowProgress vote_progress(options.progress, 0.6, 0.9, rows);
  if (!internal::Vote(scratch.field, *style.exemplar, style.blend_radius, edges ? &*edges : nullptr, region, out,
                      vote_progress)) {
    return CancelledError();
  }
  scratch.times.vote_ms = watch.Lap();

  internal::RowProgress compose_progress(options.progress, 0.9, 1.0, rows);
  if (!internal::Compose(guides, style.paper, options.over, region, out, compose_progress)) return CancelledError();
  scratch.times.compose_ms = watch.Lap();
  return Ok();
}

}  // namespace

LayerSet RequiredLayers(const TransferSettings& settings) {
  LayerSet layers{Layer::kCoverage, Layer::kNormal};
  if (settings.edge_aware && settings.blend_radius > 0) layers.Add(Layer::kDepth).Add(Layer::kObject);
  return layers;
}

Expected<PreparedStyle> Prepare(const Style& style, int output_height) {
  SCUMBLE_RETURN_IF_ERROR(CheckSettings(style.transfer));
  if (style.exemplars.size() != 1) {
    return UnavailableError("style " + style.name + " has " + std::to_string(style.exemplars.size()) +
                            " exemplars; this version takes exactly one");
  }
  const Exemplar& exemplar = style.exemplars.front();
  if (exemplar.picture.empty() || exemplar.picture.width != exemplar.picture.height) {
    return InputError(exemplar.name + " is " + std::to_string(exemplar.picture.width) + "×" +
                      std::to_string(exemplar.picture.height) + ": an exemplar is a square that its sphere fills");
  }
  const TransferSettings& settings = style.transfer;
  PreparedStyle prepared;
  prepared.settings = settings;
  prepared.output_height = output_height;
  prepared.levels = ScaledLevels(settings.levels, settings.reference_height, output_height);
  prepared.blend_radius = ScaledRadius(settings.blend_radius, settings.reference_height, output_height);
  prepared.exemplar = std::make_shared<PreparedExemplar>(
      exemplar.picture, settings.rim,
      ScaledSize(exemplar.picture.width, settings.scale, settings.reference_height, output_height));
  prepared.paper = style.paper;
  if (style.paper.picture) {
    prepared.paper.picture = ScaledPaper(*style.paper.picture, settings.reference_height, output_height);
  }
  return prepared;
}

Status Transfer(const PreparedStyle& style, const GuideSet& guides, const TransferOptions& options,
                TransferScratch& scratch, Picture& out) {
  SCUMBLE_RETURN_IF_ERROR(CheckInputs(style, guides, options));
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return TransferInArena(style, guides, options, scratch, out); });
}

std::int64_t JitterStep(double jitter_fps, std::int64_t frame, std::int64_t fps_numerator,
                        std::int64_t fps_denominator) {
  if (jitter_fps < 0.0) return frame;
  const std::int64_t numerator = frame * std::llround(jitter_fps * 1000.0) * fps_denominator;
  const std::int64_t denominator = fps_numerator * 1000;
  const std::int64_t quotient = numerator / denominator;
  return numerator % denominator < 0 ? quotient - 1 : quotient;
}

}  // namespace scumble
