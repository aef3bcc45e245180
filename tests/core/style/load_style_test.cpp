// Where styles are found, what their text may be, and --set.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "tests/core/style/style_fixtures.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

TEST_F(StyleFile, UnknownKeysAreRefusedWithTheKnownOnes) {
  ExpectRefusal(LoadLine("\n# a comment\ntreshold = 0.1"), ErrorKind::kInput,
                {"style.toml:4", "unknown key transfer.treshold", "threshold, ", "paper"});
  ExpectRefusal(Load(std::string("nmae = 'x'\n") + kExemplar), ErrorKind::kInput,
                {"style.toml:1", "unknown key nmae", "name", "licence", "[transfer]", "[[exemplar]]"});
  ExpectRefusal(Load(std::string("[transfr]\nlevels = 3\n") + kExemplar), ErrorKind::kInput,
                {"style.toml:1", "transfr"});
  ExpectRefusal(Load(std::string("transfer = 3\n") + kExemplar), ErrorKind::kInput, {"style.toml:1", "[transfer]"});
  ExpectRefusal(Load(std::string(kExemplar) + "weight = 2\n"), ErrorKind::kInput,
                {"style.toml:3", "unknown key exemplar.weight", "image, guides, luminance, fills"});
}

TEST_F(StyleFile, BadTomlSaysTheLine) {
  for (const char* bad :
       {"levels = = 3", "levels", "[transfer", "name = \"open", "levels = 3\nlevels = 4", "x = \xff"}) {
    SCOPED_TRACE(bad);
    const std::string text = "# one\n# two\n" + std::string(bad) + "\n";
    ExpectRefusal(Load(text), ErrorKind::kInput, {"style.toml:", "not valid TOML"});
  }
  ExpectRefusal(Load("# one\n# two\nlevels = = 3\n"), ErrorKind::kInput, {"style.toml:3: "});
  for (const char* open : {"name = \"x", "name = 'x", "name = \"x\\\"", "name = \"\"\"x\n\"\"", "name = '''x\n"}) {
    SCOPED_TRACE(open);
    ExpectRefusal(Load("# one\n" + std::string(open) + "\nlevels = 3\n"), ErrorKind::kInput,
                  {"style.toml:2: ", "begins here is not closed"});
  }
  ExpectRefusal(Load(std::string(2 << 20, '#')), ErrorKind::kInput, {"style.toml", "larger than"});
}

TEST_F(StyleFile, DamagedTomlNeverCrashes) {
  const std::string good =
      "name = \"x\"\n[transfer]\nthreshold = 0.5\npaper = \"#ffffff\"\nlevels = 3\n" + std::string(kExemplar);
  ASSERT_TRUE(Load(good));
  for (std::uint64_t round = 0; round < 1000; ++round) {
    std::string text = good;
    for (std::uint64_t k = 0; k <= round % 4; ++k) {
      text[Hash(round, k) % text.size()] = static_cast<char>("[]{}=\"'#.,0a-\n\\\0\xff"[Hash(round, k, 1) % 18]);
    }
    const auto style = Load(text);
    if (!style) {
      EXPECT_NE(style.error().message.find(folder_.path().string()), std::string::npos) << style.error().message;
    }
  }
}

TEST_F(StyleFile, OverridesWinWithQuotesOrWithout) {
  const std::string toml = "name = 'file'\n[transfer]\nlevels = 3\nmethod = 'styleblit'\n" + std::string(kExemplar);
  const auto style = Load(toml, {"transfer.levels=5", "transfer.method=litsphere", "transfer.threshold=inf",
                                 "transfer.threshold_metric=\"l1\"", "transfer.edge_aware=false",
                                 "transfer.paper=#102030", "name=bare words, with = signs", "licence='MIT'",
                                 "transfer.jitter= 0.5 ", "transfer.levels=6", "transfer.scale=1."});
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->transfer.levels, 6) << "the last one wins";
  EXPECT_EQ(style->transfer.method, Method::kLitSphere);
  EXPECT_TRUE(std::isinf(style->transfer.threshold));
  EXPECT_EQ(style->transfer.threshold_metric, ThresholdMetric::kL1);
  EXPECT_FALSE(style->transfer.edge_aware);
  EXPECT_EQ(style->paper.color, (std::array<std::uint16_t, 3>{0x10 * 257, 0x20 * 257, 0x30 * 257}));
  EXPECT_EQ(style->name, "bare words, with = signs");
  EXPECT_EQ(style->licence, "MIT");
  EXPECT_EQ(style->transfer.jitter, 0.5f);
  EXPECT_EQ(style->transfer.scale, 1.0f);
}

TEST_F(StyleFile, BadOverridesAreTheCallersMistake) {
  const std::string toml = kExemplar;
  ExpectRefusal(Load(toml, {"transfer.wibble=1"}), ErrorKind::kUsage,
                {"--set: ", "unknown key transfer.wibble", "threshold"});
  ExpectRefusal(Load(toml, {"wibble=1"}), ErrorKind::kUsage, {"--set: ", "unknown key wibble", "licence"});
  ExpectRefusal(Load(toml, {"transfer.levels=99"}), ErrorKind::kUsage, {"--set: transfer.levels = 99", "1 to 16"});
  ExpectRefusal(Load(toml, {"transfer.levels=many"}), ErrorKind::kUsage,
                {"--set: transfer.levels = \"many\"", "whole number"});
  ExpectRefusal(Load(toml, {"transfer.levels"}), ErrorKind::kUsage, {"--set transfer.levels", "KEY=VALUE"});
  ExpectRefusal(Load(toml, {"=3"}), ErrorKind::kUsage, {"KEY=VALUE"});
  ExpectRefusal(Load(toml, {""}), ErrorKind::kUsage, {"KEY=VALUE"});
  ExpectRefusal(Load(toml, {"transfer.levels=3\nname=\"x\""}), ErrorKind::kUsage, {"transfer.levels"});
  ExpectRefusal(Load(toml, {"transfer.levels=[1]"}), ErrorKind::kUsage, {"transfer.levels", "whole number"});
  ExpectRefusal(Load(toml, {"transfer.paper=no.png"}), ErrorKind::kInput, {"transfer.paper", "no.png"});
  ExpectRefusal(Load(toml, {"transfer.method=stylit"}), ErrorKind::kUnavailable, {"--set: transfer.method", "stylit"});
  ExpectRefusal(Load(toml, {"transfer.coherent=1"}), ErrorKind::kUsage, {"transfer.coherent", "true or false"});
}

TEST(LoadStyle, AFolderATomlFileOrAPicture) {
  const TemporaryFolder folder;
  const fs::path style_folder = folder / "Kohle v1.2";
  fs::create_directory(style_folder);
  ASSERT_TRUE(WritePicture(style_folder / "lit.png", NoisyPicture(8, 8)));
  ASSERT_TRUE(WriteFileAtomically(style_folder / "style.toml", kExemplar));
  ASSERT_TRUE(
      WriteFileAtomically(style_folder / "soft.toml", std::string("[transfer]\nblend_radius = 9\n") + kExemplar));
  const std::vector<std::pair<fs::path, const char*>> cases = {{style_folder, "Kohle v1.2"},
                                                               {style_folder / "", "Kohle v1.2"},
                                                               {style_folder / "../Kohle v1.2/.", "Kohle v1.2"},
                                                               {style_folder / "style.toml", "Kohle v1.2"},
                                                               {style_folder / "soft.toml", "soft"},
                                                               {style_folder / "lit.png", "lit"}};
  for (const auto& [path, name] : cases) {
    const auto style = LoadStyle(path);
    ASSERT_TRUE(style) << path << ": " << style.error().message;
    EXPECT_EQ(style->name, name) << path;
    EXPECT_EQ(style->exemplars.at(0).picture.rgba, NoisyPicture(8, 8).rgba);
    EXPECT_EQ(style->transfer.blend_radius, path.filename() == "soft.toml" ? 9 : 1);
  }
  const fs::path before = fs::current_path();
  fs::current_path(style_folder);
  const auto here = LoadStyle("."), by_file = LoadStyle("style.toml");
  fs::current_path(before);
  ASSERT_TRUE(here && by_file);
  EXPECT_EQ(here->name, "Kohle v1.2");
  EXPECT_EQ(by_file->name, "Kohle v1.2");
}

TEST(LoadStyle, WhatIsNoStyle) {
  const TemporaryFolder folder;
  ExpectRefusal(LoadStyle(folder / "missing"), ErrorKind::kInput, {"missing", "no such file or folder"});
  ExpectRefusal(LoadStyle(folder.path()), ErrorKind::kInput, {folder.path().string(), "no style.toml"});
  ASSERT_TRUE(WriteFileAtomically(folder / "notes.txt", "notes"));
  ExpectRefusal(LoadStyle(folder / "notes.txt"), ErrorKind::kInput, {"notes.txt"});
  ASSERT_TRUE(WritePicture(folder / "wide.png", NoisyPicture(9, 4)));
  ExpectRefusal(LoadStyle(folder / "wide.png"), ErrorKind::kInput, {"wide.png", "9×4", "square"});
  fs::create_directory(folder / "style.toml");
  ExpectRefusal(LoadStyle(folder.path()), ErrorKind::kInput, {"style.toml", "folder"});
}

TEST(FindStyles, SortedAndOnlyFoldersWithAStyle) {
  const TemporaryFolder folder;
  for (const char* name : {"b", "a", "Z", "empty"}) fs::create_directory(folder / name);
  for (const char* name : {"b", "a", "Z"}) ASSERT_TRUE(WriteFileAtomically(folder / name / "style.toml", ""));
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", "not in a folder of its own"));
  fs::create_symlink("loop", folder / "loop");
  fs::create_symlink("gone", folder / "dangling");
  EXPECT_EQ(FindStyles(folder.path()), (std::vector<fs::path>{folder / "Z", folder / "a", folder / "b"}));
  EXPECT_TRUE(FindStyles(folder / "missing").empty());
  EXPECT_TRUE(FindStyles(folder / "style.toml").empty());
}

}  // namespace
}  // namespace scumble
