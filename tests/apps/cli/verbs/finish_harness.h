// What tests of finishing effects from the command line share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tests/support/cli_harness.h"

namespace scumble {

class CliFinish : public CliTest {
 protected:
  static constexpr const char* kBall = SCUMBLE_SOURCE_DIR "/scenes/ball.glb";
  static constexpr const char* kToys = SCUMBLE_SOURCE_DIR "/scenes/toys.glb";

  static Picture PlainBall() {
    Picture picture(32, 32);
    for (int i = 0; i < 32 * 32; ++i) {
      std::uint16_t* const texel = picture.At(i % 32, i / 32);
      texel[0] = 60000, texel[1] = 40000, texel[2] = 20000, texel[3] = 65535;
    }
    return picture;
  }
  // A style of one colour without paper.
  void WriteStyle(const std::string& folder, const std::string& more = "") {
    std::filesystem::create_directories(At(folder));
    ASSERT_TRUE(WritePicture(At(folder + "/lit.png"), PlainBall()));
    WriteText(folder + "/style.toml", "[[exemplar]]\nimage = \"lit.png\"\nfills = true\n" + more);
  }
  Picture Read(const std::string& name) {
    const Expected<Picture> picture = ReadPicture(At(name));
    EXPECT_TRUE(picture) << name;
    return picture ? *picture : Picture();
  }
};

}  // namespace scumble
