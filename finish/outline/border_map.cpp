#include "finish/outline/border_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "core/filter/edge_test.h"
#include "core/filter/wide_loops.h"
#include "core/image/oklab.h"
#include "finish/outline/border_joiners.h"
#include "finish/outline/tangent_planes.h"
#include "finish/outline/valleys.h"

namespace scumble::internal {
namespace {

// Of a step in depth, as a share of the distance; see DepthTolerance.
constexpr double kDepthTolerance = 0.002;

// How much the depth may change without a step: by that share of the tolerance, and beyond the slope beside by that
// share of it. A ball's depth falls like the root of the distance to its rim: to its last pixel it changes up to 1 + √2
// times as much as before.
struct StepTolerance {
  float share, slope, slope_at_end;
};
constexpr StepTolerance kFullLimits{1.0f, 1.0f, 1.5f};
// A line of full steps goes on where one is more than this: along a fold that fades it would be dashed otherwise.
constexpr StepTolerance kWeakLimits{0.25f, 0.5f, 0.75f};
// Of depths that were stored as half floats: their rounding alone makes steps of up to a half of the tolerance.
constexpr float kWeakShareOfHalves = 0.6f;
// From a line of no fewer borders, at the reference height.
constexpr double kShortestSteps = 4.0;
// Up to how much of the slope that its normal gives the farther pixel's surface may have: flat faces with the normals
// of a round form are steeper than these say.
constexpr float kTangentShare = 1.4f;

// A crease goes on where the angle is no smaller than this share of `crease_angle`: a fold whose angle is about that
// would be dashed otherwise.
constexpr double kCreaseGoesOn = 2.0 / 3.0;
constexpr int kLeastBeside = 1;  // pixels of the surface beside the two of a border where a crease begins
// Where a crease begins, the flatter of its sides turns by no more than the first share of its angle, the rounder one
// by no more than the second.
constexpr double kMostBeside = 0.25, kMostRound = 0.6;

StepTolerance WeakLimits(std::span<const float> depth) {
  const auto has_more_bits = [](float one) { return (std::bit_cast<std::uint32_t>(one) & 0x1fffu) != 0; };
  StepTolerance limits = kWeakLimits;
  if (std::none_of(depth.begin(), depth.end(), has_more_bits)) limits.share = kWeakShareOfHalves;
  return limits;
}

std::vector<glm::vec3> OklabOf(const GuideSet& guides) {
  std::vector<glm::vec3> colors(guides.pixel_count());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, colors.size(), 1 << 14), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i)
      colors[i] = OklabFromLinear(guides.Vec3(Layer::kAlbedo, i));
  });
  return colors;
}

// What decides most pairs of neighbours.
struct PairPlanes {
  const float *coverage, *depth, *object, *material, *shadow, *normal_x, *normal_y, *normal_z;
  float tolerance_share, tolerance_fixed, crease;
  float weak_share;  // of both parts of the tolerance; 1: there are no weak steps
};

// For `count` pairs of pixels from (first, first + step) on: 0 where neither is covered, and where both are and
// depth, normal, object, material and shadow go on; 1 where Classifier::Between has to decide. `before`, `after`: how
// far away the pixels beyond the two are; 0 at the picture's edge.
SCUMBLE_WIDE_LOOPS void FindUndecided(const PairPlanes& of, std::size_t first, std::size_t step, std::size_t before,
                                      std::size_t after, std::size_t count, std::uint32_t* undecided) {
  const float tolerance_share = of.tolerance_share, tolerance_fixed = of.tolerance_fixed, crease = of.crease,
              weak_share = of.weak_share;
  const float *const coverage = of.coverage + first, *const depth = of.depth + first, *const object = of.object + first,
                     *const material = of.material + first, *const shadow = of.shadow + first;
  const float *const x = of.normal_x + first, *const y = of.normal_y + first, *const z = of.normal_z + first;
  const float *const depth_before = depth - before, *const depth_after = depth + step + after;
  const float *const object_before = object - before, *const object_after = object + step + after;
  for (std::size_t p = 0; p < count; ++p) {
    const std::size_t q = p + step;
    const bool covers_p = coverage[p] > 0.0f, covers_q = coverage[q] > 0.0f;
    const float nearer = depth[q] < depth[p] ? depth[q] : depth[p];
    const float rise = depth[q] - depth[p], tolerance = tolerance_fixed + tolerance_share * nearer,
                weak = weak_share * tolerance;
    const float rise_before = depth[p] - depth_before[p], rise_after = depth_after[p] - depth[q];
    // Beside the background a slope is infinite, and less than infinity is needed.
    const bool is_as_before = (std::fabs(rise - rise_before) < kWeakLimits.slope * std::fabs(rise_before) + weak) &
                              (object_before[p] == object[p]);
    const bool is_as_after = (std::fabs(rise - rise_after) < kWeakLimits.slope * std::fabs(rise_after) + weak) &
                             (object_after[p] == object[p]);
    const bool goes_on = (std::fabs(rise) <= tolerance) & ((std::fabs(rise) <= weak) | is_as_before | is_as_after);
    const bool is_flat = x[p] * x[q] + y[p] * y[q] + z[p] * z[q] > crease;
    const bool is_same = (object[p] == object[q]) & (material[p] == material[q]);
    const bool is_lit_alike = (shadow[p] >= 0.5f) == (shadow[q] >= 0.5f);
    const bool goes_on_in_all = covers_p & covers_q & goes_on & is_flat & is_same & is_lit_alike;
    undecided[p] = (covers_p | covers_q) & !goes_on_in_all ? 1u : 0u;
  }
}

bool IsOn(const OutlinePass& pass, LineClass line) { return pass.of_class[std::size_t(line)] > 0.0; }

class Classifier {
 public:
  Classifier(const OutlinePass& pass, const GuideSet& guides, double scale, std::span<const std::uint8_t> only,
             std::span<const float> shadow)
      : pass_(pass),
        only_(only),
        guides_(guides),
        tolerance_(guides, kDepthTolerance),
        weak_(WeakLimits(guides.Plane(Layer::kDepth))),
        crease_(pass.crease_angle < 180.0 ? glm::radians(pass.crease_angle) : std::numeric_limits<double>::infinity()),
        weak_crease_(crease_ * (IsOn(LineClass::kCrease) ? kCreaseGoesOn : 1.0)),
        owner_(guides),
        planes_(guides),
        coverage_(guides.Plane(Layer::kCoverage)),
        depth_(guides.Plane(Layer::kDepth)),
        object_(guides.Plane(Layer::kObject)),
        texture_step_(static_cast<float>(pass.texture_step * pass.texture_step)) {
    if (IsOn(LineClass::kMaterial)) material_ = guides.Plane(Layer::kMaterial);
    if (IsOn(LineClass::kShadow)) shadow_ = shadow;
    if (IsOn(LineClass::kTexture)) colors_ = OklabOf(guides);
    if (IsOn(LineClass::kSuggestive)) valleys_.emplace(pass, guides, scale);
  }

  // Of the tolerance, beyond which steps are weak ones.
  double WeakShare() const { return double(weak_.share); }

  // Of `count` pairs from (first, first + step) on: 0 where Between gives 0 for sure. The rest as FindUndecided has it.
  void MarkUndecided(std::size_t first, std::size_t step, std::size_t before, std::size_t after, std::size_t count,
                     std::uint32_t* undecided) const {
    if (!colors_.empty() || valleys_) return static_cast<void>(std::fill_n(undecided, count, 1u));
    const auto normal = [&](int c) { return guides_.Plane(Layer::kNormal, c).data(); };
    // Where a layer is not looked at, the object's values stand in, which are compared anyway.
    const auto or_object = [&](std::span<const float> plane) { return (plane.empty() ? object_ : plane).data(); };
    FindUndecided({coverage_.data(), depth_.data(), object_.data(), or_object(material_), or_object(shadow_), normal(0),
                   normal(1), normal(2), tolerance_.share, tolerance_.fixed,
                   static_cast<float>(std::cos(std::min(weak_crease_, std::numbers::pi))),
                   IsOn(LineClass::kOcclusion) ? weak_.share : 1.0f},
                  first, step, before, after, count, undecided);
  }

  // Of the border between pixels p and q, the next one of a row or a column. `before` and `after`: the pixels beyond
  // them in the same direction; empty at the picture's edge.
  std::uint8_t Between(std::optional<std::size_t> before, std::size_t p, std::size_t q,
                       std::optional<std::size_t> after) const {
    const bool covers_p = coverage_[p] > 0.0f, covers_q = coverage_[q] > 0.0f;
    if (!covers_p && !covers_q) return 0;
    if (!only_.empty() && !IsWanted(p, q)) return 0;
    if (covers_p != covers_q) return CodeIfOn(LineClass::kSilhouette);
    if (object_[p] != object_[q]) return CodeIfOn(LineClass::kObject);
    if (!DepthGoesOn(before, p, q, after)) return CodeIfOn(LineClass::kOcclusion);
    const std::optional<LineClass> line = OnSurface(p, q);
    const std::uint8_t code = line ? CodeIfOn(*line) : IsOn(LineClass::kCrease) ? GoingOn(p, q) : 0;
    const bool is_weak_step = IsOn(LineClass::kOcclusion) && !DepthGoesOn(before, p, q, after, weak_);
    return is_weak_step ? code | kWeakStep : code;
  }

 private:
  std::uint8_t CodeIfOn(LineClass line) const { return IsOn(line) ? CodeOf(line) : std::uint8_t{0}; }
  bool IsOn(LineClass line) const { return internal::IsOn(pass_, line); }

  bool IsWanted(std::size_t p, std::size_t q) const {
    return only_[owner_.Of(p, q)] || ((only_[p] || only_[q]) && owner_.Meet(p, q));
  }

  // Whether the depth goes on from p to q: as it does on one of the sides, by up to twice the slope there, give or take
  // the tolerance, and by a little more where the surface ends. A step's two sides are flatter than the step. Or as the
  // farther pixel's surface does, which a bevel of a pixel or two shows at its rim: behind a step it is not that steep.
  bool DepthGoesOn(std::optional<std::size_t> before, std::size_t p, std::size_t q, std::optional<std::size_t> after,
                   const StepTolerance& of = kFullLimits) const {
    const float step = depth_[q] - depth_[p], tolerance = of.share * tolerance_.At(std::min(depth_[p], depth_[q]));
    if (std::fabs(step) <= tolerance) return true;
    const auto goes_on = [&](std::optional<std::size_t> there, std::size_t here) {
      return there && coverage_[*there] > 0.0f && object_[*there] == object_[here];
    };
    const bool has_before = goes_on(before, p), has_after = goes_on(after, q);
    const auto fits = [&](float slope, bool is_end) {
      return std::fabs(step - slope) <= (is_end ? of.slope_at_end : of.slope) * std::fabs(slope) + tolerance;
    };
    return (has_before && fits(depth_[p] - depth_[*before], !has_after)) ||
           (has_after && fits(depth_[*after] - depth_[q], !has_before)) || IsSteepBehind(p, q, tolerance);
  }

  // Whether the farther pixel's surface rises to the depth of the nearer one, or beyond, within a pixel.
  bool IsSteepBehind(std::size_t p, std::size_t q, float tolerance) const {
    const std::size_t nearer = depth_[p] < depth_[q] ? p : q, farther = nearer == p ? q : p;
    const std::size_t width = static_cast<std::size_t>(guides_.width());
    const bool is_below = std::max(p, q) - std::min(p, q) == width;
    const float slope = planes_.StepAt(farther, is_below) * (farther > nearer ? 1.0f : -1.0f);
    return depth_[farther] - depth_[nearer] - kTangentShare * slope <= tolerance;
  }

  double AngleBetween(std::size_t p, std::size_t q) const {
    const glm::dvec3 a(guides_.Vec3(Layer::kNormal, p)), b(guides_.Vec3(Layer::kNormal, q));
    return 2.0 * std::asin(std::min(1.0, 0.5 * glm::length(a - b)));
  }

  // By how much the normal turns from `pixel` to the one `reach` pixels on, or to the last one there that is of its
  // surface: of its object, without a step in depth. Infinite if the surface ends before `least` pixels; the picture's
  // edge is no such end.
  double TurnFrom(std::size_t pixel, std::ptrdiff_t step, int least, int reach) const {
    const auto count = static_cast<std::ptrdiff_t>(depth_.size()), width = std::ptrdiff_t(guides_.width());
    const auto after = [&](std::size_t here) -> std::optional<std::size_t> {
      const std::ptrdiff_t next = static_cast<std::ptrdiff_t>(here) + step;
      if (next < 0 || next >= count) return std::nullopt;
      if ((step == 1 && next % width == 0) || (step == -1 && (next + 1) % width == 0)) return std::nullopt;
      return static_cast<std::size_t>(next);
    };
    std::optional<std::size_t> before;
    std::size_t last = pixel;
    for (int k = 0; k < reach; ++k) {
      const std::optional<std::size_t> next = after(last);
      if (!next) break;
      if (!(coverage_[*next] > 0.0f) || object_[*next] != object_[pixel] ||
          !DepthGoesOn(before, last, *next, after(*next))) {
        if (k < least) return std::numeric_limits<double>::infinity();
        break;
      }
      before = last, last = *next;
    }
    return AngleBetween(pixel, last);
  }

  // Whether a crease begins between p and q: both sides are wider than a pixel, their normals are that much farther
  // apart than the flatter one turns, and within three pixels the sides are flat compared with the step. A round fold
  // is no crease, however few pixels it has, nor is the border of a bevel of one pixel beside an outline.
  bool CreaseBegins(std::size_t p, std::size_t q) const {
    const double angle = AngleBetween(p, q);
    if (!(angle >= crease_)) return false;
    const auto step = static_cast<std::ptrdiff_t>(q - p);
    const double from_p = TurnFrom(p, -step, kLeastBeside, 3), from_q = TurnFrom(q, step, kLeastBeside, 3);
    if (!(std::max(from_p, from_q) <= std::numbers::pi)) return false;
    const double flatter = std::min(from_p, from_q), rounder = std::max(from_p, from_q);
    return angle - flatter >= crease_ && flatter <= kMostBeside * angle && rounder <= kMostRound * angle;
  }

  // Whether one that began beside goes on there, and whether from a step in depth: into corners, where its sides are
  // narrow, and along round ones.
  std::uint8_t GoingOn(std::size_t p, std::size_t q) const {
    const double angle = AngleBetween(p, q);
    if (!(angle >= weak_crease_)) return 0;
    const auto step = static_cast<std::ptrdiff_t>(q - p);
    const double rest = angle - std::min(TurnFrom(p, -step, 0, 1), TurnFrom(q, step, 0, 1));
    return rest >= crease_ ? kFullCrease : rest >= weak_crease_ ? kWeakCrease : 0;
  }

  // Both pixels are of one surface.
  std::optional<LineClass> OnSurface(std::size_t p, std::size_t q) const {
    if (CreaseBegins(p, q)) return LineClass::kCrease;
    if (!material_.empty() && material_[p] != material_[q]) return LineClass::kMaterial;
    if (!shadow_.empty() && (shadow_[p] >= 0.5f) != (shadow_[q] >= 0.5f)) return LineClass::kShadow;
    if (!colors_.empty()) {
      const glm::vec3 step = colors_[q] - colors_[p];
      if (step.x * step.x + step.y * step.y + step.z * step.z > texture_step_) return LineClass::kTexture;
    }
    if (valleys_ && valleys_->Between(p, q)) return LineClass::kSuggestive;
    return std::nullopt;
  }

  const OutlinePass& pass_;
  std::span<const std::uint8_t> only_;
  const GuideSet& guides_;
  DepthTolerance tolerance_;
  StepTolerance weak_;
  double crease_, weak_crease_;  // radians
  BorderOwner owner_;
  TangentPlanes planes_;
  std::span<const float> coverage_, depth_, object_, material_, shadow_;
  std::vector<glm::vec3> colors_;
  float texture_step_;
  std::optional<Valleys> valleys_;
};

}  // namespace

BorderOwner::BorderOwner(const GuideSet& guides)
    : coverage_(guides.Plane(Layer::kCoverage)),
      depth_(guides.Plane(Layer::kDepth)),
      object_(guides.Plane(Layer::kObject)),
      facing_(guides.Plane(Layer::kNormal, 2)),
      width_(static_cast<std::size_t>(guides.width())),
      tolerance_(guides, kDepthTolerance) {}

float BorderOwner::SlopeTowards(std::size_t pixel, std::optional<std::size_t> before) const {
  const bool goes_on = before && coverage_[*before] > 0.0f && object_[*before] == object_[pixel];
  return goes_on ? depth_[pixel] - depth_[*before] : 0.0f;
}

bool BorderOwner::Meet(std::size_t p, std::size_t q) const {
  if (!(coverage_[p] > 0.0f) || !(coverage_[q] > 0.0f) || object_[p] == object_[q]) return false;
  const std::size_t step = q - p, count = depth_.size();
  const bool is_below = step == width_;
  const auto at = [&](bool is_inside, std::size_t pixel) { return is_inside ? std::optional(pixel) : std::nullopt; };
  const auto before = at(is_below ? p >= step : p % width_ > 0, p - step);
  const auto after = at(is_below ? q + step < count : (q + 1) % width_ > 0, q + step);
  // How much farther q's surface is than that of p, in the middle of p and in that of q. Between them it changes
  // evenly.
  const float in_p = depth_[q] + SlopeTowards(q, after) - depth_[p],
              in_q = depth_[q] - depth_[p] - SlopeTowards(p, before);
  const float least = (in_p < 0.0f) == (in_q < 0.0f) ? std::min(std::fabs(in_p), std::fabs(in_q)) : 0.0f;
  return least <= tolerance_.At(std::min(depth_[p], depth_[q]));
}

bool BorderOwner::IsSecond(std::size_t p, std::size_t q) const {
  if (!(coverage_[q] > 0.0f)) return false;
  if (!(coverage_[p] > 0.0f)) return true;
  if (!Meet(p, q)) return depth_[q] < depth_[p];
  return facing_[q] == facing_[p] ? object_[q] < object_[p] : facing_[q] > facing_[p];
}

BorderMap FindBorders(const OutlinePass& pass, const GuideSet& guides, double scale, std::span<const std::uint8_t> only,
                      std::span<const float> shadow) {
  const Classifier classifier(pass, guides, scale, only, shadow);
  BorderMap map{guides.width(), guides.height(), {}, {}};
  map.right.assign(guides.pixel_count(), 0), map.below.assign(guides.pixel_count(), 0);
  const auto width = static_cast<std::size_t>(map.width), height = static_cast<std::size_t>(map.height);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, height, 16), [&](const auto& rows) {
    std::vector<std::uint32_t> undecided(width);
    const auto at = [&](bool is_inside, std::size_t pixel) { return is_inside ? std::optional(pixel) : std::nullopt; };
    for (std::size_t y = rows.begin(); y != rows.end(); ++y) {
      const std::size_t row = y * width;
      std::fill(undecided.begin(), undecided.end(), 1u);  // also of the pairs beside the picture's edge
      if (width > 3) classifier.MarkUndecided(row + 1, 1, 1, 1, width - 3, undecided.data() + 1);
      for (std::size_t x = 0; x + 1 < width; ++x) {
        const std::size_t p = row + x;
        if (undecided[x]) map.right[p] = classifier.Between(at(x > 0, p - 1), p, p + 1, at(x + 2 < width, p + 2));
      }
      if (y + 1 == height) continue;
      classifier.MarkUndecided(row, width, y > 0 ? width : 0, y + 2 < height ? width : 0, width, undecided.data());
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = row + x;
        if (!undecided[x]) continue;
        map.below[p] = classifier.Between(at(y > 0, p - width), p, p + width, at(y + 2 < height, p + 2 * width));
      }
    }
  });
  if (IsOn(pass, LineClass::kCrease)) JoinCreases(guides.Plane(Layer::kObject), map);
  if (IsOn(pass, LineClass::kOcclusion)) {
    const DepthTolerance least(guides, kDepthTolerance * classifier.WeakShare());
    JoinSteps(guides, only, std::max(kShortestSteps, kShortestSteps * scale), least, map);
  }
  return map;
}

}  // namespace scumble::internal
