// A file that declares more than it can hold is refused before memory is allocated; a file packed as tightly as
// possible is still read.
#include <gmock/gmock.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/guides.h"
#include "core/io/atomic_file.h"
#include "core/io/channel_file.h"
#include "core/io/exr/exr_integrity.h"
#include "core/io/exr/scanline_exr.h"
#include "core/io/guide_file.h"
#include "core/io/guides/own_guides.h"
#include "core/io/picture_file.h"
#include "core/io/png/png_integrity.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

using testing::HasSubstr;

// Guides of nothing but background: the most that any compression can do.
GuideSet Nothing(int width, int height) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kMaterial})
    guides.Add(layer);
  return guides;
}

// Replaces the first value of that attribute.
void Patch(std::vector<std::byte>& file, const std::string& attribute, std::size_t behind, std::uint32_t value) {
  const auto* const begin = reinterpret_cast<const char*>(file.data());
  const auto at =
      static_cast<std::size_t>(std::search(begin, begin + file.size(), attribute.begin(), attribute.end()) - begin);
  ASSERT_LT(at + attribute.size() + behind + 4, file.size());
  for (std::size_t i = 0; i < 4; ++i) file[at + attribute.size() + behind + i] = std::byte(value >> (8 * i));
}

class Promises : public testing::Test {
 protected:
  std::vector<std::byte> Guides(const char* compression, int side) {
    EXPECT_TRUE(WriteGuides(path_, Nothing(side, side), {false, compression}));
    return *ReadWholeFile(path_);
  }
  // Writes the file, which every reader must then refuse with a word about it.
  void ExpectRefused(const std::vector<std::byte>& file, const std::string& why) {
    ASSERT_TRUE(WriteFileAtomically(path_, file));
    EXPECT_FALSE(internal::ReadPlainGuides(path_, {}));
    EXPECT_FALSE(internal::InspectPlainGuides(path_));
    const auto guides = ReadGuides(path_);
    ASSERT_FALSE(guides);
    EXPECT_THAT(guides.error().message, HasSubstr(why));
    EXPECT_THAT(guides.error().message, HasSubstr("g.exr"));
    EXPECT_FALSE(ReadChannels(path_));
    EXPECT_FALSE(InspectGuides(path_));
    EXPECT_FALSE(internal::CheckExrIntegrity(file, "g.exr"));
    EXPECT_FALSE(CountPixels(path_));
    for (const Expected<Picture>& picture : {ReadPicture(path_), DecodePicture(file, "g.exr")}) {
      ASSERT_FALSE(picture);
      EXPECT_THAT(picture.error().message, HasSubstr(why));
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "g.exr";
};

// 28 bytes a pixel, 2²⁰ pixels, nearly all of them equal: as near to the limit of each compression as pixels come.
TEST_F(Promises, WhatIsPackedTightlyIsRead) {
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    const auto file = Guides(compression, 1024);
    EXPECT_TRUE(internal::CheckExrIntegrity(file, "g.exr")) << compression;
    const auto guides = ReadGuides(path_);
    ASSERT_TRUE(guides) << guides.error().message;
    EXPECT_EQ(guides->width(), 1024);
  }
}

// A window's last column and row stand 8 and 12 bytes behind its beginning; 16384² pixels of 28 bytes are 7.5e9 bytes,
// more than 1032 times what the file of one pixel has.
TEST_F(Promises, ExrWindowsThatNoFileOfThatSizeHolds) {
  const std::string window = std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    for (const std::uint32_t last : {16383u, 32767u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
      auto file = Guides(compression, 1);
      Patch(file, window, 8, last);
      Patch(file, window, 12, last);
      const bool is_empty = last >= 0x80000000u;  // ends before it begins: the library's business
      if (is_empty) {
        ASSERT_TRUE(WriteFileAtomically(path_, file));
        EXPECT_FALSE(ReadGuides(path_));
      } else {
        ExpectRefused(file, "promises");
      }
    }
  }
}

// A header at the beginning of a terabyte of addresses, of which a copy could not be made.
TEST_F(Promises, ExrHeadersAreReadWhereTheyStand) {
  const auto file = Guides("zip", 8);
  constexpr std::size_t kTerabyte = std::size_t(1) << 40;
  void* const start =
      ::mmap(nullptr, kTerabyte, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (start == MAP_FAILED) GTEST_SKIP() << "the system gives no terabyte of addresses";
  std::memcpy(start, file.data(), file.size());
  const std::span<const std::byte> bytes(static_cast<const std::byte*>(start), kTerabyte);
  EXPECT_NO_THROW(EXPECT_TRUE(internal::CheckExrIntegrity(bytes, "g.exr")));
  // Cut short at every place, in the header and behind it: never read beyond, which the sanitizers see.
  for (std::size_t length = 0; length < file.size(); ++length) {
    const std::vector<std::byte> cut(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length));
    static_cast<void>(internal::CheckExrIntegrity(cut, "g.exr"));
  }
  ::munmap(start, kTerabyte);
}

TEST_F(Promises, ExrAttributesOfAnotherSize) {
  auto file = Guides("zip", 2);
  Patch(file, std::string("capDate\0string\0", 15), 0, 0x6e000000u);
  ExpectRefused(file, "1845493760 bytes of its header stand beyond its end");
  file = Guides("zip", 2);
  Patch(file, std::string("screenWindowWidth\0float\0", 24), 0, 8);
  ExpectRefused(file, "no float");
  file = Guides("zip", 2);
  Patch(file, std::string("channels\0chlist\0", 16), 6, 3);  // behind the size, and the name A with its NUL
  ExpectRefused(file, "no chlist");
}

// Guides of a side with the attribute type, deepscanline, and these bits of the version, which stands at byte 4.
std::vector<std::byte> CalledDeep(int side, std::uint32_t flags) {
  const GuideSet guides = Nothing(side, side);
  internal::ExrImage image{side, side, {}, "zips", {{"tYPE", "deepscanline"}}, {}, {}};
  for (const char* name : {"normal.X", "normal.Y", "normal.Z"})
    image.channels.push_back({name, false, guides.Plane(Layer::kNormal, 0)});
  image.channels.push_back({"A", false, guides.Plane(Layer::kCoverage, 0)});
  std::vector<std::byte> file = *internal::EncodeExr("g.exr", image);
  auto* const begin = reinterpret_cast<char*>(file.data());
  const std::string name = "tYPE";  // the library would repair one that it is given
  char* const at = std::search(begin, begin + file.size(), name.begin(), name.end());
  EXPECT_NE(at, begin + file.size());
  std::memcpy(at, "type", name.size());
  file[5] |= std::byte(flags >> 8);
  return file;
}

// Without the flags 0x800 (not only images) and 0x1000 (many parts) OpenEXR takes a file for what it reads, an image of
// scan lines, whatever its type is called: it is read, and its window is believed no more than any other.
TEST_F(Promises, ImagesThatAreCalledDeepAreImages) {
  const auto file = CalledDeep(8, 0);
  ASSERT_TRUE(WriteFileAtomically(path_, file));
  GuideReadOptions options;
  options.required = {Layer::kCoverage, Layer::kNormal};
  const auto guides = ReadGuides(path_, options);
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(guides->width(), 8);
  const std::string window = std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
  for (const std::uint32_t last : {16383u, 32767u}) {
    auto large = file;
    Patch(large, window, 8, last);
    Patch(large, window, 12, last);
    ExpectRefused(large, "promises");
  }
}

// A deep pixel has any number of samples, so that nothing bounds how many a file holds; no reader makes anything of
// them.
TEST_F(Promises, DeepPixelsAreRefusedAsThat) {
  for (const std::uint32_t flags : {0x800u, 0x1000u, 0x1800u}) ExpectRefused(CalledDeep(8, flags), "deep pixels");
}

// A PNG's header has its sides at bytes 16 and 20, and its sum follows.
TEST(PromisesOfPng, SidesThatNoDataOfThatSizeFills) {
  for (const std::uint32_t side : {2048u, 16384u, 32768u, 0x7fffffffu}) {
    auto file = *EncodePng(Picture(4, 4), 0);
    for (std::size_t i = 0; i < 4; ++i) file[16 + i] = file[20 + i] = std::byte(side >> (24 - 8 * i));
    std::uint32_t sum = 0xffffffffu;  // PNG specification, third edition, annex D
    for (std::size_t i = 12; i < 29; ++i) {
      sum ^= std::to_integer<std::uint32_t>(file[i]);
      for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0);
    }
    for (std::size_t i = 0; i < 4; ++i) file[29 + i] = std::byte(~sum >> (24 - 8 * i));
    const auto picture = DecodePicture(file, "p.png");
    ASSERT_FALSE(picture) << side;
    EXPECT_THAT(picture.error().message, HasSubstr("p.png: the PNG file ends before its picture does"));
  }
}

TEST(PromisesOfPng, WhatIsPackedTightlyIsRead) {
  const auto file = *EncodePng(Picture(2048, 2048), 0);
  EXPECT_TRUE(internal::CheckPngIntegrity(file, "p.png"));
  EXPECT_TRUE(DecodePicture(file, "p.png"));
}

// --- Formats that OpenImageIO reads
// ------------------------------------------------------------------------------------

std::vector<std::byte> BytesOf(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}
std::vector<std::byte> BytesOf(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

struct Claim {
  const char* name;
  std::vector<std::byte> header;  // of 16384 x 16384 pixels
};

std::vector<Claim> Claims() {
  return {
      {"p.ppm", BytesOf("P6\n16384 16384\n255\n")},
      {"p.pbm", BytesOf("P4\n16384 16384\n")},
      {"p.pfm", BytesOf("PF\n16384 16384\n-1.0\n")},
      {"p.hdr", BytesOf("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n")},
      {"p.tga", BytesOf({0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 64, 0, 64, 32, 8})},
      {"p.bmp", BytesOf({'B', 'M', 0, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0, 0, 64, 0, 0, 0, 64, 0, 0, 1,
                         0,   24,  0, 0, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0})},
  };
}

// By the formats' bounds, a file of some kilobytes may declare at most 512 times as many samples: far less than these.
TEST(PromisesOfPictures, SidesThatNoFileOfThatSizeHolds) {
  const TemporaryFolder folder;
  for (Claim& claim : Claims()) {
    claim.header.resize(claim.header.size() + 4096);
    const auto refused = [&](const Expected<Picture>& picture) {
      ASSERT_FALSE(picture) << claim.name;
      EXPECT_THAT(picture.error().message, HasSubstr(claim.name));
      EXPECT_THAT(picture.error().message, HasSubstr("it promises 16384×16384 pixels"));
      EXPECT_THAT(picture.error().message, HasSubstr(std::to_string(claim.header.size()) + " bytes"));
    };
    ASSERT_TRUE(WriteFileAtomically(folder / claim.name, claim.header));
    refused(ReadPicture(folder / claim.name));
    if (std::string_view(claim.name) != "p.tga") refused(DecodePicture(claim.header, claim.name));
  }
}

// Readers that take memory as they open a file: all of a BMP that is packed by runs, 65535 rows of 65535 channels of an
// SGI, which is not read at all. That of GIF draws at once, here on none of 32768² pixels, as 4 · 2³⁰ bytes are 0 in 32
// bits. A TGA's colours are looked up in its palette, however short it is and wherever it starts.
TEST(PromisesOfPictures, HeadersThatCostAsTheyAreOpened) {
  const auto refused = [](std::vector<std::byte> header, const char* name, const char* why) {
    header.resize(header.size() + 4096);
    const auto picture = DecodePicture(header, name);
    ASSERT_FALSE(picture) << name;
    EXPECT_THAT(picture.error().message, HasSubstr(why));
  };
  refused(BytesOf({1, 218, 1, 1, 0, 3, 0, 4, 255, 255, 255, 255}), "p.sgi", "it is an SGI");
  refused(BytesOf({'G', 'I', 'F', '8', '9', 'a', 0, 128, 0, 128, 128, 0, 0, 0,    0, 0, 9,  9,
                   9,   ',', 0,   0,   0,   0,   1, 0,   1, 0,   0,   2, 2, 0x4c, 1, 0, ';'}),
          "p.gif", "it is a GIF");
  const auto indexed = [](int first, int colors, int bits) {
    return BytesOf({0, 1, 1, first, 0, colors % 256, colors / 256, 24, 0, 0, 0, 0, 4, 0, 4, 0, bits, 32});
  };
  refused(indexed(0, 255, 8), "p.tga", "palette");
  refused(indexed(1, 256, 8), "p.tga", "palette");
  refused(indexed(0, 256, 16), "p.tga", "palette");
  auto whole = indexed(0, 256, 8);
  whole.resize(whole.size() + 3 * 256 + 16);
  EXPECT_TRUE(DecodePicture(whole, "p.tga"));
  for (const int packing : {1, 2}) {
    refused(BytesOf({'B', 'M', 0,   0,   0, 0, 0,   0,   0, 0, 54, 0, 0, 0, 40,     0,
                     0,   0,   255, 255, 0, 0, 255, 255, 0, 0, 1,  0, 8, 0, packing}),
            "p.bmp", "packed by runs");
  }
}

// Highest byte first.
std::string Big(std::uint64_t number, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(number >> (8 * i));
  return text;
}

// A PSD, or with version 2 a PSB, of 2 × 1 pixels. Its sections are without the lengths that stand before them.
struct PsdFile {
  int version = 1, channels = 3, depth = 8, mode = 3;
  std::string palette{}, resources{}, layers{};
  std::string pixels = {0, 0, '\xc8', 10, 'd', 20, '2', 30};  // as they are: 200 and 10 of red, 100 and 20, 50 and 30

  int Digits() const { return 4 * version; }
  std::vector<std::byte> Bytes() const {
    return BytesOf("8BPS" + Big(std::uint64_t(version), 2) + Big(0, 6) + Big(std::uint64_t(channels), 2) + Big(1, 4) +
                   Big(2, 4) + Big(std::uint64_t(depth), 2) + Big(std::uint64_t(mode), 2) + Big(palette.size(), 4) +
                   palette + Big(resources.size(), 4) + resources + Big(layers.size(), Digits()) + layers + pixels);
  }
  // Layers with one of that many rows, which has 2 bytes of pixels, and additional information of a length.
  static std::string Layers(int version, int count, std::uint64_t rows, std::uint64_t more = 0) {
    const int digits = 4 * version;
    const std::string extra = std::string(12, '\0') + "8BIMLr16" + Big(more, digits);
    const std::string rectangle = Big(0, 8) + Big(rows, 4) + Big(1, 4), channel = Big(0, 2) + Big(4, digits);
    const std::string info = Big(std::uint64_t(count), 2) + rectangle + Big(1, 2) + channel + "8BIMnorm" + Big(0, 4) +
                             Big(extra.size(), 4) + extra + Big(0, 4);
    return Big(info.size(), digits) + info;
  }
};
std::string Resource(int id, const std::string& bytes, std::uint64_t length) {
  return "8BIM" + Big(std::uint64_t(id), 2) + Big(0, 2) + Big(length, 4) + bytes;
}

void ExpectThePixels(const Expected<Picture>& picture, int alpha_of_second = 255) {
  ASSERT_TRUE(picture) << picture.error().message;
  ASSERT_EQ(picture->width, 2);
  ASSERT_EQ(picture->height, 1);
  const int expected[2][4] = {{200, 100, 50, 255}, {10, 20, 30, 255}};
  for (int c = 0; c < 4; ++c) EXPECT_EQ(picture->At(0, 0)[c], 257 * expected[0][c]) << c;
  if (alpha_of_second == 0) {
    EXPECT_EQ(picture->At(1, 0)[3], 0);
    return;
  }
  for (int c = 0; c < 4; ++c) EXPECT_EQ(picture->At(1, 0)[c], 257 * expected[1][c]) << c;
}

// The flattened picture stands behind all that layers and notes claim, and is there: it is read, whatever they say. 2³¹
// rows of a layer were 17 GB of their places; profile, thumbnail and notes of 4 GB as many bytes, and a thumbnail of
// less than its own header 4 GB too; names that never end, and information whose length leads back to itself, a loop.
TEST(PromisesOfPsd, NothingButTheFlattenedPictureIsLookedAt) {
  const TemporaryFolder folder;
  std::vector<PsdFile> files(1);
  for (const int version : {1, 2}) {
    files.push_back({.version = version, .layers = PsdFile::Layers(version, 1, 2)});
    files.push_back({.version = version, .layers = PsdFile::Layers(version, 32767, 0x7fffffff)});
    files.push_back({.version = version, .layers = PsdFile::Layers(version, 1, 0x80000000u, ~std::uint64_t{0} - 23)});
    files.push_back({.version = version, .layers = Big(0x7fffffff, 4 * version)});
  }
  for (const int id : {1005, 1006, 1010, 1033, 1036, 1039, 1047, 1058, 1059, 1060, 1064}) {
    files.push_back({.resources = Resource(id, "", 0xf0000000u)});
    files.push_back({.resources = Resource(id, "\xc8", 1) + '\0'});
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    SCOPED_TRACE(i);
    const auto bytes = files[i].Bytes();
    ExpectThePixels(DecodePicture(bytes, "p.psd"));
    ASSERT_TRUE(WriteFileAtomically(folder / "p.psd", bytes));
    ExpectThePixels(ReadPicture(folder / "p.psd"));
  }
}

// A negative number of layers means that the fourth channel is alpha, if there is one. Resolution is kept: 300 an inch.
TEST(PromisesOfPsd, AlphaAndResolutionAreKept) {
  const TemporaryFolder folder;
  for (const int version : {1, 2}) {
    PsdFile file{.version = version, .layers = PsdFile::Layers(version, -1, 2)};
    ExpectThePixels(DecodePicture(file.Bytes(), "p.psd"));  // there is no fourth
    file.channels = 4, file.pixels += std::string{'\xff', 0};
    ExpectThePixels(DecodePicture(file.Bytes(), "p.psd"), 0);
    file.layers = PsdFile::Layers(version, 1, 2);
    ExpectThePixels(DecodePicture(file.Bytes(), "p.psd"));
    const std::string dots = Big(300u << 16, 4) + Big(1, 2) + Big(1, 2);
    file.resources = Resource(1000, "odd", 3) + '\0' + Resource(1005, dots + dots, 16);
    ASSERT_TRUE(WriteFileAtomically(folder / "p.psd", file.Bytes()));
    const auto header = InspectPicture(folder / "p.psd");
    ASSERT_TRUE(header) << header.error().message;
    EXPECT_EQ(header->dpi, 300.0);
    EXPECT_EQ(header->width, 2);
  }
}

// Colours of transparent pixels are stored over white.
TEST(PromisesOfPsd, ColoursUnderAlphaAreThoseOfThePainting) {
  PsdFile file{.channels = 4, .layers = PsdFile::Layers(1, -1, 2)};
  file.pixels.assign(2, 0);  // not packed
  for (const int color : {200, 100, 50}) {
    for (const int alpha : {51, 204}) file.pixels += static_cast<char>((color * alpha + 255 * (255 - alpha)) / 255);
  }
  file.pixels += std::string{'\x33', '\xcc'};
  const auto picture = DecodePicture(file.Bytes(), "p.psd");
  ASSERT_TRUE(picture) << picture.error().message;
  for (int x = 0; x < 2; ++x) {
    const int expected[] = {200, 100, 50, x == 0 ? 51 : 204};
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(picture->At(x, 0)[c] / 257.0, expected[c], x == 0 ? 5.0 : 1.5) << x << c;
  }
}

// By the palette, 256 values of red, then of green, then of blue; opaque but for the transparent colour.
TEST(PromisesOfPsd, IndexedColoursAreThoseOfThePalette) {
  std::string palette(768, '\0');
  palette[7] = '\xc8', palette[256 + 7] = 'd', palette[512 + 7] = '2';
  palette[9] = 10, palette[256 + 9] = 20, palette[512 + 9] = 30;
  PsdFile file{.channels = 1, .mode = 2, .palette = palette, .pixels = {0, 0, 7, 9}};
  ExpectThePixels(DecodePicture(file.Bytes(), "p.psd"));
  file.resources = Resource(1047, Big(9, 2), 2);
  ExpectThePixels(DecodePicture(file.Bytes(), "p.psd"), 0);
}

TEST(PromisesOfPsd, SectionsAndRowsThatTheFileDoesNotHold) {
  const auto refused = [](const std::vector<std::byte>& bytes, const char* why) {
    const auto picture = DecodePicture(bytes, "p.psd");
    ASSERT_FALSE(picture);
    EXPECT_THAT(picture.error().message, HasSubstr("p.psd"));
    EXPECT_THAT(picture.error().message, HasSubstr(why));
  };
  for (const int version : {1, 2}) {
    const PsdFile file{.version = version};
    const auto whole = file.Bytes();
    for (std::size_t length = 26; length < whole.size(); ++length) {
      refused({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}, "promises more than its");
    }
    // The lengths of palette, resources and layers stand at bytes 26, 30 and 34.
    for (const std::size_t at : {26, 30, 34}) {
      auto bytes = whole;
      for (int i = 0; i < (at == 34 ? file.Digits() : 4); ++i) bytes[at + std::size_t(i)] = std::byte(0xff);
      bytes.resize(bytes.size() + 4096);
      refused(bytes, "promises more than its");
    }
    // Packed, each of the three rows is two bytes, once.
    PsdFile packed = file;
    packed.pixels = Big(1, 2);
    for (int row = 0; row < 3; ++row) packed.pixels += Big(row == 0 ? 3 : 2, 2 * version);
    packed.pixels += std::string{1, '\xc8', 10, '\xff', 'd', '\xff', '2'};
    const auto picture = DecodePicture(packed.Bytes(), "p.psd");
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_EQ(picture->At(1, 0)[0], 10 * 257);
    EXPECT_EQ(picture->At(1, 0)[1], 100 * 257);
    packed.pixels[std::size_t(2 + 2 * version - 1)] = 4;
    refused(packed.Bytes(), "promises more than its");
  }
  // 16384² pixels, as in Claims(), and 2³² − 1 of them.
  auto bytes = PsdFile{}.Bytes();
  for (const std::size_t at : {16, 20}) bytes[at] = std::byte(64), bytes[at + 1] = std::byte(0);
  refused(bytes, "promises more than its");
  for (std::size_t at = 14; at < 22; ++at) bytes[at] = std::byte(0xff);
  refused(bytes, "expected one flat picture");
  // Missing data would be read: of one channel three, of eight bits a pixel one.
  for (const PsdFile& file : {PsdFile{.channels = 1}, PsdFile{.channels = 3, .mode = 4}, PsdFile{.channels = 57},
                              PsdFile{.depth = 1}, PsdFile{.depth = 1, .mode = 2}, PsdFile{.depth = 16, .mode = 2}}) {
    refused(file.Bytes(), "do not fit its colours");
  }
}

// As near to the bounds as pixels come: a bit each in P4, and runs of 128 in Targa.
TEST(PromisesOfPictures, WhatIsPackedTightlyIsRead) {
  auto bits = BytesOf("P4\n1024 512\n");
  bits.resize(bits.size() + 1024 * 512 / 8);
  const auto white = DecodePicture(bits, "p.pbm");
  ASSERT_TRUE(white) << white.error().message;
  EXPECT_EQ(white->width, 1024);
  const TemporaryFolder folder;
  // Of a palette with alpha, 1024 x 512, its first colour.
  auto runs = BytesOf({0, 1, 9, 0, 0, 0, 1, 32, 0, 0, 0, 0, 0, 4, 0, 2, 8, 8, 30, 20, 10, 255});
  runs.resize(runs.size() + 4 * 255);
  for (int i = 0; i < 1024 * 512 / 128; ++i) runs.insert(runs.end(), {std::byte(0xff), std::byte(0)});
  ASSERT_TRUE(WriteFileAtomically(folder / "p.tga", runs));
  const auto plain = ReadPicture(folder / "p.tga");
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->At(1023, 511)[0], 10 * 257);
  EXPECT_EQ(plain->At(1023, 511)[2], 30 * 257);
}

}  // namespace
}  // namespace scumble
