#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "core/image/exact_math.h"
#include "core/image/hash.h"
#include "finish/area/area_effects.h"
#include "finish/area/hatch_texture.h"
#include "finish/area/ink.h"
#include "finish/area/noise.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/surface_share.h"

namespace scumble::internal {
namespace {

constexpr int kMostLayers = 4;

// A direction of strokes: a unit vector along them. Its sign does not matter.
using Axis = glm::vec2;

Axis AxisAt(double degrees) {
  // Rows count downwards.
  return {static_cast<float>(CosDegrees(degrees)), static_cast<float>(-SinDegrees(degrees))};
}

// The axis turned by the angle of that cosine and sine.
Axis Turned(Axis axis, glm::vec2 by) { return {axis.x * by.x - axis.y * by.y, axis.x * by.y + axis.y * by.x}; }

// Sums of a structure tensor.
struct Tensor {
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;
};

// What bends less than this, in radians a pixel of the reference height, or in no direction more than in others, has no
// axis of its own.
constexpr float kLeastBend = 0.003f, kLeastCoherence = 0.15f;

// Bends are measured over so many pixels of the reference height to both sides. Beside a crease or a bevel one side is
// flat: these belong to no face.
constexpr double kBendReach = 4.0;

// A patch is flat where it is flat over this share, and in all if over that one.
constexpr float kFlatShare = 0.25f, kMostlyFlat = 0.75f;

// Strokes run in one of so many directions. So those of neighbouring patches join, and a smaller picture or the next
// frame repeats them.
constexpr int kDirections = 24;

std::array<Axis, kDirections> AllDirections() {
  std::array<Axis, kDirections> directions;
  for (int i = 0; i < kDirections; ++i) directions[std::size_t(i)] = AxisAt(i * 180.0 / kDirections);
  return directions;
}

// The direction nearest to the tensor's largest axis, whose double angle is that of (xx - yy, 2 xy). `fixed`, if there
// is no such axis. `least` is of the trace.
Axis MainAxis(const Tensor& sum, float least, const std::array<Axis, kDirections>& directions, Axis fixed) {
  const glm::vec2 own(sum.xx - sum.yy, 2.0f * sum.xy);
  const float trace = sum.xx + sum.yy, length = std::sqrt(own.x * own.x + own.y * own.y);
  if (!(trace > least) || !(length > kLeastCoherence * trace)) return fixed;
  const auto likeness = [&](Axis axis) {
    return own.x * (axis.x * axis.x - axis.y * axis.y) + own.y * 2.0f * axis.x * axis.y;
  };
  Axis best = directions[0];
  for (const Axis axis : directions) {
    if (likeness(axis) > likeness(best)) best = axis;
  }
  return best;
}

// The patches of a picture.
class Patches {
 public:
  Patches(const HatchPass& pass, const FinishFrame& frame, int width, int height)
      : width_(width),
        height_(height),
        reach_(std::max(1, static_cast<int>(kBendReach * frame.scale + 0.5))),
        least_(static_cast<float>(kLeastBend / frame.scale)),  // normals turn more a pixel in small pictures
        cell_(static_cast<float>(std::max(4.0, pass.patch * frame.scale))),
        columns_(static_cast<int>(static_cast<float>(width) / cell_) + 3),
        rows_(static_cast<int>(static_cast<float>(height) / cell_) + 3),
        seed_(frame.steady_seed),
        directions_(AllDirections()),
        fixed_(AxisAt(pass.angle)) {
    if (pass.along == HatchPass::Along::kFixed) return;
    const GuideSet& guides = *frame.guides;
    object_ = guides.Plane(Layer::kObject);
    patch_.resize(guides.pixel_count()), is_flat_.resize(guides.pixel_count());
    for (int row = -1; row < rows_; ++row) {
      for (int column = -1; column + 1 < columns_; ++column) points_.push_back(PointOf(column, row));
    }
    tbb::parallel_for(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) patch_[guides.Index(x, y)] = NearestPoint(x, y);
    });
    Sum(guides);
    for (auto& patch : of_cell_) {
      for (Part& part : patch) {
        Tensor& sum = part.tensor;
        if (pass.along == HatchPass::Along::kAlong) sum = {sum.yy, -sum.xy, sum.xx};
        if (!(part.flat > kMostlyFlat * part.pixels))
          part.axis = MainAxis(sum, least_ * (part.pixels - part.flat), directions_, fixed_);
        if (!(part.flat > kFlatShare * part.pixels)) part.flat_axis = part.axis;
      }
    }
  }

  Axis At(std::size_t pixel) const {
    if (patch_.empty()) return fixed_;
    for (const Part& part : of_cell_[std::size_t(patch_[pixel])]) {
      if (part.object == object_[pixel]) return is_flat_[pixel] ? part.flat_axis : part.axis;
    }
    return fixed_;
  }

 private:
  // One object's share of a patch.
  struct Part {
    float object, pixels, flat;  // of the pixels
    Tensor tensor;
    Axis axis, flat_axis;
  };

  // The grid point's place, in cells.
  glm::vec2 PointOf(int column, int row) const {
    const std::uint64_t hash = Hash(seed_, 3, column, row);
    return {static_cast<float>(column) + UnitFloat(hash), static_cast<float>(row) + UnitFloat(Mix64(hash))};
  }

  int NearestPoint(int x, int y) const {
    const glm::vec2 at((static_cast<float>(x) + 0.5f) / cell_, (static_cast<float>(y) + 0.5f) / cell_);
    const int column = static_cast<int>(at.x), row = static_cast<int>(at.y);
    int nearest = 0;
    float least = 1e9f;
    for (int v = row - 1; v <= row + 1; ++v) {
      for (int u = column - 1; u <= column + 1; ++u) {
        const int index = (v + 1) * columns_ + (u + 1);
        const glm::vec2 off = points_[std::size_t(index)] - at;
        const float distance = off.x * off.x + off.y * off.y;
        if (distance < least) least = distance, nearest = index;
      }
    }
    return nearest;
  }

  using Parts = std::vector<std::vector<Part>>;  // by cell

  // Strips are added in one fixed order, since sums of floats depend on it.
  void Sum(const GuideSet& guides) {
    constexpr int kStrip = 64;
    std::vector<Parts> strips(std::size_t((height_ + kStrip - 1) / kStrip));
    tbb::parallel_for(std::size_t(0), strips.size(), [&](std::size_t s) {
      const int first = static_cast<int>(s) * kStrip;
      strips[s] = SumOf(guides, first, std::min(height_, first + kStrip));
    });
    of_cell_.resize(std::size_t(columns_) * std::size_t(rows_ + 1));
    for (const Parts& strip : strips) {
      for (std::size_t cell = 0; cell < strip.size(); ++cell) {
        for (const Part& more : strip[cell]) {
          Part& part = PartOf(of_cell_[cell], more.object);
          part.pixels += more.pixels, part.flat += more.flat;
          part.tensor.xx += more.tensor.xx, part.tensor.xy += more.tensor.xy, part.tensor.yy += more.tensor.yy;
        }
      }
    }
  }
  Parts SumOf(const GuideSet& guides, int first, int last) {
    Parts parts(std::size_t(columns_) * std::size_t(rows_ + 1));
    const auto coverage = guides.Plane(Layer::kCoverage);
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width_; ++x) {
        const std::size_t p = guides.Index(x, y);
        if (!(coverage[p] > 0.0f)) continue;
        Part& part = PartOf(parts[std::size_t(patch_[p])], object_[p]);
        part.pixels += 1.0f;
        const glm::vec3 dx = Bend(guides, p, 1, x, width_), dy = Bend(guides, p, width_, y, height_);
        const float xx = dx.x * dx.x + dx.y * dx.y + dx.z * dx.z, xy = dx.x * dy.x + dx.y * dy.y + dx.z * dy.z,
                    yy = dy.x * dy.x + dy.y * dy.y + dy.z * dy.z;
        // Lengths, not their squares: a tight bend then counts as much beside a wide one in pictures of any size.
        const float length = std::sqrt(xx + yy);
        if (!(length > least_)) {
          is_flat_[p] = 1, part.flat += 1.0f;
          continue;
        }
        part.tensor.xx += xx / length, part.tensor.xy += xy / length, part.tensor.yy += yy / length;
      }
    }
    return parts;
  }
  // How the normal turns a pixel along a row or a column, whose pixels are `step` apart. p is the `nth` of `count`.
  glm::vec3 Bend(const GuideSet& guides, std::size_t p, int step, int nth, int count) const {
    const glm::vec3 normal = guides.Vec3(Layer::kNormal, p);
    for (const int reach : {reach_, 1}) {  // thin objects have no pixels farther on
      const std::size_t off = std::size_t(reach) * std::size_t(step);
      const bool has_before = nth >= reach && object_[p - off] == object_[p];
      const bool has_after = nth + reach < count && object_[p + off] == object_[p];
      if (!has_before && !has_after) continue;
      const auto share = 1.0f / static_cast<float>(reach);
      const glm::vec3 before = has_before ? (normal - guides.Vec3(Layer::kNormal, p - off)) * share : glm::vec3();
      const glm::vec3 after = has_after ? (guides.Vec3(Layer::kNormal, p + off) - normal) * share : glm::vec3();
      if (!has_before || !has_after) return has_before ? before : after;
      // Their mean, or none where one side is flat.
      const float b = glm::dot(before, before), a = glm::dot(after, after);
      return a + b > 0.0f ? (before * a + after * b) / (a + b) : glm::vec3();
    }
    return glm::vec3();
  }
  Part& PartOf(std::vector<Part>& parts, float object) const {
    for (Part& part : parts) {
      if (part.object == object) return part;
    }
    parts.push_back({object, 0.0f, 0.0f, {}, fixed_, fixed_});
    return parts.back();
  }

  int width_, height_, reach_;
  float least_, cell_;
  int columns_, rows_;
  std::uint64_t seed_;
  std::array<Axis, kDirections> directions_;
  Axis fixed_;  // where the surface has no direction
  std::span<const float> object_;
  std::vector<int> patch_;  // by pixel; empty: all strokes have one direction
  std::vector<std::uint8_t> is_flat_;
  std::vector<glm::vec2> points_;  // of the grid, in cells, from the cell (-1, -1) on
  Parts of_cell_;
};

// How much of a pixel strokes of this share of ink cover: lines `spacing` apart and share · spacing wide, across a
// pixel of width 1.
float LineCover(float across, float spacing, float share) {
  const float turns = across / spacing;
  float part = turns - static_cast<float>(static_cast<int>(turns));  // without std::floor, which may be a call
  if (part < 0.0f) part = part + 1.0f;
  const float from_middle = std::fabs(part - 0.5f) * spacing;
  // Both the line and the gap may be thinner than a pixel.
  const float half = 0.5f * share * spacing;
  const float low = std::max(from_middle - 0.5f, -half), high = std::min(from_middle + 0.5f, half);
  const float next_low = std::max(from_middle - 0.5f, spacing - half),
              next_high = std::min(from_middle + 0.5f, spacing + half);
  return std::clamp(std::max(0.0f, high - low) + std::max(0.0f, next_high - next_low), 0.0f, 1.0f);
}

// The share of a pixel that a layer of strokes covers.
class Strokes {
 public:
  Strokes(const HatchPass& pass, double spacing) : spacing_(static_cast<float>(spacing)) {
    if (pass.texture) texture_.emplace(*pass.texture, spacing, pass.spacing);
  }
  // `at` in pixels, along the strokes and across them; `layer` counts from 0; `share`: of ink, wanted.
  float Cover(glm::vec2 at, int layer, float share) const {
    // Layers of one spacing would meet in a pattern.
    const float wider = 1.0f + 0.137f * static_cast<float>(layer);
    if (texture_) return texture_->Cover(at / wider + glm::vec2(13.1f * spacing_ * static_cast<float>(layer)), share);
    return LineCover(at.y, spacing_ * wider, share);
  }

 private:
  float spacing_;
  std::optional<TextureStrokes> texture_;
};

}  // namespace

void DrawHatch(const HatchPass& pass, double strength, std::span<const std::uint8_t> only, bool of_guides,
               const FinishFrame& frame, Picture& picture) {
  const Patches patches(pass, frame, picture.width, picture.height);
  const FloatPlane tones =
      ToneOf(pass.tone == HatchPass::Tone::kLight ? EdgesPass::Tone::kLight : EdgesPass::Tone::kPaint, frame, picture);
  const auto spacing = static_cast<float>(std::max(1.0, pass.spacing * frame.scale));
  const auto wobble = static_cast<float>(pass.wobble * frame.scale);
  const auto fullest = static_cast<float>(pass.fullest), from = static_cast<float>(pass.bare),
             deepest = static_cast<float>(pass.deepest);
  const Strokes strokes(pass, spacing);
  std::vector<NoiseField> strays;  // of each layer's strokes
  for (int k = 0; k < pass.layers && wobble > 0.0f; ++k)
    strays.emplace_back(Hash(frame.seed, 4, k), 6.0f * spacing, nullptr, picture.width, picture.height);
  std::array<glm::vec2, kMostLayers> turns;  // the cosine and sine of each layer's turn
  for (int k = 0; k < kMostLayers; ++k) turns[std::size_t(k)] = AxisAt(k * pass.cross);
  std::array<glm::vec2, kMostLayers> shifts{};  // of each layer's strokes, in later draws
  for (int k = 0; k < kMostLayers && frame.seed != frame.steady_seed; ++k) {
    const std::uint64_t hash = Hash(frame.seed, 9, k);
    shifts[std::size_t(k)] = glm::vec2(UnitFloat(hash), UnitFloat(Mix64(hash))) * (kSpacingsOfTexture * spacing);
  }
  const auto width = static_cast<std::size_t>(picture.width);
  const bool of_light = pass.tone == HatchPass::Tone::kLight;
  tbb::parallel_for(tbb::blocked_range<int>(0, picture.height, 8), [&](const auto& rows) {
    std::vector<float> surface(of_light ? width : 0);  // light is the surface's, paint the whole pixel's
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const std::size_t row = std::size_t(y) * width;
      if (of_light) {
        const auto coverage = frame.guides->Plane(Layer::kCoverage);
        SurfaceShares(coverage.data() + row, picture.rgba.data() + 4 * row, of_guides, width, surface.data());
      }
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = std::size_t(y) * width + x;
        std::uint16_t* const pixel = picture.rgba.data() + 4 * p;
        if (pixel[3] == 0 || (!only.empty() && !only[p])) continue;
        // Of the tone, after the layers so far.
        float left = from > 0.0f ? std::max(deepest, std::min(1.0f, tones[p] / from)) : 1.0f;
        if (left >= 1.0f) continue;
        const Axis axis = patches.At(p);
        const glm::vec2 at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        float bare = 1.0f;
        for (int k = 0; k < pass.layers && left < 1.0f; ++k) {
          const float most = k + 1 < pass.layers ? fullest : 1.0f;
          const float share = std::min(1.0f - left, most);
          const Axis along = Turned(axis, turns[std::size_t(k)]);
          float across = at.y * along.x - at.x * along.y;
          if (wobble > 0.0f) across += wobble * strays[std::size_t(k)].At(static_cast<int>(x), y);
          bare *= 1.0f -
                  strokes.Cover(glm::vec2(at.x * along.x + at.y * along.y, across) + shifts[std::size_t(k)], k, share);
          left = share < 1.0f ? left / (1.0f - share) : 1.0f;
        }
        std::uint16_t ink[4] = {pass.ink[0], pass.ink[1], pass.ink[2], 0};
        const float share = static_cast<float>(strength) * (of_light ? surface[x] : 1.0f);
        ink[3] = static_cast<std::uint16_t>((1.0f - bare) * share * 65535.0f + 0.5f);
        if (ink[3] == 0) continue;
        const std::uint16_t kept = pixel[3];
        LayInk(ink, pixel);
        pixel[3] = kept;  // strokes stay inside
      }
    }
  });
}

}  // namespace scumble::internal
