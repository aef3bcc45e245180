#include "finish/area/noise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/image/hash.h"

namespace scumble::internal {
namespace {

float Smooth01(float t) { return t * t * (3.0f - 2.0f * t); }

float LatticeValue(std::uint64_t hash) { return 2.0f * UnitFloat(hash) - 1.0f; }

// Pixels of an object whose right neighbour is of it too, at most so many: enough for a median.
constexpr std::size_t kMostSteps = 4096;

// What is known of an object.
struct Steps {
  std::size_t pixels = 0, seen = 0;
  std::vector<float> lengths;  // |∂pref/∂x| / depth
};

// The median of |∂pref/∂x| / depth, by object.
std::map<std::uint32_t, float> UnitsOf(const GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage), object = guides.Plane(Layer::kObject),
             depth = guides.Plane(Layer::kDepth);
  std::map<std::uint32_t, Steps> objects;
  for (std::size_t i = 0; i < object.size(); ++i) objects[IdOf(object[i])].pixels += coverage[i] > 0.0f;
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x + 1 < guides.width(); ++x) {
      const std::size_t p = guides.Index(x, y);
      if (!(coverage[p] > 0.0f) || !(coverage[p + 1] > 0.0f) || object[p] != object[p + 1]) continue;
      Steps& steps = objects[IdOf(object[p])];
      if (steps.seen++ % (1 + steps.pixels / kMostSteps) != 0) continue;
      const glm::vec3 step = guides.Vec3(Layer::kPref, p + 1) - guides.Vec3(Layer::kPref, p);
      const float length = std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z) / depth[p];
      if (length > 0.0f && length < 1e30f) steps.lengths.push_back(length);
    }
  }
  std::map<std::uint32_t, float> units;
  for (auto& [id, steps] : objects) {
    if (steps.lengths.empty()) continue;
    const auto middle = steps.lengths.begin() + std::ptrdiff_t(steps.lengths.size() / 2);
    std::nth_element(steps.lengths.begin(), middle, steps.lengths.end());
    units[id] = *middle;
  }
  return units;
}

}  // namespace

float Noise(std::uint64_t seed, glm::vec2 at) {
  const float floor_x = std::floor(at.x), floor_y = std::floor(at.y);
  const auto x = static_cast<std::int64_t>(floor_x), y = static_cast<std::int64_t>(floor_y);
  const float su = Smooth01(at.x - floor_x), sv = Smooth01(at.y - floor_y);
  const auto value = [&](std::int64_t dx, std::int64_t dy) { return LatticeValue(Hash(seed, x + dx, y + dy)); };
  const float above = value(0, 0) + (value(1, 0) - value(0, 0)) * su;
  const float below = value(0, 1) + (value(1, 1) - value(0, 1)) * su;
  return above + (below - above) * sv;
}

float Noise(std::uint64_t seed, glm::vec3 at) {
  constexpr float kMost = 1e9f;
  if (!(std::fabs(at.x) < kMost && std::fabs(at.y) < kMost && std::fabs(at.z) < kMost)) return 0.0f;
  const float floor_z = std::floor(at.z), sw = Smooth01(at.z - floor_z);
  const auto z = static_cast<std::int64_t>(floor_z);
  const float near = Noise(Hash(seed, z), glm::vec2(at)), far = Noise(Hash(seed, z + 1), glm::vec2(at));
  return near + (far - near) * sw;
}

SurfaceScale::SurfaceScale(const GuideSet& guides) : guides_(&guides), reach_(guides.pixel_count(), 0.0f) {
  const std::map<std::uint32_t, float> units = UnitsOf(guides);
  const auto coverage = guides.Plane(Layer::kCoverage), object = guides.Plane(Layer::kObject),
             depth = guides.Plane(Layer::kDepth);
  tbb::parallel_for(0, guides.height(), [&](int y) {
    float id = -1.0f, unit = 0.0f;
    for (std::size_t p = guides.Index(0, y), end = p + std::size_t(guides.width()); p < end; ++p) {
      if (!(coverage[p] > 0.0f)) continue;
      if (object[p] != id) {
        id = object[p];
        const auto found = units.find(IdOf(id));
        unit = found == units.end() ? 0.0f : found->second;
      }
      const float reach = unit * depth[p];
      if (reach < 1e30f) reach_[p] = reach;
    }
  });
}

NoiseField::NoiseField(std::uint64_t seed, double wave, const SurfaceScale* surface, int width, int height)
    : seed_(seed),
      wave_(static_cast<float>(std::max(0.5, wave))),
      per_wave_(1.0f / wave_),
      width_(width),
      columns_(static_cast<int>(static_cast<float>(width) * per_wave_) + 2),
      surface_(surface) {
  const int rows = static_cast<int>(static_cast<float>(height) * per_wave_) + 2;
  lattice_.resize(std::size_t(columns_) * std::size_t(rows));
  tbb::parallel_for(0, rows, [&](int v) {
    for (int u = 0; u < columns_; ++u)
      lattice_[std::size_t(v) * std::size_t(columns_) + std::size_t(u)] = LatticeValue(Hash(seed, u, v));
  });
  // Places in the picture are above 0, so that conversion is a floor.
  for (int x = 0; x < width; ++x) {
    const float at = (static_cast<float>(x) + 0.5f) * per_wave_;
    column_.push_back({static_cast<int>(at), Smooth01(at - static_cast<float>(static_cast<int>(at)))});
  }
}

float NoiseField::InPicture(int x, int y) const {
  const float at = (static_cast<float>(y) + 0.5f) * per_wave_;
  const int row = static_cast<int>(at);
  const auto [cell, su] = column_[std::size_t(x)];
  const float sv = Smooth01(at - static_cast<float>(row));
  const float* const above = lattice_.data() + std::size_t(row) * std::size_t(columns_) + std::size_t(cell);
  const float* const below = above + columns_;
  const float upper = above[0] + (above[1] - above[0]) * su, lower = below[0] + (below[1] - below[0]) * su;
  return upper + (lower - upper) * sv;
}

float NoiseField::At(int x, int y) const {
  const std::size_t p = std::size_t(y) * std::size_t(width_) + std::size_t(x);
  const float wave = surface_ ? surface_->At(p) * wave_ : 0.0f;
  if (!(wave > 1e-30f)) return InPicture(x, y);
  int octave = 0;
  const float share = 2.0f * std::frexp(wave, &octave) - 1.0f;  // of the way from half of 2^octave to all of it
  const glm::vec3 place = surface_->guides().Vec3(Layer::kPref, p) * std::ldexp(1.0f, 1 - octave);
  const std::int64_t number = octave - 1;
  const std::uint64_t object = static_cast<std::uint64_t>(IdOf(surface_->guides().Plane(Layer::kObject)[p]));
  const float finer = Noise(Hash(seed_, object, number), place);
  const float coarser = Noise(Hash(seed_, object, number + 1), place * 0.5f);
  // A mean of two independent noises is fainter than either.
  const float rest = 1.0f - share, per_spread = 1.0f / std::sqrt(rest * rest + share * share);
  return std::clamp((rest * finer + share * coarser) * per_spread, -1.0f, 1.0f);
}

}  // namespace scumble::internal
