#include "exemplars/paint/hatching.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "exemplars/paint/engine/brush.h"
#include "exemplars/paint/engine/canvas.h"
#include "exemplars/paint/engine/chance.h"

namespace scumble::paint {
namespace {

constexpr int kTilePixels = 512;
constexpr std::uint64_t kHatchStream = 0x68617463;
constexpr float kEnough = 0.985f;  // share of ink at which the tile is full
constexpr int kMostStrokes = 4000;

struct Tool {
  const char* preset;
  float radius;    // units of a pixel
  float pressure;  // heaviest
  float waver;     // how far a stroke leaves its row
  float tilt;      // its end against its beginning
  float shortest, longest;
};

Tool ToolOf(const std::string& name) {
  if (name == "pen") return {"classic/pen", 2.2f, 0.75f, 1.2f, 5.0f, 150.0f, 380.0f};
  if (name == "charcoal") return {"tanda/charcoal-04", 7.0f, 0.8f, 2.5f, 12.0f, 160.0f, 330.0f};
  return {"deevad/2B_pencil", 3.2f, 0.9f, 2.0f, 9.0f, 150.0f, 320.0f};
}

// The row of the tile with the least ink beside it, of a few that chance offers.
float EmptiestRow(const std::vector<float>& ink, float x, float length, Chance& chance) {
  float best = 0.0f, least = 1e30f;
  for (int i = 0; i < 12; ++i) {
    const float row = chance.Uniform(0.0f, kTilePixels);
    float sum = 0.0f;
    for (int dy = -9; dy <= 9; ++dy) {
      const int y = (static_cast<int>(row) + dy + kTilePixels) % kTilePixels;
      const float weight = 10.0f - std::fabs(static_cast<float>(dy));
      for (float at = 0.0f; at < length; at += 8.0f) {
        const int column = static_cast<int>(x + at) % kTilePixels;
        sum += weight * ink[std::size_t(y) * kTilePixels + std::size_t(column)];
      }
    }
    if (sum < least) least = sum, best = row;
  }
  return best;
}

Stroke HatchStroke(const Tool& tool, float x, float row, float length, Chance& chance) {
  constexpr int kPoints = 9;
  Stroke stroke;
  const float tilt = chance.Bell(tool.tilt / 2.0f), bow = chance.Bell(tool.waver), heavy = chance.Uniform(0.75f, 1.0f);
  for (int i = 0; i < kPoints; ++i) {
    const float t = static_cast<float>(i) / (kPoints - 1);
    const float y = row + tilt * (t - 0.5f) + bow * (4.0f * t * (1.0f - t) - 0.5f) + chance.Bell(tool.waver / 4.0f);
    // Pressed at once, lifted slowly.
    const float press = std::min(1.0f, 0.5f + 5.0f * t) * std::min(1.0f, 0.25f + 2.2f * (1.0f - t));
    stroke.push_back({{x + length * t, y}, tool.pressure * heavy * press});
  }
  return stroke;
}

}  // namespace

Expected<Picture> PaintHatching(const Studio& studio, const std::string& name) {
  const Tool tool = ToolOf(name);
  SCUMBLE_ASSIGN(Brush brush, Brush::Load(studio.brushes, tool.preset));
  brush.Radius(tool.radius).Color({0.0f, 0.0f, 0.0f});
  Canvas canvas({kTilePixels, kTilePixels, true});
  Chance chance(studio.seed, kHatchStream + HashText(name));
  constexpr std::size_t kPixels = std::size_t(kTilePixels) * kTilePixels;
  std::vector<float> ink(kPixels, 0.0f), threshold(kPixels, -1.0f);
  float mean = 0.0f;
  for (int i = 0; i < kMostStrokes && mean < kEnough; ++i) {
    const float x = chance.Uniform(0.0f, kTilePixels), length = chance.Uniform(tool.shortest, tool.longest);
    brush.Paint(canvas, HatchStroke(tool, x, EmptiestRow(ink, x, length, chance), length, chance));
    const Layer layer = canvas.Read();
    double sum = 0.0;
    for (const glm::vec4& pixel : layer.pixels) sum += pixel.w;
    const float before = mean;
    mean = static_cast<float>(sum / kPixels);
    for (std::size_t p = 0; p < kPixels; ++p) {
      const float now = layer.pixels[p].w;
      if (ink[p] < 0.5f && now >= 0.5f) threshold[p] = before + (mean - before) * (0.5f - ink[p]) / (now - ink[p]);
      ink[p] = now;
    }
  }
  // What never got half of its ink comes last.
  for (std::size_t p = 0; p < kPixels; ++p) {
    if (threshold[p] < 0.0f) threshold[p] = 2.0f - ink[p];
  }
  std::vector<std::uint32_t> order(kPixels);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return threshold[a] < threshold[b]; });
  Picture picture(kTilePixels, kTilePixels);
  for (std::size_t rank = 0; rank < kPixels; ++rank) {
    std::uint16_t* const texel = picture.rgba.data() + 4 * std::size_t(order[rank]);
    const auto grey = static_cast<std::uint16_t>(257 * (256 * rank / kPixels));
    texel[0] = texel[1] = texel[2] = grey;
    texel[3] = 65535;
  }
  return picture;
}

}  // namespace scumble::paint
