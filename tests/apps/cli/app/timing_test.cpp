// --timing and --fast-io: figures that add up, and pixels that do not change.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliTiming : public CliTest {
 protected:
  static constexpr int kRle = 1, kZip = 3;  // as EXR files number them

  // The value behind the header's "compression", its type and its length.
  int CompressionOf(const std::string& name) const {
    const std::string key("compression\0compression\0\1\0\0\0", 28), bytes = Bytes(name);
    const std::size_t at = bytes.find(key);
    return at == std::string::npos ? -1 : bytes[at + key.size()];
  }
};

TEST_F(CliTiming, TheStagesAddUpToTheWhole) {
  WriteStyle("style");
  const Arguments stylize = {"stylize", Scene("ball.glb"), "--style", "style", "--size", "64", "-o", "p.png"};
  const auto text = Run(With(stylize, {"--timing"}));
  ASSERT_EQ(text.code, 0) << text.err;
  for (const char* stage :
       {"start ", "style ", "scene ", "build ", "rays ", "prepare ", "match ", "vote ", "write ", "total "}) {
    EXPECT_NE(text.out.find(std::string("\n") + stage), std::string::npos) << stage << text.out;
  }
  const auto plain = Run(stylize);
  EXPECT_EQ(plain.out.find("total  "), std::string::npos) << "only where it is asked for";
  const auto asked = Run(With(stylize, {"--timing", "--json"}));
  ASSERT_EQ(asked.code, 0) << asked.err;
  const auto json = nlohmann::json::parse(asked.out);
  double wall = 0, cpu = 0;
  for (const auto& stage : json["timing"]) {
    if (stage["stage"] == "total") continue;
    wall += stage["wall_ms"].get<double>();
    cpu += stage.value("cpu_ms", 0.0);
  }
  const auto& total = json["timing"].back();
  EXPECT_EQ(total["stage"], "total");
  EXPECT_NEAR(wall, total["wall_ms"].get<double>(), 1.0 + 0.2 * wall) << "nothing is counted twice or left out";
  EXPECT_NEAR(cpu, total["cpu_ms"].get<double>(), 1.0 + 0.2 * cpu);
}

TEST_F(CliTiming, OfASequenceItIsTheSum) {
  WriteStyle("style");
  const auto run = Run({"stylize", Scene("toys.glb"), "--style", "style", "--size", "48", "--frames", "1-3", "--json",
                        "--timing", "-o", "p.####.png"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  double rays = 0, counted = 0;
  for (const auto& frame : json["frames"]) rays += frame["ms"]["rays"]["median"].get<double>();
  for (const auto& stage : json["timing"]) {
    if (stage["stage"] == "rays") counted = stage["wall_ms"].get<double>();
  }
  EXPECT_NEAR(counted, rays, 1e-6 + 1e-6 * rays);
}

TEST_F(CliTiming, OneThreadWritesAtOnceAndIsCountedOnce) {
  WriteStyle("style");
  const auto run = Run({"stylize", Scene("ball.glb"), "--style", "style", "--size", "512", "--frames", "1-3", "--json",
                        "--bits", "16", "--png-level", "9", "--threads", "1", "--timing", "-o", "p.####.png"});
  ASSERT_EQ(run.code, 0) << run.err;
  double wall = 0, write_cpu = 0, total = 0;
  const auto json = run.Json();
  for (const auto& stage : json["timing"]) {
    const std::string name = stage["stage"];
    EXPECT_NE(name, "waiting") << "for what, with one thread";
    if (name == "write") write_cpu = stage.value("cpu_ms", 0.0);
    (name == "total" ? total : wall) += stage["wall_ms"].get<double>();
  }
  EXPECT_GT(write_cpu, 0.0);
  EXPECT_NEAR(wall, total, 2.0 + 0.02 * total);
}

TEST_F(CliTiming, FastGuidesHoldTheSamePixels) {
  const Arguments guidegen = {"guidegen", Scene("ball.glb"), "--size", "64x48"};
  ASSERT_EQ(Run(With(guidegen, {"-o", "zip.exr"})).code, 0);
  ASSERT_EQ(Run(With(guidegen, {"--fast-io", "-o", "fast.exr"})).code, 0);
  const auto same = Run({"compare", "zip.exr", "fast.exr"});
  EXPECT_EQ(same.code, 0) << same.out;
  EXPECT_NE(Bytes("zip.exr"), Bytes("fast.exr")) << "another compression";
  const auto both = Run(With(guidegen, {"--fast-io", "--compression", "zip", "-o", "g.exr"}));
  EXPECT_EQ(both.code, 2) << both.err;
}

TEST_F(CliTiming, EveryVerbThatWritesExrCanBeFast) {
  const auto same = [&](const std::string& plain, const std::string& fast) {
    const auto compared = Run({"compare", plain, fast});
    EXPECT_EQ(compared.code, 0) << compared.out << compared.err;
    EXPECT_NE(Bytes(plain), Bytes(fast)) << "another compression";
    EXPECT_EQ(CompressionOf(plain), kZip) << plain;
    EXPECT_EQ(CompressionOf(fast), kRle) << fast;
  };
  WriteStyle("style");
  for (const char* bits : {"16", "32"}) {
    const Arguments stylize = {"stylize", Scene("ball.glb"), "--style", "style", "--size", "64x48", "--bits", bits};
    RunOk(With(stylize, {"-o", "zip.exr"}));
    RunOk(With(stylize, {"--fast-io", "-o", "fast.EXR"}));
    same("zip.exr", "fast.EXR");
  }
  RunOk({"guidegen", Scene("ball.glb"), "--size", "64x48", "-o", "g.exr"});
  const Arguments transfer = {"transfer", "g.exr", "--style", "style"};
  RunOk(With(transfer, {"-o", "zip.exr"}));
  const auto quiet = RunOk(With(transfer, {"--fast-io", "-o", "fast.exr"}));
  EXPECT_EQ(quiet.Warning(), "");
  same("zip.exr", "fast.exr");
  const auto png = RunOk(With(transfer, {"--fast-io", "-o", "fast.png"}));
  EXPECT_NE(png.Warning().find("--fast-io changes nothing: fast.png is no .exr"), std::string::npos) << png.err;
  // An existing frame is kept, for either packing.
  RunOk(With(transfer, {"--frames", "1", "-o", "p.#.exr"}));
  const auto kept = RunOk(With(transfer, {"--frames", "1", "--fast-io", "--resume", "-o", "p.#.exr"}));
  EXPECT_NE(kept.out.find("0 made, 1 kept"), std::string::npos) << kept.out;

  RunOk({"sphere", "--size", "64", "-o", "kit"});
  RunOk({"sphere", "--size", "64", "--fast-io", "-o", "fast-kit"});
  same("kit/guides.exr", "fast-kit/guides.exr");
  const auto needs = Run({"crosscheck", Scene("ball.glb"), "--fast-io"});
  EXPECT_EQ(needs.code, 2) << needs.err;
  EXPECT_NE(needs.Error().find("--keep"), std::string::npos) << needs.err;
}

}  // namespace
}  // namespace scumble
