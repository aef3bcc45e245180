// scumble compare --flip: of pictures, of layers of light, and as a verdict.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"
#include "tests/support/picture_files.h"

namespace scumble {
namespace {

class CliFlip : public CliTest {
 protected:
  // Guides with light of the same value everywhere.
  void WriteLight(const std::string& name, float grey, float red) {
    GuideSet guides = Ball(24);
    guides.Add(Layer::kLuminance);
    guides.Add(Layer::kLpeFull);
    std::fill_n(guides.Plane(Layer::kLuminance).begin(), guides.pixel_count(), grey);
    std::fill_n(guides.Plane(Layer::kLpeFull, 0).begin(), guides.pixel_count(), red);
    WriteGuideFile(name, guides);
  }
};

TEST_F(CliFlip, FlipOfPictures) {
  WritePainted("a.png", 24, 16);
  Picture black(24, 16), white(24, 16);
  for (std::size_t i = 3; i < black.rgba.size(); i += 4) black.rgba[i] = 65535;
  std::fill(white.rgba.begin(), white.rgba.end(), std::uint16_t{65535});
  ASSERT_TRUE(WritePicture(At("black.png"), black) && WritePicture(At("white.png"), white));
  const CommandResult same = RunOk({"compare", "a.png", "a.png", "--flip", "--json"});
  EXPECT_EQ(same.Json()["flip"], 0.0);
  EXPECT_EQ(same.Json()["rms"], 0.0);
  EXPECT_NEAR(double(same.Json()["pixels_per_degree"]), 67.02, 0.001);
  // The paper's formula for two flat colours whose lightness is 100 apart; flip_test.cpp has it.
  const CommandResult apart = RunOk({"compare", "black.png", "white.png", "--flip", "--json", "-o", "map.png"});
  EXPECT_NEAR(double(apart.Json()["flip"]), 0.9674, 2e-4);
  EXPECT_EQ(apart.Json()["rms"], 1.0);
  EXPECT_TRUE(Contains(RunOk({"compare", "a.png", "a.png", "--flip"}).out, "FLIP mean 0.000000"));
  const Expected<Picture> map = ReadPicture(At("map.png"));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->width, 24);
  EXPECT_GT(map->At(3, 3)[0], 50000) << "yellow";
  EXPECT_EQ(map->At(3, 3)[3], 65535);
  const CommandResult near = RunOk({"compare", "a.png", "white.png", "--flip", "--flip-ppd", "20", "--json"});
  EXPECT_NE(near.Json()["flip"], RunOk({"compare", "a.png", "white.png", "--flip", "--json"}).Json()["flip"]);
  ExpectError({"compare", "a.png", "white.png", "--flip", "--flip-ppd", "0"}, 2, {"pixels per degree", "more than 0"});
  ExpectError({"compare", "a.png", "white.png", "--flip-ppd", "20"}, 2, {"--flip-ppd", "--flip"});
  ExpectError({"compare", "a.png", "white.png", "--flip", "-failpercent", "1"}, 2, {"--flip", "--failpercent"});
  ExpectError({"compare", "a.png", "white.png", "--flip", "--motion", "a.exr"}, 2, {"--flip", "--motion"});
  WritePainted("wide.png", 25, 16);
  ExpectError({"compare", "a.png", "wide.png", "--flip"}, 3, {"24×16", "25×16", "one size"});
}

// The paper's formula for two flat colours whose lightness is 100 apart; flip_test.cpp has it.
constexpr double kBlackToWhite = 0.9674, kItsRounding = 2e-4;

TEST_F(CliFlip, FilesOfLayersAreNoPictures) {
  WriteLight("a.exr", 0.0f, 0.0f);
  WriteLight("b.exr", 1.0f, 0.0f);
  const std::vector<std::string> words = {"holds layers and no picture", "A, depth.Z", "expected R, G and B, or Y"};
  ExpectError({"compare", "a.exr", "b.exr", "--flip"}, 3,
              {"a.exr " + words[0], words[1], words[2], "--layer", "lpe.full, luminance"});
  ExpectError({"transfer", "a.exr", "--style", "b.exr", "-o", "p.png"}, 3, {"b.exr " + words[0], words[2]});
  ExpectError({"stylize", "a.glb", "--style", "b.exr", "-o", "p.png"}, 3, {"b.exr " + words[0]});
}

TEST_F(CliFlip, OfOneLayerOfLight) {
  WriteLight("a.exr", 0.0f, 0.25f);
  WriteLight("b.exr", 1.0f, 0.25f);
  const CommandResult grey =
      RunOk({"compare", "a.exr", "b.exr", "--flip", "--layer", "luminance", "--json", "-o", "map.png"});
  EXPECT_NEAR(double(grey.Json()["flip"]), kBlackToWhite, kItsRounding);
  EXPECT_EQ(grey.Json()["rms"], 1.0);
  EXPECT_EQ(grey.Json()["layer"], "luminance");
  const Expected<Picture> map = ReadPicture(At("map.png"));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->width, 24);
  const CommandResult red = RunOk({"compare", "a.exr", "b.exr", "--flip", "--layer", "lpe.full", "--json"});
  EXPECT_EQ(red.Json()["flip"], 0.0);
  // Twice the white is shown as white, with a message; so is NaN.
  WriteLight("c.exr", 2.0f, 0.25f);
  const CommandResult above = RunOk({"compare", "a.exr", "c.exr", "--flip", "--layer", "luminance"});
  EXPECT_TRUE(Contains(above.out, "FLIP mean 0.967")) << above.out;
  EXPECT_TRUE(Contains(above.err, "576 values of luminance lie outside")) << above.err;
  for (const std::string layer : {"normal", "depth", "lpe", "bogus"}) {
    ExpectError({"compare", "a.exr", "b.exr", "--flip", "--layer", layer}, 3,
                {"a.exr has no layer of light " + layer, "lpe.full, luminance"});
  }
  ExpectError({"compare", "a.exr", "b.exr", "--flip", "--layer", "luminance", "--layer", "lpe.full"}, 2,
              {"one --layer"});
  WritePainted("a.png", 24, 24);
  EXPECT_EQ(RunOk({"compare", "a.png", "a.png", "--flip", "--layer", "color", "--json"}).Json()["flip"], 0.0);
  ExpectError({"compare", "a.png", "a.exr", "--flip", "--layer", "luminance"}, 3,
              {"a.png has no layer of light", "it has none"});
}

TEST_F(CliFlip, ValuesOutsideOfPicturesAreToldAndNanFails) {
  const auto write = [&](const char* name, float value) {
    WriteWith<float>(At(name), OIIO::ImageSpec(4, 4, 3, OIIO::TypeDesc::FLOAT), std::vector<float>(48, value));
  };
  write("black.exr", 0.0f), write("white.exr", 1.0f), write("bright.exr", 7.0f), write("nan.exr", std::nanf(""));
  write("inf.exr", std::numeric_limits<float>::infinity());
  for (const std::string file : {"bright.exr", "inf.exr"}) {
    const CommandResult clamped = RunOk({"compare", "white.exr", file, "--flip", "--fail", "0.01", "--json"});
    EXPECT_TRUE(Contains(clamped.err, "48 values of color lie outside of 0 … 1")) << clamped.err;
    EXPECT_EQ(clamped.Json()["clamped_values"], 48);
  }
  const CommandResult nan = Run({"compare", "black.exr", "nan.exr", "--flip", "--fail", "0.01", "--json"});
  EXPECT_EQ(nan.code, 1) << nan.err;
  EXPECT_EQ(nan.Json()["nan_values"], 48);
  EXPECT_EQ(nan.Json()["verdict"], "fail");
  EXPECT_TRUE(Contains(nan.Warning(), "48 values of color are no numbers")) << nan.err;
  EXPECT_EQ(RunOk({"compare", "white.exr", "white.exr", "--flip", "--fail", "0"}).err, "");
  WriteLight("c.exr", std::nanf(""), 0.0f);
  EXPECT_EQ(Run({"compare", "c.exr", "c.exr", "--flip", "--layer", "luminance", "--fail", "1"}).code, 1);
}

TEST_F(CliFlip, FailIsALimitOfItsMean) {
  WriteLight("a.exr", 0.0f, 0.25f);
  WriteLight("b.exr", 1.0f, 0.25f);
  const auto run = [&](const Arguments& more) {
    Arguments all = {"compare", "a.exr", "b.exr", "--flip", "--layer", "luminance"};
    all.insert(all.end(), more.begin(), more.end());
    return Run(all);
  };
  EXPECT_EQ(run({}).code, 0) << "it only measures";
  EXPECT_EQ(run({"-fail", "0.968"}).code, 0);
  EXPECT_EQ(run({"-fail", "0.967"}).code, 1);
  EXPECT_EQ(run({"--fail", "0"}).code, 1);
  EXPECT_EQ(Run({"compare", "a.exr", "a.exr", "--flip", "--layer", "luminance", "--fail", "0"}).code, 0)
      << "not above it";
  EXPECT_EQ(run({"--fail", "0.967", "--json"}).Json()["verdict"], "fail");
  EXPECT_EQ(run({"--fail", "1", "--json"}).Json()["verdict"], "equal");
  EXPECT_TRUE(Contains(run({"--fail", "0.5"}).out, "fail: the mean may be 0.5"));
  EXPECT_EQ(run({"--fail", "-1"}).code, 2);
  EXPECT_EQ(run({"--fail", "nan"}).code, 2);
}

}  // namespace
}  // namespace scumble
