#include "exemplars/paint/engine/even_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scumble::paint {
namespace {

constexpr float kLineStep = 4.0f;  // units between the points of a line
constexpr float kCell = 20.0f;     // of the grid that finds neighbours
constexpr float kWidestSpacing = 60.0f;
constexpr std::size_t kMostSteps = 500;  // a line each way: a flow may go round in circles

// Occupied points, in a grid that is a little larger than the picture.
class Taken {
 public:
  explicit Taken(float margin)
      : origin_(-margin - kWidestSpacing), side_(static_cast<int>((kSide - 2.0f * origin_) / kCell) + 1) {
    cells_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
  }

  void Add(glm::vec2 at) { cells_[Index(CellOf(at.x), CellOf(at.y))].push_back(at); }

  bool AnyWithin(glm::vec2 at, float distance) const {
    for (int y = CellOf(at.y - distance); y <= CellOf(at.y + distance); ++y) {
      for (int x = CellOf(at.x - distance); x <= CellOf(at.x + distance); ++x) {
        for (const glm::vec2 other : cells_[Index(x, y)]) {
          if (glm::distance(at, other) < distance) return true;
        }
      }
    }
    return false;
  }

 private:
  int CellOf(float coordinate) const {
    return std::clamp(static_cast<int>((coordinate - origin_) / kCell), 0, side_ - 1);
  }
  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x);
  }

  float origin_;
  int side_;
  std::vector<std::vector<glm::vec2>> cells_;
};

class Planner {
 public:
  Planner(const Flow& flow, const Touch& spacing, const EvenLineOptions& options)
      : flow_(flow), spacing_(spacing), options_(options), taken_(options.margin) {}

  // A line through `seed`, if there is room for it.
  void TryLine(glm::vec2 seed) {
    const float room = Spacing(seed);
    // Slightly less: otherwise rounding would refuse a place at exactly this distance from a line.
    if (room <= 0.0f || taken_.AnyWithin(seed, 0.98f * room)) return;
    Stroke line = Walk(seed, -1.0f);
    std::reverse(line.begin(), line.end());
    line.push_back({seed, 1.0f});
    const Stroke onward = Walk(seed, 1.0f);
    line.insert(line.end(), onward.begin(), onward.end());
    if (static_cast<float>(line.size()) * kLineStep < options_.shortest) return;
    for (const StrokePoint& point : line) taken_.Add(point.at);
    lines_.push_back(std::move(line));
  }

  // Adds lines beside each line, until no gap has room for one.
  void FillBeside() {
    for (; filled_ < lines_.size(); ++filled_) {
      // By index: lines_ grows meanwhile.
      for (std::size_t i = 1; i < lines_[filled_].size(); i += 3) {
        const glm::vec2 at = lines_[filled_][i].at;
        const glm::vec2 way = (at - lines_[filled_][i - 1].at) / kLineStep;
        const glm::vec2 aside = glm::vec2(-way.y, way.x) * Spacing(at);
        TryLine(at + aside);
        TryLine(at - aside);
      }
    }
  }

  std::vector<Stroke> Take() { return std::move(lines_); }

 private:
  float Spacing(glm::vec2 at) const {
    const bool inside = std::min(at.x, at.y) > -options_.margin && std::max(at.x, at.y) < kSide + options_.margin;
    return inside ? std::min(spacing_(at), kWidestSpacing) : 0.0f;
  }

  Stroke Walk(glm::vec2 at, float sign) const {
    Stroke part;
    glm::vec2 heading = flow_(at) * sign;
    while (part.size() < kMostSteps) {
      glm::vec2 next = flow_(at);
      // A flow may turn round at its pole; the hand does not.
      if (glm::dot(next, heading) < 0.0f) next = -next;
      heading = next;
      at += next * (kLineStep / std::max(glm::length(next), 1e-5f));
      const float room = Spacing(at);
      if (room <= 0.0f || taken_.AnyWithin(at, options_.closest * room)) break;
      part.push_back({at, 1.0f});
    }
    return part;
  }

  const Flow& flow_;
  const Touch& spacing_;
  EvenLineOptions options_;
  Taken taken_;
  std::vector<Stroke> lines_;
  std::size_t filled_ = 0;
};

}  // namespace

std::vector<Stroke> PlanEvenLines(Chance& chance, const Flow& flow, const Touch& spacing,
                                  const EvenLineOptions& options) {
  Planner planner(flow, spacing, options);
  for (const glm::vec2 place : SowEvenly(chance, 16.0f, kSide, options.margin)) {
    planner.TryLine(place);
    planner.FillBeside();
  }
  return planner.Take();
}

}  // namespace scumble::paint
