// Guides through EXR files: no loss, and a clear refusal of every file that is no guide file.
#include "core/io/guide_file.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "tests/support/guide_files.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

TEST(GuideFile, EveryLayerKeepsItsBitsAtOddSizes) {
  const TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 97}, {97, 1}, {37, 23}, {130, 67}}) {
    const GuideSet guides = RandomGuides(width, height);
    ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
    const auto read = ReadGuides(folder / "g.exr", Everything());
    ASSERT_TRUE(read) << read.error().message;
    ExpectSameBits(*read, guides);
  }
  EXPECT_EQ(folder.List(), std::vector<std::string>{"g.exr"});
}

TEST(GuideFile, AllLosslessCompressionsKeepTheBits) {
  const TemporaryFolder folder;
  const GuideSet guides = RandomGuides(37, 23);
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    GuideWriteOptions options;
    options.compression = compression;
    ASSERT_TRUE(WriteGuides(folder / "g.exr", guides, options)) << compression;
    const auto file = OIIO::ImageInput::open((folder / "g.exr").string());
    ASSERT_TRUE(file);
    EXPECT_EQ(file->spec().get_string_attribute("compression"), compression);
    const auto read = ReadGuides(folder / "g.exr", Everything());
    ASSERT_TRUE(read) << compression << ": " << read.error().message;
    ExpectSameBits(*read, guides);
  }
}

TEST(GuideFile, LossyCompressionAndOtherEndingsAreRefused) {
  const TemporaryFolder folder;
  const GuideSet guides = RandomGuides(3, 3);
  for (const char* compression : {"pxr24", "b44", "b44a", "dwaa", "dwab", "dwaa:45", "ZIP", "", "zip:9"}) {
    GuideWriteOptions options;
    options.compression = compression;
    ExpectRefusal(WriteGuides(folder / "g.exr", guides, options), ErrorKind::kUsage,
                  {"'" + std::string(compression) + "'", "none, rle, zips, zip, piz"});
  }
  for (const char* name : {"g.png", "g", "g.exr.tif"}) {
    ExpectRefusal(WriteGuides(folder / name, guides), ErrorKind::kUsage, {name, ".exr"});
  }
  EXPECT_TRUE(folder.List().empty());
}

TEST(GuideFile, HalfRoundsColoursAsInMemoryAndLeavesDataAlone) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(37, 23);
  guides.Plane(Layer::kAlbedo)[0] = 1.0f / 3.0f;
  guides.Plane(Layer::kAlbedo)[1] = 1e-9f;
  guides.Plane(Layer::kLpeFull)[0] = 65504.0f;
  guides.Plane(Layer::kLpeFull)[1] = 70000.0f;  // beyond half floats: the brightest one, not infinity
  guides.Plane(Layer::kLpeFull)[2] = 3e38f;
  GuideWriteOptions options;
  options.half = true;
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides, options));
  const auto read = ReadGuides(folder / "g.exr", Everything());
  ASSERT_TRUE(read) << read.error().message;
  GuideSet rounded = guides;
  RoundColorLayersToHalf(rounded);
  ExpectSameBits(*read, rounded);
  EXPECT_EQ(rounded.Plane(Layer::kAlbedo)[0], 0.333251953125f);
  EXPECT_EQ(rounded.Plane(Layer::kAlbedo)[1], 0.0f);
  EXPECT_EQ(rounded.Plane(Layer::kLpeFull)[0], 65504.0f);
  EXPECT_EQ(rounded.Plane(Layer::kLpeFull)[1], 65504.0f);
  EXPECT_EQ(rounded.Plane(Layer::kLpeFull)[2], 65504.0f);
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; c < ChannelCount(info.layer) && !info.is_color; ++c) {
      const auto a = rounded.Plane(info.layer, c), b = guides.Plane(info.layer, c);
      EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin())) << info.name;
    }
  }
  GuideSet twice = rounded;
  RoundColorLayersToHalf(twice);
  ExpectSameBits(twice, rounded);
}

TEST(GuideFile, OnlyWhatIsAskedForIsRead) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(7, 5);
  guides.Remove(Layer::kMotion);
  ASSERT_TRUE(WriteGuides(folder / "g.exr", guides));
  GuideReadOptions options = OnlyNormals();
  options.optional = {Layer::kMotion, Layer::kShadow, Layer::kLpeLSE};
  const auto read = ReadGuides(folder / "g.exr", options);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->layers().ToString(), "A, normal, shadow, lpe.LSE");
  for (const LayerInfo& info : AllLayers()) {
    if (!read->Has(info.layer)) guides.Remove(info.layer);
  }
  ExpectSameBits(*read, guides);
}

TEST(GuideFile, AMissingLayerIsNamedWithWhatThereIs) {
  const TemporaryFolder folder;
  GuideSet guides = RandomGuides(3, 3);
  guides.Remove(Layer::kLuminance);
  guides.Remove(Layer::kDepth);
  ASSERT_TRUE(WriteGuides(folder / "ball.exr", guides));
  GuideReadOptions options;
  options.required.Add(Layer::kLuminance);
  ExpectRefusal(ReadGuides(folder / "ball.exr", options), ErrorKind::kInput,
                {"ball.exr", "no layer depth, luminance", "It has A, normal, object"});
  WriteExr(folder / "half.exr", OIIO::ImageSpec(2, 2, 1, OIIO::TypeDesc::FLOAT), {"A", "normal.X", "normal.Y"},
           [](std::size_t, std::size_t) { return 1.0f; });
  ExpectRefusal(ReadGuides(folder / "half.exr", OnlyNormals()), ErrorKind::kInput, {"no layer normal", "normal.Y"});
}

TEST(GuideFile, AnEmptySetIsNotWritten) {
  const TemporaryFolder folder;
  EXPECT_FALSE(WriteGuides(folder / "g.exr", GuideSet()));
  EXPECT_FALSE(WriteGuides(folder / "g.exr", GuideSet(4, 4))) << "no layers";
  EXPECT_TRUE(folder.List().empty());
}

TEST(GuideFile, WhatIsNoGuideFile) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "folder.exr");
  ASSERT_TRUE(WriteFileAtomically(folder / "empty.exr", ""));
  ASSERT_TRUE(WriteFileAtomically(folder / "text.exr", "This is not a picture, whatever its name says.\n"));
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"missing.exr", "no such file"}, {"folder.exr", "folder"}, {"empty.exr", "empty"}, {"text.exr", "text.exr"}};
  for (const auto& [name, words] : cases) {
    ExpectRefusal(ReadGuides(folder / name), ErrorKind::kInput, {name, words});
    ExpectRefusal(InspectGuides(folder / name), ErrorKind::kInput, {name, words});
  }
}

TEST(GuideFile, NamesWithSpecialCharactersAreOnlyNames) {
  const TemporaryFolder folder;
  const GuideSet guides = RandomGuides(3, 2);
  for (const char* name :
       {"a b.exr", "Käse 球.exr", "what?x=1.exr", "100%.exr", "frame.####.exr", "-o.exr", "a'b\"c.exr"}) {
    ASSERT_TRUE(WriteGuides(folder / name, guides)) << name;
    const auto read = ReadGuides(folder / name, Everything());
    ASSERT_TRUE(read) << name << ": " << read.error().message;
    ExpectSameBits(*read, guides);
  }
}

TEST(GuideFile, ATruncatedFileIsRefusedAtAnyLength) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteGuides(folder / "whole.exr", RandomGuides(37, 23)));
  const auto whole = ReadWholeFile(folder / "whole.exr");
  ASSERT_TRUE(whole);
  const fs::path cut = folder / "cut.exr";
  for (std::size_t k = 0; k < 120; ++k) {
    const std::size_t length = k < 60 ? k * k / 2 : whole->size() - 1 - Hash(k) % (whole->size() - 1);
    if (length >= whole->size()) continue;
    ASSERT_TRUE(WriteFileAtomically(cut, std::span(whole->data(), length)));
    ExpectRefusal(ReadGuides(cut, Everything()), ErrorKind::kInput, {"cut.exr"});
  }
}

TEST(GuideFile, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteGuides(folder / "whole.exr", RandomGuides(37, 23)));
  const auto whole = ReadWholeFile(folder / "whole.exr");
  ASSERT_TRUE(whole);
  const fs::path damaged = folder / "damaged.exr";
  int refused = 0;
  for (std::uint64_t round = 0; round < 300; ++round) {
    auto bytes = *whole;
    const std::size_t reach = round % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 1500);  // the header
    for (std::uint64_t k = 0; k <= round % 3; ++k)
      bytes[Hash(round, k) % reach] ^= std::byte(1 + Hash(round, k, 1) % 255);
    ASSERT_TRUE(WriteFileAtomically(damaged, std::span<const std::byte>(bytes)));
    const auto read = ReadGuides(damaged, Everything());
    if (read) continue;
    ++refused;
    ExpectRefusal(read, ErrorKind::kInput, {"damaged.exr"});
  }
  EXPECT_GT(refused, 100) << "most damage shows";
}

}  // namespace
}  // namespace scumble
