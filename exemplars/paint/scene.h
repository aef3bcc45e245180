// A sphere on a floor before a wall, for painting: the guides of scenes/ball.glb at each place of the picture. Lengths
// are units of kSide; the picture is square, for guides of any size.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "core/image/status.h"
#include "exemplars/paint/engine/canvas.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

// The values at a place; all in [0, 1].
struct Seen {
  float light = 0.0f;      // of the light, without cast shadows: a share of the brightest
  float cast = 0.0f;       // share of the light that an object hides
  float bounce = 0.0f;     // light from other surfaces: a share of the most
  float highlight = 0.0f;  // mirror image of the light, on the sphere alone
};

class Scene {
 public:
  // Reads normal, object, luminance, shadow, lpe.LSE and lpe.LDDE. A kInput error names a missing layer, or reports
  // that no object's name has "ball" in it.
  static Expected<Scene> Load(const std::filesystem::path& guides);

  // Distance from the sphere's middle in radii: 1 on its outline.
  float SphereDistance(glm::vec2 at) const;
  // Where floor and wall meet, downward from the top.
  float horizon() const { return horizon_; }
  bool IsFloor(glm::vec2 at) const { return at.y > horizon_; }
  // Nearness of a place on the floor: 0 at the wall, 1 at the picture's lower edge. Marks grow with it.
  float Nearness(glm::vec2 at) const;

  // On the sphere; places outside it are taken on its outline.
  Seen OnSphere(glm::vec2 at) const;
  // On the floor and the wall; behind the sphere they are continued from beside it.
  Seen Behind(glm::vec2 at) const;
  // Nearness of the floor to its contact with the sphere: 1 at the contact.
  float Contact(glm::vec2 at) const;

  // A flow of the sphere that fills the picture, on this sphere: AroundAxis for instance.
  Flow OverSphere(const Flow& of_sphere) const;
  // Lines of the floor that run across the view, slightly bent like a hand's.
  Flow AcrossFloor() const;
  // Lines of the floor that run away from the light's foot, like cast shadows.
  Flow AlongShadow() const;
  // Straight lines at that angle, in radians clockwise from the right.
  static Flow Slanting(float angle);

 private:
  explicit Scene(const Sheet& sheet) : light_(sheet), cast_(sheet), bounce_(sheet), highlight_(sheet) {}
  void CoverBall(const std::vector<bool>& ball);

  Field light_, cast_, bounce_, highlight_;  // in the picture
  std::vector<std::size_t> behind_;          // for each pixel the place where the backdrop is read
  glm::vec2 middle_{0.0f};                   // of the sphere
  float radius_ = 1.0f;
  float horizon_ = 0.0f;
};

}  // namespace scumble::paint
