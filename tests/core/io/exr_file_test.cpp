// EXR files by OpenEXR alone: the bytes equal OpenImageIO's, and so do the values read.
#include <Imath/half.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/image/color.h"
#include "core/io/atomic_file.h"
#include "core/io/exr/scanline_exr.h"
#include "core/io/format_dispatch.h"
#include "core/io/guides/own_guides.h"
#include "core/io/library.h"
#include "tests/support/guide_files.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<int, int> kSizes[] = {{1, 1}, {1, 17}, {23, 1}, {37, 23}, {130, 70}};
constexpr const char* kCompressions[] = {"none", "rle", "zips", "zip", "piz"};

// What OpenImageIO makes of these planes; each in floats, or rounded to half.
std::vector<std::byte> ByOpenImageIO(OIIO::ImageSpec spec, const std::vector<std::pair<std::string, bool>>& channels,
                                     const std::function<float(std::size_t c, std::size_t i)>& value) {
  spec.nchannels = static_cast<int>(channels.size());
  for (const auto& [name, half] : channels) {
    spec.channelnames.push_back(name);
    spec.channelformats.push_back(half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
  }
  spec.attribute("DateTime", "");
  std::vector<float> pixels(channels.size() * spec.width * spec.height);
  for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = value(k % channels.size(), k / channels.size());
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput proxy(encoded);
  auto output = OIIO::ImageOutput::create("x.exr");
  EXPECT_TRUE(output && output->set_ioproxy(&proxy) && output->open("x.exr", spec) &&
              output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close());
  const auto bytes = std::as_bytes(std::span(encoded));
  return {bytes.begin(), bytes.end()};
}

TEST(ExrFile, GuidesAreTheBytesOfOpenImageIO) {
  const TemporaryFolder folder;
  for (const auto& [width, height] : kSizes) {
    GuideSet guides = RandomGuides(width, height);
    guides.attributes = {{"scumble:generator", "guidegen 0.1"}, {"scumble:note", "two\nlines, Käse"}};
    for (const bool half : {false, true}) {
      for (const char* compression : kCompressions) {
        OIIO::ImageSpec spec(width, height, 0, OIIO::TypeDesc::FLOAT);
        spec.attribute("compression", compression);
        for (const auto& [name, text] : guides.attributes) spec.attribute(name, text);
        std::vector<std::pair<std::string, bool>> channels;
        std::vector<std::span<const float>> planes;
        for (const LayerInfo& info : AllLayers()) {
          for (int c = 0; c < ChannelCount(info.layer); ++c) {
            channels.emplace_back(info.channels[static_cast<std::size_t>(c)], half && info.is_color);
            planes.push_back(guides.Plane(info.layer, c));
          }
        }
        const auto expected = ByOpenImageIO(spec, channels, [&](std::size_t c, std::size_t i) { return planes[c][i]; });
        for (const int threads : {1, 2, 0}) {
          SetIoThreads(threads);
          ASSERT_TRUE(WriteGuides(folder / "g.exr", guides, {half, compression}));
          const auto written = ReadWholeFile(folder / "g.exr");
          ASSERT_TRUE(written);
          EXPECT_TRUE(*written == expected) << width << "×" << height << " " << compression << " " << half;
        }
      }
    }
  }
}

TEST(ExrFile, PicturesAreTheBytesOfOpenImageIO) {
  const TemporaryFolder folder;
  for (const auto& [width, height] : kSizes) {
    Picture picture(width, height);
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = static_cast<std::uint16_t>(Hash(i));
    for (const int bits : {16, 32}) {
      for (const bool fast : {false, true}) {
        PictureWriteOptions options;
        options.bits = bits, options.fast = fast, options.settings = "seed 7";
        ASSERT_TRUE(WritePicture(folder / "p.exr", picture, options));
        OIIO::ImageSpec spec(width, height, 4, OIIO::TypeDesc::FLOAT);
        spec.channelnames.clear();
        spec.attribute("compression", fast ? "rle" : "zip");
        spec.attribute(kSettingsKey, options.settings);
        const bool half = bits == 16;
        const auto expected = ByOpenImageIO(
            spec, {{"R", half}, {"G", half}, {"B", half}, {"A", half}}, [&](std::size_t c, std::size_t i) {
              const float alpha = static_cast<float>(picture.rgba[4 * i + 3]) / 65535.0f;
              return c == 3 ? alpha : Srgb16ToLinear(picture.rgba[4 * i + c]) * alpha;
            });
        const auto written = ReadWholeFile(folder / "p.exr");
        ASSERT_TRUE(written);
        EXPECT_TRUE(*written == expected) << width << "×" << height << " " << bits << " " << fast;
      }
    }
  }
}

TEST(ExrFile, PlainGuidesAreReadAsTheModuleReadsThem) {
  const TemporaryFolder folder;
  const auto formats = LoadFormats("a test");
  ASSERT_TRUE(formats) << formats.error().message;
  const fs::path file = folder / "g.exr";
  for (const auto& [width, height] : kSizes) {
    GuideSet guides = RandomGuides(width, height);
    guides.attributes = {{"scumble:generator", "guidegen 0.1"}, {"scumble:settings", "seed 0"}};
    guides.object_names = {{1, "a"}, {2, "two\nlines"}};
    guides.object_styles = {{1, "oil"}};
    guides.camera.emplace().name = "Camera";
    for (const char* compression : kCompressions) {
      for (const bool half : {false, true}) {
        ASSERT_TRUE(WriteGuides(file, guides, {half, compression}));
        GuideReadOptions some;
        some.required = {Layer::kNormal, Layer::kCoverage};
        some.optional = {Layer::kLuminance};
        for (const GuideReadOptions& options : {Everything(), some}) {
          const auto plain = internal::ReadPlainGuides(file, options);
          const auto by_module = (*formats)->read_guides(file, options);
          ASSERT_TRUE(plain && *plain && by_module);
          const GuideSet& read = **plain;
          ExpectSameBits(read, *by_module);
          EXPECT_EQ(read.attributes, by_module->attributes);
          EXPECT_EQ(read.object_names, by_module->object_names);
          EXPECT_EQ(read.object_styles, by_module->object_styles);
          EXPECT_EQ(read.camera->name, by_module->camera->name);
          EXPECT_EQ(read.camera->view_from_world, by_module->camera->view_from_world);
        }
        const auto plain = internal::InspectPlainGuides(file);
        const auto by_module = (*formats)->inspect_guides(file);
        ASSERT_TRUE(plain && *plain && by_module);
        const GuideFileInfo& read = **plain;
        EXPECT_EQ(std::pair(read.width, read.height), std::pair(by_module->width, by_module->height));
        EXPECT_EQ(read.has_half, by_module->has_half);
        EXPECT_EQ(read.from_blender, by_module->from_blender);
        EXPECT_EQ(read.layers, by_module->layers);
        EXPECT_EQ(read.channels, by_module->channels);
        EXPECT_EQ(read.header.attributes, by_module->header.attributes);
      }
    }
  }
}

TEST(ExrFile, WhatIsNotPlainIsLeftToTheModule) {
  const TemporaryFolder folder;
  const auto one = [](std::size_t c, std::size_t) { return c == 1 || c == 2 ? 0.0f : 1.0f; };
  const std::vector<std::string> names = {"A", "normal.X", "normal.Y", "normal.Z"};
  GuideReadOptions options;
  options.required = {Layer::kCoverage, Layer::kNormal};
  const auto is_plain = [&](OIIO::ImageSpec spec, const std::vector<std::string>& channels) {
    WriteExr(folder / "x.exr", std::move(spec), channels, one);
    EXPECT_EQ(internal::InspectPlainGuides(folder / "x.exr").has_value(),
              internal::ReadPlainGuides(folder / "x.exr", options).has_value());
    return internal::ReadPlainGuides(folder / "x.exr", options).has_value();
  };
  const auto with = [&](const std::string& more) {
    auto channels = names;
    channels.push_back(more);
    return channels;
  };
  const OIIO::ImageSpec flat(4, 4, 1, OIIO::TypeDesc::FLOAT);
  EXPECT_TRUE(is_plain(flat, names));
  EXPECT_TRUE(is_plain(flat, {"A", "N.X", "N.Y", "N.Z"})) << "by names that mean the same";
  EXPECT_FALSE(is_plain(flat, with("N.X"))) << "two of one meaning";
  EXPECT_FALSE(is_plain(flat, with("anything")));
  EXPECT_FALSE(is_plain(flat, with("ViewLayer.Combined.R")));
  EXPECT_FALSE(is_plain(flat, with("ViewLayer.CryptoObject00.r")));
  EXPECT_FALSE(is_plain(flat, {"V.A", "V.normal.X", "V.normal.Y", "V.normal.Z"})) << "a view layer";
  OIIO::ImageSpec blender = flat, window = flat, tiled = flat;
  blender.attribute("Software", "Blender 3.4.1 (Release)");
  EXPECT_FALSE(is_plain(blender, names));
  window.full_width = 6;
  EXPECT_FALSE(is_plain(window, names));
  tiled.tile_width = tiled.tile_height = 2;
  EXPECT_FALSE(is_plain(tiled, names));

  ASSERT_TRUE(WriteGuides(folder / "g.exr", RandomGuides(40, 30)));
  EXPECT_TRUE(internal::ReadPlainGuides(folder / "g.exr", Everything()));
  GuideReadOptions layer = Everything();
  layer.view_layer = "V";
  EXPECT_FALSE(internal::ReadPlainGuides(folder / "g.exr", layer));
  const auto whole = ReadWholeFile(folder / "g.exr");
  ASSERT_TRUE(whole);
  ASSERT_TRUE(WriteFileAtomically(folder / "cut.exr", std::span(whole->data(), whole->size() * 3 / 4)));
  EXPECT_FALSE(internal::ReadPlainGuides(folder / "cut.exr", Everything()));
  EXPECT_FALSE(internal::ReadPlainGuides(folder / "missing.exr", Everything()));
  EXPECT_FALSE(internal::ReadPlainGuides(folder.path(), Everything()));
}

}  // namespace
}  // namespace scumble
