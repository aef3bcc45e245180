// Shared parts of our HTML pages: one style sheet, escaped text, embedded pictures.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace scumble::internal {

// Text escaped for HTML, for attributes with either quotes, and for SVG.
std::string EscapeHtml(const std::string& text);

// RFC 4648, with padding.
std::string Base64(std::span<const std::byte> bytes);

// Bytes of a PNG as a data URI.
std::string PngAddress(std::span<const std::byte> png);

// Everything up to and including <body>: colours for dark and light, tables, figures, code, then `style`. The page
// forbids the browser to load anything from elsewhere.
std::string PageHead(const std::string& title, const std::string& style);

}  // namespace scumble::internal
