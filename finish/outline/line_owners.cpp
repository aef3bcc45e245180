#include "finish/outline/line_owners.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace scumble::internal {
namespace {

constexpr std::ptrdiff_t kVoters = 8;  // points to each side

class Owners {
 public:
  Owners(const GuideSet& guides, LineChain& chain)
      : chain_(chain), object_(guides.Plane(Layer::kObject)), width_(guides.width()) {}

  void Settle() {
    const auto& points = chain_.points;
    for (std::size_t from = 0, to; from < points.size(); from = to) {
      for (to = from + 1; to < points.size() && IsOfOnePair(from, to); ++to) continue;
      if (points[from].line == LineClass::kObject) Settle(from, to);
    }
  }

 private:
  std::size_t OtherOf(const LinePoint& point) const { return OtherSide(point, width_); }
  std::pair<float, float> PairOf(std::size_t i) const {
    return std::minmax({object_[chain_.points[i].owner], object_[OtherOf(chain_.points[i])]});
  }
  bool IsOfOnePair(std::size_t i, std::size_t j) const {
    return chain_.points[i].line == chain_.points[j].line && PairOf(i) == PairOf(j);
  }
  bool IsOfFirst(std::size_t i) const { return object_[chain_.points[i].owner] == PairOf(i).first; }

  // The points [from, to) lie between two objects.
  void Settle(std::size_t from, std::size_t to) {
    auto& points = chain_.points;
    const auto begin = points.begin() + std::ptrdiff_t(from), end = points.begin() + std::ptrdiff_t(to);
    const bool all_meet = std::all_of(begin, end, [](const LinePoint& point) { return point.meets; });
    votes_.assign(to - from, 0);
    int most = 0;
    for (std::size_t i = from; i < to; ++i) {
      if (points[i].meets && !all_meet) continue;
      most += votes_[i - from] = IsOfFirst(i) ? 1 : -1;
    }
    for (std::size_t i = from; i < to; ++i) {
      if (points[i].meets && most != 0) votes_[i - from] = most < 0 ? -1 : 1;
    }
    const auto count = std::ptrdiff_t(to - from);
    const bool is_ring = chain_.closed && to - from == points.size();
    const auto vote = [&](std::ptrdiff_t i) {
      if (is_ring) return votes_[std::size_t((i % count + count) % count)];
      return i < 0 || i >= count ? 0 : votes_[std::size_t(i)];
    };
    int sum = 0;
    for (std::ptrdiff_t k = -kVoters; k < kVoters; ++k) sum += vote(k);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      sum += vote(i + kVoters);
      const std::size_t at = from + std::size_t(i);
      if (sum != 0 && IsOfFirst(at) != (sum > 0)) GiveToOther(points[at]);
      sum -= vote(i - kVoters);
    }
  }

  void GiveToOther(LinePoint& point) {
    point.owner = static_cast<std::uint32_t>(OtherOf(point));
    point.to_owner = -point.to_owner, point.shift = -point.shift;
  }

  LineChain& chain_;
  std::span<const float> object_;
  int width_;
  std::vector<int> votes_;
};

}  // namespace

void SettleOwners(const GuideSet& guides, LineChain& chain) { Owners(guides, chain).Settle(); }

}  // namespace scumble::internal
