// Painted spheres for tests: one without faults, which a test changes in one respect.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <utility>

#include "core/image/direction.h"
#include "core/image/hash.h"
#include "core/image/style.h"

namespace scumble {

struct PaintedSphere {
  int size = 512;
  double x = 0.5, y = 0.5, radius = 0.5;  // of the sphere, in shares of the size
  double reach = 1.12;                    // paint goes on to so many radii, wavering, and then there is paper
  double waver = 0.05;
  double azimuth = kKeyLightAzimuth, elevation = kKeyLightElevation;
  double dark = 0.12, light = 0.8;  // grey, encoded, 0 … 1
  double grain = 0.06;
  double paper = 0.93;
};

inline void SetGrey(Picture& picture, int x, int y, double grey) {
  std::uint16_t* texel = picture.At(x, y);
  texel[0] = texel[1] = texel[2] = static_cast<std::uint16_t>(65535.0 * std::clamp(grey, 0.0, 1.0) + 0.5);
  texel[3] = 65535;
}

// Shaded in the light, with specks of four pixels each of which is lighter or darker by chance. Shades are warmer than
// lights.
inline Picture PaintSphere(const PaintedSphere& sphere) {
  Picture picture(sphere.size, sphere.size);
  const glm::dvec3 to_light = DirectionFromAngles(sphere.azimuth, sphere.elevation);
  for (int y = 0; y < sphere.size; ++y) {
    for (int x = 0; x < sphere.size; ++x) {
      const double u = ((x + 0.5) / sphere.size - sphere.x) / sphere.radius;
      const double v = (sphere.y - (y + 0.5) / sphere.size) / sphere.radius, r = std::hypot(u, v);
      const double edge =
          sphere.reach +
          sphere.waver * (std::sin(7.0 * std::atan2(v, u)) + std::sin(17.0 * std::atan2(v, u) + 1.0)) / 2.0;
      if (r > edge) {
        SetGrey(picture, x, y, sphere.paper);
        continue;
      }
      const double in = std::max(1.0, r), w = std::sqrt(std::max(0.0, 1.0 - u * u / in / in - v * v / in / in));
      const double lit = std::max(0.0, glm::dot(to_light, glm::dvec3(u / in, v / in, w)));
      const double speck = UnitFloat(Hash(x / 2, y / 2, 7)) - 0.5 + UnitFloat(Hash((x + 1) / 3, (y + 2) / 3, 8)) - 0.5;
      SetGrey(picture, x, y, sphere.dark + (sphere.light - sphere.dark) * lit + sphere.grain * speck);
      std::uint16_t* texel = picture.At(x, y);
      texel[2] = static_cast<std::uint16_t>(texel[2] - (1.0 - lit) * 0.25 * texel[2]);
    }
  }
  return picture;
}

// Multiplies colours inside the picture by a pattern of the place.
inline void Overlay(Picture& picture, const std::function<double(double x, double y)>& factor) {
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      const double by = factor(x + 0.5, y + 0.5);
      for (int c = 0; c < 3; ++c) texel[c] = static_cast<std::uint16_t>(std::clamp(texel[c] * by, 0.0, 65535.0));
    }
  }
}

inline Exemplar ExemplarOf(Picture picture) { return {"lit.png", std::move(picture), std::nullopt}; }

}  // namespace scumble
