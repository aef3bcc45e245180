#include "exemplars/paint/engine/hairs.h"

#include <algorithm>
#include <cmath>

namespace scumble::paint {
namespace {

constexpr float kStreakWidth = 3.6f;     // units across
constexpr float kStreakLength = 130.0f;  // and along
constexpr float kLeastMark = 0.03f;      // pressures below it leave no mark

// A path with the values that a hair needs at each of its points.
struct TuftPath {
  explicit TuftPath(const Stroke& path) : aside(path.size()), walked(path.size(), 0.0f) {
    for (std::size_t i = 0; i < path.size(); ++i) {
      const glm::vec2 along = path[std::min(i + 1, path.size() - 1)].at - path[i > 0 ? i - 1 : 0].at;
      aside[i] = glm::vec2(-along.y, along.x) / std::max(glm::length(along), 1e-5f);
      if (i > 0) walked[i] = walked[i - 1] + glm::distance(path[i].at, path[i - 1].at);
    }
  }

  std::vector<glm::vec2> aside;  // unit vectors
  std::vector<float> walked;     // units from the start
};

}  // namespace

std::vector<Stroke> PartIntoHairs(Chance& chance, const Stroke& path, const Tuft& tuft) {
  std::vector<Stroke> hairs;
  if (path.size() < 4) return hairs;
  const TuftPath tuft_path(path);
  const float length = std::max(tuft_path.walked.back(), 1e-3f);
  const int count = std::max(3, static_cast<int>(tuft.width / (tuft.gap * tuft.hair)));
  const std::uint64_t streaks = chance.Draw();
  for (int k = 0; k < count; ++k) {
    const float across = (static_cast<float>(k) + 0.5f) / static_cast<float>(count) - 0.5f;
    const float place = across * tuft.width + chance.Bell(0.35f * tuft.hair);
    const float ink =
        tuft.ink * (1.0f + 2.0f * tuft.side * across) * (1.0f + chance.Bell(0.10f + 0.12f * tuft.dryness));
    // The tuft is round where it starts and ends; if dry, its hairs lift one by one.
    const float round = 0.5f * tuft.width * (1.0f - std::sqrt(1.0f - 4.0f * across * across)) / length;
    const float begin = round + chance.Uniform(0.0f, 0.02f + 0.08f * tuft.dryness);
    const float end = 1.0f - round - chance.Uniform(0.0f, 0.04f + 0.45f * tuft.dryness);
    Stroke hair;
    const auto lift = [&] {
      if (hair.size() > 1) hairs.push_back(hair);
      hair.clear();
    };
    for (std::size_t i = 0; i < path.size(); ++i) {
      const float u = tuft_path.walked[i] / length;
      const float fan = glm::mix(tuft.narrowest, 1.0f, path[i].pressure);
      // Hairs stick together, so the white between them continues as streaks.
      const float touch = SmoothNoise(glm::vec2(place / kStreakWidth, tuft_path.walked[i] / kStreakLength), streaks);
      const float parted = tuft.dryness * (0.48f + 0.60f * u);
      const float pressure = ink * (1.0f - tuft.spent * u) * Ramp(parted - 0.06f, parted + 0.06f, touch);
      if (u < begin || u > end || pressure < kLeastMark) {
        lift();
      } else {
        hair.push_back({path[i].at + tuft_path.aside[i] * place * fan, std::min(pressure, 1.0f)});
      }
    }
    lift();
  }
  return hairs;
}

}  // namespace scumble::paint
