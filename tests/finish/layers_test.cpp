// A finish in layers: what they are, and that they make the picture.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/filter/more_workers.h"
#include "core/image/color.h"
#include "core/style/finish_keys.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

using ::testing::ElementsAre;

// The second over the first, with straight alpha in 0 … 1, or atop it.
void Lay(const FinishLayer& layer, std::vector<double>& flat) {
  for (std::size_t i = 0; i < flat.size(); i += 4) {
    const double share = layer.picture.rgba[i + 3] / 65535.0, rest = (layer.atop ? 1.0 : flat[i + 3]) * (1.0 - share);
    if (!(share > 0.0) || (layer.atop && !(flat[i + 3] > 0.0))) continue;
    for (std::size_t c = i; c < i + 3; ++c)
      flat[c] = (layer.picture.rgba[c] / 65535.0 * share + flat[c] * rest) / (share + rest);
    if (!layer.atop) flat[i + 3] = share + rest;
  }
}

// The largest difference of the visible layers' sum from the picture, in steps of 1 / 255, as colours show.
double ShownError(const std::vector<FinishLayer>& layers, const Picture& picture) {
  std::vector<double> flat(picture.rgba.size(), 0.0);
  for (const FinishLayer& layer : layers) {
    if (layer.visible) Lay(layer, flat);
  }
  double error = 0.0;
  for (std::size_t i = 0; i < flat.size(); i += 4) {
    const double alpha = picture.rgba[i + 3] / 65535.0;
    error = std::max(error, std::abs(flat[i + 3] - alpha));
    for (std::size_t c = i; c < i + 3; ++c)
      error = std::max(error, std::abs(flat[c] * flat[i + 3] - picture.rgba[c] / 65535.0 * alpha));
  }
  return 255.0 * error;
}

// The largest difference of the visible layers' sum from the picture in 8 bits, in steps of 1 / 255, and of alpha.
double FlatError(const std::vector<FinishLayer>& layers, const Picture& picture) {
  std::vector<double> flat(picture.rgba.size(), 0.0);
  for (const FinishLayer& layer : layers) {
    EXPECT_TRUE(std::all_of(layer.picture.rgba.begin(), layer.picture.rgba.end(), [](int v) { return v % 257 == 0; }));
    if (layer.visible) Lay(layer, flat);
  }
  double error = 0.0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const std::size_t alpha = i / 4 * 4 + 3;
    const double eighth = std::floor(picture.rgba[i] / 257.0 + 0.5);
    // Of a pixel that hardly shows, a colour in 8 bits says little.
    const double weight = i == alpha ? 1.0 : picture.rgba[alpha] / 65535.0;
    error = std::max(error, std::abs(255.0 * flat[i] - eighth) * weight);
  }
  return error;
}

FinishStep NamedStep(const std::string& effect, const std::vector<std::pair<std::string, KeyValue>>& keys = {}) {
  FinishPass pass = *MakeFinishPass(effect);
  for (const auto& [key, value] : keys) EXPECT_TRUE(SetFinishKey(pass, key, value)) << key;
  if (auto* const palette = std::get_if<PalettePass>(&pass.effect)) palette->target = ColorSpread{{0.4, 0.1}, {0.02}};
  return {pass, {}};
}

std::vector<std::string> NamesIn(const std::vector<FinishLayer>& layers) {
  std::vector<std::string> names;
  for (const FinishLayer& layer : layers) names.push_back((layer.visible ? "" : "hidden ") + layer.name);
  return names;
}

class LayeredFinish : public ::testing::Test {
 protected:
  std::vector<FinishLayer> Layers(const std::vector<FinishStep>& steps, const FinishLayerOptions& options = {}) {
    made_ = picture_;
    auto layers = FinishInLayers(steps, frame_, options, 2, {}, made_);
    EXPECT_TRUE(layers) << layers.error().message;
    return layers ? *std::move(layers) : std::vector<FinishLayer>();
  }
  // As ApplyFinish makes it.
  Picture Whole(const std::vector<FinishStep>& steps, const FinishLayerOptions& options = {}) {
    Picture picture = picture_;
    EXPECT_TRUE(ApplyFinish(steps, FinishPass::Stage::kPaint, frame_, 2, {}, picture));
    if (options.put_ground) {
      EXPECT_TRUE(options.put_ground(picture));
    }
    EXPECT_TRUE(ApplyFinish(steps, FinishPass::Stage::kSheet, frame_, 2, {}, picture));
    return picture;
  }
  // Paper of one colour.
  static FinishLayerOptions OnPaper() {
    FinishLayerOptions options;
    options.put_ground = [](Picture& picture) -> Status {
      for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
        const double share = picture.rgba[i + 3] / 65535.0, paper[3] = {60000.0, 50000.0, 30000.0};
        for (std::size_t c = 0; c < 3; ++c)
          picture.rgba[i + c] =
              static_cast<std::uint16_t>(picture.rgba[i + c] * share + paper[c] * (1.0 - share) + 0.5);
        picture.rgba[i + 3] = 65535;
      }
      return Ok();
    };
    return options;
  }

  // A plate of partial alpha, blended in linear light.
  static FinishLayerOptions OnThinPlate() {
    FinishLayerOptions options;
    options.put_ground = [](Picture& picture) -> Status {
      constexpr double kPlate[3] = {2000.0, 9000.0, 30000.0};
      for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
        const bool has_plate = i % 3 != 0;
        const double share = picture.rgba[i + 3] / 65535.0, rest = has_plate ? 0.5 * (1.0 - share) : 0.0;
        for (std::size_t c = 0; c < 3 && rest > 0.0; ++c) {
          const double front = Srgb16ToLinear(picture.rgba[i + c]);
          const double back = Srgb16ToLinear(static_cast<std::uint16_t>(kPlate[c]));
          picture.rgba[i + c] = Srgb16FromLinear(static_cast<float>((front * share + back * rest) / (share + rest)));
        }
        picture.rgba[i + 3] = static_cast<std::uint16_t>((share + rest) * 65535.0 + 0.5);
      }
      return Ok();
    };
    return options;
  }
  // Paint that shows what is behind it.
  void ThinThePaint() {
    for (std::size_t i = 3; i < picture_.rgba.size(); i += 4)
      picture_.rgba[i] = static_cast<std::uint16_t>(picture_.rgba[i] * (0.3 + 0.5 * double(i % 97) / 96.0));
  }

  GuideSet guides_ = AllGuides(60);
  Picture picture_ = CoveredPicture(guides_), made_;
  FinishFrame frame_{&guides_, MeasureFinish(guides_), 1.0, 7};
};

TEST_F(LayeredFinish, OfEveryEffectMakesThePicture) {
  for (const FinishEffect& effect : FinishEffects()) {
    const std::vector<FinishStep> steps{NamedStep(effect.name)};
    for (const bool on_paper : {false, true}) {
      const FinishLayerOptions options = on_paper ? OnPaper() : FinishLayerOptions();
      const auto layers = Layers(steps, options);
      EXPECT_EQ(made_.rgba, Whole(steps, options).rgba) << effect.name;
      EXPECT_LE(FlatError(layers, made_), 1.0) << effect.name << (on_paper ? " on paper" : "");
      ASSERT_EQ(layers.size(), on_paper ? 3u : 2u);
      EXPECT_EQ(layers.back().name, effect.name);
    }
  }
}

// No colour of thin paint over a plate of partial alpha may lead to the picture.
TEST_F(LayeredFinish, ThinPaintOnAThinPlateMakesThePicture) {
  ThinThePaint();
  const KeyValue white = std::string("#ffffff");
  for (const std::vector<FinishStep>& steps :
       {std::vector{NamedStep("pigment")}, std::vector{NamedStep("outline", {{"ink", white}}), NamedStep("hatch")},
        std::vector{NamedStep("tones"), NamedStep("edges"), NamedStep("outline")}}) {
    const auto layers = Layers(steps, OnThinPlate());
    EXPECT_EQ(made_.rgba, Whole(steps, OnThinPlate()).rgba);
    EXPECT_LE(ShownError(layers, made_), 1.0) << steps.front().pass.name;
  }
}

// Alpha that is rounded in every layer does not add up.
TEST_F(LayeredFinish, ThinPaintAndInkOnNothingMakeThePicture) {
  ThinThePaint();
  const auto layers = Layers({NamedStep("outline"), NamedStep("edges"), NamedStep("outline")});
  EXPECT_THAT(NamesIn(layers), ElementsAre("paint", "outline", "edges", "outline"));
  EXPECT_LE(ShownError(layers, made_), 1.0);
  EXPECT_LE(FlatError(layers, made_), 1.1);
}

TEST_F(LayeredFinish, ChainsMakeThePicture) {
  const KeyValue sheet = std::string("sheet"), paint = std::string("paint"), half = 0.5;
  const std::vector<FinishStep> steps{
      NamedStep("outline", {{"color", std::string("complement")}, {"strength", half}}),
      NamedStep("edges", {{"tone", paint}, {"color", paint}}),
      NamedStep("tones"),
      NamedStep("shadows"),
      NamedStep("grade", {{"contrast", KeyValue(1.5)}}),
      NamedStep("hatch", {{"mask", std::string("radial")}}),
      NamedStep("outline", {{"width", KeyValue(5.0)}}),
      NamedStep("hatch", {{"at", sheet}, {"strength", half}}),
      NamedStep("depth", {{"strength", KeyValue(0.0)}}),
  };
  std::vector<FinishStep> masked = steps;
  masked[5].share = std::vector<std::uint16_t>(guides_.pixel_count(), 20000);
  for (const auto& options : {FinishLayerOptions(), OnPaper()}) {
    const auto layers = Layers(masked, options);
    EXPECT_EQ(made_.rgba, Whole(masked, options).rgba) << "as without layers";
    EXPECT_LE(FlatError(layers, made_), 1.0);
    if (!options.put_ground) {
      EXPECT_THAT(NamesIn(layers), ElementsAre("hidden paint", "hidden outline", "hidden edges", "hidden tones",
                                               "hidden shadows", "grade", "hatch", "outline", "hatch"));
    }
  }
}

TEST_F(LayeredFinish, HideWhatIsPaintedAnew) {
  const auto on_paper = Layers({NamedStep("outline"), NamedStep("tones"), NamedStep("hatch")}, OnPaper());
  EXPECT_THAT(NamesIn(on_paper), ElementsAre("paper", "hidden paint", "hidden outline", "tones", "hatch"));
  const KeyValue sheet = std::string("sheet");
  const auto of_sheet = Layers({NamedStep("hatch"), NamedStep("tones", {{"at", sheet}})}, OnPaper());
  EXPECT_THAT(NamesIn(of_sheet), ElementsAre("hidden paper", "hidden paint", "hidden hatch", "tones"));
}

// Lines as they lie on nothing, whatever is below them.
TEST_F(LayeredFinish, OutlinesAreTheInkAlone) {
  const FinishStep outline = NamedStep("outline", {{"ink", std::string("#336699")}});
  Picture lines(60, 60);
  ASSERT_TRUE(ApplyFinish(std::span(&outline, 1), FinishPass::Stage::kPaint, frame_, 2, {}, lines));
  FinishLayerOptions alone;
  alone.only = "outline", alone.bits = 16;
  const auto layers = Layers({NamedStep("tones"), outline}, alone);
  ASSERT_EQ(layers.size(), 1u);
  EXPECT_EQ(layers[0].picture.rgba, lines.rgba);
  const auto in_8_bits = Layers({NamedStep("tones"), outline});
  for (std::size_t i = 3; i < lines.rgba.size(); i += 4) {
    EXPECT_EQ(in_8_bits.back().picture.rgba[i] / 257, (lines.rgba[i] + 128) / 257);
  }
}

TEST_F(LayeredFinish, OnePassAloneIsThePictureAfterIt) {
  const std::vector<FinishStep> steps{NamedStep("tones"), NamedStep("shadows"), NamedStep("grade"),
                                      NamedStep("outline")};
  FinishLayerOptions alone;
  alone.bits = 16;
  for (std::size_t i = 0; i < 3; ++i) {
    alone.only = steps[i].pass.name;
    const auto layers = Layers(steps, alone);
    ASSERT_EQ(layers.size(), 1u);
    EXPECT_FALSE(layers[0].is_ink);
    const std::vector<FinishStep> until(steps.begin(), steps.begin() + std::ptrdiff_t(i + 1));
    EXPECT_EQ(layers[0].picture.rgba, Whole(until).rgba) << alone.only;
  }
  alone.only = "hatch";
  EXPECT_TRUE(Layers(steps, alone).empty());
}

// Hatching ends at the silhouette: its layer leaves the alpha below.
TEST_F(LayeredFinish, HatchingLiesAtopWhereSomeOfItIsOpen) {
  EXPECT_TRUE(Layers({NamedStep("hatch")}).back().atop);
  EXPECT_FALSE(Layers({NamedStep("hatch")}, OnPaper()).back().atop);
  EXPECT_FALSE(Layers({NamedStep("outline")}).back().atop);
}

TEST_F(LayeredFinish, AreTheSameOnAnyNumberOfThreads) {
  const std::vector<FinishStep> steps{NamedStep("edges", {{"color", std::string("paint")}}), NamedStep("hatch")};
  Picture one = picture_, four = picture_;
  const MoreWorkers workers(4);  // beyond the machine's cores, too
  const auto with_one = FinishInLayers(steps, frame_, {}, 1, {}, one);
  const auto with_four = FinishInLayers(steps, frame_, {}, 4, {}, four);
  ASSERT_TRUE(with_one && with_four);
  for (std::size_t i = 0; i < with_one->size(); ++i) {
    EXPECT_EQ((*with_one)[i].picture.rgba, (*with_four)[i].picture.rgba);
  }
}

}  // namespace
}  // namespace scumble
