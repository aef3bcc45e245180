// Exemplars that are painted scenes, for the tests of the search for sources in them.
#pragma once

#include <memory>

#include "tests/support/transfer_fixtures.h"

namespace scumble::testing {

// Blobs, holes and single pixels.
inline GuideSet Blobs(int width, int height, std::uint64_t seed) {
  return MakeGuides(width, height, [=](int x, int y) {
    const bool background = Hash(seed, x / 5, y / 7) % 4 == 0 || Hash(seed, x, y) % 61 == 0;
    if (background) return glm::vec3(0.0f);
    glm::vec3 n = AnyDirection(Hash(seed, x, y, 1));
    n.z = std::fabs(n.z);
    return n;
  });
}

inline Style SceneStyle(Picture picture, GuideSet guides) {
  Style style = PlainStyle(std::move(picture));
  style.exemplars[0].guides = std::move(guides);
  style.exemplars[0].is_sphere = false;
  return style;
}

inline Picture WideNoise(int width, int height) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(width, i) & 0xffff);
  }
  return picture;
}

inline std::shared_ptr<const PreparedExemplar> MustPrepare(const Style& style, const PrepareOptions& options = {}) {
  const auto prepared = Prepare(style, 100, options);
  EXPECT_TRUE(prepared.ok()) << (prepared.ok() ? "" : prepared.error().message);
  return prepared->exemplar;
}

}  // namespace scumble::testing
