// Styles from files: every key applied, or refused by name.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/image/hash.h"
#include "core/io/file/atomic_file.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "core/style/style_keys.h"
#include "tests/support/picture_files.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExemplar = "[[exemplar]]\nimage = \"lit.png\"\n";

Picture NoisyPicture(int width, int height) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(width, i) % 256 * 257);
  }
  return picture;
}

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

// A folder with a painted sphere of 8×8 pixels in it; its style.toml is written by each test.
class StyleFile : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(WritePicture(folder_ / "lit.png", NoisyPicture(8, 8))); }

  Expected<Style> Load(const std::string& toml, const std::vector<std::string>& overrides = {}) {
    std::ofstream(folder_ / "style.toml", std::ios::binary) << toml;
    return LoadStyle(folder_.path(), overrides);
  }
  // A style with this one line under [transfer].
  Expected<Style> LoadLine(const std::string& line) { return Load("[transfer]\n" + line + "\n" + kExemplar); }

  TemporaryFolder folder_;
};

// ---- keys ------------------------------------------------------------------------------------------------------

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

TEST_F(StyleFile, GuideWeightsAreATableOfLayers) {
  GuideSet guides(8, 8);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kLuminance, Layer::kLpeLDE}) guides.Add(layer);
  for (float& value : guides.Plane(Layer::kCoverage)) value = 1.0f;
  for (float& value : guides.Plane(Layer::kNormal, 2)) value = 1.0f;
  ASSERT_TRUE(WriteGuides(folder_ / "guides.exr", guides));
  const std::string exemplar = kExemplar + std::string("guides = \"guides.exr\"\n");
  const LayerSet lit{Layer::kNormal, Layer::kLuminance, Layer::kLpeLDE};
  for (const char* table : {"[transfer.guide_weights]\nluminance = 2\n\"lpe.LDE\" = 0.5\n",
                            "[transfer.guide_weights]\nluminance = 2\nlpe.LDE = 0.5\n",
                            "[transfer]\nguide_weights = {luminance = 2, \"lpe.LDE\" = 0.5}\n"}) {
    const auto style = Load(table + exemplar);
    ASSERT_TRUE(style) << table << style.error().message;
    EXPECT_EQ(style->transfer.guide_weights[Layer::kNormal], 1.0f);
    EXPECT_EQ(style->transfer.guide_weights[Layer::kLuminance], 2.0f);
    EXPECT_EQ(style->transfer.guide_weights[Layer::kLpeLDE], 0.5f);
    EXPECT_TRUE(style->transfer.guide_weights.Layers() == lit);
    EXPECT_TRUE(RequiredLayers(*style).Contains(lit));
    ASSERT_TRUE(style->exemplars[0].guides);
    EXPECT_TRUE(style->exemplars[0].guides->layers().Contains(lit));
  }
  const auto neutral = Load("[transfer.guide_weights]\nluminance = 0\nnormal = 1.0\n" + exemplar);
  ASSERT_TRUE(neutral);
  EXPECT_TRUE(neutral->transfer.guide_weights.ArePlain());
  EXPECT_FALSE(RequiredLayers(*neutral).Has(Layer::kLuminance));
  const auto set = Load(exemplar, {"transfer.guide_weights.lpe.LDE=3", "transfer.guide_weights.normal=0"});
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->transfer.guide_weights[Layer::kLpeLDE], 3.0f);
  EXPECT_EQ(set->transfer.guide_weights[Layer::kNormal], 0.0f);
  const auto refuse = [&](const std::string& toml, const std::vector<std::string>& words) {
    SCOPED_TRACE(toml);
    ExpectRefusal(Load(toml), ErrorKind::kInput, words);
  };
  refuse("[transfer.guide_weights]\nluminance = 1\n" + std::string(kExemplar), {"lit.png has no guides", "luminance"});
  refuse("[transfer.guide_weights]\nshadow = 1\n" + exemplar, {"guides.exr holds", "asks for shadow", "--layers"});
  for (const std::string layer : {"depth", "cosine", "uv"}) {
    refuse("[transfer.guide_weights]\n" + layer + " = 1\n" + exemplar,
           {"style.toml:2", "unknown key", "there are normal, albedo"});
  }
  refuse("[transfer.guide_weights]\nluminance = -1\n" + exemplar, {"style.toml:2", "0 to 1000"});
  refuse("[transfer.guide_weights]\nluminance = [[1, 0], [9, 1]]\n" + exemplar, {"cannot change over time"});
}

TEST_F(StyleFile, WhatIsStillToComeIsRefusedByName) {
  ExpectRefusal(LoadLine("method = 'stylit'"), ErrorKind::kUnavailable, {"style.toml:2", "transfer.method", "stylit"});
}

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

// ---- exemplars -------------------------------------------------------------------------------------------------

TEST_F(StyleFile, WhatAnExemplarNeeds) {
  const std::string e = kExemplar;
  ExpectRefusal(Load("name = 'x'\n"), ErrorKind::kInput, {"style.toml", "no [[exemplar]]", "image = \"lit.png\""});
  ExpectRefusal(Load("exemplar = []\n"), ErrorKind::kInput, {"no [[exemplar]]"});
  ExpectRefusal(Load(e + e + e + e + e), ErrorKind::kInput, {"style.toml:1", "5 exemplars", "up to 4"});
  ExpectRefusal(Load("[exemplar]\nimage = 'lit.png'\n"), ErrorKind::kInput, {"style.toml:1", "two brackets"});
  ExpectRefusal(Load("exemplar = [3]\n"), ErrorKind::kInput, {"two brackets"});
  ExpectRefusal(Load("[[exemplar]]\n"), ErrorKind::kInput, {"style.toml:1", "no image"});
  ExpectRefusal(Load("[[exemplar]]\nimage = ''\n"), ErrorKind::kInput, {"no image"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 3\n"), ErrorKind::kInput, {"style.toml:2", "exemplar.image", "in quotes"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 'missing.png'\n"), ErrorKind::kInput, {"missing.png", "no such file"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 'style.toml'\n"), ErrorKind::kInput, {"style.toml"});
  ExpectRefusal(Load("[[exemplar]]\nimage = '.'\n"), ErrorKind::kInput, {"folder"});
  for (const char* bad : {"-0.1", "'bright'", "nan", "inf", "true"}) {
    ExpectRefusal(Load(e + "luminance = " + bad + "\n"), ErrorKind::kInput, {"style.toml:3", "exemplar.luminance"});
  }
  ExpectRefusal(Load(e + "guides = 'no.exr'\n"), ErrorKind::kInput, {"no.exr", "no such file"});
  ExpectRefusal(Load(e + "guides = 'lit.png'\n"), ErrorKind::kInput, {"lit.png", "no layer"});
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", NoisyPicture(8, 6)));
  ExpectRefusal(Load(e), ErrorKind::kInput, {"lit.png", "8×6", "square"});
}

GuideSet BallGuides(int width, int height, float luminance) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kLuminance}) guides.Add(layer);
  for (int i = 0; i < width * height; ++i) {
    const float u = (2.0f * float(i % width) + 1) / float(width) - 1,
                v = 1 - (2.0f * float(i / width) + 1) / float(height);
    if (u * u + v * v >= 1.0f) continue;
    guides.Plane(Layer::kCoverage)[i] = 1.0f;
    const float values[3] = {u, v, std::sqrt(1.0f - u * u - v * v)};
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = values[c];
    guides.Plane(Layer::kLuminance)[i] = luminance;
  }
  return guides;
}

TEST_F(StyleFile, GuidesOfAnySceneOfThePicturesSize) {
  ASSERT_TRUE(WritePicture(folder_ / "wide.png", NoisyPicture(24, 16)));
  ASSERT_TRUE(WriteGuides(folder_ / "wide.exr", BallGuides(24, 16, 0.5f)));
  const std::string wide = "[[exemplar]]\nimage = 'wide.png'\n", guides = "guides = 'wide.exr'\n";
  const auto style = Load(wide + guides);
  ASSERT_TRUE(style) << style.error().message;
  const Exemplar& exemplar = style->exemplars[0];
  EXPECT_FALSE(exemplar.is_sphere);
  ASSERT_TRUE(exemplar.guides);
  EXPECT_EQ(exemplar.guides->width(), 24);
  EXPECT_EQ(exemplar.guides->layers(), (LayerSet{Layer::kCoverage, Layer::kNormal}))
      << "one exemplar: light is not read";
  const std::size_t middle = exemplar.guides->Index(12, 8);
  EXPECT_EQ(exemplar.guides->Vec3(Layer::kNormal, middle), BallGuides(24, 16, 0.5f).Vec3(Layer::kNormal, middle));
  EXPECT_EQ(exemplar.picture.rgba, NoisyPicture(24, 16).rgba);
  const auto several = Load(wide + guides + wide + guides + "luminance = 0.1\n");
  ASSERT_TRUE(several) << several.error().message;
  EXPECT_TRUE(several->exemplars[0].guides->Has(Layer::kLuminance)) << "its luminance is to be measured";
  EXPECT_FALSE(several->exemplars[1].guides->Has(Layer::kLuminance)) << "known";
  ExpectRefusal(Load(wide), ErrorKind::kInput, {"wide.png", "24×16", "square", "guides"});
  ExpectRefusal(Load("[[exemplar]]\nimage = 'lit.png'\n" + guides), ErrorKind::kInput,
                {"lit.png is 8×8", "wide.exr are 24×16"});
  GuideSet flat = BallGuides(24, 16, 0.5f);
  flat.Remove(Layer::kNormal);
  flat.Add(Layer::kDepth);
  ASSERT_TRUE(WriteGuides(folder_ / "wide.exr", flat));
  ExpectRefusal(Load(wide + guides), ErrorKind::kInput, {"wide.exr", "normal"});
}

TEST_F(StyleFile, GuidesOfTheSphereKitAreReadForTheirLightOnly) {
  GuideSet kit = BallGuides(8, 8, 0.25f);
  kit.attributes["scumble:sphereMargin"] = "2";
  ASSERT_TRUE(WriteGuides(folder_ / "guides.exr", kit));
  const std::string one = std::string(kExemplar) + "guides = 'guides.exr'\n";
  auto style = Load(one);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_TRUE(style->exemplars[0].is_sphere);
  EXPECT_FALSE(style->exemplars[0].guides);
  style = Load(one + one + "luminance = 0.9\n");
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_TRUE(style->exemplars[0].is_sphere);
  ASSERT_TRUE(style->exemplars[0].guides);
  EXPECT_TRUE(style->exemplars[0].guides->Has(Layer::kLuminance));
  EXPECT_FALSE(style->exemplars[1].guides);
  // The whole painted template: its margin is cut off.
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", NoisyPicture(12, 12)));
  style = Load(one);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->exemplars[0].picture.width, 8);
  const Picture whole = NoisyPicture(12, 12), &cut = style->exemplars[0].picture;
  EXPECT_EQ(std::vector<int>(cut.At(0, 0), cut.At(0, 0) + 32), std::vector<int>(whole.At(2, 2), whole.At(2, 2) + 32));
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

TEST_F(StyleFile, UpToFourLightingConditions) {
  const std::string e = kExemplar;
  auto style = Load(e + "luminance = 0.8\n" + e + e + "luminance = 0\n" + e);
  ASSERT_TRUE(style) << style.error().message;
  ASSERT_EQ(style->exemplars.size(), 4u);
  EXPECT_EQ(style->exemplars[0].luminance, 0.8);
  EXPECT_EQ(style->exemplars[1].luminance, std::nullopt);
  EXPECT_EQ(style->exemplars[2].luminance, 0.0);
  EXPECT_TRUE(RequiredLayers(*style).Has(Layer::kLuminance));
  style =
      Load(std::string(
               "[transfer]\ncolorize = 0.5\ncolorize_mode = 'oklab'\nvariety = 10\nluminance_error = 'published'\n") +
           e);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->transfer.colorize, 0.5);
  EXPECT_EQ(style->transfer.colorize_mode, ColorizeMode::kOklab);
  EXPECT_EQ(style->transfer.variety, 10.0);
  EXPECT_EQ(style->transfer.luminance_error, LuminanceError::kPublished);
  EXPECT_TRUE(RequiredLayers(*style).Has(Layer::kAlbedo));
  EXPECT_FALSE(RequiredLayers(*style).Has(Layer::kLuminance));
}

TEST_F(StyleFile, TheExemplarIsThePictureAsPainted) {
  const auto style = Load(std::string("name = \"Kohle\"\nlicence = \"CC0-1.0\"\n") + kExemplar);
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->name, "Kohle");
  EXPECT_EQ(style->licence, "CC0-1.0");
  ASSERT_EQ(style->exemplars.size(), 1u);
  EXPECT_EQ(style->exemplars[0].picture.rgba, NoisyPicture(8, 8).rgba);
  EXPECT_NE(style->exemplars[0].name.find("lit.png"), std::string::npos);
}

TEST_F(StyleFile, AnExemplarWithoutPaintIsRefused) {
  ASSERT_TRUE(WritePicture(folder_ / "lit.png", Picture(8, 8)));
  ExpectRefusal(Load(kExemplar), {"lit.png shows no paint", "all of its pixels are transparent"});
  ExpectRefusal(LoadStyle(folder_ / "lit.png"), {"lit.png shows no paint"});
  EXPECT_TRUE(Load(kExemplar, {"transfer.method=toon"})) << "its paint is not looked at";
  std::vector<float> pixels(4 * 64, 0.5f);
  for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = std::numeric_limits<float>::quiet_NaN();
  WriteWith<float>(folder_ / "a.exr", OIIO::ImageSpec(8, 8, 4, OIIO::TypeDesc::FLOAT), pixels);
  fs::remove(folder_ / "style.toml");
  ExpectRefusal(LoadStyle(folder_ / "a.exr"), {"a.exr shows no paint: its alpha is NaN"});
}

// ---- paper -----------------------------------------------------------------------------------------------------

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

// ---- --set -----------------------------------------------------------------------------------------------------

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

// ---- where styles are --------------------------------------------------------------------------------------------

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
