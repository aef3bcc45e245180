// The transfer of a painted sphere's style to guides: the manual of this library.
//
//   Prepare(style)                  resize exemplars, once for a sequence
//   Transfer(prepared, guides, …)   match → SourceField → vote → compose → picture, once a frame
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/filter/region.h"
#include "core/image/fragments.h"
#include "core/image/guides.h"
#include "core/image/progress.h"
#include "core/image/status.h"
#include "core/image/style.h"
#include "scumble/picture.h"
#include "transfer/exemplar/guide_space.h"
#include "transfer/exemplar/illumination.h"
#include "transfer/lookup_table.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/rim/rim_paint.h"
#include "transfer/shadow/shadow_paint.h"
#include "transfer/source_field.h"
#include "transfer/style_map.h"

namespace scumble {

namespace internal {
struct BandMemory;
}

// A style prepared for outputs of one height. Immutable; any number of threads may use it at once.
struct PreparedStyle {
  TransferSettings settings;
  LayerSet required;  // of the guides
  std::shared_ptr<const PreparedExemplar> exemplar;
  Illumination illumination;
  float reference_lightness =
      0.0f;  // Oklab's, of paint that takes on base colours as they are; only for tints in Oklab
  std::shared_ptr<const GuideSpace> space;              // the space of the match; null: normals alone, with weight 1
  std::shared_ptr<const PreparedExemplar> base_layers;  // by MakeBaseLayers; null where transfer.hybrid is 0
  Paper paper;
  // By exemplar; only where transfer.edge is "exemplar" and the paint of every exemplar ends near its rim.
  std::vector<RimPaint> rims;
  std::optional<ShadowPaint> shadow;  // only where transfer.shadow is "paint"
  int output_height = 0;
  int levels = 1;        // settings.levels at the output's height
  int blend_radius = 0;  // settings.blend_radius at the output's height
  int flat_reach =
      16;  // pixels around a seed, at the output's height, that must be flat before `variety` gives it freedom
};

struct PrepareOptions {
  int table_resolution = LookUpTable::kResolution;  // cells a side of look-up tables, 1 … 16384
  TableCache* cache = nullptr;                      // null: none
  int threads = 0;                                  // 0: all
  // Asked between the steps; true ends them with kCancelled. Null: nothing cancels it.
  std::function<bool()> is_cancelled = {};
};

// Resizes exemplars and paper for outputs of `output_height` pixels; several exemplars become one size, the first's.
// Fails in these cases. An exemplar is empty, or a sphere's picture is not square. Guides do not fit their picture, or
// those of one style's exemplars are not of one scene, or one lacks a layer that has a weight. The rim takes more than
// half of a sphere's radius. A setting is outside its range in core/image/style.h.
Expected<PreparedStyle> Prepare(const Style& style, int output_height, const PrepareOptions& options = {});

// The luminance of the light that an exemplar is painted for: the style's value, else the mean of the luminance layer
// of its guides, else that of its paint. Means are over the pixels that are usable with a rim of that many pixels.
double LuminanceOf(const Exemplar& exemplar, double rim);

// The exposure that suits all of these styles, by MeasureExposure of illumination.h. For styles that weigh light, the
// 90th percentile of their exemplars' guides counts; for other styles of several exemplars, their luminances. Empty if
// no style uses light; 0 if no exemplar is lit. The guides must hold the layers that the styles require. `threads` 0:
// all; the result does not depend on them.
std::optional<double> MeasureExposure(std::span<const PreparedStyle> styles, const GuideSet& guides, int threads = 0);

// The brute force takes time quadratic in the pixels; larger pictures are refused.
inline constexpr std::size_t kMostBruteForcePixels = 1 << 20;

struct TransferOptions {
  std::uint64_t seed = 0;
  std::int64_t frame = 0;  // with the rate and jitter_fps; see JitterStep
  std::int64_t fps_numerator = 24;
  std::int64_t fps_denominator = 1;
  double exposure = 0.0;          // stops that brighten the scene's luminance; see MeasureExposure
  int threads = 0;                // 0: all
  const Picture* over = nullptr;  // composited underneath instead of the paper; the guides' size
  bool bare = false;              // neither paper nor `over` is put behind: PutBackground does it later
  bool keep_colors = false;       // TransferScratch::colors and `strokes` are wanted afterwards
  std::optional<Region> region;   // only these pixels of the result are made; empty: all
  bool keep_field = false;        // TransferScratch::field and `active` are wanted afterwards; costs some time
  Progress progress;
};

// Milliseconds of wall-clock time.
struct StageTimes {
  double match_ms = 0;
  double vote_ms = 0;
  double compose_ms = 0;
};

// Memory that a sequence keeps from frame to frame, and intermediate results of a transfer.
struct TransferScratch {
  TransferScratch();
  ~TransferScratch();
  TransferScratch(TransferScratch&&);
  TransferScratch& operator=(TransferScratch&&);

  SourceField field;                 // empty unless TransferOptions::keep_field requests it or the transfer needs it
  std::vector<std::uint8_t> active;  // 1: pixels that the last style painted; empty likewise
  StageTimes times;
  FragmentColors colors;                    // of the guides' fragments; empty unless keep_colors requests it
  EdgeStrokes strokes;                      // of painted edges, in the region; likewise
  std::vector<internal::BandMemory> bands;  // by thread
  Picture base_votes;                       // of hybrids
};

// Stylises one frame into `out` (resized to the guides; straight alpha = coverage × paint). The guides must hold
// style.required and pass GuideSet::Validate; their height must be the prepared one. The bytes depend on guides, style,
// seed and time step only: not on threads, tiles, region or machine. O(covered pixels), except for kBruteForce, which
// is refused above a megapixel.
Status Transfer(const PreparedStyle& style, const GuideSet& guides, const TransferOptions& options,
                TransferScratch& scratch, Picture& out);

// Transfer with several styles in one picture: `map` assigns them. Chunks and votes never cross from one style to
// another. Pixels of StyleMap::kPassThrough show the picture underneath, and their coverage does not count. So do those
// of StyleMap::kShadowCatcher, but with the first style's paint in shadow, if its settings enable that. The paper is
// the first style's. O(covered pixels + the rectangles around each style's pixels).
Status Transfer(std::span<const PreparedStyle* const> styles, const StyleMap& map, const GuideSet& guides,
                const TransferOptions& options, TransferScratch& scratch, Picture& out);

// Puts the style's paper, or `over` instead, behind a picture that was made with TransferOptions::bare.
Status PutBackground(const PreparedStyle& style, const Picture* over, int threads, Picture& picture);

}  // namespace scumble
