// Figures as JSON holds them.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace scumble {

// JSON has no NaN or infinity: they become the texts "nan", "inf" and "-inf".
inline nlohmann::ordered_json JsonNumber(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

}  // namespace scumble
