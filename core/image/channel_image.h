// A file's channels by name, before they have a meaning: for comparing files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace scumble {

// Planes of floats, rows from the top. Values are as stored; integers are scaled so that their largest value is 1.
// Names are unique, in the file's order.
struct ChannelImage {
  std::string name;  // the file's, for messages
  int x = 0;         // where the stored window's first pixel lies in the whole picture; not 0 in cropped renders
  int y = 0;
  int width = 0;
  int height = 0;
  std::vector<std::string> names;
  std::vector<std::vector<float>> planes;  // one per name, width × height each

  std::size_t pixel_count() const { return std::size_t(width) * height; }

  // The plane of that exact name, or nullptr.
  const std::vector<float>* Find(std::string_view channel) const {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == channel) return &planes[i];
    }
    return nullptr;
  }
};

}  // namespace scumble
