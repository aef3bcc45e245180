// A run's estimate of its peak memory, against the system's count; and refusals before anything is allocated.
#include "pipeline/memory_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/finish_keys.h"
#include "core/style/style_override.h"
#include "tests/support/cli_harness.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

class MemoryNeedTest : public CliTest {
 protected:
  // The estimate is an upper bound: pixels covered from edge to edge, paint and guides that do not pack at all, all
  // threads at work. So the count is below it. It is also tight: the count is above a quarter.
  void ExpectHonest(const Arguments& arguments) {
    const nlohmann::json json = RunOk(With(arguments, {"--json", "--threads", "2"})).Json()["memory"];
    ASSERT_TRUE(json.is_object()) << Joined(arguments);
    const double estimated = json["estimated_peak_bytes"], peak = json["peak_bytes"];
    double sum = 0;
    for (const auto& [name, bytes] : json["parts"].items()) sum += bytes.get<double>();
    EXPECT_EQ(sum, estimated) << Joined(arguments);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    EXPECT_LE(peak, estimated) << Joined(arguments);
    EXPECT_GE(peak, 0.25 * estimated) << Joined(arguments);
#endif
  }

  // Within the addresses of one plane of 16384² floats, as a shell limits them. Two threads, whose stacks take few of
  // them.
  void ExpectErrorInOnePlane(const Arguments& arguments, int code, const std::vector<std::string>& parts) {
    constexpr int kPlaneKilobytes = 16384 / 1024 * 16384 * 4;
    CommandSettings shell;
    shell.program = "/bin/sh";
    const std::string limited = "ulimit -v " + std::to_string(kPlaneKilobytes) + R"( && exec "$0" "$@")";
    ExpectError(With({"-c", limited, SCUMBLE_BINARY}, With(arguments, {"--threads", "2"})), code, parts, shell);
  }
};

TEST_F(MemoryNeedTest, NothingTakesMoreThanItSays) {
  WriteStyle("style");
  for (const char* size : {"16", "400", "1100x900"}) {
    ExpectHonest({"guidegen", Scene("suzanne.glb"), "--size", size, "-o", "g.exr"});
    ExpectHonest({"transfer", "g.exr", "--style", "style", "-o", "p.png"});
    ExpectHonest({"stylize", Scene("suzanne.glb"), "--size", size, "--style", "style", "-o", "p.exr"});
  }
  ExpectHonest({"guidegen", Scene("ball.glb"), "--size", "700", "--compression", "none", "--layers", "albedo,position",
                "-o", "g.exr"});
  ExpectHonest(
      {"guidegen", Scene("ball.glb"), "--size", "400", "--layers", "lpe.full", "--samples", "1", "-o", "g.exr"});
  const Arguments stylize = {"stylize", Scene("ball.glb"), "--size", "800", "--style", "style"};
  ExpectHonest(With(stylize, {"-o", "p.tif"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--upsample", "2"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--set", "transfer.coherent=true"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--set", "transfer.match_step=2", "--set", "transfer.hybrid=3"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--set", "transfer.blend_radius=20", "--show", "error"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--finish", "storybook", "--finish", "smooth", "--finish", "edges"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--finish", "comic", "--layers-out", "l.ora"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--finish", "hatch", "--show", "finish:hatch"}));
  ExpectHonest(With(stylize, {"-o", "p.png", "--finish", "hatch", "--set", "finish.hatch.stick=true"}));
  ExpectHonest({"guidegen", Scene("snail.glb"), "--size", "800", "--layers", "luminance,shadow", "-o", "s.exr"});
  ExpectHonest({"transfer", "s.exr", "--style", "style", "--finish", "charcoal-lines", "-o", "p.png"});
  ExpectHonest({"finish", "p.png", "s.exr", "--finish", "charcoal-lines", "-o", "f.png"});
  ExpectHonest({"sphere", "--size", "500", "-o", "kit"});
}

// Large papers and pictures underneath, by our own readers and by OpenImageIO, which stays.
TEST_F(MemoryNeedTest, PicturesThatAreReadTakeNoMoreThanTheySay) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(1000));
  for (const char* const file : {"sheet.png", "sheet.jpg", "sheet.tif", "sheet.exr"}) {
    ASSERT_TRUE(WritePicture(At(file), Painted(1000, 1000)).ok());
  }
  const Arguments stylize = {"stylize", Scene("ball.glb"), "--size", "160", "--style", "style", "-o", "p.png", "--set"};
  ExpectHonest(With(stylize, {"transfer.paper=" + At("sheet.png").string()}));
  ExpectHonest(With(stylize, {"transfer.paper=" + At("sheet.jpg").string()}));
  ExpectHonest({"transfer", "g.exr", "--style", "style", "--over", "sheet.tif", "-o", "p.png"});
  ExpectHonest({"finish", "sheet.exr", "--finish", "grade", "-o", "p.png"});
}

// A finish whose keys change takes what its greediest frame does, in every frame.
TEST(FinishMemory, IsThatOfTheGreediestFrame) {
  const auto needed = [](const FinishChain& chain) {
    MemoryNeed need;
    AddFinish(chain, true, {100, 100}, need);
    return need.peak();
  };
  FinishPass smooth = *MakeFinishPass("smooth");
  FinishChain moving{{smooth}, {}};
  std::get<SmoothPass>(smooth.effect).filter = SmoothPass::Filter::kKuwahara;
  const FinishChain greedy{{smooth}, {}};
  EXPECT_LT(needed(moving), needed(greedy));
  ASSERT_TRUE(
      OverrideFinish(moving, ParseOverride("finish.smooth.filter=[[1, \"bilateral\"], [5, \"kuwahara\"]]").value()));
  ASSERT_TRUE(OverrideFinish(moving, ParseOverride("finish.smooth.strength=[[1, 0], [9, 1]]").value()));
  EXPECT_EQ(moving.passes[0].strength, 0.0);
  EXPECT_EQ(needed(moving), needed(greedy));
}

// A small sphere in a large file: the file is there while the sphere is looked for.
TEST_F(MemoryNeedTest, FindingASphereTakesNoMoreThanItSays) {
  Picture sheet(3000, 2200);
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      std::uint16_t* const texel = sheet.At(x, y);
      const bool is_ball = std::hypot(x - 1500.5, y - 1100.5) < 400.0;
      texel[0] = texel[1] = texel[2] = is_ball ? 20000 : 65535, texel[3] = 65535;
    }
  }
  ASSERT_TRUE(WritePicture(At("ball.png"), sheet).ok());
  ExpectHonest({"stylize", Scene("suzanne.glb"), "--size", "200", "--style", "ball.png", "-o", "p.png"});
}

// A mesh of 8,192 triangles 48 times, and one of two 20,000 times: Embree has corners and a hierarchy for each of them.
// The estimate has 340 bytes for a triangle and 40 for a vertex, of which triangles may share none, 220 for each
// further instance of a triangle, and 2300 for an instance.
TEST_F(MemoryNeedTest, EveryInstanceTakesItsTriangles) {
  const auto bytes_of = [&](const std::string& scene) -> std::uint64_t {
    return RunOk({"guidegen", scene, "--explain", "--json"}).Json()["memory"]["parts"]["scene"];
  };
  WriteText("one.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(bytes_of("one.obj"), 340u + 3u * 40u + 2300u);
  const auto scene_bytes = [&](int side, int instances, const std::string& name) {
    GltfBuilder builder;
    std::vector<float> places;
    std::vector<std::uint16_t> corners;
    for (int y = 0; y <= side; ++y) {
      for (int x = 0; x <= side; ++x) {
        places.insert(places.end(), {float(x) / float(side), float(y) / float(side), 0.1f * float(x * y % 3)});
      }
    }
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const int a = y * (side + 1) + x;
        for (const int corner : {a, a + 1, a + side + 2, a, a + side + 2, a + side + 1}) {
          corners.push_back(std::uint16_t(corner));
        }
      }
    }
    const int position = builder.Floats(places, 3), index = builder.Indices(corners);
    const int mesh = builder.Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", index}}});
    for (int i = 0; i < instances; ++i) {
      const nlohmann::json place = {1.1 * (i % 200), 1.1 * (i / 200), 0.0};
      builder.Root({{"name", "i" + std::to_string(i)}, {"mesh", mesh}, {"translation", place}});
    }
    const auto glb = builder.Glb();
    WriteText(name, std::string(glb.begin(), glb.end()));
    return bytes_of(name);
  };
  const auto added = [&](int side, int instances, const std::string& name) {
    return scene_bytes(side, instances, name) - scene_bytes(side, 1, "once.glb");
  };
  EXPECT_EQ(added(64, 48, "often.glb"), 47u * (220u * 8192u + 2300u));
  EXPECT_EQ(added(1, 20000, "many.glb"), 19999u * (220u * 2u + 2300u));
  ExpectHonest({"guidegen", "often.glb", "--size", "64", "-o", "g.exr"});
  ExpectHonest({"guidegen", "many.glb", "--size", "64", "-o", "g.exr"});
}

// A frame is written while the next one is made, and the one peak of the process is below each frame's estimate.
TEST_F(MemoryNeedTest, SequencesTakeNoMoreThanTheirFramesSay) {
  WriteStyle("style");
  for (const Arguments& arguments :
       {Arguments{"guidegen", Scene("ball.glb"), "--size", "500", "-o", "g.#.exr"},
        Arguments{"stylize", Scene("ball.glb"), "--size", "500", "--style", "style", "-o", "p.#.png"}}) {
    const nlohmann::json json = RunOk(With(arguments, {"--frames", "1-3", "--json", "--threads", "2"})).Json();
    ASSERT_EQ(json["frames"].size(), 3u) << Joined(arguments);
    const double peak = json["memory"]["peak_bytes"];
    for (const nlohmann::json& frame : json["frames"]) {
      const double estimated = frame["memory"]["estimated_peak_bytes"];
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
      EXPECT_LE(peak, estimated) << Joined(arguments);
      EXPECT_GE(peak, 0.25 * estimated) << Joined(arguments);
#endif
    }
  }
}

// Guides are seven floats a pixel, the picture four 16-bit integers: the parts are those numbers.
TEST_F(MemoryNeedTest, ThePlanSaysHowMuchAndForWhat) {
  WriteStyle("style");
  const Arguments plan = {"stylize", Scene("suzanne.glb"), "--size", "1000x500", "--style", "style", "--explain"};
  EXPECT_NE(RunOk(plan).out.find("memory  up to "), std::string::npos);
  const nlohmann::json memory = RunOk(With(plan, {"--json"})).Json()["memory"];
  EXPECT_EQ(memory["parts"]["guides"], 28 * 1000 * 500);
  EXPECT_EQ(memory["parts"]["picture"], 8 * 1000 * 500);
  EXPECT_FALSE(memory.contains("peak_bytes")) << "nothing was taken";
  EXPECT_FALSE(memory["parts"].contains("writer")) << "a plan has no output";
  EXPECT_NE(RunOk({"guidegen", Scene("suzanne.glb"), "--explain"}).out.find("guides"), std::string::npos);
}

TEST_F(MemoryNeedTest, ThePlanOfFramesIsThatOfTheirRun) {
  WriteStyle("style");
  const Arguments guidegen = {"guidegen", Scene("toys.glb"), "--size", "64", "--layers", "motion", "--explain"};
  const Arguments stylize = {"stylize", Scene("toys.glb"), "--size", "64", "--style", "style", "--explain"};
  const CommandResult plan = RunOk(With(guidegen, {"--frames", "1-2", "--json"}));
  EXPECT_EQ(plan.Warning(), "");
  EXPECT_EQ(plan.Json()["memory"]["parts"]["guides"], 36 * 64 * 64);
  EXPECT_EQ(plan.Json()["memory"]["parts"]["frame that is written"], 2 * 36 * 64 * 64);
  const nlohmann::json painted = RunOk(With(stylize, {"--frames", "1-2", "--json"})).Json()["memory"]["parts"];
  EXPECT_TRUE(painted.contains("frame that is written")) << painted;
  const CommandResult one = RunOk(With(guidegen, {"--frame", "2", "--json"}));
  EXPECT_EQ(one.Warning(), "");
  EXPECT_EQ(one.Json()["memory"]["parts"],
            RunOk(With(guidegen, {"--frame", "2", "--json", "-o", "g.exr"})).Json()["memory"]["parts"]);
  for (const Arguments& verb : {guidegen, stylize}) {
    for (const char* frames : {"--frame=2", "--frames=1-2"}) {
      ExpectError(With(verb, {frames, "--animation", "Nope"}), 2, {"no animation \"Nope\"", "\"Animation\""});
    }
  }
  ExpectError(With(stylize, {"--animation", "Nope"}), 2, {"--animation", "--frame N"});
}

// The largest picture that there may be, under a gigabyte: 16384² pixels of guides alone are 7.5 GB. It is refused
// before they are taken, which is why this test is quick, and nothing is written. Planes are taken without being
// touched, so what is resident would not show that one was: but of 1 GiB of addresses, which is one plane of floats,
// the program itself has some, and no plane has room. With a larger limit to try all the same, it does take one, and
// ends for want of memory.
TEST_F(MemoryNeedTest, TheLargestPictureIsRefusedUnderAGigabyte) {
  WriteStyle("style");
  WriteText("p.png", "old");
  const Arguments huge = {"stylize", Scene("suzanne.glb"), "--size", "16384", "--style", "style", "-o",
                          "p.png",   "--max-memory",       "1G"};
  ExpectError(huge, 2,
              {"this takes up to ", " GiB of memory (program ", "guides 7.0 GiB", "picture 2.0 GiB",
               "--max-memory allows 1.0 GiB", "take a smaller --size, or fewer layers, or allow more"});
  EXPECT_EQ(Bytes("p.png"), "old");
  ExpectError({"guidegen", Scene("suzanne.glb"), "--size", "16384", "-o", "g.exr", "--max-memory", "1G"}, 2,
              {"guides 7.0 GiB"});
  EXPECT_FALSE(Exists("g.exr"));
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they take terabytes of addresses
  ExpectErrorInOnePlane(huge, 2, {"guides 7.0 GiB", "--max-memory allows 1.0 GiB"});
  const Arguments guidegen = {"guidegen", Scene("suzanne.glb"), "--size", "16384", "-o", "g.exr", "--max-memory"};
  ExpectErrorInOnePlane(With(guidegen, {"1G"}), 2, {"guides 7.0 GiB"});
  ExpectErrorInOnePlane(With(guidegen, {"1T"}), 6, {"memory"});
  EXPECT_EQ(Bytes("p.png"), "old");
  EXPECT_FALSE(Exists("g.exr"));
#endif
  ExpectError({"sphere", "--size", "8192", "-o", "kit", "--max-memory", "1G"}, 2, {"guides ", "--only png"});
  EXPECT_FALSE(Exists("kit"));
  ExpectError(
      {"guidegen", Scene("suzanne.glb"), "--size", "9000", "--frames", "1-3", "-o", "f.#.exr", "--max-memory", "1G"}, 2,
      {"frame that is written"});
  EXPECT_FALSE(Exists("f.1.exr"));
}

// An exemplar of 2048² pixels, 8 bytes each, in a few kilobytes that are damaged at their end: the error, size or
// damage, shows whether it was read. Guides of 300² have four floats a pixel, their picture has 8 bytes.
TEST_F(MemoryNeedTest, ExemplarsAreCountedBeforeTheyAreRead) {
  WriteStyle("style");
  std::vector<std::byte> png = *EncodePng(Picture(2048, 2048));
  std::fill(png.end() - 12, png.end(), std::byte{0});  // the last chunk
  WriteText("style/lit.png", std::string(reinterpret_cast<const char*>(png.data()), png.size()));
  const Arguments guidegen = {"guidegen", Scene("ball.glb"), "--size", "16", "--style", "style", "-o", "g.exr"},
                  stylize = {"stylize", Scene("ball.glb"), "--size", "16", "--style", "style", "-o", "p.png"};
  WriteGuideFile("ball.exr", Ball(300));
  for (const Arguments& arguments : {guidegen, stylize, {"transfer", "ball.exr", "--style", "style", "-o", "p.png"}}) {
    ExpectError(With(arguments, {"--max-memory", "31M"}), 2,
                {"this takes up to 32 MiB of memory (styles 32 MiB), and --max-memory allows 31 MiB: take smaller "
                 "exemplars, or allow more"});
    ExpectError(With(arguments, {"--max-memory", "1G"}), 3, {"lit.png", "ends before its picture does"});
  }
  EXPECT_FALSE(Exists("p.png"));
  WriteStyle("scene");
  WritePainted("scene/lit.png", 300, 300);
  WriteText("scene/style.toml", "[[exemplar]]\nimage = \"lit.png\"\nguides = \"../ball.exr\"\n");
  ExpectError({"transfer", "ball.exr", "--style", "scene", "-o", "p.png", "--max-memory", "1M"}, 2,
              {"(styles 2.1 MiB)", "take smaller exemplars"});
  ExpectError(
      {"transfer", "ball.exr", "--style", "scene", "--assign", "Nobody=style", "-o", "p.png", "--max-memory", "3M"}, 2,
      {"(styles 34 MiB)"});
}

TEST_F(MemoryNeedTest, GuidesOfAFileAreLookedAtBeforeTheyAreRead) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(300));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style", "-o", "p.png"};
  ExpectError(With(transfer, {"--max-memory", "1M"}), 2, {"take smaller guides", "--max-memory allows 1.0 MiB"});
  ExpectError(With(transfer, {"--max-memory", "100M", "--upsample", "8"}), 2, {"upsampled guides", "--upsample"});
  EXPECT_FALSE(Exists("p.png"));
  RunOk(With(transfer, {"--max-memory", "1G"}));
}

// Pictures of materials are counted by their headers, eight bytes a pixel, where a layer needs them, and refused before
// they are decoded.
TEST_F(MemoryNeedTest, TexturesAreCountedBeforeTheyAreDecoded) {
  WriteText("t.obj", "mtllib t.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n");
  WriteText("t.mtl", "newmtl m\nmap_Kd t.png\n");
  const std::uint64_t pixels = 2000 * 1500;
  ASSERT_TRUE(WritePicture(At("t.png"), Picture(2000, 1500)));
  ASSERT_TRUE(WritePicture(At("t.jpg"), Picture(2000, 1500)));
  const auto scene_bytes = [&](const std::string& layers) -> std::uint64_t {
    return RunOk({"guidegen", "t.obj", "--layers", layers, "--explain", "--json"}).Json()["memory"]["parts"]["scene"];
  };
  const std::uint64_t bare = scene_bytes("normal");
  EXPECT_LT(bare, 8 * pixels);
  EXPECT_EQ(scene_bytes("albedo") - bare, 8 * pixels);
  const Arguments guidegen = {"guidegen", "t.obj", "--size", "64", "-o", "g.exr", "--threads", "2"};
  ExpectError(With(guidegen, {"--layers", "albedo", "--max-memory", "50M"}), 2,
              {"scene 23 MiB", "--max-memory allows"});
  EXPECT_FALSE(Exists("g.exr"));
  RunOk(With(guidegen, {"--max-memory", "50M"}));
  WriteText("t.mtl", "newmtl m\nmap_Kd t.jpg\n");
  EXPECT_EQ(scene_bytes("albedo") - bare, 8 * pixels) << "by OpenImageIO";
}

TEST_F(MemoryNeedTest, AmountsThatAreNone) {
  WriteStyle("style");
  for (const char* wrong : {"0", "-1G", "4X", "", "nan"}) {
    ExpectError({"guidegen", Scene("suzanne.glb"), "--size", "16", "-o", "g.exr", "--max-memory=" + std::string(wrong)},
                2, {"--max-memory"});
  }
}

}  // namespace
}  // namespace scumble
