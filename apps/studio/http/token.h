// The secret that a page shows to be the one that this program opened.
#pragma once

#include <string>
#include <string_view>

namespace scumble {

// 256 bits from the system's random numbers, as 64 hexadecimal digits.
std::string MakeToken();

// Whether two texts are equal, in a time that depends on their lengths alone.
bool EqualInConstantTime(std::string_view a, std::string_view b);

}  // namespace scumble
