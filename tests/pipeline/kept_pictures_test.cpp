#include "pipeline/style/kept_pictures.h"

#include <gtest/gtest.h>

#include "core/io/picture_file.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

Picture Of(int side, std::uint16_t red) {
  Picture picture(side, side);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) picture.rgba[i] = red, picture.rgba[i + 3] = 65535;
  return picture;
}

TEST(KeptPictures, AFileIsDecodedOnceAndAgainWhereItHasChanged) {
  const TemporaryFolder folder;
  const auto file = folder / "a.png";
  ASSERT_TRUE(WritePicture(file, Of(4, 257)));
  KeptPictures pictures;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(pictures.Read(file)->rgba, Of(4, 257).rgba);
  EXPECT_EQ(pictures.decoded(), 1u);
  ASSERT_TRUE(WritePicture(file, Of(5, 514)));
  EXPECT_EQ(pictures.Read(file)->rgba, Of(5, 514).rgba);
  EXPECT_EQ(pictures.decoded(), 2u);
  std::filesystem::remove(file);
  EXPECT_FALSE(pictures.Read(file));
}

TEST(KeptPictures, WhatIsNotReadAnyMoreIsForgotten) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "b.png"}) ASSERT_TRUE(WritePicture(folder / name, Of(4, 257)));
  KeptPictures pictures;
  ASSERT_TRUE(pictures.Read(folder / "a.png"));
  ASSERT_TRUE(pictures.Read(folder / "b.png"));
  pictures.ForgetUnread();
  ASSERT_TRUE(pictures.Read(folder / "a.png"));
  pictures.ForgetUnread();
  ASSERT_TRUE(pictures.Read(folder / "a.png"));
  EXPECT_EQ(pictures.decoded(), 2u);
  ASSERT_TRUE(pictures.Read(folder / "b.png"));
  EXPECT_EQ(pictures.decoded(), 3u);
}

}  // namespace
}  // namespace scumble
