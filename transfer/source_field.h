// The intermediate result of every method: the source of each pixel's paint.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace scumble {

// Per pixel: the source position in the resized exemplar, the index of the style's exemplar, and the level that settled
// it (0: the pixel's own nearest neighbour). Rows from the top. Uncovered pixels have level kNoSource, position and
// exemplar 0.
struct SourceField {
  static constexpr std::int8_t kNoSource = -1;

  int width = 0;
  int height = 0;     // of the picture
  int first_row = 0;  // the first row in memory; a field of a band (band_pipeline.h) holds some rows only
  std::vector<std::int16_t> x;
  std::vector<std::int16_t> y;
  std::vector<std::int8_t> level;
  std::vector<std::uint8_t> exemplar;
  std::vector<glm::vec3> guide_offset;  // guide offset of each seed's source (variety); empty where it is not needed

  // Sets the size alone: values stay or are undefined, and guide offsets are 0.
  void Resize(int new_width, int new_height) { ResizeRows(new_width, new_height, new_height); }
  // Resize with room for some rows only, from row 0 on.
  void ResizeRows(int new_width, int new_height, int rows) {
    width = new_width, height = new_height, first_row = 0;
    const std::size_t count = std::size_t(width) * rows;
    x.resize(count), y.resize(count), level.resize(count), exemplar.resize(count);
    guide_offset.clear();
  }
  void Reset(int new_width, int new_height) {
    width = new_width, height = new_height, first_row = 0;
    const std::size_t count = std::size_t(width) * height;
    x.assign(count, 0), y.assign(count, 0), level.assign(count, kNoSource), exemplar.assign(count, 0);
    guide_offset.clear();
  }
  void Set(std::size_t i, int source_x, int source_y, int source_exemplar, int settled) {
    x[i] = static_cast<std::int16_t>(source_x), y[i] = static_cast<std::int16_t>(source_y);
    exemplar[i] = static_cast<std::uint8_t>(source_exemplar), level[i] = static_cast<std::int8_t>(settled);
  }
  std::size_t Index(int px, int py) const { return std::size_t(py - first_row) * width + px; }
};

}  // namespace scumble
