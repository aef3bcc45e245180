#include "measure/flat_surfaces.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <span>

namespace scumble {
namespace {

// Its cosine. The rule equals the transfer's IsFlat (transfer/match/variety.cpp); a test compares them.
constexpr float kHalfADegree = 0.99996192f;

struct Step {
  int x = 0, y = 0;
};
constexpr Step kSides[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
constexpr Step kCorners[] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

class Surfaces {
 public:
  Surfaces(const GuideSet& guides, int reach)
      : guides_(guides),
        reach_(reach),
        coverage_(guides.Plane(Layer::kCoverage)),
        object_(guides.Plane(Layer::kObject)) {}

  bool IsFlatAllRound(int x, int y) const {
    return std::all_of(std::begin(kSides), std::end(kSides), [&](Step step) {
      const int to_x = x + step.x * reach_, to_y = y + step.y * reach_;
      return !Inside(to_x, to_y) || Continues(guides_.Index(x, y), guides_.Index(to_x, to_y));
    });
  }
  bool ReachesAny(int x, int y, std::span<const Step> steps, const std::vector<std::uint8_t>& flat) const {
    return std::any_of(steps.begin(), steps.end(), [&](Step step) {
      const int to_x = x + step.x * reach_, to_y = y + step.y * reach_;
      if (!Inside(to_x, to_y)) return false;
      const std::size_t there = guides_.Index(to_x, to_y);
      return flat[there] && Continues(guides_.Index(x, y), there);
    });
  }

 private:
  bool Inside(int x, int y) const { return x >= 0 && y >= 0 && x < guides_.width() && y < guides_.height(); }
  bool Continues(std::size_t here, std::size_t there) const {
    return coverage_[there] > 0.0f && object_[there] == object_[here] &&
           glm::dot(guides_.Vec3(Layer::kNormal, here), guides_.Vec3(Layer::kNormal, there)) > kHalfADegree;
  }

  const GuideSet& guides_;
  const int reach_;
  const std::span<const float> coverage_, object_;
};

}  // namespace

std::vector<std::uint8_t> FlatSurfaces(const GuideSet& guides, int reach) {
  const Surfaces surfaces(guides, reach);
  const auto coverage = guides.Plane(Layer::kCoverage);
  const auto marked = [&](const auto& is_flat) {
    std::vector<std::uint8_t> flat(guides.pixel_count(), 0);
    for (int y = 0; y < guides.height(); ++y) {
      for (int x = 0; x < guides.width(); ++x) {
        const std::size_t i = guides.Index(x, y);
        flat[i] = coverage[i] > 0.0f && is_flat(x, y, i);
      }
    }
    return flat;
  };
  const auto all_round = marked([&](int x, int y, std::size_t) { return surfaces.IsFlatAllRound(x, y); });
  return marked([&](int x, int y, std::size_t i) {
    return all_round[i] || surfaces.ReachesAny(x, y, kSides, all_round) ||
           surfaces.ReachesAny(x, y, kCorners, all_round);
  });
}

}  // namespace scumble
