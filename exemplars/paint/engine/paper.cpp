#include "exemplars/paint/engine/paper.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "exemplars/paint/engine/chance.h"

namespace scumble::paint {
namespace {

// A pixel's place in noise whose features are `period` units wide.
template <class T>
NoisePlace PlaceIn(const Raster<T>& raster, int x, int y, float period) {
  const glm::vec2 at = raster.Place(x, y);
  if (!raster.sheet.tile) return {at / period};
  const float repeat = std::max(1.0f, std::round(raster.sheet.units / period));
  return {at * (repeat / raster.sheet.units), glm::vec2(repeat)};
}

float RawHeight(Tooth tooth, const NoisePlace& place, std::uint64_t seed) {
  switch (tooth) {
    case Tooth::kLaid: {
      const float fibres = 0.5f * SmoothNoise(place.Finer({2.4f, 0.7f}), Hash(seed, 1)) +
                           0.5f * SmoothNoise(place.Finer({0.7f, 2.4f}), Hash(seed, 2));
      return 0.55f * CloudNoise(place, 3, Hash(seed, 3)) + 0.45f * fibres;
    }
    case Tooth::kFine:
      return CloudNoise(place, 3, Hash(seed, 1));
    case Tooth::kRibbed: {
      const NoisePlace ribs = place.Finer({0.22f, 0.62f});
      const float sway = 0.5f * SmoothNoise(ribs.Finer({0.3f, 0.1f}), Hash(seed, 1));
      const float rib = 0.5f + 0.5f * std::cos(2.0f * std::numbers::pi_v<float> * (ribs.at.y + sway));
      const float worn = 0.4f + 0.6f * SmoothNoise(ribs, Hash(seed, 2));
      return 0.85f * CloudNoise(place, 3, Hash(seed, 3)) + 0.13f * rib * worn;
    }
    case Tooth::kColdPress: {
      const NoisePlace wide = place.Finer(glm::vec2(0.3f));
      const glm::vec2 bend(CloudNoise(wide, 2, Hash(seed, 1)), CloudNoise(wide, 2, Hash(seed, 2)));
      const NoisePlace bent{place.at + 2.0f * bend, place.repeat};
      const float hollows = std::fabs(2.0f * SmoothNoise(bent, Hash(seed, 3)) - 1.0f);
      return 0.55f * hollows + 0.45f * CloudNoise(place.Finer(glm::vec2(1.9f)), 2, Hash(seed, 4));
    }
  }
  return 0.5f;
}

}  // namespace

Field MakeTooth(const Sheet& sheet, const Stock& stock, std::uint64_t seed) {
  Field field(sheet);
  double sum = 0.0;
  double squares = 0.0;
  for (int y = 0; y < field.size; ++y) {
    for (int x = 0; x < field.size; ++x) {
      const float height = RawHeight(stock.tooth, PlaceIn(field, x, y, stock.period), seed);
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

Colors MakePaper(const Field& tooth, const Stock& stock, std::uint64_t seed) {
  const float relief = stock.relief;
  // A cloud that repeats in every tile is noticed quickly.
  const float clouds = tooth.sheet.tile ? 0.008f : 0.03f;
  Colors paper(tooth.sheet);
  for (int y = 0; y < tooth.size; ++y) {
    for (int x = 0; x < tooth.size; ++x) {
      const float slope =
          0.6f * (tooth.Near(x + 1, y) - tooth.Near(x - 1, y)) + 0.8f * (tooth.Near(x, y + 1) - tooth.Near(x, y - 1));
      const float mottle = clouds * (CloudNoise(PlaceIn(paper, x, y, 60.0f), 3, seed) - 0.5f);
      paper.At(x, y) = stock.color * (1.0f + mottle + relief * slope + 0.3f * relief * (tooth.At(x, y) - 0.5f));
    }
  }
  return paper;
}

Ground PrepareGround(const Sheet& sheet, const Stock& stock, std::uint64_t seed) {
  Field tooth = MakeTooth(sheet, stock, Hash(seed, 0));
  Colors paper = MakePaper(tooth, stock, Hash(seed, 1));
  return {std::move(tooth), std::move(paper)};
}

Picture PaperTile(const Studio& studio, const Stock& stock) {
  return ToPicture(PrepareGround(TileFor(studio.size), stock, studio.seed).paper);
}

}  // namespace scumble::paint
