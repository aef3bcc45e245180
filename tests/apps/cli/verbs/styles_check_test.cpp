// scumble styles check: its messages, their channel, and its exit codes.
#include <set>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"
#include "tests/support/painted_spheres.h"

namespace scumble {
namespace {

class StylesCheck : public CliTest {
 protected:
  void Write(const std::string& name, const Picture& picture) {
    std::filesystem::create_directories(At(name).parent_path());
    const Status written = WritePicture(At(name), picture);
    ASSERT_TRUE(written) << written.error().message;
  }
  std::set<std::string> CodesOf(const nlohmann::json& report) {
    std::set<std::string> codes;
    for (const auto& fault : report["faults"]) codes.insert(fault["code"].get<std::string>());
    return codes;
  }
  std::set<std::string> CodesIn(const std::string& style) {
    return CodesOf(RunOk({"styles", "check", style, "--json"}).Json());
  }
};

using Codes = std::set<std::string>;

TEST_F(StylesCheck, AGoodStyleIsSilent) {
  Write("good.png", PaintSphere({}));
  const CommandResult check = RunOk({"styles", "check", "good.png", "--strict"});
  EXPECT_EQ(check.err, "");
  EXPECT_TRUE(Contains(check.out, "good: 512² pixels, tonal range")) << check.out;
  EXPECT_TRUE(Contains(check.out, "usable\n")) << check.out;
  const nlohmann::json json = RunOk({"styles", "check", "good.png", "--json"}).Json();
  EXPECT_TRUE(json["faults"].is_array() && json["faults"].empty()) << json["faults"];
  const nlohmann::json& paint = json["exemplars"][0];
  EXPECT_GT(paint["covered_percent"], 99.0);
  EXPECT_NEAR(paint["painted_light"]["azimuth"].get<double>(), -40.0, 10.0);
  EXPECT_NEAR(paint["template_light"]["azimuth"].get<double>(), -40.0, 10.0);
  for (const char* key : {"transparent_percent", "lightness", "anisotropy", "regularity", "holes", "fringe_percent",
                          "template_percent"}) {
    EXPECT_TRUE(paint.contains(key)) << key;
  }
}

TEST_F(StylesCheck, MistakesAreWarningsAndStrictCountsThem) {
  PaintedSphere shifted;
  shifted.x = 0.53, shifted.reach = 1.0, shifted.waver = 0.0;
  Write("off.png", PaintSphere(shifted));
  const CommandResult plain = RunOk({"styles", "check", "off.png"});
  EXPECT_TRUE(Contains(plain.Warning(), "off.png: the painted sphere is 3.0% of its diameter off the middle"))
      << plain.err;
  EXPECT_TRUE(Contains(plain.Warning(), "pixels to the left")) << plain.err;
  EXPECT_TRUE(Contains(plain.out, "usable, with 1 mistake\n")) << plain.out;
  EXPECT_EQ(Run({"styles", "check", "off.png", "--strict"}).code, 1);
  const CommandResult json = Run({"styles", "check", "off.png", "--strict", "--json"});
  EXPECT_EQ(json.code, 1);
  EXPECT_EQ(CodesOf(json.Json()), Codes{"off-centre"});
  EXPECT_EQ(json.Json()["faults"][0]["weight"], "mistake");
  EXPECT_TRUE(Contains(json.Json()["faults"][0]["image"], "off.png"));
}

TEST_F(StylesCheck, RemarksAreNoMistakes) {
  PaintedSphere right;
  right.azimuth = 40.0;
  Write("right.png", PaintSphere(right));
  const CommandResult check = RunOk({"styles", "check", "right.png", "--strict"});
  EXPECT_EQ(check.err, "");
  EXPECT_TRUE(Contains(check.out, "usable, 1 remark\n")) << check.out;
  EXPECT_TRUE(Contains(check.out, "remark: right.png: the painted light comes from azimuth ")) << check.out;
}

TEST_F(StylesCheck, SeveralStyles) {
  Write("good.png", PaintSphere({}));
  PaintedSphere pale;
  pale.dark = 0.5, pale.light = 0.6, pale.grain = 0.02;
  Write("pale.png", PaintSphere(pale));
  const CommandResult two = RunOk({"styles", "check", "good.png", "pale.png"});
  EXPECT_TRUE(Contains(two.Warning(), "pale.png: light and dark differ by")) << two.err;
  EXPECT_TRUE(Contains(two.out, "2 styles: 1 without a mistake, 1 with 1 mistakes, 0 cannot be used\n")) << two.out;
  const nlohmann::json json = RunOk({"styles", "check", "good.png", "pale.png", "--json"}).Json();
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(CodesOf(json[1]), Codes{"flat"});
  // One that cannot be read hides none of the others.
  WriteText("broken.png", "no picture");
  const CommandResult three = Run({"styles", "check", "broken.png", "good.png"});
  EXPECT_EQ(three.code, 3);
  EXPECT_TRUE(Contains(three.Warning(), "broken.png cannot be used")) << three.err;
  EXPECT_TRUE(Contains(three.out, "good: 512²")) << three.out;
  EXPECT_TRUE(Contains(three.out, "1 cannot be used")) << three.out;
  ExpectError({"styles", "check", "broken.png"}, 3, {"broken.png"});
}

// The kit's own grey, in the light of its guides, margin or no margin.
TEST_F(StylesCheck, WhatIsLeftOfTheKitsTemplate) {
  RunOk({"sphere", "--size", "512", "-o", "kit", "--light", "60,20", "-q"});
  const Expected<Picture> drawn = ReadPicture(At("kit/template.png"));
  ASSERT_TRUE(drawn);
  ASSERT_EQ(drawn->width, 640);
  Write("kit/lit.png", *drawn);
  const nlohmann::json untouched = RunOk({"styles", "check", "kit", "--json"}).Json();
  EXPECT_EQ(CodesOf(untouched).count("bare-template"), 1u);
  EXPECT_GT(untouched["exemplars"][0]["template_percent"], 95.0);
  // Painted except for one region, whose place is reported in pixels of the file.
  PaintedSphere sphere;
  sphere.azimuth = 60.0, sphere.elevation = 20.0, sphere.paper = 1.0;
  const Picture paint = PaintSphere(sphere);
  Picture whole = *drawn;
  for (int y = 0; y < 512; ++y) std::copy_n(paint.At(0, y), 4 * 512, whole.At(64, y + 64));
  Write("kit/lit.png", whole);
  EXPECT_EQ(CodesIn("kit"), Codes{});
  for (int y = 300; y < 350; ++y) std::copy_n(drawn->At(300, y), 4 * 50, whole.At(300, y));
  Write("kit/lit.png", whole);
  const nlohmann::json patch = RunOk({"styles", "check", "kit", "--json"}).Json();
  EXPECT_EQ(CodesOf(patch), Codes{"bare-template"});
  EXPECT_NEAR(patch["faults"][0]["x"].get<int>(), 325, 2);
  EXPECT_NEAR(patch["faults"][0]["y"].get<int>(), 325, 2);
  EXPECT_EQ(patch["exemplars"][0]["margin"], 64);
  // Moved on its canvas, marks and all.
  Picture moved(640, 640);
  std::fill(moved.rgba.begin(), moved.rgba.end(), std::uint16_t{65535});
  for (int y = 20; y < 640; ++y) std::copy_n(whole.At(0, y), 4 * 610, moved.At(30, y - 20));
  Write("kit/lit.png", moved);
  const CommandResult aside = RunOk({"styles", "check", "kit"});
  EXPECT_TRUE(Contains(aside.err,
                       "its centre is at x=350, y=300; move the painting 30 pixels to the left and 20 pixels "
                       "down"))
      << aside.err;
  // Painted for another light than the template's.
  sphere.azimuth = -60.0;
  Write("kit/lit.png", PaintSphere(sphere));
  EXPECT_EQ(CodesIn("kit"), Codes{"other-light"});
  // The same picture without guides, margin included, is no exemplar.
  WriteText("bare/style.toml", "[[exemplar]]\nimage = \"lit.png\"\n");
  for (int y = 0; y < 512; ++y) std::copy_n(paint.At(0, y), 4 * 512, whole.At(64, y + 64));
  Write("bare/lit.png", whole);
  ExpectError({"styles", "check", "bare"}, 3, {"bare/lit.png is a whole template", "crop"});
}

TEST_F(StylesCheck, ARimThatTakesMostOfTheSphere) {
  Write("rim/lit.png", PaintSphere({}));
  const auto write = [&](const std::string& rim) {
    WriteText("rim/style.toml", "[transfer]\nrim = " + rim + "\n[[exemplar]]\nimage = \"lit.png\"\n");
  };
  for (const char* rim : {"0", "128"}) {
    write(rim);
    EXPECT_LE(RunOk({"styles", "check", "rim", "--json"}).Json()["exemplars"][0]["fringe_percent"], 0.0) << rim;
  }
  write("300");
  ExpectError({"styles", "check", "rim"}, 3,
              {"lit.png is 512×512: transfer.rim = 300 leaves too little of the sphere", "at most 128"});
}

TEST_F(StylesCheck, AStyleWithoutAPaintingHasNoMistakes) {
  WriteText("mine/style.toml", "[transfer]\nmethod = \"toon\"\n");
  const CommandResult check = RunOk({"styles", "check", "toon", "mine", "--strict"});
  EXPECT_EQ(check.err, "");
  EXPECT_TRUE(Contains(check.out, "toon: no painting, method toon: usable\nmine: no painting, method toon: usable\n"))
      << check.out;
  const nlohmann::json json = RunOk({"styles", "check", "toon", "--json"}).Json();
  EXPECT_EQ(json["method"], "toon");
  EXPECT_TRUE(json["exemplars"].empty() && json["faults"].empty()) << json;
  ExpectError({"tradeoff", Scene("suzanne.glb"), "--style", "toon", "--size", "16x9", "--no-memory"}, 2,
              {"measures paint, and method toon has none"});
}

TEST_F(StylesCheck, LightsOfOneStyle) {
  PaintedSphere lit, shade;
  shade.dark = 0.05, shade.light = 0.3, shade.azimuth = 0.0, shade.elevation = 80.0, shade.size = 256;
  Write("two/lit.png", PaintSphere(lit));
  Write("two/shade.png", PaintSphere(shade));
  WriteText(
      "two/style.toml",
      "[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.7\n[[exemplar]]\nimage = \"shade.png\"\nluminance = 0.1\n");
  const nlohmann::json json = RunOk({"styles", "check", "two", "--json"}).Json();
  EXPECT_EQ(CodesOf(json), Codes{"other-size"});
  EXPECT_TRUE(Contains(json["faults"][0]["image"], "shade.png"));
}

// That they pass `styles check --strict` is a part of traits_are_current.
TEST_F(StylesCheck, EveryBundledStyleHasAThumbnail) {
  const auto listed = RunOk({"styles", "--json"}).Json();
  EXPECT_GE(listed.size(), 20u);
  for (const auto& style : listed) {
    ASSERT_TRUE(style.contains("thumbnail")) << style;
    EXPECT_TRUE(std::filesystem::exists(style["thumbnail"].get<std::string>())) << style;
  }
}

}  // namespace
}  // namespace scumble
