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
// fixed size, for any number of threads. As in pigz, each band is deflated separately, with the end of the previous one
// as its dictionary, and ends at a full byte; this costs hardly a byte. So the bytes depend on the picture and the
// options alone. Each band's rows are unfiltered or use Paeth's filter, as a sample decides. `picture` has at least one
// pixel. Throws std::bad_alloc where memory ends. Thread-safe.
std::vector<std::byte> WritePng(const Picture& picture, const PngOptions& options);

}  // namespace scumble::internal
