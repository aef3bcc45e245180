#include "transfer/seeds/surface_seeds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/image/hash.h"

namespace scumble::internal {
namespace {

// Exact at powers of two, straight in between, rising everywhere. `value` is positive and finite.
double StraightLog2(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);  // [0.5, 1)
  return exponent - 1 + (2.0 * mantissa - 1.0);
}

double Distance(const glm::vec3& a, const glm::vec3& b) {
  const double x = double(a.x) - b.x, y = double(a.y) - b.y, z = double(a.z) - b.z;
  return std::sqrt(x * x + y * y + z * z);
}

// The objects of a picture, numbered in order of appearance.
class ObjectNumbers {
 public:
  std::uint32_t Of(float id) {
    if (const std::uint32_t bits = std::bit_cast<std::uint32_t>(id); bits != last_bits_ || next_ == 0) {
      const auto [found, is_new] = numbers_.try_emplace(bits, next_);
      if (is_new) ++next_;
      last_bits_ = bits, last_ = found->second;
    }
    return last_;
  }
  std::uint32_t count() const { return next_; }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;
  std::uint32_t last_bits_ = 0, last_ = 0, next_ = 0;
};

}  // namespace

std::vector<float> SurfaceOctaves(const GuideSet& guides, std::span<const std::uint8_t> active) {
  const int width = guides.width(), height = guides.height();
  const auto object = guides.Plane(Layer::kObject), depth = guides.Plane(Layer::kDepth);
  const bool flat = guides.camera && guides.camera->IsOrthographic();
  const auto is_finite = [&](std::size_t i) {
    const glm::vec3 p = guides.Vec3(Layer::kPref, i);
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  };
  const auto distance_of = [&](std::size_t i) {
    return !flat && depth[i] > 0.0f && std::isfinite(depth[i]) ? double(depth[i]) : 1.0;
  };
  // The shorter of the steps to the right and down: surfaces seen at an angle stretch in one direction.
  const auto step_of = [&](int x, int y, std::size_t i) {
    double step = std::numeric_limits<double>::infinity();
    const auto look = [&](std::size_t j) {
      if (!active[j] || object[j] != object[i] || !is_finite(j)) return;
      const double to = Distance(guides.Vec3(Layer::kPref, i), guides.Vec3(Layer::kPref, j));
      if (to > 0.0) step = std::min(step, to);
    };
    if (x + 1 < width) look(i + 1);
    if (y + 1 < height) look(i + std::size_t(width));
    return step;
  };

  std::vector<float> octaves(guides.pixel_count(), kNoOctave);
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t i = guides.Index(x, y);
        if (!active[i] || !is_finite(i)) continue;
        octaves[i] = static_cast<float>(std::min(1e30, step_of(x, y, i) / distance_of(i)));
      }
    }
  });
  ObjectNumbers numbers;
  std::vector<std::vector<float>> steps;
  for (std::size_t i = 0; i < octaves.size(); ++i) {
    if (octaves[i] == kNoOctave) continue;
    const std::uint32_t number = numbers.Of(object[i]);
    if (number == steps.size()) steps.emplace_back();
    if (octaves[i] > 0.0f && octaves[i] < 1e30f) steps[number].push_back(octaves[i]);
  }
  std::vector<double> typical(steps.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, steps.size(), [&](std::size_t k) {
    if (steps[k].empty()) return;
    const auto middle = steps[k].begin() + std::ptrdiff_t(steps[k].size() / 2);
    std::nth_element(steps[k].begin(), middle, steps[k].end());
    typical[k] = *middle;
  });
  for (std::size_t i = 0; i < octaves.size(); ++i) {
    if (octaves[i] == kNoOctave) continue;
    const double footprint = typical[numbers.Of(object[i])] * distance_of(i);
    octaves[i] = footprint > 0.0 ? static_cast<float>(StraightLog2(footprint)) : kNoOctave;
  }
  return octaves;
}

SurfaceGrid::SurfaceGrid(const SeedRules& rules, std::uint32_t object, int exponent)
    : object_(object), exponent_(exponent), per_edge_(std::ldexp(1.0, -exponent)), jitter_(rules.jitter) {
  const std::uint64_t place = Hash(rules.seed, object, exponent);
  for (int axis = 0; axis < 3; ++axis) shift_[axis] = UnitFloat(Mix64(place + std::uint64_t(axis)));
  prefix_ = Hash(place, rules.time_step);
}

void SurfaceGrid::MoveTo(const std::int64_t (&cube)[3]) {
  if (placed_ && cube[0] == cube_[0] && cube[1] == cube_[1] && cube[2] == cube_[2]) return;
  std::copy(std::begin(cube), std::end(cube), cube_);
  placed_ = true, filled_ = 0;
}

void SurfaceGrid::Fill(int neighbour) {
  const int offset[3] = {neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1};
  std::uint64_t packed = 0;  // 21 bits for each axis: cubes that share them are millions apart
  for (int axis = 0; axis < 3; ++axis) {
    packed = packed << 21 | (static_cast<std::uint64_t>(cube_[axis] + offset[axis]) & 0x1fffff);
  }
  const std::uint64_t key = std::max<std::uint64_t>(1, Mix64(prefix_ ^ packed));
  const std::uint64_t chance = Mix64(key);
  for (int axis = 0; axis < 3; ++axis) {
    const float j = static_cast<float>(chance >> (21 * axis) & 0x1fffff) * 0x1.0p-21f;
    point_[neighbour][axis] = static_cast<float>(offset[axis]) + (0.5f + (j - 0.5f) * jitter_);
  }
  key_[neighbour] = key;
  filled_ |= 1u << neighbour;
}

SurfaceCell SurfaceGrid::Nearest(const glm::vec3& place) {
  std::int64_t cube[3];
  float local[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double at = double(place[axis]) * per_edge_ + shift_[axis];
    if (!(std::fabs(at) < 0x1.0p50)) return {};
    const double low = std::floor(at);
    cube[axis] = static_cast<std::int64_t>(low);
    local[axis] = static_cast<float>(at - low);
  }
  MoveTo(cube);
  // The least distance of a cube, by axis and side.
  const float apart[3][3] = {{local[0] * local[0], 0.0f, (1.0f - local[0]) * (1.0f - local[0])},
                             {local[1] * local[1], 0.0f, (1.0f - local[1]) * (1.0f - local[1])},
                             {local[2] * local[2], 0.0f, (1.0f - local[2]) * (1.0f - local[2])}};
  int best = 13;
  float squared = std::numeric_limits<float>::infinity();
  const auto look = [&](int n) {
    if (!(filled_ >> n & 1u)) Fill(n);
    const float x = point_[n][0] - local[0], y = point_[n][1] - local[1], z = point_[n][2] - local[2];
    const float to = x * x + y * y + z * z;
    if (to < squared || (to == squared && n < best)) squared = to, best = n;
  };
  look(13);
  constexpr float kSlack = 1.0001f;  // a bound that was rounded up must not hide the nearest
  // The nearer side first: then the fewest cubes are visited.
  const auto side = [&](int axis, int step) { return step == 0 ? 1 : (local[axis] < 0.5f) == (step == 1) ? 0 : 2; };
  for (int k = 0; k < 3; ++k) {
    const int z = side(2, k);
    if (apart[2][z] > squared * kSlack) continue;
    for (int j = 0; j < 3; ++j) {
      const int y = side(1, j);
      if (apart[2][z] + apart[1][y] > squared * kSlack) continue;
      for (int i = 0; i < 3; ++i) {
        const int x = side(0, i), n = 9 * z + 3 * y + x;
        if (n != 13 && apart[2][z] + apart[1][y] + apart[0][x] <= squared * kSlack) look(n);
      }
    }
  }
  return {key_[best], squared};
}

float CellChance(std::uint64_t key, int purpose) { return UnitFloat(Hash(key, purpose)); }

}  // namespace scumble::internal
