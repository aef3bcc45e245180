// Helpers that the parts of picture_file.h share.
#pragma once

#include <string>

namespace scumble::internal {

// In capital letters, as endings are compared.
std::string Upper(std::string text);

// Dots an inch as they are, or 0 where they are no true resolution: none, a camera's or screen's 72 or 96, nonsense.
double TrueDpi(double dpi);

}  // namespace scumble::internal
