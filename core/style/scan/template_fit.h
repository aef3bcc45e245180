// The template's place in a scan or photograph: a perspective map, and a lens's distortion where the marks show one.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/style/fiducials.h"
#include "core/style/scan/marker_detection.h"

namespace scumble {

// Template coordinates (core/style/fiducials.h: the sphere's square is [0, 1]²) → pixels of the picture.
struct TemplateMap {
  glm::dmat3 perspective{1.0};
  // A lens moves a point at distance r from the picture's middle by the factor 1 + bend · r², r in halves of the
  // diagonal: negative for a barrel, positive for a cushion.
  double bend = 0;
  glm::dvec2 middle{0.0};
  double half_diagonal = 1;

  glm::dvec2 ToPicture(glm::dvec2 on_template) const;
  // Pixels across the sphere, the mean of both directions.
  double SpherePixels() const;
  // Degrees clockwise that the template is turned in the picture, -180 … 180.
  double Turn() const;
};

struct TemplateFit {
  TemplateMap map;
  std::vector<FoundMark> marks;  // those that lie where the map has them, by id, one of each
  // All as shares of the sphere's diameter. `held_out`: root mean square of the distance of each mark's corners from
  // where the others alone expect them. `on_sphere`: the standard error of the sphere's outline that follows from
  // `at_marks`, the fit's residual at the corners.
  double held_out = 0;
  double on_sphere = 0;
  double at_marks = 0;
  int worst_id = 0;  // the mark that is farthest from where the others expect it
  double worst = 0;
};

// The most marks that are searched for a map, some sheets' worth of them: the work grows with the cube of their number.
inline constexpr std::size_t kMostMarks = 5 * kFiducialCount;

// The map on which most marks agree. Marks elsewhere (other squares read as marks, a second sheet) are left out. Empty
// if no four marks agree on one, if they agree on a mirrored one only, or if there are more than kMostMarks.
std::optional<TemplateFit> FitTemplate(std::span<const FoundMark> marks, int width, int height);

// A corner of a marker in template coordinates; `corner` as in FoundMark.
glm::dvec2 PrintedCorner(int id, int corner);

}  // namespace scumble
