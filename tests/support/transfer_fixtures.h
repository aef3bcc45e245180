// Guides and exemplars that the transfer's tests share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/image/guides.h"
#include "core/image/hash.h"
#include "core/image/style.h"
#include "transfer/transfer.h"

namespace scumble::testing {

// Guides with all the layers that the transfer may read; `normal` returns a zero vector for background. Depth is 10 m
// and the object id 1 on everything covered.
inline GuideSet MakeGuides(int width, int height, const std::function<glm::vec3(int x, int y)>& normal) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec3 n = normal(x, y);
      if (n == glm::vec3(0.0f)) continue;
      const std::size_t i = guides.Index(x, y);
      guides.Plane(Layer::kCoverage)[i] = 1.0f;
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = n[c];
      guides.Plane(Layer::kDepth)[i] = 10.0f;
      guides.Plane(Layer::kObject)[i] = 1.0f;
    }
  }
  return guides;
}

// An orthographic view of `height` metres, by a camera that stands wherever depths say.
inline GuideCamera OrthographicCamera(double height) {
  GuideCamera camera{"flat"};
  camera.clip_from_view[0][0] = camera.clip_from_view[1][1] = 2.0 / height;
  return camera;
}

// The normals of the sphere that fills an N × N picture, by the formula.
inline GuideSet SphereGuides(int size) {
  return MakeGuides(size, size, [size](int x, int y) {
    const float nx = (2.0f * x + 1 - size) / size, ny = -(2.0f * y + 1 - size) / size;
    const float z2 = 1.0f - nx * nx - ny * ny;
    return z2 > 0.0f ? glm::vec3(nx, ny, std::sqrt(z2)) : glm::vec3(0.0f);
  });
}

// A unit vector with any direction, from a hash.
inline glm::vec3 AnyDirection(std::uint64_t hash) {
  const float z = 2.0f * UnitFloat(hash) - 1.0f, angle = 6.2831853f * UnitFloat(Mix64(hash));
  const float r = std::sqrt(std::fmax(0.0f, 1.0f - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// Smooth hills with a hole of background in the middle: every direction towards the viewer occurs.
inline GuideSet HillGuides(int width, int height) {
  return MakeGuides(width, height, [=](int x, int y) {
    const float u = static_cast<float>(x) / width - 0.5f, v = static_cast<float>(y) / height - 0.5f;
    if (u * u + v * v < 0.01f) return glm::vec3(0.0f);
    const float sx = 1.5f * std::sin(9.0f * u + 2.0f * v), sy = 1.5f * std::cos(7.0f * v - u);
    return glm::normalize(glm::vec3(sx, sy, 1.0f));
  });
}

// Red encodes the column and green the row, as 16-bit values that survive copying.
inline Picture PositionPicture(int size) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = static_cast<std::uint16_t>(x), texel[1] = static_cast<std::uint16_t>(y);
      texel[2] = 12345, texel[3] = 65535;
    }
  }
  return picture;
}

// Irregular paint: every texel its own grey.
inline Picture NoisePicture(int size) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = static_cast<std::uint16_t>(Hash(x, y) & 0xffff);
      texel[3] = 65535;
    }
  }
  return picture;
}

// A style of one exemplar whose lengths are plain pixels, so that tests can state them.
inline Style PlainStyle(Picture picture) {
  Style style;
  style.name = "test";
  style.exemplars.push_back({"test.png", std::move(picture), std::nullopt});
  style.transfer.reference_height = 0;
  return style;
}

struct Transferred {
  Picture picture;
  SourceField field;
};

inline Transferred MustTransfer(const Style& style, const GuideSet& guides, TransferOptions options = {}) {
  auto prepared = Prepare(style, guides.height());
  EXPECT_TRUE(prepared.ok()) << (prepared.ok() ? "" : prepared.error().message);
  Transferred result;
  TransferScratch scratch;
  options.keep_field = true;
  const Status done = Transfer(*prepared, guides, options, scratch, result.picture);
  EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().message);
  result.field = std::move(scratch.field);
  // The other form, which keeps no field, is compared with this one in passing.
  options.keep_field = false;
  Picture without;
  EXPECT_TRUE(Transfer(*prepared, guides, options, scratch, without).ok());
  EXPECT_EQ(without.rgba, result.picture.rgba);
  return result;
}

// How much farther away than the nearest source the source of a look-up table may be: LookUpTable::Find.
inline double TableQuantisation(int resolution) { return 4.0 * std::sqrt(2.0) / resolution; }

inline bool SameField(const SourceField& a, const SourceField& b) {
  return a.x == b.x && a.y == b.y && a.level == b.level;
}

}  // namespace scumble::testing
