#include "finish/hatch/patches.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/image/exact_math.h"
#include "core/image/hash.h"

namespace scumble::internal {
namespace {

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

}  // namespace

Patches::Patches(const HatchPass& pass, const FinishFrame& frame, const FloatPlane& tones, const SurfaceScale* surface,
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

Patches::Strokes Patches::At(std::size_t pixel) const {
  if (patch_.empty()) return {fixed_};
  for (const Part& part : of_cell_[std::size_t(patch_[pixel])]) {
    if (part.object != object_[pixel]) continue;
    const Track& track = is_flat_[pixel] ? part.flat_track : part.track;
    return {is_flat_[pixel] ? part.flat_axis : part.axis, track.is_there ? &track : nullptr};
  }
  return {fixed_};
}

// Strokes run in one of so many directions. So those of neighbouring patches join, and a smaller picture or the next
// frame repeats them.
std::array<Axis, Patches::kDirections> Patches::AllDirections() {
  std::array<Axis, kDirections> directions;
  for (int i = 0; i < kDirections; ++i) directions[std::size_t(i)] = AxisAt(i * 180.0 / kDirections);
  return directions;
}

// The direction nearest to the tensor's largest axis, whose double angle is that of (xx - yy, 2 xy); that axis itself
// if there are none. `fixed`, if there is no such axis. `least` is of the trace.
Axis Patches::MainAxis(const Tensor& sum, float least, std::span<const Axis> directions, Axis fixed) {
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

// The grid point's place, in cells.
glm::vec2 Patches::PointOf(int column, int row) const {
  const std::uint64_t hash = Hash(seed_, 3, column, row);
  return {static_cast<float>(column) + UnitFloat(hash), static_cast<float>(row) + UnitFloat(Mix64(hash))};
}

// Numbers the patches, of surfaces in the order in which they are met.
void Patches::FindPatches(const GuideSet& guides) {
  patches_ = columns_ * (rows_ + 1);
  if (!surface_) {
    tbb::parallel_for(0, height_, [&](int y) {
      for (int x = 0; x < width_; ++x) patch_[guides.Index(x, y)] = NearestPoint(x, y);
    });
    return;
  }
  std::vector<std::uint64_t> keys(guides.pixel_count());
  tbb::parallel_for(0, height_, [&](int y) {
    NearPoints near;
    for (int x = 0; x < width_; ++x) {
      const std::size_t p = guides.Index(x, y);
      const float size = surface_->At(p) * cell_;
      keys[p] = size > 1e-30f ? SurfacePatch(guides, p, size, near) : std::uint64_t(NearestPoint(x, y));
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
std::uint64_t Patches::SurfacePatch(const GuideSet& guides, std::size_t p, float size, NearPoints& near) const {
  int octave = 0;
  if (std::frexp(size, &octave) < std::sqrt(0.5f)) --octave;
  const glm::vec3 at = guides.Vec3(Layer::kPref, p) * std::ldexp(1.0f, -octave);
  constexpr float kMost = 1e9f;
  if (!(std::fabs(at.x) < kMost && std::fabs(at.y) < kMost && std::fabs(at.z) < kMost)) return 0;
  const glm::vec3 corner = glm::floor(at), inside = at - corner;
  if (near.object != object_[p] || near.octave != octave || near.corner != corner) {
    near.object = object_[p], near.octave = octave, near.corner = corner;
    const std::uint64_t grid = Hash(seed_, 10, IdOf(object_[p]), octave);
    for (int k = 0; k < 27; ++k) {
      const glm::ivec3 step(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const std::uint64_t cell =
          Hash(grid, std::int64_t(corner.x) + step.x, std::int64_t(corner.y) + step.y, std::int64_t(corner.z) + step.z);
      const std::uint64_t second = Mix64(cell), third = Mix64(second);
      near.cells[std::size_t(k)] = cell;
      near.points[std::size_t(k)] = glm::vec3(step) + glm::vec3(UnitFloat(cell), UnitFloat(second), UnitFloat(third));
    }
  }
  std::size_t nearest = 0;
  float least = 1e9f;
  for (std::size_t k = 0; k < near.points.size(); ++k) {
    const glm::vec3 off = near.points[k] - inside;
    const float distance = glm::dot(off, off);
    if (distance < least) least = distance, nearest = k;
  }
  return near.cells[nearest];
}

int Patches::NearestPoint(int x, int y) const {
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

// Strips are added in one fixed order, since sums of floats depend on it.
void Patches::Sum(const GuideSet& guides) {
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

Patches::Parts Patches::SumOf(const GuideSet& guides, int first, int last) {
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

void Patches::AddSteps(const GuideSet& guides, std::size_t p, Part& part) const {
  const std::size_t right = p + 1, below = p + std::size_t(width_);
  if (object_[right] != object_[p] || object_[below] != object_[p]) return;
  const glm::vec3 place = guides.Vec3(Layer::kPref, p);
  part.per_x += guides.Vec3(Layer::kPref, right) - place, part.per_y += guides.Vec3(Layer::kPref, below) - place;
  part.steps += 1.0f;
}

// What strokes go by: the normal, or one number.
glm::vec3 Patches::ValueAt(const GuideSet& guides, std::size_t p) const {
  return value_.empty() ? guides.Vec3(Layer::kNormal, p) : glm::vec3(value_[p], 0.0f, 0.0f);
}

// How that changes a pixel along a row or a column, whose pixels are `step` apart. p is the `nth` of `count`.
glm::vec3 Patches::Bend(const GuideSet& guides, std::size_t p, int step, int nth, int count) const {
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

Patches::Part& Patches::PartOf(std::vector<Part>& parts, float object) const {
  for (Part& part : parts) {
    if (part.object == object) return part;
  }
  parts.push_back({object, 0.0f, 0.0f, {}, fixed_, fixed_});
  return parts.back();
}

}  // namespace scumble::internal
