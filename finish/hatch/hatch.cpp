#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/image/exact_math.h"
#include "core/image/hash.h"
#include "finish/area/ink.h"
#include "finish/area/noise.h"
#include "finish/area/oklab_blocks.h"
#include "finish/hatch/hatch_texture.h"
#include "finish/hatch/patches.h"
#include "finish/hatch/track.h"
#include "finish/tone/surface_share.h"

namespace scumble::internal {
namespace {

// How much of a box strokes of this share of ink cover: lines `spacing` apart and share · spacing wide, across a box of
// that width, 1 at most.
float BoxCover(float across, float spacing, float share, float width) {
  const float turns = across / spacing;
  float part = turns - static_cast<float>(static_cast<int>(turns));  // without std::floor, which may be a call
  if (part < 0.0f) part = part + 1.0f;
  const float from_middle = std::fabs(part - 0.5f) * spacing, reach = 0.5f * width;
  // Both the line and the gap may be thinner than the box.
  const float half = 0.5f * share * spacing;
  const float low = std::max(from_middle - reach, -half), high = std::min(from_middle + reach, half);
  const float next_low = std::max(from_middle - reach, spacing - half),
              next_high = std::min(from_middle + reach, spacing + half);
  return std::clamp((std::max(0.0f, high - low) + std::max(0.0f, next_high - next_low)) / width, 0.0f, 1.0f);
}

// How much of a pixel they cover, seen along their axis: of a box as wide as the pixel's one side, spread over the
// other. Two boxes of equal variance stand for that. So four pixels show what one of twice the size does.
float LineCover(float across, float spacing, float share, Axis along) {
  const float x = std::fabs(along.x), y = std::fabs(along.y), width = std::max(x, y),
              off = std::min(x, y) * 0.28867513f;
  const float cover = BoxCover(across - off, spacing, share, width);
  return off > 0.01f ? 0.5f * (cover + BoxCover(across + off, spacing, share, width)) : cover;
}

// The tone that strokes leave, as a share of 1.
class ToneCurve {
 public:
  explicit ToneCurve(const HatchPass& pass)
      : power_(std::max(1.0, pass.shade)),
        share_(static_cast<float>(std::min(1.0, pass.shade))),
        bare_(static_cast<float>(pass.bare)) {}
  float At(float tone) const {
    if (power_ > 1.0 && tone > 0.0f) tone = static_cast<float>(Exp2(power_ * Log2(tone)));
    tone = bare_ > 0.0f ? std::min(1.0f, tone / bare_) : 1.0f;
    return 1.0f - share_ * (1.0f - tone);
  }

 private:
  double power_;
  float share_, bare_;
};

// The share of a pixel that a layer of strokes covers.
class Strokes {
 public:
  Strokes(const HatchPass& pass, double spacing) : spacing_(static_cast<float>(spacing)) {
    if (pass.texture) texture_.emplace(*pass.texture, spacing, pass.spacing);
  }
  // `at` in pixels, along the strokes and across them; `along`: their axis in the picture; `layer` counts from 0;
  // `share`: of ink, wanted.
  float Cover(glm::vec2 at, Axis along, int layer, float share) const {
    const float wider = WiderBy(layer);
    if (!texture_) return LineCover(at.y, spacing_ * wider, share, along);
    return texture_->Cover(at / wider + glm::vec2(13.1f * spacing_ * static_cast<float>(layer)), along, share);
  }
  // On a surface, at a place of pref. `off`: pixels, along and across. Every second stroke grows as the surface comes
  // nearer, so that none moves. Textures change to the finer one within a quarter of an octave.
  float CoverOn(const Track& track, glm::vec3 place, glm::vec2 off, int layer, float share) const {
    const Track::OfLayer& on = track.layers[std::size_t(layer)];
    const float at = glm::dot(on.across, place);
    if (!(std::fabs(at) < 1e6f * on.step)) return share;
    if (texture_) {
      const glm::vec2 fine = glm::vec2(glm::dot(on.along, place), at) * (spacing_ * WiderBy(layer) / on.step);
      const float coarser = std::clamp(4.0f * (on.coarser - 0.5f) + 0.5f, 0.0f, 1.0f);
      float cover = 0.0f;
      if (coarser < 1.0f) cover += (1.0f - coarser) * Cover(fine + off, on.axis, layer, share);
      if (coarser > 0.0f) cover += coarser * Cover(0.5f * fine + off, on.axis, layer, share);
      return cover;
    }
    const float across = at / on.pixel + off.y, spacing = 2.0f * on.step / on.pixel;
    const float between = 0.5f * share * (1.0f - on.coarser);
    return std::min(1.0f, LineCover(across + 0.5f * spacing, spacing, share - between, on.axis) +
                              LineCover(across, spacing, between, on.axis));
  }

 private:
  float spacing_;
  std::optional<TextureStrokes> texture_;
};

}  // namespace

void DrawHatch(const HatchPass& pass, double strength, std::span<const std::uint8_t> only, bool of_guides,
               const FinishFrame& frame, Picture& picture) {
  const bool of_light = pass.tone == HatchPass::Tone::kLight;
  const FloatPlane tones = ToneOf(of_light ? EdgesPass::Tone::kLight : EdgesPass::Tone::kPaint, frame, picture);
  std::optional<SurfaceScale> surface;
  if (pass.stick) surface.emplace(*frame.guides);
  const SurfaceScale* const sticks = surface ? &*surface : nullptr;
  const bool needs_light = pass.along == HatchPass::Along::kLight && !of_light;
  const FloatPlane light = needs_light ? ToneOf(EdgesPass::Tone::kLight, frame, picture) : FloatPlane();
  const Patches patches(pass, frame, needs_light ? light : tones, sticks, picture.width, picture.height);
  const float spacing = SpacingOf(pass, frame);
  const auto wobble = static_cast<float>(pass.wobble * frame.scale);
  const auto fullest = static_cast<float>(pass.fullest);
  const ToneCurve curve(pass);
  const Strokes strokes(pass, spacing);
  std::vector<NoiseField> strays;  // of each layer's strokes
  for (int k = 0; k < pass.layers && wobble > 0.0f; ++k)
    strays.emplace_back(Hash(frame.seed, 4, k), 6.0f * spacing, sticks, picture.width, picture.height);
  std::array<glm::vec2, kMostLayers> turns;  // the cosine and sine of each layer's turn
  for (int k = 0; k < kMostLayers; ++k) turns[std::size_t(k)] = AxisAt(k * pass.cross);
  std::array<glm::vec2, kMostLayers> shifts{};  // of each layer's strokes, in later draws
  for (int k = 0; k < kMostLayers && frame.seed != frame.steady_seed; ++k) {
    const std::uint64_t hash = Hash(frame.seed, 9, k);
    shifts[std::size_t(k)] = glm::vec2(UnitFloat(hash), UnitFloat(Mix64(hash))) * (kSpacingsOfTexture * spacing);
  }
  const auto width = static_cast<std::size_t>(picture.width);
  tbb::parallel_for(tbb::blocked_range<int>(0, picture.height, 8), [&](const auto& rows) {
    std::vector<float> of_surface(of_light ? width : 0);  // light is the surface's, paint the whole pixel's
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const std::size_t row = std::size_t(y) * width;
      if (of_light) {
        const auto coverage = frame.guides->Plane(Layer::kCoverage);
        SurfaceShares(coverage.data() + row, picture.rgba.data() + 4 * row, of_guides, width, of_surface.data());
      }
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = std::size_t(y) * width + x;
        std::uint16_t* const pixel = picture.rgba.data() + 4 * p;
        if (pixel[3] == 0 || (!only.empty() && !only[p])) continue;
        float left = curve.At(tones[p]);  // of the tone, after the layers so far
        if (left >= 1.0f) continue;
        const auto [axis, track] = patches.At(p);
        const glm::vec2 at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        float bare = 1.0f;
        for (int k = 0; k < pass.layers && left < 1.0f; ++k) {
          const float most = k + 1 < pass.layers ? fullest : 1.0f;
          const float share = std::min(1.0f - left, most);
          const glm::vec2 turn = turns[std::size_t(k)];
          const float stray = wobble > 0.0f ? wobble * strays[std::size_t(k)].At(static_cast<int>(x), y) : 0.0f;
          const glm::vec2 off = glm::vec2(0.0f, stray) + shifts[std::size_t(k)];
          if (track) {
            bare *= 1.0f - strokes.CoverOn(*track, frame.guides->Vec3(Layer::kPref, p), off, k, share);
          } else {
            const Axis along = Turned(axis, turn);
            const glm::vec2 place(at.x * along.x + at.y * along.y, at.y * along.x - at.x * along.y);
            bare *= 1.0f - strokes.Cover(place + off, along, k, share);
          }
          left = share < 1.0f ? left / (1.0f - share) : 1.0f;
        }
        std::uint16_t ink[4] = {pass.ink[0], pass.ink[1], pass.ink[2], 0};
        const float share = static_cast<float>(strength) * (of_light ? of_surface[x] : 1.0f);
        ink[3] = static_cast<std::uint16_t>((1.0f - bare) * share * 65535.0f + 0.5f);
        if (ink[3] == 0) continue;
        const std::uint16_t kept = pixel[3];
        LayInk(ink, pixel);
        pixel[3] = kept;  // strokes stay inside
      }
    }
  });
}

}  // namespace scumble::internal
