// Which name was probably meant.
#pragma once

#include <span>
#include <string>

namespace scumble {

// The name that is `text` but for upper and lower case, or the one nearest to it; empty: none is near. Of several the
// first.
std::string NearestName(const std::string& text, std::span<const std::string> names);

}  // namespace scumble
