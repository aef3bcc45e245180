// The ramps of toon, from text and from pictures.
#pragma once

#include <string>

#include "core/image/finish_pass.h"
#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

inline constexpr int kMostRampColumns = 64, kMostRampRows = 16;  // in text
inline constexpr int kMostRampTexels = 1024;                     // along each side of a picture

// Whether the value of `ramp` is colours; otherwise it is a file, or empty.
bool IsRampText(const std::string& value);

// "#202040 #fff4d0 / #405060 #c0d0e0": colours from dark to light, rows of equally many. kUsage says what is wrong.
Expected<ColorRamp> ParseColorRamp(const std::string& text);

// Every texel is a colour, row 0 the first. kInput where one is transparent, or there are more than kMostRampTexels a
// side.
Expected<ColorRamp> ColorRampOf(const Picture& picture);

}  // namespace scumble
