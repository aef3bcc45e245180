// Common expectations of the ray caster's tests.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include "guidegen/guidegen.h"

namespace scumble::testing {

// The guides, which must exist and be valid for a transfer.
inline GuidegenResult TakeValid(Expected<GuidegenResult> result) {
  if (!result) throw std::runtime_error(result.error().message);
  const Status valid = result->guides.Validate("guides");
  EXPECT_TRUE(valid) << (valid ? "" : valid.error().message);
  return std::move(result).value();
}

inline GuidegenResult Render(const Scene& scene, const Camera& camera, const GuidegenOptions& options) {
  return TakeValid(RenderGuides(scene, camera, options));
}

// Whether two renders hold the same layers, bit by bit.
inline bool SameBytes(const GuideSet& a, const GuideSet& b) {
  if (!(a.layers() == b.layers())) return false;
  for (const LayerInfo& info : AllLayers()) {
    if (!a.Has(info.layer)) continue;
    for (int i = 0; i < ChannelCount(info.layer); ++i) {
      const auto p = a.Plane(info.layer, i);
      const auto q = b.Plane(info.layer, i);
      if (p.size() != q.size() || std::memcmp(p.data(), q.data(), p.size_bytes()) != 0) return false;
    }
  }
  return true;
}

inline void ExpectBackground(const GuideSet& guides, std::size_t i) {
  EXPECT_EQ(guides.Plane(Layer::kCoverage)[i], 0.0f);
  EXPECT_EQ(guides.Plane(Layer::kDepth)[i], std::numeric_limits<float>::infinity());
  EXPECT_EQ(guides.Plane(Layer::kObject)[i], 0.0f);
  EXPECT_EQ(guides.Plane(Layer::kMaterial)[i], 0.0f);
  EXPECT_EQ(guides.Vec3(Layer::kNormal, i), glm::vec3(0.0f));
}

inline void ExpectEmpty(const GuideSet& guides) {
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) ExpectBackground(guides, i);
}

}  // namespace scumble::testing
