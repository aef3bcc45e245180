// The exemplars of a style: their pictures, their guides, and the light that they are for.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "tests/core/style/style_fixtures.h"
#include "tests/support/picture_files.h"
#include "tests/support/refusal.h"

namespace scumble {
namespace {

TEST_F(StyleFile, WhatAnExemplarNeeds) {
  const std::string e = kExemplar;
  ExpectRefusal(Load("name = 'x'\n"), ErrorKind::kInput, {"style.toml", "no [[exemplar]]", "image = \"lit.png\""});
  ExpectRefusal(Load("exemplar = []\n"), ErrorKind::kInput, {"no [[exemplar]]"});
  ExpectRefusal(Load(e + e + e + e + e), ErrorKind::kInput, {"style.toml:1", "5 exemplars", "up to 4"});
  ExpectRefusal(Load("[exemplar]\nimage = 'lit.png'\n"), ErrorKind::kInput, {"style.toml:1", "two brackets"});
  ExpectRefusal(Load("exemplar = [3]\n"), ErrorKind::kInput, {"two brackets"});
  ExpectRefusal(Load("[[exemplar]]\n"), ErrorKind::kInput, {"style.toml:1", "no image"});
  ExpectRefusal(Load("[[exemplar]]\nimage = ''\n"), ErrorKind::kInput, {"no image"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 3\n"), ErrorKind::kInput, {"style.toml:2", "exemplar.image", "in quotes"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 'missing.png'\n"), ErrorKind::kInput, {"missing.png", "no such file"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 'style.toml'\n"), ErrorKind::kInput, {"style.toml"});
  ExpectRefusal(Load("[[exemplar]]\nimage = '.'\n"), ErrorKind::kInput, {"folder"});
  for (const char* bad : {"-0.1", "'bright'", "nan", "inf", "true"}) {
    ExpectRefusal(Load(e + "luminance = " + bad + "\n"), ErrorKind::kInput, {"style.toml:3", "exemplar.luminance"});
  }
  ExpectRefusal(Load(e + "guides = 'no.exr'\n"), ErrorKind::kInput, {"no.exr", "no such file"});
  ExpectRefusal(Load(e + "guides = 'lit.png'\n"), ErrorKind::kInput, {"lit.png", "no layer"});
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", NoisyPicture(8, 6)));
  ExpectRefusal(Load(e), ErrorKind::kInput, {"lit.png", "8×6", "square"});
}

GuideSet BallGuides(int width, int height, float luminance) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kLuminance}) guides.Add(layer);
  for (int i = 0; i < width * height; ++i) {
    const float u = (2.0f * float(i % width) + 1) / float(width) - 1,
                v = 1 - (2.0f * float(i / width) + 1) / float(height);
    if (u * u + v * v >= 1.0f) continue;
    guides.Plane(Layer::kCoverage)[i] = 1.0f;
    const float values[3] = {u, v, std::sqrt(1.0f - u * u - v * v)};
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = values[c];
    guides.Plane(Layer::kLuminance)[i] = luminance;
  }
  return guides;
}

TEST_F(StyleFile, GuidesOfAnySceneOfThePicturesSize) {
  ASSERT_TRUE(WritePicture(folder_ / "wide.png", NoisyPicture(24, 16)));
  ASSERT_TRUE(WriteGuides(folder_ / "wide.exr", BallGuides(24, 16, 0.5f)));
  const std::string wide = "[[exemplar]]\nimage = 'wide.png'\n", guides = "guides = 'wide.exr'\n";
  const auto style = Load(wide + guides);
  ASSERT_TRUE(style) << style.error().message;
  const Exemplar& exemplar = style->exemplars[0];
  EXPECT_FALSE(exemplar.is_sphere);
  ASSERT_TRUE(exemplar.guides);
  EXPECT_EQ(exemplar.guides->width(), 24);
  EXPECT_EQ(exemplar.guides->layers(), (LayerSet{Layer::kCoverage, Layer::kNormal}))
      << "one exemplar: light is not read";
  const std::size_t middle = exemplar.guides->Index(12, 8);
  EXPECT_EQ(exemplar.guides->Vec3(Layer::kNormal, middle), BallGuides(24, 16, 0.5f).Vec3(Layer::kNormal, middle));
  EXPECT_EQ(exemplar.picture.rgba, NoisyPicture(24, 16).rgba);
  const auto several = Load(wide + guides + wide + guides + "luminance = 0.1\n");
  ASSERT_TRUE(several) << several.error().message;
  EXPECT_TRUE(several->exemplars[0].guides->Has(Layer::kLuminance)) << "its luminance is to be measured";
  EXPECT_FALSE(several->exemplars[1].guides->Has(Layer::kLuminance)) << "known";
  ExpectRefusal(Load(wide), ErrorKind::kInput, {"wide.png", "24×16", "square", "guides"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 'lit.png'\n" + guides), ErrorKind::kInput,
                {"lit.png is 8×8", "wide.exr are 24×16"});
  GuideSet flat = BallGuides(24, 16, 0.5f);
  flat.Remove(Layer::kNormal);
  flat.Add(Layer::kDepth);
  ASSERT_TRUE(WriteGuides(folder_ / "wide.exr", flat));
  ExpectRefusal(Load(wide + guides), ErrorKind::kInput, {"wide.exr", "normal"});
}

TEST_F(StyleFile, GuidesOfTheSphereKitAreReadForTheirLightOnly) {
  GuideSet kit = BallGuides(8, 8, 0.25f);
  kit.attributes["scumble:sphereMargin"] = "2";
  ASSERT_TRUE(WriteGuides(folder_ / "guides.exr", kit));
  const std::string one = std::string(kExemplar) + "guides = 'guides.exr'\n";
  auto style = Load(one);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_TRUE(style->exemplars[0].is_sphere);
  EXPECT_FALSE(style->exemplars[0].guides);
  style = Load(one + one + "luminance = 0.9\n");
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_TRUE(style->exemplars[0].is_sphere);
  ASSERT_TRUE(style->exemplars[0].guides);
  EXPECT_TRUE(style->exemplars[0].guides->Has(Layer::kLuminance));
  EXPECT_FALSE(style->exemplars[1].guides);
  // The whole painted template: its margin is cut off.
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", NoisyPicture(12, 12)));
  style = Load(one);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->exemplars[0].picture.width, 8);
  const Picture whole = NoisyPicture(12, 12), &cut = style->exemplars[0].picture;
  EXPECT_EQ(std::vector<int>(cut.At(0, 0), cut.At(0, 0) + 32), std::vector<int>(whole.At(2, 2), whole.At(2, 2) + 32));
}

TEST_F(StyleFile, GuideWeightsAreATableOfLayers) {
  GuideSet guides(8, 8);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kLuminance, Layer::kLpeLDE}) guides.Add(layer);
  for (float& value : guides.Plane(Layer::kCoverage)) value = 1.0f;
  for (float& value : guides.Plane(Layer::kNormal, 2)) value = 1.0f;
  ASSERT_TRUE(WriteGuides(folder_ / "guides.exr", guides));
  const std::string exemplar = kExemplar + std::string("guides = \"guides.exr\"\n");
  const LayerSet lit{Layer::kNormal, Layer::kLuminance, Layer::kLpeLDE};
  for (const char* table : {"[transfer.guide_weights]\nluminance = 2\n\"lpe.LDE\" = 0.5\n",
                            "[transfer.guide_weights]\nluminance = 2\nlpe.LDE = 0.5\n",
                            "[transfer]\nguide_weights = {luminance = 2, \"lpe.LDE\" = 0.5}\n"}) {
    const auto style = Load(table + exemplar);
    ASSERT_TRUE(style) << table << style.error().message;
    EXPECT_EQ(style->transfer.guide_weights[Layer::kNormal], 1.0f);
    EXPECT_EQ(style->transfer.guide_weights[Layer::kLuminance], 2.0f);
    EXPECT_EQ(style->transfer.guide_weights[Layer::kLpeLDE], 0.5f);
    EXPECT_TRUE(style->transfer.guide_weights.Layers() == lit);
    EXPECT_TRUE(RequiredLayers(*style).Contains(lit));
    ASSERT_TRUE(style->exemplars[0].guides);
    EXPECT_TRUE(style->exemplars[0].guides->layers().Contains(lit));
  }
  const auto neutral = Load("[transfer.guide_weights]\nluminance = 0\nnormal = 1.0\n" + exemplar);
  ASSERT_TRUE(neutral);
  EXPECT_TRUE(neutral->transfer.guide_weights.ArePlain());
  EXPECT_FALSE(RequiredLayers(*neutral).Has(Layer::kLuminance));
  const auto set = Load(exemplar, {"transfer.guide_weights.lpe.LDE=3", "transfer.guide_weights.normal=0"});
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->transfer.guide_weights[Layer::kLpeLDE], 3.0f);
  EXPECT_EQ(set->transfer.guide_weights[Layer::kNormal], 0.0f);
  const auto refuse = [&](const std::string& toml, const std::vector<std::string>& words) {
    SCOPED_TRACE(toml);
    ExpectRefusal(Load(toml), ErrorKind::kInput, words);
  };
  refuse("[transfer.guide_weights]\nluminance = 1\n" + std::string(kExemplar), {"lit.png has no guides", "luminance"});
  refuse("[transfer.guide_weights]\nshadow = 1\n" + exemplar, {"guides.exr holds", "asks for shadow", "--layers"});
  for (const std::string layer : {"depth", "cosine", "uv"}) {
    refuse("[transfer.guide_weights]\n" + layer + " = 1\n" + exemplar,
           {"style.toml:2", "unknown key", "there are normal, albedo"});
  }
  refuse("[transfer.guide_weights]\nluminance = -1\n" + exemplar, {"style.toml:2", "0 to 1000"});
  refuse("[transfer.guide_weights]\nluminance = [[1, 0], [9, 1]]\n" + exemplar, {"cannot change over time"});
}

TEST_F(StyleFile, UpToFourLightingConditions) {
  const std::string e = kExemplar;
  auto style = Load(e + "luminance = 0.8\n" + e + e + "luminance = 0\n" + e);
  ASSERT_TRUE(style) << style.error().message;
  ASSERT_EQ(style->exemplars.size(), 4u);
  EXPECT_EQ(style->exemplars[0].luminance, 0.8);
  EXPECT_EQ(style->exemplars[1].luminance, std::nullopt);
  EXPECT_EQ(style->exemplars[2].luminance, 0.0);
  EXPECT_TRUE(RequiredLayers(*style).Has(Layer::kLuminance));
  style =
      Load(std::string(
               "[transfer]\ncolorize = 0.5\ncolorize_mode = 'oklab'\nvariety = 10\nluminance_error = 'published'\n") +
           e);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->transfer.colorize, 0.5);
  EXPECT_EQ(style->transfer.colorize_mode, ColorizeMode::kOklab);
  EXPECT_EQ(style->transfer.variety, 10.0);
  EXPECT_EQ(style->transfer.luminance_error, LuminanceError::kPublished);
  EXPECT_TRUE(RequiredLayers(*style).Has(Layer::kAlbedo));
  EXPECT_FALSE(RequiredLayers(*style).Has(Layer::kLuminance));
}

TEST_F(StyleFile, TheExemplarIsThePictureAsPainted) {
  const auto style = Load(std::string("name = \"Kohle\"\nlicence = \"CC0-1.0\"\n") + kExemplar);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->name, "Kohle");
  EXPECT_EQ(style->licence, "CC0-1.0");
  ASSERT_EQ(style->exemplars.size(), 1u);
  EXPECT_EQ(style->exemplars[0].picture.rgba, NoisyPicture(8, 8).rgba);
  EXPECT_NE(style->exemplars[0].name.find("lit.png"), std::string::npos);
}

TEST_F(StyleFile, AnExemplarWithoutPaintIsRefused) {
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", Picture(8, 8)));
  ExpectRefusal(Load(kExemplar), {"lit.png shows no paint", "all of its pixels are transparent"});
  ExpectRefusal(LoadStyle(folder_ / "lit.png"), {"lit.png shows no paint"});
  EXPECT_TRUE(Load(kExemplar, {"transfer.method=toon"})) << "its paint is not looked at";
  std::vector<float> pixels(4 * 64, 0.5f);
  for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = std::numeric_limits<float>::quiet_NaN();
  WriteWith<float>(folder_ / "a.exr", OIIO::ImageSpec(8, 8, 4, OIIO::TypeDesc::FLOAT), pixels);
  std::filesystem::remove(folder_ / "style.toml");
  ExpectRefusal(LoadStyle(folder_ / "a.exr"), {"a.exr shows no paint: its alpha is NaN"});
}

}  // namespace
}  // namespace scumble
