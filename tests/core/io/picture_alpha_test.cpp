// Colours under alpha, in every format that has it.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "tests/support/picture_files.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

TEST(PictureAlpha, ColourUnderAlmostNoAlphaSurvives) {
  const TemporaryFolder folder;
  Picture picture(3, 1);
  const std::uint16_t values[] = {200 * 257, 100 * 257, 50 * 257, 257,     255 * 257, 3 * 257,
                                  128 * 257, 0,         1 * 257,  2 * 257, 3 * 257,   65535};
  std::copy(std::begin(values), std::end(values), picture.rgba.begin());
  for (const char* name : {"thin.png", "thin.tif"}) {
    ASSERT_TRUE(WritePicture(folder / name, picture));
    ExpectSame(Read(folder / name), picture);
  }
}

TEST(PictureAlpha, AssociatedAlphaIsUndone) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(2, 2, 4, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 0);
  WriteWith<std::uint8_t>(folder / "a.tif", spec, {64, 32, 0, 128, 10, 20, 30, 255, 0, 0, 0, 0, 1, 1, 1, 1});
  const Picture picture = Read(folder / "a.tif");
  EXPECT_EQ(Pixel(picture, 0, 0), (std::vector<std::uint16_t>{32768, 16384, 0, 128 * 257}));
  EXPECT_EQ(Pixel(picture, 1, 0), (std::vector<std::uint16_t>{10 * 257, 20 * 257, 30 * 257, 65535}));
  EXPECT_EQ(Pixel(picture, 0, 1), (std::vector<std::uint16_t>{0, 0, 0, 0}));
  EXPECT_EQ(Pixel(picture, 1, 1), (std::vector<std::uint16_t>{65535, 65535, 65535, 257}));
}

TEST(PictureAlpha, LossesOfFloatsAreCounted) {
  const TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN(), much = std::numeric_limits<float>::infinity();
  // Its second pixel is half-transparent white, rounded up as half floats may be.
  WriteWith<float>(folder / "a.exr", OIIO::ImageSpec(2, 2, 4, OIIO::TypeDesc::FLOAT),
                   {nan, 2.0f, -1.0f, 1.0f, 0.501f, 0.5f, 0.5f, 0.5f, much, 0.0f, 0.0f, nan, 0.0f, 1.0f, 0.5f, 1.0f});
  PictureLosses losses;
  ASSERT_TRUE(ReadPicture(folder / "a.exr", {}, Profiles::kApply, &losses));
  EXPECT_EQ(losses.clamped, 3u);
  EXPECT_EQ(losses.nan, 2u);
  ASSERT_TRUE(WritePicture(folder / "a.png", Picture(2, 2)));
  ASSERT_TRUE(ReadPicture(folder / "a.png", {}, Profiles::kApply, &losses));
  EXPECT_EQ(losses.clamped + losses.nan, 0u);
}

TEST(PictureAlpha, ColoursUnderAlphaAreThoseOfTheFile) {
  const TemporaryFolder folder;
  for (const char* const name : {"a.png", "a.tif", "a.tga"}) {
    OIIO::ImageSpec spec(16, 16, 4, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 256; ++i) bytes.insert(bytes.end(), {100, 150, 200, 128});
    WriteWith<std::uint8_t>(folder / name, spec, bytes);
    const Picture picture = Read(folder / name);
    const int expected[] = {100, 150, 200, 128};
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(Pixel(picture, 8, 8)[std::size_t(c)] / 257.0, expected[c], 2.5) << name;
  }
}

// 4 × 4 pixels of one colour with alpha, packed by OpenJPEG. Its reader gives straight colours without saying so, as
// that of bitmaps does.
TEST(PictureAlpha, ColoursUnderAlphaOfJpeg2000AreTheFiles) {
  const std::string hex =
      "0000000c6a5020200d0a870a00000014667479706a703220000000006a7032200000002d6a703268000000166968647200000004"
      "000000040004070700000000000f636f6c7201000000000010000000ab6a703263ff4fff51003200000000000400000004000000"
      "0000000000000000040000000400000000000000000004070101070101070101070101ff52000c00000001000000000001ff5c00"
      "044040ff640025000143726561746564206279204f70656e4a5045472076657273696f6e20322e352e30ff90000a000000000030"
      "0001ff93c3e70e1150548842e11fc3e71014005272c4e0183fcfb4241400515c0841816a0880ffd9";
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    bytes.push_back(static_cast<std::byte>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  const auto picture = DecodePicture(bytes, "a.jp2");
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(Pixel(*picture, 1, 1), (std::vector<std::uint16_t>{100 * 257, 150 * 257, 200 * 257, 128 * 257}));
}

// A bitmap of 32 bits a pixel, by its fifth header: blue, green, red and alpha.
TEST(PictureAlpha, ColoursUnderAlphaOfABitmapAreTheFiles) {
  const auto little = [](std::uint32_t number, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(number >> (8 * i));
    return text;
  };
  constexpr std::uint32_t kHeader = 124, kStart = 14 + kHeader;
  std::string file = "BM" + little(kStart + 4, 4) + little(0, 4) + little(kStart, 4) + little(kHeader, 4) +
                     little(1, 4) + little(1, 4) + little(1, 2) + little(32, 2) + little(0, 4);
  file.resize(kStart, 0);
  file += std::string{'\xc8', '\x96', '\x64', '\x80'};
  const auto bytes = std::as_bytes(std::span(file));
  const auto picture = DecodePicture(bytes, "a.bmp");
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(Pixel(*picture, 0, 0), (std::vector<std::uint16_t>{100 * 257, 150 * 257, 200 * 257, 128 * 257}));
}

}  // namespace
}  // namespace scumble
