#include "measure/guided_texture.h"

#include <hwy/contrib/sort/vqsort.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/image/guides.h"
#include "core/image/hash.h"
#include "measure/texture/normal_tone.h"
#include "measure/texture/paint_pyramid.h"

namespace scumble {
namespace internal {

using FeatureWeights = std::vector<float>;  // of a group's features
inline constexpr std::size_t kQuantiles = 64, kCells = 52;
using Quantiles = std::array<float, kQuantiles>;

// The distributions of one group of an exemplar's features.
struct Distributions {
  std::vector<FeatureWeights> slices;
  std::array<std::vector<Quantiles>, kCells> cells;  // by slice; empty: too few pixels
};

struct OneExemplar {
  NormalTone tone;
  std::array<Distributions, 1 + kOctaves> groups;
  float condition;  // the first of its guides beside normals
};

}  // namespace internal
namespace {

using internal::Distributions;
using internal::FeatureGroup;
using internal::FeaturesOf;
using internal::FeatureWeights;
using internal::kCells;
using internal::kNoSurface;
using internal::kOctaves;
using internal::kQuantiles;
using internal::NormalTone;
using internal::OneExemplar;
using internal::PaintFeatures;
using internal::Quantiles;
using internal::Surface;
using internal::SurfaceOf;

// Rings of equal area on the disc of normals, from the middle out, and the cells of each.
constexpr std::size_t kRings = 5;
constexpr int kCellsOfRing[kRings] = {4, 8, 12, 12, 16};
constexpr std::size_t kGroups = 1 + kOctaves;
constexpr int kDirections = 8;  // of slices, besides the features' own axes
// A cell counts where either side has so many pixels, and takes so many at most, evenly.
constexpr std::size_t kLeastPixels = 100, kMostPixels = 2000;
// Deviations are taken to be so large at least: paint of one tone may vary a little.
constexpr double kLeastTone = 0.05, kLeastStroke = 0.002;
constexpr int kBlock = 24;  // pixels, of halves of an exemplar

std::size_t CellOf(float x, float y) {
  const auto ring = std::size_t(std::clamp(kRings * (x * x + y * y), 0.0f, kRings - 1.0f));
  int first = 0;
  for (std::size_t k = 0; k < ring; ++k) first += kCellsOfRing[k];
  // The way round a square instead of a circle: no angle is needed.
  const float length = std::abs(x) + std::abs(y);
  const float along = length > 0.0f ? x / length : 1.0f;
  const float turn = y >= 0.0f ? 1.0f - along : 3.0f + along;  // 0 … 4
  const int count = kCellsOfRing[ring];
  return std::size_t(first + std::min(count - 1, int(0.25f * turn * float(count))));
}

using Pixels = std::vector<std::uint32_t>;
using CellPixels = std::array<Pixels, kCells>;

// The pixels of a group that have this exemplar and `count`, by cell.
template <class Counts>
CellPixels PixelsOf(const FeatureGroup& group, std::uint8_t exemplar, const Counts& counts) {
  CellPixels cells;
  for (std::size_t i = 0; i < group.exemplar.size(); ++i) {
    if (group.exemplar[i] == exemplar && counts(i))
      cells[CellOf(group.normal[0][i], group.normal[1][i])].push_back(std::uint32_t(i));
  }
  return cells;
}

std::vector<double> DeviationsOf(const FeatureGroup& group, const CellPixels& cells, double least) {
  std::vector<double> deviations(group.count());
  tbb::parallel_for(std::size_t{0}, deviations.size(), [&](std::size_t f) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (const Pixels& pixels : cells) {
      for (const std::uint32_t i : pixels) {
        const double value = group.At(f, i);
        sum += value, squares += value * value, count += 1.0;
      }
    }
    const double mean = count > 0.0 ? sum / count : 0.0;
    const double variance = count > 0.0 ? std::max(0.0, squares / count - mean * mean) : 0.0;
    deviations[f] = std::max(least, std::sqrt(variance));
  });
  return deviations;
}

// The axes and some random directions, over features that are divided by their deviations.
std::vector<FeatureWeights> SlicesOf(const std::vector<double>& deviations, std::size_t group) {
  std::vector<FeatureWeights> slices;
  for (std::size_t f = 0; f < deviations.size(); ++f) {
    slices.emplace_back(deviations.size(), 0.0f)[f] = float(1.0 / deviations[f]);
  }
  for (int d = 0; d < kDirections; ++d) {
    std::vector<double> direction;
    double squared = 0.0;
    for (std::size_t f = 0; f < deviations.size(); ++f) {
      double sum = -2.0;  // of four uniform numbers, less their mean: nearly normal
      for (int k = 0; k < 4; ++k) sum += UnitFloat(Hash(int(group), d, f, k));
      direction.push_back(sum), squared += sum * sum;
    }
    FeatureWeights& weights = slices.emplace_back();
    for (std::size_t f = 0; f < deviations.size(); ++f) {
      weights.push_back(float(direction[f] / (std::sqrt(squared) * deviations[f])));
    }
  }
  return slices;
}

// The features of a cell's pixels, kMostPixels at most, evenly: by feature, a value for each pixel.
std::vector<std::vector<float>> SampledFeatures(const FeatureGroup& group, const Pixels& pixels) {
  const std::size_t count = std::min(pixels.size(), kMostPixels);
  std::vector<std::vector<float>> features(group.count(), std::vector<float>(count));
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = pixels[k * pixels.size() / count];
    for (std::size_t f = 0; f < features.size(); ++f) features[f][k] = group.At(f, i);
  }
  return features;
}

Quantiles QuantilesOf(const std::vector<std::vector<float>>& features, const FeatureWeights& weights) {
  const std::size_t count = features[0].size();
  std::vector<float> values(count);
  for (std::size_t f = 0; f < weights.size(); ++f) {
    if (weights[f] == 0.0f) continue;
    for (std::size_t k = 0; k < count; ++k) values[k] += weights[f] * features[f][k];
  }
  hwy::Sorter()(values.data(), count, hwy::SortAscending());
  Quantiles quantiles;
  for (std::size_t q = 0; q < kQuantiles; ++q) quantiles[q] = values[(2 * q + 1) * count / (2 * kQuantiles)];
  return quantiles;
}

Distributions DistributionsOf(const FeatureGroup& group, std::size_t number, const CellPixels& cells) {
  Distributions result;
  result.slices = SlicesOf(DeviationsOf(group, cells, number == 0 ? kLeastTone : kLeastStroke), number);
  tbb::parallel_for(std::size_t{0}, kCells, [&](std::size_t cell) {
    if (cells[cell].size() < kLeastPixels) return;
    const auto features = SampledFeatures(group, cells[cell]);
    for (const FeatureWeights& weights : result.slices) result.cells[cell].push_back(QuantilesOf(features, weights));
  });
  return result;
}

// The sum over the cells of a picture of their distances. A cell weighs what the root of its area does: a wall has one
// normal however large it is, and round things have few pixels for each of theirs.
struct GroupSum {
  double distance = 0.0, weight = 0.0;
  std::size_t blocks = 0;

  void Add(const Distributions& exemplar, const FeatureGroup& group, const CellPixels& cells, int octave) {
    std::array<double, kCells> of_cell = {};
    tbb::parallel_for(std::size_t{0}, kCells, [&](std::size_t cell) {
      if (cells[cell].size() < kLeastPixels || exemplar.cells[cell].empty()) return;
      const auto features = SampledFeatures(group, cells[cell]);
      for (std::size_t s = 0; s < exemplar.slices.size(); ++s) {
        const Quantiles here = QuantilesOf(features, exemplar.slices[s]);
        for (std::size_t q = 0; q < kQuantiles; ++q) of_cell[cell] += std::abs(here[q] - exemplar.cells[cell][s][q]);
      }
      of_cell[cell] /= double(kQuantiles * exemplar.slices.size());
    });
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      if (cells[cell].size() < kLeastPixels || exemplar.cells[cell].empty()) continue;
      const double root = std::sqrt(double(cells[cell].size())) * double(1 << octave);  // of pixels, not of blocks
      distance += root * of_cell[cell], weight += root, blocks += cells[cell].size();
    }
  }
  double Mean() const { return weight > 0.0 ? distance / weight : 0.0; }
};

using GroupSums = std::array<GroupSum, kGroups>;

double MeanOf(const GroupSums& sums) {
  GroupSum all;
  for (const GroupSum& one : sums) all.distance += one.distance, all.weight += one.weight;
  return all.Mean();
}

int OctaveOf(std::size_t group) { return group == 0 ? 0 : int(group) - 1; }

}  // namespace

struct GuidedTexture::Impl {
  std::vector<OneExemplar> exemplars;
  std::optional<double> floor;
};

GuidedTexture::GuidedTexture(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GuidedTexture::~GuidedTexture() = default;
GuidedTexture::GuidedTexture(GuidedTexture&&) noexcept = default;
GuidedTexture& GuidedTexture::operator=(GuidedTexture&&) noexcept = default;

Expected<GuidedTexture> GuidedTexture::Of(std::span<const EnergyExemplar> exemplars, int threads) {
  if (exemplars.empty()) return InputError("a texture distance needs an exemplar, and there is none");
  if (exemplars.size() >= internal::kNoExemplar) {
    return InputError("a texture distance takes fewer than 255 exemplars, and there are " +
                      std::to_string(exemplars.size()));
  }
  for (const EnergyExemplar& exemplar : exemplars) {
    const std::size_t pixels = std::size_t(exemplar.picture->width) * std::size_t(exemplar.picture->height);
    if (exemplar.usable.size() != pixels || exemplar.normal[0].size() != pixels ||
        exemplar.normal[1].size() != pixels || exemplar.normal[2].size() != pixels) {
      return InputError("a texture distance: the exemplar has " + std::to_string(pixels) +
                        " pixels, and its planes have another number of values");
    }
  }
  auto impl = std::make_unique<Impl>();
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    GroupSums halves;
    for (const EnergyExemplar& exemplar : exemplars) {
      std::vector<Surface> surface(exemplar.usable.size());
      for (std::size_t i = 0; i < surface.size(); ++i) surface[i] = exemplar.usable[i] ? SurfaceOf(0, 0) : kNoSurface;
      NormalTone tone(*exemplar.picture, exemplar.normal, exemplar.usable);
      const NormalTone* const tones[] = {&tone};
      const PaintFeatures features = FeaturesOf(*exemplar.picture, exemplar.normal, std::move(surface), tones);
      OneExemplar one{std::move(tone), {}, 0.0f};
      if (!exemplar.more_guides.empty()) {
        const auto first = std::find_if(exemplar.usable.begin(), exemplar.usable.end(), [](auto u) { return u != 0; });
        if (first != exemplar.usable.end()) {
          one.condition = exemplar.more_guides[0][std::size_t(first - exemplar.usable.begin())];
        }
      }
      for (std::size_t g = 0; g < kGroups; ++g) {
        const int octave = OctaveOf(g);
        const auto width = std::size_t(exemplar.picture->width >> octave), block = std::size_t(kBlock >> octave);
        const auto half = [&](std::size_t i) { return (i % width / block + i / width / block) % 2; };
        one.groups[g] = DistributionsOf(features[g], g, PixelsOf(features[g], 0, [](std::size_t) { return true; }));
        const Distributions first =
            DistributionsOf(features[g], g, PixelsOf(features[g], 0, [&](std::size_t i) { return half(i) == 0; }));
        halves[g].Add(first, features[g], PixelsOf(features[g], 0, [&](std::size_t i) { return half(i) == 1; }),
                      octave);
      }
      impl->exemplars.push_back(std::move(one));
    }
    const auto counts = [](const GroupSum& one) { return one.weight > 0.0; };
    if (std::any_of(halves.begin(), halves.end(), counts)) impl->floor = MeanOf(halves);
  });
  return GuidedTexture(std::move(impl));
}

Expected<GuidedTextureReport> GuidedTexture::Measure(const EnergyTarget& target, std::span<const float> surface,
                                                     int threads) const {
  const std::size_t pixels = std::size_t(target.picture->width) * std::size_t(target.picture->height);
  const bool has_conditions = impl_->exemplars.size() > 1 && !target.more_guides.empty();
  if (surface.size() != pixels || target.coverage.size() != pixels || target.normal[0].size() != pixels ||
      target.normal[1].size() != pixels || (has_conditions && target.more_guides[0].size() != pixels)) {
    return InputError("a texture distance: the picture has " + std::to_string(pixels) +
                      " pixels, and its guides have another number of values");
  }
  GroupSums sums;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    const std::vector<OneExemplar>& exemplars = impl_->exemplars;
    const auto nearest = [&](std::size_t i) -> std::uint8_t {
      if (!has_conditions) return 0;
      const float wanted = target.more_guides[0][i];
      const auto nearer = [&](const OneExemplar& a, const OneExemplar& b) {
        return std::abs(a.condition - wanted) < std::abs(b.condition - wanted);
      };
      return std::uint8_t(std::min_element(exemplars.begin(), exemplars.end(), nearer) - exemplars.begin());
    };
    std::vector<Surface> surfaces(pixels, kNoSurface);
    std::vector<std::uint8_t> is_used(exemplars.size());
    for (std::size_t i = 0; i < pixels; ++i) {
      if (!(target.coverage[i] >= 0.999f) || !(surface[i] >= 0.0f)) continue;
      const std::uint8_t own = nearest(i);
      surfaces[i] = SurfaceOf(IdOf(surface[i]), own), is_used[own] = 1;
    }
    std::vector<const NormalTone*> tones;
    for (const OneExemplar& exemplar : exemplars) tones.push_back(&exemplar.tone);
    const PaintFeatures features = FeaturesOf(*target.picture, target.normal, std::move(surfaces), tones);
    for (std::size_t k = 0; k < exemplars.size(); ++k) {
      if (!is_used[k]) continue;
      for (std::size_t g = 0; g < kGroups; ++g) {
        const CellPixels cells = PixelsOf(features[g], std::uint8_t(k), [](std::size_t) { return true; });
        sums[g].Add(exemplars[k].groups[g], features[g], cells, OctaveOf(g));
      }
    }
  });
  GuidedTextureReport report;
  report.distance = MeanOf(sums);
  report.tone = sums[0].Mean();
  for (std::size_t octave = 0; octave < kOctaves; ++octave) report.strokes[octave] = sums[1 + octave].Mean();
  report.measured = sums[0].blocks;
  return report;
}

std::optional<double> GuidedTexture::floor() const { return impl_->floor; }

}  // namespace scumble
