#include "transfer/rim/painted_edge.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/fragments.h"
#include "transfer/frame/compose.h"
#include "transfer/rim/rim_segments.h"
#include "transfer/rim/silhouettes.h"

namespace scumble::internal {
namespace {

// Inside, shares of the band: the depth of rim paint over an object's own, and the depth of gaps in it.
constexpr float kInkDepth = 0.5f, kCutDepth = 0.2f;
constexpr float kFadeFrom = 0.6f;  // of the depth, on either side
constexpr float kFirm = 0.2f;      // of the full width: narrower edges fade

using Texel = EdgeStroke::Texel;

float SmoothStep(float from, float to, float value) {
  const float t = std::clamp((value - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// The edge's input from the picture, for the pixels of the region.
class EdgePainter {
 public:
  explicit EdgePainter(const PaintedEdgeInput& input)
      : input_(input),
        coverage_(input.guides.Plane(Layer::kCoverage)),
        bands_(Bands(input)),
        silhouettes_({input.guides, input.style, bands_, input.region, Margin(input)}),
        segments_(Segments()) {}

  // `kept`: null, or where a stroke is added.
  void Paint(int x, int y, float& coverage, std::uint16_t* pixel, EdgeStrokes* kept) const {
    const std::int32_t nearest = silhouettes_.Nearest(x, y);
    if (nearest == Silhouettes::kNone) return;
    const OutlinePixel& outline = silhouettes_.outline()[std::size_t(nearest)];
    const std::size_t p = input_.guides.Index(x, y);
    const bool inside = silhouettes_.Inside(outline, p);
    const std::size_t owner = inside ? p : input_.guides.Index(outline.x, outline.y);
    const EdgePaint& paint = input_.paints[silhouettes_.StyleOf(outline)];
    const std::size_t exemplar = std::min<std::size_t>(input_.field.exemplar[owner], paint.rims.size() - 1);
    const RimPaint& rim = paint.rims[exemplar];

    const float distance = Distance(outline, x, y, inside) / outline.width;  // the distance at full width
    const float depth = distance / static_cast<float>(rim.band()), share = depth > 0.0f ? depth / kInkDepth : -depth;
    if (share >= 1.0f) return;
    const float firm = SmoothStep(Silhouettes::kNarrowest, kFirm, outline.width);
    Texel texel = RimAt(rim, segments_[std::size_t(nearest)], {x + 0.5f, y + 0.5f}, distance, outline.width);
    if (paint.tint.active() && texel[3] > 0) {
      paint.tint.Apply(input_.guides.Vec3(Layer::kAlbedo, owner), texel.data());
    }
    const float opacity = static_cast<float>(texel[3]) / 65535.0f * (1.0f - SmoothStep(kFadeFrom, 1.0f, share)) * firm;
    // The part of the pixel inside the silhouette, with rim paint over it.
    float below = coverage_[p] > 0.0f ? static_cast<float>(pixel[3]) / 65535.0f * std::min(coverage_[p], 1.0f) : 0.0f;
    if (depth > 0.0f && outline.open) {
      const float cut = std::max(0.0f, 1.0f - depth / kCutDepth) * firm;
      below *= 1.0f - cut * (1.0f - opacity);
    }
    texel[3] = static_cast<std::uint16_t>(opacity * 65535.0f + 0.5f);
    pixel[3] = static_cast<std::uint16_t>(below * 65535.0f + 0.5f);
    const std::size_t like = inside ? p : WithinOf(outline, owner);
    EdgeStroke stroke{static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(like), texel, {}, {}};
    std::copy_n(pixel, 4, stroke.beneath.begin());
    BlendOver(texel.data(), pixel);
    std::copy(texel.begin(), texel.end(), pixel);
    stroke.mixed = texel;
    if (kept && stroke.own[3] > 0 && !(inside && IsWhole(p))) kept->push_back(stroke);
    coverage = texel[3] > 0 ? 1.0f : 0.0f;
  }

 private:
  // A pixel of the surface a little inside: at the outline itself it is seen from its edge, and normals and light jump
  // from row to row.
  std::size_t WithinOf(const OutlinePixel& outline, std::size_t owner) const {
    const GuideSet& guides = input_.guides;
    for (const float steps : {2.0f, 1.0f}) {
      const int x = static_cast<int>(std::floor(static_cast<float>(outline.x) + 0.5f - steps * outline.outward.x));
      const int y = static_cast<int>(std::floor(static_cast<float>(outline.y) + 0.5f - steps * outline.outward.y));
      if (x < 0 || y < 0 || x >= guides.width() || y >= guides.height()) continue;
      const std::size_t p = guides.Index(x, y);
      if (coverage_[p] >= 1.0f && silhouettes_.Inside(outline, p)) return p;
    }
    return owner;
  }

  // Whether the guides are those of the whole pixel.
  bool IsWhole(std::size_t p) const {
    const Fragments* const fragments = input_.guides.fragments.get();
    if (!(coverage_[p] >= 1.0f)) return false;
    const std::size_t first = fragments ? fragments->From(p) : 0;
    return !fragments || first == fragments->count() || fragments->pixel[first] != p;
  }

  static std::vector<int> Bands(const PaintedEdgeInput& input) {
    std::vector<int> bands;
    for (const EdgePaint& paint : input.paints) bands.push_back(paint.rims.empty() ? 0 : paint.rims.front().band());
    return bands;
  }

  static int Margin(const PaintedEdgeInput& input) {
    int margin = 0;
    for (const EdgePaint& paint : input.paints) {
      if (paint.rims.empty()) continue;
      margin = std::max(margin, RimSegmentMargin(paint.seeds.level_offset, paint.rims.front().band()));
    }
    return margin;
  }

  std::vector<RimSegments> Segments() const {
    std::vector<float> radii;
    std::vector<SeedRules> seeds;
    int widest = 0;
    for (const EdgePaint& paint : input_.paints) {
      radii.push_back(paint.rims.empty() ? 1.0f : paint.rims.front().radius());
      seeds.push_back(paint.seeds);
      if (!paint.rims.empty()) widest = std::max(widest, paint.rims.front().band());
    }
    const Region near = input_.region.GrownBy(EdgeReach(widest), input_.guides.width(), input_.guides.height());
    return ChooseRimSegments({silhouettes_, radii, seeds, near});
  }

  // The distance of a pixel's centre from the outline, above 0 inside. Beside the outline pixel it is the distance from
  // the line through it, which has no steps as the pixels have.
  static float Distance(const OutlinePixel& outline, int x, int y, bool inside) {
    const glm::vec2 to = outline.point - glm::vec2(x + 0.5f, y + 0.5f);
    const float across = to.x * outline.outward.x + to.y * outline.outward.y;
    const float along = std::fabs(to.x * outline.outward.y - to.y * outline.outward.x) - 1.0f;
    if (along <= 0.0f) return across;
    const float length = std::sqrt(across * across + along * along);
    return inside ? length : -length;
  }

  // The rim segments' paint at a point of the picture, this far inside its edge. A narrower line is the mean of the
  // texels that it is shrunk from. Sums are of integers, like a vote's.
  static Texel RimAt(const RimPaint& rim, const RimSegments& segments, glm::vec2 at, float distance, float width) {
    const int samples = std::clamp(static_cast<int>(std::ceil(1.0f / width - 0.01f)), 1, 8);
    RimPaint::Sum sum;
    for (std::size_t n = 0; n < segments.segment.size() && segments.weight[n] > 0.0f; ++n) {
      const glm::vec2 direction = segments.segment[n].DirectionAt(at, rim.radius());
      const auto weight = static_cast<std::uint64_t>(segments.weight[n] * 256.0f + 0.5f);
      for (int s = 0; s < samples; ++s) {
        const float off = (static_cast<float>(2 * s + 1 - samples) / static_cast<float>(2 * samples)) / width;
        const float radius = rim.radius() - distance + (samples > 1 ? off : 0.0f);
        rim.Add(direction.x * radius, direction.y * radius, weight, sum);
      }
    }
    Texel texel{};
    if (sum.opacity == 0) return texel;
    for (int c = 0; c < 3; ++c) {
      texel[c] = static_cast<std::uint16_t>((sum.color[c] + sum.opacity / 2) / sum.opacity);
    }
    texel[3] = static_cast<std::uint16_t>((sum.opacity + sum.weight / 2) / sum.weight);
    return texel;
  }

  const PaintedEdgeInput& input_;
  std::span<const float> coverage_;
  std::vector<int> bands_;
  Silhouettes silhouettes_;
  std::vector<RimSegments> segments_;  // by outline pixel
};

}  // namespace

bool PaintEdges(const PaintedEdgeInput& input, std::vector<float>& coverage, Picture& picture, RowProgress& progress,
                EdgeStrokes* kept) {
  if (kept) kept->clear();
  const Region& region = input.region;
  if (region.empty()) return true;
  const EdgePainter painter(input);
  std::vector<EdgeStrokes> of_rows(kept ? std::size_t(region.y1 - region.y0) : 0);
  const bool done = ForEachRow(region, progress, [&](int y) {
    EdgeStrokes* const of_row = kept ? &of_rows[std::size_t(y - region.y0)] : nullptr;
    for (int x = region.x0; x < region.x1; ++x) {
      painter.Paint(x, y, coverage[input.guides.Index(x, y)], picture.At(x, y), of_row);
    }
  });
  std::size_t count = 0;
  for (const EdgeStrokes& of_row : of_rows) count += of_row.size();
  if (kept) kept->reserve(count);
  for (const EdgeStrokes& of_row : of_rows) kept->insert(kept->end(), of_row.begin(), of_row.end());
  return done;
}

}  // namespace scumble::internal
