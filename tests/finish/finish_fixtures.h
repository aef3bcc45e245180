// Guides by formula, and pictures of one colour, for the tests of finishing effects.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>

#include "core/filter/more_workers.h"
#include "core/image/guides.h"
#include "finish/finish.h"

namespace scumble {

// The sigmoid of tones and edges.
inline double PlainSigmoid(double x) {
  const double within = std::clamp(x, -3.0, 3.0), square = within * within;
  return within * (27.0 + square) / (27.0 + 9.0 * square);
}

// What one sample of a scene sees.
struct SeenPoint {
  bool hit = false;
  glm::vec3 normal{0, 0, 1};
  float depth = 5.0f;
  float object = 1.0f;
};

// Guides with A, normal, depth and object; coverage from 8 × 8 samples a pixel, the others at the centre, or at the
// covered sample nearest to it. `seen` is given a place in the picture, pixel (0, 0) covers [0, 1) × [0, 1).
inline GuideSet GuidesOf(int width, int height, const std::function<SeenPoint(glm::vec2 at)>& seen) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  constexpr int kSamples = 8;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      SeenPoint data = seen(glm::vec2(x + 0.5f, y + 0.5f));
      int hits = 0;
      float nearest = 2.0f;
      const bool centre = data.hit;
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const glm::vec2 off((s % kSamples + 0.5f) / kSamples, (s / kSamples + 0.5f) / kSamples);
        const SeenPoint one = seen(glm::vec2(x, y) + off);
        if (!one.hit) continue;
        ++hits;
        const float distance = glm::length(off - glm::vec2(0.5f));
        if (!centre && distance < nearest) data = one, nearest = distance;
      }
      if (hits == 0) continue;
      const std::size_t i = guides.Index(x, y);
      guides.Plane(Layer::kCoverage)[i] = static_cast<float>(hits) / (kSamples * kSamples);
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = data.normal[c];
      guides.Plane(Layer::kDepth)[i] = data.depth;
      guides.Plane(Layer::kObject)[i] = data.object;
    }
  }
  return guides;
}

// A sphere on the picture, of orthographic shape.
inline SeenPoint SeenOnBall(glm::vec2 at, glm::vec2 centre, float radius, float depth, float object) {
  const glm::vec2 off = (at - centre) / radius;
  const float z2 = 1.0f - off.x * off.x - off.y * off.y;
  if (!(z2 > 0.0f)) return {};
  const float z = std::sqrt(z2);
  return {true, glm::vec3(off.x, -off.y, z), depth - 0.1f * z, object};
}

inline GuideSet BallGuides(int size, float radius) {
  const glm::vec2 centre(size / 2.0f, size / 2.0f);
  return GuidesOf(size, size, [=](glm::vec2 at) { return SeenOnBall(at, centre, radius, 5.0f, 1.0f); });
}

// Covered from edge to edge, facing the viewer, 5 m away, with the light layers at full light.
inline GuideSet FlatGuides(int width, int height) {
  GuideSet guides = GuidesOf(width, height, [](glm::vec2) { return SeenPoint{true, {0, 0, 1}, 5.0f, 1.0f}; });
  for (const Layer layer : {Layer::kLuminance, Layer::kShadow}) guides.Add(layer);
  for (float& value : guides.Plane(Layer::kLuminance)) value = 1.0f;
  return guides;
}

inline Picture PlainPicture(int width, int height, std::uint16_t r, std::uint16_t g, std::uint16_t b,
                            std::uint16_t alpha = 65535) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    picture.rgba[i] = r, picture.rgba[i + 1] = g, picture.rgba[i + 2] = b, picture.rgba[i + 3] = alpha;
  }
  return picture;
}

// Many colours, the same each time.
inline Picture ColorfulPicture(int width, int height) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint16_t* const texel = picture.At(x, y);
      texel[0] = static_cast<std::uint16_t>(65535u * unsigned(x) / unsigned(width));
      texel[1] = static_cast<std::uint16_t>(65535u * unsigned(y) / unsigned(height));
      texel[2] = static_cast<std::uint16_t>((x * 977 + y * 3571) % 65536);
      texel[3] = 65535;
    }
  }
  return picture;
}

// Guides with every layer that some effect reads.
inline GuideSet AllGuides(int size) {
  GuideSet guides = BallGuides(size, 0.4f * static_cast<float>(size));
  for (const Layer layer :
       {Layer::kMaterial, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow, Layer::kLpeFull, Layer::kPref})
    guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kLuminance)[i] = std::max(0.0f, guides.Plane(Layer::kNormal)[i]);
    guides.Plane(Layer::kShadow)[i] = static_cast<float>(i % 7) / 6.0f;
  }
  return guides;
}

// Three balls, one before the other, lit from the left, with every layer that some effect reads.
inline GuideSet LitBalls() {
  GuideSet guides = GuidesOf(97, 83, [](glm::vec2 at) {
    const SeenPoint near = SeenOnBall(at, {38.3f, 47.1f}, 26.0f, 5.0f, 1.0f);
    if (near.hit) return near;
    const SeenPoint far = SeenOnBall(at, {63.7f, 40.2f}, 30.0f, 8.0f, 2.0f);
    return far.hit ? far : SeenOnBall(at, {20.0f, 14.0f}, 9.0f, 6.0f, 3.0f);
  });
  for (const Layer layer : {Layer::kMaterial, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow, Layer::kLpeFull,
                            Layer::kPref, Layer::kCosine, Layer::kUv})
    guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
    const float x = guides.Plane(Layer::kNormal, 0)[i], y = guides.Plane(Layer::kNormal, 1)[i],
                z = guides.Plane(Layer::kNormal, 2)[i];
    const float light = 0.5f * z + 0.4f * y - 0.6f * x;
    guides.Plane(Layer::kCosine)[i] = light;
    guides.Plane(Layer::kLuminance)[i] = std::max(0.0f, light);
    guides.Plane(Layer::kShadow)[i] = y < -0.3f ? 1.0f : 0.0f;
    guides.Plane(Layer::kMaterial)[i] = x > 0.2f ? 1.0f : 2.0f;
    for (int c = 0; c < 3; ++c) {
      guides.Plane(Layer::kAlbedo, c)[i] = 0.2f + 0.2f * static_cast<float>(c) + (x > 0.2f ? 0.2f : 0.0f);
      guides.Plane(Layer::kLpeFull, c)[i] = 0.1f * static_cast<float>(c) + std::max(0.0f, light);
    }
  }
  return guides;
}

// Many colours, with the alpha of the coverage.
inline Picture CoveredPicture(const GuideSet& guides) {
  Picture picture = ColorfulPicture(guides.width(), guides.height());
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const float coverage = guides.Plane(Layer::kCoverage)[i];
    picture.rgba[4 * i + 3] = static_cast<std::uint16_t>(coverage * 65535.0f);
    if (coverage == 0.0f) std::fill_n(picture.rgba.begin() + std::ptrdiff_t(4 * i), 3, std::uint16_t{0});
  }
  return picture;
}

inline FinishStep StepOf(FinishPass::Effect effect, double strength = 1.0) {
  return {{"it", std::move(effect), FinishPass::Stage::kPaint, strength, {}, {}}, {}};
}

// The picture after these steps; a failure is a failed test of the caller, which compares pictures.
inline Picture Finished(std::span<const FinishStep> steps, const GuideSet* guides, Picture picture,
                        FinishMeasures measures = {}, int threads = 0, double scale = 1.0) {
  const MoreWorkers workers(threads);  // beyond the machine's cores, too
  const FinishFrame frame{guides, measures, scale, 7};
  const Status done = ApplyFinish(steps, FinishPass::Stage::kPaint, frame, threads, {}, picture);
  return done ? picture : Picture();
}
inline Picture Finished(const FinishStep& step, const GuideSet* guides, Picture picture, FinishMeasures measures = {},
                        int threads = 0, double scale = 1.0) {
  return Finished(std::span(&step, 1), guides, std::move(picture), measures, threads, scale);
}

}  // namespace scumble
