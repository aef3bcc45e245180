#include "transfer/rim/silhouettes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/filter/distance_transform.h"
#include "transfer/style_map.h"

namespace scumble::internal {
namespace {

// Shares of the distance: an object nearer by more than the first is in front, and fully so from the second on.
constexpr float kLeastStep = 0.01f, kFullStep = 0.03f;
// The step back from which on an object behind the outline is not behind the pixels beside it.
constexpr float kMostBefore = 0.1f;
// In bands: an object thinner than the first has no painted edge, one thicker than the second has the whole. The other
// two are for the gap to the next object.
constexpr float kThin = 1.0f, kThick = 8.0f, kNarrow = 0.5f, kWide = 3.0f;
// The distance around an outline pixel over which its direction is measured, in bands.
constexpr float kDirectionReach = 0.5f;
constexpr int kPointReach = 2;  // pixels around, to place the outline between pixels

}  // namespace

Silhouettes::Silhouettes(const SilhouetteInput& input)
    : input_(input),
      coverage_(input.guides.Plane(Layer::kCoverage)),
      depth_(input.guides.Plane(Layer::kDepth)),
      object_(input.guides.Plane(Layer::kObject)),
      around_(input.region.GrownBy(input.margin, input.guides.width(), input.guides.height())) {
  for (const int band : input.bands) widest_ = std::max(widest_, band);
  if (around_.empty()) return;
  Find();
  tbb::parallel_for(std::size_t(0), outline_.size(), [&](std::size_t k) { Straighten(outline_[k]); });
  tbb::parallel_for(std::size_t(0), outline_.size(), [&](std::size_t k) { outline_[k].width *= Room(outline_[k]); });
  Smooth();
  FindNearest();
}

bool Silhouettes::Painted(std::size_t i) const {
  const std::size_t style = StyleOf(i);
  return coverage_[i] > 0.0f && style != StyleMap::kPassThrough && style != StyleMap::kShadowCatcher;
}

int Silhouettes::Band(std::size_t i) const {
  const std::size_t style = StyleOf(i);
  return style < input_.bands.size() ? input_.bands[style] : 0;
}

std::uint32_t Silhouettes::ObjectOf(const OutlinePixel& pixel) const {
  return IdOf(object_[input_.guides.Index(pixel.x, pixel.y)]);
}

// How clearly pixel `front` of an object is in front of the surface at pixel `behind`, 0 … 1.
float Silhouettes::Step(std::size_t front, std::size_t behind) const {
  if (!(coverage_[behind] > 0.0f)) return 1.0f;
  if (object_[front] == object_[behind]) return 0.0f;
  const float step = 1.0f - depth_[front] / depth_[behind];
  if (!Painted(behind)) return step > -kLeastStep ? 1.0f : 0.0f;
  return step > kLeastStep ? std::min(1.0f, (step - kLeastStep) / (kFullStep - kLeastStep)) : 0.0f;
}

bool Silhouettes::Inside(const OutlinePixel& outline, std::size_t pixel) const {
  const std::size_t own = input_.guides.Index(outline.x, outline.y);
  return coverage_[pixel] > 0.0f && object_[pixel] == object_[own] && StyleOf(pixel) == StyleOf(own);
}

// An object that is behind at the outline is behind beside it too: ground comes nearer below the objects on it.
bool Silhouettes::Behind(const OutlinePixel& outline, std::size_t pixel) const {
  const std::size_t own = input_.guides.Index(outline.x, outline.y);
  if (Step(own, pixel) > 0.0f) return true;
  return object_[pixel] != object_[own] && coverage_[outline.beyond] > 0.0f &&
         object_[pixel] == object_[outline.beyond] && depth_[own] < depth_[pixel] * (1.0f + kMostBefore);
}

bool Silhouettes::Concerns(const OutlinePixel& outline, int x, int y) const {
  if (!(outline.width > kNarrowest)) return false;
  const int dx = outline.x - x, dy = outline.y - y;
  const float reach = outline.width * static_cast<float>(BandOf(outline)) + 1.5f;
  if (static_cast<float>(dx * dx + dy * dy) > reach * reach) return false;
  const std::size_t pixel = input_.guides.Index(x, y);
  return Inside(outline, pixel) || Behind(outline, pixel);
}

void Silhouettes::Find() {
  const GuideSet& guides = input_.guides;
  row_.reserve(std::size_t(around_.y1 - around_.y0) + 1);
  for (int y = around_.y0; y < around_.y1; ++y) {
    row_.push_back(static_cast<std::uint32_t>(outline_.size()));
    for (int x = around_.x0; x < around_.x1; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(coverage_[i] > 0.0f) || Band(i) == 0) continue;
      OutlinePixel pixel{x, y};
      pixel.width = 0.0f;
      const auto look = [&](int u, int v) {
        if (u < 0 || v < 0 || u >= guides.width() || v >= guides.height()) return;
        const std::size_t q = guides.Index(u, v);
        const float step = Step(i, q);
        if (!(step > 0.0f)) return;
        pixel.open |= !Painted(q);
        if (step > pixel.width) {
          pixel.width = step, pixel.beyond = static_cast<std::uint32_t>(q);
          pixel.outward = {static_cast<float>(u - x), static_cast<float>(v - y)};
        }
      };
      look(x, y - 1), look(x - 1, y), look(x + 1, y), look(x, y + 1);
      if (pixel.width > 0.0f) outline_.push_back(pixel);
    }
  }
  row_.push_back(static_cast<std::uint32_t>(outline_.size()));
}

// Sets the outward direction and the point of the outline, from the shares of the object and of its background in the
// pixels around. Surfaces in front of both count for neither.
void Silhouettes::Straighten(OutlinePixel& pixel) const {
  const GuideSet& guides = input_.guides;
  const int reach = std::max(kPointReach, static_cast<int>(kDirectionReach * static_cast<float>(BandOf(pixel)) + 0.5f));
  float toward_x = 0.0f, toward_y = 0.0f, near = 0.0f;
  for (int v = std::max(0, pixel.y - reach); v <= std::min(guides.height() - 1, pixel.y + reach); ++v) {
    for (int u = std::max(0, pixel.x - reach); u <= std::min(guides.width() - 1, pixel.x + reach); ++u) {
      const int dx = u - pixel.x, dy = v - pixel.y;
      if (dx * dx + dy * dy > reach * reach + reach) continue;
      const std::size_t q = guides.Index(u, v);
      float share;  // 1: the object, -1: behind it
      if (Inside(pixel, q))
        share = pixel.open ? 2.0f * std::min(coverage_[q], 1.0f) - 1.0f : 1.0f;
      else if (Behind(pixel, q))
        share = -1.0f;
      else
        continue;
      toward_x -= share * static_cast<float>(dx), toward_y -= share * static_cast<float>(dy);
      if (std::max(std::abs(dx), std::abs(dy)) <= kPointReach) near += share;
    }
  }
  const float length = std::sqrt(toward_x * toward_x + toward_y * toward_y);
  if (length > 0.5f) pixel.outward = {toward_x / length, toward_y / length};
  // A line through the square's centre has this length inside; moving it by t moves t times that area over.
  const float inside = (2 * kPointReach + 1) / std::max(std::fabs(pixel.outward.x), std::fabs(pixel.outward.y));
  const float beyond = std::clamp(0.5f * near / inside, -0.5f, 1.0f);
  pixel.point = glm::vec2(pixel.x + 0.5f, pixel.y + 0.5f) + beyond * pixel.outward;
}

// The share of the full width that has room, 0 … 1: inside up to the opposite outline, outside up to the next object
// that is not behind. Both are searched in steps of a pixel. Behind an occluder an object is assumed to continue.
float Silhouettes::Room(const OutlinePixel& pixel) const {
  const GuideSet& guides = input_.guides;
  const float band = static_cast<float>(BandOf(pixel)), own_depth = depth_[guides.Index(pixel.x, pixel.y)];
  const auto walk = [&](float sign, float far, const auto& ends) {
    for (float t = 1.0f; t < far; t += 1.0f) {
      const int u = static_cast<int>(std::floor(pixel.x + 0.5f + sign * t * pixel.outward.x));
      const int v = static_cast<int>(std::floor(pixel.y + 0.5f + sign * t * pixel.outward.y));
      if (u < 0 || v < 0 || u >= guides.width() || v >= guides.height()) return 1.0f;
      const std::size_t q = guides.Index(u, v);
      if (sign < 0.0f && coverage_[q] > 0.0f && !(depth_[q] > own_depth * (1.0f - kLeastStep)) && !Inside(pixel, q))
        return 1.0f;
      if (ends(q, t)) return t / far;
    }
    return 1.0f;
  };
  const float thickness = walk(-1.0f, kThick * band, [&](std::size_t q, float) { return !Inside(pixel, q); });
  const float gap = walk(1.0f, kWide * band, [&](std::size_t q, float t) { return t > 2.0f && !Behind(pixel, q); });
  const float by_thickness = (thickness - kThin / kThick) / (1.0f - kThin / kThick);
  const float by_gap = (gap - kNarrow / kWide) / (1.0f - kNarrow / kWide);
  return std::clamp(std::min(by_thickness, by_gap), 0.0f, 1.0f);
}

// Averages directions and widths with those of the object's same side nearby.
void Silhouettes::Smooth() {
  struct Smoothed {
    glm::vec2 outward;
    float width;
  };
  std::vector<Smoothed> smoothed(outline_.size());
  tbb::parallel_for(std::size_t(0), outline_.size(), [&](std::size_t k) {
    const OutlinePixel& own = outline_[k];
    const std::uint32_t object = ObjectOf(own);
    const int band = BandOf(own), turning = std::max(3, band / 2);
    glm::vec2 outward(0.0f);
    float width = 0.0f, count = 0.0f;
    ForNear(own.x, own.y, std::max(band, turning), [&](std::size_t other) {
      const OutlinePixel& at = outline_[other];
      if (ObjectOf(at) != object || glm::dot(at.outward, own.outward) < 0.5f) return;
      if (std::max(std::abs(at.x - own.x), std::abs(at.y - own.y)) <= turning) outward += at.outward;
      if (std::max(std::abs(at.x - own.x), std::abs(at.y - own.y)) <= band) width += at.width, count += 1.0f;
    });
    const float length = std::sqrt(outward.x * outward.x + outward.y * outward.y);
    smoothed[k] = {length > 0.0f ? outward / length : own.outward, count > 0.0f ? width / count : own.width};
  });
  for (std::size_t k = 0; k < smoothed.size(); ++k)
    outline_[k].outward = smoothed[k].outward, outline_[k].width = smoothed[k].width;
}

void Silhouettes::FindNearest() {
  row_reach_.assign(row_.size(), 0);
  for (const OutlinePixel& outline : outline_) {
    if (!(outline.width > kNarrowest)) continue;
    int& reach = row_reach_[std::size_t(outline.y - around_.y0)];
    reach = std::max(reach, static_cast<int>(outline.width * static_cast<float>(BandOf(outline)) + 1.5f));
  }
  const Region& region = input_.region;
  const Region near = region.GrownBy(widest_ + 2, input_.guides.width(), input_.guides.height());
  const int width = near.x1 - near.x0, height = near.y1 - near.y0, columns = region.x1 - region.x0;
  nearest_.assign(std::size_t(columns) * std::size_t(region.y1 - region.y0), kNone);
  std::vector<std::int32_t> at(std::size_t(width) * height, kNone);
  for (std::size_t k = 0; k < outline_.size(); ++k) {
    if (!(outline_[k].width > kNarrowest)) continue;
    const int x = outline_[k].x - near.x0, y = outline_[k].y - near.y0;
    if (x >= 0 && y >= 0 && x < width && y < height) at[std::size_t(y) * width + x] = static_cast<std::int32_t>(k);
  }
  ForNearestFeature(
      width, height, [&](std::size_t i) { return at[i] != kNone; },
      [&](std::size_t, int x, int y, int u, int v) {
        const int px = x + near.x0, py = y + near.y0;
        if (px < region.x0 || py < region.y0 || px >= region.x1 || py >= region.y1) return;
        if ((u - x) * (u - x) + (v - y) * (v - y) > (widest_ + 2) * (widest_ + 2)) return;
        std::int32_t found = at[std::size_t(v) * width + u];
        if (!Concerns(outline_[std::size_t(found)], px, py)) found = Search(px, py);
        nearest_[std::size_t(py - region.y0) * columns + (px - region.x0)] = found;
      });
}

// Nearest where the nearest of all does not concern the pixel: ties to the lowest (x, y), too.
std::int32_t Silhouettes::Search(int x, int y) const {
  std::int32_t best = kNone;
  int least = 0;
  const auto look = [&](int row, int reach) {
    ForNearInRow(x, row, reach, [&](std::size_t k) {
      const OutlinePixel& outline = outline_[k];
      const int squared = (outline.x - x) * (outline.x - x) + (row - y) * (row - y);
      if (best != kNone) {
        const OutlinePixel& other = outline_[std::size_t(best)];
        if (squared > least || (squared == least && std::tie(outline.x, row) > std::tie(other.x, other.y))) return;
      }
      if (!Concerns(outline, x, y)) return;
      least = squared, best = static_cast<std::int32_t>(k);
    });
  };
  for (int dy = 0; dy <= widest_ + 2 && (best == kNone || dy * dy <= least); ++dy) {
    if (row_reach_.empty()) break;
    for (int sign = -1; sign <= (dy > 0 ? 1 : -1); sign += 2) {
      const int row = y + sign * dy,
                in_row = row >= around_.y0 && row < around_.y1 ? row_reach_[std::size_t(row - around_.y0)] : 0;
      if (in_row >= dy && in_row > 0) look(row, in_row);
    }
  }
  return best;
}

std::int32_t Silhouettes::Nearest(int x, int y) const {
  const Region& region = input_.region;
  return nearest_[std::size_t(y - region.y0) * (region.x1 - region.x0) + (x - region.x0)];
}

}  // namespace scumble::internal
