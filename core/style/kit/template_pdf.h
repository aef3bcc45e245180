// The template as a page for the printer, by libharu.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/style/kit/print_page.h"
#include "core/style/sphere_template.h"

namespace scumble {

// One page, true to scale: the sphere so pale (0 to 18% grey) that paint covers it, the same marks as in the picture
// but as shapes, and a text on how it is lit, printed and scanned. `painting` is the file name for the painting. The
// same input makes the same bytes: no date is in it. `name` is for messages. Thread-safe.
Expected<std::vector<std::byte>> EncodeTemplatePdf(const KitLight& light, const PrintPage& page, int dpi,
                                                   const std::string& painting, const std::string& name);

// Whether a file's bytes are an unchanged page of EncodeTemplatePdf.
bool IsTemplatePdf(std::span<const std::byte> bytes);

}  // namespace scumble
