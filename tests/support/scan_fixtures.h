// Scans and photographs of a painted template, made with a known camera, known light and known faults.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/scan/template_fit.h"

namespace scumble {

// The template with `paint` on its sphere and a ragged rim of it beyond the sphere's edge, on white paper.
Picture PaintedTemplate(const Picture& paint);
// That of the bundled charcoal, lit.
const Picture& CharcoalSheet();

struct Scan {
  int width = 900, height = 720;
  double fill = 0.85;               // of the shorter side, by the template
  double rotation = 0;              // degrees clockwise
  double tilt = 0, towards = 0;     // degrees; about an axis in that direction of the sheet
  double shift_x = 0, shift_y = 0;  // pixels
  double barrel = 0;                // share by which the picture's corner is pulled in
  bool mirrored = false;
  double curl = 0;       // height of the sheet's wave, in diameters of the sphere
  double blur = 0;       // standard deviation, pixels
  double noise = 0;      // standard deviation, of 255
  int jpeg_quality = 0;  // 0: none
  double gradient = 0;   // share of light that is lost from the left to the right of the picture
  std::array<double, 3> cast{1, 1, 1};
  double glare = 0;          // light added everywhere, a share of white
  std::vector<int> covered;  // marks under a thumb
  int seed = 1;
};

// Sheet ([0, 1]² is the sphere's square) → picture, for a camera that sees the longer side at 67 degrees.
class ScanCamera {
 public:
  explicit ScanCamera(const Scan& scan);

  glm::dvec2 ToPicture(glm::dvec2 on_sheet) const;

  // By Newton's steps from the sheet's middle, or from `guess`.
  glm::dvec2 ToSheet(glm::dvec2 in_picture, glm::dvec2 guess) const;

  double SpherePixels() const { return focal_ / distance_; }

 private:
  Scan scan_;
  glm::dvec2 middle_;
  glm::dmat3 turn_{1.0};
  double focal_ = 1, distance_ = 1;
};

Picture TakeScan(const Picture& sheet, const Scan& scan);

// The largest registration error anywhere on the sphere, a share of its diameter.
double TrueError(const TemplateMap& map, const Scan& scan);

}  // namespace scumble
