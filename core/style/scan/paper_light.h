// The light in which a scan or photograph was taken, from its white paper and its printed black.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "core/style/scan/template_fit.h"
#include "scumble/picture.h"

namespace scumble {

// Per channel, in linear light: the paper's brightness at a place of the template is exp of a polynomial of second
// order in it, which is positive everywhere and cannot follow a brush stroke; black is what the printed black still
// reflects, as a share of the paper there (ink, and glare on it).
struct PaperLight {
  // Coefficients of 1, x, y, x², xy, y²; x and y from the template's middle, in diameters of the sphere.
  std::array<std::array<double, 6>, 3> log_white{};
  std::array<double, 3> black{};
  // Share of the places looked at that the fit took for bare paper; the rest is painted over, or in a shadow's edge.
  double bare_share = 0;
  double clipped_share = 0;  // of the bare places, those whose brightest channel is at the file's limit

  // 1 for each channel of white paper at (x, y) in template coordinates.
  glm::dvec3 White(glm::dvec2 on_template) const;
  // How the darkest of the light across the whole template is to the brightest: 0 is even, 0.4 a loss of 40 %.
  double Unevenness() const;
};

// From the margin: quiet zones and white bits of the marks that were found, and the paper between them, where paint may
// have run over. Bare paper is the brightest thing there, so places that are much darker than the fit count nothing.
// Never fails: a margin painted black is taken for what it is.
PaperLight MeasurePaperLight(const Picture& picture, const TemplateFit& fit);

}  // namespace scumble
