// An outline of guides that are turned by 90 degrees is the turned outline.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

// Clockwise: the first row becomes the last column.
Picture Turned(const Picture& picture) {
  Picture turned(picture.height, picture.width);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) std::copy_n(picture.At(x, y), 4, turned.At(picture.height - 1 - y, x));
  }
  return turned;
}

GuideSet Turned(const GuideSet& guides) {
  GuideSet turned(guides.height(), guides.width());
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.layers().Has(info.layer)) continue;
    turned.Add(info.layer);
    for (int c = 0; c < static_cast<int>(info.channels.size()); ++c) {
      // Right becomes down, and up becomes right.
      const bool is_normal = info.layer == Layer::kNormal && c < 2;
      const auto from = guides.Plane(info.layer, is_normal ? 1 - c : c);
      const auto to = turned.Plane(info.layer, c);
      for (int y = 0; y < guides.height(); ++y) {
        for (int x = 0; x < guides.width(); ++x) {
          const float value = from[guides.Index(x, y)];
          to[turned.Index(guides.height() - 1 - y, x)] = is_normal && c == 1 ? -value : value;
        }
      }
    }
  }
  return turned;
}

// A slanted box with a crease, before a floor that ends in a slanted line: steps, corners and a junction.
GuideSet BoxOnFloor() {
  return GuidesOf(97, 83, [](glm::vec2 at) -> SeenPoint {
    const glm::vec2 off(0.8f * (at.x - 45.3f) + 0.6f * (at.y - 40.2f), 0.8f * (at.y - 40.2f) - 0.6f * (at.x - 45.3f));
    if (std::fabs(off.x) < 26.0f && std::fabs(off.y) < 17.0f) {
      const bool left = off.x < -4.0f;
      return {true, left ? glm::vec3(-0.6f, 0.0f, 0.8f) : glm::vec3(0.0f, 0.6f, 0.8f), 5.0f, 1.0f};
    }
    if (at.y > 50.4f + 0.3f * at.x) return {true, {0, 0.8f, 0.6f}, 8.0f - 0.02f * at.y, 2.0f};
    return {};
  });
}

// The ink that is not where it was: at most in a pixel, and of all ink.
struct Moved {
  double most = 0.0, share = 0.0, of_ink = 0.0;  // pixels full of it
};
Moved MovedInk(const Picture& a, const Picture& b, const Picture& ground) {
  Moved moved;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    const double off = std::fabs(double(a.rgba[i]) - b.rgba[i]) / 65535.0;
    moved.most = std::max(moved.most, off), moved.share += off;
    moved.of_ink += std::fabs(double(a.rgba[i]) - ground.rgba[i]) / 65535.0;
  }
  moved.share /= moved.of_ink;
  return moved;
}

// `most` of a pixel's ink, and `share` of all ink.
void ExpectTurned(OutlinePass::Form form, const GuideSet& guides, double most, double share) {
  OutlinePass outline;
  outline.form = form;
  const Picture ground = PlainPicture(guides.width(), guides.height(), 65535, 65535, 65535);
  const GuideSet turned = Turned(guides);
  const Picture made = Turned(Finished(StepOf(outline), &guides, ground));
  const Picture of_turned = Finished(StepOf(outline), &turned, Turned(ground));
  const Moved moved = MovedInk(made, of_turned, Turned(ground));
  EXPECT_GT(moved.of_ink, 100.0);
  EXPECT_LE(moved.most, most);
  EXPECT_LE(moved.share, share);
}

// Closed lines are smoothed from where they begin, which is another place in the turned picture.
TEST(TurnedOutline, StrokesMoveByATenthOfAPixel) {
  ExpectTurned(OutlinePass::Form::kStrokes, LitBalls(), 0.1, 0.005);
  ExpectTurned(OutlinePass::Form::kStrokes, BoxOnFloor(), 0.1, 0.005);
}

// Where two borders are equally far, another one may be the nearest: a pixel here and there.
TEST(TurnedOutline, TheFieldIsTheSameButForSinglePixels) {
  ExpectTurned(OutlinePass::Form::kField, LitBalls(), 0.0, 0.0);
  ExpectTurned(OutlinePass::Form::kField, BoxOnFloor(), 0.25, 0.001);
}

}  // namespace
}  // namespace scumble
