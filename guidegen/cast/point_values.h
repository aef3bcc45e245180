// Values of layers at a point of a surface that depend on that point alone.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "guidegen/guidegen.h"
#include "guidegen/light/view.h"
#include "guidegen/rays/embree_scene.h"

namespace scumble {

// Immutable; free to use from any thread. The scene and the view outlive it.
class PointValues {
 public:
  PointValues(const EmbreeScene& scene, const View& view, NormalFrame frame)
      : scene_(scene), view_(view), frame_(frame) {}

  // The shading normal in the frame of the guides, where `ray` sees the point.
  glm::dvec3 Normal(const SurfacePoint& point, const ViewRay& ray) const;
  // The place before any deformation, in object space.
  glm::dvec3 Rest(std::uint32_t object, std::uint32_t primitive, const SurfacePoint& point, const ViewRay& ray) const;
  // The movement in the picture until the next frame, in pixels; 0 if the point is not in view then.
  glm::dvec2 Motion(std::uint32_t object, std::uint32_t primitive, const glm::dvec2& barycentric) const;
  // The cosine between the shading normal and the direction to the key lamp; 0 without one.
  double Cosine(const SurfacePoint& point) const;
  // Texture coordinates, (0, 0) lower left; (0, 0) where there are none.
  glm::dvec2 Uv(std::uint32_t object, std::uint32_t primitive, const glm::dvec2& barycentric) const;

 private:
  const EmbreeScene& scene_;
  const View& view_;
  NormalFrame frame_;
};

}  // namespace scumble
