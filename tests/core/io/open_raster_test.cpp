// Files of layers: written, and read from untrusted files.
#include "core/io/open_raster.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/file/zip_archive.h"
#include "core/io/picture_file.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

Picture Noise(int width, int height, int seed) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = static_cast<std::uint16_t>(Hash(seed, i) % 256 * 257);
  }
  return picture;
}

std::vector<std::byte> Bytes(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}
std::string Text(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<RasterLayer> TwoLayers() {
  return {{"lines <\"&\"> over it", *EncodePng(Noise(40, 30, 1)), 0.5, false, true, false},
          {"paint", *EncodePng(Noise(40, 30, 2)), 1.0, true, false, true}};
}

class OpenRaster : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::vector<std::byte>& bytes) {
    EXPECT_TRUE(WriteFileAtomically(folder_ / name, bytes));
    return folder_ / name;
  }
  std::filesystem::path WriteZip(const std::string& name, const std::vector<ZipEntry>& entries) {
    return Write(name, *EncodeZip(entries, name));
  }
  const TemporaryFolder folder_;
};

TEST_F(OpenRaster, TypeComesFirstAndUnpacked) {
  const auto bytes = EncodeOpenRaster(TwoLayers(), Noise(40, 30, 3), 300, "a.ora");
  ASSERT_TRUE(bytes) << bytes.error().message;
  // The local header is 30 bytes; then the name and, with nothing between them, the bytes.
  EXPECT_EQ(Text(*bytes).substr(0, 4), "PK\3\4");
  EXPECT_EQ(Text(*bytes).substr(30, 24), "mimetypeimage/openraster");
  const auto zip = ZipReader::Open(Write("a.ora", *bytes));
  ASSERT_TRUE(zip) << zip.error().message;
  EXPECT_EQ(zip->names(), (std::vector<std::string>{"mimetype", "stack.xml", "data/layer00.png", "data/layer01.png",
                                                    "mergedimage.png", "Thumbnails/thumbnail.png"}));
  const std::string stack = Text(*zip->Read("stack.xml", 10000));
  for (const char* part : {"w=\"40\" h=\"30\"", "mypaint:frame-active=\"true\"", "xres=\"300\" yres=\"300\"",
                           "name=\"lines &lt;&quot;&amp;&quot;> over it\"", "opacity=\"0.50\" visibility=\"hidden\"",
                           "edit-locked=\"true\"", "selected=\"true\""}) {
    EXPECT_NE(stack.find(part), std::string::npos) << part << "\n" << stack;
  }
  EXPECT_LT(stack.find("\"lines"), stack.find("\"paint\"")) << "the topmost first";
}

TEST_F(OpenRaster, SameBytesInAnyTimeZone) {
  const auto make = [](const char* zone) {
    ::setenv("TZ", zone, 1);
    return *EncodeOpenRaster(TwoLayers(), Noise(40, 30, 3), 300, "a.ora");
  };
  const auto west = make("XXX+11"), east = make("XXX-12");
  ::unsetenv("TZ");
  EXPECT_EQ(west, east);
}

TEST_F(OpenRaster, TheMergedPictureIsRead) {
  const Picture merged = Noise(40, 30, 3);
  const auto path = Write("a.ora", *EncodeOpenRaster(TwoLayers(), merged, 0, "a.ora"));
  const auto read = ReadPicture(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->width, 40);
  EXPECT_EQ(read->rgba, merged.rgba);
  const auto header = InspectPicture(path);
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->width, 40);
  EXPECT_EQ(header->height, 30);
  EXPECT_EQ(header->bits, 8);
  // Krita's own files have an equal structure; the name does not matter.
  const auto krita =
      WriteZip("b.kra", {{"mimetype", Bytes("application/x-krita")}, {"mergedimage.png", *EncodePng(merged), true}});
  EXPECT_EQ(ReadPicture(krita)->rgba, merged.rgba);
}

TEST_F(OpenRaster, TheThumbnailIsSmallAndTheMeanOfItsPixels) {
  const Picture merged = Noise(1024, 512, 3);
  const auto zip = ZipReader::Open(Write("a.ora", *EncodeOpenRaster({}, merged, 0, "a.ora")));
  const auto small = DecodePicture(*zip->Read("Thumbnails/thumbnail.png", 1 << 24), "thumbnail.png");
  ASSERT_EQ(small->width, 256);
  ASSERT_EQ(small->height, 128);
  for (const auto& [x, y] : {std::pair{0, 0}, {255, 127}, {100, 3}}) {
    int sum = 0;
    for (int i = 0; i < 16; ++i) sum += merged.At(4 * x + i % 4, 4 * y + i / 4)[0];
    EXPECT_NEAR(small->At(x, y)[0], sum / 16, 129) << "within half an 8-bit step";
  }
}

TEST_F(OpenRaster, SameLayersAreFoundSame) {
  std::vector<RasterLayer> layers = TwoLayers();
  const Picture merged = Noise(40, 30, 3);
  const auto path = Write("a.ora", *EncodeOpenRaster(layers, merged, 72, "a.ora"));
  EXPECT_TRUE(SameLayers(path, layers, merged));
  EXPECT_FALSE(SameLayers(path, layers, Noise(40, 30, 4))) << "another merged picture";
  EXPECT_FALSE(SameLayers(path, std::span(layers).first(1), merged)) << "a layer more";
  const auto changed = [&](auto change) {
    std::vector<RasterLayer> others = TwoLayers();
    change(others);
    return !SameLayers(path, others, merged);
  };
  EXPECT_TRUE(changed([](auto& others) { others[0].visible = true; }));
  EXPECT_TRUE(changed([](auto& others) { others[0].opacity = 0.6; }));
  EXPECT_TRUE(changed([](auto& others) { others[1].name = "mine"; }));
  EXPECT_TRUE(changed([](auto& others) { others[1].locked = true; }));
  EXPECT_FALSE(changed([](auto&) {}));
  layers[1].png = *EncodePng(Noise(40, 30, 5));
  EXPECT_FALSE(SameLayers(path, layers, merged)) << "another layer";
  EXPECT_FALSE(SameLayers(folder_ / "none.ora", layers, merged));
}

TEST_F(OpenRaster, WhatIsNoFileOfLayersIsRefused) {
  const auto good = EncodeOpenRaster(TwoLayers(), Noise(40, 30, 3), 0, "a.ora");
  ExpectRefusal(ReadPicture(WriteZip("empty.ora", {{"mimetype", Bytes("image/openraster")}})),
                {"empty.ora", "without mergedimage.png", "export a PNG"});
  ExpectRefusal(ReadPicture(WriteZip("text.ora", {{"mergedimage.png", Bytes("no picture at all")}})),
                {"text.ora: mergedimage.png", "no PNG"});
  ExpectRefusal(ReadPicture(WriteZip("void.ora", {{"mergedimage.png", {}}})), {"void.ora: mergedimage.png", "no PNG"});
  ExpectRefusal(ReadPicture(Write("garbage.ora", Bytes("PK\3\4 and nothing that follows"))), {"garbage.ora"});
  std::vector<std::byte> png = *EncodePng(Noise(40, 30, 3));
  png.resize(png.size() / 2);
  ExpectRefusal(ReadPicture(WriteZip("half.ora", {{"mergedimage.png", png}})), {"half.ora: mergedimage.png", "ends"});
  for (std::size_t length = 5; length < good->size(); length += good->size() / 37) {
    std::vector<std::byte> cut(good->begin(), good->begin() + static_cast<std::ptrdiff_t>(length));
    ExpectRefusal(ReadPicture(Write("cut.ora", cut)), {"cut.ora"});
  }
}

TEST_F(OpenRaster, DamageIsFoundByTheChecksum) {
  const std::vector<std::byte> whole = *EncodeZip(std::vector<ZipEntry>{{"a", Bytes(std::string(1000, 'x'))}}, "a.zip");
  std::vector<std::byte> damaged = whole;
  damaged[500] = std::byte('y');
  const auto zip = ZipReader::Open(Write("a.zip", damaged));
  ASSERT_TRUE(zip);
  ExpectRefusal(zip->Read("a", 10000), {"a in ", "a.zip", "CRC"});
}

TEST_F(OpenRaster, AnEntryThatUnpacksToTooMuchIsRefused) {
  const std::size_t large = 5 << 20;
  const auto path = WriteZip("bomb.zip", {{"a", std::vector<std::byte>(large), true}});
  EXPECT_LT(std::filesystem::file_size(path), 20000u);
  const auto zip = ZipReader::Open(path);
  ASSERT_TRUE(zip);
  ExpectRefusal(zip->Read("a", large - 1), {"bomb.zip", "unpacks to more than 5242879 bytes"});
  const auto all = zip->Read("a", large);
  ASSERT_TRUE(all) << "as much as the limit is allowed";
  EXPECT_EQ(all->size(), large);
  ExpectRefusal(zip->Read("b", large), {"b in ", "bomb.zip"});
}

TEST_F(OpenRaster, APngUnpacksToItsOwnSizeAtMost) {
  std::vector<std::byte> png = *EncodePng(Noise(40, 30, 3));
  png.resize(std::size_t(64) << 20);
  ExpectRefusal(ReadPicture(WriteZip("long.ora", {{"mergedimage.png", png, true}})),
                {"mergedimage.png in ", "long.ora", "unpacks to more than"});
  // The same bytes, truncated, of a picture that declares a huge size.
  png.resize(200);
  for (int i = 16; i < 20; ++i) png[std::size_t(i)] = std::byte(0xff);
  ExpectRefusal(ReadPicture(WriteZip("huge.ora", {{"mergedimage.png", png}})),
                {"huge.ora: mergedimage.png", "4294967295×30"});
  const auto zip = ZipReader::Open(WriteZip("two.zip", {{"a", Bytes("abcdef"), true}}));
  ASSERT_TRUE(zip);
  EXPECT_EQ(Text(*zip->ReadStart("a", 4)), "abcd");
  EXPECT_EQ(Text(*zip->ReadStart("a", 6)), "abcdef");
  EXPECT_EQ(Text(*zip->ReadStart("a", 40)), "abcdef");
}

TEST_F(OpenRaster, NoFolderAndNoPipeIsTakenForAnArchive) {
  EXPECT_FALSE(IsZip(folder_.path()));
  EXPECT_FALSE(IsZip(folder_ / "none"));
  EXPECT_FALSE(IsZip(Write("short", Bytes("PK"))));
  EXPECT_TRUE(IsZip(Write("long", Bytes("PK\3\4"))));
}

}  // namespace
}  // namespace scumble
