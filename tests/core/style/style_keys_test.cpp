// The keys of a style: every one applied within its range, and refused by name beyond it.
#include "core/style/style_keys.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "tests/core/style/style_fixtures.h"
#include "tests/support/refusal.h"

namespace scumble {
namespace {

void ExpectEqual(const TransferSettings& a, const TransferSettings& b) {
  EXPECT_EQ(a.method, b.method);
  EXPECT_EQ(a.nearest, b.nearest);
  EXPECT_EQ(a.nearest_error, b.nearest_error);
  EXPECT_EQ(a.threshold, b.threshold);
  EXPECT_EQ(a.threshold_metric, b.threshold_metric);
  EXPECT_EQ(a.levels, b.levels);
  EXPECT_EQ(a.jitter, b.jitter);
  EXPECT_EQ(a.jitter_fps, b.jitter_fps);
  EXPECT_EQ(a.blend_radius, b.blend_radius);
  EXPECT_EQ(a.edge_aware, b.edge_aware);
  EXPECT_EQ(a.crease, b.crease);
  EXPECT_EQ(a.shadow, b.shadow);
  EXPECT_EQ(a.edge, b.edge);
  EXPECT_EQ(a.depth_tolerance, b.depth_tolerance);
  EXPECT_EQ(a.scale, b.scale);
  EXPECT_EQ(a.rim, b.rim);
  EXPECT_EQ(a.reference_height, b.reference_height);
  EXPECT_TRUE(a.guide_weights == b.guide_weights);
}

TEST_F(StyleFile, AnEmptyTransferTableIsTheDefaults) {
  const auto style = LoadLine("");
  ASSERT_TRUE(style) << style.error().message;
  ExpectEqual(style->transfer, TransferSettings());
  EXPECT_FALSE(style->paper.color);
  EXPECT_FALSE(style->paper.picture);
  EXPECT_EQ(style->licence, "");
}

TEST_F(StyleFile, EveryDocumentedDefaultIsTheRealOne) {
  for (const StyleKey& key : StyleKeys()) {
    const std::string name = key.name.substr(key.name.find('.') + 1), line = name + " = " + key.default_value + "\n";
    const auto style = key.name == name ? Load(line + kExemplar) : LoadLine(line);
    ASSERT_TRUE(style) << key.name << ": " << style.error().message;
    ExpectEqual(style->transfer, TransferSettings());
    EXPECT_FALSE(style->paper.color || style->paper.picture);
    EXPECT_FALSE(key.help.empty());
    EXPECT_EQ(FindStyleKey(key.name), &key) << "names are unique";
  }
  EXPECT_EQ(FindStyleKey("threshold"), nullptr);
}

TEST_F(StyleFile, FormsOfKeysAreWhatTheirSettersTake) {
  for (const StyleKey& key : StyleKeys()) {
    Style style;
    const auto takes = [&](const KeyValue& value) { return key.set(style, value, folder_.path()).ok(); };
    EXPECT_FALSE(key.group.empty()) << key.name;
    EXPECT_TRUE(takes(key.Default())) << key.name;
    const bool is_whole = key.kind == KeyKind::kWhole;
    const auto number = [&](double value) { return is_whole ? KeyValue(std::int64_t(value)) : KeyValue(value); };
    if (is_whole || key.kind == KeyKind::kNumber) {
      EXPECT_TRUE(takes(number(key.least)) && takes(number(key.most)) && takes(number(key.least + key.step)))
          << key.name;
      EXPECT_FALSE(takes(number(is_whole ? key.least - 1.0 : key.least - 1e-4))) << key.name;
      EXPECT_EQ(takes(number(key.most + 1.0)), key.unlimited) << key.name;
      EXPECT_GT(key.step, 0.0) << key.name;
    }
    for (const std::string& choice : key.choices) EXPECT_TRUE(takes(choice)) << key.name << " " << choice;
    EXPECT_EQ(key.kind == KeyKind::kChoice, key.choices.size() >= 2) << key.name;
    EXPECT_TRUE(key.kind != KeyKind::kChoice || !takes(std::string("bogus"))) << key.name;
    EXPECT_TRUE(key.kind != KeyKind::kFlag || (takes(true) && takes(false) && !takes(1.0))) << key.name;
  }
}

TEST_F(StyleFile, ValuesAreTheFilesOrTheDefaults) {
  std::ofstream(folder_ / "style.toml", std::ios::binary)
      << "name = 'Mine'\n[transfer]\nthreshold = [[-10, 0.25], [10, 0.75]]\ncrease = 30\nedge_aware = false\n"
      << "guide_weights.lpe.LDE = 2\n"
      << kExemplar;
  const auto values = StyleValues(folder_.path());
  ASSERT_TRUE(values) << values.error().message;
  EXPECT_EQ(values->size(), StyleKeys().size());
  EXPECT_EQ(values->at("name"), KeyValue(std::string("Mine")));
  EXPECT_EQ(values->at("transfer.threshold"), KeyValue(0.5)) << "at frame 0";
  EXPECT_EQ(values->at("transfer.crease"), KeyValue(30.0));
  EXPECT_EQ(values->at("transfer.edge_aware"), KeyValue(false));
  EXPECT_EQ(values->at("transfer.guide_weights.lpe.LDE"), KeyValue(2.0));
  EXPECT_EQ(values->at("transfer.levels"), KeyValue(std::int64_t(7)));
  EXPECT_EQ(StyleValues(folder_ / "lit.png")->at("transfer.crease"), KeyValue(30.0)) << "which style.toml names";
  ASSERT_TRUE(WritePicture(folder_ / "other.png", NoisyPicture(8, 8)));
  EXPECT_EQ(StyleValues(folder_ / "other.png")->at("transfer.crease"), KeyValue(60.0));
  EXPECT_FALSE(StyleValues(folder_ / "nothing"));
  EXPECT_EQ(StyleValues("toon")->at("transfer.method"), KeyValue(std::string("toon"))) << "which has no file";
}

struct Valid {
  const char* line;
  std::function<double(const TransferSettings&)> get;
  double value;
};

TEST_F(StyleFile, ValuesUpToTheirBoundariesAreTaken) {
  using T = TransferSettings;
  const auto threshold = [](const T& t) { return double(t.threshold); };
  const auto levels = [](const T& t) { return double(t.levels); };
  const auto jitter = [](const T& t) { return double(t.jitter); };
  const auto fps = [](const T& t) { return t.jitter_fps; };
  const auto blend = [](const T& t) { return double(t.blend_radius); };
  const auto scale = [](const T& t) { return t.scale; };
  const auto rim = [](const T& t) { return t.rim; };
  const auto height = [](const T& t) { return double(t.reference_height); };
  const auto method = [](const T& t) { return double(t.method); };
  const auto metric = [](const T& t) { return double(t.threshold_metric); };
  const auto edge = [](const T& t) { return double(t.edge); };
  const auto shadow = [](const T& t) { return double(t.shadow); };
  const auto crease = [](const T& t) { return t.crease; };
  const auto nearest_error = [](const T& t) { return t.nearest_error; };
  const auto tolerance = [](const T& t) { return t.depth_tolerance; };
  const auto edges = [](const T& t) { return double(t.edge_aware); };
  const Valid cases[] = {
      {"method = 'litsphere'", method, double(Method::kLitSphere)},
      {"method = \"styleblit\"", method, double(Method::kStyleBlit)},
      {"method = 'bruteforce'", method, double(Method::kBruteForce)},
      {"nearest_error = 0.25", nearest_error, 0.25},
      {"nearest_error = 10", nearest_error, 10},
      {"threshold = 0", threshold, 0},
      {"threshold = 0.25", threshold, 0.25},
      {"threshold = inf", threshold, std::numeric_limits<double>::infinity()},
      {"threshold = 1e300", threshold, std::numeric_limits<double>::infinity()},
      {"threshold_metric = 'l1'", metric, double(ThresholdMetric::kL1)},
      {"levels = 1", levels, 1},
      {"levels = 16", levels, 16},
      {"jitter = 0", jitter, 0},
      {"jitter = 0.5", jitter, 0.5},
      {"jitter = 1", jitter, 1},
      {"jitter_fps = -1", fps, -1},
      {"jitter_fps = 12.5", fps, 12.5},
      {"jitter_fps = 1000", fps, 1000},
      {"blend_radius = 0", blend, 0},
      {"blend_radius = 64", blend, 64},
      {"edge_aware = false", edges, 0},
      {"edge = 'exact'", edge, double(EdgeMode::kExact)},
      {"edge = 'exemplar'", edge, double(EdgeMode::kExemplar)},
      {"shadow = 'none'", shadow, double(ShadowMode::kNone)},
      {"shadow = 'paint'", shadow, double(ShadowMode::kPaint)},
      {"crease = 0", crease, 0},
      {"crease = 180", crease, 180},
      {"depth_tolerance = 0", tolerance, 0},
      {"depth_tolerance = 1", tolerance, 1},
      {"scale = 0.001", scale, 0.001},
      {"scale = 64", scale, 64},
      {"rim = 0", rim, 0},
      {"rim = 3.5", rim, 3.5},
      {"reference_height = 0", height, 0},
      {"reference_height = 32768", height, 32768},
  };
  for (const Valid& valid : cases) {
    const auto style = LoadLine(valid.line);
    ASSERT_TRUE(style) << valid.line << ": " << style.error().message;
    EXPECT_EQ(valid.get(style->transfer), valid.value) << valid.line;
  }
}

TEST_F(StyleFile, ValuesBeyondThemAreRefusedWithTheRange) {
  const std::vector<std::pair<const char*, const char*>> cases = {{"threshold = nan", "0 or more"},
                                                                  {"threshold = -0.001", "0 or more"},
                                                                  {"threshold = -inf", "0 or more"},
                                                                  {"threshold = 'big'", "a number"},
                                                                  {"threshold = true", "a number"},
                                                                  {"threshold_metric = 'l3'", "\"l1\""},
                                                                  {"threshold_metric = 2", "\"l2\""},
                                                                  {"levels = 0", "1 to 16"},
                                                                  {"levels = 17", "1 to 16"},
                                                                  {"levels = 7.0", "whole number"},
                                                                  {"levels = '7'", "whole number"},
                                                                  {"levels = 9223372036854775807", "1 to 16"},
                                                                  {"jitter = 1.0001", "0 to 1"},
                                                                  {"jitter = -0.1", "0 to 1"},
                                                                  {"jitter = nan", "0 to 1"},
                                                                  {"jitter_fps = -2", "-1 (every frame)"},
                                                                  {"jitter_fps = -0.5", "frozen"},
                                                                  {"jitter_fps = 1001", "1000"},
                                                                  {"jitter_fps = nan", "frozen"},
                                                                  {"blend_radius = -1", "0 to 64"},
                                                                  {"blend_radius = 65", "0 to 64"},
                                                                  {"edge_aware = 1", "true or false"},
                                                                  {"edge = 'ragged'", "\"exemplar\""},
                                                                  {"shadow = true", "\"paint\""},
                                                                  {"crease = -1", "0 to 180"},
                                                                  {"crease = 181", "0 to 180"},
                                                                  {"depth_tolerance = -0.001", "0 to 1"},
                                                                  {"depth_tolerance = 1.5", "0 to 1"},
                                                                  {"depth_tolerance = nan", "0 to 1"},
                                                                  {"scale = 0", "0.001 to 64"},
                                                                  {"scale = -1", "0.001 to 64"},
                                                                  {"scale = 65", "0.001 to 64"},
                                                                  {"scale = nan", "0.001 to 64"},
                                                                  {"rim = -1", "0 to 16384"},
                                                                  {"rim = inf", "0 to 16384"},
                                                                  {"reference_height = -1", "32768"},
                                                                  {"reference_height = 32769", "32768"},
                                                                  {"method = 'magic'", "\"litsphere\""},
                                                                  {"method = 3", "\"bruteforce\""},
                                                                  {"levels = 7.0", "without a decimal point, 1 to 16"},
                                                                  {"levels = [7]", "plain value"},
                                                                  {"levels = {a = 1}", "plain value"},
                                                                  {"levels = 2024-01-01", "plain value"}};
  for (const auto& [line, words] : cases) {
    const std::string text = line, key = "transfer." + text.substr(0, text.find(' '));
    SCOPED_TRACE(line);
    ExpectRefusal(LoadLine(line), ErrorKind::kInput, {"style.toml:2: ", key, words});
  }
  ExpectRefusal(LoadLine("guide_weights.normal = 0"), ErrorKind::kInput,
                {"style.toml:2: transfer.guide_weights are all 0", "a weight above 0"});
  ExpectRefusal(Load(std::string("name = 5\n") + kExemplar), ErrorKind::kInput,
                {"style.toml:1", "name = 5", "text in quotes"});
}

TEST_F(StyleFile, WaysToFindSources) {
  const std::pair<const char*, NearestSearch> cases[] = {{"auto", NearestSearch::kAuto},
                                                         {"analytic", NearestSearch::kAnalytic},
                                                         {"table", NearestSearch::kTable},
                                                         {"tree", NearestSearch::kTree}};
  for (const auto& [name, search] : cases) {
    const auto style = LoadLine("nearest = '" + std::string(name) + "'");
    ASSERT_TRUE(style) << style.error().message;
    EXPECT_EQ(style->transfer.nearest, search);
  }
  ExpectRefusal(LoadLine("nearest = 'magic'"), ErrorKind::kInput, {"style.toml:2", "transfer.nearest", "analytic"});
  ExpectRefusal(LoadLine("nearest = 1"), ErrorKind::kInput, {"transfer.nearest", "tree"});
}

TEST_F(StyleFile, WhatIsStillToComeIsRefusedByName) {
  ExpectRefusal(LoadLine("method = 'stylit'"), ErrorKind::kUnavailable, {"style.toml:2", "transfer.method", "stylit"});
}

TEST_F(StyleFile, PaperIsAColourAPictureOrNothing) {
  const auto color = LoadLine("paper = '#F4efe6'");
  ASSERT_TRUE(color) << color.error().message;
  EXPECT_EQ(color->paper.color, (std::array<std::uint16_t, 3>{0xf4 * 257, 0xef * 257, 0xe6 * 257}));
  EXPECT_FALSE(color->paper.picture);
  ASSERT_TRUE(WritePicture(folder_ / "paper.png", NoisyPicture(5, 3)));
  const auto picture = LoadLine("paper = 'paper.png'");
  ASSERT_TRUE(picture) << picture.error().message;
  ASSERT_TRUE(picture->paper.picture);
  EXPECT_EQ(picture->paper.picture->rgba, NoisyPicture(5, 3).rgba);
  EXPECT_FALSE(picture->paper.color);
  const auto none = Load("[transfer]\npaper = '#ffffff'\n" + std::string(kExemplar), {"transfer.paper="});
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_FALSE(none->paper.color || none->paper.picture);
  ExpectRefusal(LoadLine("paper = 'no.png'"), ErrorKind::kInput,
                {"style.toml:2", "transfer.paper", "no.png", "no such file", "a colour is #"});
  ExpectRefusal(LoadLine("paper = 3"), ErrorKind::kInput,
                {"transfer.paper", "a colour is # and six hexadecimal digits"});
}

TEST_F(StyleFile, OnlySixHexadecimalDigitsAreAColour) {
  for (const char* bad : {"#fff", "#f4efe", "#f4efe6a", "#gggggg", "#", "#+f4efe", "#-f4efe", "#0xf4ef", "# f4efe",
                          "#f4ef 6", "#f4efé"}) {
    SCOPED_TRACE(bad);
    ExpectRefusal(LoadLine("paper = '" + std::string(bad) + "'"), ErrorKind::kInput,
                  {"transfer.paper", bad, "a colour is # and six hexadecimal digits", "#f4efe6"});
  }
}

TEST(StyleOverrides, AreParsedIntoValues) {
  const auto value = [](const std::string& text) { return std::get<KeyValue>(ParseOverride(text)->value); };
  EXPECT_EQ(value("transfer.scale=.5"), KeyValue(0.5));
  EXPECT_EQ(value("transfer.levels=5"), KeyValue(std::int64_t(5)));
  EXPECT_EQ(value("transfer.method=litsphere"), KeyValue(std::string("litsphere")));
  EXPECT_EQ(value("transfer.method=\"litsphere\""), KeyValue(std::string("litsphere")));
  EXPECT_EQ(value("transfer.paper="), KeyValue(std::string()));
  EXPECT_EQ(value("finish.ink.objects=a,b"), KeyValue(std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(value("finish.ink.objects=['a,b']"), KeyValue(std::vector<std::string>{"a,b"}));
  EXPECT_EQ(value("finish.ink.objects=[1]"), KeyValue(std::string("[1]")));
  const auto frames = [](const std::string& text) {
    return std::get<StyleOverride::Frames>(ParseOverride("transfer.scale=" + text)->value);
  };
  EXPECT_EQ(frames("[[1, 2], [3, 0.5]]"), (StyleOverride::Frames{{1, std::int64_t(2)}, {3, 0.5}}));
  EXPECT_TRUE(frames("[[1, 2, 3]]").empty()) << "no frames";
  const auto one = ParseStyleOverride("a:b=c:transfer.scale=2");
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(one->style, "a:b=c");
  EXPECT_EQ(one->key, "transfer.scale");
  EXPECT_EQ(one->text, "transfer.scale=2");
  EXPECT_EQ(ToText(*one), "a:b=c:transfer.scale=2");
  for (const char* text : {"transfer.scale", "=2", ":transfer.scale=2", "finish.ink.width"})
    ExpectRefusal(ParseStyleOverride(text), ErrorKind::kUsage, {"--set"});
  for (const StyleKey& key : StyleKeys()) {
    const StyleOverride made = MakeExactOverride(key.name, key.Default());
    const auto again = std::get<KeyValue>(ParseOverride(made.text)->value);
    EXPECT_TRUE(again == key.Default() || AsNumber(again) == AsNumber(key.Default())) << made.text;
  }
}

}  // namespace
}  // namespace scumble
