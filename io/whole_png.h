// Whether a PNG file is all there: libpng would say so on standard error, whoever listens.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "image/status.h"

namespace scumble::internal {

// Whether the bytes begin as every PNG file does.
bool IsPng(std::span<const std::byte> bytes);

// Follows the chunks (PNG specification, third edition, section 5) up to the one that ends the picture, and checks the
// sums of those that a reader needs. `name` is for the message. Thread-safe.
Status CheckPngIsWhole(std::span<const std::byte> bytes, const std::string& name);

}  // namespace scumble::internal
