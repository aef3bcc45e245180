#include "guidegen/rays/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "guidegen/scene/matrix_util.h"

namespace scumble {
namespace {

std::string Called(const Camera& camera) { return "camera \"" + camera.name + "\" "; }

// Empty if the camera is usable; otherwise its fault.
std::string FindFault(const Camera& camera) {
  if (camera.orthographic) {
    if (!(camera.ymag > 0.0) || !std::isfinite(camera.ymag)) {
      return "has the half height " + std::to_string(camera.ymag) + ": give it one above 0";
    }
  } else if (!(camera.yfov_degrees > 0.0 && camera.yfov_degrees < 180.0)) {
    return "has the vertical angle " + std::to_string(camera.yfov_degrees) + " degrees: give it one between 0 and 180";
  }
  if (camera.aspect && (!(*camera.aspect > 0.0) || !std::isfinite(*camera.aspect))) {
    return "has the aspect ratio " + std::to_string(*camera.aspect) + ": give it one above 0, or none";
  }
  if (!std::isfinite(camera.shift_x) || !std::isfinite(camera.shift_y)) {
    return "has a shift that is not finite: give it one around 0";
  }
  if (const auto& border = camera.border) {
    const auto fits = [](double from, double to) { return from >= 0.0 && from < to && to <= 1.0; };
    if (!fits(border->left, border->right) || !fits(border->bottom, border->top)) {
      std::ostringstream fault;
      fault << "has a border from " << border->left << ", " << border->bottom << " to " << border->right << ", "
            << border->top << ": give it sides from 0 to 1, left before right and bottom before top";
      return fault.str();
    }
  }
  if (!(std::max(camera.z_near, 0.0) < camera.z_far) || std::isnan(camera.z_near)) {
    return "has its near plane at " + std::to_string(camera.z_near) + " and its far plane at " +
           std::to_string(camera.z_far) + ": the near plane must come first";
  }
  return {};
}

bool MeasuresWidth(const Camera& camera, double picture_aspect) {
  return camera.fit == CameraFit::kHorizontal || (camera.fit == CameraFit::kLonger && picture_aspect >= 1.0);
}

// Half the picture's width and height, where `half` is half of the side that the camera measures.
glm::dvec2 HalfExtent(const Camera& camera, double half, double picture_aspect) {
  if (MeasuresWidth(camera, picture_aspect)) return {half, half / picture_aspect};
  const bool keep_horizontal = camera.fit == CameraFit::kVertical && camera.aspect && *camera.aspect > picture_aspect;
  const double half_width = half * (keep_horizontal ? *camera.aspect : picture_aspect);
  return {half_width, keep_horizontal ? half_width / picture_aspect : half};
}

PixelWindow WindowOf(const std::optional<CameraBorder>& border, int width, int height) {
  if (!border || border->crop) return {0, 0, width, height};
  const auto at = [](double share, int side) { return static_cast<int>(float(share) * float(side)); };
  return {at(border->left, width), height - at(border->top, height), at(border->right, width),
          height - at(border->bottom, height)};
}

}  // namespace

Expected<CameraPose> CameraPose::Make(const Camera& camera) {
  if (const std::string fault = FindFault(camera); !fault.empty()) return InputError(Called(camera) + fault);
  const std::optional<glm::dmat3> axes = StraightenAxes(camera.world_from_camera);
  if (!axes) {
    return InputError(Called(camera) +
                      "has a matrix without a direction: its axes must be finite, not zero and not parallel");
  }
  CameraPose pose;
  pose.axes_ = *axes;
  pose.eye_ = glm::dvec3(camera.world_from_camera[3]);
  return pose;
}

Expected<CameraRays> CameraRays::Make(const Camera& camera, int width, int height) {
  CameraRays rays;
  SCUMBLE_ASSIGN(static_cast<CameraPose&>(rays), CameraPose::Make(camera));
  rays.name_ = camera.name;
  rays.orthographic_ = camera.orthographic;
  rays.width_ = width;
  rays.height_ = height;
  rays.near_depth_ = std::max(camera.z_near, 0.0);
  rays.far_depth_ = camera.z_far;

  const double half = camera.orthographic ? camera.ymag : std::tan(glm::radians(camera.yfov_degrees) / 2.0);
  rays.window_ = WindowOf(camera.border, width, height);
  // Of the frame, which is larger than the picture where that is cropped.
  const CameraBorder shown = camera.border && camera.border->crop ? *camera.border : CameraBorder();
  const glm::dvec2 share(shown.right - shown.left, shown.top - shown.bottom);
  const double aspect = double(width) / height * (share.y / share.x);
  const glm::dvec2 frame = HalfExtent(camera, half, aspect);
  rays.half_extent_ = frame * share;
  rays.shift_ = 2.0 * (MeasuresWidth(camera, aspect) ? frame.x : frame.y) * glm::dvec2(camera.shift_x, camera.shift_y) +
                frame * glm::dvec2(shown.left + shown.right - 1.0, shown.bottom + shown.top - 1.0);
  rays.step_ = rays.half_extent_ / glm::dvec2(width, height);
  const glm::dvec2 farthest = rays.half_extent_ + glm::abs(rays.shift_);
  const double most = std::max(farthest.x, farthest.y);
  if (!(most <= kLargestInRay)) {
    std::ostringstream fault;
    fault << "sees " << most << (camera.orthographic ? " m" : " m at a distance of 1 m")
          << " to one side in a picture of " << width << "x" << height << " pixels; expected at most " << kLargestInRay
          << ": give it a smaller " << (camera.orthographic ? "height" : "angle") << ", aspect or shift";
    return InputError(Called(camera) + fault.str());
  }
  return rays;
}

ViewRay CameraRays::Through(double x, double y) const {
  const double across = (2.0 * x - width_) * step_.x + shift_.x;
  const double up = (height_ - 2.0 * y) * step_.y + shift_.y;
  ViewRay ray;
  (orthographic_ ? ray.origin : ray.direction) += glm::dvec3(across, up, 0.0);
  return ray;
}

ViewRay CameraRays::ThroughWithFootprint(double x, double y) const {
  ViewRay ray = Through(x, y);
  const glm::dvec2 pixel = 2.0 * step_;
  if (orthographic_) {
    ray.width = 0.5 * (pixel.x + pixel.y);
    return ray;
  }
  const glm::dvec3 centre = glm::normalize(ray.direction);
  const auto side = [&](const glm::dvec3& step) { return glm::length(glm::normalize(ray.direction + step) - centre); };
  ray.spread = 0.5 * (side({pixel.x, 0.0, 0.0}) + side({0.0, pixel.y, 0.0}));
  return ray;
}

std::optional<glm::dvec2> CameraRays::PixelOf(const glm::dvec3& point) const {
  if (!orthographic_ && !(point.z < 0.0)) return std::nullopt;
  const glm::dvec2 plane = orthographic_ ? glm::dvec2(point) : glm::dvec2(point) / -point.z;
  const glm::dvec2 steps = (plane - shift_) / step_;
  return glm::dvec2((steps.x + width_) / 2.0, (height_ - steps.y) / 2.0);
}

glm::dmat4 CameraPose::ViewFromObject(const glm::dmat4& world_from_object) const {
  const glm::dmat3 view_from_world = glm::transpose(axes_);
  const glm::dmat3 linear = view_from_world * glm::dmat3(world_from_object);
  glm::dmat4 result(linear);
  result[3] = glm::dvec4(ViewFromWorld(glm::dvec3(world_from_object[3])), 1.0);
  return result;
}

GuideCamera CameraRays::ToGuideCamera() const {
  GuideCamera camera;
  camera.name = name_;
  const glm::dmat3 view_from_world = glm::transpose(axes_);
  camera.view_from_world = glm::dmat4(view_from_world);
  camera.view_from_world[3] = glm::dvec4(-(view_from_world * eye_), 1.0);

  glm::dmat4& clip = camera.clip_from_view;
  clip = glm::dmat4(0.0);
  clip[0][0] = 1.0 / half_extent_.x;
  clip[1][1] = 1.0 / half_extent_.y;
  if (orthographic_) {
    const double n = near_depth_;
    const double f = std::isinf(far_depth_) ? n + 1000.0 : far_depth_;
    clip[2][2] = -2.0 / (f - n);
    clip[3][2] = -(f + n) / (f - n);
    clip[3][0] = -shift_.x / half_extent_.x;
    clip[3][1] = -shift_.y / half_extent_.y;
    clip[3][3] = 1.0;
    return camera;
  }
  const double n = near_depth_ > 0.0 ? near_depth_ : std::min(0.01, far_depth_ / 2.0);
  const bool endless = std::isinf(far_depth_);
  clip[2][2] = endless ? -1.0 : -(far_depth_ + n) / (far_depth_ - n);
  clip[3][2] = endless ? -2.0 * n : -2.0 * far_depth_ * n / (far_depth_ - n);
  clip[2][0] = shift_.x / half_extent_.x;
  clip[2][1] = shift_.y / half_extent_.y;
  clip[2][3] = -1.0;
  return camera;
}

}  // namespace scumble
