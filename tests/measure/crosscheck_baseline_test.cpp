// Baselines of the cross-check: written, read, tightening and never loosening.
#include "measure/crosscheck_baseline.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/measure/crosscheck_fixtures.h"

namespace scumble {
namespace {

constexpr const char* kScene = R"("a.glb": {"size": "20x16", "samples": 64, "max_bounces": 8, "limits": )";

std::string Text(const std::string& limits) {
  return std::string(R"({"scumble_baseline": 1, "blender": "3.4.1", "scenes": {)") + kScene + limits + "}}}";
}

Baseline Parsed(const std::string& text) {
  auto baseline = ParseBaseline(text, "b.json");
  EXPECT_TRUE(baseline.ok()) << baseline.error().message;
  return baseline.ok() ? *baseline : Baseline();
}

// LDE 0.4 % too bright: within the built-in limit.
CrosscheckReport SlightlyOff() {
  CrosscheckLight light = EqualLight(64);
  FillLayer(light.ours, Layer::kLpeLDE, {1.004f, 0.502f, 0.502f});
  CrosscheckReport report = CheckLight({light});
  report.setup.max_bounces = 8;
  return report;
}

TEST(CrosscheckBaseline, TightensAndNeverLoosens) {
  CrosscheckReport report = SlightlyOff();
  ASSERT_TRUE(report.passed());
  EXPECT_TRUE(ApplyBaseline(Parsed(Text(R"({"lpe.LDE mean difference": 0.3})")), "a.glb", report).empty());
  EXPECT_EQ(FigureOf(report, "lpe.LDE").LimitInForce(), 0.3);
  EXPECT_TRUE(FigureOf(report, "lpe.LDE").TightenedByBaseline());
  EXPECT_FALSE(report.passed());
  EXPECT_TRUE(report.KeepsBuiltInLimits());
  EXPECT_NE(CrosscheckToText(report).find("(baseline; built in 0.5)"), std::string::npos);

  CrosscheckLight light = EqualLight(64);
  FillLayer(light.ours, Layer::kLpeLDE, {1.01f, 0.505f, 0.505f});
  CrosscheckReport broken = CheckLight({light});
  const auto notes = ApplyBaseline(Parsed(Text(R"({"lpe.LDE mean difference": 5})")), "a.glb", broken);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("above the built-in one"), std::string::npos) << notes[0];
  EXPECT_EQ(FigureOf(broken, "lpe.LDE").LimitInForce(), 0.5);
  EXPECT_FALSE(FigureOf(broken, "lpe.LDE").TightenedByBaseline());
  EXPECT_FALSE(broken.passed());
}

TEST(CrosscheckBaseline, AFigureThatWasNotMeasuredFailsTheVerdict) {
  CrosscheckReport report = SlightlyOff();
  ApplyBaseline(Parsed(Text(R"({"lpe.LSSE mean difference": 1})")), "a.glb", report);
  EXPECT_FALSE(report.passed());
  ASSERT_EQ(report.problems.size(), 1u);
  EXPECT_NE(report.problems[0].find("lpe.LSSE mean difference"), std::string::npos);
  EXPECT_NE(report.problems[0].find("--write-baseline"), std::string::npos);
}

TEST(CrosscheckBaseline, WrittenLimitsHaveRoomAndBounds) {
  CrosscheckReport report = SlightlyOff();
  report.figures.push_back({"x", "small", "", 0.000531, 0.01, 0, 1e-4});
  report.figures.push_back({"x", "noisy", "%", 0.2, 2.0, 0.3, 0.01});
  report.figures.push_back({"x", "zero", "", 0.0, 0.01, 0, 1e-4});
  report.figures.push_back({"x", "count", "pixels", 0.0, 0.0});
  Baseline baseline;
  RecordInBaseline(report, "a.glb", baseline);
  const auto& limits = baseline.scenes.at("a.glb").limits;
  EXPECT_EQ(limits.at("x small"), 0.00067) << "0.000531 × 1.25 = 0.00066375";
  EXPECT_EQ(limits.at("x noisy"), 0.85) << "0.2 × 1.25 + 2 × 0.3";
  EXPECT_EQ(limits.at("x zero"), 1e-4);
  EXPECT_EQ(limits.at("x count"), 0.0);
  EXPECT_EQ(limits.at("lpe.LDE mean difference"), 0.5) << "0.4 × 1.25 and rounding never go above the built-in limit";
  EXPECT_EQ(limits.at("A differing"), 0.02) << "one of 320 pixels is more than is built in";
  EXPECT_EQ(baseline.scenes.at("a.glb").setup, report.setup);
}

TEST(CrosscheckBaseline, RoundTripKeepsEveryScene) {
  CrosscheckReport report = SlightlyOff();
  report.setup.camera = "Two \"words\"";
  report.setup.frame = -3;
  Baseline baseline;
  baseline.blender = "3.4.1";
  RecordInBaseline(report, "a.glb", baseline);
  report.setup.camera.clear(), report.setup.frame.reset();
  RecordInBaseline(report, "b.blend", baseline);
  const std::string text = BaselineToJson(baseline);
  const Baseline again = Parsed(text);
  EXPECT_EQ(BaselineToJson(again), text);
  EXPECT_EQ(again.scenes.at("a.glb").setup, baseline.scenes.at("a.glb").setup);
  EXPECT_EQ(again.scenes.at("b.blend").limits, baseline.scenes.at("b.blend").limits);
  EXPECT_EQ(again.blender, "3.4.1");
  // The run that wrote it keeps it.
  CrosscheckReport same = SlightlyOff();
  ApplyBaseline(again, "b.blend", same);
  EXPECT_TRUE(same.passed()) << CrosscheckToText(same);
}

TEST(CrosscheckBaseline, AnotherSetUpIsNamed) {
  const Baseline baseline = Parsed(Text(R"({"normal 99% within": 0.001})"));
  const CrosscheckSetup setup{20, 16, 64, 8, "", {}};
  EXPECT_EQ(BaselineMismatch(baseline, "a.glb", setup), "");
  EXPECT_NE(BaselineMismatch(baseline, "b.glb", setup).find("no scene b.glb: add it with --write-baseline"),
            std::string::npos);
  const auto mismatch = [&](CrosscheckSetup other) { return BaselineMismatch(baseline, "a.glb", other); };
  EXPECT_NE(mismatch({21, 16, 64, 8, "", {}}).find("--size 20x16 and not 21x16"), std::string::npos);
  EXPECT_NE(mismatch({20, 16, 16, 8, "", {}}).find("--samples 64 and not 16"), std::string::npos);
  EXPECT_NE(mismatch({20, 16, 64, 4, "", {}}).find("--max-bounces 8 and not 4"), std::string::npos);
  EXPECT_NE(mismatch({20, 16, 64, 8, "Cam", {}}).find("--camera left out and not Cam"), std::string::npos);
  EXPECT_NE(mismatch({20, 16, 64, 8, "", 5}).find("--frame left out and not 5"), std::string::npos);
}

TEST(CrosscheckBaseline, HostileFilesAreRefusedByPlace) {
  const auto scene = [](const std::string& inside) {
    return R"({"scumble_baseline": 1, "scenes": {"a.glb": )" + inside + "}}";
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "no baseline"},
      {"{\n  \"a\": }", "no JSON at line 2, column 8"},
      {"{\"a\"" + std::string(100000, '\n'), "no JSON at line 100001, column 1"},
      {"{\"a\": 1" + std::string(1000, '0') + "}", "number overflow parsing '1000"},
      {"{", "line 1"},
      {"\n\n{\"scumble_baseline\": 1,]", "line 3"},
      {"[]", "scumble_baseline"},
      {"{}", "scumble_baseline"},
      {R"({"scumble_baseline": 2})", "scumble_baseline"},
      {R"({"scumble_baseline": "1"})", "scumble_baseline"},
      {R"({"scumble_baseline": 1, "blender": 3})", "blender"},
      {R"({"scumble_baseline": 1, "limits": {}})", "limits"},
      {R"({"scumble_baseline": 1, "scenes": []})", "scenes"},
      {scene("3"), "scenes/a.glb"},
      {scene("{}"), "scenes/a.glb"},
      {scene(R"({"size": "20", "samples": 1, "max_bounces": 1, "limits": {"x": 1}})"), "scenes/a.glb/size"},
      {scene(R"({"size": "20x", "samples": 1, "max_bounces": 1, "limits": {"x": 1}})"), "scenes/a.glb/size"},
      {scene(R"({"size": "-2x16", "samples": 1, "max_bounces": 1, "limits": {"x": 1}})"), "scenes/a.glb/size"},
      {scene(R"({"size": "99999999999x16", "samples": 1, "max_bounces": 1, "limits": {"x": 1}})"), "scenes/a.glb/size"},
      {scene(R"({"size": 20, "samples": 1, "max_bounces": 1, "limits": {"x": 1}})"), "scenes/a.glb/size"},
      {scene(R"({"size": "20x16", "samples": 1.5, "max_bounces": 1, "limits": {"x": 1}})"), "scenes/a.glb/samples"},
      {scene(R"({"size": "20x16", "samples": 18446744073709551615, "max_bounces": 1, "limits": {"x": 1}})"),
       "scenes/a.glb/samples"},
      {scene(R"({"size": "20x16", "samples": 1, "max_bounces": -1, "limits": {"x": 1}})"), "scenes/a.glb/max_bounces"},
      {scene(R"({"size": "20x16", "samples": 1, "max_bounces": 1, "frame": 1e300, "limits": {"x": 1}})"),
       "scenes/a.glb/frame"},
      {scene(R"({"size": "20x16", "samples": 1, "max_bounces": 1, "camera": 1, "limits": {"x": 1}})"),
       "scenes/a.glb/camera"},
      {scene(R"({"size": "20x16", "samples": 1, "max_bounces": 1, "sample": 1, "limits": {"x": 1}})"),
       "scenes/a.glb/sample"},
      {scene(R"({"size": "20x16", "samples": 1, "max_bounces": 1, "limits": {}})"), "scenes/a.glb/limits"},
      {Text(R"({"normal 99% within": -1})"), "limits/normal 99% within"},
      {Text(R"({"normal 99% within": "0.1"})"), "limits/normal 99% within"},
      {Text(R"({"normal 99% within": null})"), "limits/normal 99% within"},
      {Text(R"({"normal 99% within": 1e999})"), "1e999"},
      {Text(std::string(200000, '[')), "no baseline"},
      {Text("{\"x\": " + std::string(200000, '[') + std::string(200000, ']') + "}"), "limits/x"},
  };
  for (const auto& [text, place] : cases) {
    const auto refused = ParseBaseline(text, "b.json");
    ASSERT_FALSE(refused.ok()) << text.substr(0, 200);
    EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
    EXPECT_EQ(refused.error().message.rfind("b.json", 0), 0u) << refused.error().message;
    EXPECT_LT(refused.error().message.size(), 400u) << "whatever it quotes";
    EXPECT_NE(refused.error().message.find(place), std::string::npos) << refused.error().message.substr(0, 300);
    EXPECT_NE(refused.error().message.find("--write-baseline"), std::string::npos);
  }
}

}  // namespace
}  // namespace scumble
