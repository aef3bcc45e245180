// A ball on a floor before a wall, as a painter looks at it: what the guides of scenes/ball.glb say at each place of
// the picture. Lengths are units of kSide; the picture is square, whatever size the guides have.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "core/image/status.h"
#include "exemplars/paint/engine/canvas.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

// What is seen at a place; all in [0, 1].
struct Seen {
  float light = 0.0f;      // of the lamp, cast shadows taken off: a share of the brightest
  float cast = 0.0f;       // share of the lamp that something hides
  float bounce = 0.0f;     // what other surfaces throw there: a share of the most
  float highlight = 0.0f;  // mirror image of the lamp, on the ball alone
};

class Scene {
 public:
  // Reads normal, object, luminance, shadow, lpe.LSE and lpe.LDDE. A kInput error says what is missing, or that there
  // is no ball among the objects' names.
  static Expected<Scene> Load(const std::filesystem::path& guides);

  int guide_size() const { return light_.size; }  // pixels

  // Distance from the ball's middle in radii: 1 on its outline.
  float BallDistance(glm::vec2 at) const;
  // Where floor and wall meet, downward from the top.
  float horizon() const { return horizon_; }
  bool IsFloor(glm::vec2 at) const { return at.y > horizon_; }
  // How near a place of the floor is: 0 at the wall, 1 at the picture's lower edge. Marks grow with it.
  float Nearness(glm::vec2 at) const;

  // On the ball; places outside it are taken on its outline.
  Seen OnBall(glm::vec2 at) const;
  // On the floor and the wall, with what the ball covers continued from beside it.
  Seen Behind(glm::vec2 at) const;
  // How close the floor there is to where the ball touches it: 1 in the crevice.
  float Contact(glm::vec2 at) const;

  // A flow of the sphere that fills the picture, on the ball: AroundAxis for instance.
  Flow OverBall(const Flow& of_sphere) const;
  // Lines of the floor that run across the view, a little bent as a hand draws them.
  Flow AcrossFloor() const;
  // Lines of the floor that run away from the lamp's foot, as cast shadows do.
  Flow AlongShadow() const;
  // Straight lines at that angle, in radians clockwise from the right.
  static Flow Slanting(float angle);

 private:
  explicit Scene(const Sheet& sheet) : light_(sheet), cast_(sheet), bounce_(sheet), highlight_(sheet) {}
  void CoverBall(const std::vector<bool>& ball);

  Field light_, cast_, bounce_, highlight_;  // as they are seen
  std::vector<std::size_t> behind_;          // for each pixel where the backdrop is read
  glm::vec2 middle_{0.0f};                   // of the ball
  float radius_ = 1.0f;
  float horizon_ = 0.0f;
};

}  // namespace scumble::paint
