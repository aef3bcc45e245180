#include "core/painting/find_sphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/painting/paint_mask.h"
#include "core/painting/sphere_doubt.h"

namespace scumble {
namespace {

constexpr double kReaches = 0.0075;                   // of a side: paint that comes so near reaches it
constexpr double kPaintedLine = 0.005;                // of a row or column: more of it than specks
constexpr double kFree = 0.03, kFreeOpposite = 0.1;   // of a side, where paint clearly does not reach it
constexpr double kFlattened = 0.02;                   // of a side: an ellipse leaves it free on two
constexpr double kTooSmall = 0.985;                   // of the radius
constexpr double kOffCentre = 0.01, kCovers = 0.995;  // of the width, of the radius
constexpr double kLeastTolerance = 0.004;             // of the width
constexpr double kMostTolerance = 0.025;              // of the radius
constexpr double kLeastOutline = 0.8;                 // of the directions in which it can be seen
constexpr double kLeastSeen = 0.25;                   // of all directions
constexpr double kSeenFrom = 4.5;                     // pixels of ground between the circle and the picture's side
constexpr double kMostBeyond = 0.04;                  // of the circle's area
constexpr double kMostCut = 0.015;                    // of the radius, beyond the picture's sides
constexpr double kLeastRadius = 15.0;                 // pixels
constexpr double kLikelyOutline = 0.4;                // of all directions
constexpr double kRound = 0.97;                       // the shorter diameter of a circle to the longer
constexpr double kRoundOfSeveral = 0.95;
constexpr double kLeastOther = 0.05;  // of the largest region's pixels: another region of paint

// How far from each side the first painted line is, as a share of the picture: left, right, top, bottom.
struct Gaps {
  std::array<double, 4> of{1.0, 1.0, 1.0, 1.0};
  bool AllWithin(double share) const {
    return std::ranges::all_of(of, [&](double gap) { return gap <= share; });
  }
  bool ClearlyInside() const {
    return std::ranges::count_if(of, [](double gap) { return gap > kFree; }) >= 3 || OppositeBeyond(kFreeOpposite);
  }
  bool OppositeBeyond(double share) const {
    return (of[0] > share && of[1] > share) || (of[2] > share && of[3] > share);
  }
};

// `is_paint(x, y)` is asked up to `deepest` of each side.
template <class IsPaintAt>
Gaps GapsOf(int width, int height, double deepest, const IsPaintAt& is_paint) {
  Gaps gaps;
  for (std::size_t side = 0; side < 4; ++side) {
    const bool upright = side < 2, from_end = side % 2 == 1;
    const int lines = upright ? width : height, length = upright ? height : width;
    const double least = std::max(2.0, kPaintedLine * length);
    for (int line = 0; line <= deepest * lines && line < lines; ++line) {
      const int at = from_end ? lines - 1 - line : line;
      int painted = 0;
      for (int k = 0; k < length; ++k) painted += upright ? is_paint(at, k) : is_paint(k, at);
      if (painted < least) continue;
      gaps.of[side] = static_cast<double>(line) / lines;
      break;
    }
  }
  return gaps;
}

glm::dvec2 MiddleOf(const std::vector<std::uint8_t>& mask, int width) {
  glm::dvec2 sum(0.0);
  double count = 0.0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    sum += glm::dvec2(static_cast<double>(i % std::size_t(width)) + 0.5,
                      static_cast<double>(i / std::size_t(width)) + 0.5);
    count += 1.0;
  }
  return count > 0.0 ? sum / count : sum;
}

// A 4-connected region of paint: its first pixel in row order, and its number of pixels.
struct PaintRegion {
  std::size_t first = 0, size = 0;
};

// Takes the region of paint around a pixel out of `left` and calls visit(pixel) for each of its pixels. Goes in waves
// from the pixel on, so that only the front is in memory.
template <class Visit>
void TakeRegion(std::size_t first, int width, int height, std::vector<std::uint8_t>& left, const Visit& visit) {
  std::vector<std::size_t> front(1, first), next;
  left[first] = 0;
  while (!front.empty()) {
    next.clear();
    for (const std::size_t i : front) {
      visit(i);
      const int x = static_cast<int>(i % std::size_t(width)), y = static_cast<int>(i / std::size_t(width));
      const auto reach = [&](bool inside, std::size_t neighbour) {
        if (!inside || !left[neighbour]) return;
        left[neighbour] = 0;
        next.push_back(neighbour);
      };
      reach(x > 0, i - 1), reach(x + 1 < width, i + 1);
      reach(y > 0, i - std::size_t(width)), reach(y + 1 < height, i + std::size_t(width));
    }
    front.swap(next);
  }
}

// The two largest regions, the larger one first.
std::array<PaintRegion, 2> LargestRegions(const PaintMask& mask) {
  std::vector<std::uint8_t> left = mask.values();
  std::array<PaintRegion, 2> largest;
  for (std::size_t first = 0; first < left.size(); ++first) {
    if (!left[first]) continue;
    PaintRegion region{first, 0};
    TakeRegion(first, mask.width(), mask.height(), left, [&](std::size_t) { ++region.size; });
    if (region.size > largest[0].size) std::swap(region, largest[0]);
    if (region.size > largest[1].size) largest[1] = region;
  }
  return largest;
}

// The circle or ellipse of an outline of paint in a picture.
class OutlineFit {
 public:
  OutlineFit(const std::vector<std::uint8_t>& mask, int width, int height)
      : mask_(mask), width_(width), height_(height), size_(std::min(width, height)) {
    glm::dvec2 towards = MiddleOf(mask, width);
    // From the middle of the paint first, then from that of the circle.
    for (int round = 0; round < 2; ++round) {
      points_ = PaintOutline(mask, width, height, towards);
      const auto rough = FitCircle(points_, 0.01 * size_, kLeastRadius, size_);
      if (!rough) return;
      const auto fit = FitCircle(points_, ToleranceFor(rough->circle), kLeastRadius, size_);
      if (!fit) return;
      circle_ = fit->circle, agree_ = fit->agree;
      towards = {circle_->x, circle_->y};
      if (towards.x < 1 || towards.y < 1 || towards.x > width - 1 || towards.y > height - 1) return;
    }
    SetRadius();
  }

  const std::optional<Circle>& circle() const { return circle_; }
  double outline_radius() const { return outline_radius_; }  // of the circle's line, before it is moved inward

  // Whether the circle is sure: on it lies the outline, and beyond it hardly any paint.
  bool IsSure() const {
    if (!circle_ || outline_radius_ < kLeastRadius) return false;
    const auto agree = static_cast<double>(agree_), seen = static_cast<double>(SeenDirections());
    const bool is_circle = agree >= kLeastOutline * seen && agree >= kLeastSeen * kOutlineDirections;
    return is_circle && IsInPicture() && IsAlone();
  }

  // The tolerance around the circle's line.
  double tolerance() const { return ToleranceFor(*circle_); }

  // Whether so much of the outline lies on the circle that the rest may have a cause of its own.
  bool IsLikely() const {
    return circle_ && outline_radius_ >= kLeastRadius && agree_ >= kLikelyOutline * kOutlineDirections;
  }

  // If its shorter diameter is less than `round` of the longer.
  std::optional<EllipseFit> Ellipse(double round = kRound) const {
    if (points_.size() < kLeastOutline * kOutlineDirections) return std::nullopt;
    const auto fit = FitEllipse(points_, MiddleOf(mask_, width_), std::max(1.0, 0.01 * size_));
    if (!fit || fit->agree < kLeastOutline * kOutlineDirections || fit->shorter < 2.0 * kLeastRadius)
      return std::nullopt;
    return fit->shorter < round * fit->longer ? fit : std::nullopt;
  }

 private:
  // Where the square's own circle is far away, an uneven outline cannot be mistaken for it.
  double ToleranceFor(const Circle& circle) const {
    const double half = 0.5 * size_, dx = circle.x - 0.5 * width_, dy = circle.y - 0.5 * height_;
    const double off = std::sqrt(dx * dx + dy * dy);
    const double least = std::max(1.0, kLeastTolerance * size_);
    const double apart = width_ == height_ ? std::max(0.0, half - circle.radius + off) : half;
    return std::max(least, std::min(0.25 * apart, kMostTolerance * circle.radius));
  }

  // Moves the circle's line inward, to where there is paint in 95% of the directions on it.
  void SetRadius() {
    const double tolerance = ToleranceFor(*circle_);
    std::vector<double> distances;
    for (const glm::dvec2 p : points_) {
      if (circle_->Off(p) > tolerance) continue;
      const glm::dvec2 d = p - glm::dvec2(circle_->x, circle_->y);
      distances.push_back(std::sqrt(glm::dot(d, d)));
    }
    outline_radius_ = circle_->radius;
    if (distances.empty()) return;
    const auto low = distances.begin() + std::ptrdiff_t(distances.size() / 20);
    std::nth_element(distances.begin(), low, distances.end());
    circle_->radius = *low;
  }

  // A sphere that reaches the sides of a picture that is no square shows no ground there.
  std::size_t SeenDirections() const {
    if (width_ == height_) return kOutlineDirections;
    const double reach = outline_radius_ + kSeenFrom;
    std::size_t seen = 0;
    for (int i = 0; i < kOutlineDirections; ++i) {
      const glm::dvec2 at = glm::dvec2(circle_->x, circle_->y) + reach * OutlineDirection(i);
      seen += at.x >= 0.0 && at.y >= 0.0 && at.x < width_ && at.y < height_;
    }
    return seen;
  }

  bool IsInPicture() const {
    const double most = std::max(2.0, kMostCut * circle_->radius), r = circle_->radius - most;
    return circle_->x - r >= 0.0 && circle_->y - r >= 0.0 && circle_->x + r <= width_ && circle_->y + r <= height_;
  }

  bool IsAlone() const {
    const double beyond = circle_->radius + 2.0 * ToleranceFor(*circle_) + 2.0;
    double count = 0.0;
    for (std::size_t i = 0; i < mask_.size(); ++i) {
      if (!mask_[i]) continue;
      const double dx = static_cast<double>(i % std::size_t(width_)) + 0.5 - circle_->x;
      const double dy = static_cast<double>(i / std::size_t(width_)) + 0.5 - circle_->y;
      count += dx * dx + dy * dy > beyond * beyond;
    }
    return count <= kMostBeyond * std::numbers::pi * circle_->radius * circle_->radius;
  }

  const std::vector<std::uint8_t>& mask_;
  int width_, height_;
  double size_;
  std::vector<glm::dvec2> points_;
  std::optional<Circle> circle_;
  double outline_radius_ = 0.0;
  std::size_t agree_ = 0;
};

// Two regions of paint that are spheres both.
std::optional<FoundSphere> TwoSpheres(const PaintMask& mask) {
  const std::array<PaintRegion, 2> regions = LargestRegions(mask);
  if (static_cast<double>(regions[1].size) < std::max(1.0, kLeastOther * static_cast<double>(regions[0].size))) {
    return std::nullopt;
  }
  // Dots and strokes are regions too.
  const auto all = static_cast<std::size_t>(std::ranges::count(mask.values(), std::uint8_t{1}));
  if (2 * (regions[0].size + regions[1].size) < all) return std::nullopt;
  std::array<Circle, 2> circles;
  std::vector<std::uint8_t> left = mask.values();
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<std::uint8_t> alone(left.size(), 0);
    TakeRegion(regions[k].first, mask.width(), mask.height(), left, [&](std::size_t i) { alone[i] = 1; });
    const OutlineFit outline(alone, mask.width(), mask.height());
    if (!outline.IsSure() || outline.Ellipse(kRoundOfSeveral)) return std::nullopt;
    circles[k] = *outline.circle();
  }
  // One inside the other is one sphere, with a ring or a core.
  const glm::dvec2 apart(circles[0].x - circles[1].x, circles[0].y - circles[1].y);
  if (glm::length(apart) < std::max(circles[0].radius, circles[1].radius)) return std::nullopt;
  FoundSphere found{FoundSphere::Kind::kSeveral};
  found.circle = circles[0], found.second = circles[1];
  return found;
}

// Whether all paint but specks lies within so many pixels.
bool IsSmall(const Gaps& gaps, int width, int height) {
  return (1.0 - gaps.of[0] - gaps.of[1]) * width < 2.0 * kLeastRadius &&
         (1.0 - gaps.of[2] - gaps.of[3]) * height < 2.0 * kLeastRadius;
}

FoundSphere Empty(bool is_square) {
  FoundSphere found{is_square ? FoundSphere::Kind::kFills : FoundSphere::Kind::kUnclear};
  if (!is_square) found.doubt = SphereDoubt::kNoCircle;
  return found;
}

bool FillsSquare(const Circle& circle, int size) {
  const double half = 0.5 * size, dx = circle.x - half, dy = circle.y - half, off = std::sqrt(dx * dx + dy * dy);
  const bool aside = off > kOffCentre * size && circle.radius - off < kCovers * half;
  return circle.radius >= kTooSmall * half && !aside;
}

}  // namespace

FoundSphere FindSphere(const Picture& picture) {
  using Kind = FoundSphere::Kind;
  const int width = picture.width, height = picture.height;
  const bool is_square = width == height;
  const BarePaper ground = FindBarePaper(picture);
  FoundSphere no_ground{Kind::kNoGround};
  if (ground.kind == BarePaper::Kind::kCovered) {
    if (HasUnevenCorners(picture)) no_ground.doubt = SphereDoubt::kUnevenGround;
    return no_ground;
  }
  const auto is_paint = [&](int x, int y) { return IsPaint(picture, ground, x, y); };
  if (is_square && GapsOf(width, height, kReaches, is_paint).AllWithin(kReaches)) return {Kind::kFills};
  const PaintMask mask(picture, ground);
  if (!mask.known()) {
    if (HasUnevenCorners(picture)) no_ground.doubt = SphereDoubt::kUnevenGround;
    return no_ground;
  }
  const std::vector<std::uint8_t>& values = mask.values();
  const Gaps gaps = GapsOf(width, height, 1.0, [&](int x, int y) { return values[std::size_t(y) * width + x] != 0; });
  // An empty sheet shows nothing that could lie anywhere else.
  const auto painted = static_cast<double>(std::ranges::count(values, std::uint8_t{1}));
  if (painted < kPaintedLine * static_cast<double>(values.size())) return Empty(is_square);
  const bool clearly_inside = !is_square || gaps.ClearlyInside();
  if (const auto two = TwoSpheres(mask)) return *two;
  const OutlineFit outline(values, width, height);
  if (const auto ellipse = outline.Ellipse(); ellipse && (!is_square || gaps.OppositeBeyond(kFlattened))) {
    FoundSphere found{Kind::kEllipse};
    found.longer = ellipse->longer, found.shorter = ellipse->shorter;
    return found;
  }
  if (!outline.IsSure()) {
    if (!clearly_inside) return {Kind::kFills};
    FoundSphere unclear{Kind::kUnclear};
    unclear.doubt = IsSmall(gaps, width, height) ? SphereDoubt::kSmall : SphereDoubt::kNoCircle;
    if (outline.IsLikely()) {
      unclear.circle = *outline.circle();
      unclear.doubt = DoubtAbout(picture, mask, unclear.circle, 2.0 * outline.tolerance());
    }
    return unclear;
  }
  const Circle line{outline.circle()->x, outline.circle()->y, outline.outline_radius()};
  const bool fills = is_square && FillsSquare(line, width);
  if (!fills && mask.ground().kind == BarePaper::Kind::kPaper && !HasColorStep(picture, line)) {
    FoundSphere uneven{Kind::kUnclear};
    uneven.doubt = SphereDoubt::kUnevenGround;
    return uneven;
  }
  FoundSphere found{fills ? Kind::kFills : Kind::kInside};
  found.circle = *outline.circle();
  return found;
}

}  // namespace scumble
