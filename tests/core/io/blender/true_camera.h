// Known cameras, and a renderer's output for them.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "core/image/hash.h"
#include "core/io/blender/solve_camera.h"

namespace scumble {

struct TrueCamera {
  int width = 320, height = 180;
  double scale = 400.0;   // focal length in pixels; pixels a metre where orthographic
  glm::dvec2 shift{0.0};  // of the principal point, pixels right and down
  bool orthographic = false;
  double pixel_width = 1.0;  // times the height
  glm::dmat3 view_from_world{1.0};
  glm::dvec3 origin{0.0};  // where the camera stands
  std::uint64_t seed = 0;
  std::function<double(double u, double v)> depth = [](double u, double v) {
    return 5.0 + std::sin(0.05 * u) + 0.7 * std::cos(0.08 * v);
  };
  std::function<glm::dvec2(int x, int y)> jitter;  // where in the pixel the sample lies, from its centre

  glm::dvec2 Project(glm::dvec3 world) const {
    const glm::dvec3 q = view_from_world * (world - origin);
    const double k = orthographic ? scale : scale / -q.z;
    return {0.5 * width + shift.x + k * q.x / pixel_width, 0.5 * height + shift.y - k * q.y};
  }
};

inline double Uniform(std::uint64_t seed, int k) { return UnitFloat(Hash(seed, k)); }

// A rotation by three angles of the seed.
inline glm::dmat3 RandomRotation(std::uint64_t seed) {
  glm::dmat4 m(1.0);
  m = glm::rotate(m, 6.28 * Uniform(seed, 1), glm::dvec3(0, 1, 0));
  m = glm::rotate(m, 2.8 * Uniform(seed, 2) - 1.4, glm::dvec3(1, 0, 0));
  m = glm::rotate(m, 6.28 * Uniform(seed, 3), glm::dvec3(0, 0, 1));
  return glm::dmat3(m);
}

// A renderer's output for the camera: float positions and depths, a corner of background.
struct Render {
  explicit Render(const TrueCamera& camera) : width(camera.width), height(camera.height) {
    for (auto& plane : position) plane.assign(std::size_t(width) * height, 0.0f);
    depth.assign(std::size_t(width) * height, 1e10f);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (x + y < width / 4) continue;
        const glm::dvec2 offset = camera.jitter ? camera.jitter(x, y) : glm::dvec2(0.0);
        const double u = x + 0.5 + offset.x - 0.5 * width - camera.shift.x;
        const double v = y + 0.5 + offset.y - 0.5 * height - camera.shift.y;
        const double z = camera.depth(u, v);
        const double k = camera.orthographic ? 1.0 / camera.scale : z / camera.scale;
        const glm::dvec3 world =
            camera.origin + glm::transpose(camera.view_from_world) * glm::dvec3(u * k * camera.pixel_width, -v * k, -z);
        const std::size_t i = std::size_t(y) * width + x;
        for (int c = 0; c < 3; ++c) position[c][i] = static_cast<float>(world[c]);
        depth[i] = static_cast<float>(z);
      }
    }
  }
  Expected<SolvedCamera> Solve() const {
    SolveCameraInput input;
    input.width = width, input.height = height;
    for (int c = 0; c < 3; ++c) input.position[c] = position[c];
    input.depth = depth;
    return SolveCamera(input, "shot.exr");
  }
  glm::dvec3 At(std::size_t i) const { return {position[0][i], position[1][i], position[2][i]}; }

  int width, height;
  std::vector<float> position[3];
  std::vector<float> depth;
};

// In degrees.
inline double AngleBetween(const glm::dmat3& a, const glm::dmat3& b) {
  const glm::dmat3 d = a * glm::transpose(b);
  const glm::dvec3 axis(d[1][2] - d[2][1], d[2][0] - d[0][2], d[0][1] - d[1][0]);
  return std::atan2(0.5 * glm::length(axis), 0.5 * (d[0][0] + d[1][1] + d[2][2] - 1.0)) * 57.29577951308232;
}

}  // namespace scumble
