#include "measure/texture/paint_pyramid.h"

#include <tbb/parallel_for.h>

#include <cstddef>
#include <utility>

#include "core/filter/gaussian_blur.h"

namespace scumble::internal {
namespace {

using Plane = std::vector<float>;

// One octave's picture.
struct Level {
  int width = 0, height = 0;
  std::array<Plane, 3> detail;  // Oklab beside the tone
  std::array<Plane, 2> normal;
  std::vector<Surface> surface;

  std::size_t Index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
};

// A block has a surface if its four pixels have the same.
Level Halved(const Level& level) {
  Level half;
  half.width = level.width / 2, half.height = level.height / 2;
  const std::size_t pixels = std::size_t(half.width) * std::size_t(half.height);
  half.surface.resize(pixels);
  for (Plane& plane : half.detail) plane.resize(pixels);
  for (Plane& plane : half.normal) plane.resize(pixels);
  tbb::parallel_for(0, half.height, [&](int y) {
    for (int x = 0; x < half.width; ++x) {
      const std::size_t to = half.Index(x, y), upper = level.Index(2 * x, 2 * y), lower = level.Index(2 * x, 2 * y + 1);
      const auto mean = [&](const Plane& plane) {
        return 0.25f * (plane[upper] + plane[upper + 1] + plane[lower] + plane[lower + 1]);
      };
      for (std::size_t c = 0; c < 3; ++c) half.detail[c][to] = mean(level.detail[c]);
      for (std::size_t c = 0; c < 2; ++c) half.normal[c][to] = mean(level.normal[c]);
      const Surface first = level.surface[upper];
      const bool same =
          level.surface[upper + 1] == first && level.surface[lower] == first && level.surface[lower + 1] == first;
      half.surface[to] = same ? first : kNoSurface;
    }
  });
  return half;
}

// The exemplars of pixels whose neighbours up to `reach` away have the same surface.
std::vector<std::uint8_t> ExemplarsWithin(const Level& level, int reach) {
  std::vector<std::uint8_t> along(level.surface.size()), exemplar(level.surface.size(), kNoExemplar);
  tbb::parallel_for(0, level.height, [&](int y) {
    int same = 0;  // pixels up to this one that have its surface
    for (int x = 0; x < level.width; ++x) {
      const Surface here = level.surface[level.Index(x, y)];
      same = here == kNoSurface ? 0 : x > 0 && level.surface[level.Index(x - 1, y)] == here ? same + 1 : 1;
      if (same > 2 * reach) along[level.Index(x - reach, y)] = 1;
    }
  });
  tbb::parallel_for(reach, std::max(reach, level.height - reach), [&](int y) {
    for (int x = 0; x < level.width; ++x) {
      const std::size_t i = level.Index(x, y);
      bool same = true;
      for (int v = y - reach; v <= y + reach && same; ++v) {
        const std::size_t q = level.Index(x, v);
        same = along[q] && level.surface[q] == level.surface[i];
      }
      if (same) exemplar[i] = ExemplarOf(level.surface[i]);
    }
  });
  return exemplar;
}

FeatureGroup StrokesOf(const Level& level) {
  constexpr int kReach = 3;  // two deviations of the Gaussian, and the neighbour
  FeatureGroup group;
  group.width = level.width, group.strokes = true;
  for (std::size_t c = 0; c < 3; ++c) {
    group.colors[c] = GaussianBlur(level.detail[c], level.width, level.height, 1.0);
  }
  group.exemplar = ExemplarsWithin(level, kReach);
  group.normal = level.normal;
  return group;
}

}  // namespace

PaintFeatures FeaturesOf(const Picture& picture, const NormalPlanes& normal, std::vector<Surface> surface,
                         std::span<const NormalTone* const> tones) {
  Level level;
  level.width = picture.width, level.height = picture.height;
  level.surface = std::move(surface);
  PaintFeatures features;
  FeatureGroup& raw = features[0];
  raw.width = level.width;
  for (Plane& plane : raw.colors) plane.resize(level.surface.size());
  for (Plane& plane : level.detail) plane.resize(level.surface.size());
  for (std::size_t c = 0; c < 2; ++c) level.normal[c].assign(normal[c].begin(), normal[c].end());
  tbb::parallel_for(0, level.height, [&](int y) {
    for (int x = 0; x < level.width; ++x) {
      const std::size_t i = level.Index(x, y);
      if (level.surface[i] == kNoSurface) continue;
      const NormalTone& tone = *tones[ExemplarOf(level.surface[i])];
      const glm::vec3 color = OklabOf(picture.rgba.data() + 4 * i), off = color - tone.At(normal[0][i], normal[1][i]);
      for (int c = 0; c < 3; ++c) {
        raw.colors[std::size_t(c)][i] = color[c], level.detail[std::size_t(c)][i] = off[c];
      }
    }
  });
  raw.exemplar = ExemplarsWithin(level, 1);
  raw.normal = level.normal;
  for (std::size_t octave = 0; octave < kOctaves; ++octave) {
    if (octave > 0) level = Halved(level);
    features[1 + octave] = StrokesOf(level);
  }
  return features;
}

}  // namespace scumble::internal
