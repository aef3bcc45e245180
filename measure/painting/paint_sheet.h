// A painted exemplar for the measures of paint: its picture, the usable pixels, and their normals.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/image/style.h"

namespace scumble {

// Refers to the exemplar, which must outlive it. Pixels are those of the exemplar's picture, rows from the top; angles
// and axes are those of view space (core/image/guides.h).
class PaintSheet {
 public:
  // Usable pixels: on a sphere, those at least `rim` pixels, and its SoftEdge, inside the circle that fills the square;
  // in a painted scene, those that its guides cover. The picture is not empty; that of a sphere is square.
  PaintSheet(const Exemplar& exemplar, double rim);

  const Picture& picture() const { return exemplar_.picture; }
  bool is_sphere() const { return exemplar_.is_sphere; }
  int width() const { return picture().width; }
  int height() const { return picture().height; }
  std::size_t Index(int x, int y) const { return std::size_t(y) * width() + x; }
  bool Usable(int x, int y) const { return usable_[Index(x, y)] != 0; }
  std::size_t usable_pixels() const { return usable_pixels_; }
  // Pixels of a sphere that are not used: `rim`, or its soft edge where that is wider.
  double rim() const { return std::max(rim_, static_cast<double>(soft_edge_)); }
  double style_rim() const { return rim_; }
  int soft_edge() const { return soft_edge_; }  // of a sphere

  // The unit normal at a usable pixel's centre.
  glm::vec3 Normal(int x, int y) const;

  // Whether there is paint: alpha above a hundredth.
  bool Shows(int x, int y) const { return picture().At(x, y)[3] > kClearAlpha; }

  // CIE L* (0 black … 100 white) of every pixel: translucent paint as on white paper, transparent pixels by their
  // colour.
  const std::vector<float>& lightness() const { return lightness_; }

  static constexpr std::uint16_t kClearAlpha = 655;

 private:
  const Exemplar& exemplar_;
  double rim_;
  int soft_edge_ = 0;
  std::vector<std::uint8_t> usable_;
  std::size_t usable_pixels_ = 0;
  std::vector<float> lightness_;
};

}  // namespace scumble
