// TIFF without the picture library: pixels and notes equal to what the library writes, equal bytes for any threads.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/channel_file.h"
#include "core/io/picture/tiff_writer.h"
#include "core/io/picture_file.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using internal::TiffOptions;

// Noise in every channel, or smooth rows whose sums pass the type's range.
Picture Make(int width, int height, bool smooth) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 4; ++c) {
        const std::uint64_t value = smooth ? std::uint64_t(x * 3 + y * 5 + c * 40) * 97 : Hash(x, y, c, width);
        picture.At(x, y)[c] = static_cast<std::uint16_t>(value % 65536);
      }
    }
  }
  return picture;
}

std::unique_ptr<OIIO::ImageInput> Open(const fs::path& path) {
  OIIO::ImageSpec straight;
  straight.attribute("oiio:UnassociatedAlpha", 1);
  return OIIO::ImageInput::open(path.string(), &straight);
}

// The samples that a file of those bits and channels must hold.
template <class T>
std::vector<T> Samples(const Picture& picture, const TiffOptions& options) {
  std::vector<T> samples;
  for (std::size_t i = 0; i < picture.rgba.size(); i += options.grey ? 4 : 1) {
    samples.push_back(static_cast<T>(options.bits == 8 ? (picture.rgba[i] + 128u) / 257u : picture.rgba[i]));
  }
  return samples;
}

template <class T>
void ExpectSamples(const std::vector<std::byte>& bytes, const Picture& picture, const TiffOptions& options) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "p.tif", bytes));
  const auto file = Open(folder / "p.tif");
  ASSERT_TRUE(file) << OIIO::geterror();
  ASSERT_EQ(file->spec().width, picture.width);
  ASSERT_EQ(file->spec().height, picture.height);
  ASSERT_EQ(file->spec().nchannels, options.grey ? 1 : 4);
  ASSERT_EQ(file->spec().format, OIIO::TypeDesc(OIIO::BaseTypeFromC<T>::value));
  const std::vector<T> expected = Samples<T>(picture, options);
  std::vector<T> found(expected.size());
  ASSERT_TRUE(file->read_image(0, 0, 0, -1, file->spec().format, found.data())) << file->geterror();
  EXPECT_TRUE(found == expected);
  EXPECT_FALSE(file->seek_subimage(1, 0)) << "one picture, and nothing after it";
}

TEST(TiffWriter, ChannelsAreReadByNameAsWell) {
  const TemporaryFolder folder;
  const Picture picture = Make(5, 3, false);
  ASSERT_TRUE(WritePicture(folder / "p.tif", picture));
  const auto channels = ReadChannels(folder / "p.tif");
  ASSERT_TRUE(channels) << channels.error().message;
  EXPECT_EQ(channels->names, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_EQ(channels->planes[2][14], static_cast<float>(In8Bits(picture)[4 * 14 + 2]) / 255.0f);
}

struct TiffSize {
  int width, height;
};
class TiffShapes : public ::testing::TestWithParam<std::tuple<TiffSize, int>> {};

TEST_P(TiffShapes, AnyThreadsSameBytesAndTheyHoldThePicture) {
  const auto [shape, bits] = GetParam();
  for (const bool smooth : {false, true}) {
    const Picture picture = Make(shape.width, shape.height, smooth);
    for (const bool grey : {false, true}) {
      SCOPED_TRACE(std::string(smooth ? "smooth" : "noise") + (grey ? ", grey" : ""));
      TiffOptions options{bits, grey, 0, 1};
      const auto bytes = internal::EncodeTiff("p.tif", picture, options);
      ASSERT_TRUE(bytes) << bytes.error().message;
      bits == 8 ? ExpectSamples<std::uint8_t>(*bytes, picture, options)
                : ExpectSamples<std::uint16_t>(*bytes, picture, options);
      options.threads = 5;
      EXPECT_TRUE(*internal::EncodeTiff("p.tif", picture, options) == *bytes);
    }
  }
}
// A hundred rows of 700 pixels are two strips of 8 bits, and a row of the widest is more than a strip of 16.
INSTANTIATE_TEST_SUITE_P(All, TiffShapes,
                         ::testing::Combine(::testing::Values(TiffSize{1, 1}, TiffSize{1, 300}, TiffSize{301, 1},
                                                              TiffSize{2, 2}, TiffSize{37, 23}, TiffSize{700, 100},
                                                              TiffSize{33000, 2}),
                                            ::testing::Values(8, 16)),
                         [](const auto& test) {
                           const TiffSize shape = std::get<0>(test.param);
                           return std::to_string(shape.width) + "x" + std::to_string(shape.height) + "of" +
                                  std::to_string(std::get<1>(test.param));
                         });

// What a reader finds beside the pixels. How many rows a strip has is the writer's own business.
std::map<std::string, std::string> Notes(const fs::path& path) {
  const auto file = Open(path);
  EXPECT_TRUE(file) << OIIO::geterror();
  if (!file) return {};
  std::map<std::string, std::string> notes;
  for (const auto& attribute : file->spec().extra_attribs) {
    notes[attribute.name().string()] = attribute.get_string();
  }
  notes.erase("tiff:RowsPerStrip");
  notes["the alpha channel"] = std::to_string(file->spec().alpha_channel);
  return notes;
}

TEST(TiffWriter, NotesAreThoseOfThePictureLibrary) {
  const TemporaryFolder folder;
  const Picture picture = Make(37, 23, true);
  for (const bool grey : {false, true}) {
    for (const int dpi : {0, 300}) {
      SCOPED_TRACE(std::to_string(dpi) + " dpi" + (grey ? ", grey" : ""));
      const TiffOptions options{8, grey, dpi, 1};
      OIIO::ImageSpec spec(37, 23, grey ? 1 : 4, OIIO::TypeDesc::UINT8);
      if (!grey) spec.attribute("oiio:UnassociatedAlpha", 1);
      if (dpi > 0) {
        spec.attribute("XResolution", static_cast<float>(dpi));
        spec.attribute("YResolution", static_cast<float>(dpi));
        spec.attribute("ResolutionUnit", "in");
      }
      const std::string theirs = (folder / "theirs.tif").string();
      const auto output = OIIO::ImageOutput::create(theirs);
      spec.attribute("DateTime", "");
      ASSERT_TRUE(output && output->open(theirs, spec) &&
                  output->write_image(OIIO::TypeDesc::UINT8, Samples<std::uint8_t>(picture, options).data()) &&
                  output->close());
      ASSERT_TRUE(WriteFileAtomically(folder / "ours.tif", *internal::EncodeTiff("ours.tif", picture, options)));
      EXPECT_EQ(Notes(folder / "ours.tif"), Notes(folder / "theirs.tif"));
      EXPECT_EQ(Notes(folder / "ours.tif").contains("XResolution"), dpi > 0);
      const auto header = InspectPicture(folder / "ours.tif");
      ASSERT_TRUE(header) << header.error().message;
      EXPECT_EQ(header->dpi, dpi);
    }
  }
}

// A TIFF whose entry PhotometricInterpretation, a short number with the lowest byte first, has another value.
void WriteWithColorsOf(const fs::path& path, char kind) {
  const auto output = OIIO::ImageOutput::create(path.string());
  const std::vector<std::uint8_t> pixels(3 * 8 * 8, 128);
  ASSERT_TRUE(output && output->open(path.string(), OIIO::ImageSpec(8, 8, 3, OIIO::TypeDesc::UINT8)) &&
              output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) && output->close());
  auto bytes = ReadWholeFile(path);
  ASSERT_TRUE(bytes) << bytes.error().message;
  constexpr std::array<unsigned char, 10> kAsRgb = {0x06, 0x01, 3, 0, 1, 0, 0, 0, 2, 0};
  const auto at = std::search(bytes->begin(), bytes->end(), kAsRgb.begin(), kAsRgb.end(),
                              [](std::byte a, unsigned char b) { return std::to_integer<unsigned char>(a) == b; });
  ASSERT_NE(at, bytes->end());
  *(at + 8) = std::byte(kind);
  ASSERT_TRUE(WriteFileAtomically(path, *bytes));
}

TEST(TiffReader, ColoursInLabAreRefused) {
  const TemporaryFolder folder;
  WriteWithColorsOf(folder / "rgb.tif", 2);
  EXPECT_TRUE(ReadPicture(folder / "rgb.tif"));
  WriteWithColorsOf(folder / "lab.tif", 8);
  const auto picture = ReadPicture(folder / "lab.tif");
  ASSERT_FALSE(picture);
  for (const char* word : {"lab.tif", "L*a*b*", "save it in RGB"})
    EXPECT_NE(picture.error().message.find(word), std::string::npos) << picture.error().message;
  for (const char kind : {9, 10}) {  // unsigned a and b, and ITU's
    WriteWithColorsOf(folder / "lab.tif", kind);
    EXPECT_FALSE(ReadPicture(folder / "lab.tif")) << int(kind);
  }
}

}  // namespace
}  // namespace scumble
