// PNG files, deflated in bands by several threads (PNG specification, third edition; RFC 1950 and 1951).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scumble/picture.h"

namespace scumble::internal {

struct PngOptions {
  int bits = 8;          // 8 or 16 a channel
  bool grey = false;     // the red channel alone
  int level = 6;         // zlib's, 0 … 9
  int dpi = 0;           // 0: none is noted
  std::string settings;  // of the tEXt chunk scumble:settings; "": none
  int threads = 0;       // 0: all
};

// The bytes of a file with the picture's straight RGBA, or its red as grey, marked as sRGB. Rows are cut into bands of
// fixed size, whatever the threads: each is deflated apart, with the end of the one before as its dictionary, so that
// hardly a byte is lost, and ends at a full byte, as pigz does it. So the bytes depend on the picture and the options
// alone. Each band's rows are as they are, or by Paeth's filter, as a sample says. `picture` has a pixel at least.
// Throws std::bad_alloc where memory ends. Thread-safe.
std::vector<std::byte> WritePng(const Picture& picture, const PngOptions& options);

}  // namespace scumble::internal
