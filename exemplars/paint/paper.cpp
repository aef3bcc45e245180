#include "exemplars/paint/paper.h"

#include <algorithm>
#include <cmath>

#include "exemplars/paint/chance.h"

namespace scumble::paint {
namespace {

float RawHeight(Tooth tooth, glm::vec2 at, std::uint64_t seed) {
  switch (tooth) {
    case Tooth::kLaid: {
      const float fibres = 0.5f * SmoothNoise(at * glm::vec2(2.4f, 0.7f), Hash(seed, 1)) +
                           0.5f * SmoothNoise(at * glm::vec2(0.7f, 2.4f), Hash(seed, 2));
      return 0.55f * CloudNoise(at, 3, Hash(seed, 3)) + 0.45f * fibres;
    }
    case Tooth::kFine:
      return CloudNoise(at, 3, Hash(seed, 1));
    case Tooth::kColdPress: {
      const glm::vec2 bend(CloudNoise(at * 0.3f, 2, Hash(seed, 1)), CloudNoise(at * 0.3f, 2, Hash(seed, 2)));
      const float hollows = std::fabs(2.0f * SmoothNoise(at + 2.0f * bend, Hash(seed, 3)) - 1.0f);
      return 0.55f * hollows + 0.45f * CloudNoise(at * 1.9f, 2, Hash(seed, 4));
    }
  }
  return 0.5f;
}

}  // namespace

Field MakeTooth(int size, Tooth tooth, float period, std::uint64_t seed) {
  Field field(size);
  double sum = 0.0;
  double squares = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float height = RawHeight(tooth, field.Place(x, y) / period, seed);
      field.At(x, y) = height;
      sum += height;
      squares += static_cast<double>(height) * height;
    }
  }
  const double count = static_cast<double>(field.pixels.size());
  const double mean = sum / count;
  const double deviation = std::sqrt(std::max(squares / count - mean * mean, 1e-12));
  for (float& height : field.pixels) {
    height = glm::clamp(0.5f + 0.25f * static_cast<float>((height - mean) / deviation), 0.0f, 1.0f);
  }
  return field;
}

Colors MakePaper(const Field& tooth, glm::vec3 color, float relief, std::uint64_t seed) {
  Colors paper(tooth.size);
  for (int y = 0; y < tooth.size; ++y) {
    for (int x = 0; x < tooth.size; ++x) {
      const float slope =
          0.6f * (tooth.Near(x + 1, y) - tooth.Near(x - 1, y)) + 0.8f * (tooth.Near(x, y + 1) - tooth.Near(x, y - 1));
      const float mottle = 0.03f * (CloudNoise(paper.Place(x, y) / 60.0f, 3, seed) - 0.5f);
      paper.At(x, y) = color * (1.0f + mottle + relief * slope + 0.3f * relief * (tooth.At(x, y) - 0.5f));
    }
  }
  return paper;
}

}  // namespace scumble::paint
