// Finishing effects from the command line: with a transfer, after one, and on pictures of any renderer.
#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/apps/cli/verbs/finish_harness.h"
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

TEST_F(CliFinish, AfterTheTransferIsWithTheTransfer) {
  WriteStyle("plain");
  const Arguments scene{"--size", "96x64", "--aa", "2"};
  const auto with = [&](Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), scene.begin(), scene.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  RunOk(with({"stylize", kToys}, {"--style", "plain", "--bits", "16", "-o", "plain.png"}));
  RunOk(with({"stylize", kToys}, {"--style", "plain", "--bits", "16", "--finish", "comic", "-o", "whole.png"}));
  RunOk(with({"guidegen", kToys}, {"--layers", "luminance,shadow", "-o", "g.exr"}));
  RunOk({"finish", "plain.png", "g.exr", "--finish", "comic", "--bits", "16", "-o", "steps.png"});
  EXPECT_NE(Read("whole.png").rgba, Read("plain.png").rgba);
  EXPECT_EQ(Read("steps.png").rgba, Read("whole.png").rgba);
  RunOk({"transfer", "g.exr", "--style", "plain", "--finish", "comic", "--bits", "16", "-o", "transfer.png"});
  EXPECT_EQ(Read("transfer.png").rgba, Read("whole.png").rgba);
}

TEST_F(CliFinish, EveryEffectTakesAGuideFile) {
  ASSERT_TRUE(WritePicture(At("p.png"), Picture(40, 40)));
  RunOk({"guidegen", kBall, "--size", "40", "--layers", "luminance,shadow,albedo,lpe.full", "--samples", "1", "-o",
         "g.exr"});
  for (const char* effect : {"render", "toon", "smooth", "tones", "shadows", "depth", "grade", "pigment", "fill",
                             "edges", "hatch", "outline"}) {
    RunOk({"finish", "p.png", "g.exr", "--finish", effect, "-o", std::string(effect) + ".png"});
  }
}

// A palette by the style's painting, by colours, by a file beside the preset, by one that --set names.
TEST_F(CliFinish, PalettesAreOfPaintingsColoursAndFiles) {
  WriteStyle("plain");
  std::filesystem::create_directories(At("looks"));
  Picture blue(8, 8);
  for (std::size_t i = 0; i < blue.rgba.size(); ++i) blue.rgba[i] = i % 4 == 2 || i % 4 == 3 ? 65535 : 20000;
  ASSERT_TRUE(WritePicture(At("looks/blue.png"), blue));
  WriteText("looks/cold.toml", "help = \"cold\"\n[[finish]]\neffect = \"palette\"\nlike = \"blue.png\"\n");
  const auto middle = [&](const Arguments& more) {
    Arguments arguments{"stylize", kBall, "--size", "32", "--style", "plain", "--bits", "16", "-o", "p.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOk(arguments);
    const Picture picture = Read("p.png");
    return std::vector<int>(picture.At(16, 16), picture.At(16, 16) + 3);
  };
  const auto is_near = [](const std::vector<int>& got, int r, int g, int b) {
    return std::abs(got[0] - r) < 300 && std::abs(got[1] - g) < 300 && std::abs(got[2] - b) < 300;
  };
  const std::vector<int> plain = middle({});
  EXPECT_TRUE(is_near(plain, 60000, 40000, 20000));
  EXPECT_TRUE(is_near(middle({"--finish", "palette"}), 60000, 40000, 20000));
  EXPECT_TRUE(is_near(middle({"--finish", "looks/cold.toml"}), 20000, 20000, 65535));
  EXPECT_TRUE(
      is_near(middle({"--finish", "palette", "--set", "finish.palette.like=looks/blue.png"}), 20000, 20000, 65535));
  EXPECT_TRUE(is_near(middle({"--finish", "palette", "--set", "finish.palette.like=#804020"}), 0x8080, 0x4040, 0x2020));
  // Of one colour each, `from` moves by the difference.
  EXPECT_TRUE(is_near(middle({"--finish", "looks/cold.toml", "--set", "finish.palette.from=looks/blue.png"}), 60000,
                      40000, 20000));
  const auto of_like = [&](const std::string& like) {
    return Arguments{"stylize", kBall,      "--size",  "32",    "--style",
                     "plain",   "--finish", "palette", "--set", "finish.palette.like=" + like,
                     "-o",      "q.png"};
  };
  ExpectError(of_like("#12345"), 3, {"finish palette: like: #12345 is no colour"});
  ExpectError(of_like("none.png"), 3, {"finish palette: like: ", "none.png"});
  ExpectError({"finish", "p.png", "--finish", "palette", "-o", "q.png"}, 3,
              {"set finish.palette.like to a picture's file"});
  ExpectError({"finish", "p.png", "--finish", "looks/cold.toml", "-o", "looks/blue.png"}, 2, {"a file of a finish"});
}

TEST_F(CliFinish, HatchesWithTools) {
  ASSERT_TRUE(WritePicture(At("p.png"), PlainBall()));
  const auto hatched = [&](const std::string& strokes, const std::string& name) {
    RunOk({"finish", "p.png", "--finish", "hatch", "--set", "finish.hatch.tone=paint", "--set",
           "finish.hatch.along=fixed", "--set", "finish.hatch.strokes=" + strokes, "-o", name});
    return Read(name).rgba;
  };
  const auto lines = hatched("lines", "a.png"), pencil = hatched("pencil", "b.png");
  EXPECT_NE(lines, pencil);
  EXPECT_NE(hatched("pen", "c.png"), pencil);
  EXPECT_EQ(hatched(SCUMBLE_SOURCE_DIR "/finish/hatching/pencil.png", "d.png"), pencil);
  ExpectError({"finish", "p.png", "--finish", "hatch", "--set", "finish.hatch.strokes=crayon", "-o", "e.png"}, 3,
              {"finish hatch: strokes: there are no strokes 'crayon'", "lines, charcoal, pen, pencil"});
}

TEST_F(CliFinish, FocusesOnAnObject) {
  WriteStyle("plain");
  const auto paint = [&](const Arguments& more, const std::string& name) {
    Arguments arguments{"stylize", kToys, "--size", "96x64", "--style", "plain", "--finish", "depth", "-o", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunOk(arguments).err;
  };
  paint({}, "near.png");
  paint({"--set", "finish.depth.focus_on=Jelly*"}, "on.png");
  EXPECT_NE(Read("near.png").rgba, Read("on.png").rgba);
  EXPECT_TRUE(Contains(paint({"--set", "finish.depth.focus_on=Nobody"}, "lost.png"),
                       "no object in the picture has the name Nobody"));
  EXPECT_EQ(Read("near.png").rgba, Read("lost.png").rgba);
}

TEST_F(CliFinish, CastsOnlyWhatItReads) {
  WriteStyle("plain", "[transfer]\nedge_aware = false\n");
  const auto plan = [&](const std::string& finish) {
    return RunOk({"stylize", kBall, "--style", "plain", "--finish", finish, "--explain"}).out;
  };
  EXPECT_TRUE(Contains(plan("noir"), "shadow"));
  EXPECT_FALSE(Contains(plan("tones"), "luminance"));
  EXPECT_FALSE(Contains(plan("outline"), "luminance"));
}

TEST_F(CliFinish, StylesHaveTheirOwnAndNoneDropsIt) {
  WriteStyle("plain");
  WriteStyle("inked", "[[finish]]\neffect = \"outline\"\nname = \"ink\"\n");
  const auto paint = [&](const std::string& style, const Arguments& more, const std::string& name) {
    Arguments arguments{"stylize", kBall, "--size", "64", "--style", style, "-o", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOk(arguments);
    return Read(name).rgba;
  };
  const auto plain = paint("plain", {}, "a.png"), inked = paint("inked", {}, "b.png");
  EXPECT_NE(plain, inked);
  EXPECT_EQ(paint("inked", {"--finish", "none"}, "c.png"), plain);
  EXPECT_EQ(paint("plain", {"--finish", "outline"}, "d.png"), inked);
  EXPECT_EQ(paint("inked", {"--set", "finish.ink.strength=0"}, "e.png"), plain);
  EXPECT_NE(paint("inked", {"--set", "finish.ink.width=6"}, "f.png"), inked);
  EXPECT_NE(paint("inked", {"--set", "inked:finish.ink.width=6"}, "g.png"), inked);
}

TEST_F(CliFinish, OfAStyleTouchesItsOwnPixels) {
  WriteStyle("plain");
  WriteStyle("white", "[[finish]]\neffect = \"fill\"\ncolor = \"#ffffff\"\n");
  const auto paint = [&](const Arguments& more, const std::string& name) {
    Arguments arguments{"stylize", kToys, "--size", "96x64", "--style", "plain", "-o", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOk(arguments);
    return Read(name);
  };
  const Picture picture = paint({"--assign", "Ball*=white"}, "two.png");
  std::size_t white = 0, other = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i + 3] != 65535) continue;
    (picture.rgba[i + 2] > 65000 ? white : other)++;
  }
  EXPECT_GT(white, 20u);
  EXPECT_GT(other, 200u);
  WriteText("ball.toml", "[[finish]]\neffect = \"fill\"\ncolor = \"#ffffff\"\nobjects = \"Ball*\"\n");
  EXPECT_EQ(paint({"--finish", "ball.toml"}, "named.png").rgba, picture.rgba);
  WriteText("none.toml", "[[finish]]\neffect = \"fill\"\nobjects = \"Balll\"\n");
  const CommandResult none =
      RunOk({"stylize", kToys, "--size", "96x64", "--style", "plain", "--finish", "none.toml", "-o", "none.png"});
  EXPECT_TRUE(Contains(none.err, "no object has the name Balll; did you mean Ball")) << none.err;
}

// Methods that need no painting, alone and for some objects.
TEST_F(CliFinish, ToonAndRenderAreStylesWithoutAPainting) {
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "toon", "-o", "toon.png"});
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "toon", "--set", "finish.toon.bands=1", "-o", "flat.png"});
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "render", "--samples", "4", "-o", "render.png"});
  const Picture toon = Read("toon.png"), flat = Read("flat.png"), render = Read("render.png");
  EXPECT_NE(toon.rgba, flat.rgba);
  EXPECT_NE(toon.rgba, render.rgba);
  WriteStyle("plain");
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "plain", "--assign", "Ball*=toon", "-o", "both.png"});
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "plain", "-o", "plain.png"});
  const Picture both = Read("both.png"), plain = Read("plain.png");
  std::size_t of_toon = 0, of_plain = 0, of_none = 0;
  for (std::size_t i = 0; i < both.rgba.size(); i += 4) {
    const auto same = [&](const Picture& other) {
      return std::equal(&both.rgba[i], &both.rgba[i] + 4, &other.rgba[i]);
    };
    (same(plain) ? of_plain : same(toon) ? of_toon : of_none)++;
  }
  EXPECT_GT(of_toon, 50u);
  EXPECT_GT(of_plain, 500u);
  EXPECT_EQ(of_none, 0u);
  std::filesystem::create_directories(At("bare"));
  WriteText("bare/style.toml", "[transfer]\nmethod = \"toon\"\n[[finish]]\neffect = \"toon\"\nbands = 1\n");
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "bare", "-o", "bare.png"});
  EXPECT_EQ(Read("bare.png").rgba, flat.rgba);
  ASSERT_TRUE(WritePicture(At("bare/ball.png"), PlainBall()));
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "bare/ball.png", "-o", "ball.png"});
  RunOk({"stylize", kToys, "--size", "96x64", "--style", "toon", "--finish", "none", "-o", "none.png"});
  EXPECT_EQ(Read("none.png").rgba, toon.rgba) << "what makes the picture is no finish";
  ExpectError({"stylize", kToys, "--style", "toon", "--set", "transfer.method=styleblit", "-o", "x.png"}, 2,
              {"must be toon or render"});
  EXPECT_TRUE(Contains(RunOk({"stylize", kToys, "--style", "toon", "--explain"}).out, "read by finish toon"));
}

TEST_F(CliFinish, LiesUnderThePaperOrOverIt) {
  WriteStyle("paper", "[transfer]\npaper = \"#0000ff\"\n");
  WriteText("paint.toml", "[[finish]]\neffect = \"fill\"\ncolor = \"#ff0000\"\n");
  WriteText("sheet.toml", "[[finish]]\neffect = \"fill\"\ncolor = \"#ff0000\"\nat = \"sheet\"\n");
  for (const std::string name : {"paint", "sheet"}) {
    RunOk({"stylize", kToys, "--size", "64", "--style", "paper", "--finish", name + ".toml", "-o", name + ".png"});
  }
  EXPECT_GT(Read("paint.png").At(0, 0)[2], 65000);
  EXPECT_GT(Read("paint.png").At(32, 32)[0], 65000);
  EXPECT_GT(Read("sheet.png").At(0, 0)[0], 65000);
}

// What does not show has no lines.
TEST_F(CliFinish, CatchersHaveNoLines) {
  WriteStyle("plain");
  RunOk({"stylize", kBall, "--size", "64", "--style", "plain", "--assign", "*=rendered", "--finish", "outline", "-o",
         "rendered.png"});
  const Picture nothing = Read("rendered.png");
  EXPECT_EQ(std::count(nothing.rgba.begin(), nothing.rgba.end(), 0), std::ptrdiff_t(nothing.rgba.size()));
}

// Black and white is the whole sheet, where a catcher shows what is behind, too.
TEST_F(CliFinish, WhatIsOfTheSheetAndReadsNoGuidesIsAlsoOfCatchers) {
  WriteStyle("paper", "[transfer]\npaper = \"#8090ff\"\nshadow = \"paint\"\n");
  for (const char* const place : {"catcher", "rendered"}) {
    RunOk({"stylize", kToys, "--size", "96x54", "--style", "paper", "--assign", std::string("Table=") + place,
           "--finish", "noir", "-o", "p.png"});
    const Picture picture = Read("p.png");
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
      const auto [least, most] = std::minmax({picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]});
      ASSERT_LE(most - least, 2 * 257) << place << ", pixel " << i / 4;
    }
  }
}

// Light that a pass has flattened is matched as flat light is, and base colours tint as they are then.
TEST_F(CliFinish, ChangesGuidesBeforePaintIsMatched) {
  WriteStyle("tinted", "[transfer]\ncolorize = 1\n");
  const auto paint = [&](const Arguments& more, const std::string& name) {
    Arguments arguments{"stylize", kToys, "--size", "64x48", "--style", "tinted", "-o", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::string errors = RunOk(arguments).err;
    return std::pair(Read(name), errors);
  };
  const auto [plain, silent] = paint({}, "plain.png");
  const auto [grey, also_silent] = paint(
      {"--finish", "fill", "--set", "finish.fill.at=\"guides\"", "--set", "finish.fill.color=\"#404040\""}, "grey.png");
  EXPECT_NE(plain.rgba, grey.rgba);
  EXPECT_FALSE(Contains(also_silent, "does not look at"));
  std::set<std::array<std::uint16_t, 3>> colors;
  for (std::size_t i = 0; i < grey.rgba.size(); i += 4) {
    if (grey.rgba[i + 3] == 65535) colors.insert({grey.rgba[i], grey.rgba[i + 1], grey.rgba[i + 2]});
  }
  EXPECT_LE(colors.size(), 3u) << "one base colour, one paint";
  const auto [idle, warned] =
      paint({"--finish", "tones", "--set", "finish.tones.at=\"guides\"", "--set", "finish.tones.guide=\"luminance\""},
            "idle.png");
  EXPECT_EQ(idle.rgba, plain.rgba);
  EXPECT_TRUE(Contains(warned, "changes the guide luminance, which style tinted does not look at"));
}

// Lines of upsampled guides are nearly those of guides of full size.
TEST_F(CliFinish, LinesOfUpsampledGuidesAreSmooth) {
  WriteStyle("plain");
  const auto ink = [&](const Arguments& more) {
    Arguments run{"stylize", kBall,      "--size",  "240",  "--style", "plain", "--finish",
                  "fill",    "--finish", "outline", "--aa", "4",       "--set", "finish.outline.width=20",
                  "-o",      "u.png"};
    run.insert(run.end(), more.begin(), more.end());
    RunOk(run);
    return Read("u.png");
  };
  const Picture whole = ink({}), upsampled = ink({"--upsample", "3"});
  double off = 0.0, dark = 0.0;
  for (std::size_t i = 0; i < whole.rgba.size(); i += 4) {
    dark += std::abs(60000.0 - whole.rgba[i]) * whole.rgba[i + 3] / 65535.0;
    off += std::abs(double(whole.rgba[i]) * whole.rgba[i + 3] - double(upsampled.rgba[i]) * upsampled.rgba[i + 3]) /
           65535.0;
  }
  EXPECT_LT(off, 0.12 * dark);
}

TEST_F(CliFinish, ListsEffectsKeysAndPresets) {
  const std::string all = RunOk({"finish", "--list"}).out;
  for (const char* name : {"comic", "ligne-claire", "noir", "chiaroscuro", "impression", "charcoal-lines", "storybook",
                           "engraving", "pen-and-ink", "pencil-sketch", "blueprint", "gooch", "outline", "shadows",
                           "tones", "depth", "grade", "fill", "strength"}) {
    EXPECT_TRUE(Contains(all, name)) << name;
  }
  EXPECT_TRUE(Contains(RunOk({"finish", "--list", "--finish", "outline"}).out, "crease_angle"));
  EXPECT_TRUE(Contains(RunOk({"finish", "--list", "--finish", "noir"}).out, "mode=\"black\""));
  const nlohmann::json json = RunOk({"finish", "--list", "--json"}).Json();
  EXPECT_GE(json["presets"].size(), 8u);
  EXPECT_EQ(json["effects"][0]["name"], "render");
}

TEST_F(CliFinish, SaysWhatIsWrong) {
  ASSERT_TRUE(WritePicture(At("p.png"), Picture(32, 32)));
  ExpectError({"finish", "p.png", "-o", "o.png"}, 2, {"--finish NAME is required"});
  ExpectError({"finish", "p.png", "--finish", "tones"}, 2, {"-o FILE is required"});
  ExpectError({"finish"}, 2, {"name a picture"});
  ExpectError({"finish", "p.png", "--finish", "comix", "-o", "o.png"}, 3, {"--finish comix", "did you mean comic?"});
  ExpectError({"finish", "p.png", "--finish", "outline", "-o", "o.png"}, 3,
              {"finish outline needs", "depth", "name a guide file"});
  ExpectError({"finish", "p.png", "--finish", "tones", "--set", "finish.tones.bin=3", "-o", "o.png"}, 2,
              {"has no key 'bin'", "did you mean bins?"});
  ExpectError({"finish", "p.png", "--finish", "tones", "--set", "finish.ink.width=3", "-o", "o.png"}, 2,
              {"no finish has that name", "there are tones"});
  ExpectError({"finish", "p.png", "--finish", "tones", "-o", "p.png"}, 2, {"p.png"});
  RunOk({"guidegen", kBall, "--size", "40", "-o", "g.exr"});
  ExpectError({"finish", "p.png", "g.exr", "--finish", "outline", "-o", "o.png"}, 3, {"32×32", "40×40"});
  const CommandResult lacks =
      ExpectError({"finish", "p.png", "g.exr", "--finish", "noir", "-o", "o.png"}, 3, {"g.exr", "--layers luminance"});
  EXPECT_FALSE(Contains(lacks.err, "--style")) << lacks.err;
  WriteStyle("plain");
  ExpectError({"stylize", kBall, "--style", "plain", "--set", "finish.ink.width=3", "-o", "o.png"}, 2,
              {"no finish has that name", "--finish"});
  EXPECT_FALSE(std::filesystem::exists(At("o.png")));
}

// In an orthographic view nothing gets smaller with distance.
TEST_F(CliFinish, RefusesThinLinesWithoutPerspective) {
  RunOk({"sphere", "--size", "64", "-o", "kit"});
  ASSERT_TRUE(WritePicture(At("p.png"), Picture(64, 64)));
  ExpectError(
      {"finish", "p.png", "kit/guides.exr", "--finish", "outline", "--set", "finish.outline.thin=1", "-o", "o.png"}, 3,
      {"finish outline", "orthographic", "thin to 0"});
}

// A preset and a style are for any scene: what they ask for does not apply.
TEST_F(CliFinish, PresetsDoWithoutThinLinesWherePerspectiveLacks) {
  RunOk({"sphere", "--size", "64", "-o", "kit"});
  WriteStyle("plain");
  WriteStyle("thinning", "[[finish]]\neffect = \"outline\"\nthin = 1.0\n");
  const Arguments paint = {"transfer", "kit/guides.exr", "--style", "plain", "-o", "o.png", "--finish", "outline"};
  RunOk(paint);
  const auto plain = Read("o.png").rgba;
  WriteText("thin.toml", "[[finish]]\neffect = \"outline\"\nthin = [[1, 0.5], [9, 1]]\n");
  const std::string note = "finish outline: its thin is left out";
  for (const Arguments& run : {Arguments{"transfer", "kit/guides.exr", "--style", "plain", "--finish", "thin.toml"},
                               {"transfer", "kit/guides.exr", "--style", "thinning"}}) {
    EXPECT_TRUE(Contains(RunOk(With(run, {"-o", "o.png"})).err, note));
    EXPECT_EQ(Read("o.png").rgba, plain);
    ExpectError(With(run, {"-o", "x.png", "--set", "finish.outline.thin=0.5"}), 3, {"orthographic", "thin to 0"});
    ExpectError(With(run, {"-o", "x.png", "--set", "finish.outline.thin=[[1, 0.5], [2, 1]]"}), 3,
                {"orthographic", "thin to 0"});
  }
  RunOk({"transfer", "kit/guides.exr", "--style", "plain", "-o", "p.png"});
  EXPECT_TRUE(Contains(RunOk({"finish", "p.png", "kit/guides.exr", "--finish", "thin.toml", "-o", "o.png"}).err, note));
}

TEST_F(CliFinish, MasksLimitAnEffect) {
  RunOk({"guidegen", kToys, "--size", "96x64", "--aa", "2", "-o", "g.exr"});
  ASSERT_TRUE(WritePicture(At("p.png"), [] {
    Picture picture(96, 64);
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = i % 4 == 3 ? 65535 : 30000;
    return picture;
  }()));
  Picture left(96, 64);
  for (int i = 0; i < 96 * 64; ++i) {
    if (i % 96 < 48) std::fill_n(left.At(i % 96, i / 96), 4, std::uint16_t{65535});
  }
  ASSERT_TRUE(WritePicture(At("left.png"), left));
  const auto fill = [&](const Arguments& more) {
    Arguments arguments{"finish", "p.png", "g.exr", "--finish", "fill", "--set", "finish.fill.color=#ff0000",
                        "-o",     "o.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOk(arguments);
    const Picture made = Read("o.png");
    std::size_t red = 0;
    for (std::size_t i = 0; i < made.rgba.size(); i += 4) red += made.rgba[i] > 60000 && made.rgba[i + 1] < 5000;
    return red;
  };
  EXPECT_EQ(fill({}), 96u * 64u);
  EXPECT_EQ(fill({"--set", "finish.fill.mask=left.png"}), 48u * 64u);
  EXPECT_EQ(Read("o.png").At(90, 30)[0], Read("p.png").At(90, 30)[0]);
  const std::size_t near = fill({"--set", "finish.fill.mask_far=8"}), far = fill({"--set", "finish.fill.mask_near=8"});
  EXPECT_EQ(near + far, 96u * 64u);
  EXPECT_GT(near, 100u);
  EXPECT_GT(far, 100u);
  EXPECT_EQ(fill({"--set", "finish.fill.mask_far=8", "--set", "finish.fill.mask_invert=true"}), far);
  const CommandResult missing =
      Run({"finish", "p.png", "g.exr", "--finish", "fill", "--set", "finish.fill.mask=no.png", "-o", "o.png"});
  EXPECT_EQ(missing.code, 2) << missing.err;
  EXPECT_TRUE(Contains(missing.err, "no.png: there is no such file")) << missing.err;
  const CommandResult over =
      Run({"finish", "p.png", "g.exr", "--finish", "fill", "--set", "finish.fill.mask=left.png", "-o", "left.png"});
  EXPECT_NE(over.code, 0);
  EXPECT_TRUE(Contains(over.err, "left.png")) << over.err;
  EXPECT_EQ(Read("left.png").rgba, left.rgba) << "the mask is still there";
}

TEST_F(CliFinish, WarnsOfOrderThatIsLikelyWrong) {
  RunOk({"guidegen", kBall, "--size", "32", "--layers", "luminance,shadow,albedo,cosine", "-o", "g.exr"});
  ASSERT_TRUE(WritePicture(At("p.png"), PlainBall()));
  const auto warnings = [&](const Arguments& names) {
    Arguments arguments{"finish", "p.png", "g.exr", "-o", "o.png"};
    for (const std::string& name : names) arguments.insert(arguments.end(), {"--finish", name});
    return RunOk(arguments).err;
  };
  EXPECT_TRUE(Contains(warnings({"outline", "smooth"}),
                       "finish outline draws lines, which smooth then blurs: put smooth before it"));
  EXPECT_TRUE(Contains(warnings({"hatch", "tones"}), "finish hatch draws lines, which tones then makes jagged"));
  EXPECT_TRUE(Contains(warnings({"grade", "fill"}), "finish grade is covered by fill"));
  EXPECT_FALSE(Contains(warnings({"smooth", "tones", "hatch", "outline"}), "draws lines"));
  for (const char* preset : {"comic", "noir", "storybook", "blueprint", "charcoal-lines", "engraving", "gooch"}) {
    const std::string said = warnings({preset});
    EXPECT_FALSE(Contains(said, "covered by") || Contains(said, "draws lines")) << preset << said;
  }
  WriteText("low.toml", "[[finish]]\neffect = \"outline\"\nobjects = \"Ball*\"\n[[finish]]\neffect = \"smooth\"\n");
  EXPECT_FALSE(Contains(warnings({"low.toml"}), "then blurs")) << "they may not meet";
  WriteStyle("painted", "[transfer]\nedge = \"exemplar\"\n");
  const CommandResult edge =
      RunOk({"stylize", kBall, "--size", "32", "--style", "painted", "--finish", "outline", "-o", "s.png"});
  EXPECT_TRUE(Contains(edge.err, "transfer.edge of style painted is \"exemplar\"")) << edge.err;
}

}  // namespace
}  // namespace scumble
