// PNG without the picture library: pixels and texts equal to the library's, and equal bytes for any threads.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/format_dispatch.h"
#include "core/io/parallel.h"
#include "core/io/png/png_filter.h"
#include "core/io/png/png_integrity.h"
#include "core/io/png/png_reader.h"
#include "core/io/png_writer.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using internal::PngOptions;

// Noise, or a picture that is smooth: one packs better without a filter, the other with one.
Picture Make(int width, int height, int bits, bool smooth) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 4; ++c) {
        const std::uint64_t value = smooth ? std::uint64_t(x * 3 + y * 5 + c * 40) : Hash(x / 4, y / 3, c, width);
        picture.At(x, y)[c] =
            static_cast<std::uint16_t>(bits == 8 ? value % 256 * 257 : value * (smooth ? 97 : 1) % 65536);
      }
    }
  }
  return picture;
}

Picture Grey(Picture picture) {
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    picture.rgba[i + 1] = picture.rgba[i + 2] = picture.rgba[i];
    picture.rgba[i + 3] = 65535;
  }
  return picture;
}

// By the picture library, whatever the file is.
Expected<Picture> ReadByLibrary(const fs::path& path) {
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats("a test"));
  return formats->read_picture(path, "", Profiles::kApply, nullptr);
}

// Channels and header without the library are those that it reads.
void ExpectAsLibrary(const std::vector<std::byte>& bytes, const fs::path& file) {
  const auto plain = internal::ReadPlainPngChannels(bytes, file.string());
  const auto header = internal::PlainPngHeader(bytes);
  ASSERT_TRUE(plain && header);
  const auto formats = LoadFormats("a test");
  ASSERT_TRUE(formats);
  const auto channels = (*formats)->read_channels(file);
  ASSERT_TRUE(channels) << channels.error().message;
  EXPECT_EQ(plain->names, channels->names);
  EXPECT_EQ(plain->name, channels->name);
  EXPECT_EQ(plain->width, channels->width);
  EXPECT_EQ(plain->height, channels->height);
  EXPECT_TRUE(plain->planes == channels->planes);
  const auto told = (*formats)->inspect_picture(file);
  ASSERT_TRUE(told) << told.error().message;
  EXPECT_EQ(header->width, told->width);
  EXPECT_EQ(header->height, told->height);
  EXPECT_EQ(header->bits, told->bits);
  EXPECT_EQ(header->dpi, told->dpi);
}

void ExpectHolds(const std::vector<std::byte>& bytes, const Picture& picture) {
  EXPECT_TRUE(internal::CheckPngIntegrity(bytes, "p.png"));
  const auto plain = internal::ReadPlainPng(bytes);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->width, picture.width);
  EXPECT_EQ(plain->height, picture.height);
  EXPECT_TRUE(plain->rgba == picture.rgba);
  TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "p.png", bytes));
  const auto library = ReadByLibrary(folder / "p.png");
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_TRUE(library->rgba == picture.rgba);
  ExpectAsLibrary(bytes, folder / "p.png");
}

struct Shape {
  int width, height;
};
class PngShapes : public ::testing::TestWithParam<Shape> {};

TEST_P(PngShapes, AnyThreadsSameBytesAndTheyHoldThePicture) {
  const auto [width, height] = GetParam();
  for (const int bits : {8, 16}) {
    for (const int level : {0, 1, 9}) {
      for (const bool smooth : {false, true}) {
        SCOPED_TRACE(std::to_string(bits) + " bits, level " + std::to_string(level) +
                     (smooth ? ", smooth" : ", noise"));
        const Picture picture = Make(width, height, bits, smooth);
        PngOptions options{bits, false, level, 0, "", 1};
        const auto bytes = internal::WritePng(picture, options);
        ExpectHolds(bytes, picture);
        for (const int threads : {2, 3, 0}) {
          options.threads = threads;
          EXPECT_TRUE(internal::WritePng(picture, options) == bytes) << threads << " threads";
        }
        options.grey = true;
        ExpectHolds(internal::WritePng(picture, options), Grey(picture));
      }
    }
  }
}
// A row of the widest is more than a band, a hundred rows of 1,000 pixels are two, 300 are five.
INSTANTIATE_TEST_SUITE_P(All, PngShapes,
                         ::testing::Values(Shape{1, 1}, Shape{1, 300}, Shape{301, 1}, Shape{37, 23}, Shape{1000, 100},
                                           Shape{1000, 300}, Shape{32768, 3}),
                         [](const auto& shape) {
                           return std::to_string(shape.param.width) + "x" + std::to_string(shape.param.height);
                         });

// So many bytes are left of 8-bit rows as they are.
std::size_t PackedUnfiltered(const Picture& picture) {
  const std::vector<std::uint8_t> bytes = In8Bits(picture);
  std::vector<Bytef> out(compressBound(bytes.size()));
  uLongf size = out.size();
  EXPECT_EQ(compress2(out.data(), &size, bytes.data(), bytes.size(), 6), Z_OK);
  return size;
}

TEST(PngWriter, PacksSmoothPicturesByAFilterAndCopiesWithoutOne) {
  Picture tiled(640, 640), smooth(640, 640);
  for (int y = 0; y < 640; ++y) {
    for (int x = 0; x < 640; ++x) {
      for (int c = 0; c < 4; ++c) {
        tiled.At(x, y)[c] = static_cast<std::uint16_t>(Hash(x % 64, y % 8, c) % 256 * 257);
        smooth.At(x, y)[c] = static_cast<std::uint16_t>((x * x / 97 + y * y / 89 + Hash(x, y, c) % 3) % 256 * 257);
      }
    }
  }
  EXPECT_LT(internal::WritePng(tiled, {}).size(), PackedUnfiltered(tiled) * 11 / 10);
  EXPECT_LT(internal::WritePng(smooth, {}).size(), PackedUnfiltered(smooth) * 3 / 4);
}

TEST(PngWriter, MoreEffortLessBytes) {
  const Picture picture = Make(500, 400, 8, false);
  std::vector<std::size_t> sizes;
  for (const int level : {0, 1, 9}) sizes.push_back(internal::WritePng(picture, {8, false, level, 0, "", 2}).size());
  EXPECT_GT(sizes[0], 500u * 400u * 4u) << "level 0 stores";
  EXPECT_GT(sizes[0], sizes[1]);
  EXPECT_GT(sizes[1], sizes[2]);
}

// A file's texts beside its pixels, as the picture library reads them.
std::map<std::string, std::string> Said(const fs::path& path) {
  std::map<std::string, std::string> said;
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) return said;
  for (const OIIO::ParamValue& value : input->spec().extra_attribs) {
    said[std::string(value.name())] = value.get_string();
  }
  return said;
}

TEST(PngWriter, SaysWhatThePictureLibraryWouldSay) {
  TemporaryFolder folder;
  const Picture picture = Make(8, 8, 8, false);
  for (const int dpi : {0, 72, 300, 601}) {
    for (const std::string settings : {"", "scumble 1; seed 0; style Öl"}) {
      OIIO::ImageSpec spec(8, 8, 4, OIIO::TypeDesc::UINT8);
      spec.attribute("oiio:ColorSpace", "sRGB");
      spec.attribute("oiio:UnassociatedAlpha", 1);
      spec.attribute("DateTime", "");
      if (dpi > 0) {
        spec.attribute("XResolution", static_cast<float>(dpi));
        spec.attribute("YResolution", static_cast<float>(dpi));
        spec.attribute("ResolutionUnit", "in");
      }
      if (!settings.empty()) spec.attribute(kSettingsKey, settings);
      const std::string by_library = (folder / "library.png").string();
      auto output = OIIO::ImageOutput::create(by_library);
      ASSERT_TRUE(output && output->open(by_library, spec));
      ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT16, picture.rgba.data()) && output->close());
      ASSERT_TRUE(
          WriteFileAtomically(folder / "ours.png", internal::WritePng(picture, {8, false, 6, dpi, settings, 1})));
      EXPECT_EQ(Said(folder / "ours.png"), Said(by_library)) << dpi << " dpi, settings '" << settings << "'";
      ExpectAsLibrary(*ReadWholeFile(folder / "ours.png"), folder / "ours.png");
      // From OpenImageIO 2.5 on its files hold more, which is left to it.
      if (OIIO_VERSION < 20500) ExpectAsLibrary(*ReadWholeFile(by_library), by_library);
    }
  }
}

// ---- reading -----------------------------------------------------------------------------------------------------

struct PngKind {
  int type, bits;
  bool interlaced = false, transparent = false;
  double gamma = 0;
  std::string key = "", text = "";
  int offset = 0;
  std::string exif = "";
};

using namespace std::string_literals;
const std::string kEmptyExif = "MM\0*\0\0\0\x08\0\0\0\0\0\0"s, kEmptyExifBackwards = "II*\0\x08\0\0\0\0\0\0\0\0\0"s;
const std::string kTurned = "MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"s;

// A file of that kind with noise in it, by libpng.
void Write(const fs::path& path, const PngKind& kind, int width, int height) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  ASSERT_TRUE(file);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), kind.bits, kind.type,
               kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const int colors = 1 << std::min(kind.bits, 8);
  if (kind.type == PNG_COLOR_TYPE_PALETTE) {
    std::vector<png_color> palette(static_cast<std::size_t>(colors));
    std::vector<png_byte> alphas(palette.size());
    for (std::size_t i = 0; i < palette.size(); ++i) {
      const auto byte = [&](int c) { return static_cast<png_byte>(Hash(i, c) % 256); };
      palette[i] = {byte(0), byte(1), byte(2)}, alphas[i] = byte(3);
    }
    png_set_PLTE(png, info, palette.data(), colors);
    if (kind.transparent) png_set_tRNS(png, info, alphas.data(), colors / 2, nullptr);
  } else if (kind.transparent) {
    png_color_16 clear{0, 1, 2, 3, 1};
    png_set_tRNS(png, info, nullptr, 0, &clear);
  }
  if (kind.gamma > 0) png_set_gAMA(png, info, kind.gamma);
  if (kind.offset != 0) png_set_oFFs(png, info, kind.offset, 0, PNG_OFFSET_PIXEL);
  std::vector<png_byte> exif(kind.exif.begin(), kind.exif.end());
  if (!exif.empty()) png_set_eXIf_1(png, info, png_uint_32(exif.size()), exif.data());
  std::string key = kind.key, words = kind.text;
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_NONE, text.key = key.data(), text.text = words.data();
  text.text_length = words.size();
  if (!key.empty()) png_set_text(png, info, &text, 1);
  png_write_info(png, info);
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  std::vector<png_byte> bytes(row_bytes * std::size_t(height));
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<png_byte>(Hash(i, kind.type) % (kind.transparent ? 4 : 256));
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y) rows.push_back(bytes.data() + row_bytes * std::size_t(y));
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

constexpr int kG = PNG_COLOR_TYPE_GRAY, kGa = PNG_COLOR_TYPE_GRAY_ALPHA, kRgb = PNG_COLOR_TYPE_RGB,
              kRgba = PNG_COLOR_TYPE_RGB_ALPHA, kPalette = PNG_COLOR_TYPE_PALETTE;

TEST(PngReader, ReadsEveryKindAsThePictureLibraryDoes) {
  const std::vector<PngKind> kinds = {{kG, 1},
                                      {kG, 2},
                                      {kG, 4},
                                      {kG, 8},
                                      {kG, 16},
                                      {kGa, 8},
                                      {kGa, 16},
                                      {kRgb, 8},
                                      {kRgb, 16},
                                      {kRgba, 8},
                                      {kRgba, 16},
                                      {kPalette, 1},
                                      {kPalette, 2},
                                      {kPalette, 4},
                                      {kPalette, 8},
                                      {kPalette, 8, false, true},
                                      {kPalette, 4, true, true},
                                      {kRgb, 8, false, true},
                                      {kG, 8, false, true},
                                      {kRgb, 16, false, true},
                                      {kG, 2, false, true},
                                      {kRgba, 8, true},
                                      {kRgba, 16, true},
                                      {kG, 1, true},
                                      {kRgba, 8, false, false, 1 / 2.2},
                                      {kRgb, 8, false, false, 1 / 1.8},
                                      {kRgb, 8, false, false, 0, "Comment", "a word"},
                                      {kRgba, 16, false, false, 0, "scumble:settings", "seed 1"},
                                      {kRgb, 8, false, false, 0, "oiio:ColorSpace", "sRGB"},
                                      {kRgb, 8, false, false, 0, "", "", 0, kEmptyExif},
                                      {kG, 16, false, false, 0, "", "", 0, kEmptyExifBackwards}};
  TemporaryFolder folder;
  for (const PngKind& kind : kinds) {
    for (const auto& [width, height] : {Shape{1, 1}, Shape{19, 13}, Shape{7, 40}}) {
      SCOPED_TRACE("type " + std::to_string(kind.type) + ", " + std::to_string(kind.bits) + " bits, " +
                   std::to_string(width) + "×" + std::to_string(height) + (kind.interlaced ? ", interlaced" : "") +
                   (kind.transparent ? ", transparent" : "") + kind.key);
      Write(folder / "p.png", kind, width, height);
      const auto plain = internal::ReadPlainPng(*ReadWholeFile(folder / "p.png"));
      const auto library = ReadByLibrary(folder / "p.png");
      ASSERT_TRUE(plain);
      ASSERT_TRUE(library) << library.error().message;
      EXPECT_EQ(plain->width, library->width);
      EXPECT_TRUE(plain->rgba == library->rgba);
      ExpectAsLibrary(*ReadWholeFile(folder / "p.png"), folder / "p.png");
      const auto head = internal::InspectPlainPng(*ReadWholeFile(folder / "p.png"));
      const auto stored = (*LoadFormats("a test"))->inspect_stored(folder / "p.png");
      ASSERT_TRUE(head && stored);
      EXPECT_EQ(std::tie(head->width, head->height, head->channels, head->bits, head->settings),
                std::tie(stored->width, stored->height, stored->channels, stored->bits, stored->settings));
    }
  }
}

TEST(PngReader, LeavesToThePictureLibraryWhatSaysMore) {
  TemporaryFolder folder;
  for (const PngKind& kind :
       {PngKind{kRgb, 8, false, false, 1.0}, PngKind{kRgb, 8, false, false, 0, "oiio:ColorSpace", "Linear"},
        PngKind{kRgb, 8, false, false, 0, "XML:com.adobe.xmp", "<x/>"},
        PngKind{kRgb, 8, false, false, 0, "Raw profile type exif", "\nexif\n 1\n00\n"},
        PngKind{kRgb, 8, false, false, 0, "Orientation", "6"}, PngKind{kRgb, 8, false, false, 0, "", "", 3},
        PngKind{kRgb, 8, false, false, 0, "", "", 0, kTurned}}) {
    Write(folder / "p.png", kind, 5, 4);
    const auto bytes = *ReadWholeFile(folder / "p.png");
    EXPECT_FALSE(internal::ReadPlainPng(bytes)) << kind.gamma << kind.key;
    const auto library = ReadByLibrary(folder / "p.png");
    const auto both = ReadPicture(folder / "p.png");
    ASSERT_EQ(both.ok(), library.ok());
    if (both) {
      EXPECT_TRUE(both->rgba == library->rgba) << kind.key;
    }
  }
}

TEST(PngReader, EveryCodeIsTheNumberThatTheLibraryMakesOfIt) {
  TemporaryFolder folder;
  Picture picture(256, 256);
  for (const int bits : {8, 16}) {
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
      picture.rgba[i] = static_cast<std::uint16_t>(bits == 8 ? i / 4 % 256 * 257 : i / 4);
    const auto bytes = internal::WritePng(picture, {bits, false, 1, 0, "", 1});
    ASSERT_TRUE(WriteFileAtomically(folder / "p.png", bytes));
    ExpectAsLibrary(bytes, folder / "p.png");
  }
}

TEST(PngReader, DamageIsNotPlain) {
  const auto bytes = internal::WritePng(Make(60, 50, 8, false), {});
  for (std::size_t length = 0; length + 12 < bytes.size();
       length += 1 + length / 7) {  // 12: what ends the file may lack
    EXPECT_FALSE(internal::ReadPlainPng(std::span(bytes).first(length))) << length;
  }
  for (std::size_t i = 0; i < bytes.size(); i += 1 + i / 9) {
    auto damaged = bytes;
    damaged[i] ^= std::byte(0x5a);
    internal::ReadPlainPng(damaged);  // any answer, no crash
  }
}

// ---- parts -------------------------------------------------------------------------------------------------------

TEST(PngFilter, PaethIsTheSpecificationsAndIsUndone) {
  for (const std::size_t pixel : {1, 2, 4, 8}) {
    const std::size_t bytes = 8 * 13;
    std::vector<std::uint8_t> row(bytes), above(bytes), out(bytes), back(bytes);
    for (std::size_t i = 0; i < bytes; ++i) row[i] = Hash(i, 1) % 256, above[i] = Hash(i, 2) % 256;
    internal::FilterPaeth(row.data(), above.data(), bytes, pixel, out.data());
    for (std::size_t i = 0; i < bytes; ++i) {
      const int a = i >= pixel ? back[i - pixel] : 0, b = above[i], c = i >= pixel ? above[i - pixel] : 0;
      const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
      const int predicted = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
      back[i] = static_cast<std::uint8_t>(out[i] + predicted);
    }
    EXPECT_EQ(back, row);
  }
}

TEST(ForEachIndex, EachOnceAndTheFirstFailureIsThrownOn) {
  for (const int threads : {1, 2, 3, 7, 0}) {
    std::vector<std::atomic<int>> calls(100);
    internal::ForEachIndex(100, threads, [&](int i) { ++calls[std::size_t(i)]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
    EXPECT_THROW(internal::ForEachIndex(100, threads,
                                        [](int i) {
                                          if (i == 50) throw std::runtime_error("50");
                                        }),
                 std::runtime_error);
  }
  internal::ForEachIndex(0, 2, [](int) { FAIL(); });
}

}  // namespace
}  // namespace scumble
