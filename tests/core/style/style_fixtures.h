// A style of one painted sphere in a temporary folder; each test writes its style.toml.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "core/image/hash.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "tests/support/temporary_folder.h"

namespace scumble {

inline constexpr const char* kExemplar = "[[exemplar]]\nimage = \"lit.png\"\n";

inline Picture NoisyPicture(int width, int height) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(width, i) % 256 * 257);
  }
  return picture;
}

// A folder with a painted sphere of 8×8 pixels in it; its style.toml is written by each test.
class StyleFile : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(WritePicture(folder_ / "lit.png", NoisyPicture(8, 8))); }

  Expected<Style> Load(const std::string& toml, const std::vector<std::string>& overrides = {}) {
    std::ofstream(folder_ / "style.toml", std::ios::binary) << toml;
    const auto sets = ParseStyleOverrides(overrides);
    return sets ? LoadStyle(folder_.path(), *sets) : sets.error();
  }
  // A style with this one line under [transfer].
  Expected<Style> LoadLine(const std::string& line) { return Load("[transfer]\n" + line + "\n" + kExemplar); }

  TemporaryFolder folder_;
};

}  // namespace scumble
