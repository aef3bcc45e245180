// scumble tradeoff, from its arguments to its files.
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// RFC 4180, as any reader takes it.
std::vector<std::vector<std::string>> ParseCsv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      rows.back().back() += c, ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (quoted) {
      rows.back().back() += c;
    } else if (c == ',') {
      rows.back().emplace_back();
    } else if (c == '\n') {
      rows.emplace_back(1);
    } else if (c != '\r') {
      rows.back().back() += c;
    }
  }
  rows.pop_back();  // what follows the last line's end
  return rows;
}

class Tradeoff : public CliTest {
 protected:
  void SetUp() override { WriteStyle("mine"); }

  // Small, and without the processes that measure memory.
  Arguments Small(const std::string& scene, const Arguments& more, const std::string& size = "96x54") const {
    return With({"tradeoff", scene, "--style", "mine", "--size", size, "--repeat", "1", "--no-memory"}, more);
  }
  // The variants' measures without times.
  nlohmann::json WithoutTimes(const CommandResult& result) const {
    nlohmann::json variants = result.Json()["variants"];
    for (auto& variant : variants) {
      for (const char* key : {"guides_ms", "transfer_ms", "total_ms", "prepare_ms", "front"}) variant.erase(key);
    }
    return variants;
  }
  // Splits options without blanks in them like a shell.
  static Arguments Words(std::string options) {
    std::erase(options, '\'');
    std::istringstream stream(options);
    return {std::istream_iterator<std::string>(stream), {}};
  }
};

TEST_F(Tradeoff, WritesAPageFiguresAndPicturesThatAgree) {
  const CommandResult result =
      RunOk({"tradeoff", Scene("suzanne.glb"), "--style", "mine", "--size", "96x54", "--repeat", "2", "--only",
             "method,levels 1,precision,resolution", "-o", "out/deep", "--quick"});
  EXPECT_NE(result.out.find("the style"), std::string::npos);
  EXPECT_NE(result.out.find("litsphere"), std::string::npos);
  EXPECT_NE(result.err.find("out/deep/report.html"), std::string::npos);
  const nlohmann::json json = nlohmann::json::parse(Bytes("out/deep/tradeoff.json"));
  const auto rows = ParseCsv(Bytes("out/deep/tradeoff.csv"));
  const std::string page = Bytes("out/deep/report.html");
  EXPECT_EQ(json["scene"], "suzanne");
  EXPECT_EQ(json["width"], 96);
  EXPECT_EQ(json["repeats"], 2);
  ASSERT_EQ(rows.size(), json["variants"].size() + 1);
  std::map<std::string, std::size_t> column;
  for (std::size_t c = 0; c < rows[0].size(); ++c) column[rows[0][c]] = c;
  for (std::size_t i = 0; i < json["variants"].size(); ++i) {
    const auto& variant = json["variants"][i];
    const auto& row = rows[i + 1];
    ASSERT_EQ(row.size(), rows[0].size());
    EXPECT_EQ(nlohmann::json(row[column["variant"]]), variant["variant"]);
    EXPECT_EQ(nlohmann::json(row[column["options"]]), variant["options"]);
    EXPECT_EQ(std::stod(row[column["texture"]]), variant["texture"].get<double>());
    EXPECT_EQ(std::stod(row[column["both"]]), variant["both"]["mean"].get<double>());
    EXPECT_EQ(std::stod(row[column["total_ms_median"]]), variant["total_ms"]["median"].get<double>());
    EXPECT_EQ(std::stod(row[column["memory_bytes"]]), variant["memory_bytes"].get<double>());
    EXPECT_GT(variant["memory_bytes"].get<double>(), 10e6) << "a process with its libraries";
    EXPECT_LT(variant["memory_bytes"].get<double>(), 4e9);
    const double both = variant["both"]["mean"],
                 parts = double(variant["energy"]["mean"]) + double(variant["missing"]["mean"]);
    EXPECT_NEAR(both, parts, 1e-9 * (1.0 + both));
    const double lower = variant["total_ms"]["lower_quartile"], median = variant["total_ms"]["median"],
                 upper = variant["total_ms"]["upper_quartile"];
    EXPECT_LE(lower, median);
    EXPECT_LE(median, upper);
    const auto picture = ReadPicture(At("out/deep/pictures") / variant["picture"].get<std::string>());
    ASSERT_TRUE(picture.ok()) << variant["picture"];
    EXPECT_EQ(picture->width, 96);
    EXPECT_EQ(picture->height, 54);
    EXPECT_NE(page.find(variant["variant"].get<std::string>()), std::string::npos);
  }
  for (const auto& entry : fs::recursive_directory_iterator(At("out"))) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path() << " is a temporary file";
  }
}

TEST_F(Tradeoff, OptionsRepeatThePictureByteForByte) {
  RunOk(
      Small(Scene("suzanne.glb"), {"--only",
                                   "method litsphere,levels 3,threshold 0.25,blend_radius 4,edge_aware,match_step 2,"
                                   "nearest tree,nearest table 64,resolution,robust,seed,quality",
                                   "--seed", "3", "--aa", "2", "--normal-frame", "eye", "--raw-normals", "-o", "out"}));
  const nlohmann::json json = nlohmann::json::parse(Bytes("out/tradeoff.json"));
  int repeated = 0;
  for (const auto& variant : json["variants"]) {
    const std::string options = variant["options"], name = variant["variant"];
    if (options.empty()) {
      EXPECT_NE(variant["note"], "") << name << " should say why";
      continue;
    }
    RunOk(With(With({"stylize", Scene("suzanne.glb")}, Words(options)), {"-o", "again.png"}));
    EXPECT_EQ(Pixels("again.png"), Pixels("out/pictures/" + variant["picture"].get<std::string>()))
        << name << ": " << options;
    ++repeated;
  }
  EXPECT_EQ(repeated, 15) << "all but the small table and twice the resolution";
  const auto large = std::find_if(json["variants"].begin(), json["variants"].end(),
                                  [](const auto& variant) { return variant["variant"] == "resolution 2"; });
  ASSERT_NE(large, json["variants"].end());
  EXPECT_GT((*large)["guide_rms"].get<double>(), 0.0) << "averaged, they are not those of the pixels' centres";
  EXPECT_GT((*large)["guide_flip"].get<double>(), 0.0);
}

// Light that needs chance, and light that would without the limit on bounces.
TEST_F(Tradeoff, OptionsRepeatLightPathsToo) {
  struct Case {
    std::string weight, only;
    Arguments light;
  };
  for (const Case& c : {Case{"lpe.LDDE", "samples 1,blend_radius 4", {"--samples", "3", "--max-bounces", "1"}},
                        Case{"lpe.full", "blend_radius 4", {"--max-bounces", "0"}}}) {
    const Arguments trade = {"tradeoff",   Scene("snail.glb"),
                             "--style",    "scene-oil",
                             "--set",      "transfer.guide_weights." + c.weight + "=1",
                             "--size",     "64x36",
                             "--repeat",   "1",
                             "--no-memory"};
    const nlohmann::json variants =
        RunOk(With(With(trade, c.light), {"--only", c.only, "--json", "-o", "out"})).Json()["variants"];
    EXPECT_EQ(variants.size(), c.only.starts_with("samples") ? 3u : 2u);
    for (const auto& variant : variants) {
      RunOk(With(With({"stylize", Scene("snail.glb")}, Words(variant["options"])), {"-o", "again.png"}));
      EXPECT_EQ(Pixels("again.png"), Pixels("out/pictures/" + variant["picture"].get<std::string>()))
          << variant["options"];
    }
  }
}

// A scene that moves, and a style whose chunks begin elsewhere in each frame.
TEST_F(Tradeoff, AFrameIsThatOfStylize) {
  const Arguments arguments = Small(Scene("toys.glb"), {"--only", "blend_radius 4", "--set", "transfer.jitter_fps=12",
                                                        "--json", "--frame", "31", "--fps", "20", "-o", "out"});
  const nlohmann::json variants = RunOk(arguments).Json()["variants"];
  ASSERT_EQ(variants.size(), 2u);
  for (const auto& variant : variants) {
    Arguments words = Words(variant["options"]);
    RunOk(With(With({"stylize", Scene("toys.glb")}, words), {"-o", "again.png"}));
    const auto picture = Pixels("out/pictures/" + variant["picture"].get<std::string>());
    EXPECT_EQ(Pixels("again.png"), picture) << variant["options"];
    const auto frame = std::find(words.begin(), words.end(), "--frame");
    ASSERT_NE(frame, words.end());
    *(frame + 1) = "0";
    RunOk(With(With({"stylize", Scene("toys.glb")}, words), {"-o", "other.png"}));
    EXPECT_NE(Pixels("other.png"), picture);
  }
  // Layers that a key needs in other frames are in this one too: guides of half the size are upsampled with them.
  WriteText("mine/style.toml",
            "[transfer]\nreference_height = 0\nlevels = 4\nblend_radius = [[0, 0], [48, 3]]\n[[exemplar]]\nimage = "
            "\"lit.png\"\n");
  const nlohmann::json half = RunOk(Small(Scene("toys.glb"), {"--only", "resolution 0.5", "--view", "30,20", "--frame",
                                                              "2", "--json", "-o", "out"}))
                                  .Json();
  EXPECT_EQ(half["frame"], 2);
  ASSERT_EQ(half["variants"].size(), 2u);
  for (const auto& variant : half["variants"]) {
    RunOk(With(With({"stylize", Scene("toys.glb")}, Words(variant["options"])), {"-o", "again.png"}));
    EXPECT_EQ(Pixels("again.png"), Pixels("out/pictures/" + variant["picture"].get<std::string>()))
        << variant["options"];
  }
  ExpectError(Small(Scene("toys.glb"), {"--frame", "1", "--fps", "0"}), 2, {"--fps 0"});
  ExpectError(Small(Scene("toys.glb"), {"--animation", "walk"}), 2, {"--animation", "--frame"});
}

TEST_F(Tradeoff, FiguresButTimesAreTheSameForAnyThreads) {
  const Arguments arguments = Small(Scene("toys.glb"), {"--json", "--only",
                                                        "exact,levels 1,threshold 0.25,blend_radius 4,"
                                                        "precision,resolution 0.5,nearest tree"});
  const nlohmann::json one = WithoutTimes(RunOk(With(arguments, {"--threads", "1"})));
  ASSERT_EQ(one.size(), 9u);
  EXPECT_EQ(one, WithoutTimes(RunOk(With(arguments, {"--threads", "2"}))));
  const nlohmann::json other = WithoutTimes(RunOk(With(arguments, {"--threads", "2", "--seed", "1"})));
  EXPECT_NE(one[0]["both"], other[0]["both"]) << "another pattern, other places looked at";
}

TEST_F(Tradeoff, AnIlluminatedStyleIsComparedByItsLight) {
  WritePainted("mine/shade.png", 64, 64);
  WriteText(
      "mine/style.toml",
      "[transfer]\nreference_height = 0\nlevels = 4\npaper = \"#ffeecc\"\n"
      "[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.7\n[[exemplar]]\nimage = \"shade.png\"\nluminance = 0.1\n");
  const CommandResult result = RunOk(Small(Scene("suzanne.glb"), {"--json", "--only", "precision,exact"}));
  const nlohmann::json variants = result.Json()["variants"];
  ASSERT_EQ(variants.size(), 4u);
  EXPECT_EQ(variants[0]["guide_rms"], 0.0) << "suns need no samples: the style's guides are the exact ones";
  EXPECT_EQ(variants[1]["exact"], true);
  EXPECT_GT(variants[2]["guide_rms"].get<double>(), 0.0) << "8 bits of luminance";
  EXPECT_GT(variants[2]["guide_rms"].get<double>(), variants[3]["guide_rms"].get<double>()) << "half floats are finer";
  EXPECT_NE(variants[0]["options"].get<std::string>().find("transfer.paper="), std::string::npos)
      << "measured without paper";
  // ball.glb is lit by a square light, which is sampled.
  const nlohmann::json sampled =
      RunOk(Small(Scene("ball.glb"), {"--json", "--only", "samples"}, "40x40")).Json()["variants"];
  std::map<std::string, double> rms;
  for (const auto& variant : sampled) rms[variant["value"]] = variant["guide_rms"];
  ASSERT_TRUE(rms.count("1") && rms.count("256") && rms.count("1024"));
  EXPECT_GT(rms["1024"], 0.0) << "what the others are compared with has noise of its own";
  EXPECT_LT(rms["1024"], rms["256"]);
  EXPECT_GT(rms["1"], 4.0 * rms["256"]) << "noise falls with the root of the samples: 16 times, less what is cut at 1";
}

// Given stops apply to every variant, to its stylize command, and to the command that measures it again; fitted ones
// are reported.
TEST_F(Tradeoff, TheExposureIsGivenOrTold) {
  Picture shade = Painted(64, 64);
  for (std::size_t i = 0; i < shade.rgba.size(); ++i) {
    if (i % 4 != 3) shade.rgba[i] = static_cast<std::uint16_t>(shade.rgba[i] / 3);
  }
  ASSERT_TRUE(WritePicture(At("mine/shade.png"), shade).ok());
  WriteText(
      "mine/style.toml",
      "[transfer]\nreference_height = 0\nlevels = 4\n"
      "[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.7\n[[exemplar]]\nimage = \"shade.png\"\nluminance = 0.1\n");
  const auto pictures_of = [&](const Arguments& exposure) {
    const nlohmann::json json =
        RunOk(With(Small(Scene("suzanne.glb"), {"--only", "levels 1", "--json", "-o", "out"}), exposure)).Json();
    EXPECT_EQ(json["variants"].size(), 2u);
    for (const auto& variant : json["variants"]) {
      RunOk(With(With({"stylize", Scene("suzanne.glb")}, Words(variant["options"])), {"-o", "again.png"}));
      EXPECT_EQ(Pixels("again.png"), Pixels("out/pictures/" + variant["picture"].get<std::string>()))
          << variant["options"];
    }
    return json;
  };
  const nlohmann::json dark = pictures_of({"--exposure", "-4"});
  const std::string dark_picture = Pixels("out/pictures/01-the-style.png");
  EXPECT_EQ(dark["exposure"], -4.0);
  EXPECT_NE(dark["command"].get<std::string>().find("--exposure=-4"), std::string::npos) << dark["command"];
  const nlohmann::json bright = pictures_of({"--exposure", "4"});
  EXPECT_EQ(bright["exposure"], 4.0);
  EXPECT_NE(Pixels("out/pictures/01-the-style.png"), dark_picture) << "256 times as much light";
  const nlohmann::json fitted = pictures_of({});
  EXPECT_EQ(fitted["command"].get<std::string>().find("--exposure"), std::string::npos);
  ASSERT_TRUE(fitted["exposure"].is_number()) << fitted["exposure"];
  const std::string fitted_picture = Pixels("out/pictures/01-the-style.png");
  pictures_of({"--exposure", std::to_string(fitted["exposure"].get<double>())});
  EXPECT_EQ(Pixels("out/pictures/01-the-style.png"), fitted_picture) << "what was told repeats it";
}

TEST_F(Tradeoff, AnExposureThatIsNoneOrIdleIsSaid) {
  ExpectError(Small(Scene("suzanne.glb"), {"--exposure", "bright"}), 2, {"--exposure bright", "auto"});
  const CommandResult idle =
      RunOk(Small(Scene("suzanne.glb"), {"--only", "levels 1", "--exposure", "1", "--json"}, "48x27"));
  EXPECT_NE(idle.Warning().find("--exposure 1 changes nothing"), std::string::npos) << idle.err;
  EXPECT_TRUE(idle.Json()["exposure"].is_null());
}

// Eight variants, their reference and all pictures are too much for a gigabyte at 16384², of which guides alone take 7
// GiB. Nothing is cast, no folder is made, and the advice names options that the command has: it has no layers.
TEST_F(Tradeoff, WhatDoesNotFitIsRefusedBeforeItIsTaken) {
  const Arguments huge = Small(Scene("suzanne.glb"), {"--max-memory", "1G", "--only", "levels", "-o", "out"}, "16384");
  const CommandResult result =
      ExpectError(huge, 2,
                  {"this takes up to ", "guides 7.0 GiB", "reference ", "pictures of all variants ", "energy ",
                   "--max-memory allows 1.0 GiB", "take a smaller --size, or fewer variants by --only, or allow more"});
  EXPECT_EQ(result.Error().find("layers"), std::string::npos) << result.Error();
  EXPECT_FALSE(Exists("out"));
  ExpectError(Small(Scene("suzanne.glb"), {"--max-memory", "0"}), 2, {"--max-memory"});
}

// Guides of twice the size exceed the largest side here; the others are still measured.
TEST_F(Tradeoff, AWayThatCannotBeMadeIsLeftOut) {
  const nlohmann::json json =
      RunOk(Small(Scene("suzanne.glb"), {"--only", "resolution,levels 1", "--json"}, "20000x4")).Json();
  std::set<std::string> variants;
  for (const auto& variant : json["variants"]) variants.insert(variant["variant"]);
  EXPECT_EQ(variants, (std::set<std::string>{"the style", "levels 1", "resolution 0.5", "resolution 0.5 scaled up"}));
  ASSERT_EQ(json["left_out"].size(), 2u) << json["left_out"];
  EXPECT_EQ(json["left_out"][0].get<std::string>().find("resolution 2, as "), 0u) << json["left_out"];
  EXPECT_EQ(json["left_out"][1].get<std::string>().find("texture "), 0u) << "4 rows show too little paint";
}

TEST_F(Tradeoff, TextureThatIsNotMeasuredIsSaid) {
  const Arguments tiny = Small(Scene("suzanne.glb"), {"--only", "levels 1"}, "8x8");
  const nlohmann::json json = RunOk(With(tiny, {"--json"})).Json();
  ASSERT_TRUE(json["variants"][0]["texture"].is_null());
  ASSERT_EQ(json["left_out"].size(), 1u) << json["left_out"];
  EXPECT_EQ(json["left_out"][0].get<std::string>().find("texture "), 0u) << json["left_out"];
  EXPECT_NE(RunOk(tiny).out.find("left out: texture "), std::string::npos);
  EXPECT_TRUE(RunOk(Small(Scene("suzanne.glb"), {"--only", "levels 1", "--json"})).Json()["left_out"].empty());
}

// The cost of a table is reported, though this machine has made it before.
TEST_F(Tradeoff, PreparingIsToldWithNothingKept) {
  const Arguments arguments = Small(Scene("suzanne.glb"), {"--only", "nearest table 64,nearest table 1024", "--json"});
  std::map<std::string, double> ms;  // the least, whatever else the machine does
  for (int run = 0; run < 4; ++run) {
    const nlohmann::json report = RunOk(arguments).Json();
    for (const auto& variant : report["variants"]) {
      const double least = ms.count(variant["variant"]) ? ms[variant["variant"]] : 1e9;
      if (run > 0) ms[variant["variant"]] = std::min(least, variant["prepare_ms"].get<double>());
    }
  }
  // 256 times as many cells to fill.
  EXPECT_GT(ms.at("nearest table 1024"), 4.0 * ms.at("nearest table 64"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// The estimate is an upper bound, as for other commands (memory_estimate_test): above the system's count, but less than
// four times as much.
TEST_F(Tradeoff, TakesNoMoreMemoryThanItSays) {
  const Arguments arguments =
      Small(Scene("suzanne.glb"), {"--only", "levels 1,resolution 0.5", "--threads", "2", "-o", "out"}, "640x360");
  const std::string error =
      ExpectError(With(arguments, {"--max-memory", "1M"}), 2, {"this takes up to ", "MiB of memory"}).Error();
  const std::string before = "this takes up to ";
  const double estimated = 1048576.0 * std::stod(error.substr(error.find(before) + before.size()));
  const pid_t child = Start(arguments);
  int status = 0;
  rusage used{};
  ASSERT_EQ(::wait4(child, &status, 0, &used), child);
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  const double peak = 1024.0 * static_cast<double>(used.ru_maxrss);
  EXPECT_LE(peak, 1.01 * estimated) << "1% for how it is rounded";
  EXPECT_GE(peak, 0.25 * estimated);
}

// Four exemplars of S = 8 · 512² bytes: 4 S as they were read, 4 S as they are painted with, and S more while one of
// them is prepared, since at their own size they are only copied. A second style of the process, which no run of
// stylize has, would be 4 S more; half of that is allowed to the allocator.
TEST_F(Tradeoff, MemoryHasTheStyleOnce) {
  const auto peak_with = [&](const std::string& folder, int size) {
    WritePainted(folder + "/lit.png", size, size);
    std::string text = "[transfer]\nreference_height = 0\nlevels = 4\n";
    for (const char* luminance : {"0.8", "0.4", "0.2", "0.1"}) {
      text += std::string("[[exemplar]]\nimage = \"lit.png\"\nluminance = ") + luminance + "\n";
    }
    WriteText(folder + "/style.toml", text);
    const CommandResult result = RunOk({"tradeoff", Scene("suzanne.glb"), "--style", folder, "--size", "64x36",
                                        "--threads", "1", "--peak-of", "the style"});
    return result.Json()["peak_bytes"].get<double>();
  };
  const double more = peak_with("large", 512) - peak_with("small", 16), s = 8.0 * 512 * 512;
  EXPECT_LT(more, (4 + 4 + 1 + 2) * s);
  EXPECT_GT(more, 4 * s) << "what is painted with is there";
}

#endif

TEST_F(Tradeoff, SaysWhatIsWrongAndHowToMendIt) {
  const std::string scene = Scene("suzanne.glb");
  ExpectError(Small(scene, {"--only", "levles"}), 2, {"--only levles", "levels", "nearest", "threshold"});
  ExpectError(Small(scene, {"--only", ""}), 2, {"--only"});
  ExpectError(Small(scene, {"--repeat", "0"}), 2, {"--repeat"});
  ExpectError({"tradeoff", scene}, 2, {"--style"});
  ExpectError({"tradeoff", "none.glb", "--style", "mine"}, 3, {"none.glb"});
  ExpectError({"tradeoff", scene, "--style", "nobody"}, 3, {"nobody"});
  WriteText("file", "");
  ExpectError(Small(scene, {"-o", "file"}), 4, {"-o file"});
  ExpectError(Small(scene, {"--quick", "--only", "resolution 2,levels"}), 2,
              {"--only resolution 2,levels", "--quick leaves"});
  // One thing that covers no pixel whole has no paint to be measured.
  ExpectError(Small(scene, {"--view", "30,20", "--aa", "4"}, "1x1"), 3, {"covered fully", "--size"});
  WriteText("away.gltf", TriangleGltf(true));
  ExpectError(Small("away.gltf", {"-o", "out"}), 3, {"away.gltf", "nothing", "--view"});
  EXPECT_FALSE(Exists("out/report.html"));
  EXPECT_FALSE(Exists("out/tradeoff.csv"));
}

// A folder holds one report: pictures that an earlier one lists are removed, and no other files.
TEST_F(Tradeoff, AFolderIsTakenAgainAndLeftAsItWasFound) {
  const auto pictures = [&] {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(At("out/pictures"))) names.insert(entry.path().filename().string());
    return names;
  };
  const std::string scene = Scene("suzanne.glb");
  RunOk(Small(scene, {"--only", "levels 1,levels 2", "-o", "out"}));
  EXPECT_EQ(pictures().size(), 3u);
  WriteText("out/pictures/04-holiday.png", "mine");
  RunOk(Small(scene, {"--only", "levels 2", "-o", "out"}));
  EXPECT_EQ(pictures(), (std::set<std::string>{"01-the-style.png", "02-levels-2.png", "04-holiday.png"}));
  // A report that is none names nothing.
  WriteText("out/tradeoff.json", R"({"variants": [{"picture": "../../mine/lit.png"}, {"picture": 3}, 4]})");
  RunOk(Small(scene, {"--only", "levels 2", "-o", "out"}));
  EXPECT_TRUE(Exists("mine/lit.png"));
  // Where something is wrong no folder stays that was not there, and every one that was.
  ExpectError(Small(scene, {"--only", "levles", "-o", "new/deep"}), 2, {"--only levles"});
  EXPECT_FALSE(Exists("new"));
  WriteText("file", "");
  ExpectError(Small(scene, {"-o", "file/deep"}), 4, {"-o file/deep: ", "none can be made: Not a directory"});
  fs::create_directories(At("empty"));
  ExpectError(Small(scene, {"--only", "levles", "-o", "empty"}), 2, {"--only levles"});
  ExpectError({"tradeoff", scene, "--style", "nobody", "-o", "empty"}, 3, {"nobody"});
  EXPECT_TRUE(fs::is_empty(At("empty")));
  EXPECT_EQ(pictures().size(), 3u);
  // An exemplar among the pictures would be painted over.
  fs::copy_file(At("mine/lit.png"), At("out/pictures/01-the-style.png"), fs::copy_options::overwrite_existing);
  WriteText("out/pictures/style.toml", "[[exemplar]]\nimage = \"01-the-style.png\"\n");
  const std::string before = Bytes("out/pictures/01-the-style.png");
  ExpectError({"tradeoff", scene, "--style", "out/pictures", "--size", "96x54", "-o", "out"}, 2, {"01-the-style.png"});
  EXPECT_EQ(Bytes("out/pictures/01-the-style.png"), before);
}

TEST_F(Tradeoff, InterruptedLeavesNoFolder) {
  const pid_t child =
      Start({"tradeoff", Scene("suzanne.glb"), "--style", "mine", "--size", "96x54", "--repeat", "1000", "-o", "out"});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // of the minutes that a thousand runs take
  ::kill(child, SIGINT);
  EXPECT_EQ(Finish(child).code, 128 + SIGINT) << "it was at work";
  EXPECT_FALSE(Exists("out"));
}

// Files may not exceed 10,000 bytes: the pictures fit, the page, which holds them all as text, does not. An older
// report stays, to the byte; the new figures are still printed.
TEST_F(Tradeoff, AReportWithoutRoomLeavesTheOlderOne) {
  const Arguments arguments = Small(Scene("suzanne.glb"), {"--only", "levels 1", "-o", "out"}, "48x27");
  RunOk(arguments);
  WriteText("out/pictures/01-the-style.png", "an older one");
  const auto files = [&] {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : fs::recursive_directory_iterator(At("out"))) {
      if (entry.is_regular_file()) bytes[entry.path().string()] = ReadAll(entry.path().string());
    }
    return bytes;
  };
  const auto before = files();
  ASSERT_EQ(before.size(), 6u) << "two pictures, page, chart, table and figures";
  EXPECT_LT(before.at(At("out/pictures/02-levels-1.png").string()).size(), 10000u);
  EXPECT_GT(before.at(At("out/report.html").string()).size(), 10000u);
  CommandSettings settings;
  settings.file_size_limit = 10000;
  const CommandResult refused = Run(arguments, settings);
  EXPECT_EQ(refused.code, 4) << refused.err;
  for (const char* part : {"out/report.html", "File too large", "make room"}) {
    EXPECT_NE(refused.Error().find(part), std::string::npos) << part << ": " << refused.Error();
  }
  EXPECT_NE(refused.out.find("levels 1"), std::string::npos) << "the table: " << refused.out;
  EXPECT_EQ(files(), before);
  const CommandResult json = Run(With(arguments, {"--json"}), settings);
  EXPECT_EQ(json.code, 4) << json.err;
  EXPECT_EQ(json.Json()["variants"].size(), 2u) << json.out;
}

// If killed among its pictures, it leaves no page, table or figures of the older report with them. A pipe without a
// reader stops it at the second picture.
TEST_F(Tradeoff, KilledAmongItsPicturesItLeavesNoPage) {
  const Arguments arguments = Small(Scene("suzanne.glb"), {"--only", "levels 1", "-o", "out"}, "48x27");
  RunOk(arguments);
  WriteText("out/pictures/01-the-style.png", "an older one");
  fs::remove(At("out/pictures/02-levels-1.png"));
  ASSERT_EQ(::mkfifo(At("out/pictures/02-levels-1.png").c_str(), 0600), 0);
  const pid_t child = Start(arguments);
  const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(30 * SCUMBLE_TESTS_SLOWER);
  while (Bytes("out/pictures/01-the-style.png") == "an older one" && std::chrono::steady_clock::now() < late) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::kill(child, SIGKILL);
  EXPECT_EQ(Finish(child).code, 128 + SIGKILL) << "it waited for a reader";
  EXPECT_NE(Bytes("out/pictures/01-the-style.png"), "an older one") << "it came to its pictures";
  for (const char* name : {"report.html", "tradeoff.json", "tradeoff.csv", "chart.svg"}) {
    EXPECT_FALSE(Exists(std::string("out/") + name)) << name;
  }
  fs::remove(At("out/pictures/02-levels-1.png"));
  RunOk(arguments);
  EXPECT_TRUE(Exists("out/report.html")) << "the folder is taken again";
}

TEST_F(Tradeoff, HelpSaysWhatIsTimed) {
  const std::string help = RunOk({"help", "tradeoff"}).out;
  for (const char* word : {"--only", "--quick", "--repeat", "--samples", "--exposure", "--max-memory", "--no-memory",
                           "texture", "not in", "FOLDER"}) {
    EXPECT_NE(help.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(help.find("--peak-of"), std::string::npos) << "for the program itself";
}

// Embree's robust mode affects rays that hit an edge. Other hits are equal, and our own arithmetic refines their last
// bits in any case. The file records the mode.
TEST_F(Tradeoff, GuidesWithoutRobustModeSaySo) {
  const Arguments arguments = {"guidegen", Scene("suzanne.glb"), "--size", "160x90", "-o"};
  RunOk(With(arguments, {"robust.exr"}));
  RunOk(With(arguments, {"plain.exr", "--no-robust"}));
  const auto robust = ReadGuides(At("robust.exr"), {}), plain = ReadGuides(At("plain.exr"), {});
  ASSERT_TRUE(robust.ok() && plain.ok());
  EXPECT_EQ(robust->attributes.count("scumble:robust"), 0u);
  ASSERT_EQ(plain->attributes.count("scumble:robust"), 1u);
  EXPECT_EQ(plain->attributes.at("scumble:robust"), "false");
  std::size_t different = 0;
  for (std::size_t i = 0; i < robust->pixel_count(); ++i) {
    different += robust->Plane(Layer::kObject)[i] != plain->Plane(Layer::kObject)[i];
  }
  // Only where a ray passes an outline within float's sight, 2^-20 of 9 m to either side beside pixels of 0.026 m:
  // outlines are some 1,500 pixels long, so one centre is expected there, and more than three once in fifty.
  EXPECT_LE(different, 3u);
}

// Pictures and times are those with the effects; figures of the paint are those without, which no exemplar has.
TEST_F(Tradeoff, KnowsFinishingEffects) {
  const Arguments more{"--only", "levels 1", "--json"};
  const CommandResult plain = RunOk(With(Small(Scene("suzanne.glb"), more), {"-o", "plain"}));
  const CommandResult inked =
      RunOk(With(Small(Scene("suzanne.glb"), more), {"-o", "inked", "--finish", "fill", "--finish", "outline"}));
  const nlohmann::json before = plain.Json()["variants"][0], after = inked.Json()["variants"][0];
  for (const char* key : {"texture", "energy", "missing", "guide_degrees"}) EXPECT_EQ(before[key], after[key]) << key;
  EXPECT_TRUE(Contains(after["options"].get<std::string>(), "--finish fill --finish outline")) << after["options"];
  const auto first = ReadPicture(At("plain/pictures/" + before["picture"].get<std::string>()));
  const auto second = ReadPicture(At("inked/pictures/" + after["picture"].get<std::string>()));
  ASSERT_TRUE(first && second);
  EXPECT_NE(first->rgba, second->rgba);
}

}  // namespace
}  // namespace scumble
