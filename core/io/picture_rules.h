// Helpers that the parts of picture_file.h share.
#pragma once

#include <string>

namespace scumble::internal {

// In capital letters, as endings are compared.
std::string Upper(std::string text);

}  // namespace scumble::internal
