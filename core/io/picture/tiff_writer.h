// TIFF files, deflated in strips by several threads (TIFF 6.0 with the supplement for Photoshop, which adds Deflate).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble::internal {

struct TiffOptions {
  int bits = 8;       // 8 or 16 a channel
  bool grey = false;  // the red channel alone
  int dpi = 0;        // 0: none is noted
  int threads = 0;    // 0: all
};

// The bytes of a file with the picture's straight RGBA, or its red as grey. Rows are cut into strips of fixed size, for
// any number of threads. Each strip holds horizontal differences, deflated as a stream of its own, and libtiff writes
// them in their order. So the bytes depend on the picture and the options alone. `picture` has at least one pixel;
// `name` stands for the file in messages. Throws std::bad_alloc where memory ends. Thread-safe.
Expected<std::vector<std::byte>> EncodeTiff(const std::string& name, const Picture& picture,
                                            const TiffOptions& options);

}  // namespace scumble::internal
