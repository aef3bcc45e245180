// Pictures that explain a result: the source of every pixel's paint, the chunks, and the guide error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scumble/picture.h"

namespace scumble {

enum class Explanation {
  kSources,   // the nearest-neighbour field: source x is red, y green, the exemplar blue
  kChunks,    // every chunk in its own colour, dark at its border
  kBorders,   // the result with the borders of its chunks drawn over it
  kLevels,    // the level that settled a pixel: LevelColor
  kError,     // guide distance at the chosen source: ErrorColor
  kExemplar,  // the lighting condition
  kStyles,    // the style
};

// "sources", "chunks", …, in the enum's order; and back.
std::vector<std::string> ExplanationNames();
std::optional<Explanation> FindExplanation(std::string_view name);

// Views of width × height values, rows from the top; they are not stored. Unused ones may be empty.
struct ExplainPlanes {
  static constexpr std::uint16_t kNoStyle = 0xffff;

  int width = 0;
  int height = 0;
  std::span<const float> coverage;         // 0 … 1, becomes the alpha
  std::span<const std::int16_t> source_x;  // exemplar pixels
  std::span<const std::int16_t> source_y;
  std::span<const std::int8_t> level;  // below 0: not painted
  std::span<const std::uint8_t> exemplar;
  std::span<const std::uint16_t> style;  // kNoStyle: unchanged; empty: there is one style, 0
  std::span<const float> error;          // guide distance, 0 or more
  // By style.
  std::vector<int> exemplar_size;  // side of the resized exemplar, pixels
  std::vector<int> exemplar_count;
  std::vector<float> threshold;
  const Picture* result = nullptr;  // for kBorders
};

// Unpainted pixels are transparent, except in kBorders, which is the result. Deterministic, O(pixels).
Picture Explain(Explanation what, const ExplainPlanes& planes);

// 16-bit sRGB.
struct ExplainColor {
  std::uint16_t r = 0, g = 0, b = 0;
  bool operator==(const ExplainColor&) const = default;
};

// Level l is a grid of 2^l pixels. From violet over green to yellow, in even steps of Oklab's lightness, so it is
// readable in grey and by colour-blind viewers. A level has one colour in every picture; 7 and above are alike.
ExplainColor LevelColor(int level);

// Black at 0, orange at the threshold, white at twice that and above, both halves straight in Oklab. With a threshold
// of infinity the scale ends at 2, the largest distance of unit vectors; with 0 any error is white.
ExplainColor ErrorColor(float error, float threshold);

}  // namespace scumble
