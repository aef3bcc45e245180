#include "finish/outline/valleys.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "finish/tone/view_rays.h"

namespace scumble::internal {
namespace {

// A cosine above 1 - 1e-6 has no direction to speak of.
constexpr float kFacing = 1e-3f;

// The cosine at places between pixels' centres.
class CosineField {
 public:
  CosineField(const GuideSet& guides, const FloatPlane& cosine)
      : width_(guides.width()),
        height_(guides.height()),
        cosine_(cosine),
        coverage_(guides.Plane(Layer::kCoverage)),
        object_(guides.Plane(Layer::kObject)) {}

  // Between the four pixels around, if all are of that object.
  std::optional<float> At(glm::vec2 at, float object) const {
    const float left = std::floor(at.x - 0.5f), above = std::floor(at.y - 0.5f);
    const int x = static_cast<int>(left), y = static_cast<int>(above);
    if (x < 0 || y < 0 || x + 1 >= width_ || y + 1 >= height_) return std::nullopt;
    const std::size_t i = std::size_t(y) * std::size_t(width_) + std::size_t(x), row = std::size_t(width_);
    for (const std::size_t k : {i, i + 1, i + row, i + row + 1}) {
      if (object_[k] != object || !(coverage_[k] > 0.0f)) return std::nullopt;
    }
    const float u = at.x - 0.5f - left, v = at.y - 0.5f - above;
    const float top = cosine_[i] + (cosine_[i + 1] - cosine_[i]) * u;
    const float bottom = cosine_[i + row] + (cosine_[i + row + 1] - cosine_[i + row]) * u;
    return top + (bottom - top) * v;
  }

 private:
  int width_, height_;
  const FloatPlane& cosine_;
  std::span<const float> coverage_, object_;
};

}  // namespace

Valleys::Valleys(const OutlinePass& pass, const GuideSet& guides, double scale) {
  const std::size_t pixels = guides.pixel_count();
  const int width = guides.width();
  FloatPlane cosine(pixels);
  slope_.resize(pixels), along_x_.resize(pixels), along_y_.resize(pixels), is_deep_.assign(pixels, 0);
  const ViewRays rays(guides);
  const auto rows = tbb::blocked_range<int>(0, guides.height(), 16);
  tbb::parallel_for(rows, [&](const auto& part) {
    for (int y = part.begin(); y != part.end(); ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t i = guides.Index(x, y);
        const glm::vec3 normal = guides.Vec3(Layer::kNormal, i), viewer = rays.ToViewer(x, y);
        cosine[i] = normal.x * viewer.x + normal.y * viewer.y + normal.z * viewer.z;
        const glm::vec2 across = glm::vec2(normal) - glm::vec2(viewer) * cosine[i];
        const float length = std::sqrt(across.x * across.x + across.y * across.y);
        const float per_length = length > kFacing ? 1.0f / length : 0.0f;
        along_x_[i] = across.x * per_length, along_y_[i] = -across.y * per_length;  // rows run downwards
      }
    }
  });
  const CosineField field(guides, cosine);
  const auto object = guides.Plane(Layer::kObject), coverage = guides.Plane(Layer::kCoverage);
  const auto reach = static_cast<float>(std::max(1.0, pass.suggestive_reach * scale));
  const auto least = static_cast<float>(pass.suggestive_depth);
  tbb::parallel_for(rows, [&](const auto& part) {
    for (int y = part.begin(); y != part.end(); ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t i = guides.Index(x, y);
        const glm::vec2 at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const glm::vec2 along = glm::vec2(along_x_[i], along_y_[i]) * reach;
        std::optional<float> after, before, beyond, behind;
        const bool has_direction = coverage[i] > 0.0f && (along.x != 0.0f || along.y != 0.0f);
        if (has_direction) after = field.At(at + along * 0.5f, object[i]);
        if (after) before = field.At(at - along * 0.5f, object[i]);
        if (before) beyond = field.At(at + along, object[i]);
        if (beyond) behind = field.At(at - along, object[i]);
        if (!behind) {
          slope_[i] = along_x_[i] = along_y_[i] = 0.0f;
          continue;
        }
        slope_[i] = *after - *before;
        is_deep_[i] = std::min(*beyond, *behind) - cosine[i] >= least;
      }
    }
  });
}

}  // namespace scumble::internal
