#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <unordered_map>
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

// The same for what changes by less, a pixel of the reference height: the tone, where strokes go by the light; the
// depth, as a share of it.
constexpr float kLeastLightStep = 0.001f, kLeastDepthStep = 0.0004f;

// Bends and steps are measured over so many pixels of the reference height to both sides. Beside a crease or a bevel
// one side is flat: these belong to no face.
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

// Of strokes that stick to surfaces, in the space of the layer pref: there, they lie where planes cut the surface.
// Their directions are of so many all around, for the same reason.
constexpr int kWays = 300;

std::vector<glm::vec3> AllWays() {
  std::vector<glm::vec3> ways;
  for (int i = 0; i < kWays; ++i) {  // a spiral over half a sphere; a plane has no sign
    const double z = (i + 0.5) / kWays, radius = std::sqrt(1.0 - z * z), turn = i * 137.50776405;
    ways.push_back(glm::vec3(radius * CosDegrees(turn), radius * SinDegrees(turn), z));
  }
  return ways;
}

glm::vec3 NearestWay(const std::vector<glm::vec3>& ways, glm::vec3 direction) {
  glm::vec3 nearest = ways[0];
  for (const glm::vec3 way : ways) {
    if (std::fabs(glm::dot(way, direction)) > std::fabs(glm::dot(nearest, direction))) nearest = way;
  }
  return nearest;
}

// In pixels.
float SpacingOf(const HatchPass& pass, const FinishFrame& frame) {
  return static_cast<float>(std::max(1.0, pass.spacing * frame.scale));
}

// Layers of one spacing would meet in a pattern.
float WiderBy(int layer) { return 1.0f + 0.137f * static_cast<float>(layer); }

// Strokes on a surface, by layer. Their distance in pref is a power of two, `step`, at most the one that is wanted; by
// `coarser` of 0 … 1, its double is nearer to that.
struct Track {
  struct OfLayer {
    glm::vec3 along, across;     // unit vectors
    float pixel, step, coarser;  // pixel: how far pref goes across the strokes in one
  };
  std::array<OfLayer, kMostLayers> layers = {};
  bool is_there = false;
};

// `per_x`, `per_y`: how far pref goes in a pixel along a row and a column. `axis`: of the strokes in the picture.
// Nothing is there where the surface is seen from its edge.
Track TrackOf(const HatchPass& pass, float spacing, glm::vec3 per_x, glm::vec3 per_y, Axis axis,
              const std::vector<glm::vec3>& ways) {
  Track track;
  const float xx = glm::dot(per_x, per_x), xy = glm::dot(per_x, per_y), yy = glm::dot(per_y, per_y);
  const float area = xx * yy - xy * xy;
  if (!(area > 1e-6f * xx * yy) || !(area < 1e30f)) return track;
  // In the surface, what grows by as much a pixel as the place across the strokes does.
  const glm::vec2 wanted(-axis.y, axis.x);
  const glm::vec3 across =
      NearestWay(ways, per_x * (yy * wanted.x - xy * wanted.y) + per_y * (xx * wanted.y - xy * wanted.x));
  const glm::vec3 off = glm::cross(NearestWay(ways, glm::cross(per_x, per_y)), across);
  const float length = std::sqrt(glm::dot(off, off));
  if (!(length > 0.1f)) return track;
  track.is_there = true;
  const glm::vec3 along = off / length;
  for (int k = 0; k < kMostLayers; ++k) {
    const Axis turn = AxisAt(k * pass.cross);
    Track::OfLayer& layer = track.layers[std::size_t(k)];
    layer.across = turn.x * across + turn.y * along, layer.along = turn.x * along - turn.y * across;
    const glm::vec2 slope(glm::dot(per_x, layer.across), glm::dot(per_y, layer.across));
    layer.pixel = std::sqrt(glm::dot(slope, slope));
    const double level = Log2(layer.pixel * spacing * WiderBy(k)), octave = std::floor(level);
    layer.step = static_cast<float>(Exp2(octave)), layer.coarser = static_cast<float>(level - octave);
    track.is_there = track.is_there && layer.step > 1e-30f;
  }
  return track;
}

// The direction nearest to the tensor's largest axis, whose double angle is that of (xx - yy, 2 xy); that axis itself
// if there are none. `fixed`, if there is no such axis. `least` is of the trace.
Axis MainAxis(const Tensor& sum, float least, std::span<const Axis> directions, Axis fixed) {
  const glm::vec2 own(sum.xx - sum.yy, 2.0f * sum.xy);
  const float trace = sum.xx + sum.yy, length = std::sqrt(own.x * own.x + own.y * own.y);
  if (!(trace > least) || !(length > kLeastCoherence * trace)) return fixed;
  const auto likeness = [&](Axis axis) {
    return own.x * (axis.x * axis.x - axis.y * axis.y) + own.y * 2.0f * axis.x * axis.y;
  };
  if (directions.empty()) {
    const float cosine = own.x / length;
    const float x = std::sqrt(std::max(0.0f, 0.5f + 0.5f * cosine)),
                y = std::sqrt(std::max(0.0f, 0.5f - 0.5f * cosine));
    return {x, own.y < 0.0f ? -y : y};
  }
  Axis best = directions[0];
  for (const Axis axis : directions) {
    if (likeness(axis) > likeness(best)) best = axis;
  }
  return best;
}

// The patches of a picture.
class Patches {
 public:
  // `tones`: evened light, if strokes go by it. `surface`: null, unless strokes stick to surfaces.
  Patches(const HatchPass& pass, const FinishFrame& frame, const FloatPlane& tones, const SurfaceScale* surface,
          int width, int height)
      : along_(pass.along),
        width_(width),
        height_(height),
        reach_(std::max(1, static_cast<int>(kBendReach * frame.scale + 0.5))),
        cell_(static_cast<float>(std::max(4.0, pass.patch * frame.scale))),
        columns_(static_cast<int>(static_cast<float>(width) / cell_) + 3),
        rows_(static_cast<int>(static_cast<float>(height) / cell_) + 3),
        seed_(frame.steady_seed),
        directions_(AllDirections()),
        fixed_(AxisAt(pass.angle)),
        surface_(surface) {
    if (pass.along == HatchPass::Along::kFixed && !surface) return;
    const GuideSet& guides = *frame.guides;
    object_ = guides.Plane(Layer::kObject);
    if (along_ == HatchPass::Along::kLight) value_ = tones;
    if (along_ == HatchPass::Along::kDepth) value_ = guides.Plane(Layer::kDepth);
    const float least = along_ == HatchPass::Along::kLight   ? kLeastLightStep
                        : along_ == HatchPass::Along::kDepth ? kLeastDepthStep
                                                             : kLeastBend;
    least_ = least / static_cast<float>(frame.scale);  // normals turn more a pixel in small pictures
    patch_.resize(guides.pixel_count()), is_flat_.resize(guides.pixel_count());
    for (int row = -1; row < rows_; ++row) {
      for (int column = -1; column + 1 < columns_; ++column) points_.push_back(PointOf(column, row));
    }
    FindPatches(guides);
    Sum(guides);
    const float spacing = SpacingOf(pass, frame);
    const std::vector<glm::vec3> ways = surface ? AllWays() : std::vector<glm::vec3>();
    const auto directions = surface ? std::span<const Axis>() : std::span<const Axis>(directions_);
    for (auto& patch : of_cell_) {
      for (Part& part : patch) {
        Tensor& sum = part.tensor;
        if (pass.along == HatchPass::Along::kAlong) sum = {sum.yy, -sum.xy, sum.xx};
        if (!(part.flat > kMostlyFlat * part.pixels))
          part.axis = MainAxis(sum, least_ * (part.pixels - part.flat), directions, fixed_);
        if (!(part.flat > kFlatShare * part.pixels)) part.flat_axis = part.axis;
        if (!surface || !(part.steps > 0.0f)) continue;
        const glm::vec3 per_x = part.per_x / part.steps, per_y = part.per_y / part.steps;
        part.track = TrackOf(pass, spacing, per_x, per_y, part.axis, ways);
        part.flat_track =
            part.flat_axis == part.axis ? part.track : TrackOf(pass, spacing, per_x, per_y, part.flat_axis, ways);
      }
    }
  }

  // The strokes of a pixel.
  struct Strokes {
    Axis axis;
    const Track* track = nullptr;  // null: they do not stick
  };
  Strokes At(std::size_t pixel) const {
    if (patch_.empty()) return {fixed_};
    for (const Part& part : of_cell_[std::size_t(patch_[pixel])]) {
      if (part.object != object_[pixel]) continue;
      const Track& track = is_flat_[pixel] ? part.flat_track : part.track;
      return {is_flat_[pixel] ? part.flat_axis : part.axis, track.is_there ? &track : nullptr};
    }
    return {fixed_};
  }

 private:
  // One object's share of a patch.
  struct Part {
    float object, pixels, flat;  // of the pixels
    Tensor tensor;
    Axis axis, flat_axis;
    glm::vec3 per_x = {}, per_y = {};  // sums of how far pref goes in a pixel
    float steps = 0.0f;                // so many
    Track track = {}, flat_track = {};
  };

  // The grid point's place, in cells.
  glm::vec2 PointOf(int column, int row) const {
    const std::uint64_t hash = Hash(seed_, 3, column, row);
    return {static_cast<float>(column) + UnitFloat(hash), static_cast<float>(row) + UnitFloat(Mix64(hash))};
  }

  // Numbers the patches, of surfaces in the order in which they are met.
  void FindPatches(const GuideSet& guides) {
    patches_ = columns_ * (rows_ + 1);
    if (!surface_) {
      tbb::parallel_for(0, height_, [&](int y) {
        for (int x = 0; x < width_; ++x) patch_[guides.Index(x, y)] = NearestPoint(x, y);
      });
      return;
    }
    std::vector<std::uint64_t> keys(guides.pixel_count());
    tbb::parallel_for(0, height_, [&](int y) {
      for (int x = 0; x < width_; ++x) {
        const std::size_t p = guides.Index(x, y);
        const float size = surface_->At(p) * cell_;
        keys[p] = size > 1e-30f ? SurfacePatch(guides, p, size) : std::uint64_t(NearestPoint(x, y));
      }
    });
    std::unordered_map<std::uint64_t, int> numbers;
    std::uint64_t last = ~std::uint64_t(0);
    int number = 0;
    for (std::size_t p = 0; p < keys.size(); ++p) {
      if (keys[p] != last)
        last = keys[p], number = numbers.try_emplace(last, static_cast<int>(numbers.size())).first->second;
      patch_[p] = number;
    }
    patches_ = static_cast<int>(numbers.size());
  }

  // The point of a grid on the object that is nearest to the pixel. The grid's cells have about that size, in units of
  // pref: a power of two, so that they change only where the size does so by half.
  std::uint64_t SurfacePatch(const GuideSet& guides, std::size_t p, float size) const {
    const auto octave = static_cast<std::int64_t>(std::floor(Log2(size) + 0.5));
    const glm::vec3 at = guides.Vec3(Layer::kPref, p) * static_cast<float>(Exp2(double(-octave)));
    constexpr float kMost = 1e9f;
    if (!(std::fabs(at.x) < kMost && std::fabs(at.y) < kMost && std::fabs(at.z) < kMost)) return 0;
    const std::uint64_t grid = Hash(seed_, 10, IdOf(object_[p]), octave);
    const glm::vec3 corner(std::floor(at.x), std::floor(at.y), std::floor(at.z)), inside = at - corner;
    const auto beyond = [](int step, float place) { return step > 0 ? 1.0f - place : step < 0 ? place : 0.0f; };
    std::uint64_t nearest = 0;
    float least = 1e9f;
    for (const int dz : {0, -1, 1}) {
      for (const int dy : {0, -1, 1}) {
        for (const int dx : {0, -1, 1}) {
          const glm::vec3 gap(beyond(dx, inside.x), beyond(dy, inside.y), beyond(dz, inside.z));
          if (glm::dot(gap, gap) >= least) continue;
          const std::uint64_t cell =
              Hash(grid, std::int64_t(corner.x) + dx, std::int64_t(corner.y) + dy, std::int64_t(corner.z) + dz);
          const std::uint64_t second = Mix64(cell), third = Mix64(second);
          const glm::vec3 off =
              glm::vec3(dx, dy, dz) + glm::vec3(UnitFloat(cell), UnitFloat(second), UnitFloat(third)) - inside;
          const float distance = glm::dot(off, off);
          if (distance < least) least = distance, nearest = cell;
        }
      }
    }
    return nearest;
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
    of_cell_.resize(std::size_t(patches_));
    for (const Parts& strip : strips) {
      for (std::size_t cell = 0; cell < strip.size(); ++cell) {
        for (const Part& more : strip[cell]) {
          Part& part = PartOf(of_cell_[cell], more.object);
          part.pixels += more.pixels, part.flat += more.flat;
          part.per_x += more.per_x, part.per_y += more.per_y, part.steps += more.steps;
          part.tensor.xx += more.tensor.xx, part.tensor.xy += more.tensor.xy, part.tensor.yy += more.tensor.yy;
        }
      }
    }
  }
  Parts SumOf(const GuideSet& guides, int first, int last) {
    Parts parts(static_cast<std::size_t>(patches_));
    const auto coverage = guides.Plane(Layer::kCoverage);
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width_; ++x) {
        const std::size_t p = guides.Index(x, y);
        if (!(coverage[p] > 0.0f)) continue;
        Part& part = PartOf(parts[std::size_t(patch_[p])], object_[p]);
        part.pixels += 1.0f;
        if (surface_ && x + 1 < width_ && y + 1 < height_) AddSteps(guides, p, part);
        if (along_ == HatchPass::Along::kFixed) {
          is_flat_[p] = 1, part.flat += 1.0f;
          continue;
        }
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
  void AddSteps(const GuideSet& guides, std::size_t p, Part& part) const {
    const std::size_t right = p + 1, below = p + std::size_t(width_);
    if (object_[right] != object_[p] || object_[below] != object_[p]) return;
    const glm::vec3 place = guides.Vec3(Layer::kPref, p);
    part.per_x += guides.Vec3(Layer::kPref, right) - place, part.per_y += guides.Vec3(Layer::kPref, below) - place;
    part.steps += 1.0f;
  }
  // What strokes go by: the normal, or one number.
  glm::vec3 ValueAt(const GuideSet& guides, std::size_t p) const {
    return value_.empty() ? guides.Vec3(Layer::kNormal, p) : glm::vec3(value_[p], 0.0f, 0.0f);
  }
  // How that changes a pixel along a row or a column, whose pixels are `step` apart. p is the `nth` of `count`.
  glm::vec3 Bend(const GuideSet& guides, std::size_t p, int step, int nth, int count) const {
    const glm::vec3 value = ValueAt(guides, p);
    for (const int reach : {reach_, 1}) {  // thin objects have no pixels farther on
      const std::size_t off = std::size_t(reach) * std::size_t(step);
      const bool has_before = nth >= reach && object_[p - off] == object_[p];
      const bool has_after = nth + reach < count && object_[p + off] == object_[p];
      if (!has_before && !has_after) continue;
      float share = 1.0f / static_cast<float>(reach);
      if (along_ == HatchPass::Along::kDepth) share /= value.x;
      const glm::vec3 before = has_before ? (value - ValueAt(guides, p - off)) * share : glm::vec3();
      const glm::vec3 after = has_after ? (ValueAt(guides, p + off) - value) * share : glm::vec3();
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

  HatchPass::Along along_;
  int width_, height_, reach_;
  float least_ = 0.0f, cell_;
  int columns_, rows_, patches_ = 0;
  std::uint64_t seed_;
  std::array<Axis, kDirections> directions_;
  Axis fixed_;  // where the surface has no direction
  const SurfaceScale* surface_;
  std::span<const float> object_, value_;  // value_: instead of normals
  std::vector<int> patch_;                 // by pixel; empty: all strokes have one direction
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

// The tone that strokes leave, as a share of 1.
class ToneCurve {
 public:
  explicit ToneCurve(const HatchPass& pass)
      : power_(std::max(1.0, pass.shade)),
        share_(static_cast<float>(std::min(1.0, pass.shade))),
        bare_(static_cast<float>(pass.bare)) {}
  float At(float tone) const {
    if (power_ > 1.0 && tone > 0.0f) tone = static_cast<float>(Exp2(power_ * Log2(tone)));
    tone = bare_ > 0.0f ? std::min(1.0f, tone / bare_) : 1.0f;
    return 1.0f - share_ * (1.0f - tone);
  }

 private:
  double power_;
  float share_, bare_;
};

// The share of a pixel that a layer of strokes covers.
class Strokes {
 public:
  Strokes(const HatchPass& pass, double spacing) : spacing_(static_cast<float>(spacing)) {
    if (pass.texture) texture_.emplace(*pass.texture, spacing, pass.spacing);
  }
  // `at` in pixels, along the strokes and across them; `layer` counts from 0; `share`: of ink, wanted.
  float Cover(glm::vec2 at, int layer, float share) const {
    const float wider = WiderBy(layer);
    if (texture_) return texture_->Cover(at / wider + glm::vec2(13.1f * spacing_ * static_cast<float>(layer)), share);
    return LineCover(at.y, spacing_ * wider, share);
  }
  // On a surface, at a place of pref. `off`: pixels, along and across. Every second stroke grows as the surface comes
  // nearer, so that none moves. Textures change to the finer one within a quarter of an octave.
  float CoverOn(const Track& track, glm::vec3 place, glm::vec2 off, int layer, float share) const {
    const Track::OfLayer& on = track.layers[std::size_t(layer)];
    const float at = glm::dot(on.across, place);
    if (!(std::fabs(at) < 1e6f * on.step)) return share;
    if (texture_) {
      const glm::vec2 fine = glm::vec2(glm::dot(on.along, place), at) * (spacing_ * WiderBy(layer) / on.step);
      const float coarser = std::clamp(4.0f * (on.coarser - 0.5f) + 0.5f, 0.0f, 1.0f);
      float cover = 0.0f;
      if (coarser < 1.0f) cover += (1.0f - coarser) * Cover(fine + off, layer, share);
      if (coarser > 0.0f) cover += coarser * Cover(0.5f * fine + off, layer, share);
      return cover;
    }
    const float across = at / on.pixel + off.y, spacing = 2.0f * on.step / on.pixel;
    const float between = 0.5f * share * (1.0f - on.coarser);
    return std::min(1.0f,
                    LineCover(across + 0.5f * spacing, spacing, share - between) + LineCover(across, spacing, between));
  }

 private:
  float spacing_;
  std::optional<TextureStrokes> texture_;
};

}  // namespace

void DrawHatch(const HatchPass& pass, double strength, std::span<const std::uint8_t> only, bool of_guides,
               const FinishFrame& frame, Picture& picture) {
  const bool of_light = pass.tone == HatchPass::Tone::kLight;
  const FloatPlane tones = ToneOf(of_light ? EdgesPass::Tone::kLight : EdgesPass::Tone::kPaint, frame, picture);
  std::optional<SurfaceScale> surface;
  if (pass.stick) surface.emplace(*frame.guides);
  const SurfaceScale* const sticks = surface ? &*surface : nullptr;
  const bool needs_light = pass.along == HatchPass::Along::kLight && !of_light;
  const FloatPlane light = needs_light ? ToneOf(EdgesPass::Tone::kLight, frame, picture) : FloatPlane();
  const Patches patches(pass, frame, needs_light ? light : tones, sticks, picture.width, picture.height);
  const float spacing = SpacingOf(pass, frame);
  const auto wobble = static_cast<float>(pass.wobble * frame.scale);
  const auto fullest = static_cast<float>(pass.fullest);
  const ToneCurve curve(pass);
  const Strokes strokes(pass, spacing);
  std::vector<NoiseField> strays;  // of each layer's strokes
  for (int k = 0; k < pass.layers && wobble > 0.0f; ++k)
    strays.emplace_back(Hash(frame.seed, 4, k), 6.0f * spacing, sticks, picture.width, picture.height);
  std::array<glm::vec2, kMostLayers> turns;  // the cosine and sine of each layer's turn
  for (int k = 0; k < kMostLayers; ++k) turns[std::size_t(k)] = AxisAt(k * pass.cross);
  std::array<glm::vec2, kMostLayers> shifts{};  // of each layer's strokes, in later draws
  for (int k = 0; k < kMostLayers && frame.seed != frame.steady_seed; ++k) {
    const std::uint64_t hash = Hash(frame.seed, 9, k);
    shifts[std::size_t(k)] = glm::vec2(UnitFloat(hash), UnitFloat(Mix64(hash))) * (kSpacingsOfTexture * spacing);
  }
  const auto width = static_cast<std::size_t>(picture.width);
  tbb::parallel_for(tbb::blocked_range<int>(0, picture.height, 8), [&](const auto& rows) {
    std::vector<float> of_surface(of_light ? width : 0);  // light is the surface's, paint the whole pixel's
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const std::size_t row = std::size_t(y) * width;
      if (of_light) {
        const auto coverage = frame.guides->Plane(Layer::kCoverage);
        SurfaceShares(coverage.data() + row, picture.rgba.data() + 4 * row, of_guides, width, of_surface.data());
      }
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = std::size_t(y) * width + x;
        std::uint16_t* const pixel = picture.rgba.data() + 4 * p;
        if (pixel[3] == 0 || (!only.empty() && !only[p])) continue;
        float left = curve.At(tones[p]);  // of the tone, after the layers so far
        if (left >= 1.0f) continue;
        const auto [axis, track] = patches.At(p);
        const glm::vec2 at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        float bare = 1.0f;
        for (int k = 0; k < pass.layers && left < 1.0f; ++k) {
          const float most = k + 1 < pass.layers ? fullest : 1.0f;
          const float share = std::min(1.0f - left, most);
          const glm::vec2 turn = turns[std::size_t(k)];
          const float stray = wobble > 0.0f ? wobble * strays[std::size_t(k)].At(static_cast<int>(x), y) : 0.0f;
          const glm::vec2 off = glm::vec2(0.0f, stray) + shifts[std::size_t(k)];
          if (track) {
            bare *= 1.0f - strokes.CoverOn(*track, frame.guides->Vec3(Layer::kPref, p), off, k, share);
          } else {
            const Axis along = Turned(axis, turn);
            const glm::vec2 place(at.x * along.x + at.y * along.y, at.y * along.x - at.x * along.y);
            bare *= 1.0f - strokes.Cover(place + off, k, share);
          }
          left = share < 1.0f ? left / (1.0f - share) : 1.0f;
        }
        std::uint16_t ink[4] = {pass.ink[0], pass.ink[1], pass.ink[2], 0};
        const float share = static_cast<float>(strength) * (of_light ? of_surface[x] : 1.0f);
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
