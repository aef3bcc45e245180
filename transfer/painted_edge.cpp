#include "transfer/painted_edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "image/color.h"
#include "image/oklab.h"
#include "transfer/resample.h"

namespace scumble {
namespace {

// Distances in Oklab: below the first is the paper's own grain, above the second is full paint.
constexpr float kGrain = 0.06f, kFullPaint = 0.30f;
// The band around the rim, as a share of the radius; beyond 1.15 a picture with an edge shows mostly paper.
constexpr double kBand = 0.035, kPaperFrom = 1.15;
constexpr double kMostPaintOnPaper = 0.25;

glm::vec3 Lab(const std::uint16_t* texel) {
  return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
}

double Radius(int x, int y, int size) {
  const double dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
  return std::sqrt(dx * dx + dy * dy) / size;
}

glm::vec3 Median(std::vector<glm::vec3> colors) {
  glm::vec3 median(1.0f, 0.0f, 0.0f);
  if (colors.empty()) return median;
  const auto middle = colors.begin() + std::ptrdiff_t(colors.size() / 2);
  for (int c = 0; c < 3; ++c) {
    std::nth_element(colors.begin(), middle, colors.end(), [c](glm::vec3 a, glm::vec3 b) { return a[c] < b[c]; });
    median[c] = (*middle)[c];
  }
  return median;
}

glm::vec3 PaperColor(const Picture& picture, const Paper& paper) {
  std::vector<glm::vec3> colors;
  if (paper.color) {
    const std::array<std::uint16_t, 3>& c = *paper.color;
    return Lab(c.data());
  }
  const Picture& sheet = paper.picture ? *paper.picture : picture;
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      if (!paper.picture && Radius(x, y, sheet.width) < kPaperFrom) continue;
      if (sheet.At(x, y)[3] > 32767) colors.push_back(Lab(sheet.At(x, y)));
    }
  }
  return Median(std::move(colors));
}

}  // namespace

RimPaint::RimPaint(const Picture& picture, const Paper& paper, int size)
    : size_(size),
      band_(std::clamp(static_cast<int>(std::ceil(kBand * 0.5 * size)), 1, 64)),
      picture_(Resample(picture, size, size)) {
  const glm::vec3 bare = PaperColor(picture, paper);
  double paint = 0.0, count = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      std::uint16_t* texel = picture_.At(x, y);
      const glm::vec3 off = Lab(texel) - bare;
      const float distance = std::sqrt(off.x * off.x + off.y * off.y + off.z * off.z);
      const float t = std::clamp((distance - kGrain) / (kFullPaint - kGrain), 0.0f, 1.0f);
      const float opacity = static_cast<float>(texel[3]) * (t * t * (3.0f - 2.0f * t));
      texel[3] = static_cast<std::uint16_t>(opacity + 0.5f);
      if (Radius(x, y, size) < kPaperFrom) continue;
      paint += opacity / 65535.0, count += 1.0;
    }
  }
  has_edge_ = count > 0.0 && paint / count < kMostPaintOnPaper;
}

const std::uint16_t* RimPaint::At(int x, int y) const {
  static constexpr std::uint16_t kNothing[4] = {0, 0, 0, 0};
  if (x < 0 || y < 0 || x >= size_ || y >= size_) return kNothing;
  return picture_.At(x, y);
}

}  // namespace scumble

namespace scumble::internal {
namespace {

constexpr float kDepthStep = 0.02f;  // of the distance: what is nearer by more stands before
constexpr int kSeedLevel = 6;        // seeds 64 pixels apart
// Eight directions between the axes: on the axes the sphere touches the picture's sides, and no rim is left to see.
constexpr float kA = 0.92387953f, kC = 0.38268343f;
constexpr glm::vec2 kDirections[] = {{kA, kC}, {kC, kA}, {-kC, kA}, {-kA, kC}, {-kA, -kC}, {-kC, -kA}, {kC, -kA}, {kA, -kC}};
// Inside, shares of the band: how deep rim paint lies over an object's own, and how deep gaps in it may cut.
constexpr float kInkDepth = 0.5f, kCutDepth = 0.2f;

// Where a pixel stands to the nearest silhouette.
struct Place {
  float distance = 0.0f;   // pixels; above 0 inside the object, below outside
  glm::vec2 outward{0.0f};  // in the picture, y down
  std::size_t owner = 0;   // a pixel of the object that the silhouette belongs to
  bool open = false;       // nothing is on its other side
};

// The pixels from which a border of objects is at most `reach` away by row and by column.
std::vector<std::uint8_t> NearBorders(const GuideSet& guides, int reach) {
  const auto coverage = guides.Plane(Layer::kCoverage), object = guides.Plane(Layer::kObject);
  const int width = guides.width(), height = guides.height();
  const auto differ = [&](std::size_t a, std::size_t b) {
    return object[a] != object[b] || (coverage[a] > 0.0f) != (coverage[b] > 0.0f);
  };
  std::vector<std::uint8_t> rows(guides.pixel_count(), 0), near(guides.pixel_count(), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      const bool right = x + 1 < width && differ(i, i + 1), below = y + 1 < height && differ(i, i + std::size_t(width));
      if (!right && !below) continue;
      const int first = std::max(0, x - reach), last = std::min(width - 1, x + reach + 1);
      std::fill(rows.begin() + std::ptrdiff_t(guides.Index(first, y)), rows.begin() + std::ptrdiff_t(guides.Index(last, y)) + 1, 1);
    }
  }
  std::vector<int> left(std::size_t(width), 0);  // rows below the last mark of each column that are still near it
  const auto sweep = [&](int y, int span) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (rows[i]) left[x] = span + 1;
      if (left[x] > 0) near[i] = 1, --left[x];
    }
  };
  for (int y = 0; y < height; ++y) sweep(y, reach + 1);
  std::fill(left.begin(), left.end(), 0);
  for (int y = height - 1; y >= 0; --y) sweep(y, reach);
  return near;
}

class EdgePainter {
 public:
  EdgePainter(const PaintedEdgeInput& input)
      : input_(input),
        coverage_(input.guides.Plane(Layer::kCoverage)),
        depth_(input.guides.Plane(Layer::kDepth)),
        object_(input.guides.Plane(Layer::kObject)) {
    for (const EdgePaint& paint : input.paints) seeds_.emplace_back(paint.seeds, kSeedLevel, input.region);
  }

  const EdgePaint* PaintAt(std::size_t i) const {
    const std::size_t style = input_.style.empty() ? 0 : input_.style[i];
    if (style >= input_.paints.size() || input_.paints[style].rims.empty()) return nullptr;
    return &input_.paints[style];
  }

  // Whether the surface at q hides what is at p, or would.
  bool Before(std::size_t q, std::size_t p) const {
    if (!(coverage_[q] > 0.0f)) return false;
    if (!(coverage_[p] > 0.0f)) return true;
    return object_[q] != object_[p] && depth_[q] < depth_[p] * (1.0f - kDepthStep);
  }

  std::optional<Place> PlaceOf(int x, int y, int band) const {
    const GuideSet& guides = input_.guides;
    const std::size_t p = guides.Index(x, y);
    std::optional<Place> place;
    // The way out is the mean over the whole disc: the nearest pixel's own would jump with every step of a slanted border.
    int nearest = band * band + 1, inside_x = 0, inside_y = 0, outside_x = 0, outside_y = 0;
    for (int v = std::max(0, y - band); v <= std::min(guides.height() - 1, y + band); ++v) {
      for (int u = std::max(0, x - band); u <= std::min(guides.width() - 1, x + band); ++u) {
        const int dx = u - x, dy = v - y, squared = dx * dx + dy * dy;
        if (squared > band * band || squared == 0) continue;
        const std::size_t q = guides.Index(u, v);
        const bool q_before = Before(q, p), p_before = !q_before && Before(p, q);
        if (!q_before && !p_before) continue;
        const std::size_t owner = q_before ? q : p;
        if (!PaintAt(owner)) continue;
        if (q_before) inside_x += dx, inside_y += dy;
        else outside_x += dx, outside_y += dy;
        if (squared >= nearest) continue;
        nearest = squared;
        const float length = std::sqrt(static_cast<float>(squared)), sign = q_before ? -1.0f : 1.0f;
        place = Place{sign * (length - 0.5f), glm::vec2(sign * dx / length, sign * dy / length), owner,
                      !(coverage_[q_before ? p : q] > 0.0f)};
      }
    }
    if (!place) return place;
    const bool inside = place->distance > 0.0f;
    const float x_out = static_cast<float>(inside ? outside_x : -inside_x), y_out = static_cast<float>(inside ? outside_y : -inside_y);
    const float length = std::sqrt(x_out * x_out + y_out * y_out);
    if (length > 0.0f) place->outward = {x_out / length, y_out / length};
    return place;
  }

  // The rim's pixel for a place: as far from the rim as the place is from the silhouette, and round the rim as far as the
  // pixel is along the silhouette from its seed. Directions are taken in steps, so inside a step and around a seed the rim
  // is copied as it stands; a straight silhouette has one direction and would repeat one pixel of it for ever.
  static PixelPosition Choose(const RimPaint& rim, PixelPosition seed, int x, int y, const Place& place) {
    glm::vec2 outward = kDirections[0];
    for (const glm::vec2 way : kDirections) {
      const auto along = [&](glm::vec2 d) { return d.x * place.outward.x + d.y * place.outward.y; };
      if (along(way) > along(outward)) outward = way;
    }
    const float half = 0.5f * static_cast<float>(rim.size()), radius = half - place.distance;
    const glm::vec2 tangent(-outward.y, outward.x);
    const float round = (static_cast<float>(x - seed.x) * tangent.x + static_cast<float>(y - seed.y) * tangent.y) / half;
    const float dx = outward.x + round * tangent.x, dy = outward.y + round * tangent.y;
    const float length = std::sqrt(dx * dx + dy * dy);
    return {static_cast<int>(std::floor(half + dx / length * radius)),
            static_cast<int>(std::floor(half + dy / length * radius))};
  }

  void Paint(int x, int y, float& coverage, std::uint16_t* pixel, int widest_band) const {
    const std::size_t p = input_.guides.Index(x, y);
    const auto place = PlaceOf(x, y, widest_band);
    if (!place) return;
    const EdgePaint& paint = *PaintAt(place->owner);
    const std::size_t exemplar = std::min<std::size_t>(input_.field.exemplar[place->owner], paint.rims.size() - 1);
    const RimPaint& rim = paint.rims[exemplar];
    const float depth = place->distance / static_cast<float>(rim.band());  // of the place, in bands
    const float share = depth > 0.0f ? depth / kInkDepth : -depth;
    if (share >= 1.0f) return;
    const SeedGrid& seeds = seeds_[std::size_t(&paint - input_.paints.data())];
    const PixelPosition at = Choose(rim, seeds.Position(seeds.Nearest(x, y)), x, y, *place);
    std::array<std::uint16_t, 4> texel;
    std::copy_n(rim.At(at.x, at.y), 4, texel.begin());
    if (paint.tint.active() && texel[3] > 0) {
      paint.tint.Apply(input_.guides.Vec3(Layer::kAlbedo, place->owner), static_cast<int>(exemplar), texel.data());
    }
    const float fade = 1.0f - share * share;
    const float opacity = static_cast<float>(texel[3]) / 65535.0f * fade;
    // What the silhouette itself leaves of the pixel, and rim paint over it.
    float below = coverage_[p] > 0.0f ? static_cast<float>(pixel[3]) / 65535.0f * std::min(coverage_[p], 1.0f) : 0.0f;
    if (depth > 0.0f && place->open) {
      const float cut = std::max(0.0f, 1.0f - depth / kCutDepth);
      below *= 1.0f - cut * (1.0f - opacity);
    }
    const float alpha = opacity + below * (1.0f - opacity);
    if (!(alpha > 0.0f)) {
      coverage = 0.0f;
      return;
    }
    for (int c = 0; c < 3; ++c) {
      const float sum = static_cast<float>(texel[c]) * opacity + static_cast<float>(pixel[c]) * below * (1.0f - opacity);
      pixel[c] = static_cast<std::uint16_t>(std::min(65535.0f, sum / alpha + 0.5f));
    }
    pixel[3] = static_cast<std::uint16_t>(std::min(65535.0f, alpha * 65535.0f + 0.5f));
    coverage = 1.0f;
  }

 private:
  const PaintedEdgeInput& input_;
  std::span<const float> coverage_, depth_, object_;
  std::vector<SeedGrid> seeds_;  // by style
};

}  // namespace

bool PaintEdges(const PaintedEdgeInput& input, std::vector<float>& coverage, Picture& picture, RowProgress& progress) {
  int widest = 0;
  for (const EdgePaint& paint : input.paints) {
    for (const RimPaint& rim : paint.rims) widest = std::max(widest, rim.band());
  }
  const std::vector<std::uint8_t> near = NearBorders(input.guides, widest);
  const EdgePainter painter(input);
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = input.guides.Index(x, y);
      if (near[i]) painter.Paint(x, y, coverage[i], picture.At(x, y), widest);
    }
  });
}

}  // namespace scumble::internal
