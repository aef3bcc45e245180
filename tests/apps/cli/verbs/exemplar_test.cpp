// Exemplars with their own guides, from the command line: painted scenes, the cache of tables, styles check.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"
#include "tests/support/painted_spheres.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

class CliExemplar : public CliTest {
 protected:
  // A style painted on suzanne, 96×54.
  void WriteSceneStyle() {
    RunOk({"guidegen", Scene("suzanne.glb"), "--size", "96x54", "-q", "-o", "style/scene.exr"});
    WritePainted("style/scene.png", 96, 54);
    WriteText("style/style.toml",
              "name = \"scene\"\n[transfer]\nreference_height = 0\nlevels = 4\n"
              "[[exemplar]]\nimage = \"scene.png\"\nguides = \"scene.exr\"\n");
  }
  std::string Paint(const std::string& name, const Arguments& more = {}) {
    WriteGuideFile("ball.exr", Ball(48));
    RunOk(With({"transfer", "ball.exr", "--style", "style", "-o", name}, more));
    return Bytes(name);
  }
  std::vector<fs::path> Tables() const {
    std::vector<fs::path> files;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(Cache() / "scumble", failed)) files.push_back(entry.path());
    return files;
  }
};

TEST_F(CliExemplar, TablesAreKeptAndDamagedOnesRebuilt) {
  fs::create_directory(At("style"));
  WriteSceneStyle();
  const std::string first = Paint("first.png");
  ASSERT_EQ(Tables().size(), 1u);
  const fs::path table = Tables()[0];
  const std::string kept = ReadAll(table.string());
  EXPECT_GT(kept.size(), 512u * 512u * 4u);
  const auto made = fs::last_write_time(table);
  EXPECT_EQ(Paint("second.png"), first);
  EXPECT_EQ(fs::last_write_time(table), made) << "read, not made again";
  for (int damage = 0; damage < 4; ++damage) {
    std::string bytes = kept;
    if (damage == 0) bytes.clear();
    if (damage == 1) bytes.resize(bytes.size() / 2);
    if (damage == 2) bytes[bytes.size() / 2] ^= 1;
    if (damage == 3) bytes += "more";
    std::ofstream(table, std::ios::binary | std::ios::trunc) << bytes;
    EXPECT_EQ(Paint("again.png"), first) << damage;
    EXPECT_EQ(ReadAll(table.string()), kept) << damage;
  }
  EXPECT_EQ(Paint("tree.png", {"--set", "transfer.nearest=tree"}).empty(), false);
  EXPECT_EQ(Tables().size(), 1u) << "nothing but the table; the style's folder is not written to";
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(At("style"))) ++files;
  EXPECT_EQ(files, 3u);
}

TEST_F(CliExemplar, GuidesOfLightFromTheSphereToThePicture) {
  RunOk({"sphere", "--size", "64", "--layers", "lpe.LDE,lpe.LSE", "-q", "-o", "ball"});
  WritePainted("ball/lit.png", 64, 64);
  WriteText("ball/style.toml",
            "name = \"ball\"\n[transfer]\nreference_height = 0\nlevels = 4\nblend_radius = 2\n"
            "[transfer.guide_weights]\nluminance = 1.0\n\"lpe.LDE\" = 0.5\n"
            "[[exemplar]]\nimage = \"lit.png\"\nguides = \"guides.exr\"\n");
  const std::string scene = Scene("stilllife.glb");
  const Arguments size = {"--size", "96x54", "--aa", "4"};
  RunOk(With({"stylize", scene, "--style", "ball", "-o", "one.png"}, size));
  RunOk(With({"guidegen", scene, "--style", "ball", "-q", "-o", "scene.exr"}, size));
  RunOk({"transfer", "scene.exr", "--style", "ball", "-o", "two.png"});
  EXPECT_EQ(Bytes("one.png"), Bytes("two.png"));
  RunOk({"transfer", "scene.exr", "--style", "ball", "--threads", "1", "-o", "single.png"});
  EXPECT_EQ(Bytes("one.png"), Bytes("single.png"));
  // Neutral: the plain engine's bytes. Not neutral: others.
  const Arguments plain = {"--set", "transfer.guide_weights.luminance=0", "--set", "transfer.guide_weights.lpe.LDE=0"};
  RunOk(With({"transfer", "scene.exr", "--style", "ball", "-o", "neutral.png"}, plain));
  WriteText("ball/plain.toml",
            "[transfer]\nreference_height = 0\nlevels = 4\nblend_radius = 2\n"
            "[[exemplar]]\nimage = \"lit.png\"\nguides = \"guides.exr\"\n");
  RunOk({"transfer", "scene.exr", "--style", "ball/plain.toml", "-o", "other.png"});
  EXPECT_EQ(Bytes("other.png"), Bytes("neutral.png"));
  EXPECT_FALSE(Pixels("one.png") == Pixels("neutral.png"));
  for (const char* what : {"error", "sources"}) {
    RunOk({"transfer", "scene.exr", "--style", "ball", "--show", what, "-o", "show.png"});
  }
  RunOk(With({"transfer", "scene.exr", "--style", "oil", "--assign", "Vase=ball", "-o", "many.png"}, {}));
  const auto checked = RunOk({"styles", "check", "ball"});
  EXPECT_NE(checked.out.find("guides: 7 dimensions"), std::string::npos) << checked.out;
  EXPECT_NE(checked.out.find("lpe.LDE shows 0.00 to"), std::string::npos) << checked.out;
  WriteText("ball/weights.toml",
            "[transfer.guide_weights]\nalbedo = 1.0\n\"lpe.LSE\" = 0.5\n"
            "[[exemplar]]\nimage = \"lit.png\"\nguides = \"guides.exr\"\n");
  const std::string faults = RunOk({"styles", "check", "ball/weights.toml"}).err;
  EXPECT_TRUE(Contains(faults,
                       "lit.png: albedo has a weight, and is 1.00 all over its guides; set "
                       "transfer.guide_weights.albedo to 0"))
      << faults;
  EXPECT_FALSE(Contains(faults, "lpe.LSE")) << "a highlight varies: " << faults;
  // Guides that lack a required layer.
  RunOk(With({"guidegen", scene, "-q", "-o", "dark.exr"}, size));
  const auto refused = Run({"transfer", "dark.exr", "--style", "ball", "-o", "no.png"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("luminance"), std::string::npos) << refused.err;
}

TEST_F(CliExemplar, ALayerOfOneColourIsFound) {
  GuideSet guides = Ball(48);
  guides.Add(Layer::kAlbedo);
  const float color[] = {0.2f, 0.5f, 0.9f};
  for (int c = 0; c < 3; ++c) std::ranges::fill(guides.Plane(Layer::kAlbedo, c), color[c]);
  fs::create_directory(At("ball"));
  WritePainted("ball/lit.png", 48, 48);
  WriteText("ball/style.toml",
            "[transfer.guide_weights]\nalbedo = 2.0\n[[exemplar]]\nimage = \"lit.png\"\nguides = \"guides.exr\"\n");
  WriteGuideFile("ball/guides.exr", guides);
  const std::string faults = RunOk({"styles", "check", "ball"}).err;
  EXPECT_TRUE(Contains(faults,
                       "lit.png: albedo has a weight, and is 0.20, 0.50, 0.90 all over its guides; set "
                       "transfer.guide_weights.albedo to 0"))
      << faults;
  for (std::size_t i = 0; i < guides.pixel_count(); i += 2) guides.Plane(Layer::kAlbedo, 1)[i] = 0.6f;
  WriteGuideFile("ball/guides.exr", guides);
  const std::string none = RunOk({"styles", "check", "ball"}).err;
  EXPECT_FALSE(Contains(none, "albedo")) << "one channel varies: " << none;
}

TEST_F(CliExemplar, ACacheThatCannotBeWrittenIsNoError) {
  fs::create_directory(At("style"));
  WriteSceneStyle();
  const std::string first = Paint("first.png");
  fs::remove_all(Cache());
  WriteText("../cache", "a file where the folder should be");
  EXPECT_EQ(Paint("second.png"), first);
  ::setenv("XDG_CACHE_HOME", "/proc/none", 1);
  EXPECT_EQ(Paint("third.png"), first);
  ::setenv("XDG_CACHE_HOME", "relative", 1);
  const char* const home = std::getenv("HOME");
  const std::string home_before = home ? home : "";
  ::setenv("HOME", (Work() / "home").c_str(), 1);
  EXPECT_EQ(Paint("fourth.png"), first);
  EXPECT_TRUE(Exists("home/.cache/scumble")) << "a relative XDG_CACHE_HOME does not count";
  EXPECT_FALSE(Exists("relative"));
  ::unsetenv("HOME");
  EXPECT_EQ(Paint("fifth.png"), first);
  if (home) ::setenv("HOME", home_before.c_str(), 1);
}

TEST_F(CliExemplar, TheCacheDoesNotGrowForEver) {
  fs::create_directory(At("style"));
  WriteSceneStyle();
  for (int i = 0; i < 300; ++i) {
    WriteText("../cache/scumble/" + std::to_string(i) + ".table", "old");
    fs::last_write_time(Cache() / "scumble" / (std::to_string(i) + ".table"),
                        fs::file_time_type::clock::now() - std::chrono::hours(1000 - i));
  }
  WriteText("../cache/scumble/notes.txt", "not ours to remove");
  Paint("first.png");
  EXPECT_EQ(Tables().size(), 257u) << "256 tables and the notes";
  EXPECT_TRUE(fs::exists(Cache() / "scumble/notes.txt"));
  EXPECT_FALSE(fs::exists(Cache() / "scumble/44.table")) << "the 45 oldest are gone";
  EXPECT_TRUE(fs::exists(Cache() / "scumble/45.table"));
}

TEST_F(CliExemplar, SpheresNeedNoTable) {
  WriteStyle("style");
  Paint("first.png");
  EXPECT_TRUE(Tables().empty());
  ExpectError({"transfer", "ball.exr", "--style", "style", "--set", "transfer.nearest=magic", "-o", "x.png"}, 2,
              {"transfer.nearest", "analytic"});
}

TEST_F(CliExemplar, CheckReportsDirectionsAndRepeats) {
  WriteStyle("style");
  const CommandResult sphere = RunOk({"styles", "check", "style"});
  EXPECT_NE(sphere.out.find("test: 64² pixels"), std::string::npos) << sphere.out;
  EXPECT_NE(sphere.out.find("\ndirections: "), std::string::npos) << sphere.out;
  EXPECT_NE(sphere.out.find("\nrepeats: "), std::string::npos) << sphere.out;
  EXPECT_EQ(sphere.err.find("directions"), std::string::npos) << sphere.err;
  EXPECT_EQ(sphere.err.find("flat faces"), std::string::npos) << sphere.err;
  const nlohmann::json json = RunOk({"styles", "check", "style", "--json"}).Json();
  EXPECT_EQ(json["shape"], "sphere");
  EXPECT_GT(json["directions"]["covered_percent"], 65.0);
  EXPECT_EQ(json["directions"]["flat_percent"], 0.0);
  // A wedge: two flat faces.
  GuideSet wedge = Ball(64);
  for (int i = 0; i < 64 * 64; ++i) {
    const float values[3] = {i % 64 < 32 ? -0.6f : 0.6f, 0.0f, 0.8f};
    for (int c = 0; c < 3; ++c)
      wedge.Plane(Layer::kNormal, c)[i] = wedge.Plane(Layer::kCoverage)[i] > 0 ? values[c] : 0.0f;
    if (wedge.Plane(Layer::kCoverage)[i] > 0) wedge.Plane(Layer::kDepth)[i] = 5.0f;  // of a ball no more
  }
  fs::create_directory(At("wedge"));
  WriteGuideFile("wedge/wedge.exr", wedge);
  WritePainted("wedge/wedge.png", 64, 64);
  WriteText("wedge/style.toml", "[[exemplar]]\nimage = \"wedge.png\"\nguides = \"wedge.exr\"\n");
  const CommandResult flat = RunOk({"styles", "check", "wedge"});
  EXPECT_NE(flat.err.find("100% of the painting shows flat faces: 2 of"), std::string::npos) << flat.err;
  EXPECT_NE(flat.err.find("use a rounded shape"), std::string::npos) << flat.err;
  EXPECT_EQ(RunOk({"styles", "check", "wedge", "--json"}).Json()["directions"]["shown"], 2);
  EXPECT_EQ(RunOk({"styles", "check", "wedge", "--json"}).out, RunOk({"styles", "check", "wedge", "--json"}).out);
  ExpectError({"transfer", "wedge/wedge.exr", "--style", "wedge", "--set", "transfer.nearest=analytic", "-o", "x.png"},
              2, {"transfer.nearest", "spheres"});
}

// A sphere of that radius in a picture of another size, cut out with a soft edge, or on white paper.
Picture Laid(int width, int height, double x, double y, double radius, double soft, bool cut_out) {
  PaintedSphere painted;
  painted.size = static_cast<int>(2 * radius), painted.reach = 2.0;
  const Picture sphere = PaintSphere(painted);
  Picture picture(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      SetGrey(picture, u, v, 1.0);
      const double r = std::hypot(u + 0.5 - x, v + 0.5 - y);
      const double share = std::clamp(0.5 + (radius - soft - r) / (2.0 * soft), 0.0, 1.0);
      if (share > 0.0) {
        const int i = std::clamp(static_cast<int>(u - x + radius), 0, sphere.width - 1);
        const int j = std::clamp(static_cast<int>(v - y + radius), 0, sphere.width - 1);
        std::copy_n(sphere.At(i, j), 4, picture.At(u, v));
      }
      if (cut_out) picture.At(u, v)[3] = static_cast<std::uint16_t>(65535.0 * share + 0.5);
    }
  }
  return picture;
}

// Nothing of a soft edge ends up inside objects, and a warning names the rim.
TEST_F(CliExemplar, ASoftEdgeIsLeftOutAndSaidToBe) {
  WriteGuideFile("ball.exr", Ball(200));
  fs::create_directory(At("cut"));
  ASSERT_TRUE(WritePicture(At("cut/lit.png"), Laid(400, 400, 200, 200, 200, 2.0, true)).ok());
  WriteText("cut/style.toml", "[transfer]\nreference_height = 0\n[[exemplar]]\nimage = \"lit.png\"\n");
  const CommandResult run = RunOk({"transfer", "ball.exr", "--style", "cut", "-o", "soft.png"});
  EXPECT_TRUE(Contains(run.Warning(), "lit.png: the edge of the sphere is see-through up to 4 pixels inside it"))
      << run.err;
  EXPECT_TRUE(Contains(run.Warning(), "--set transfer.rim=4")) << run.err;
  const Expected<Picture> picture = ReadPicture(At("soft.png"));
  ASSERT_TRUE(picture);
  int inside = 0;
  for (int i = 0; i < 200 * 200; ++i) {
    if (std::hypot(i % 200 - 99.5, i / 200 - 99.5) > 98.0) continue;
    inside += picture->rgba[std::size_t(i) * 4 + 3] < 65000;
  }
  EXPECT_EQ(inside, 0) << "half transparent pixels inside the ball";
  const CommandResult wide =
      RunOk({"transfer", "ball.exr", "--style", "cut", "--set", "transfer.rim=4", "-o", "wide.png"});
  EXPECT_EQ(wide.Warning(), "");
  EXPECT_EQ(Bytes("wide.png").size() > 0 && Pixels("wide.png") == Pixels("soft.png"), true) << "rim says the same";
  const CommandResult check = RunOk({"styles", "check", "cut"});
  EXPECT_TRUE(Contains(check.Warning(), "see-through up to 4 pixels")) << check.err;
  EXPECT_TRUE(Contains(check.Warning(), "write rim = 4 into [transfer]")) << check.err;
  EXPECT_FALSE(Contains(check.err, "half see-through")) << check.err;
}

// Any picture of one painted ball works, and the run says where it is.
TEST_F(CliExemplar, ASphereIsTakenAsItLies) {
  WriteGuideFile("ball.exr", Ball(64));
  ASSERT_TRUE(WritePicture(At("aside.png"), Laid(640, 400, 250, 180, 150, 0.5, false)).ok());
  const CommandResult run = RunOk({"transfer", "ball.exr", "--style", "aside.png", "-o", "out.png"});
  EXPECT_EQ(run.Warning(), "");
  EXPECT_TRUE(Contains(run.err,
                       "aside.png: its sphere does not fill the picture of 640×400; it is taken as it lies, "
                       "around x=250, y=180, with a radius of 1"))
      << run.err;
  const CommandResult quiet = RunOk({"transfer", "ball.exr", "--style", "aside.png", "-q", "-o", "out.png"});
  EXPECT_EQ(quiet.err, "");
  const CommandResult check = RunOk({"styles", "check", "aside.png", "--strict"});
  EXPECT_EQ(check.err, "");
  EXPECT_TRUE(Contains(check.out, "remark: aside.png: its sphere does not fill")) << check.out;
  const nlohmann::json json = RunOk({"styles", "check", "aside.png", "--json"}).Json();
  EXPECT_EQ(json["faults"][0]["code"], "taken-as-it-lies");
  EXPECT_NEAR(json["exemplars"][0]["sphere"]["x"].get<double>(), 250, 1.5);
  EXPECT_NEAR(json["exemplars"][0]["sphere"]["radius"].get<double>(), 150, 2.5);
}

TEST_F(CliExemplar, WhatIsNoSphereIsRefusedInWords) {
  WriteGuideFile("ball.exr", Ball(64));
  Picture two = Laid(640, 400, 150, 180, 120, 0.5, false);
  const Picture other = Laid(640, 400, 450, 200, 130, 0.5, false);
  for (std::size_t i = 0; i < two.rgba.size(); ++i) two.rgba[i] = std::min(two.rgba[i], other.rgba[i]);
  ASSERT_TRUE(WritePicture(At("two.png"), two).ok());
  ExpectError({"transfer", "ball.exr", "--style", "two.png", "-o", "out.png"}, 3,
              {"two.png shows more than one sphere", "crop the picture to it"});
  ExpectError({"styles", "check", "two.png"}, 3, {"two.png shows more than one sphere"});
  Picture box(300, 300);
  for (int i = 0; i < 300 * 300; ++i) {
    const bool inside = std::max(std::abs(i % 300 - 150), std::abs(i / 300 - 150)) < 80;
    SetGrey(box, i % 300, i / 300, inside ? 0.2 + 0.001 * (i % 300) : 1.0);
  }
  ASSERT_TRUE(WritePicture(At("box.png"), box).ok());
  ExpectError({"transfer", "ball.exr", "--style", "box.png", "-o", "out.png"}, 3,
              {"box.png is 300×300", "shows no clear sphere", "crop it to the sphere", "--set exemplar.1.fills=true"});
  ExpectError({"styles", "check", "box.png"}, 3, {"box.png is 300×300", "shows no clear sphere"});
  RunOk({"transfer", "ball.exr", "--style", "box.png", "--set", "exemplar.1.fills=true", "-o", "out.png"});
}

}  // namespace
}  // namespace scumble
