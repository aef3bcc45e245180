#include "transfer/transfer.h"

#include <tbb/task_arena.h>

#include <cmath>

#include "image/check.h"
#include "image/stopwatch.h"
#include "transfer/compose.h"
#include "transfer/match.h"
#include "transfer/resample.h"
#include "transfer/vote.h"

namespace scumble {
namespace {

constexpr std::size_t kBruteForcePixels = 1 << 20;
constexpr int kMaxExemplarSize = 16384;

// Lengths follow the height; the seed grids are powers of two, so levels follow in whole steps, to the nearest octave.
// In integers: height / reference ≥ √2 is one level more, ≥ 2√2 two, < 1/√2 one less.
int ScaledLevels(int levels, int reference_height, int output_height) {
  if (reference_height == 0) return levels;
  const std::int64_t reference = reference_height, output = output_height;
  std::int64_t reference_squared = reference * reference, output_squared = output * output;
  for (; output_squared >= 2 * reference_squared && levels < 16; reference_squared *= 4) ++levels;
  for (; 2 * output_squared < reference_squared && levels > 1; output_squared *= 4) --levels;
  return levels;
}

int ScaledRadius(int radius, int reference_height, int output_height) {
  if (reference_height == 0) return radius;
  const double scaled = static_cast<double>(radius) * output_height / reference_height;
  // A style that blends goes on doing so in a small preview: without it patches would show hard edges there alone.
  return static_cast<int>(std::clamp(std::floor(scaled + 0.5), radius > 0 ? 1.0 : 0.0, 1024.0));
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
  const auto scaled = [&](int side) {
    return std::min(kMaxExemplarSize, ScaledSize(side, 1.0, reference_height, output_height));
  };
  return Resample(paper, scaled(paper.width), scaled(paper.height));
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
                                   SeedRules{options.seed, options.time_step, style.settings.jitter,
                                             style.settings.levels - style.levels},
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
  const internal::VoteInput votes{scratch.field, *style.exemplar, style.blend_radius, edges ? &*edges : nullptr, region};
  if (!internal::Vote(votes, out, vote_progress)) return CancelledError();
  scratch.times.vote_ms = watch.Lap();

  internal::RowProgress compose_progress(options.progress, 0.9, 1.0, rows);
  const internal::Background background{style.paper, options.over};
  if (!internal::Compose(guides, background, region, out, compose_progress)) return CancelledError();
  scratch.times.compose_ms = watch.Lap();
  return Ok();
}

}  // namespace

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
  const int size = ScaledSize(exemplar.picture.width, settings.scale, settings.reference_height, output_height);
  if (size > kMaxExemplarSize) {
    return UsageError(exemplar.name + " would be resized from " + std::to_string(exemplar.picture.width) + " to " +
                      std::to_string(size) + " pixels by transfer.scale and the output's height: at most " +
                      std::to_string(kMaxExemplarSize) + " are possible; lower transfer.scale");
  }
  PreparedStyle prepared;
  prepared.settings = settings;
  prepared.output_height = output_height;
  prepared.levels = ScaledLevels(settings.levels, settings.reference_height, output_height);
  prepared.blend_radius = ScaledRadius(settings.blend_radius, settings.reference_height, output_height);
  prepared.exemplar = std::make_shared<PreparedExemplar>(exemplar.picture, settings.rim, size);
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
  // 128 bits: frame numbers that carry a date, times a rate in thousandths, leave 64 behind.
  __extension__ using Int128 = __int128;
  const Int128 numerator = static_cast<Int128>(frame) * std::llround(jitter_fps * 1000.0) * fps_denominator;
  const Int128 denominator = static_cast<Int128>(fps_numerator) * 1000;
  const Int128 quotient = numerator / denominator;
  return static_cast<std::int64_t>(numerator % denominator < 0 ? quotient - 1 : quotient);
}

}  // namespace scumble
