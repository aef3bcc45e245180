#include "finish/outline/border_joiners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <vector>

#include "finish/outline/border_grid.h"

namespace scumble::internal {
namespace {

constexpr std::uint8_t kCrease = CodeOf(LineClass::kCrease), kOcclusion = CodeOf(LineClass::kOcclusion);
constexpr std::uint8_t kJoined = 0x80;   // of a line of steps
constexpr std::uint8_t kOwnCode = 0x3f;  // what else a border is
constexpr std::size_t kLongestGap = 2;   // borders

class StepJoiner {
 public:
  StepJoiner(const GuideSet& guides, std::span<const std::uint8_t> only, double shortest, const DepthTolerance& least,
             BorderMap& map)
      : grid_(map),
        only_(only),
        coverage_(guides.Plane(Layer::kCoverage)),
        depth_(guides.Plane(Layer::kDepth)),
        object_(guides.Plane(Layer::kObject)),
        shortest_(shortest),
        least_(least) {}

  void Run() {
    grid_.ForEachBorder([&](const Border& border) {
      if (grid_.At(border) == kOcclusion) Join(border, shortest_);
    });
    while (!todo_.empty()) {
      const Border border = todo_.back();
      todo_.pop_back();
      for (const Corner& end : BorderGrid::Corners(border)) GoOnFrom(border, end);
    }
    grid_.ForEachBorder([&](const Border& border) {
      std::uint8_t& code = grid_.At(border);
      const std::uint8_t own = code & kOwnCode;
      code = own == 0 && (code & kJoined) != 0 ? kOcclusion : own;
    });
  }

 private:
  std::uint8_t OwnCode(const Border& border) { return grid_.At(border) & kOwnCode; }
  bool IsStep(const Border& border) { return (grid_.At(border) & kWeakStep) != 0 || OwnCode(border) == kOcclusion; }
  bool IsJoined(const Border& border) { return (grid_.At(border) & kJoined) != 0; }
  bool IsLine(const Border& border) { return IsJoined(border) || OwnCode(border) != 0; }
  int LinesAt(const Corner& corner) {
    int lines = 0;
    grid_.ForEachAt(corner, [&](const Border& border) { lines += IsLine(border) ? 1 : 0; });
    return lines;
  }

  // Joins that step and those that lie end to end with it and are lines already, if these are `shortest` or more.
  void Join(const Border& first, double shortest) {
    const std::size_t begin = todo_.size();
    todo_.push_back(first);
    grid_.At(first) |= kJoined;
    for (std::size_t i = begin; i < todo_.size(); ++i) {
      for (const Corner& end : BorderGrid::Corners(todo_[i])) {
        grid_.ForEachAt(end, [&](const Border& next) {
          if (!IsStep(next) || OwnCode(next) == 0 || IsJoined(next)) return;
          grid_.At(next) |= kJoined;
          todo_.push_back(next);
        });
      }
    }
    if (double(todo_.size() - begin) >= shortest) return;
    for (std::size_t i = begin; i < todo_.size(); ++i) grid_.At(todo_[i]) &= static_cast<std::uint8_t>(~kJoined);
    todo_.resize(begin);
  }

  // Where a line of steps ends there: lets it go on to the clearest weak step, or over as few borders as possible to a
  // step ahead. Elsewhere a weak step would be a second line beside the first.
  void GoOnFrom(const Border& last, const Corner& end) {
    before_ = BorderGrid::OtherEnd(last, end), end_ = end;
    if (LinesAt(end) != 1 || LinesAt(before_) != 2) return;
    best_change_ = 0.0f;
    grid_.ForEachAt(end, [&](const Border& step) {
      if (IsLine(step) || !IsStep(step)) return;
      const float change = ChangeAt(step);
      if (change > best_change_) best_step_ = step, best_change_ = change;
    });
    if (best_change_ > 0.0f) return Join(best_step_, 0.0);
    for (std::size_t length = 1; length <= kLongestGap && best_change_ == 0.0f; ++length)
      FindBridge(end, length, std::numeric_limits<float>::infinity());
    if (best_change_ == 0.0f) return;
    for (const Border& border : best_gap_) {
      grid_.At(border) = kOcclusion | kJoined;
      todo_.push_back(border);
    }
    if (!IsJoined(best_step_)) Join(best_step_, 0.0);
  }

  // Of the ways on from the corner over `length` more borders to a step, the one with the clearest borders.
  // `change`: the smallest one of depth so far, in tolerances.
  void FindBridge(const Corner& corner, std::size_t length, float change) {
    grid_.ForEachPlaceAt(corner, [&](const Border& border) {
      const Corner next = BorderGrid::OtherEnd(border, corner);
      if (!IsAhead(next) || !MayBeStep(border)) return;
      const float here = ChangeAt(border), least = std::min(change, here);
      if (!(here > 1.0f)) return;
      gap_.push_back(border);
      if (length > 1) FindBridge(next, length - 1, least);
      if (length == 1 && least > best_change_) {
        grid_.ForEachAt(next, [&](const Border& step) {
          if (!IsStep(step) || !LeadsOn(BorderGrid::OtherEnd(step, next))) return;
          best_gap_ = gap_, best_step_ = step, best_change_ = least;
        });
      }
      gap_.pop_back();
    });
  }
  bool IsAhead(const Corner& corner) const {
    return (corner.x - end_.x) * (end_.x - before_.x) + (corner.y - end_.y) * (end_.y - before_.y) >= 0;
  }
  // And not round a pixel.
  bool LeadsOn(const Corner& corner) const {
    return IsAhead(corner) && std::abs(corner.x - before_.x) + std::abs(corner.y - before_.y) > 1;
  }
  // Whether nothing is known against a step there.
  bool MayBeStep(const Border& border) {
    const std::size_t p = grid_.First(border), q = grid_.Second(border);
    if (IsLine(border) || IsStep(border) || !(coverage_[p] > 0.0f) || !(coverage_[q] > 0.0f)) return false;
    return object_[p] == object_[q] && (only_.empty() || (only_[p] && only_[q]));
  }
  // Of depth, in tolerances.
  float ChangeAt(const Border& border) const {
    const float p = depth_[grid_.First(border)], q = depth_[grid_.Second(border)];
    return std::fabs(q - p) / least_.At(std::min(p, q));
  }

  BorderGrid grid_;
  std::span<const std::uint8_t> only_;
  std::span<const float> coverage_, depth_, object_;
  double shortest_;
  DepthTolerance least_;
  std::vector<Border> todo_, gap_, best_gap_;
  Corner before_{}, end_{};  // of the last border of a line
  Border best_step_{};
  float best_change_ = 0.0f;
};

class CreaseJoiner {
 public:
  CreaseJoiner(std::span<const float> object, BorderMap& map) : object_(object), grid_(map) {}

  void Run() {
    grid_.ForEachBorder([&](const Border& border) {
      if (OwnCode(border) == kCrease || OwnCode(border) == kOcclusion) Follow(border);
    });
    grid_.ForEachBorder([&](const Border& border) {
      if (OwnCode(border) >= kFullCrease) SetOwnCode(border, 0);
    });
  }

 private:
  std::uint8_t OwnCode(const Border& border) { return grid_.At(border) & kOwnCode; }
  void SetOwnCode(const Border& border, std::uint8_t code) {
    grid_.At(border) = static_cast<std::uint8_t>((grid_.At(border) & ~kOwnCode) | code);
  }

  void Follow(const Border& from) {
    todo_.assign(1, from);
    while (!todo_.empty()) {
      const Border at = todo_.back();
      todo_.pop_back();
      const std::uint8_t last = OwnCode(at) == kOcclusion ? kFullCrease : kWeakCrease;
      for (const Corner& end : BorderGrid::Corners(at)) {
        grid_.ForEachAt(end, [&](const Border& next) {
          // A crease has the same object on both of its sides.
          if (OwnCode(next) < kFullCrease || OwnCode(next) > last) return;
          if (object_[grid_.First(next)] != object_[grid_.First(at)]) return;
          SetOwnCode(next, kCrease);
          todo_.push_back(next);
        });
      }
    }
  }

  std::span<const float> object_;
  BorderGrid grid_;
  std::vector<Border> todo_;
};

}  // namespace

void JoinSteps(const GuideSet& guides, std::span<const std::uint8_t> only, double shortest, const DepthTolerance& least,
               BorderMap& map) {
  StepJoiner(guides, only, shortest, least, map).Run();
}

void JoinCreases(std::span<const float> object, BorderMap& map) { CreaseJoiner(object, map).Run(); }

}  // namespace scumble::internal
