#include "measure/explain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/image/oklab.h"

namespace scumble {
namespace {

constexpr float kTurn = 6.2831853f;
constexpr float kLargestDistance = 2.0f;  // of two unit vectors
constexpr std::array<const char*, 7> kNames = {"sources", "chunks", "borders", "levels", "error", "exemplar", "styles"};

ExplainColor FromOklab(glm::vec3 lab) {
  const glm::vec3 linear = LinearFromOklab(lab);
  return {Srgb16FromLinear(linear.x), Srgb16FromLinear(linear.y), Srgb16FromLinear(linear.z)};
}

// A colour of that lightness and hue with as much of the chroma as a screen can show.
ExplainColor FromHue(float lightness, float chroma, float turns) {
  const glm::vec2 way(std::cos(kTurn * turns), std::sin(kTurn * turns));
  for (; chroma > 0.0f; chroma -= 0.005f) {
    const glm::vec3 linear = LinearFromOklab({lightness, chroma * way.x, chroma * way.y});
    if (std::min({linear.x, linear.y, linear.z}) >= 0.0f && std::max({linear.x, linear.y, linear.z}) <= 1.0f) break;
  }
  chroma = std::max(chroma, 0.0f);
  return FromOklab({lightness, chroma * way.x, chroma * way.y});
}

ExplainColor HashedColor(std::uint64_t hash, float least_lightness, float most_lightness) {
  const float lightness = least_lightness + (most_lightness - least_lightness) * UnitFloat(Mix64(hash));
  return FromHue(lightness, 0.13f, UnitFloat(hash));
}

ExplainColor Mixed(ExplainColor a, ExplainColor b, float share) {
  const auto mix = [share](std::uint16_t x, std::uint16_t y) {
    return static_cast<std::uint16_t>(std::lround(x + (static_cast<float>(y) - x) * share));
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

// Lighting conditions, in colours that every viewer separates (Okabe and Ito's palette).
ExplainColor ExemplarColor(int exemplar) {
  constexpr std::array<std::array<int, 3>, 4> kColors = {
      {{230, 159, 0}, {86, 180, 233}, {0, 158, 115}, {204, 121, 167}}};
  const auto& c = kColors[static_cast<std::size_t>(exemplar) % kColors.size()];
  return {static_cast<std::uint16_t>(c[0] * 257), static_cast<std::uint16_t>(c[1] * 257),
          static_cast<std::uint16_t>(c[2] * 257)};
}

class Painter {
 public:
  explicit Painter(const ExplainPlanes& planes) : planes_(planes) {}

  bool Painted(std::size_t i) const { return planes_.level[i] >= 0; }
  std::size_t StyleAt(std::size_t i) const { return planes_.style.empty() ? 0 : planes_.style[i]; }

  // A hash of the values that a chunk's pixels share and that differ between neighbouring chunks.
  std::uint64_t ChunkAt(std::size_t i, int x, int y) const {
    return Hash(planes_.source_x[i] - x, planes_.source_y[i] - y, planes_.exemplar[i], StyleAt(i));
  }

  // Whether a chunk ends to the right or below. Single pixels have no room for a border.
  bool Border(std::size_t i, int x, int y) const {
    if (planes_.level[i] < 1) return false;
    const std::uint64_t chunk = ChunkAt(i, x, y);
    const std::size_t right = i + 1, below = i + static_cast<std::size_t>(planes_.width);
    return (x + 1 < planes_.width && Painted(right) && ChunkAt(right, x + 1, y) != chunk) ||
           (y + 1 < planes_.height && Painted(below) && ChunkAt(below, x, y + 1) != chunk);
  }

  ExplainColor Color(Explanation what, std::size_t i, int x, int y) const {
    switch (what) {
      case Explanation::kSources:
        return SourceColor(i);
      case Explanation::kChunks: {
        const ExplainColor chunk = HashedColor(ChunkAt(i, x, y), 0.6f, 0.85f);
        return Border(i, x, y) ? Mixed(chunk, {}, 0.72f) : chunk;
      }
      case Explanation::kLevels:
        return LevelColor(planes_.level[i]);
      case Explanation::kError:
        return ErrorColor(planes_.error[i], planes_.threshold[StyleAt(i)]);
      case Explanation::kExemplar:
        return ExemplarColor(planes_.exemplar[i]);
      // The golden ratio separates the hues of few and of many styles.
      case Explanation::kStyles: {
        const double turns = 0.16 + 0.6180339887 * static_cast<double>(StyleAt(i));
        return FromHue(0.72f, 0.13f, static_cast<float>(turns - std::floor(turns)));
      }
      case Explanation::kBorders:
        break;
    }
    return {};
  }

 private:
  ExplainColor SourceColor(std::size_t i) const {
    const double size = planes_.exemplar_size[StyleAt(i)];
    const int count = planes_.exemplar_count[StyleAt(i)];
    const auto share = [](double value) {
      return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, 1.0) * 65535.0));
    };
    return {share((planes_.source_x[i] + 0.5) / size), share((planes_.source_y[i] + 0.5) / size),
            count > 1 ? share(double(planes_.exemplar[i]) / (count - 1)) : std::uint16_t{0}};
  }

  const ExplainPlanes& planes_;
};

Picture ResultWithBorders(const ExplainPlanes& planes) {
  SCUMBLE_CHECK(planes.result && planes.result->width == planes.width && planes.result->height == planes.height);
  constexpr ExplainColor kLine = {0xd4d4, 0x2727, 0x2727};
  const Painter painter(planes);
  Picture picture = *planes.result;
  for (int y = 0; y < planes.height; ++y) {
    for (int x = 0; x < planes.width; ++x) {
      const std::size_t i = std::size_t(y) * planes.width + x;
      if (!painter.Painted(i) || !painter.Border(i, x, y)) continue;
      std::uint16_t* pixel = picture.At(x, y);
      pixel[0] = kLine.r, pixel[1] = kLine.g, pixel[2] = kLine.b;
    }
  }
  return picture;
}

}  // namespace

std::vector<std::string> ExplanationNames() { return {kNames.begin(), kNames.end()}; }

std::optional<Explanation> FindExplanation(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Explanation>(found - kNames.begin());
}

ExplainColor LevelColor(int level) {
  constexpr int kLast = 7;
  const float share = static_cast<float>(std::clamp(level, 0, kLast)) / kLast;
  return FromHue(0.32f + 0.60f * share, 0.14f, 0.85f - 0.55f * share);
}

ExplainColor ErrorColor(float error, float threshold) {
  constexpr glm::vec3 kBlack(0.0f), kOrange(0.75f, 0.08f, 0.14f), kWhite(1.0f, 0.0f, 0.0f);
  if (!(error > 0.0f)) return {};
  const float scale = std::min(threshold, kLargestDistance);
  const float share = scale > 0.0f ? error / scale : kLargestDistance;
  if (share <= 1.0f) return FromOklab(kBlack + share * (kOrange - kBlack));
  return FromOklab(kOrange + std::min(share - 1.0f, 1.0f) * (kWhite - kOrange));
}

Picture Explain(Explanation what, const ExplainPlanes& planes) {
  const std::size_t count = std::size_t(planes.width) * planes.height;
  SCUMBLE_CHECK_EQ(planes.level.size(), count);
  if (what == Explanation::kBorders) return ResultWithBorders(planes);
  if (what == Explanation::kError) SCUMBLE_CHECK_EQ(planes.error.size(), count);
  const Painter painter(planes);
  Picture picture(planes.width, planes.height);
  for (int y = 0; y < planes.height; ++y) {
    for (int x = 0; x < planes.width; ++x) {
      const std::size_t i = std::size_t(y) * planes.width + x;
      if (!painter.Painted(i)) continue;
      const ExplainColor color = painter.Color(what, i, x, y);
      std::uint16_t* pixel = picture.At(x, y);
      pixel[0] = color.r, pixel[1] = color.g, pixel[2] = color.b;
      const float covered = planes.coverage.empty() ? 1.0f : std::clamp(planes.coverage[i], 0.0f, 1.0f);
      pixel[3] = static_cast<std::uint16_t>(covered * 65535.0f + 0.5f);
    }
  }
  return picture;
}

}  // namespace scumble
