// Scenes with borders between objects, and what their painted borders are compared with.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/image/color.h"
#include "core/image/fragments.h"
#include "measure/flip.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble::testing {

inline constexpr int kPictureWidth = 120, kPictureHeight = 90, kAa = 4;

// Two balls that overlap before a wall; everything is covered, so every border is between objects.
inline Scene TwoBalls() {
  Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(0, 0, -2), glm::dvec3(8.0)));
  AddObject(scene, "near", BallMesh(40), Moved(-0.5, 0.1, 0.4));
  AddObject(scene, "far", BallMesh(40), Moved(0.6, -0.2, -0.5));
  return scene;
}

inline GuideSet GuidesAt(int width, int height, int aa, LayerSet layers = {}, const Scene& scene = TwoBalls()) {
  GuidegenOptions options = Sized(width, height, layers);
  options.aa = aa;
  return Render(scene, FlatCamera(6.0, 1.5), options).guides;
}

inline GuideSet WithoutFragments(GuideSet guides) {
  guides.fragments = nullptr;
  return guides;
}

// By the object's name.
inline std::uint32_t IdOfObject(const GuideSet& guides, const std::string& name) {
  for (const auto& [id, known] : guides.object_names) {
    if (known == name) return id;
  }
  return 0;
}

inline Picture PlainColor(std::array<std::uint16_t, 3> color) {
  Picture picture(64, 64);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    std::copy(color.begin(), color.end(), picture.rgba.begin() + std::ptrdiff_t(i)), picture.rgba[i + 3] = 65535;
  }
  return picture;
}

inline Picture MustPaint(const std::vector<const PreparedStyle*>& styles, const StyleMap& map, const GuideSet& guides,
                         TransferOptions options = {}) {
  TransferScratch scratch;
  Picture out;
  const Status done = Transfer(styles, map, guides, options, scratch, out);
  EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().message);
  return out;
}

inline PreparedStyle MustPrepareStyle(const Style& style, int height = kPictureHeight) {
  auto prepared = Prepare(style, height);
  EXPECT_TRUE(prepared.ok());
  return *std::move(prepared);
}

// The mean over all subsamples of color(x, y, k), in linear light.
inline Picture Supersampled(int width, int height,
                            const std::function<const std::uint16_t*(int x, int y, int k)>& color) {
  Picture result(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float sum[3] = {};
      for (int k = 0; k < kAa * kAa; ++k) {
        const std::uint16_t* texel = color(x, y, k);
        for (int c = 0; c < 3; ++c) sum[c] += Srgb16ToLinear(texel[c]) / (kAa * kAa);
      }
      for (int c = 0; c < 3; ++c) result.At(x, y)[c] = Srgb16FromLinear(sum[c]);
      result.At(x, y)[3] = 65535;
    }
  }
  return result;
}

// The pixel that is nearest to a subsample and whose centre shows the subsample's object.
inline std::pair<int, int> NearestOfObject(const GuideSet& guides, const GuideSet& fine, int x, int y, int k) {
  const float id = fine.Plane(Layer::kObject)[fine.Index(x * kAa + k % kAa, y * kAa + k / kAa)];
  const double at_x = x + (k % kAa + 0.5) / kAa, at_y = y + (k / kAa + 0.5) / kAa;
  double least = 1e9;
  std::pair<int, int> nearest(x, y);
  for (int v = std::max(0, y - 2); v <= std::min(guides.height() - 1, y + 2); ++v) {
    for (int u = std::max(0, x - 2); u <= std::min(guides.width() - 1, x + 2); ++u) {
      const double off = std::hypot(u + 0.5 - at_x, v + 0.5 - at_y);
      if (guides.Plane(Layer::kObject)[guides.Index(u, v)] == id && off < least) least = off, nearest = {u, v};
    }
  }
  return nearest;
}

// Smooth paint, with strokes of some strength.
inline Picture BrushedPicture(int size, double strength) {
  Picture picture = PositionPicture(size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      const double stroke = strength * std::sin(0.9 * x + 0.4 * y);
      const auto level = [&](double value) {
        return static_cast<std::uint16_t>(65535.0 * std::clamp(value, 0.0, 1.0));
      };
      texel[0] = level(0.2 + 0.6 * x / size + stroke), texel[1] = level(0.8 - 0.6 * y / size + stroke);
      texel[2] = level(0.5 - stroke), texel[3] = 65535;
    }
  }
  return picture;
}

inline double MeanFlipAtBorders(const Picture& a, const Picture& b, const GuideSet& guides) {
  const auto report = MeasureFlip(a, b);
  EXPECT_TRUE(report.ok());
  double sum = 0.0;
  int count = 0;
  std::vector<std::uint8_t> in_band(guides.pixel_count());
  for (const std::uint32_t pixel : guides.fragments->pixel) in_band[pixel] = 1;
  for (std::size_t i = 0; i < in_band.size(); ++i) {
    if (in_band[i]) sum += report->map[i], ++count;
  }
  return sum / std::max(1, count);
}

}  // namespace scumble::testing
