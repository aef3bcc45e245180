// From pixels to rays, in view space and in double: +X right, +Y up, +Z towards the viewer, the eye at the origin.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "guidegen/scene.h"
#include "guidegen/scene/view_ray.h"

namespace scumble {

// The place and rotation of a camera: its view space, for pictures of any size. Immutable; free to use from any thread.
class CameraPose {
 public:
  // Only the direction of the camera matrix's axes counts: scale is dropped and shear is removed, keeping the viewing
  // direction. Fails with kInput, naming the camera, on a matrix that has no direction, an angle outside (0, 180), a
  // height that is not positive, a shift that is not finite, or a far plane before the near one.
  static Expected<CameraPose> Make(const Camera& camera);

  // The camera's position is subtracted before anything is rotated: two places 1e7 m from the origin and one metre
  // apart keep their distance.
  glm::dmat4 ViewFromObject(const glm::dmat4& world_from_object) const;
  glm::dvec3 ViewFromWorld(const glm::dvec3& point) const { return glm::transpose(axes_) * (point - eye_); }
  glm::dvec3 WorldFromView(const glm::dvec3& point) const { return eye_ + axes_ * point; }
  glm::dvec3 DirectionToView(const glm::dvec3& direction) const { return glm::transpose(axes_) * direction; }

 protected:
  CameraPose() = default;

  glm::dmat3 axes_{1.0};  // world from view
  glm::dvec3 eye_{0.0};
};

// Pixels of a picture: columns x0 … x1 − 1, rows y0 … y1 − 1.
struct PixelWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool operator==(const PixelWindow&) const = default;
  bool Contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

// A camera in front of a picture of a certain size. Immutable; free to use from any thread.
class CameraRays : public CameraPose {
 public:
  // Fails as CameraPose::Make does, and with kInput where rays would exceed kLargestInRay.
  static Expected<CameraRays> Make(const Camera& camera, int width, int height);

  // The ray through a point of the picture, in pixels from the top left corner.
  ViewRay Through(double x, double y) const;
  // The same with the width of a pixel's footprint, as Cycles 3.4 has it: the mean of the two sides of a pixel, in
  // perspective measured on the unit sphere about the eye.
  ViewRay ThroughWithFootprint(double x, double y) const;

  // The pixels that are drawn: those of the camera's border, or all. Blender cuts the product of a border and the
  // picture's side, in floats, to a whole number. May be empty.
  const PixelWindow& window() const { return window_; }

  // Whether rays differ in their origin; otherwise in their direction.
  bool orthographic() const { return orthographic_; }

  // The place in the picture of a point of view space, the inverse of Through; empty behind the eye.
  std::optional<glm::dvec2> PixelOf(const glm::dvec3& point) const;

  // The planar depths between which surfaces are visible; the far one may be infinite.
  double near_depth() const { return near_depth_; }
  double far_depth() const { return far_depth_; }

  // For the file's header. OpenGL has no matrix for a near plane at the eye or a far plane at infinity in an
  // orthographic picture; 1 cm and 1 km behind the near plane replace them. x and y do not depend on them.
  GuideCamera ToGuideCamera() const;

 private:
  std::string name_;
  bool orthographic_ = false;
  int width_ = 1;
  int height_ = 1;
  PixelWindow window_;
  glm::dvec2 half_extent_{1.0};  // at depth 1 in perspective, in metres otherwise
  glm::dvec2 step_{1.0};         // half a pixel, in the same unit
  glm::dvec2 shift_{0.0};        // of the picture's centre, in the same unit
  double near_depth_ = 0.0;
  double far_depth_ = 0.0;
};

}  // namespace scumble
