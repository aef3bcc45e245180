// [[finish]] in styles and presets, its keys, and what is said of mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/color_ramp.h"
#include "core/style/finish/finish_mask_keys.h"
#include "core/style/finish_keys.h"
#include "core/style/finish_preset.h"
#include "core/style/style_file.h"
#include "core/style/style_keyframes.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// What a --set makes of a chain.
Expected<std::size_t> Set(FinishChain& chain, const std::string& text) {
  SCUMBLE_ASSIGN(const StyleOverride set, ParseOverride(text));
  return OverrideFinish(chain, set);
}
Expected<std::size_t> Set(std::vector<FinishPass>& passes, const std::string& text) {
  FinishChain chain{passes, {}};
  SCUMBLE_ASSIGN(const std::size_t count, Set(chain, text));
  passes = std::move(chain.passes);
  return count;
}

using ::testing::HasSubstr;

Picture White(int side) {
  Picture picture(side, side);
  std::fill(picture.rgba.begin(), picture.rgba.end(), std::uint16_t{65535});
  return picture;
}

class FinishFile : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text) {
    std::ofstream(folder_ / "look.toml") << text;
    return folder_ / "look.toml";
  }
  std::string ErrorOf(const std::string& text) {
    const auto preset = LoadFinishPreset(Write(text));
    if (preset) return "none";
    EXPECT_EQ(preset.error().kind, ErrorKind::kInput);
    return preset.error().message;
  }
  TemporaryFolder folder_;
};

TEST_F(FinishFile, HoldsPassesInOrder) {
  const auto preset =
      LoadFinishPreset(Write("help = \"a look\"\n[[finish]]\neffect = \"tones\"\nbins = 3\nstrength = 0.5\n"
                             "[[finish]]\neffect = \"outline\"\nname = \"ink\"\nwidth = 4\nink = \"#ff8000\"\nside = "
                             "\"inside\"\nat = \"sheet\"\n"
                             "objects = [\"Tree*\", \"House\"]\nmaterials = \"Glass\"\n"));
  ASSERT_TRUE(preset) << preset.error().message;
  EXPECT_EQ(preset->name, "look");
  EXPECT_EQ(preset->help, "a look");
  ASSERT_EQ(preset->passes.size(), 2u);
  const FinishPass &tones = preset->passes[0], &ink = preset->passes[1];
  EXPECT_EQ(tones.name, "tones");
  EXPECT_EQ(std::get<TonesPass>(tones.effect).bins, 3);
  EXPECT_EQ(tones.strength, 0.5);
  EXPECT_EQ(ink.name, "ink");
  EXPECT_EQ(ink.at, FinishPass::Stage::kSheet);
  const auto& outline = std::get<OutlinePass>(ink.effect);
  EXPECT_EQ(outline.width, 4.0);
  EXPECT_EQ(outline.ink, (Rgb16{65535, 128 * 257, 0}));
  EXPECT_EQ(outline.side, OutlinePass::Side::kInside);
  EXPECT_THAT(ink.objects, ::testing::ElementsAre("Tree*", "House"));
  EXPECT_THAT(ink.materials, ::testing::ElementsAre("Glass"));
}

TEST_F(FinishFile, MistakesNameFileLineAndRemedy) {
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"outlines\"\n"),
              ::testing::AllOf(HasSubstr("look.toml:2"), HasSubstr("there is no effect 'outlines'"),
                               HasSubstr("did you mean outline?")));
  EXPECT_THAT(
      ErrorOf("[[finish]]\neffect = \"outline\"\n\nwidht = 3\n"),
      ::testing::AllOf(HasSubstr("look.toml:4"), HasSubstr("has no key 'widht'"), HasSubstr("did you mean width?")));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"outline\"\nwidth = 65\n"), HasSubstr("expected a number, 0 to 64"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"outline\"\nwidth = nan\n"), HasSubstr("expected a number, 0 to 64"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"outline\"\nink = \"black\"\n"), HasSubstr("a colour is #"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"outline\"\nside = \"left\"\n"),
              HasSubstr("expected \"centre\", \"inside\" or \"outside\""));
  const auto of_toon = [&](const std::string& line) { return ErrorOf("[[finish]]\neffect = \"toon\"\n" + line); };
  EXPECT_THAT(of_toon("light = \"lambert\"\n"), HasSubstr("expected \"luminance\" or \"wrapped\""));
  EXPECT_THAT(of_toon("shading = \"cool\"\n"), HasSubstr("expected \"plain\", \"gooch\" or \"ramp\""));
  EXPECT_THAT(of_toon("shading = \"gouch\"\n"), HasSubstr("did you mean \"gooch\"?"));
  for (const char* const wrong : {"0.6 0.2", "0.2 x", "0 0.5", "0.5 1", "0.2, 0.4"})
    EXPECT_THAT(of_toon("thresholds = \"" + std::string(wrong) + "\"\n"), HasSubstr("expected growing numbers"));
  EXPECT_THAT(of_toon("thresholds = 1.5\n"), HasSubstr("expected growing numbers"));
  FinishPass two_bands = *MakeFinishPass("toon");
  EXPECT_TRUE(SetFinishKey(two_bands, "thresholds", KeyValue(0.5))) << "one needs no quotes";
  EXPECT_THAT(std::get<ToonPass>(two_bands.effect).thresholds, ::testing::ElementsAre(0.5));
  EXPECT_THAT(of_toon("wrap_power = 3\n"), HasSubstr("expected a whole number, 1 to 2"));
  EXPECT_THAT(of_toon("ramp_rows = \"u\"\n"), HasSubstr("expected \"depth\", \"facing\" or \"highlight\""));
  EXPECT_THAT(of_toon("ramp = \"#000000 white\"\n"), HasSubstr("finish.ramp: white is no colour"));
  EXPECT_THAT(of_toon("ramp = \"#000000 #ffffff / \"\n"), HasSubstr("row 2 has 0 colours"));
  EXPECT_THAT(of_toon("ramp = \"#000000 / #ffffff #000000\"\n"),
              HasSubstr("row 2 has 2 colours, the rows before have 1"));
  std::string many, tall = "#000000";
  for (int i = 0; i < 65; ++i) many += "#000000 ";
  for (int i = 0; i < 16; ++i) tall += " / #000000";
  EXPECT_THAT(of_toon("ramp = \"" + many + "\"\n"), HasSubstr("expected at most 64 in 16"));
  EXPECT_THAT(of_toon("ramp = \"" + tall + "\"\n"), HasSubstr("expected at most 64 in 16"));
  EXPECT_THAT(of_toon("ramp = 3\n"), HasSubstr("expected a text in quotes"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"tones\"\nbins = 2.5\n"), HasSubstr("expected a whole number, 2 to 64"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"tones\"\nobjects = [1]\n"), HasSubstr("expected names in quotes"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"tones\"\nname = \"a.b\"\n"), HasSubstr("without dots"));
  EXPECT_THAT(ErrorOf("[[finish]]\nwidth = 3\n"), HasSubstr("has no effect"));
  EXPECT_THAT(ErrorOf("[finish]\neffect = \"tones\"\n"), HasSubstr("two brackets"));
  EXPECT_THAT(ErrorOf("help = \"nothing\"\n"), HasSubstr("has no [[finish]]"));
  EXPECT_THAT(ErrorOf("width = 3\n"), HasSubstr("unknown key width"));
  EXPECT_THAT(ErrorOf("[[finish]\n"), HasSubstr("not valid TOML"));
}

TEST_F(FinishFile, RampsAreRowsOfColours) {
  const Expected<ColorRamp> ramp = ParseColorRamp("#000000 #ff0000 #00ff00/#0000ff  #ffffff\t#808080");
  ASSERT_TRUE(ramp) << ramp.error().message;
  EXPECT_EQ(ramp->columns, 3);
  EXPECT_EQ(ramp->rows, 2);
  ASSERT_EQ(ramp->colors.size(), 6u);
  EXPECT_EQ(ramp->colors[1], (Rgb16{65535, 0, 0}));
  EXPECT_EQ(ramp->colors[3], (Rgb16{0, 0, 65535}));
  // A file is looked for beside the file that names it, colours are not; and it may change under its name.
  const auto preset =
      LoadFinishPreset(Write("help = \"a\"\n[[finish]]\neffect = \"toon\"\nramp = \"r.png\"\n"
                             "[[finish]]\neffect = \"toon\"\nramp = \"#102030 #405060\"\n"));
  ASSERT_TRUE(preset) << preset.error().message;
  FinishPass pass = preset->passes[0];
  auto& toon = std::get<ToonPass>(pass.effect);
  EXPECT_EQ(toon.ramp, (folder_ / "r.png").string());
  EXPECT_EQ(std::get<ToonPass>(preset->passes[1].effect).ramp, "#102030 #405060");
  toon.ramp_colors = std::make_shared<const ColorRamp>(*ramp);
  const std::string before = FinishText(pass);
  ColorRamp other = *ramp;
  other.colors[5][2] = 1;
  toon.ramp_colors = std::make_shared<const ColorRamp>(other);
  EXPECT_NE(FinishText(pass), before);
  Picture picture(3, 2);
  std::fill(picture.rgba.begin(), picture.rgba.end(), std::uint16_t{65535});
  EXPECT_EQ(ColorRampOf(picture)->rows, 2);
  picture.At(2, 1)[3] = 40000;
  ExpectRefusal(ColorRampOf(picture), {"transparent at x=2, y=1", "flatten"});
  EXPECT_FALSE(ColorRampOf(Picture(2, 1025)));
}

TEST_F(FinishFile, EveryKeyTakesItsDefaultAndSaysIt) {
  for (const FinishEffect& effect : FinishEffects()) {
    FinishPass pass = *MakeFinishPass(effect.name);
    EXPECT_EQ(FinishText(pass), effect.name) << "defaults are left out";
    std::set<std::string> names;
    for (const auto keys : {std::span<const FinishKey>(effect.keys), CommonFinishKeys()}) {
      for (const FinishKey& key : keys) {
        EXPECT_TRUE(names.insert(key.name).second) << key.name;
        EXPECT_NE(key.help, "") << key.name;
        const KeyValue value = key.get(pass);
        EXPECT_EQ(ToText(value), key.default_value) << key.name;
        EXPECT_TRUE(SetFinishKey(pass, key.name, value)) << key.name;
        if (key.kind == KeyKind::kNumber || key.kind == KeyKind::kWhole) {
          const auto as_value = [&](double number) {
            return key.kind == KeyKind::kWhole ? KeyValue(std::int64_t(number)) : KeyValue(number);
          };
          EXPECT_FALSE(SetFinishKey(pass, key.name, as_value(key.most + 1.0))) << key.name;
          EXPECT_FALSE(SetFinishKey(pass, key.name, as_value(key.least - 1.0))) << key.name;
          EXPECT_TRUE(SetFinishKey(pass, key.name, as_value(key.most))) << key.name;
          if (ToText(as_value(key.most)) != key.default_value) {
            EXPECT_THAT(FinishText(pass), HasSubstr(key.name + "=")) << "another value is another text";
          }
          EXPECT_TRUE(SetFinishKey(pass, key.name, value));
        }
        EXPECT_EQ(bool(SetFinishKey(pass, key.name, KeyValue(true))), key.kind == KeyKind::kFlag) << key.name;
      }
    }
  }
}

TEST_F(FinishFile, OverridesGoToPassesByName) {
  std::vector<FinishPass> passes{*MakeFinishPass("outline"), *MakeFinishPass("tones"), *MakeFinishPass("outline")};
  passes[2].name = "ink";
  const auto one = Set(passes, "finish.ink.width=7.5");
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(*one, 1u);
  EXPECT_EQ(std::get<OutlinePass>(passes[2].effect).width, 7.5);
  EXPECT_EQ(std::get<OutlinePass>(passes[0].effect).width, OutlinePass().width);
  const std::pair<const char*, double> kWithoutZeros[] = {{".5", 0.5}, {"2.", 2.0}, {"+.25", 0.25}, {"5.e-1", 0.5}};
  for (const auto& [text, number] : kWithoutZeros) {
    ASSERT_TRUE(Set(passes, std::string("finish.ink.width=") + text)) << "zeros may be left off: " << text;
    EXPECT_EQ(std::get<OutlinePass>(passes[2].effect).width, number) << text;
  }
  for (const char* text : {".", "-.", "1.2.", "..5", "1.x", ".e1"}) {
    EXPECT_FALSE(Set(passes, std::string("finish.ink.width=") + text)) << text;
  }
  EXPECT_EQ(*Set(passes, "finish.ink.ink=#102030"), 1u) << "quotes may be left off";
  EXPECT_EQ(*Set(passes, "finish.pen.width=3"), 0u);
  EXPECT_THAT(NoSuchFinish(*ParseOverride("finish.pen.width=3"), passes).message,
              HasSubstr("there are outline, tones, ink"));
  EXPECT_EQ(*Set(passes, "finish.ink.objects=Tree*,House"), 1u);
  EXPECT_THAT(passes[2].objects, ::testing::ElementsAre("Tree*", "House"));
  EXPECT_EQ(*Set(passes, "finish.ink.objects=[\"Ball, red\", 'Dancer']"), 1u) << "as in the file";
  EXPECT_THAT(passes[2].objects, ::testing::ElementsAre("Ball, red", "Dancer"));
  EXPECT_THAT(Set(passes, "finish.ink.objects=[1]").error().message, HasSubstr("expected names in quotes"));
  EXPECT_THAT(Set(passes, "finish.ink.objects=[\"Ball\"").error().message, HasSubstr("names in quotes"));
  EXPECT_FALSE(Set(passes, "finish.width=3"));
  EXPECT_FALSE(Set(passes, "finish.ink.width=wide"));
}

TEST_F(FinishFile, DialsTurnTheWholeChain) {
  const auto chain = [] {
    std::vector<FinishPass> passes;
    for (const char* name : {"outline", "edges", "smooth", "tones", "shadows", "toon", "depth", "grade"})
      passes.push_back(*MakeFinishPass(name));
    for (FinishPass& pass : passes) pass.strength = 0.4;
    return passes;
  };
  const auto text = [](const std::vector<FinishPass>& passes) {
    std::string all;
    for (const FinishPass& pass : passes) all += FinishText(pass) + "\n";
    return all;
  };
  for (const char* name : kDials) {
    auto passes = chain();
    ASSERT_TRUE(Set(passes, "dial." + std::string(name) + "=0.5"));
    EXPECT_EQ(text(passes), text(chain())) << name << " at rest";
  }
  auto passes = chain();
  ASSERT_TRUE(Set(passes, "dial.lines=0"));
  EXPECT_EQ(std::get<OutlinePass>(passes[0].effect).width, 0.0);
  EXPECT_EQ(passes[1].strength, 0.0);
  ASSERT_TRUE(Set(passes, "dial.detail=1"));
  EXPECT_EQ(passes[2].strength, 0.0);
  EXPECT_EQ(passes[3].strength, 0.0);
  ASSERT_TRUE(Set(passes, "dial.light=1"));
  EXPECT_EQ(passes[4].strength, 0.8);
  EXPECT_EQ(std::get<ShadowsPass>(passes[4].effect).none, 2.0 * ShadowsPass().none);
  EXPECT_EQ(passes[5].strength, 0.4);
  EXPECT_EQ(std::get<ToonPass>(passes[5].effect).shade, 0.0);
  ASSERT_TRUE(Set(passes, "dial.light=0"));
  EXPECT_EQ(passes[4].strength, 0.0);
  EXPECT_EQ(std::get<ToonPass>(passes[5].effect).shade, 1.0) << "no band shows, and the colour does";
  EXPECT_EQ(std::get<ToonPass>(passes[5].effect).cool, ToonPass().warm) << "neither does any side of gooch";
  EXPECT_EQ(std::get<ToonPass>(passes[5].effect).cool_base, ToonPass().warm_base);
  ASSERT_TRUE(Set(passes, "dial.depth=0.25"));
  EXPECT_EQ(std::get<DepthPass>(passes[6].effect).desaturate, 0.5 * DepthPass().desaturate);
  EXPECT_EQ(passes[7].strength, 0.4) << "no dial turns it";
  const auto wrong = Set(passes, "dial.line=0.5");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("did you mean lines?"));
  EXPECT_FALSE(Set(passes, "dial.lines=1.5"));
}

// Few tones in the paint itself make its strokes stand out; few tones of the light do not.
TEST_F(FinishFile, LessDetailIsNoRougherPaint) {
  std::vector<FinishPass> passes{*MakeFinishPass("tones"), *MakeFinishPass("tones")};
  std::get<TonesPass>(passes[1].effect).tone = TonesPass::Tone::kLight;
  ASSERT_TRUE(Set(passes, "dial.detail=0"));
  EXPECT_EQ(std::get<TonesPass>(passes[0].effect).bins, TonesPass().bins);
  EXPECT_EQ(std::get<TonesPass>(passes[1].effect).bins, TonesPass().bins / 2);
}

TEST_F(FinishFile, StyleHasItsOwn) {
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", White(32)));
  std::ofstream(folder_ / "style.toml")
      << "[[exemplar]]\nimage = \"lit.png\"\nfills = true\n[[finish]]\neffect = \"outline\"\nmaterial = 1\nthin = 1\n";
  const auto style = LoadStyle(folder_ / "style.toml", *ParseStyleOverrides({"finish.outline.width=3"}));
  ASSERT_TRUE(style) << style.error().message;
  ASSERT_EQ(style->finish.size(), 1u);
  EXPECT_EQ(std::get<OutlinePass>(style->finish[0].effect).width, 3.0);
  EXPECT_TRUE(RequiredLayers(*style).Has(Layer::kMaterial));
  EXPECT_FALSE(RequiredLayers(*style).Has(Layer::kShadow));
  const auto wrong = LoadStyle(folder_ / "style.toml", *ParseStyleOverrides({"finish.ink.width=3"}));
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("there are outline"));
}

TEST_F(FinishFile, KeysChangeOverTime) {
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", White(32)));
  const auto load = [&](const std::string& finish, const std::vector<std::string>& sets = {}) {
    std::ofstream(folder_ / "style.toml") << "[[exemplar]]\nimage = \"lit.png\"\nfills = true\n" + finish;
    return LoadStyle(folder_ / "style.toml", *ParseStyleOverrides(sets));
  };
  const std::string moving =
      "[[finish]]\neffect = \"outline\"\nname = \"ink\"\nwidth = [[1, 2], [11, 4]]\nlight = [[5, 0], [6, 1]]\n";
  auto style = load(moving);
  ASSERT_TRUE(style) << style.error().message;
  const auto width_at = [&](int frame) {
    EXPECT_TRUE(SetStyleFrame(*style, frame));
    return std::get<OutlinePass>(style->finish[0].effect).width;
  };
  EXPECT_EQ(width_at(0), 2.0);
  EXPECT_EQ(width_at(6), 3.0);
  EXPECT_EQ(width_at(20), 4.0);
  const auto layers = LayersOverTime(*style);
  ASSERT_TRUE(layers);
  EXPECT_TRUE(layers->Has(Layer::kLuminance)) << "of a later frame";
  style = load(moving, {"finish.ink.width=7"});
  ASSERT_TRUE(style);
  EXPECT_EQ(width_at(6), 7.0) << "a plain value takes the place of key frames";
  style = load(moving, {"finish.ink.width=[[0, 1], [10, 2]]"});
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(width_at(5), 1.5);
  const auto dial = load(moving, {"dial.lines=0"});
  ASSERT_FALSE(dial);
  EXPECT_THAT(dial.error().message, HasSubstr("which a dial would undo"));
  const auto twice = load(moving + "[[finish]]\neffect = \"tones\"\nname = \"ink\"\n");
  ASSERT_FALSE(twice);
  EXPECT_THAT(twice.error().message, HasSubstr("a name of its own"));
  const auto wide = load("[[finish]]\neffect = \"outline\"\nwidth = [[1, 2], [11, 400]]\n");
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().kind, ErrorKind::kInput);
  EXPECT_THAT(wide.error().message, HasSubstr("frame 11"));
}

TEST_F(FinishFile, KeysOfPresetsChangeOverTime) {
  auto preset = LoadFinishPreset(Write(
      "[[finish]]\neffect = \"outline\"\nname = \"ink\"\nwidth = [[1, 2], [11, 4]]\nlight = [[5, 0], [6, 1]]\n"
      "side = [[3, \"inside\"], [5, \"outside\"]]\n[[finish]]\neffect = \"tones\"\nstrength = [[0, 0], [4, 1]]\n"));
  ASSERT_TRUE(preset) << preset.error().message;
  const auto outline_at = [&](int frame) {
    EXPECT_TRUE(SetFinishFrame(*preset, frame));
    return std::get<OutlinePass>(preset->passes[0].effect);
  };
  EXPECT_EQ(std::get<OutlinePass>(preset->passes[0].effect).width, 2.0) << "of frame 0";
  EXPECT_EQ(outline_at(6).width, 3.0);
  EXPECT_EQ(outline_at(4).side, OutlinePass::Side::kInside) << "choices hold";
  EXPECT_EQ(outline_at(5).side, OutlinePass::Side::kOutside);
  EXPECT_EQ(outline_at(1).light, 0.0);
  EXPECT_EQ(preset->passes[1].strength, 0.25);
  EXPECT_TRUE(LayersOverTime(*preset).Has(Layer::kLuminance)) << "of a later frame";
  EXPECT_EQ(MomentsOf(*preset, 1).size(), 5u) << "now, and at each key frame and after";
  EXPECT_EQ(ToText(preset->tracks[1].keys).substr(0, 2), "[[");
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"outline\"\nwidth = [[1, 2], [11, 400]]\n"),
              AllOf(HasSubstr("look.toml:3: "), HasSubstr("frame 11")));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"outline\"\nwidth = [1, 2]\n"), HasSubstr("as [[1, 0.1], [24, 0.3]]"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"palette\"\nlike = [[1, \"a.png\"]]\n"), HasSubstr("read once"));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"tones\"\nmask = [[1, \"radial\"]]\n"), HasSubstr("read once"));
}

TEST_F(FinishFile, ColoursMoveInOklab) {
  const auto preset = LoadFinishPreset(
      Write("[[finish]]\neffect = \"fill\"\ncolor = [[0, \"#000000\"], [10, \"#ffffff\"], [20, \"#ff0000\"]]\n"));
  ASSERT_TRUE(preset) << preset.error().message;
  const auto at = [&](int frame) { return std::get<Rgb16>(ValueAt(preset->tracks[0].keys, frame)); };
  EXPECT_EQ(at(-1), (Rgb16{0, 0, 0}));
  EXPECT_NEAR(at(5)[1], 25465, 2) << "half of Oklab's lightness is an eighth of the light, which 8 bits do not hold";
  EXPECT_EQ(at(10), (Rgb16{65535, 65535, 65535}));
  EXPECT_EQ(at(20), (Rgb16{65535, 0, 0}));
  EXPECT_EQ(ToText(preset->tracks[0].keys), "[[0, \"#000000\"], [10, \"#ffffff\"], [20, \"#ff0000\"]]");
  EXPECT_EQ(ColorText({0x1111, 0xabab, 0x0102}), "#1111abab0102");
}

TEST_F(FinishFile, ChainsTakeKeyFramesFromTheCommandLine) {
  FinishChain chain{{*MakeFinishPass("outline"), *MakeFinishPass("tones")}, {}};
  FinishChain more = chain;
  ASSERT_EQ(*Set(more, "finish.outline.width=[[1, 2], [3, 4]]"), 1u);
  Append(more, chain);
  ASSERT_EQ(chain.passes.size(), 4u);
  const auto width_at = [&](std::size_t pass, int frame) {
    EXPECT_TRUE(SetFinishFrame(chain, frame));
    return std::get<OutlinePass>(chain.passes[pass].effect).width;
  };
  EXPECT_EQ(width_at(2, 2), 3.0);
  EXPECT_EQ(width_at(0, 2), OutlinePass().width) << "a pass of the same name and another preset";
  const auto dial = Set(chain, "dial.lines=0.2");
  ASSERT_FALSE(dial);
  EXPECT_THAT(dial.error().message, HasSubstr("finish.outline.width changes over time"));
  EXPECT_EQ(*Set(chain, "finish.outline.width=[[0, 6], [2, 8]]"), 2u);
  EXPECT_EQ(width_at(0, 1), 7.0);
  EXPECT_EQ(width_at(2, 1), 7.0);
  EXPECT_EQ(*Set(chain, "finish.outline.width=5"), 2u);
  EXPECT_EQ(width_at(2, 1), 5.0) << "a plain value takes the place of key frames";
  EXPECT_TRUE(chain.tracks.empty());
  EXPECT_EQ(*Set(chain, "finish.pen.width=[[0, 6]]"), 0u);
  const auto wrong = Set(chain, "finish.outline.widht=[[0, 6]]");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("did you mean width?"));
  EXPECT_FALSE(Set(chain, "finish.outline.objects=[[0, \"A\"]]"));
  EXPECT_FALSE(Set(chain, "finish.outline.width=[[0, 1, 2]]"));
  EXPECT_FALSE(Set(chain, "dial.lines=[[0, 1]]"));
}

TEST_F(FinishFile, BundledPresetsAreRead) {
  const auto files = FindFinishPresets(std::filesystem::path(SCUMBLE_SOURCE_DIR) / "finish" / "presets");
  EXPECT_GE(files.size(), 8u);
  for (const auto& file : files) {
    const auto preset = LoadFinishPreset(file);
    ASSERT_TRUE(preset) << preset.error().message;
    EXPECT_NE(preset->help, "") << file;
  }
}

TEST(FinishLayers, AreThoseThatItReads) {
  FinishPass pass = *MakeFinishPass("outline");
  EXPECT_EQ(RequiredLayers(pass), (LayerSet{Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}));
  auto& outline = std::get<OutlinePass>(pass.effect);
  outline.light = 1.0, outline.of_class[std::size_t(LineClass::kTexture)] = 1.0;
  EXPECT_TRUE(RequiredLayers(pass).Contains({Layer::kLuminance, Layer::kAlbedo}));
  pass.strength = 0.0;
  EXPECT_TRUE(RequiredLayers(pass).empty()) << "what changes nothing reads nothing";
  FinishPass shadows = *MakeFinishPass("shadows");
  ASSERT_TRUE(SetFinishKey(shadows, "source", KeyValue(std::string("cast"))));
  EXPECT_EQ(RequiredLayers(shadows), (LayerSet{Layer::kCoverage, Layer::kShadow}));
  FinishPass tones = *MakeFinishPass("tones");
  EXPECT_TRUE(RequiredLayers(tones).empty());
  tones.objects = {"Ball"};
  EXPECT_EQ(RequiredLayers(tones), LayerSet{Layer::kObject});
}

// A grey of two shares, and half clear.
TEST_F(FinishFile, MasksAreReadBesideTheFile) {
  Picture picture(3, 1);
  const std::uint16_t texels[3][4] = {{65535, 65535, 65535, 65535}, {65535, 0, 0, 65535}, {65535, 65535, 65535, 32768}};
  for (int x = 0; x < 3; ++x) std::copy_n(texels[x], 4, picture.At(x, 0));
  ASSERT_TRUE(WritePicture(folder_ / "area.png", picture, {16}));
  const auto preset = LoadFinishPreset(
      Write("[[finish]]\neffect = \"grade\"\nmask = \"area.png\"\nmask_near = 2\nmask_far = 7.5\nmask_soft = 0.5\n"
            "mask_invert = true\n[[finish]]\neffect = \"fill\"\nmask = \"radial\"\n"));
  ASSERT_TRUE(preset) << preset.error().message;
  const FinishMask& mask = preset->passes[0].mask;
  EXPECT_EQ(mask.near, 2.0);
  EXPECT_EQ(mask.far, 7.5);
  EXPECT_EQ(mask.soft, 0.5);
  EXPECT_TRUE(mask.invert);
  EXPECT_EQ(mask.file, folder_ / "area.png");
  ASSERT_TRUE(mask.picture);
  EXPECT_EQ(mask.picture->rgba[0], 65535);
  EXPECT_NEAR(mask.picture->rgba[4], 0.2126 * 65535, 0.51);
  EXPECT_NEAR(mask.picture->rgba[8], 32768, 0.51);
  EXPECT_EQ(preset->passes[1].mask.shape, "radial");
  EXPECT_FALSE(preset->passes[1].mask.picture);
  FinishPass other = preset->passes[0];
  picture.At(0, 0)[0] = 0;
  ASSERT_TRUE(WritePicture(folder_ / "area.png", picture, {16}));
  ASSERT_TRUE(SetMaskShape("area.png", folder_.path(), other.mask));
  EXPECT_NE(FinishText(other), FinishText(preset->passes[0])) << "another picture of the same name";
  EXPECT_THAT(
      ErrorOf("[[finish]]\neffect = \"fill\"\nmask = \"ara.png\"\n"),
      AllOf(HasSubstr(":3: finish.mask"), HasSubstr("ara.png: there is no such file"), HasSubstr("\"radial\"")));
  EXPECT_THAT(ErrorOf("[[finish]]\neffect = \"fill\"\nmask_near = -1\n"), HasSubstr("expected metres"));
}

TEST(FinishDials, EachTurnsSomethingOfEachPreset) {
  int presets = 0;
  for (const std::filesystem::path& file : FindFinishPresets(SCUMBLE_SOURCE_DIR "/finish/presets")) {
    const auto preset = LoadFinishPreset(file);
    ASSERT_TRUE(preset) << file;
    ++presets;
    for (const char* const dial : kDials) {
      const auto turned = [&](double value) {
        std::vector<FinishPass> passes = preset->passes;
        EXPECT_TRUE(TurnFinishDial(passes, std::string(kDialKeys) + dial, value));
        std::string text;
        for (const FinishPass& pass : passes) text += FinishText(pass) + "; ";
        return text;
      };
      EXPECT_NE(turned(0.0), turned(1.0)) << file.stem() << ": " << dial;
      EXPECT_NE(turned(0.0), turned(0.5)) << file.stem() << ": " << dial;
    }
  }
  EXPECT_GE(presets, 12);
}

TEST(FinishDials, UnknownKeysWithKeyFramesAreUnknown) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "slip.toml";
  std::ofstream(file) << "[[finish]]\neffect = \"outline\"\nwidht = [[1, 0], [12, 4]]\n";
  const auto preset = LoadFinishPreset(file);
  ASSERT_FALSE(preset);
  EXPECT_THAT(preset.error().message, HasSubstr("width")) << "the nearest name";
}

}  // namespace
}  // namespace scumble
