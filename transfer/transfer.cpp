#include "transfer/transfer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "core/image/check.h"
#include "core/image/exact_math.h"
#include "core/image/jitter_rate.h"
#include "core/image/stopwatch.h"
#include "transfer/frame/band_pipeline.h"
#include "transfer/frame/compose.h"
#include "transfer/frame/fragment_paint.h"
#include "transfer/frame/frame_setup.h"
#include "transfer/match/coarse_match.h"
#include "transfer/match/match.h"
#include "transfer/rim/painted_edge.h"
#include "transfer/shadow/cast_shadows.h"
#include "transfer/tint/colorize.h"
#include "transfer/vote/tone_texture_split.h"
#include "transfer/vote/vote.h"

namespace scumble {
namespace {

// The memory that threads may use for seeds; see SeedsOfBandsFit.
constexpr std::size_t kLeastSeedBytes = 64 << 20, kSeedBytesOfAPixel = 16;

// The time of one style's steps, as shares of it.
constexpr double kMatchShare = 0.6;    // the other steps are votes, with their tint
constexpr double kComposeShare = 0.1;  // of the whole

Status CheckInputs(std::span<const PreparedStyle* const> styles, const StyleMap* map, const GuideSet& guides,
                   const TransferOptions& options) {
  for (const PreparedStyle* style : styles) {
    for (const LayerInfo& info : AllLayers()) {
      if (style->required.Has(info.layer) && !guides.Has(info.layer)) {
        return InputError("the style needs layer " + std::string(info.name) + "; the guides hold " +
                          guides.layers().ToString());
      }
    }
    SCUMBLE_CHECK_EQ(guides.height(), style->output_height);
    if (style->settings.method == Method::kBruteForce && guides.pixel_count() > kMostBruteForcePixels) {
      return UsageError("method bruteforce takes time quadratic in the pixels and is meant for pictures of at most " +
                        std::to_string(kMostBruteForcePixels) + " pixels; use styleblit");
    }
  }
  if (map) SCUMBLE_CHECK_EQ(map->style.size(), guides.pixel_count());
  if (options.over && (options.over->width != guides.width() || options.over->height != guides.height())) {
    return InputError("the picture underneath is " + std::to_string(options.over->width) + "×" +
                      std::to_string(options.over->height) + ", the guides are " + std::to_string(guides.width()) +
                      "×" + std::to_string(guides.height()) + ": render both at one size");
  }
  return Ok();
}

// Styles are painted one after the other, each as if alone.
class Run {
 public:
  Run(const StyleMap* map, std::size_t styles, const GuideSet& guides, const TransferOptions& options,
      TransferScratch& scratch, Picture& out)
      : map_(map),
        guides_(guides),
        options_(options),
        scratch_(scratch),
        out_(out),
        region_(options.region ? options.region->GrownBy(0, guides.width(), guides.height())
                               : Region{0, 0, guides.width(), guides.height()}),
        frame_{guides, map, styles, region_},
        fragments_(frame_) {
    scratch.times = {}, scratch.colors = {}, scratch.strokes = {};
  }

  Status PaintAll(std::span<const PreparedStyle* const> styles) {
    if (GoesByBands(styles)) return PaintByBands(styles);
    Stopwatch watch;
    start_ = internal::StartFrame(frame_, scratch_.field, scratch_.active, out_);
    scratch_.times.compose_ms += watch.Lap();
    const double share = (1.0 - kComposeShare) / static_cast<double>(styles.size());
    for (std::size_t s = 0; s < styles.size(); ++s) {
      const double from = share * static_cast<double>(s);
      SCUMBLE_RETURN_IF_ERROR(Paint(*styles[s], static_cast<int>(s), from, from + share));
    }
    return Ok();
  }

  Status Finish(std::span<const PreparedStyle* const> styles) {
    Stopwatch watch;
    const bool shadows = styles.front()->shadow && map_;
    if (shadows) SCUMBLE_RETURN_IF_ERROR(PaintShadows(*styles.front()));
    if (!fragments_.empty()) {
      fragments_.Mix(out_, options_.keep_colors ? &scratch_.colors : nullptr);
      start_.softly_covered = true;  // the mixed pixels may be, whatever paints their centres
    }
    std::span<const float> coverage = guides_.Plane(Layer::kCoverage);
    std::vector<float> edged;
    if (std::any_of(styles.begin(), styles.end(), [](const PreparedStyle* style) { return !style->rims.empty(); })) {
      edged.assign(coverage.begin(), coverage.end());
      SCUMBLE_RETURN_IF_ERROR(PaintEdges(styles, edged));
      coverage = edged;
    }
    const double from = 1.0 - (edged.empty() ? kComposeShare : kComposeShare / 2);
    internal::RowProgress progress(options_.progress, from, 1.0, std::max(1, region_.y1 - region_.y0));
    const Paper none;
    const internal::Background background{options_.bare ? none : styles.front()->paper,
                                          options_.bare ? nullptr : options_.over};
    if (background.empty() && !shadows && edged.empty() && !start_.softly_covered) {
      // There is no background and no soft coverage, and unpainted pixels are clear already.
      progress.Finished(std::max(1, region_.y1 - region_.y0));
      return progress.cancelled() ? CancelledError() : Ok();
    }
    if (!internal::Compose(coverage, background, region_, out_, progress)) return CancelledError();
    scratch_.times.compose_ms += watch.Lap();
    return Ok();
  }

 private:
  // Whether only the votes need the sources, and only those of a few rows at a time. The seeds of many styles and
  // threads must not take more memory than the field that is saved.
  bool SeedsOfBandsFit(std::size_t styles) const {
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    const std::size_t columns = static_cast<std::size_t>(guides_.width()) / internal::kTileWidth + 1;
    return styles <= internal::kMostBandStyles &&
           threads * styles * columns * internal::kBandSeedBytes <=
               std::max(kLeastSeedBytes, kSeedBytesOfAPixel * guides_.pixel_count());
  }

  bool GoesByBands(std::span<const PreparedStyle* const> styles) const {
    return !options_.keep_field && SeedsOfBandsFit(styles.size()) &&
           std::ranges::all_of(styles, [](const PreparedStyle* style) {
             const TransferSettings& settings = style->settings;
             return settings.method == Method::kStyleBlit && !settings.coherent && settings.match_step <= 1 &&
                    !style->space && style->rims.empty() && style->blend_radius <= internal::kMostBandRadius;
           });
  }

  Status PaintByBands(std::span<const PreparedStyle* const> styles) {
    scratch_.field.Resize(0, 0), scratch_.active.clear();
    Stopwatch watch;
    std::vector<internal::BandStyle> parts;
    for (std::size_t s = 0; s < styles.size(); ++s) {
      const PreparedStyle& style = *styles[s];
      const Region matched = region_.GrownBy(ReachOf(style), guides_.width(), guides_.height());
      internal::BandStyle& part = parts.emplace_back(internal::BandStyle{
          InputOf(style, matched), style.blend_radius, std::nullopt, TintOf(style), style.base_layers.get()});
      part.match.active = {};
      part.match.covered = {guides_.Plane(Layer::kCoverage),
                            map_ ? std::span<const std::uint16_t>(map_->style) : std::span<const std::uint16_t>(),
                            static_cast<int>(s)};
      if (IsEdgeAware(style)) part.edges.emplace(EdgesOf(style, {}));
    }
    internal::RowProgress progress(options_.progress, 0.0, 1.0 - kComposeShare, std::max(1, region_.y1 - region_.y0));
    const internal::BandResult result =
        internal::PaintByBands(frame_, parts, fragments_, scratch_.bands, scratch_.base_votes, out_, progress);
    if (!result.finished) return CancelledError();
    start_.softly_covered = result.softly_covered;
    const double ms = watch.Lap();
    scratch_.times = {ms * result.shares.match, ms * result.shares.vote, ms * result.shares.start};
    return Ok();
  }

  Status Paint(const PreparedStyle& style, int index, double from, double to) {
    const Region& extent = start_.extents[std::size_t(index)];
    Region painted = Intersection(region_, extent);
    int reach = ReachOf(style);
    // A painted edge may lie in the region while its object does not.
    for (const RimPaint& rim : style.rims) reach = std::max(reach, internal::EdgeReach(rim.band()));
    const Region near = Intersection(extent, region_.GrownBy(reach, guides_.width(), guides_.height()));
    if (painted.empty() && ((style.rims.empty() && fragments_.empty()) || near.empty())) {
      PaintFragments(style, index, InputOf(style, {}));
      return Ok();
    }
    if (painted.empty()) painted = {};
    // Chunks of the brute force depend on every pixel above them, so it always runs on all of them.
    const Region matched = style.settings.method == Method::kBruteForce ? extent : near;
    if (!map_) return MatchAndVote(style, index, matched, painted, from, to);
    const std::vector<Region>& tiles = start_.tiles[std::size_t(index)];
    internal::Activate(frame_, index, tiles, scratch_.active);
    const Status done = MatchAndVote(style, index, matched, painted, from, to);
    internal::Deactivate(frame_, tiles, scratch_.active);
    return done;
  }

  // The pixels around whose sources affect a painted one.
  int ReachOf(const PreparedStyle& style) const {
    return fragments_.empty() ? style.blend_radius : std::max(style.blend_radius, internal::FragmentPaint::kReach);
  }

  // The style's pixels around are matched, or there are none.
  void PaintFragments(const PreparedStyle& style, int index, const internal::MatchInput& match) {
    if (fragments_.empty()) return;
    const internal::FragmentStyle settings{
        match,
        style.settings.method == Method::kLitSphere,
        IsEdgeAware(style),
        IsEdgeAware(style) && style.blend_radius > 0 ? internal::EdgeRules::CreaseCosine(style.settings.crease) : -2.0f,
        style.base_layers.get(),
        TintOf(style)};
    const internal::VoteInput votes{scratch_.field, scratch_.active, *style.exemplar, style.blend_radius, nullptr, {}};
    constexpr int kRows = 16;
    tbb::parallel_for(tbb::blocked_range<int>(region_.y0, std::max(region_.y0, region_.y1), kRows),
                      [&](const auto& rows) { fragments_.Paint(settings, index, votes, rows.begin(), rows.end()); });
  }

  static Region Intersection(const Region& a, const Region& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
  }

  Status PaintShadows(const PreparedStyle& style) {
    const Progress unheard;  // far faster than the other steps
    internal::RowProgress progress(unheard, 0.0, 1.0, std::max(1, region_.y1 - region_.y0));
    const internal::ShadowInput input{guides_, map_->style, *style.shadow, SeedsOf(style), region_};
    if (!internal::PaintShadows(input, out_, progress)) return CancelledError();
    if (fragments_.empty()) return Ok();
    const internal::ShadowPainter painter(input);
    fragments_.PaintShadows([&](int x, int y, std::uint16_t* texel) { painter.Paint(x, y, texel); });
    return Ok();
  }

  Status PaintEdges(std::span<const PreparedStyle* const> styles, std::vector<float>& coverage) {
    std::vector<internal::EdgePaint> paints;
    for (const PreparedStyle* style : styles) paints.push_back({style->rims, SeedsOf(*style), TintOf(*style)});
    internal::RowProgress progress(options_.progress, 1.0 - kComposeShare, 1.0 - kComposeShare / 2,
                                   std::max(1, region_.y1 - region_.y0));
    const std::span<const std::uint16_t> map =
        map_ ? std::span<const std::uint16_t>(map_->style) : std::span<const std::uint16_t>();
    const internal::PaintedEdgeInput input{guides_, map, paints, scratch_.field, region_};
    EdgeStrokes* const kept = options_.keep_colors ? &scratch_.strokes : nullptr;
    return internal::PaintEdges(input, coverage, out_, progress, kept) ? Ok() : CancelledError();
  }

  SeedRules SeedsOf(const PreparedStyle& style) const {
    const std::int64_t step =
        JitterStep(style.settings.jitter_fps, options_.frame, options_.fps_numerator, options_.fps_denominator);
    return {options_.seed, step, style.settings.jitter, style.settings.levels - style.levels};
  }

  static internal::Tint TintOf(const PreparedStyle& style) {
    return {style.reference_lightness, static_cast<float>(style.settings.colorize), style.settings.colorize_mode};
  }

  // The scene's luminance under the exposure; made when the first style needs it.
  std::span<const float> ExposedLuminance() {
    const auto plane = guides_.Plane(Layer::kLuminance);
    const float factor = static_cast<float>(Exp2(options_.exposure));
    if (factor == 1.0f) return plane;
    if (luminance_.empty()) {
      luminance_.resize(plane.size());
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, plane.size(), 1 << 16), [&](const auto& part) {
        for (std::size_t i = part.begin(); i != part.end(); ++i) luminance_[i] = plane[i] * factor;
      });
    }
    return luminance_;
  }

  static bool IsEdgeAware(const PreparedStyle& style) { return style.settings.edge_aware && style.blend_radius > 0; }
  internal::EdgeRules EdgesOf(const PreparedStyle& style, std::span<const std::uint8_t> covered) {
    return {guides_, slopes_, style.settings.crease, style.settings.depth_tolerance, covered};
  }

  internal::MatchInput InputOf(const PreparedStyle& style, const Region& matched) {
    const TransferSettings& settings = style.settings;
    internal::MatchInput input{guides_,
                               scratch_.active,
                               *style.exemplar,
                               style.illumination,
                               style.illumination.active() ? ExposedLuminance() : std::span<const float>(),
                               GuideTest(settings.threshold, settings.threshold_metric),
                               SeedsOf(style),
                               style.levels,
                               settings.variety,
                               style.flat_reach,
                               matched};
    input.space = style.space.get();
    input.brightness = static_cast<float>(Exp2(options_.exposure));
    return input;
  }

  Status MatchAndVote(const PreparedStyle& style, int index, const Region& matched, const Region& painted, double from,
                      double to) {
    const TransferSettings& settings = style.settings;
    const internal::MatchInput input = InputOf(style, matched);
    Stopwatch watch;
    const auto part = [&](double share) { return from + (to - from) * share; };
    const int step = settings.match_step;
    const Status done = step > 1 ? MatchCoarsely(settings, input, step, part(0.0), part(kMatchShare))
                                 : MatchAll(settings, input, part(0.0), part(kMatchShare));
    if (!done) return done;
    scratch_.times.match_ms += watch.Lap();

    const internal::EdgeRules edges = EdgesOf(style, map_ ? std::span<const std::uint8_t>() : scratch_.active);
    const int rows = (painted.y1 - painted.y0) * (style.base_layers ? 2 : 1);  // that votes will report
    internal::RowProgress vote_progress(options_.progress, part(kMatchShare), part(1.0), rows);
    internal::VoteInput votes{
        scratch_.field, scratch_.active, *style.exemplar, style.blend_radius, IsEdgeAware(style) ? &edges : nullptr,
        painted};
    const internal::ColorizeInput tint{guides_, scratch_.active, TintOf(style)};
    if (tint.tint.active())
      votes.finished = [&](int y, int x0, int x1) { internal::ColorizeRow(tint, y, x0, x1, out_); };
    if (!style.base_layers) {
      if (!internal::Vote(votes, out_, vote_progress)) return CancelledError();
    } else {
      const internal::HybridInput hybrid{
          votes, guides_, style.illumination, input.luminance, *style.base_layers, input.space, input.brightness};
      if (!internal::VoteHybrid(hybrid, scratch_.base_votes, out_, vote_progress)) return CancelledError();
    }
    PaintFragments(style, index, input);
    scratch_.times.vote_ms += watch.Lap();
    return Ok();
  }

  Status MatchAll(const TransferSettings& settings, const internal::MatchInput& input, double from, double to) {
    internal::RowProgress progress(options_.progress, from, to, input.region.y1 - input.region.y0);
    return Match(settings, input, progress) ? Ok() : CancelledError();
  }

  // Matches one pixel of each block and upsamples to the others.
  Status MatchCoarsely(const TransferSettings& settings, const internal::MatchInput& input, int step, double from,
                       double to) {
    internal::MatchInput coarse = input;
    coarse.region = input.region.GrownBy(internal::CoarseReach(step), guides_.width(), guides_.height());
    const internal::CoarseGrid grid(scratch_.active, guides_.width(), guides_.height(), step, coarse.region);
    wanted_.resize(guides_.pixel_count());
    scratch_.field.guide_offset.resize(guides_.pixel_count());
    grid.Mark(1, guides_.width(), wanted_);
    coarse.wanted = wanted_;
    coarse.least_level = internal::CoarseLeastLevel(step);
    const double middle = 0.5 * (from + to);
    const Status done = MatchAll(settings, coarse, from, middle);
    grid.Mark(0, guides_.width(), wanted_);
    if (!done) return done;
    internal::RowProgress progress(options_.progress, middle, to, input.region.y1 - input.region.y0);
    return internal::UpsampleField(input, grid, scratch_.field, progress) ? Ok() : CancelledError();
  }

  bool Match(const TransferSettings& settings, const internal::MatchInput& input, internal::RowProgress& progress) {
    switch (settings.method) {
      case Method::kLitSphere:
        return internal::MatchLitSphere(input, scratch_.field, progress);
      case Method::kStyleBlit:
        return settings.coherent ? internal::MatchCoherent(input, scratch_.field, progress)
                                 : internal::MatchStyleBlit(input, scratch_.field, progress);
      case Method::kBruteForce:
        return internal::MatchBruteForce(input, scratch_.field, progress);
    }
    return false;
  }

  const StyleMap* map_;
  const GuideSet& guides_;
  const TransferOptions& options_;
  TransferScratch& scratch_;
  Picture& out_;
  Region region_;
  internal::FrameInput frame_;
  internal::FragmentPaint fragments_;
  internal::FrameSetup start_;
  std::vector<float> luminance_;
  std::vector<std::uint8_t> wanted_;
  internal::LazyDepthGradient slopes_{guides_};
};

Status TransferInArena(std::span<const PreparedStyle* const> styles, const StyleMap* map, const GuideSet& guides,
                       const TransferOptions& options, TransferScratch& scratch, Picture& out) {
  Run run(map, styles.size(), guides, options, scratch, out);
  SCUMBLE_RETURN_IF_ERROR(run.PaintAll(styles));
  return run.Finish(styles);
}

Status TransferAll(std::span<const PreparedStyle* const> styles, const StyleMap* map, const GuideSet& guides,
                   const TransferOptions& options, TransferScratch& scratch, Picture& out) {
  SCUMBLE_RETURN_IF_ERROR(CheckInputs(styles, map, guides, options));
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return TransferInArena(styles, map, guides, options, scratch, out); });
}

}  // namespace

Status PutBackground(const PreparedStyle& style, const Picture* over, int threads, Picture& picture) {
  const internal::Background background{style.paper, over};
  if (background.empty()) return Ok();
  const Progress unheard;  // far faster than the other steps
  internal::RowProgress progress(unheard, 0.0, 1.0, std::max(1, picture.height));
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  const bool done = arena.execute([&] {
    return internal::Compose({}, background, {0, 0, picture.width, picture.height}, picture, progress);
  });
  return done ? Ok() : CancelledError();
}

TransferScratch::TransferScratch() = default;
TransferScratch::~TransferScratch() = default;
TransferScratch::TransferScratch(TransferScratch&&) = default;
TransferScratch& TransferScratch::operator=(TransferScratch&&) = default;

Status Transfer(const PreparedStyle& style, const GuideSet& guides, const TransferOptions& options,
                TransferScratch& scratch, Picture& out) {
  const PreparedStyle* const styles[] = {&style};
  return TransferAll(styles, nullptr, guides, options, scratch, out);
}

Status Transfer(std::span<const PreparedStyle* const> styles, const StyleMap& map, const GuideSet& guides,
                const TransferOptions& options, TransferScratch& scratch, Picture& out) {
  SCUMBLE_CHECK(!styles.empty() && styles.size() <= std::size_t(StyleMap::kMaxStyles));
  return TransferAll(styles, &map, guides, options, scratch, out);
}

}  // namespace scumble
