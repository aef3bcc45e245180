#include "exemplars/paint/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/io/guide_file.h"
#include "exemplars/paint/engine/chance.h"
#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/sphere.h"

namespace scumble::paint {
namespace {

constexpr float kInside = 0.985f;  // radii: guides on the very outline are half the wall's

// The smallest value that is at least as large as this share of all.
float Quantile(std::vector<float> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return std::max(*at, 1e-6f);
}

// As shares of a bright one.
void Normalise(Field& field, double share) {
  const float bright = Quantile(field.pixels, share);
  for (float& value : field.pixels) value = glm::clamp(value / bright, 0.0f, 1.0f);
}

std::size_t PixelAt(const Field& field, glm::vec2 at) {
  const float scale = static_cast<float>(field.size) / kSide;
  const int x = glm::clamp(static_cast<int>(at.x * scale), 0, field.size - 1);
  const int y = glm::clamp(static_cast<int>(at.y * scale), 0, field.size - 1);
  return std::size_t(y) * field.size + x;
}

}  // namespace

Expected<Scene> Scene::Load(const std::filesystem::path& guides) {
  GuideReadOptions options;
  options.required = {scumble::Layer::kCoverage,  scumble::Layer::kNormal, scumble::Layer::kObject,
                      scumble::Layer::kLuminance, scumble::Layer::kShadow, scumble::Layer::kLpeLSE,
                      scumble::Layer::kLpeLDDE};
  SCUMBLE_ASSIGN(const GuideSet set, ReadGuides(guides, options));
  if (set.width() != set.height()) {
    return InputError(guides.string() + " is " + std::to_string(set.width()) + "×" + std::to_string(set.height()) +
                      ": expected a square; render scenes/ball.glb with --size " + std::to_string(set.height()));
  }
  std::uint32_t ball_id = 0;
  for (const auto& [id, name] : set.object_names) {
    if (name == "Ball") ball_id = id;
  }
  const int size = set.width();
  Scene scene({size});
  std::vector<bool> ball(set.pixel_count());
  const auto ids = set.Plane(scumble::Layer::kObject);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    ball[i] = ball_id != 0 && static_cast<std::uint32_t>(ids[i]) == ball_id;
    const auto mean = [&](scumble::Layer layer) {
      const glm::vec3 color = set.Vec3(layer, i);
      return (color.r + color.g + color.b) / 3.0f;
    };
    scene.light_.pixels[i] = set.Plane(scumble::Layer::kLuminance)[i];
    scene.cast_.pixels[i] = glm::clamp(set.Plane(scumble::Layer::kShadow)[i], 0.0f, 1.0f);
    scene.bounce_.pixels[i] = mean(scumble::Layer::kLpeLDDE);
    scene.highlight_.pixels[i] = ball[i] ? mean(scumble::Layer::kLpeLSE) : 0.0f;
  }
  if (std::find(ball.begin(), ball.end(), true) == ball.end()) {
    return InputError(guides.string() + " shows no object named Ball: render scenes/ball.glb");
  }
  Normalise(scene.light_, 0.995);
  // The remaining sampling noise is below the response of a hand.
  scene.bounce_ = Blur(scene.bounce_, 4.0f);
  Normalise(scene.bounce_, 0.98);
  Normalise(scene.highlight_, 0.998);
  // Beside the sphere the horizon is where the floor begins.
  const glm::vec3 wall = set.Vec3(scumble::Layer::kNormal, 0);
  int row = 0;
  while (row < size - 1 && glm::dot(set.Vec3(scumble::Layer::kNormal, set.Index(size - 1, row)), wall) > 0.9f) ++row;
  scene.horizon_ = static_cast<float>(row) * kSide / static_cast<float>(size);
  scene.CoverBall(ball);
  return scene;
}

void Scene::CoverBall(const std::vector<bool>& ball) {
  const int size = light_.size;
  int left = size, right = 0, top = size, bottom = 0;
  behind_.resize(ball.size());
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::size_t i = std::size_t(y) * size + x;
      behind_[i] = i;
      if (!ball[i]) continue;
      left = std::min(left, x), right = std::max(right, x + 1), top = std::min(top, y),
      bottom = std::max(bottom, y + 1);
      int reach = 1;
      const auto free = [&](int at) { return at >= 0 && at < size && !ball[std::size_t(y) * size + at]; };
      while (reach < size && !free(x - reach) && !free(x + reach)) ++reach;
      behind_[i] = std::size_t(y) * size + std::size_t(free(x - reach) ? x - reach : std::min(x + reach, size - 1));
    }
  }
  const float unit = kSide / static_cast<float>(size);
  middle_ = 0.5f * unit * glm::vec2(left + right, top + bottom);
  radius_ = 0.25f * unit * static_cast<float>(right - left + bottom - top);
}

float Scene::SphereDistance(glm::vec2 at) const { return glm::distance(at, middle_) / radius_; }

float Scene::Nearness(glm::vec2 at) const { return glm::clamp((at.y - horizon_) / (kSide - horizon_), 0.0f, 1.0f); }

Seen Scene::OnSphere(glm::vec2 at) const {
  const glm::vec2 off = at - middle_;
  const float distance = glm::length(off);
  const float most = kInside * radius_;
  const std::size_t i = PixelAt(light_, distance > most ? middle_ + off * (most / distance) : at);
  return {light_.pixels[i], cast_.pixels[i], bounce_.pixels[i], highlight_.pixels[i]};
}

Seen Scene::Behind(glm::vec2 at) const {
  const std::size_t i = behind_[PixelAt(light_, at)];
  return {light_.pixels[i], cast_.pixels[i], bounce_.pixels[i], 0.0f};
}

float Scene::Contact(glm::vec2 at) const {
  const glm::vec2 foot = middle_ + glm::vec2(0.10f, 0.90f) * radius_;
  const glm::vec2 off = (at - foot) / radius_ * glm::vec2(1.0f, 2.8f);
  return Ramp(0.85f, 0.25f, glm::length(off));
}

Flow Scene::OverSphere(const Flow& of_sphere) const {
  return [of_sphere, middle = middle_, scale = kRadius / radius_](glm::vec2 at) {
    return of_sphere((at - middle) * scale + kRadius);
  };
}

Flow Scene::AcrossFloor() const {
  return [](glm::vec2 at) {
    const float angle = 0.05f * (at.x / kRadius - 1.0f);
    return glm::vec2(std::cos(angle), std::sin(angle));
  };
}

Flow Scene::AlongShadow() const {
  // Away from the light on the floor, in the picture: to the right, and up because that is farther away.
  return Slanting(-0.16f);
}

Flow Scene::Slanting(float angle) {
  return [way = glm::vec2(std::cos(angle), std::sin(angle))](glm::vec2) { return way; };
}

}  // namespace scumble::paint
