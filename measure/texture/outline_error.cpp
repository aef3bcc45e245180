#include "measure/outline_error.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/image/fragments.h"
#include "measure/compare/on_white.h"

namespace scumble {
namespace {

constexpr int kInsideBy = 3;      // pixels with one surface within this many have their surface's colour
constexpr int kLookFor = 5;       // how far such pixels are looked for
constexpr int kFewestInside = 4;  // of them on either side

// An object with a material.
using SurfaceKey = std::uint64_t;

struct OutlineScene {
  int width = 0, height = 0;
  std::vector<SurfaceKey> surface;    // by pixel, 0: the background
  std::vector<std::uint8_t> inside;   // by pixel, not 0: far from other surfaces
  std::vector<SurfaceKey> other;      // of pixels that show two
  std::vector<float> share_of_other;  // above 1: more than two surfaces
};

SurfaceKey SurfaceKeyOf(const GuideSet& guides, std::size_t i) {
  if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) return 0;
  SurfaceKey surface = 1;
  if (guides.Has(Layer::kObject)) surface += SurfaceKey(IdOf(guides.Plane(Layer::kObject)[i])) << 32;
  if (guides.Has(Layer::kMaterial)) surface += SurfaceKey(IdOf(guides.Plane(Layer::kMaterial)[i])) << 1;
  return surface;
}

// What else each pixel shows: fragments, or the background.
void AddShares(const GuideSet& guides, OutlineScene& scene) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (std::size_t i = 0; i < scene.surface.size(); ++i) {
    if (scene.surface[i] != 0 && coverage[i] < 1.0f) scene.share_of_other[i] = 1.0f - coverage[i];
  }
  if (!guides.fragments) return;
  const Fragments& fragments = *guides.fragments;
  for (std::size_t f = 0; f < fragments.count(); ++f) {
    const std::size_t i = fragments.pixel[f];
    const bool is_second = scene.share_of_other[i] == 0.0f;
    scene.other[i] = SurfaceKeyOf(fragments.values, f);
    scene.share_of_other[i] = is_second ? fragments.values.Plane(Layer::kCoverage)[f] : 2.0f;
  }
}

// Whether all pixels within kInsideBy have one surface, and nothing else shows in them.
std::vector<std::uint8_t> InsideOf(const OutlineScene& scene) {
  const auto width = std::size_t(scene.width);
  const auto alike = [&](std::size_t a, std::size_t b) {
    return scene.surface[a] == scene.surface[b] && scene.share_of_other[b] == 0.0f;
  };
  std::vector<std::uint8_t> along(scene.surface.size()), inside(scene.surface.size());
  tbb::parallel_for(0, scene.height, [&](int y) {
    for (int x = kInsideBy; x < scene.width - kInsideBy; ++x) {
      const std::size_t i = std::size_t(y) * width + std::size_t(x);
      bool same = true;
      for (int u = -kInsideBy; u <= kInsideBy && same; ++u) same = alike(i, i + std::size_t(std::ptrdiff_t(u)));
      along[i] = same;
    }
  });
  tbb::parallel_for(kInsideBy, std::max(kInsideBy, scene.height - kInsideBy), [&](int y) {
    for (int x = 0; x < scene.width; ++x) {
      const std::size_t i = std::size_t(y) * width + std::size_t(x);
      bool same = true;
      for (int v = -kInsideBy; v <= kInsideBy && same; ++v) {
        const std::size_t there = i + std::size_t(std::ptrdiff_t(v) * std::ptrdiff_t(width));
        same = along[there] && scene.surface[there] == scene.surface[i];
      }
      inside[i] = same;
    }
  });
  return inside;
}

OutlineScene OutlineSceneOf(const GuideSet& guides) {
  OutlineScene scene;
  scene.width = guides.width(), scene.height = guides.height();
  const std::size_t pixels = guides.pixel_count();
  scene.surface.resize(pixels), scene.other.resize(pixels), scene.share_of_other.resize(pixels);
  tbb::parallel_for(0, scene.height, [&](int y) {
    for (int x = 0; x < scene.width; ++x) scene.surface[guides.Index(x, y)] = SurfaceKeyOf(guides, guides.Index(x, y));
  });
  AddShares(guides, scene);
  scene.inside = InsideOf(scene);
  return scene;
}

glm::dvec3 ColorAt(const Picture& picture, int x, int y) {
  const auto [r, g, b] = OnWhite(picture, x, y);
  return {r, g, b};
}

// The colours of a surface near a pixel.
struct OutlineSide {
  SurfaceKey surface = 0;
  double count = 0.0;
  glm::dvec3 sum{0.0};
  glm::dmat3 squares{0.0};

  void Add(const glm::dvec3& color) { count += 1.0, sum += color, squares += glm::outerProduct(color, color); }
  glm::dvec3 Mean() const { return sum / count; }
  // Of the colours along a direction.
  double VarianceAlong(const glm::dvec3& unit) const {
    const double mean = glm::dot(Mean(), unit);
    return std::max(0.0, glm::dot(unit, squares * unit) / count - mean * mean);
  }
};

struct OutlineSum {
  double squares = 0.0, contrast = 0.0;
  std::size_t pixels = 0;
};

// The pixel's own surface, and the one beside it: what else it shows, or the one of most of the pixels around.
void AddPixel(const Picture& picture, const OutlineScene& scene, int x, int y, OutlineSum& sum) {
  const std::size_t i = std::size_t(y) * std::size_t(scene.width) + std::size_t(x);
  const float share = scene.share_of_other[i];
  if (scene.inside[i] || share > 1.0f) return;
  OutlineSide own, beside[4];
  own.surface = scene.surface[i];
  int sides = 0;
  for (int v = std::max(0, y - kLookFor); v <= std::min(scene.height - 1, y + kLookFor); ++v) {
    for (int u = std::max(0, x - kLookFor); u <= std::min(scene.width - 1, x + kLookFor); ++u) {
      const std::size_t j = std::size_t(v) * std::size_t(scene.width) + std::size_t(u);
      if (!scene.inside[j]) continue;
      const SurfaceKey there = scene.surface[j];
      OutlineSide* side = &own;
      if (there != own.surface) {
        if (share > 0.0f && there != scene.other[i]) continue;
        int k = 0;
        while (k < sides && beside[k].surface != there) ++k;
        if (k == 4) continue;
        if (k == sides) beside[sides++].surface = there;
        side = &beside[k];
      }
      side->Add(ColorAt(picture, u, v));
    }
  }
  const OutlineSide& other = *std::max_element(
      beside, beside + 4, [](const OutlineSide& a, const OutlineSide& b) { return a.count < b.count; });
  if (own.count < kFewestInside || other.count < kFewestInside) return;
  const glm::dvec3 mean = own.Mean(), step = other.Mean() - mean;
  const double contrast = glm::dot(step, step);
  if (!(contrast > 1e-6)) return;
  const glm::dvec3 unit = step / std::sqrt(contrast);
  const double off = glm::dot(ColorAt(picture, x, y) - (mean + double(share) * step), unit);
  const double own_share = 1.0 - double(share);
  const double chance =
      own_share * own_share * own.VarianceAlong(unit) + double(share * share) * other.VarianceAlong(unit);
  sum.squares += off * off - chance, sum.contrast += contrast, ++sum.pixels;
}

}  // namespace

Expected<OutlineReport> MeasureOutlines(const Picture& picture, const GuideSet& guides, int threads) {
  if (picture.width != guides.width() || picture.height != guides.height()) {
    return InputError("outlines: the picture has " + std::to_string(picture.width) + "x" +
                      std::to_string(picture.height) + " pixels, and its guides have " +
                      std::to_string(guides.width()) + "x" + std::to_string(guides.height()));
  }
  std::vector<OutlineSum> rows(std::size_t(picture.height));
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    const OutlineScene scene = OutlineSceneOf(guides);
    tbb::parallel_for(0, scene.height, [&](int y) {
      for (int x = 0; x < scene.width; ++x) AddPixel(picture, scene, x, y, rows[std::size_t(y)]);
    });
  });
  OutlineSum all;
  for (const OutlineSum& row : rows) {
    all.squares += row.squares, all.contrast += row.contrast, all.pixels += row.pixels;
  }
  OutlineReport report;
  report.pixels = all.pixels;
  if (all.contrast > 0.0) report.error = std::sqrt(std::max(0.0, all.squares / all.contrast));
  return report;
}

}  // namespace scumble
