// Numbers at the ends of their formats: equal results in style files, options and calls, and in the half floats of EXR
// files.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/style/style_file.h"
#include "tests/support/cli_harness.h"
#include "tests/support/numbers.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr float kLargestHalf = 65504.0f;

class ExtremeFiles : public CliTest {
 protected:
  // What `transfer.KEY = TEXT` means in style.toml and behind --set; nothing where it is refused.
  std::optional<float> InFile(const std::string& key, const std::string& text, float TransferSettings::*field) {
    WritePainted("style/lit.png", 16, 16);
    WriteText("style/style.toml", "[transfer]\n" + key + " = " + text + "\n[[exemplar]]\nimage = \"lit.png\"\n");
    const auto style = LoadStyle(At("style"));
    if (!style) {
      EXPECT_EQ(style.error().kind, ErrorKind::kInput) << "the file's mistake";
    }
    return style ? std::optional(style->transfer.*field) : std::nullopt;
  }
  std::optional<float> InOption(const std::string& key, const std::string& text, float TransferSettings::*field) {
    WritePainted("plain.png", 16, 16);
    const auto style = LoadStyle(At("plain.png"), *ParseStyleOverrides({"transfer." + key + "=" + text}));
    if (!style) {
      EXPECT_EQ(style.error().kind, ErrorKind::kUsage) << "the caller's mistake";
    }
    return style ? std::optional(style->transfer.*field) : std::nullopt;
  }
  // Guides with an albedo of our own.
  static GuideSet Tinted(const std::vector<float>& values) {
    GuideSet guides = Ball(24);
    guides.Add(Layer::kAlbedo);
    for (int c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < guides.pixel_count(); ++i)
        guides.Plane(Layer::kAlbedo, c)[i] = values[(i + std::size_t(c)) % values.size()];
    }
    return guides;
  }
  // All channels of an EXR file as OpenImageIO has them, in floats, and what they were stored in.
  struct Channels {
    std::vector<std::string> names;
    std::vector<OIIO::TypeDesc> types;
    std::vector<float> pixels;
    std::size_t pixel_count = 0;
  };
  Channels ByOpenImageIO(const std::string& name) const {
    Channels all;
    const auto input = OIIO::ImageInput::open(At(name).string());
    EXPECT_TRUE(input);
    if (!input) return all;
    const OIIO::ImageSpec& spec = input->spec();
    all.names = spec.channelnames;
    for (int c = 0; c < spec.nchannels; ++c) all.types.push_back(spec.channelformat(c));
    all.pixel_count = std::size_t(spec.width) * spec.height;
    all.pixels.resize(all.pixel_count * spec.nchannels);
    EXPECT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, all.pixels.data()));
    return all;
  }
  // A file as another program writes it: our channels, albedo in half floats, whatever it becomes there.
  void WriteHalfByOpenImageIO(const std::string& name, const GuideSet& guides) {
    std::vector<std::string> names;
    std::vector<OIIO::TypeDesc> types;
    std::vector<std::span<const float>> planes;
    for (const LayerInfo& info : AllLayers()) {
      for (int c = 0; guides.Has(info.layer) && c < ChannelCount(info.layer); ++c) {
        names.push_back(info.channels[std::size_t(c)]);
        types.push_back(info.layer == Layer::kAlbedo ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
        planes.push_back(guides.Plane(info.layer, c));
      }
    }
    OIIO::ImageSpec spec(guides.width(), guides.height(), static_cast<int>(names.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames = names, spec.channelformats = types;
    std::vector<float> pixels;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      for (const auto& plane : planes) pixels.push_back(plane[i]);
    }
    const auto output = OIIO::ImageOutput::create(At(name).string());
    ASSERT_TRUE(output && output->open(At(name).string(), spec));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close());
  }
};

// ---- numbers of keys -----------------------------------------------------------------------------------------------

struct Written {
  const char* text;
  std::optional<float> expected;  // nothing: refused
};

// A double outside a float's range becomes the nearest equivalent float: infinite where it is larger than all, and
// above 0 where it is above 0, because a threshold of 0 accepts nothing and any other exact copies.
TEST_F(ExtremeFiles, ThresholdsMeanTheSameInFilesOptionsAndCalls) {
  const Written all[] = {
      {"0", 0.0f},
      {"0.0", 0.0f},
      {"-0.0", 0.0f},
      {"1e-45", std::numeric_limits<float>::denorm_min()},
      {"1e-300", std::numeric_limits<float>::denorm_min()},
      {"1e-40", 1e-40f},
      {"0.125", 0.125f},
      {"1e30", 1e30f},
      {"1e39", kInfinity},
      {"1e308", kInfinity},
      {"inf", kInfinity},
      {"+inf", kInfinity},
      {"-inf", std::nullopt},
      {"nan", std::nullopt},
      {"-nan", std::nullopt},
      {"-1e-300", std::nullopt},
      {"-1", std::nullopt},
      {"\"much\"", std::nullopt},
  };
  for (const auto& [key, field] : {std::pair("threshold", &TransferSettings::threshold),
                                   {"luminance_weight", &TransferSettings::luminance_weight}}) {
    for (const auto& [text, expected] : all) {
      EXPECT_EQ(InFile(key, text, field), expected) << key << " = " << text;
      EXPECT_EQ(InOption(key, text, field), expected) << key << "=" << text;
    }
    EXPECT_FALSE(InOption(key, "NaN", field)) << "no TOML, and no number";
  }
  const auto prepares = [](float value, float TransferSettings::*field) {
    Style style;
    style.exemplars.push_back({"test.png", Painted(8, 8), std::nullopt});
    style.transfer.*field = value;
    return Prepare(style, 100).ok();
  };
  for (const auto field : {&TransferSettings::threshold, &TransferSettings::luminance_weight}) {
    for (const float good : {0.0f, -0.0f, std::numeric_limits<float>::denorm_min(), 1e30f, kInfinity})
      EXPECT_TRUE(prepares(good, field));
    for (const float bad : {kNan, -kNan, -std::numeric_limits<float>::denorm_min(), -kInfinity})
      EXPECT_FALSE(prepares(bad, field));
  }
}

// The message names the option, and the exit code is that of a usage error, or of a bad file.
TEST_F(ExtremeFiles, TheProgramRefusesThemToo) {
  WriteGuideFile("g.exr", Ball(16));
  WriteStyle("style");
  const Arguments transfer = {"transfer", "g.exr", "--style", "style", "-o", "p.png"};
  ExpectError(With(transfer, {"--set", "transfer.threshold=nan"}), 2, {"transfer.threshold", "0 or more"});
  ExpectError(With(transfer, {"--set", "transfer.levels=17"}), 2, {"transfer.levels", "1 to 16"});
  ExpectError(With(transfer, {"--set", "transfer.blend_radius=65"}), 2, {"transfer.blend_radius", "0 to 64"});
  RunOk(With(transfer,
             {"--set", "transfer.threshold=inf", "--set", "transfer.levels=16", "--set", "transfer.blend_radius=64"}));
  WriteText("style/style.toml", "[transfer]\nthreshold = nan\n[[exemplar]]\nimage = \"lit.png\"\n");
  ExpectError(transfer, 3, {"style.toml:2", "transfer.threshold"});
}

// One process that casts rays first must not leave arithmetic that flushes the smallest floats to 0.
TEST_F(ExtremeFiles, TheSmallestThresholdIsTheSameInOneStepAndInTwo) {
  WriteStyle("style");
  const Arguments key = {"--style", "style", "--set", "transfer.threshold=1e-45", "--threads", "2"};
  RunOk({"guidegen", Scene("stilllife.glb"), "--size", "96x54", "-o", "g.exr", "--style", "style"});
  RunOk(With({"transfer", "g.exr", "-o", "two.png"}, key));
  RunOk(With({"stylize", Scene("stilllife.glb"), "--size", "96x54", "-o", "one.png"}, key));
  EXPECT_EQ(Pixels("one.png"), Pixels("two.png"));
}

// ---- half floats ---------------------------------------------------------------------------------------------------

// Half floats end at 65504: a colour beyond becomes that, not infinity, which would be no colour. Halves below are
// rounded to the nearest (65520 is the middle to the next step of 32, which there is none of). OpenImageIO reads what
// was written.
TEST_F(ExtremeFiles, WhatIsWrittenAsHalfStaysFinite) {
  const std::vector<float> values = {65504.0f, 65519.0f, 65520.0f, 1e6f, 3e38f, -1e6f, 65503.0f, 2049.0f, 1e-8f};
  const std::vector<float> expected = {kLargestHalf,  kLargestHalf, kLargestHalf, kLargestHalf, kLargestHalf,
                                       -kLargestHalf, 65504.0f,     2048.0f,      0.0f};
  GuideSet guides = Tinted(values);
  ASSERT_TRUE(WriteGuides(At("half.exr"), guides, {.half = true}));
  const Channels found = ByOpenImageIO("half.exr");
  std::size_t halves = 0;
  for (std::size_t c = 0; c < found.names.size(); ++c) {
    const bool albedo = found.names[c].rfind("albedo", 0) == 0;
    EXPECT_EQ(found.types[c] == OIIO::TypeDesc::HALF, albedo) << found.names[c];
    if (!albedo) continue;
    ++halves;
    const std::size_t component = std::string("RGB").find(found.names[c].back());
    for (std::size_t i = 0; i < found.pixel_count; ++i) {
      ASSERT_EQ(found.pixels[i * found.names.size() + c], expected[(i + component) % expected.size()]) << i;
    }
  }
  EXPECT_EQ(halves, 3u);
  // In memory they are rounded to the same.
  RoundColorLayersToHalf(guides);
  GuideReadOptions read;
  read.required.Add(Layer::kAlbedo);
  const auto back = ReadGuides(At("half.exr"), read);
  ASSERT_TRUE(back);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(BytesOf(back->Plane(Layer::kAlbedo, c)), BytesOf(guides.Plane(Layer::kAlbedo, c)));
  }
}

// Another program's halves may be infinite: the error gives the place, and nothing is painted. Up to the largest half
// they are read.
TEST_F(ExtremeFiles, InfiniteHalvesAreRefusedWithTheirPlace) {
  WriteStyle("style");
  WriteHalfByOpenImageIO("good.exr", Tinted({kLargestHalf, -kLargestHalf, 0.5f}));
  const Arguments tint = {"--style", "style", "--set", "transfer.colorize=1", "-o", "p.png"};
  RunOk(With({"transfer", "good.exr"}, tint));
  std::filesystem::remove(At("p.png"));
  for (const float beyond : {1e6f, kInfinity, -kInfinity, kNan}) {
    WriteHalfByOpenImageIO("bad.exr", Tinted({0.5f, beyond, 0.5f, 0.5f}));
    ExpectError(With({"transfer", "bad.exr"}, tint), 3,
                {"bad.exr", "layer albedo is NaN or infinite on ", "first at ("});
    EXPECT_FALSE(Exists("p.png"));
  }
}

// Whatever a base colour is, paint is 0 to 1: the brightest tint is white where the paint is not black, a negative one
// black.
TEST_F(ExtremeFiles, TintsBeyondOneSaturate) {
  WriteStyle("style");
  const auto painted = [&](float albedo) {
    WriteGuideFile("g.exr", Tinted({albedo}));
    RunOk({"transfer", "g.exr", "--style", "style", "--set", "transfer.colorize=1", "-o", "p.png", "--bits", "16"});
    const auto picture = ReadPicture(At("p.png"));
    EXPECT_TRUE(picture);
    return std::vector<int>(picture->At(12, 12), picture->At(12, 12) + 4);
  };
  for (const float bright : {kLargestHalf, 1e30f, std::numeric_limits<float>::max()})
    EXPECT_EQ(painted(bright), std::vector<int>({65535, 65535, 65535, 65535})) << bright;
  for (const float dark : {0.0f, -1.0f, -1e30f}) EXPECT_EQ(painted(dark), std::vector<int>({0, 0, 0, 65535})) << dark;
}

// A painted sphere in linear floats: values brighter than white become white, NaN and values below black become black.
TEST_F(ExtremeFiles, ExemplarsInFloatsSaturate) {
  const float values[] = {kInfinity, 1e30f, kLargestHalf, 1.0f, 0.0f, -1.0f, -kInfinity, kNan};
  const int expected[] = {65535, 65535, 65535, 65535, 0, 0, 0, 0};
  for (const auto type : {OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::HALF}) {
    for (std::size_t k = 0; k < std::size(values); ++k) {
      OIIO::ImageSpec spec(8, 8, 3, type);
      const std::vector<float> pixels(3 * 64, values[k]);
      const auto output = OIIO::ImageOutput::create(At("e.exr").string());
      ASSERT_TRUE(output && output->open(At("e.exr").string(), spec));
      ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close());
      const auto picture = ReadPicture(At("e.exr"));
      ASSERT_TRUE(picture);
      EXPECT_EQ(picture->At(3, 3)[0], expected[k]) << values[k];
      EXPECT_EQ(picture->At(3, 3)[3], 65535);
    }
  }
}

// ---- luminances of files -------------------------------------------------------------------------------------------

// Half floats end at 65504, and larger depths are written as infinite. Two such pixels are equally far, so they are no
// edge: the picture is that of a wall at 60000 m, with the same step before it.
TEST_F(ExtremeFiles, DepthsBeyondHalfFloats) {
  WritePainted("style/lit.png", 32, 32);
  WriteText("style/style.toml",
            "[transfer]\nreference_height = 0\nlevels = 4\nblend_radius = 3\n[[exemplar]]\nimage = \"lit.png\"\n");
  const auto painted = [&](float wall, bool stepped) {
    GuideSet guides = Ball(32);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      if (guides.Plane(Layer::kCoverage)[i] > 0.0f)
        guides.Plane(Layer::kDepth)[i] = stepped && i % 32 < 16 ? 2.0f : wall;
    }
    WriteGuideFile("g.exr", guides);
    RunOk({"transfer", "g.exr", "--style", "style", "-o", "p.png"});
    return Pixels("p.png");
  };
  for (const bool stepped : {false, true}) {
    EXPECT_TRUE(painted(kInfinity, stepped) == painted(60000.0f, stepped)) << stepped;
  }
  EXPECT_FALSE(painted(kInfinity, true) == painted(kInfinity, false)) << "the step is an edge";
}

// Negative light, from denoisers, counts as darkness; NaN and infinity are reported with their place.
TEST_F(ExtremeFiles, LuminancesThatAreNone) {
  WritePainted("style/lit.png", 32, 32), WritePainted("style/shade.png", 32, 32);
  WriteText("style/style.toml",
            "[transfer]\nreference_height = 0\nlevels = 4\n[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.8\n"
            "[[exemplar]]\nimage = \"shade.png\"\nluminance = 0.1\n");
  const auto write = [&](float value) {
    GuideSet guides = Ball(32);
    guides.Add(Layer::kLuminance);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kLuminance)[i] = i % 3 ? 0.5f : value;
    WriteGuideFile("g.exr", guides);
  };
  const Arguments transfer = {"transfer", "g.exr", "--style", "style", "-o", "p.png"};
  write(0.0f);
  RunOk(transfer);
  const std::string dark = Pixels("p.png");
  for (const float negative : {-1.0f, -0.0f, -1e30f}) {
    write(negative);
    RunOk(transfer);
    EXPECT_EQ(Pixels("p.png"), dark) << negative;
  }
  std::filesystem::remove(At("p.png"));
  for (const float none : {kNan, kInfinity, -kInfinity}) {
    write(none);
    ExpectError(transfer, 3, {"g.exr", "layer luminance is NaN or infinite on "});
    EXPECT_FALSE(Exists("p.png"));
  }
}

}  // namespace
}  // namespace scumble
