// Pictures in files, written as other programs might, and read by ours.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"

namespace scumble {

inline Picture Read(const std::filesystem::path& path) {
  auto picture = ReadPicture(path);
  EXPECT_TRUE(picture) << picture.error().message;
  return picture ? *std::move(picture) : Picture();
}

inline void ExpectSame(const Picture& found, const Picture& expected, int tolerance = 0) {
  ASSERT_EQ(found.width, expected.width);
  ASSERT_EQ(found.height, expected.height);
  for (std::size_t i = 0; i < expected.rgba.size(); ++i) {
    ASSERT_LE(std::abs(int(found.rgba[i]) - int(expected.rgba[i])), tolerance)
        << "channel " << i % 4 << " of pixel " << i / 4 << ": " << found.rgba[i] << " for " << expected.rgba[i];
  }
}

// Writes a file as another program might: any type, channels and attributes.
template <class T>
void WriteWith(const std::filesystem::path& path, OIIO::ImageSpec spec, const std::vector<T>& pixels) {
  auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output);
  ASSERT_TRUE(output->open(path.string(), spec)) << output->geterror();
  ASSERT_TRUE(output->write_image(OIIO::BaseTypeFromC<T>::value, pixels.data())) << output->geterror();
  ASSERT_TRUE(output->close());
}

inline std::vector<std::uint16_t> Pixel(const Picture& picture, int x, int y) {
  return std::vector<std::uint16_t>(picture.At(x, y), picture.At(x, y) + 4);
}

}  // namespace scumble
