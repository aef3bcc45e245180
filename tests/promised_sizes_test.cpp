// What a file promises and cannot hold is refused before memory is taken for it; what is packed as tightly as it can be
// is read all the same.
#include <gmock/gmock.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/guides.h"
#include "io/atomic_file.h"
#include "io/channel_file.h"
#include "io/exr_file.h"
#include "io/guide_file.h"
#include "io/picture_file.h"
#include "io/plain_guides.h"
#include "io/whole_exr.h"
#include "io/whole_png.h"
#include "temporary_folder.h"

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
    EXPECT_FALSE(internal::CheckExrPromises(file, "g.exr"));
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "g.exr";
};

// 28 bytes a pixel, 2²⁰ pixels, and nearly all of them the same: as near to the limit of each compression as pixels
// come.
TEST_F(Promises, WhatIsPackedTightlyIsRead) {
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    const auto file = Guides(compression, 1024);
    EXPECT_TRUE(internal::CheckExrPromises(file, "g.exr")) << compression;
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
  EXPECT_NO_THROW(EXPECT_TRUE(internal::CheckExrPromises(bytes, "g.exr")));
  // Cut short at every place, in the header and behind it: never read beyond, which the sanitizers see.
  for (std::size_t length = 0; length < file.size(); ++length) {
    const std::vector<std::byte> cut(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length));
    static_cast<void>(internal::CheckExrPromises(cut, "g.exr"));
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

// A PNG's header says its sides at bytes 16 and 20, and its sum follows.
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
  EXPECT_TRUE(internal::CheckPngIsWhole(file, "p.png"));
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
      {"p.psd", BytesOf({'8', 'B', 'P', 'S', 0, 1, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 64, 0, 0, 0,
                         64,  0,   0,   8,   0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0})},
      {"p.dds",
       BytesOf({'D', 'D', 'S', ' ', 124, 0, 0, 0, 7, 16, 8, 0, 0, 64, 0, 0, 0, 64, 0, 0, 0,  0, 0, 0, 0, 0,  0, 0,
                1,   0,   0,   0,   0,   0, 0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0,  0, 0, 0, 0, 0,  0, 0,
                0,   0,   0,   0,   0,   0, 0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 32, 0, 0, 0, 4, 0,  0, 0,
                'D', 'X', 'T', '1', 0,   0, 0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0,  0, 0, 0, 0, 16, 0, 0})},
      {"p.sgi", BytesOf({1, 218, 0, 1, 0, 3, 64, 0, 64, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 255})},
  };
}

// What the formats' bounds let a file of some kilobytes promise is at most 512 times as many samples: far less than
// these.
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
    if (std::string_view(claim.name) != "p.tga" && std::string_view(claim.name) != "p.sgi")
      refused(DecodePicture(claim.header, claim.name));
  }
}

// Readers that take memory as they open a file: 65535 rows of 65535 channels of an SGI, 4 GiB of palette of a PSD, and
// all of a BMP that is packed by runs.
TEST(PromisesOfPictures, HeadersThatCostAsTheyAreOpened) {
  const auto refused = [](std::vector<std::byte> header, const char* name, const char* why) {
    header.resize(header.size() + 4096);
    const auto picture = DecodePicture(header, name);
    ASSERT_FALSE(picture) << name;
    EXPECT_THAT(picture.error().message, HasSubstr(why));
  };
  refused(BytesOf({1, 218, 1, 1, 0, 3, 0, 4, 255, 255, 255, 255}), "p.sgi", "promises more than its");
  refused(BytesOf({'8', 'B', 'P', 'S', 0, 1, 0, 0, 0, 0, 0, 0,   0,   1,   0,
                   0,   0,   4,   0,   0, 0, 4, 0, 8, 0, 2, 255, 255, 255, 255}),
          "p.psd", "promises more than its");
  for (const int packing : {1, 2}) {
    refused(BytesOf({'B', 'M', 0,   0,   0, 0, 0,   0,   0, 0, 54, 0, 0, 0, 40,     0,
                     0,   0,   255, 255, 0, 0, 255, 255, 0, 0, 1,  0, 8, 0, packing}),
            "p.bmp", "packed by runs");
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
  // Of a palette of one colour with alpha, 1024 x 512.
  auto runs = BytesOf({0, 1, 9, 0, 0, 1, 0, 32, 0, 0, 0, 0, 0, 4, 0, 2, 8, 8, 30, 20, 10, 255});
  for (int i = 0; i < 1024 * 512 / 128; ++i) runs.insert(runs.end(), {std::byte(0xff), std::byte(0)});
  ASSERT_TRUE(WriteFileAtomically(folder / "p.tga", runs));
  const auto plain = ReadPicture(folder / "p.tga");
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->At(1023, 511)[0], 10 * 257);
  EXPECT_EQ(plain->At(1023, 511)[2], 30 * 257);
}

}  // namespace
}  // namespace scumble
