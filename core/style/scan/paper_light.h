// The light of a scan or photograph, measured from its white paper and its printed black.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "core/style/scan/template_fit.h"
#include "scumble/picture.h"

namespace scumble {

// Per channel, in linear light. The paper's brightness at a place of the template is exp of a polynomial of second
// order, which is positive everywhere and cannot follow a brush stroke. Black is the reflection of the printed black,
// as a share of the paper there (ink, and glare on it).
struct PaperLight {
  // Coefficients of 1, x, y, x², xy, y²; x and y from the template's middle, in diameters of the sphere.
  std::array<std::array<double, 6>, 3> log_white{};
  std::array<double, 3> black{};
  // The share of all examined places that the fit took for bare paper; the others are painted over, or in a shadow's
  // edge.
  double bare_share = 0;
  double clipped_share = 0;  // of the bare places, those whose brightest channel is at the file's limit

  // 1 for each channel of white paper at (x, y) in template coordinates.
  glm::dvec3 White(glm::dvec2 on_template) const;
  // The loss of light at the template's darkest place against its brightest: 0 is even, 0.4 a loss of 40 %.
  double Unevenness() const;
};

// Measures the margin: quiet zones and white bits of the found marks, and the paper between them, where paint may have
// run over. Bare paper is the brightest part there, so places much darker than the fit do not count. Never fails: a
// margin painted black counts as black paper.
PaperLight MeasurePaperLight(const Picture& picture, const TemplateFit& fit);

}  // namespace scumble
