#include "guidegen/light/area_light_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "guidegen/light/light_visibility.h"
#include "guidegen/rays/occlusion_batch.h"

namespace scumble {
namespace {

constexpr std::size_t kBlockPixels = 16;
constexpr int kBlockSamples = 8;  // of a term of a pixel: a packet of rays from one point to one light
constexpr std::size_t kMostTerms = LightSet::kFewLights + 1;
constexpr int kGridSide = AreaLightTile::kTileSide;
constexpr int kWindow = 2;  // pixels on each side of one whose neighbours' samples count

// Where all of fewer samples may miss: directions that look for a lamp, one lamp of many, a lamp that sets.
constexpr int kLeastSparseSamples = 16;

// At a tile's border, where neighbours of one side are unknown.
constexpr int kLeastBorderSamples = 8;

// Radii of a light within which directions look for it. Few samples that look for it are noisier than few points on it.
constexpr double kNearLight = 1.0;

// The standard error of n Owen-scrambled Sobol points of a function that jumps along an edge is its standard deviation
// times kJump n^(-3/4), of a smooth one kCurve n^(-3/2): measured for half planes of all directions that cover 5% and
// more (0.73 to 1.3), and for light from a lamp as near as it is wide (1.9 at 4 points, 2.8 at 16).
constexpr double kJump = 0.85;
constexpr double kCurve = 2.0;

double JumpError(double deviation, double n) { return kJump * deviation / std::sqrt(n * std::sqrt(n)); }
double CurveError(double deviation, double n) { return kCurve * deviation / (n * std::sqrt(n)); }

bool OnBorder(const AreaLightPixel& pixel) {
  const auto is_first_or_last = [](int at) { return at == 0 || at == kGridSide - 1; };
  return is_first_or_last(pixel.column) || is_first_or_last(pixel.row);
}

struct Tag {
  std::size_t slot = 0;
  double light = 0.0;
};

// One bit for each pixel of a tile.
using Mask = std::array<std::uint32_t, kGridSide>;

Mask Widened(const Mask& mask) {
  Mask across{}, result{};
  for (int row = 0; row < kGridSide; ++row) {
    for (int d = 0; d <= kWindow; ++d)
      across[std::size_t(row)] |= mask[std::size_t(row)] << d | mask[std::size_t(row)] >> d;
  }
  for (int row = 0; row < kGridSide; ++row) {
    for (int other = std::max(0, row - kWindow); other <= std::min(kGridSide - 1, row + kWindow); ++other) {
      result[std::size_t(row)] |= across[std::size_t(other)];
    }
  }
  return result;
}

}  // namespace

void LightErrors::Add(double error) {
  const double steps = std::clamp(std::ceil(error / kStep), 0.0, double(pixels_.size() - 1));
  ++pixels_[std::size_t(steps)];
}

LightErrors& LightErrors::operator+=(const LightErrors& other) {
  for (std::size_t i = 0; i < pixels_.size(); ++i) pixels_[i] += other.pixels_[i];
  return *this;
}

double LightErrors::OfMost() const {
  const auto all = std::accumulate(pixels_.begin(), pixels_.end(), std::uint64_t(0));
  std::uint64_t up_to = 0;
  for (std::size_t i = 0; i < pixels_.size() && all > 0; ++i) {
    up_to += pixels_[i];
    if (10 * up_to >= 9 * all) return double(i) * kStep;
  }
  return 0.0;
}

AreaLightTile::AreaLightTile(const EmbreeScene& scene, const LightSet& lights, const AreaLightSettings& settings)
    : scene_(scene),
      lights_(lights),
      settings_(settings),
      fixed_(!(settings.error > 0.0)),
      light_terms_(PointLighting::LightTerms(lights)),
      term_count_(light_terms_.size() + 1),
      block_(kBlockPixels * term_count_ * kBlockSamples) {}

// Casts the next samples of a block of pixels, those that each term wants.
bool AreaLightTile::Advance(std::span<AreaLightPixel> pixels, std::size_t begin, ProgressGate& gate, RayCounts& rays) {
  const std::size_t end = std::min(begin + kBlockPixels, pixels.size());
  OcclusionBatch<Tag> batch(scene_.handle(), false);
  const auto report = [&](const Tag& tag, bool blocked) { block_[tag.slot] = {blocked ? 0.0 : tag.light, tag.light}; };
  const auto any_goes = [&] {
    return std::any_of(terms_.begin() + std::ptrdiff_t(begin * term_count_),
                       terms_.begin() + std::ptrdiff_t(end * term_count_),
                       [](const Term& term) { return term.Goes(); });
  };
  const auto each_sample = [&](std::size_t number, std::size_t of_term, const auto& take) {
    const Term& term = TermsOf(number)[of_term];
    const std::size_t slot = ((number - begin) * term_count_ + of_term) * kBlockSamples;
    for (int k = 0; k < std::min(kBlockSamples, term.wanted - term.samples); ++k) {
      take(slot + std::size_t(k), std::uint32_t(term.samples + k));
    }
  };
  while (any_goes()) {
    if (!gate.Continue()) return false;
    for (std::size_t of_term = 0; of_term < light_terms_.size(); ++of_term) {
      for (std::size_t number = begin; number < end; ++number) {
        const Pixel& pixel = pixels_[number];
        each_sample(number, of_term, [&](std::size_t slot, std::uint32_t index) {
          const PointLighting::Take take = pixel.lighting.TakeLight(light_terms_[of_term], pixel.sampler, index);
          block_[slot] = {};
          if (!(take.light > 0.0)) return;
          ++rays.shadow;
          if (take.draw.object != LightDraw::kNoObject) {
            block_[slot] = pixel.lighting.Resolve(take, pixel.lighting.IsBlocked(take), rays);
            return;
          }
          const LightRay ray = RayTo(pixel.lighting.origin(), take.draw);
          batch.Add({ray.origin, ray.direction, 0.0, ray.reach}, {slot, take.light}, report);
        });
      }
    }
    for (std::size_t number = begin; number < end; ++number) {
      const Pixel& pixel = pixels_[number];
      each_sample(number, light_terms_.size(), [&](std::size_t slot, std::uint32_t index) {
        block_[slot] = pixel.lighting.TakeDirection(pixel.sampler, index, rays);
      });
    }
    batch.Flush(report);
    for (std::size_t number = begin; number < end; ++number) AddBlock(pixels[number], number, number - begin);
  }
  return true;
}

void AreaLightTile::AddBlock(AreaLightPixel& pixel, std::size_t number, std::size_t place) {
  const std::span<Term> terms = TermsOf(number);
  const auto sample = [&](std::size_t term, int k) -> const AreaLighting& {
    return block_[(place * term_count_ + term) * kBlockSamples + std::size_t(k)];
  };
  const auto count = [](const Term& term) { return std::min(kBlockSamples, term.wanted - term.samples); };
  // A fixed number: term by term within each sample, so that sums have the bits of plain ones.
  for (int k = 0; fixed_ && k < kBlockSamples; ++k) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (k < count(terms[i])) pixel.light += sample(i, k);
    }
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Term& term = terms[i];
    const int added = count(term);
    if (added <= 0) continue;
    for (int k = 0; k < added && !fixed_; ++k) {
      const AreaLighting& light = sample(i, k);
      term.sum += light;
      term.squares += light.unoccluded * light.unoccluded;
      term.dark_sample = term.dark_sample || !(light.unoccluded > 0.0);
    }
    term.samples += added;
  }
}

// Marks the terms of pixels around which both a lit and a blocked sample are, or a bright and a dark one.
void AreaLightTile::FindPenumbra(std::span<const AreaLightPixel> pixels) {
  for (std::size_t of_term = 0; of_term < term_count_; ++of_term) {
    Mask lit{}, blocked{}, bright{}, dark{};
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Term& term = TermsOf(i)[of_term];
      const auto row = std::size_t(pixels[i].row);
      const auto mark = [&](bool is_so, Mask& mask) { mask[row] |= std::uint32_t(is_so) << pixels[i].column; };
      mark(term.IsLit(), lit);
      mark(term.IsBlocked(), blocked);
      mark(term.MayShine(), bright);
      mark(term.dark_sample, dark);
    }
    for (Mask* mask : {&lit, &blocked, &bright, &dark}) *mask = Widened(*mask);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      Term& term = TermsOf(i)[of_term];
      const auto row = std::size_t(pixels[i].row);
      const auto both = [&](const Mask& a, const Mask& b) { return ((a[row] & b[row]) >> pixels[i].column & 1u) != 0; };
      term.in_penumbra = both(lit, blocked);
      term.on_horizon = both(bright, dark);
      if (!term.on_horizon || term.MayShine() || term.samples == 0) continue;
      term.wanted = std::clamp(kLeastSparseSamples, term.samples, settings_.samples);
    }
  }
}

// The estimated variance of the term's light.
double AreaLightTile::SquaredError(const Term& term, bool is_smooth) const {
  if (!(term.sum.unoccluded > 0.0)) return 0.0;
  const double n = term.samples;
  const double mean = term.sum.unoccluded / n;
  const double seen = term.sum.reached / term.sum.unoccluded;
  double edge = 0.0;
  if (term.in_penumbra || (term.IsLit() && term.IsBlocked())) {
    // Half a sample of either kind: samples that are all equal leave a doubt here.
    const double share = (std::clamp(seen, 0.0, 1.0) * n + 0.5) / (n + 1.0);
    edge = JumpError(mean * std::sqrt(share * (1.0 - share)), n);
  }
  const double variance = n > 1.0 ? std::max(0.0, term.squares / n - mean * mean) * n / (n - 1.0) : mean * mean;
  const double deviation = seen * std::sqrt(variance);
  const double spread =
      is_smooth && !term.dark_sample && !term.on_horizon ? CurveError(deviation, n) : JumpError(deviation, n);
  return edge * edge + spread * spread;
}

struct AreaLightTile::Doubt {
  std::array<double, kMostTerms> variances{};
  double total = 0.0;
  double light = 0.0;
  int uncertain = 0;  // terms
};

// The error is judged beside the light of the lamps that the pixel sees, so that a lamp in the next room does not hide
// the noise of this one's.
AreaLightTile::Doubt AreaLightTile::DoubtOf(const AreaLightPixel& pixel, std::size_t number) {
  const std::span<Term> terms = TermsOf(number);
  Doubt doubt;
  doubt.light = pixel.other_light;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Term& term = terms[i];
    if (term.samples == 0) continue;
    const bool directions = i == light_terms_.size();
    const bool is_smooth = directions
                               ? !pixels_[number].lighting.LooksForLights()
                               : light_terms_[i] != PointLighting::kAnyLight && !lights_.IsEmitter(light_terms_[i]);
    if (term.IsLit() || term.in_penumbra) doubt.light += term.sum.unoccluded / term.samples;
    doubt.variances[i] = SquaredError(term, is_smooth);
    doubt.total += doubt.variances[i];
    if (doubt.variances[i] > 0.0) ++doubt.uncertain;
  }
  return doubt;
}

// Decides which terms of a pixel take more samples.
void AreaLightTile::Refine(const AreaLightPixel& pixel, std::size_t number) {
  const Doubt doubt = DoubtOf(pixel, number);
  const double allowed = settings_.error * settings_.error * doubt.light * doubt.light;
  if (!(doubt.total > allowed)) return;
  const std::span<Term> terms = TermsOf(number);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (doubt.variances[i] * doubt.uncertain > allowed) {
      terms[i].wanted = std::min(2 * terms[i].samples, settings_.samples);
    }
  }
}

// All samples of a fixed number, or the first ones.
void AreaLightTile::Begin(std::span<const AreaLightPixel> pixels) {
  pixels_.resize(std::max(pixels_.size(), pixels.size()));
  terms_.assign(pixels.size() * term_count_, {});
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    Pixel& pixel = pixels_[i];
    pixel.lighting = PointLighting(scene_, lights_, *pixels[i].point, fixed_ ? kWideDistance : kNearLight);
    pixel.sampler = Sampler(pixels[i].index, kAreaLightStream, settings_.seed);
    for (std::size_t term = 0; term < term_count_; ++term) {
      const bool directions = term == light_terms_.size();
      if (directions && !pixel.lighting.HasDirections()) continue;
      const bool sparse = directions ? pixel.lighting.LooksForLights() : light_terms_[term] == PointLighting::kAnyLight;
      const int least = sparse ? kLeastSparseSamples : OnBorder(pixels[i]) ? kLeastBorderSamples : kLeastLightSamples;
      TermsOf(i)[term].wanted = fixed_ ? settings_.samples : std::min(least, settings_.samples);
    }
  }
}

// After the first samples: more of them until each pixel has enough.
bool AreaLightTile::Choose(std::span<AreaLightPixel> pixels, ProgressGate& gate, RayCounts& rays) {
  FindPenumbra(pixels);
  for (std::size_t begin = 0; begin < pixels.size(); begin += kBlockPixels) {
    const std::size_t end = std::min(begin + kBlockPixels, pixels.size());
    for (bool any = true; any;) {
      any = false;
      for (std::size_t i = begin; i < end; ++i) {
        Refine(pixels[i], i);
        for (const Term& term : TermsOf(i)) any = any || term.Goes();
      }
      if (!Advance(pixels, begin, gate, rays)) return false;
    }
  }
  return true;
}

bool AreaLightTile::Run(std::span<AreaLightPixel> pixels, ProgressGate& gate, RayCounts& rays) {
  Begin(pixels);
  for (std::size_t begin = 0; begin < pixels.size(); begin += kBlockPixels) {
    if (!Advance(pixels, begin, gate, rays)) return false;
  }
  if (!fixed_ && !Choose(pixels, gate, rays)) return false;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    AreaLighting& light = pixels[i].light;
    if (fixed_) light = {light.reached / settings_.samples, light.unoccluded / settings_.samples};
    for (const Term& term : TermsOf(i)) {
      if (fixed_ || term.samples == 0) continue;
      light += {term.sum.reached / term.samples, term.sum.unoccluded / term.samples};
    }
    if (fixed_) continue;
    const Doubt doubt = DoubtOf(pixels[i], i);
    if (doubt.light > 0.0) errors_.Add(std::sqrt(doubt.total) / doubt.light);
  }
  return true;
}

}  // namespace scumble
