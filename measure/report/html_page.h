// What our HTML pages share: one style of the house, text made safe, pictures inside the file.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace scumble::internal {

// Text as it may stand in HTML, in attributes with either quotes, and in SVG.
std::string EscapeHtml(const std::string& text);

// RFC 4648, with padding.
std::string Base64(std::span<const std::byte> bytes);

// Bytes of a PNG as an address of their own.
std::string PngAddress(std::span<const std::byte> png);

// Everything up to and including <body>: colours for dark and light, tables, figures, code, and `style` after them. The
// page tells the browser to load nothing from elsewhere.
std::string PageHead(const std::string& title, const std::string& style);

}  // namespace scumble::internal
