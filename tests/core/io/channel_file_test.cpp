// Channels of any picture file, by their names.
#include "core/io/channel_file.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// A folder that goes away with the test.
class ChannelFile : public ::testing::Test {
 protected:
  // Writes the parts as float; their values count up from 0 across parts, channels fastest.
  std::string WriteParts(std::vector<OIIO::ImageSpec> specs) {
    const std::string path = (folder_ / "parts.exr").string();
    auto output = OIIO::ImageOutput::create(path);
    EXPECT_TRUE(output->open(path, static_cast<int>(specs.size()), specs.data()));
    float value = 0;
    for (std::size_t p = 0; p < specs.size(); ++p) {
      EXPECT_TRUE(p == 0 || output->open(path, specs[p], OIIO::ImageOutput::AppendSubimage));
      std::vector<float> pixels(std::size_t(specs[p].width) * specs[p].height * specs[p].nchannels);
      for (float& pixel : pixels) pixel = value++;
      EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
    }
    EXPECT_TRUE(output->close());
    return path;
  }

  static OIIO::ImageSpec Part(const std::string& name, const std::vector<std::string>& channels, int width = 2) {
    OIIO::ImageSpec spec(width, 1, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames = channels;
    spec.full_width = 2;  // the parts of one EXR must agree on the whole picture's size, and may on no more
    spec.attribute("oiio:subimagename", name);
    return spec;
  }

  TemporaryFolder folder_;
};

TEST_F(ChannelFile, ReadsEveryChannelByName) {
  const auto image = ReadChannels(WriteParts({Part("", {"normal.X", "depth.Z"})}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 2);
  EXPECT_EQ(image->height, 1);
  ASSERT_NE(image->Find("normal.X"), nullptr);
  ASSERT_NE(image->Find("depth.Z"), nullptr);
  EXPECT_EQ(*image->Find("normal.X"), (std::vector<float>{0, 2}));
  EXPECT_EQ(*image->Find("depth.Z"), (std::vector<float>{1, 3}));
  EXPECT_EQ(image->Find("normal.Y"), nullptr);
}

TEST_F(ChannelFile, PartsArePrefixedOnlyWhereNamesRepeat) {
  const auto image = ReadChannels(WriteParts({Part("left", {"Y"}), Part("right", {"Y"}), Part("deep", {"Z"})}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->names, (std::vector<std::string>{"left.Y", "right.Y", "Z"}));
  EXPECT_EQ(image->planes[1], (std::vector<float>{2, 3}));
}

TEST_F(ChannelFile, PartsOfDifferentSizesAreRefused) {
  const auto image = ReadChannels(WriteParts({Part("a", {"Y"}), Part("b", {"Z"}, 3)}));
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().message.find("part 1 is 3×1"), std::string::npos) << image.error().message;
}

TEST_F(ChannelFile, IntegersAreScaledAndAlphaIsLeftAlone) {
  const std::string path = (folder_ / "grey.png").string();
  auto output = OIIO::ImageOutput::create(path);
  OIIO::ImageSpec spec(2, 1, 4, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  ASSERT_TRUE(output->open(path, spec));
  const unsigned char pixels[] = {255, 51, 0, 0, 102, 204, 255, 51};
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, pixels));
  ASSERT_TRUE(output->close());
  const auto image = ReadChannels(path);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->names, (std::vector<std::string>{"R", "G", "B", "A"}));
  const std::vector<std::vector<int>> expected = {{255, 102}, {51, 204}, {0, 255}, {0, 51}};
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_FLOAT_EQ(image->planes[c][i], static_cast<float>(expected[c][i]) / 255.0f);
    }
  }
}

TEST_F(ChannelFile, MissingFileIsAnError) {
  const auto image = ReadChannels(folder_ / "none.exr");
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().message.find("none.exr"), std::string::npos);
}

}  // namespace
}  // namespace scumble
