#include "core/io/guides/guide_storage.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/image/fragments.h"
#include "core/io/exr/half_float.h"
#include "core/io/guide_file.h"

namespace scumble {
namespace internal {
namespace {

constexpr const char* kCompressions[] = {"none", "rle", "zips", "zip", "piz"};

// Whether normals look squeezed into [0, 1] for an 8-bit picture: no component is negative anywhere, and lengths are
// rarely 1. A few pixels prove nothing.
bool LookPacked(const GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::size_t covered = 0, not_unit = 0;
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    if (!(coverage[i] > 0.0f)) continue;
    const glm::vec3 n = guides.Vec3(Layer::kNormal, i);
    if (n.x < 0.0f || n.y < 0.0f || n.z < 0.0f) return false;
    ++covered;
    not_unit += std::fabs(n.x * n.x + n.y * n.y + n.z * n.z - 1.0f) > 0.02f;
  }
  constexpr std::size_t kEnoughPixels = 16;
  return covered >= kEnoughPixels && 2 * not_unit > covered;
}

// Brings coverage into 0 to 1 where it is outside by an eighth or less, as by the rounding of a sum or the negative
// lobes of a pixel filter. Validate refuses what is farther outside.
void ClampCoverage(GuideSet& guides) {
  constexpr float kOvershoot = 0.125f;
  if (!guides.Has(Layer::kCoverage)) return;
  for (float& a : guides.Plane(Layer::kCoverage)) {
    if (a >= -kOvershoot && a <= 1.0f + kOvershoot) a = std::clamp(a, 0.0f, 1.0f);
  }
}

// Gives the pixels that nothing covers the values of background in the layers of surfaces, whatever a renderer left
// there: zeros, -1, NaN. Light and colours stay, which may be a sky's. Nothing without coverage.
void ClearBackground(GuideSet& guides) {
  if (!guides.Has(Layer::kCoverage)) return;
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (const Layer layer :
       {Layer::kNormal, Layer::kPosition, Layer::kDepth, Layer::kObject, Layer::kMaterial, Layer::kUv}) {
    for (int c = 0; guides.Has(layer) && c < ChannelCount(layer); ++c) {
      const auto plane = guides.Plane(layer, c);
      const float background = BackgroundValue(layer);
      for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = coverage[i] > 0.0f ? plane[i] : background;
    }
  }
}

// Depths of covered pixels that are infinite, because half floats cannot hold them, become 10^30 m: all equally far.
void LimitDepths(GuideSet& guides) {
  if (!guides.Has(Layer::kDepth) || !guides.Has(Layer::kCoverage)) return;
  const auto coverage = guides.Plane(Layer::kCoverage), depth = guides.Plane(Layer::kDepth);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (coverage[i] > 0.0f && depth[i] == std::numeric_limits<float>::infinity()) depth[i] = 1e30f;
  }
}

}  // namespace

bool IsLossless(const std::string& compression) {
  return std::find(std::begin(kCompressions), std::end(kCompressions), compression) != std::end(kCompressions);
}

void NormalizeNormals(GuideSet& guides) {
  // A unit vector in floats has a square within 2√3 · 2^-25 of 1, and 3 · 2^-24 for the sum: 2.8e-7.
  constexpr float kOfFloats = 0x1p-20f;
  constexpr float kShortest = 0.1f, kShortestPartly = 1e-5f, kLongest = 10.0f;
  const auto coverage = guides.Has(Layer::kCoverage) ? guides.Plane(Layer::kCoverage) : std::span<float>();
  const auto x = guides.Plane(Layer::kNormal, 0), y = guides.Plane(Layer::kNormal, 1),
             z = guides.Plane(Layer::kNormal, 2);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float squared = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    if (std::fabs(squared - 1.0f) <= kOfFloats) continue;
    const float shortest = !coverage.empty() && coverage[i] < 1.0f ? kShortestPartly : kShortest;
    if (!(squared > shortest * shortest && squared < kLongest * kLongest)) continue;
    const float length = std::sqrt(squared);
    x[i] /= length, y[i] /= length, z[i] /= length;
  }
}

Status MakeValid(const std::string& name, GuideSet& guides) {
  ClampCoverage(guides);
  ClearBackground(guides);
  if (guides.Has(Layer::kNormal)) {
    if (guides.Has(Layer::kCoverage) && LookPacked(guides)) {
      return InputError(name + ": its normals look packed into 0 to 1; write them as they are, in -1 to 1");
    }
    NormalizeNormals(guides);
  }
  LimitDepths(guides);
  return guides.Validate(name);
}

}  // namespace internal

Status CheckGuideTarget(const std::filesystem::path& path, const GuideWriteOptions& options) {
  if (path.extension() != ".exr" && path.extension() != ".EXR") {
    return UsageError("cannot write guides to " + path.string() + ": guides are EXR files, name it .exr");
  }
  if (!internal::IsLossless(options.compression)) {
    return UsageError("compression '" + options.compression +
                      "' is not one of none, rle, zips, zip, piz: guides are data and lossy compression is refused");
  }
  return Ok();
}

void RoundColorLayersToHalf(GuideSet& guides) {
  if (guides.fragments) {
    auto rounded = std::make_shared<Fragments>(*guides.fragments);
    RoundColorLayersToHalf(rounded->values);
    guides.fragments = std::move(rounded);
  }
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer) || !info.is_color) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (float& value : guides.Plane(info.layer, c)) value = static_cast<float>(internal::ToHalf(value));
    }
  }
}

}  // namespace scumble
