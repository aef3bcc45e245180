#include "measure/energy.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/image/hash.h"
#include "core/io/parallel.h"
#include "measure/mosaic/patch_search.h"
#include "measure/mosaic/stratified_sample.h"

namespace scumble {
namespace {

using internal::PatchPlanes;
using internal::PatchSearch;

constexpr std::size_t kMostGuides = 32;
// So that sums of squares stay far below the largest float.
constexpr float kLargestGuide = 1e6f;
constexpr double kLargestLambda = 1e12;

using Guides = std::vector<std::span<const float>>;

Guides AllGuides(const std::array<std::span<const float>, 3>& normal, const Guides& more) {
  Guides all(normal.begin(), normal.end());
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string Place(std::size_t i, int width) {
  return "(" + std::to_string(i % std::size_t(width)) + ", " + std::to_string(i / std::size_t(width)) + ")";
}

Status CheckSizes(const std::string& name, const Picture* picture, const Guides& guides, std::size_t mask) {
  if (!picture || picture->empty()) return InputError(name + " has no picture: the energy compares its colours");
  const std::size_t count = std::size_t(picture->width) * picture->height;
  bool fits = mask == count;
  for (const auto& plane : guides) fits = fits && plane.size() == count;
  if (fits) return Ok();
  return InputError(name + "'s picture is " + std::to_string(picture->width) + "×" + std::to_string(picture->height) +
                    ", its guides are not: render both at one size");
}

// Copies the pixels inside the mask; `largest` grows to the largest absolute guide.
template <class IsShown>
Expected<PatchPlanes> MakePlanes(const std::string& name, const Picture& picture, const Guides& guides,
                                 const IsShown& is_shown, double& largest) {
  PatchPlanes planes(picture.width, picture.height, internal::kPatchColors + guides.size());
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t from = std::size_t(y) * picture.width + x, to = static_cast<std::size_t>(planes.Index(x, y));
      if (!is_shown(from)) continue;
      planes.mask[to] = 1;
      for (std::size_t c = 0; c < internal::kPatchColors; ++c) planes.planes[c][to] = picture.At(x, y)[c];
      for (std::size_t g = 0; g < guides.size(); ++g) {
        const float value = guides[g][from];
        if (!(std::fabs(value) <= kLargestGuide)) {
          return InputError(name + " has a guide of " + std::to_string(value) + " at " + Place(from, picture.width) +
                            ": expected at most a million, and no NaN, where it counts");
        }
        planes.planes[internal::kPatchColors + g][to] = value;
        largest = std::max(largest, double(std::fabs(value)));
      }
    }
  }
  return planes;
}

Status AddFree(const EnergyTarget& target, PatchPlanes& planes) {
  if (target.free.empty()) return Ok();
  if (target.free.size() != target.coverage.size()) {
    return InputError("the target's free distances are not of its size: expected one for each pixel, or none");
  }
  planes.free.assign(planes.mask.size(), 0.0f);
  for (int y = 0; y < planes.height; ++y) {
    for (int x = 0; x < planes.width; ++x) {
      const std::size_t from = std::size_t(y) * planes.width + x;
      const float free = target.free[from];
      if (!(free >= 0.0f && free <= 2.0f)) {
        return InputError("the target's free distance is " + std::to_string(free) + " at " + Place(from, planes.width) +
                          ": expected 0 … 2");
      }
      planes.free[std::size_t(planes.Index(x, y))] = free;
    }
  }
  return Ok();
}

double Degrees(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

glm::dvec3 NormalAt(const PatchPlanes& planes, int x, int y) {
  const std::size_t i = static_cast<std::size_t>(planes.Index(x, y));
  const auto* guides = planes.planes.data() + internal::kPatchColors;
  return {guides[0][i], guides[1][i], guides[2][i]};
}

struct Spot {
  int image = 0, x = 0, y = 0;
};

// Appends the pixels of a mask that count along a Z-order curve, so that neighbours in the list are neighbours in the
// picture.
template <class Counts>
class ZOrder {
 public:
  ZOrder(const PatchPlanes& planes, int image, const Counts& counts, std::vector<Spot>& spots)
      : planes_(planes), image_(image), counts_(counts), spots_(spots) {
    int side = 1;
    while (side < std::max(planes.width, planes.height)) side *= 2;
    Visit(0, 0, side);
  }

 private:
  void Visit(int x, int y, int side) {
    if (x >= planes_.width || y >= planes_.height) return;
    if (side == 1) {
      const std::size_t i = static_cast<std::size_t>(planes_.Index(x, y));
      if (planes_.mask[i] && counts_(i)) spots_.push_back({image_, x, y});
      return;
    }
    const int half = side / 2;
    Visit(x, y, half), Visit(x + half, y, half), Visit(x, y + half, half), Visit(x + half, y + half, half);
  }

  const PatchPlanes& planes_;
  const int image_;
  const Counts& counts_;
  std::vector<Spot>& spots_;
};

std::vector<Spot> SpotsOf(const PatchPlanes& planes) {
  std::vector<Spot> spots;
  const auto all = [](std::size_t) { return true; };
  ZOrder(planes, 0, all, spots);
  return spots;
}

// The normals that a picture shows, in cubes of side 1/8 with all of their neighbours.
class ShownNormals {
 public:
  explicit ShownNormals(const PatchPlanes& planes) : shown_(kSide * kSide * kSide, 0) {
    for (std::size_t i = 0; i < planes.mask.size(); ++i) {
      if (!planes.mask[i]) continue;
      const std::size_t cell = CellOf(planes, i);
      for (std::size_t dz : {std::size_t(0), std::size_t(1), std::size_t(2)}) {
        for (std::size_t dy : {std::size_t(0), std::size_t(1), std::size_t(2)}) {
          for (std::size_t dx : {std::size_t(0), std::size_t(1), std::size_t(2)}) {
            shown_[cell + (dz * kSide + dy) * kSide + dx - (kSide + 1) * kSide - 1] = 1;
          }
        }
      }
    }
  }

  bool Near(const PatchPlanes& planes, std::size_t i) const { return shown_[CellOf(planes, i)] != 0; }

 private:
  static constexpr std::size_t kSide = 20;  // cells of [−1.25, 1.25)

  static std::size_t CellOf(const PatchPlanes& planes, std::size_t i) {
    std::size_t cell = 0;
    for (std::size_t c = 3; c-- > 0;) {
      const double n = std::clamp(double(planes.planes[internal::kPatchColors + c][i]), -1.0, 1.0);
      cell = cell * kSide + static_cast<std::size_t>((n + 1.25) * 8.0);
    }
    return cell;
  }

  std::vector<std::uint8_t> shown_;
};

// The spots to measure.
struct Sample {
  internal::StratifiedSample drawn;
  std::vector<Spot> spots;
};

Sample Choose(const std::vector<Spot>& all, std::size_t samples, std::uint64_t seed) {
  Sample sample{internal::ChooseStratified(all.size(), samples, seed), {}};
  for (const std::size_t place : sample.drawn.places) sample.spots.push_back(all[place]);
  return sample;
}

template <class Value>
Estimate MeanOf(const Sample& sample, const std::vector<EnergySample>& samples, const Value& value) {
  std::vector<double> values;
  for (const EnergySample& one : samples) values.push_back(value(one));
  return internal::MeanOf(sample.drawn, values);
}

using Places = std::vector<PatchSearch::Place>;

// The places from or to which the pixels of a patch were copied, moved back by their distance from its middle: in a
// copy all of them agree. `other_of(x, y)` is of a valid pixel of `planes`; empty where it is unknown.
template <class OtherOf>
Places Guesses(const PatchPlanes& planes, int x, int y, const OtherOf& other_of) {
  Places guesses;
  constexpr int kReach = internal::kPatchRadius;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      if (!planes.mask[std::size_t(planes.Index(x + dx, y + dy))]) continue;
      const std::optional<PatchSearch::Place> other = other_of(x + dx, y + dy);
      if (!other) continue;
      const PatchSearch::Place place{other->exemplar, other->x - dx, other->y - dy};
      const auto is_known = [&](const PatchSearch::Place& p) {
        return p.exemplar == place.exemplar && p.x == place.x && p.y == place.y;
      };
      if (std::none_of(guesses.begin(), guesses.end(), is_known)) guesses.push_back(place);
    }
  }
  return guesses;
}

// The sources of the picture's pixels, and the inverse map.
class KnownSources {
 public:
  KnownSources(const SourcePlanes* sources, std::span<const PatchPlanes> exemplars) : sources_(sources) {
    if (!sources) return;
    for (const PatchPlanes& exemplar : exemplars) shown_.emplace_back(exemplar.mask.size(), -1);
    for (std::size_t i = sources->covered.size(); i-- > 0;) {  // of several the first
      const std::optional<PatchSearch::Place> from = From(i);
      if (!from || from->exemplar < 0 || std::size_t(from->exemplar) >= exemplars.size()) continue;
      const PatchPlanes& exemplar = exemplars[std::size_t(from->exemplar)];
      if (from->x < 0 || from->y < 0 || from->x >= exemplar.width || from->y >= exemplar.height) continue;
      shown_[std::size_t(from->exemplar)][std::size_t(exemplar.Index(from->x, from->y))] =
          static_cast<std::ptrdiff_t>(i);
    }
  }

  Places OfTarget(const PatchPlanes& target, int x, int y) const {
    if (!sources_) return {};
    return Guesses(target, x, y, [&](int u, int v) { return From(std::size_t(v) * target.width + u); });
  }
  Places OfExemplar(const PatchPlanes& exemplar, int which, int x, int y) const {
    if (!sources_) return {};
    return Guesses(exemplar, x, y, [&](int u, int v) -> std::optional<PatchSearch::Place> {
      const std::ptrdiff_t i = shown_[std::size_t(which)][std::size_t(exemplar.Index(u, v))];
      if (i < 0) return std::nullopt;
      return PatchSearch::Place{0, static_cast<int>(i % sources_->width), static_cast<int>(i / sources_->width)};
    });
  }

 private:
  std::optional<PatchSearch::Place> From(std::size_t i) const {
    if (!sources_->covered[i]) return std::nullopt;
    return PatchSearch::Place{sources_->exemplar.empty() ? 0 : sources_->exemplar[i], sources_->source_x[i],
                              sources_->source_y[i]};
  }

  const SourcePlanes* sources_;
  std::vector<std::vector<std::ptrdiff_t>> shown_;  // by exemplar and place: a pixel of the picture; −1: none
};

Status CheckSources(const SourcePlanes& sources, int width, int height) {
  const std::size_t count = std::size_t(width) * height;
  if (sources.width == width && sources.height == height && sources.source_x.size() == count &&
      sources.source_y.size() == count && sources.covered.size() == count &&
      (sources.exemplar.empty() || sources.exemplar.size() == count)) {
    return Ok();
  }
  return InputError("the sources are " + std::to_string(sources.width) + "×" + std::to_string(sources.height) +
                    ", the picture is " + std::to_string(width) + "×" + std::to_string(height) +
                    ": they must be of the same transfer");
}

Status CheckInputs(const EnergyTarget& target, const Guides& guides, std::span<const EnergyExemplar> exemplars,
                   const SourcePlanes* sources) {
  SCUMBLE_RETURN_IF_ERROR(CheckSizes("the target", target.picture, guides, target.coverage.size()));
  if (exemplars.empty()) return InputError("there is no exemplar: the energy is a distance from one");
  if (guides.size() > kMostGuides) {
    return InputError("there are " + std::to_string(guides.size()) + " guides: expected " +
                      std::to_string(kMostGuides) + " at most, normals counting three");
  }
  for (std::size_t e = 0; e < exemplars.size(); ++e) {
    const std::string name = "exemplar " + std::to_string(e);
    const Guides own = AllGuides(exemplars[e].normal, exemplars[e].more_guides);
    SCUMBLE_RETURN_IF_ERROR(CheckSizes(name, exemplars[e].picture, own, exemplars[e].usable.size()));
    if (own.size() != guides.size()) {
      return InputError(name + " has " + std::to_string(own.size()) + " guides, the target " +
                        std::to_string(guides.size()) + ": both need the same ones");
    }
  }
  return sources ? CheckSources(*sources, target.picture->width, target.picture->height) : Ok();
}

double ColorOf(const EnergySample& sample) { return sample.color; }
double GuideOf(const EnergySample& sample) { return sample.guide; }

// The nearest patch of `there`, by `search`, to each spot of `here`. `guesses(spot)` are good first candidates.
template <class GuessesOf>
std::vector<EnergySample> Look(const PatchSearch& search, std::span<const PatchPlanes> here,
                               std::span<const PatchPlanes> there, const Sample& sample, const EnergyOptions& options,
                               const GuessesOf& guesses) {
  std::vector<EnergySample> samples(sample.spots.size());
  internal::ForEachIndex(static_cast<int>(samples.size()), options.threads, [&](int i) {
    const Spot spot = sample.spots[std::size_t(i)];
    const PatchPlanes& planes = here[std::size_t(spot.image)];
    const internal::PatchMatch match = search.Nearest(search.QueryAt(planes, spot.x, spot.y), guesses(spot));
    const glm::dvec3 found = NormalAt(there[std::size_t(match.exemplar)], match.x, match.y);
    samples[std::size_t(i)] = {.x = spot.x,
                               .y = spot.y,
                               .exemplar = match.exemplar,
                               .source_x = match.x,
                               .source_y = match.y,
                               .color = match.color,
                               .guide = match.guide,
                               .degrees = Degrees(NormalAt(planes, spot.x, spot.y), found)};
  });
  return samples;
}

}  // namespace

Expected<EnergyReport> MeasureEnergy(const EnergyTarget& target, std::span<const EnergyExemplar> exemplars,
                                     const EnergyOptions& options) {
  if (!(options.lambda >= 0.0 && options.lambda <= kLargestLambda)) {
    return UsageError("the energy's lambda is " + std::to_string(options.lambda) + ": expected 0 … 1e12");
  }
  const Guides guides = AllGuides(target.normal, target.more_guides);
  SCUMBLE_RETURN_IF_ERROR(CheckInputs(target, guides, exemplars, options.sources));
  double largest = 0.0;
  const auto counts = [&](std::size_t i) { return target.coverage[i] >= options.least_coverage; };
  SCUMBLE_ASSIGN(PatchPlanes wanted, MakePlanes("the target", *target.picture, guides, counts, largest));
  SCUMBLE_RETURN_IF_ERROR(AddFree(target, wanted));
  std::vector<PatchPlanes> planes;
  for (std::size_t e = 0; e < exemplars.size(); ++e) {
    const EnergyExemplar& exemplar = exemplars[e];
    SCUMBLE_ASSIGN(PatchPlanes own, MakePlanes(
                                        "exemplar " + std::to_string(e), *exemplar.picture,
                                        AllGuides(exemplar.normal, exemplar.more_guides),
                                        [&](std::size_t i) { return exemplar.usable[i] != 0; }, largest));
    planes.push_back(std::move(own));
  }
  const std::vector<Spot> all = SpotsOf(wanted);
  EnergyReport report;
  report.measured = all.size();
  const PatchSearch search(planes, options.lambda, largest);
  if (search.radius() < 0) return InputError("no exemplar has a usable pixel: the energy is a distance from one");
  report.patch_side = 2 * search.radius() + 1;
  if (all.empty()) return report;

  const Sample sample = Choose(all, options.samples, Hash(options.seed, 0));
  const KnownSources sources(options.sources, planes);
  report.samples = Look(search, {&wanted, 1}, planes, sample, options,
                        [&](const Spot& spot) { return sources.OfTarget(wanted, spot.x, spot.y); });
  const auto energy = [&](const EnergySample& s) { return s.color + options.lambda * s.guide; };
  report.energy = MeanOf(sample, report.samples, energy);
  report.color = MeanOf(sample, report.samples, ColorOf);
  report.guide = MeanOf(sample, report.samples, GuideOf);
  report.degrees = MeanOf(sample, report.samples, [](const EnergySample& s) { return s.degrees; });

  const ShownNormals shown(wanted);
  std::vector<Spot> asked;
  for (std::size_t e = 0; e < planes.size(); ++e) {
    const auto is_asked_for = [&](std::size_t i) { return shown.Near(planes[e], i); };
    ZOrder(planes[e], static_cast<int>(e), is_asked_for, asked);
  }
  report.asked_for = asked.size();
  const PatchSearch back({&wanted, 1}, options.lambda, largest);
  const Sample asked_sample = Choose(asked, options.samples, Hash(options.seed, 1));
  const std::vector<EnergySample> missing =
      Look(back, planes, {&wanted, 1}, asked_sample, options, [&](const Spot& spot) {
        return sources.OfExemplar(planes[std::size_t(spot.image)], spot.image, spot.x, spot.y);
      });
  report.missing = MeanOf(asked_sample, missing, energy);
  report.both = {report.energy.mean + report.missing.mean,
                 std::hypot(report.energy.standard_error, report.missing.standard_error)};
  return report;
}

Expected<double> MeanSourceDegrees(const EnergyTarget& target, std::span<const EnergyExemplar> exemplars,
                                   const SourcePlanes& sources, float least_coverage) {
  SCUMBLE_RETURN_IF_ERROR(CheckInputs(target, AllGuides(target.normal, target.more_guides), exemplars, &sources));
  double sum = 0.0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < target.coverage.size(); ++i) {
    if (!sources.covered[i] || !(target.coverage[i] >= least_coverage)) continue;
    const std::size_t e = sources.exemplar.empty() ? 0 : sources.exemplar[i];
    const int x = sources.source_x[i], y = sources.source_y[i];
    if (e >= exemplars.size() || x < 0 || y < 0 || x >= exemplars[e].picture->width ||
        y >= exemplars[e].picture->height) {
      return InputError("the source of pixel " + Place(i, target.picture->width) + " is (" + std::to_string(x) + ", " +
                        std::to_string(y) + ") of exemplar " + std::to_string(e) +
                        ", which has no such place: the exemplars must be those of the transfer, at its size");
    }
    const std::size_t from = std::size_t(y) * exemplars[e].picture->width + x;
    const auto normal = [](const std::array<std::span<const float>, 3>& n, std::size_t at) {
      return glm::dvec3(n[0][at], n[1][at], n[2][at]);
    };
    sum += Degrees(normal(target.normal, i), normal(exemplars[e].normal, from)), ++pixels;
  }
  return pixels > 0 ? sum / static_cast<double>(pixels) : 0.0;
}

}  // namespace scumble
