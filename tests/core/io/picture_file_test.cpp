// Pictures through files: exact where the format is, and every damaged file an error with its name.
#include "core/io/picture_file.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "tests/support/picture_files.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// Colours and alphas of every kind; at 8 bits only those that 8 bits hold.
Picture RandomPicture(int width, int height, int bits) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    const std::uint64_t hash = Hash(width, height, i);
    picture.rgba[i] = static_cast<std::uint16_t>(bits == 8 ? (hash % 256) * 257 : hash % 65536);
  }
  return picture;
}

// ---- round trips -----------------------------------------------------------------------------------------------

TEST(PictureFile, GreyIsOneChannelAndComesBackEqual) {
  TemporaryFolder folder;
  for (const int bits : {8, 16}) {
    Picture grey = RandomPicture(37, 23, bits);
    for (std::size_t i = 0; i < grey.rgba.size(); i += 4) {
      grey.rgba[i + 1] = grey.rgba[i + 2] = grey.rgba[i];
      grey.rgba[i + 3] = 65535;
    }
    for (const char* name : {"grey.png", "grey.tif"}) {
      SCOPED_TRACE(name);
      const fs::path path = folder.path() / name;
      PictureWriteOptions options;
      options.bits = bits, options.grey = true;
      ASSERT_TRUE(WritePicture(path, grey, options));
      const auto file = OIIO::ImageInput::open(path.string());
      ASSERT_TRUE(file);
      EXPECT_EQ(file->spec().nchannels, 1);
      EXPECT_EQ(file->spec().format.basesize(), bits == 8 ? 1u : 2u);
      ExpectSame(Read(path), grey);
    }
  }
}

TEST(PictureFile, PngAndTiffAreExactAt8And16Bits) {
  const TemporaryFolder folder;
  for (const char* name : {"p.png", "p.tif", "p.TIFF", "p.PNG"}) {
    for (int bits : {8, 16}) {
      for (const auto& [width, height] : {std::pair{1, 1}, {1, 61}, {61, 1}, {37, 23}}) {
        const Picture picture = RandomPicture(width, height, bits);
        PictureWriteOptions options;
        options.bits = bits;
        const Status written = WritePicture(folder / name, picture, options);
        ASSERT_TRUE(written) << written.error().message;
        ExpectSame(Read(folder / name), picture);
      }
    }
  }
}

TEST(PictureFile, EveryEightBitValueBecomes257TimesItself) {
  const TemporaryFolder folder;
  std::vector<std::uint8_t> bytes;
  for (int v = 0; v < 256; ++v) bytes.insert(bytes.end(), {std::uint8_t(v), std::uint8_t(255 - v), 7});
  WriteWith(folder / "v.png", OIIO::ImageSpec(256, 1, 3, OIIO::TypeDesc::UINT8), bytes);
  const Picture picture = Read(folder / "v.png");
  ASSERT_EQ(picture.width, 256);
  for (int v = 0; v < 256; ++v) {
    EXPECT_EQ(Pixel(picture, v, 0),
              (std::vector<std::uint16_t>{std::uint16_t(v * 257), std::uint16_t((255 - v) * 257), 7 * 257, 65535}));
  }
  // Back to 8 bits, each 16-bit value goes to the nearest.
  Picture wide(65536 / 64, 64);
  for (std::size_t i = 0; i < 65536; ++i) {
    for (int c = 0; c < 4; ++c) wide.rgba[4 * i + c] = c == 3 ? 65535 : static_cast<std::uint16_t>(i);
  }
  ASSERT_TRUE(WritePicture(folder / "wide.png", wide));
  const Picture narrow = Read(folder / "wide.png");
  for (std::size_t i = 0; i < 65536; ++i) {
    ASSERT_EQ(narrow.rgba[4 * i], static_cast<int>(std::lround(static_cast<double>(i) / 257.0)) * 257) << i;
  }
}

TEST(PictureFile, GreyIsSpreadAndMissingAlphaIsOpaque) {
  const TemporaryFolder folder;
  for (const char* name : {"g.png", "g.tif"}) {
    WriteWith<std::uint8_t>(folder / name, OIIO::ImageSpec(2, 1, 1, OIIO::TypeDesc::UINT8), {0, 200});
    const Picture grey = Read(folder / name);
    EXPECT_EQ(Pixel(grey, 1, 0), (std::vector<std::uint16_t>{51400, 51400, 51400, 65535})) << name;
    OIIO::ImageSpec spec(2, 1, 2, OIIO::TypeDesc::UINT16);
    spec.channelnames = {"Y", "A"};
    spec.alpha_channel = 1;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    WriteWith<std::uint16_t>(folder / name, spec, {1000, 65535, 2000, 300});
    const Picture with_alpha = Read(folder / name);
    EXPECT_EQ(Pixel(with_alpha, 0, 0), (std::vector<std::uint16_t>{1000, 1000, 1000, 65535})) << name;
    EXPECT_EQ(Pixel(with_alpha, 1, 0), (std::vector<std::uint16_t>{2000, 2000, 2000, 300})) << name;
  }
}

TEST(PictureFile, APalettePngIsLookedUp) {
  // 2×2 pixels, palette of red, green and half transparent blue; made once with a chunk writer.
  const unsigned char bytes[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
      0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x03, 0x00, 0x00, 0x00, 0x45, 0x68, 0xfd, 0x16, 0x00, 0x00, 0x00,
      0x09, 0x50, 0x4c, 0x54, 0x45, 0xff, 0x00, 0x00, 0x00, 0xff, 0x00, 0x00, 0x00, 0xff, 0x2d, 0x4a, 0xcd, 0x8a,
      0x00, 0x00, 0x00, 0x03, 0x74, 0x52, 0x4e, 0x53, 0xff, 0xff, 0x80, 0x3a, 0x72, 0x8e, 0x61, 0x00, 0x00, 0x00,
      0x0e, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x60, 0x64, 0x60, 0x62, 0x00, 0x00, 0x00, 0x0e, 0x00,
      0x04, 0xc6, 0x88, 0x7c, 0xf8, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  const auto picture = DecodePicture(std::as_bytes(std::span(bytes)), "palette.png");
  ASSERT_TRUE(picture) << picture.error().message;
  ASSERT_EQ(picture->width, 2);
  ASSERT_EQ(picture->height, 2);
  EXPECT_EQ(Pixel(*picture, 0, 0), (std::vector<std::uint16_t>{65535, 0, 0, 65535}));
  EXPECT_EQ(Pixel(*picture, 1, 0), (std::vector<std::uint16_t>{0, 65535, 0, 65535}));
  EXPECT_EQ(Pixel(*picture, 0, 1), (std::vector<std::uint16_t>{0, 0, 65535, 128 * 257}));
  EXPECT_EQ(Pixel(*picture, 1, 1), (std::vector<std::uint16_t>{65535, 0, 0, 65535}));
}

// ---- linear files ----------------------------------------------------------------------------------------------

TEST(PictureFile, ExrIsLinearWithAssociatedAlpha) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(4, 1, 4, OIIO::TypeDesc::FLOAT);
  WriteWith<float>(
      folder / "l.exr", spec,
      {0.5f, 1.0f, 0.0f, 1.0f, 0.25f, 0.5f, 0.0f, 0.5f, -1.0f, 7.0f, std::nanf(""), 1.0f, 0.0f, 0.0f, 0.0f, 0.0f});
  const Picture picture = Read(folder / "l.exr");
  EXPECT_EQ((picture.At(0, 0)[0] + 128) / 257, 188);
  EXPECT_EQ(Pixel(picture, 1, 0), (std::vector<std::uint16_t>{picture.At(0, 0)[0], 65535, 0, 32768}));
  EXPECT_EQ(Pixel(picture, 2, 0), (std::vector<std::uint16_t>{0, 65535, 0, 65535}));
  EXPECT_EQ(Pixel(picture, 3, 0), (std::vector<std::uint16_t>{0, 0, 0, 0}));
}

TEST(PictureFile, ImpossibleAlphaInAnExrIsDefined) {
  const TemporaryFolder folder;
  constexpr float kInf = std::numeric_limits<float>::infinity();
  WriteWith<float>(
      folder / "a.exr", OIIO::ImageSpec(4, 1, 4, OIIO::TypeDesc::FLOAT),
      {0.5f, 0.5f, 0.5f, std::nanf(""), 0.5f, 0.5f, 0.5f, -1.0f, 0.5f, 0.5f, 0.5f, kInf, 0.5f, 0.5f, 0.5f, 2.0f});
  const Picture picture = Read(folder / "a.exr");
  EXPECT_EQ(picture.At(0, 0)[3], 0);
  EXPECT_EQ(picture.At(1, 0)[3], 0);
  EXPECT_EQ(picture.At(2, 0)[3], 65535);
  EXPECT_EQ(picture.At(3, 0)[3], 65535);
}

// Each part of 2×1 pixels holds one value in all of its channels.
void WriteParts(const fs::path& path, const std::vector<std::pair<std::string, std::vector<std::string>>>& parts) {
  std::vector<OIIO::ImageSpec> specs;
  for (const auto& [name, channels] : parts) {
    specs.emplace_back(2, 1, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
    specs.back().channelnames = channels;
    specs.back().alpha_channel = -1;
    specs.back().attribute("oiio:subimagename", name);
  }
  auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output && output->open(path.string(), static_cast<int>(specs.size()), specs.data()));
  for (std::size_t i = 0; i < specs.size(); ++i) {
    if (i > 0) {
      ASSERT_TRUE(output->open(path.string(), specs[i], OIIO::ImageOutput::AppendSubimage));
    }
    const std::vector<float> pixels(2 * parts[i].second.size(), 0.25f * static_cast<float>(i + 1));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) << output->geterror();
  }
  ASSERT_TRUE(output->close()) << output->geterror();
}

TEST(PictureFile, AnExrOfPartsIsThePartThatIsAPicture) {
  const TemporaryFolder folder;
  const std::vector<std::string> rgb = {"R", "G", "B"};
  WriteParts(folder / "a.exr", {{"depth", {"depth.Z"}}, {"albedo", rgb}, {"beauty", rgb}});
  WriteParts(folder / "b.exr", {{"mask", {"A"}}, {"any", rgb}, {"more", rgb}});
  WriteParts(folder / "c.exr", {{"N", rgb}, {"rgba.left", rgb}, {"rgba.right", rgb}});
  EXPECT_EQ(ReadPicture(folder / "c.exr")->At(0, 0)[0], Srgb16FromLinear(0.5f));
  const auto usual = ReadPicture(folder / "a.exr"), first = ReadPicture(folder / "b.exr");
  ASSERT_TRUE(usual && first) << (usual ? first.error().message : usual.error().message);
  EXPECT_EQ(usual->At(1, 0)[0], Srgb16FromLinear(0.75f));
  EXPECT_EQ(first->At(1, 0)[0], Srgb16FromLinear(0.5f));
}

TEST(PictureFile, OfSeveralViewLayersOneIsNamed) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(1, 1, 6, OIIO::TypeDesc::FLOAT);
  spec.channelnames = {"Back.Combined.R", "Back.Combined.G", "Back.Combined.B",
                       "Fore.Combined.R", "Fore.Combined.G", "Fore.Combined.B"};
  spec.alpha_channel = -1;
  WriteWith<float>(folder / "two.exr", spec, {0.25f, 0.25f, 0.25f, 0.5f, 0.5f, 0.5f});
  const auto none = ReadPicture(folder / "two.exr");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("several view layers, Back, Fore: expected one"), std::string::npos)
      << none.error().message;
  EXPECT_EQ(ReadPicture(folder / "two.exr", "Back")->At(0, 0)[0], Srgb16FromLinear(0.25f));
  EXPECT_EQ(ReadPicture(folder / "two.exr", "Fore")->At(0, 0)[0], Srgb16FromLinear(0.5f));
  const auto other = ReadPicture(folder / "two.exr", "Middle");
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("no view layer 'Middle'; it has Back, Fore"), std::string::npos);
  // Each in a part of its own.
  const auto layer = [](const std::string& name) {
    return std::vector<std::string>{name + ".Combined.R", name + ".Combined.G", name + ".Combined.B"};
  };
  WriteParts(folder / "parts.exr", {{"back", layer("Back")}, {"fore", layer("Fore")}});
  EXPECT_FALSE(ReadPicture(folder / "parts.exr"));
  EXPECT_EQ(ReadPicture(folder / "parts.exr", "Back")->At(0, 0)[0], Srgb16FromLinear(0.25f));
  EXPECT_EQ(ReadPicture(folder / "parts.exr", "Fore")->At(0, 0)[0], Srgb16FromLinear(0.5f));
  EXPECT_FALSE(ReadPicture(folder / "parts.exr", "Middle"));
}

TEST(PictureFile, WritingExrDecodesAndAssociates) {
  const TemporaryFolder folder;
  Picture picture(2, 1);
  const std::uint16_t values[] = {65535, 188 * 257, 0, 65535, 65535, 65535, 0, 32768};
  std::copy(std::begin(values), std::end(values), picture.rgba.begin());
  PictureWriteOptions options;
  options.bits = 32;
  ASSERT_TRUE(WritePicture(folder / "l.exr", picture, options));
  auto input = OIIO::ImageInput::open((folder / "l.exr").string());
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::FLOAT);
  std::vector<float> pixels(8);
  ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, pixels.data()));
  EXPECT_EQ(pixels[0], 1.0f);
  EXPECT_NEAR(pixels[1], 0.5f, 0.005f);
  EXPECT_NEAR(pixels[4], 32768.0f / 65535.0f, 1e-6f);
  EXPECT_EQ(pixels[6], 0.0f);
  EXPECT_NEAR(pixels[7], 32768.0f / 65535.0f, 1e-6f);
  ExpectSame(Read(folder / "l.exr"), picture, 1);

  ASSERT_TRUE(WritePicture(folder / "h.exr", RandomPicture(9, 9, 8)));
  auto half = OIIO::ImageInput::open((folder / "h.exr").string());
  ASSERT_TRUE(half);
  EXPECT_EQ(half->spec().format, OIIO::TypeDesc::HALF);
}

TEST(PictureFile, OpaqueExrKeepsEvery16BitValueAt32Bits) {
  const TemporaryFolder folder;
  Picture picture = RandomPicture(64, 64, 16);
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 65535;
  PictureWriteOptions options;
  options.bits = 32;
  ASSERT_TRUE(WritePicture(folder / "l.exr", picture, options));
  ExpectSame(Read(folder / "l.exr"), picture);
}

// ---- JPEG and options ------------------------------------------------------------------------------------------

TEST(PictureFile, JpegIsPaintedOnWhite) {
  const TemporaryFolder folder;
  Picture picture(16, 16);  // transparent black
  ASSERT_TRUE(WritePicture(folder / "white.jpg", picture));
  for (std::uint16_t value : Read(folder / "white.jpg").rgba) EXPECT_EQ(value, 65535);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) picture.rgba[i + 3] = 32768;  // half transparent black
  ASSERT_TRUE(WritePicture(folder / "half.jpeg", picture));
  for (std::size_t i = 0; i < 256; ++i) EXPECT_NEAR(Read(folder / "half.jpeg").rgba[4 * i] / 257, 188, 1);
}

TEST(PictureFile, OptionsChangeTheSizeAndPngLevelNotThePixels) {
  const TemporaryFolder folder;
  Picture picture(128, 128);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = static_cast<std::uint16_t>(257 * ((i / 7 + Hash(i) % 5) % 256));
  }
  PictureWriteOptions options;
  std::vector<std::uintmax_t> sizes;
  for (int level : {0, 1, 9}) {
    options.png_level = level;
    ASSERT_TRUE(WritePicture(folder / "p.png", picture, options));
    sizes.push_back(fs::file_size(folder / "p.png"));
    ExpectSame(Read(folder / "p.png"), picture);
  }
  EXPECT_GT(sizes[0], 128u * 128u * 4u) << "level 0 stores";
  EXPECT_GT(sizes[1], sizes[2]);
  EXPECT_GT(sizes[0], sizes[1]);
  sizes.clear();
  for (int quality : {30, 95}) {
    options.jpeg_quality = quality;
    ASSERT_TRUE(WritePicture(folder / "p.jpg", picture, options));
    sizes.push_back(fs::file_size(folder / "p.jpg"));
  }
  EXPECT_LT(sizes[0] * 3 / 2, sizes[1]);
}

TEST(PictureFile, TheSamePictureGivesTheSameBytes) {
  const TemporaryFolder folder;
  const Picture picture = RandomPicture(50, 40, 16);
  for (const std::string ending : {".png", ".tif", ".exr", ".jpg"}) {
    ASSERT_TRUE(WritePicture(folder / ("a" + ending), picture));
    ASSERT_TRUE(WritePicture(folder / ("another" + ending), picture));
    EXPECT_EQ(*ReadWholeFile(folder / ("a" + ending)), *ReadWholeFile(folder / ("another" + ending)))
        << ending << " must not hold its own name";
    const auto input = OIIO::ImageInput::open((folder / ("a" + ending)).string());
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().get_string_attribute("DateTime"), "") << ending << " must not hold the hour";
  }
}

TEST(PictureFile, PngSaysThatItIsSrgb) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WritePicture(folder / "p.png", RandomPicture(2, 2, 8)));
  const auto bytes = ReadWholeFile(folder / "p.png");
  ASSERT_TRUE(bytes);
  const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  EXPECT_NE(text.find("sRGB"), std::string::npos) << "the chunk that names the colour space";
}

TEST(PictureFile, WhatCannotBeWrittenIsSaid) {
  const TemporaryFolder folder;
  const Picture picture = RandomPicture(2, 2, 8);
  for (const char* name : {"p.webp", "p", "p.png.bak", "p.gif", ".png"}) {
    const Status status = WritePicture(folder / name, picture);
    ASSERT_FALSE(status) << name;
    EXPECT_EQ(static_cast<int>(status.error().kind), static_cast<int>(ErrorKind::kUsage));
    EXPECT_NE(status.error().message.find(name), std::string::npos);
    EXPECT_NE(status.error().message.find(".png, .tif, .jpg, .exr"), std::string::npos) << status.error().message;
  }
  PictureWriteOptions options;
  options.bits = 32;
  const Status bits = WritePicture(folder / "p.png", picture, options);
  ASSERT_FALSE(bits);
  EXPECT_EQ(static_cast<int>(bits.error().kind), static_cast<int>(ErrorKind::kUsage));
  EXPECT_NE(bits.error().message.find("32 bits"), std::string::npos);
  for (const char* name : {"p.png", "p.tif", "p.jpg", "p.exr"}) {
    for (const int wrong : {-16, 0, 7, 24, 64}) {
      const Status status = CheckPictureTarget(name, {wrong});
      ASSERT_FALSE(status) << name << " " << wrong;
      EXPECT_EQ(static_cast<int>(status.error().kind), static_cast<int>(ErrorKind::kUsage));
    }
  }
  for (const char* name : {"p.png", "p.tif", "p.jpg", "p.exr"})
    EXPECT_FALSE(WritePicture(folder / name, Picture())) << name;
  EXPECT_TRUE(folder.List().empty());
}

TEST(PictureFile, DecodingFromMemoryEqualsReadingTheFile) {
  const TemporaryFolder folder;
  for (const char* name : {"p.png", "p.jpg", "p.tif", "p.exr"}) {
    ASSERT_TRUE(WritePicture(folder / name, RandomPicture(37, 23, 8)));
    const auto bytes = ReadWholeFile(folder / name);
    ASSERT_TRUE(bytes);
    for (const char* called : {name, "image 3 of scene.glb"}) {  // textures inside a .glb have no ending
      const auto decoded = DecodePicture(*bytes, called);
      ASSERT_TRUE(decoded) << name << " as " << called << ": " << decoded.error().message;
      ExpectSame(*decoded, Read(folder / name));
    }
  }
}

// ---- files that are none ---------------------------------------------------------------------------------------

TEST(PictureFile, WhatIsNoPicture) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "folder.png");
  ASSERT_TRUE(WriteFileAtomically(folder / "empty.png", ""));
  ASSERT_TRUE(WriteFileAtomically(folder / "text.png", "This is not a picture.\n"));
  ExpectRefusal(ReadPicture(folder / "missing.png"), {"missing.png", "no such file"});
  ExpectRefusal(ReadPicture(folder / "folder.png"), {"folder.png", "it is a folder"});
  ExpectRefusal(ReadPicture(folder / "empty.png"), {"empty.png", "empty"});
  ExpectRefusal(ReadPicture(folder / "text.png"), {"text.png"});
  ExpectRefusal(DecodePicture({}, "image 0"), {"image 0", "empty"});
  ExpectRefusal(DecodePicture(std::as_bytes(std::span("not a picture")), "image 1"), {"image 1"});
}

TEST(PictureFile, AWrongEndingDoesNotMatter) {
  const TemporaryFolder folder;
  const Picture picture = RandomPicture(5, 4, 8);
  ASSERT_TRUE(WritePicture(folder / "p.png", picture));
  fs::rename(folder / "p.png", folder / "p.tif");
  ExpectSame(Read(folder / "p.tif"), picture);
}

// Each format is read by its own reader, chosen by the file's content: a name without an ending gives no hint. TGA has
// no mark and needs its name. Tolerances of 16 bits: WebP is lossy, HDR has 8 bits of mantissa.
TEST(PictureFile, FormatsAreKnownByHowTheyBegin) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> bytes(3 * 16 * 16, 200);
  for (const auto& [ending, tolerance] :
       {std::pair{"bmp", 0}, {"tga", 0}, {"tif", 0}, {"ppm", 0}, {"webp", 600}, {"hdr", 600}}) {
    SCOPED_TRACE(ending);
    const fs::path path = folder / ("a." + std::string(ending));
    OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    std::vector<float> linear(bytes.size(), SrgbToLinear(200.0f / 255.0f));
    if (std::string(ending) == "hdr") {
      WriteWith(path, OIIO::ImageSpec(16, 16, 3, OIIO::TypeDesc::FLOAT), linear);
    } else {
      WriteWith(path, spec, bytes);
    }
    const fs::path bare = std::string(ending) == "tga" ? folder / "b.TGA" : folder / ("bare-" + std::string(ending));
    fs::rename(path, bare);
    const Picture picture = Read(bare);
    ASSERT_EQ(picture.width, 16);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(picture.At(5, 7)[c], 200 * 257, tolerance);
    EXPECT_EQ(picture.At(5, 7)[3], 65535);
  }
}

// A reader of OpenImageIO's ends the process at some RLA files. Painters do not use that format, and a file of unknown
// content must not reach that reader.
TEST(PictureFile, FormatsThatNobodyPaintsInAreRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "render.rla";
  WriteWith(path, OIIO::ImageSpec(8, 8, 3, OIIO::TypeDesc::UINT8), std::vector<std::uint8_t>(3 * 8 * 8, 9));
  ExpectRefusal(ReadPicture(path), {"render.rla", "does not begin as a picture", "PNG", "PSD"});
  // OpenImageIO's reader of GIF looks colours up behind the end of a short palette.
  WriteWith(folder / "small.gif", OIIO::ImageSpec(8, 8, 3, OIIO::TypeDesc::UINT8),
            std::vector<std::uint8_t>(3 * 8 * 8, 9));
  fs::rename(folder / "small.gif", folder / "small.png");
  ExpectRefusal(ReadPicture(folder / "small.png"), {"small.png", "it is a GIF", "save it as a PNG"});
  std::ofstream(folder / "block.dds") << "DDS |" << std::string(200, '\0');
  ExpectRefusal(ReadPicture(folder / "block.dds"), {"block.dds", "it is a DDS", "save it as a PNG"});
  for (const std::string order : {"SDPX", "XPDS"}) {
    std::ofstream(folder / "film.dpx") << order << std::string(2100, '\0');
    ExpectRefusal(ReadPicture(folder / "film.dpx"), {"film.dpx", "it is a DPX", "save it as a PNG"});
  }
  // Raw photographs are TIFF files whose first picture is a small preview.
  WriteWith(folder / "preview.tif", OIIO::ImageSpec(8, 8, 3, OIIO::TypeDesc::UINT8),
            std::vector<std::uint8_t>(3 * 8 * 8, 9));
  ASSERT_TRUE(ReadPicture(folder / "preview.tif"));
  fs::rename(folder / "preview.tif", folder / "photo.NEF");
  ExpectRefusal(ReadPicture(folder / "photo.NEF"), {"photo.NEF", "raw", "TIFF of 16 bits"});
}

TEST(PictureFile, AJpegMayLackNothingButMayHoldMore) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WritePicture(folder / "p.jpg", RandomPicture(37, 23, 8)));
  auto bytes = *ReadWholeFile(folder / "p.jpg");
  const auto last = bytes.back();
  bytes.pop_back();
  ExpectRefusal(DecodePicture(bytes, "cut.jpg"), {"cut.jpg", "ends before its picture"});
  bytes.push_back(last);
  for (int i = 0; i < 100; ++i) bytes.push_back(std::byte(i));  // as some cameras append previews
  const auto decoded = DecodePicture(bytes, "long.jpg");
  ASSERT_TRUE(decoded) << decoded.error().message;
  ExpectSame(*decoded, Read(folder / "p.jpg"));
}

// OpenImageIO's PNG reader leaps out of libpng over a text it has allocated, so each damaged PNG leaks 31 bytes that
// are not ours. Leaks of all other formats are looked for.
class DamagedPicture : public testing::TestWithParam<const char*> {
#ifdef __SANITIZE_ADDRESS__
 protected:
  void SetUp() override {
    if (fs::path(GetParam()).extension() == ".png") not_looking_.emplace();
  }

 private:
  std::optional<__lsan::ScopedDisabler> not_looking_;
#endif
};

TEST_P(DamagedPicture, ATruncatedFileIsRefusedAtAnyLength) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WritePicture(folder / GetParam(), RandomPicture(37, 23, 8)));
  const auto whole = ReadWholeFile(folder / GetParam());
  ASSERT_TRUE(whole);
  const std::string name = "cut" + fs::path(GetParam()).extension().string();
  for (std::size_t k = 0; k < 80; ++k) {
    const std::size_t length = k < 40 ? k * k / 2 : Hash(k) % (whole->size() * 9 / 10);
    if (length >= whole->size() * 9 / 10) continue;
    const std::span<const std::byte> bytes(whole->data(), length);
    ASSERT_TRUE(WriteFileAtomically(folder / name, bytes));
    SCOPED_TRACE(std::to_string(length) + " of " + std::to_string(whole->size()) + " bytes");
    ExpectRefusal(ReadPicture(folder / name), {name});
    ExpectRefusal(DecodePicture(bytes, name), {name});
  }
}

TEST_P(DamagedPicture, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WritePicture(folder / GetParam(), RandomPicture(37, 23, 8)));
  const auto whole = ReadWholeFile(folder / GetParam());
  ASSERT_TRUE(whole);
  for (std::uint64_t round = 0; round < 300; ++round) {
    auto bytes = *whole;
    const std::size_t reach = round % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 400);
    for (std::uint64_t k = 0; k <= round % 3; ++k)
      bytes[Hash(round, k) % reach] ^= std::byte(1 + Hash(round, k, 1) % 255);
    const auto decoded = DecodePicture(bytes, GetParam());
    if (decoded) {
      EXPECT_EQ(decoded->rgba.size(), std::size_t(4) * decoded->width * decoded->height);
    } else {
      ExpectRefusal(decoded, {GetParam()});
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedPicture, testing::Values("p.png", "p.jpg", "p.tif", "p.exr"),
                         [](const auto& format) { return fs::path(format.param).extension().string().substr(1); });

// By the Exif standard's table: where row 0 and column 0 of the stored picture are seen.
TEST(PictureFile, PhotographsAreTurnedUpright) {
  const TemporaryFolder folder;
  // Stored as 3 × 2 with the numbers 0 to 5 row by row.
  const std::vector<std::vector<int>> upright = {{0, 1, 2, 3, 4, 5}, {2, 1, 0, 5, 4, 3}, {5, 4, 3, 2, 1, 0},
                                                 {3, 4, 5, 0, 1, 2}, {0, 3, 1, 4, 2, 5}, {3, 0, 4, 1, 5, 2},
                                                 {5, 2, 4, 1, 3, 0}, {2, 5, 1, 4, 0, 3}};
  for (int orientation = 1; orientation <= 8; ++orientation) {
    OIIO::ImageSpec spec(3, 2, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("Orientation", orientation);
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < 18; ++i) pixels.push_back(static_cast<std::uint8_t>(40 * (i / 3)));
    const std::string name = (folder / "photo.tif").string();
    auto file = OIIO::ImageOutput::create(name);
    ASSERT_TRUE(file && file->open(name, spec) && file->write_image(OIIO::TypeDesc::UINT8, pixels.data()) &&
                file->close());
    const auto picture = ReadPicture(name);
    ASSERT_TRUE(picture) << picture.error().message;
    ASSERT_EQ(picture->width, orientation <= 4 ? 3 : 2);
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(picture->rgba[4 * i], 40 * 257 * upright[orientation - 1][i]) << orientation << " pixel " << i;
    }
  }
}

}  // namespace
}  // namespace scumble
