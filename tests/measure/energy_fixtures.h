// Targets and exemplars of the energy's tests, which own the planes that the measure only views.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "core/image/hash.h"
#include "measure/energy.h"
#include "scumble/picture.h"

namespace scumble::testing {

struct EnergyScene {
  Picture picture;
  std::array<std::vector<float>, 3> normal;
  std::vector<float> coverage;
  std::vector<std::uint8_t> usable;
  std::vector<std::vector<float>> more;
  std::vector<float> free;  // empty: none

  // Everything covered and usable, black, facing the viewer.
  EnergyScene(int width, int height) : picture(width, height) {
    const std::size_t count = std::size_t(width) * height;
    for (auto& plane : normal) plane.assign(count, 0.0f);
    normal[2].assign(count, 1.0f), coverage.assign(count, 1.0f), usable.assign(count, 1);
  }
  std::size_t Index(int x, int y) const { return std::size_t(y) * picture.width + x; }
  void SetNormal(int x, int y, glm::vec3 n) {
    for (int c = 0; c < 3; ++c) normal[std::size_t(c)][Index(x, y)] = n[c];
  }
  glm::dvec3 Normal(int x, int y) const {
    return {normal[0][Index(x, y)], normal[1][Index(x, y)], normal[2][Index(x, y)]};
  }
  void ForEach(const std::function<void(int x, int y)>& visit) const {
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) visit(x, y);
    }
  }
  void Paint(const std::function<std::array<int, 3>(int x, int y)>& color) {
    ForEach([&](int x, int y) {
      const auto rgb = color(x, y);
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<std::uint16_t>(rgb[std::size_t(c)]);
      picture.At(x, y)[3] = 65535;
    });
  }
  std::vector<std::span<const float>> More() const { return {more.begin(), more.end()}; }
  EnergyTarget Target() const { return {&picture, {normal[0], normal[1], normal[2]}, coverage, More(), free}; }
  double FreeAt(int x, int y) const { return free.empty() ? 0.0 : free[Index(x, y)]; }
  EnergyExemplar Exemplar() const { return {&picture, {normal[0], normal[1], normal[2]}, usable, More()}; }
};

inline std::array<int, 3> NoiseColor(std::uint64_t seed, int x, int y) {
  return {int(Hash(seed, x, y, 0) & 0xffff), int(Hash(seed, x, y, 1) & 0xffff), int(Hash(seed, x, y, 2) & 0xffff)};
}

// The sphere that fills the square, usable inside its outline, in any paint.
inline EnergyScene Ball(int size) {
  EnergyScene ball(size, size);
  ball.ForEach([&](int x, int y) {
    const float nx = (2.0f * x + 1 - size) / size, ny = -(2.0f * y + 1 - size) / size, z2 = 1.0f - nx * nx - ny * ny;
    const std::size_t i = ball.Index(x, y);
    ball.coverage[i] = z2 > 0.0f, ball.usable[i] = z2 > 0.0f;
    ball.SetNormal(x, y, z2 > 0.0f ? glm::vec3(nx, ny, std::sqrt(z2)) : glm::vec3(0.0f));
  });
  return ball;
}

inline EnergyReport MustMeasure(const EnergyTarget& target, std::span<const EnergyExemplar> exemplars,
                                const EnergyOptions& options) {
  const auto report = MeasureEnergy(target, exemplars, options);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().message);
  return report.ok() ? *report : EnergyReport{};
}

inline EnergyReport MustMeasure(const EnergyScene& target, const EnergyScene& exemplar,
                                const EnergyOptions& options = {}) {
  const EnergyExemplar one = exemplar.Exemplar();
  return MustMeasure(target.Target(), {&one, 1}, options);
}

}  // namespace scumble::testing
