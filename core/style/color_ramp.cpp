#include "core/style/color_ramp.h"

#include <algorithm>
#include <sstream>

#include "core/style/finish_keys.h"

namespace scumble {

bool IsRampText(const std::string& value) { return !value.empty() && value[0] == '#'; }

Expected<ColorRamp> ParseColorRamp(const std::string& text) {
  ColorRamp ramp;
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line, '/')) {
    std::istringstream words(line);
    int columns = 0;
    for (std::string word; words >> word; ++columns) {
      const auto color = ParseColor(word);
      if (!color) {
        return UsageError(word + " is no colour: " + kColorForm + ", with blanks between colours and / between rows");
      }
      ramp.colors.push_back(*color);
    }
    const std::string row = "row " + std::to_string(ramp.rows + 1) + " has " + std::to_string(columns) + " colours";
    if (columns == 0) return UsageError(row + ": give each row as many, from dark to light");
    if (ramp.rows > 0 && columns != ramp.columns) {
      return UsageError(row + ", the rows before have " + std::to_string(ramp.columns) + ": give each row as many");
    }
    ramp.columns = columns, ++ramp.rows;
  }
  if (ramp.columns > kMostRampColumns || ramp.rows > kMostRampRows) {
    return UsageError(std::to_string(ramp.columns) + " colours in " + std::to_string(ramp.rows) +
                      " rows: expected at most " + std::to_string(kMostRampColumns) + " in " +
                      std::to_string(kMostRampRows) + "; a picture's file may have more");
  }
  return ramp;
}

Expected<ColorRamp> ColorRampOf(const Picture& picture) {
  if (picture.width > kMostRampTexels || picture.height > kMostRampTexels || picture.empty()) {
    return InputError("the ramp is " + std::to_string(picture.width) + "×" + std::to_string(picture.height) +
                      " pixels: expected at most " + std::to_string(kMostRampTexels) + " a side; scale it down");
  }
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i] == 65535) continue;
    const std::size_t texel = i / 4, width = std::size_t(picture.width);
    return InputError("the ramp is transparent at x=" + std::to_string(texel % width) +
                      ", y=" + std::to_string(texel / width) +
                      ", where it has no colour of its own: expected opaque colours; crop the picture to them, or "
                      "flatten it");
  }
  ColorRamp ramp{picture.width, picture.height, {}};
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    ramp.colors.push_back({picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]});
  }
  return ramp;
}

}  // namespace scumble
