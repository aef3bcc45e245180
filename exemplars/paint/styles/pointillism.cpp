// Pointillism: dabs of unmixed colour side by side on a pale ground, in three layers. Each tone of the form has its own
// few colours, and between two tones the dabs of both mix optically.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "exemplars/paint/engine/flat_brush.h"
#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPriming{Tooth::kLaid, 6.0f, {0.955f, 0.925f, 0.85f}, 0.05f};

enum Pass : std::uint64_t { kFirstLayer = kFirstStream, kHighlight = 20, kAir };

// The colours of one tone: its main hues first, then neighbours, then sparks of the complement.
struct Tone {
  float value;                       // the value of the tone's middle
  std::array<std::uint32_t, 6> rgb;  // sRGB-encoded bytes
  std::array<float, 6> share;        // of the dabs
};

constexpr std::array<Tone, 5> kTones{{
    {0.08f, {0x26308f, 0x4c2b85, 0x0d5266, 0x1a4ca8, 0x851f5c, 0x9e3d29}, {0.34f, 0.26f, 0.20f, 0.12f, 0.06f, 0.03f}},
    {0.30f, {0x21807a, 0x4566c2, 0x8f4c99, 0x47945c, 0xd66142, 0xc77533}, {0.28f, 0.22f, 0.20f, 0.16f, 0.09f, 0.05f}},
    {0.52f, {0xf28c3d, 0xe87573, 0xadbd57, 0xf2b847, 0x75ada3, 0xad80b8}, {0.30f, 0.25f, 0.17f, 0.14f, 0.06f, 0.06f}},
    {0.76f, {0xfccc52, 0xfcb052, 0xfab09e, 0xf7e67a, 0xb8d694, 0xc2b2e6}, {0.36f, 0.20f, 0.18f, 0.14f, 0.07f, 0.05f}},
    {0.98f, {0xfff5c7, 0xffeb8f, 0xffdbc2, 0xfcfaed, 0xd6ebf0, 0xe0ebbd}, {0.38f, 0.24f, 0.18f, 0.12f, 0.05f, 0.03f}},
}};
// Reflected light in the shade.
constexpr Tone kReflected{
    0.34f, {0x3885bd, 0x2e8f8f, 0x8061bd, 0xb26b8f, 0x6bad70, 0xcc7a57}, {0.30f, 0.24f, 0.20f, 0.12f, 0.08f, 0.05f}};
// The light itself, mirrored.
constexpr Tone kSparkle{
    1.0f, {0xfffced, 0xfff7d1, 0xfff0e6, 0xebf5f7, 0xfff2b2, 0xf7edf7}, {0.50f, 0.25f, 0.15f, 0.06f, 0.02f, 0.02f}};
// The surroundings: quiet, of one lightness, so that no dab is noticed again in the next tile.
constexpr Tone kHaze{
    0.85f, {0xccdee6, 0xdbe0db, 0xd4d6eb, 0xcce6db, 0xe8dbd1, 0xe0d4e3}, {0.30f, 0.25f, 0.20f, 0.13f, 0.07f, 0.05f}};

// One size of dab, set over the whole picture.
struct DabLayer {
  float spacing;
  float width_min, width_max;
  float longest;  // length in widths; the shortest is round
  float scatter;  // of the tone that a dab belongs to
  float sparks;   // factor for the shares of a tone's last three colours
};
constexpr std::array<DabLayer, 3> kLayers{{
    {10.5f, 12.0f, 15.0f, 2.1f, 0.02f, 0.4f},
    {10.0f, 9.5f, 13.0f, 2.1f, 0.03f, 0.9f},
    {11.5f, 7.5f, 10.5f, 1.9f, 0.045f, 1.5f},
}};

glm::vec3 Take(Chance& chance, const Tone& tone, float sparks) {
  float total = 0.0f;
  const auto share = [&](std::size_t i) { return tone.share[i] * (i >= 3 ? sparks : 1.0f); };
  for (std::size_t i = 0; i < tone.share.size(); ++i) total += share(i);
  float left = chance.Uniform(0.0f, total);
  std::size_t taken = 0;
  while (taken + 1 < tone.share.size() && left > share(taken)) left -= share(taken++);
  const std::uint32_t rgb = tone.rgb[taken];
  return glm::vec3(rgb >> 16, rgb >> 8 & 0xff, rgb & 0xff) / 255.0f;
}

glm::vec3 ColorOf(Chance& chance, const Shading& shading, const DabLayer& layer) {
  const float value = glm::clamp(shading.value + chance.Bell(layer.scatter), 0.0f, 1.0f);
  std::size_t upper = 1;
  while (upper + 1 < kTones.size() && kTones[upper].value < value) ++upper;
  const float from = kTones[upper - 1].value;
  const float to = kTones[upper].value;
  const bool up = chance.Happens(glm::clamp((value - from) / (to - from), 0.0f, 1.0f));
  const bool back = chance.Happens(0.9f * Ramp(0.15f, 0.85f, shading.reflected));
  const Tone& tone = back ? kReflected : kTones[up ? upper : upper - 1];
  // Darkened further, colours would turn brown and grey.
  const float lift = std::max(0.9f, 1.0f + 0.6f * (value - tone.value)) + chance.Bell(0.02f);
  return Take(chance, tone, layer.sparks) * lift;
}

// A canvas for dabs, one layer over the other.
class Dabs {
 public:
  static Expected<Dabs> Begin(const Sheet& sheet, const Studio& studio) {
    SCUMBLE_ASSIGN(FlatBrush brush, FlatBrush::Cut(studio, "ramon/100%_Opaque"));
    return Dabs(sheet, studio, std::move(brush));
  }

  // One touch of the brush, `length` times as long as wide.
  void Set(Chance& chance, glm::vec2 middle, glm::vec2 direction, float width, float length, glm::vec3 color) {
    Load load;
    load.color = color;
    load.width = width;
    load.bristle = 0.2f * width;
    load.ragged = 0.25f * width;
    load.rounded = chance.Uniform(0.5f, 1.1f);
    load.streaks = 0.4f;
    load.height = chance.Uniform(0.4f, 0.6f);
    const Stroke path = ShortPath(chance, middle, direction, width * length);
    brush_.Drag(*colors_, heights_.get(), chance, path, load);
  }

  // Over the bare ground, with light across the paint's thickness.
  Picture Finish(float depth) const {
    Colors picture = PrepareGround(colors_->sheet(), kPriming, seed_).paper;
    const Layer paint = colors_->Read();
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
      picture.pixels[i] = picture.pixels[i] * (1.0f - paint.pixels[i].w) + glm::vec3(paint.pixels[i]);
    }
    LightRelief(picture, Plane(heights_->Read(), 0), {.shade = 0.5f * depth, .sheen = 0.05f * depth});
    return ToPicture(picture);
  }

 private:
  Dabs(const Sheet& sheet, const Studio& studio, FlatBrush brush)
      : seed_(studio.seed),
        brush_(std::move(brush)),
        colors_(std::make_unique<Canvas>(sheet)),
        heights_(std::make_unique<Canvas>(sheet)) {
    heights_->Fill(glm::vec3(0.3f));
  }

  std::uint64_t seed_;
  FlatBrush brush_;
  std::unique_ptr<Canvas> colors_;
  std::unique_ptr<Canvas> heights_;
};

}  // namespace

Expected<Picture> PaintPointillism(const Studio& studio) {
  SCUMBLE_ASSIGN(Dabs dabs, Dabs::Begin({studio.size}, studio));
  std::uint64_t stream = kFirstLayer;
  for (const DabLayer& layer : kLayers) {
    Chance chance(studio.seed, stream++);
    for (const glm::vec2 middle : SowEvenly(chance, layer.spacing)) {
      const Shading shading = ShadingAt(middle);
      // In the light the ground may glimmer between the dabs; in the shade it would glare.
      if (chance.Happens(0.4f * Ramp(0.35f, 0.6f, shading.value))) continue;
      const Flow flow = AroundAxis(kKeyLight + chance.Bell3(0.35f));
      const float width = chance.Uniform(layer.width_min, layer.width_max);
      const glm::vec3 color = ColorOf(chance, shading, layer);
      dabs.Set(chance, middle, flow(middle), width, chance.Uniform(1.0f, layer.longest), color);
    }
  }
  Chance chance(studio.seed, kHighlight);
  const glm::vec3 halfway = glm::normalize(kKeyLight + glm::vec3(0, 0, 1));
  for (int i = 0; i < 45; ++i) {
    const glm::vec2 middle = PlaceOf(glm::normalize(halfway + chance.Bell3(0.05f)));
    const glm::vec2 direction = AroundAxis(kKeyLight + chance.Bell3(0.3f))(middle);
    const float width = chance.Uniform(9.0f, 13.0f);
    const float length = chance.Uniform(1.0f, 1.9f);
    dabs.Set(chance, middle, direction, width, length, Take(chance, kSparkle, 1.0f));
  }
  return dabs.Finish(1.0f);
}

Expected<Picture> PointillismGround(const Studio& studio) {
  const Sheet tile = TileFor(studio.size);
  SCUMBLE_ASSIGN(Dabs dabs, Dabs::Begin(tile, studio));
  Chance chance(studio.seed, kAir);
  for (const float spacing : {12.0f, 12.5f}) {
    for (const glm::vec2 middle : SowEvenly(chance, spacing, tile.units, 0.0f)) {
      const float angle = chance.Bell(0.6f);
      const float width = chance.Uniform(9.0f, 13.0f);
      const float brightness = 1.0f + chance.Bell(0.008f);
      const glm::vec3 color = Take(chance, kHaze, 1.0f) * brightness;
      dabs.Set(chance, middle, {std::cos(angle), std::sin(angle)}, width, chance.Uniform(1.0f, 2.0f), color);
    }
  }
  return dabs.Finish(0.6f);
}

}  // namespace scumble::paint
