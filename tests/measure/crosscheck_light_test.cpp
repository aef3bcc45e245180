// The cross-check's light layers against numbers worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/image/hash.h"
#include "measure/crosscheck_page.h"
#include "tests/measure/crosscheck_fixtures.h"

namespace scumble {
namespace {

constexpr std::size_t kCompared = 16 * 12;

bool Says(const std::vector<std::string>& lines, const std::string& part) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

TEST(CrosscheckLight, EqualLightAgreesAndAbsentLightIsSaid) {
  const CrosscheckReport report = CheckLight({EqualLight(64)});
  EXPECT_TRUE(report.passed()) << CrosscheckToText(report);
  EXPECT_EQ(report.compared, kCompared);
  EXPECT_EQ(report.setup.samples, 64);
  EXPECT_EQ(FigureOf(report, "lpe.LSE").note, "no such light");
  EXPECT_EQ(FigureOf(report, "lpe.LDE").note, "");
  EXPECT_EQ(FigureOf(report, "indirect").value, 0.0);
  EXPECT_EQ(FigureOf(report, "indirect").note, "");
  EXPECT_EQ(CrosscheckVerdict(report), "agrees");
}

TEST(CrosscheckLight, LimitsFollowWhatIsSpecular) {
  CrosscheckLight light = EqualLight(64);
  const CrosscheckReport diffuse = CheckLight({light});
  light.reference.glossy = true;
  const CrosscheckReport glossy = CheckLight({light});
  for (const auto& [layer, plain, mixed] : {std::tuple("lpe.LDE", 0.5, 0.5),
                                            {"lpe.LSE", 2.0, 2.0},
                                            {"lpe.LDDE", 1.5, 2.0},
                                            {"lpe.LD12E", 1.5, 2.0},
                                            {"lpe.full", 1.5, 2.0},
                                            {"indirect", 1.5, 2.0}}) {
    EXPECT_EQ(FigureOf(diffuse, layer).limit, plain) << layer;
    EXPECT_EQ(FigureOf(glossy, layer).limit, mixed) << layer;
  }
}

TEST(CrosscheckLight, OnePercentLessDirectLightBreaks) {
  CrosscheckLight light = EqualLight(64);
  FillLayer(light.ours, Layer::kLpeLDE, {0.99f, 0.495f, 0.495f});
  const CrosscheckReport report = CheckLight({light});
  EXPECT_NEAR(FigureOf(report, "lpe.LDE").value, 1.0, 1e-5);
  EXPECT_NEAR(FigureOf(report, "lpe.LDE").error, 0.0, 1e-4);
  EXPECT_FALSE(report.passed());
  EXPECT_TRUE(Says(WhyCrosscheckFails(report), "lpe.LDE mean difference: 1 is above the limit of 0.5 %"));
  // Light missing from LDE counts as bounced light: 0.02 of 1.5.
  EXPECT_NEAR(FigureOf(report, "indirect").value, 100.0 * 0.02 / 1.5, 1e-4);
}

TEST(CrosscheckLight, ChannelsDoNotCancel) {
  CrosscheckLight light = EqualLight(64);
  FillLayer(light.ours, Layer::kLpeLDE, {1.02f, 0.48f, 0.5f});  // 0.02 more, 0.02 less, of 2
  EXPECT_NEAR(FigureOf(CheckLight({light}), "lpe.LDE").value, 2.0, 1e-5);
}

// Half of the pixels are 0.2 brighter and half 0.2 darker in every channel: σ is 0.2, the mean's error 0.2 / √192.
TEST(CrosscheckLight, AFigureThatIsTooNoisyProvesNothing) {
  CrosscheckLight light = EqualLight(64);
  for (std::size_t i = 0; i < light.ours.pixel_count(); ++i) {
    for (int c = 0; c < 3; ++c) light.ours.Plane(Layer::kLpeLDDE, c)[i] += i % 2 ? 0.2f : -0.2f;
  }
  const CrosscheckReport report = CheckLight({light});
  const CrosscheckFigure figure = FigureOf(report, "lpe.LDDE");
  EXPECT_NEAR(figure.value, 0.0, 1e-5);
  EXPECT_NEAR(figure.error, 100.0 * 0.2 / std::sqrt(double(kCompared)) / 0.5, 1e-4);
  EXPECT_TRUE(figure.TooNoisy());
  EXPECT_FALSE(figure.kept());
  EXPECT_FALSE(report.passed());
  EXPECT_TRUE(Says(WhyCrosscheckFails(report), "raise --samples"));
  EXPECT_NE(CrosscheckToText(report).find("TOO NOISY"), std::string::npos);
  EXPECT_NEAR(NoiseOf(report, "lpe.LDDE").nrmse.back(), 0.2 / 0.5, 1e-5);
}

TEST(CrosscheckLight, AFigureIsKeptOnlyIfItsErrorLeavesNoDoubt) {
  CrosscheckFigure figure{"lpe.full", "mean difference", "%", 1.45, 1.5, 0.02, 0.0};
  EXPECT_TRUE(figure.kept());
  figure.error = 0.03;  // 1.51 is possible
  EXPECT_FALSE(figure.kept());
  EXPECT_TRUE(figure.TooNoisy());
  EXPECT_FALSE(figure.broken());
  figure.value = 1.6, figure.error = 0.04;
  EXPECT_TRUE(figure.broken());
  EXPECT_FALSE(figure.TooNoisy());
  figure.must_prove = false, figure.error = 0.1;
  EXPECT_TRUE(figure.kept()) << "1.4 is possible";
  EXPECT_TRUE(figure.Unjudged());
  figure.value = std::nan("");
  EXPECT_FALSE(figure.kept());
}

// A light on the other side: the left half is brighter by a fifth and the right one darker, at every sample count.
TEST(CrosscheckLight, LightInTheWrongPlaceBreaksThoughTheMeanIsRight) {
  std::vector<CrosscheckLight> light{EqualLight(16), EqualLight(64)};
  for (CrosscheckLight& count : light) {
    for (int y = 0; y < count.ours.height(); ++y) {
      for (int x = 0; x < count.ours.width(); ++x) {
        const float factor = 2 * x < count.ours.width() ? 1.2f : 0.8f;
        for (int c = 0; c < 3; ++c) count.ours.Plane(Layer::kLpeLDE, c)[count.ours.Index(x, y)] *= factor;
      }
    }
  }
  const CrosscheckReport report = CheckLight(light);
  EXPECT_TRUE(FigureOf(report, "lpe.LDE").kept()) << "the mean is right";
  EXPECT_NEAR(FigureOf(report, "lpe.LDE").error, 0.0, 1e-9) << "nothing of it is noise";
  EXPECT_TRUE(FigureOf(report, "lpe.LDE", "8x8 tiles").broken());
  EXPECT_FALSE(report.passed());
}

// Noise of equal size, independent at every count, breaks no limit: it changes with the samples.
TEST(CrosscheckLight, NoiseIsNotTakenForLightInTheWrongPlace) {
  std::vector<CrosscheckLight> light{EqualLight(16), EqualLight(64)};
  for (CrosscheckLight& count : light) {
    for (std::size_t i = 0; i < count.ours.pixel_count(); ++i) {
      const float noise = UnitFloat(Hash(i, count.samples)) - 0.5f;
      for (int c = 0; c < 3; ++c)
        count.ours.Plane(Layer::kLpeLDE, c)[i] *= 1.0f + noise * 4.0f / std::sqrt(float(count.samples));
    }
  }
  const CrosscheckReport report = CheckLight(light);
  EXPECT_TRUE(FigureOf(report, "lpe.LDE", "8x8 tiles").kept());
  EXPECT_LT(FigureOf(report, "lpe.LDE", "8x8 tiles").value, 5.0);
  EXPECT_GT(FigureOf(report, "lpe.LDE").error, 0.1);
}

TEST(CrosscheckLight, AFewPixelsProveNothing) {
  CrosscheckReport report = CheckLight({EqualLight(64)});
  EXPECT_EQ(report.covered, 20u * 16u);
  report.compared = 99;
  EXPECT_FALSE(report.passed());
  EXPECT_TRUE(Says(WhyCrosscheckFails(report), "raise --size"));
}

TEST(CrosscheckLight, OnlyNoiseIsNotProvedAndABreakNamesWhatIsNotExpressed) {
  CrosscheckReport report;
  report.scene = "scene", report.compared = 200, report.setup.samples = 1, report.setup.max_bounces = 8;
  report.unsupported = {"hair", "fog"};
  report.figures = {{"lpe.full", "mean difference", "%", 3.0, 1.5, 1.0}};  // 3 − 2 is within 1.5
  EXPECT_EQ(report.Outcome(), CrosscheckOutcome::kNotProved);
  EXPECT_FALSE(report.passed());
  EXPECT_EQ(CrosscheckVerdict(report), "NOT PROVED, 1 figure is too noisy: raise --samples");
  report.figures[0].value = 4.0;  // 4 − 2 is not
  EXPECT_TRUE(report.figures[0].broken());
  EXPECT_EQ(report.Outcome(), CrosscheckOutcome::kDiffers);
  EXPECT_FALSE(Says(WhyCrosscheckFails(report), "raise --samples"));
  EXPECT_EQ(CrosscheckVerdict(report), "DIFFERS, 2 things are not expressed: see the list “not expressed”");
  const auto html = CrosscheckToHtml({report}, {"Cycles", "scumble"});
  ASSERT_TRUE(html.ok());
  EXPECT_LT(html->find("Not expressed"), html->find("✗ broken"));
  EXPECT_NE(CrosscheckToText(report).find("1 sample,"), std::string::npos);
}

TEST(CrosscheckLight, LightOnOneSideAloneBreaks) {
  CrosscheckLight ours_alone = EqualLight(64), theirs_alone = EqualLight(64);
  FillLayer(ours_alone.ours, Layer::kLpeLSE, glm::vec3(1e-6f));
  FillLayer(theirs_alone.reference.guides, Layer::kLpeLSE, glm::vec3(1e-6f));
  for (const CrosscheckLight& light : {ours_alone, theirs_alone}) {
    const CrosscheckReport report = CheckLight({light});
    EXPECT_FALSE(FigureOf(report, "lpe.LSE").kept());
    EXPECT_FALSE(report.passed());
  }
}

TEST(CrosscheckLight, ImpossibleValuesBreakWhereverTheyAre) {
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), -1e-6f}) {
    CrosscheckLight light = EqualLight(64);
    light.ours.Plane(Layer::kLpeLD12E, 1)[0] = bad;  // the corner: outside the eroded mask
    const CrosscheckReport report = CheckLight({light});
    EXPECT_EQ(FigureOf(report, "lpe", "NaN, inf or < 0").value, 1.0) << bad;
    EXPECT_EQ(FigureOf(report, "lpe", "NaN, inf or < 0").note, "in lpe.LD12E");
    EXPECT_FALSE(report.passed()) << bad;
  }
  // A pixel that is no number makes its layer's mean none, on either side.
  for (const bool theirs : {false, true}) {
    CrosscheckLight light = EqualLight(64);
    GuideSet& side = theirs ? light.reference.guides : light.ours;
    side.Plane(Layer::kLpeFull, 1)[side.Index(9, 9)] = std::nanf("");
    const CrosscheckReport report = CheckLight({light}, {2, true});
    EXPECT_TRUE(std::isnan(FigureOf(report, "lpe.full").value));
    EXPECT_FALSE(report.passed());
    EXPECT_NE(CrosscheckToJson({report}).find("\"nan\""), std::string::npos);
  }
}

TEST(CrosscheckLight, ASkippedLayerBreaks) {
  for (const bool theirs : {false, true}) {
    CrosscheckLight light = EqualLight(64);
    (theirs ? light.reference.guides : light.ours).Remove(Layer::kLpeLDE);
    const CrosscheckReport report = CheckLight({light});
    EXPECT_EQ(report.skipped, std::vector<std::string>{"lpe.LDE"});
    EXPECT_FALSE(report.passed());
    EXPECT_EQ(FigureOf(report, "lpe.LD12E").value, 0.0) << "the others are compared";
  }
}

TEST(CrosscheckLight, SurfacesThatShineAreNoIndirectLight) {
  CrosscheckLight light = EqualLight(64);
  const std::size_t lamp = light.ours.Index(8, 8);
  light.reference.emits[lamp] = 1;
  for (GuideSet* side : {&light.reference.guides, &light.ours}) side->Plane(Layer::kLpeFull, 0)[lamp] = 100.0f;
  light.ours.Plane(Layer::kLpeFull, 0)[lamp] = 90.0f;
  const CrosscheckReport report = CheckLight({light});
  EXPECT_EQ(FigureOf(report, "indirect").value, 0.0);
  EXPECT_GT(FigureOf(report, "lpe.full").value, 1.0);
}

// Differences of 1/√samples, of either sign in turn.
TEST(CrosscheckLight, NoiseFallsByItsSlopeAndTheWorstPixelIsNamed) {
  std::vector<CrosscheckLight> light;
  for (const int samples : {4, 16, 64}) {
    CrosscheckLight count = EqualLight(samples);
    for (std::size_t i = 0; i < count.ours.pixel_count(); ++i) {
      for (int c = 0; c < 3; ++c) {
        count.ours.Plane(Layer::kLpeLDDE, c)[i] += (i % 2 ? 0.1f : -0.1f) / std::sqrt(float(samples));
      }
    }
    count.ours.Plane(Layer::kLpeLDDE, 2)[count.ours.Index(11, 7)] = 3.0f;
    light.push_back(std::move(count));
  }
  light[0].ours.Plane(Layer::kLpeLDDE, 2)[light[0].ours.Index(11, 7)] = 0.5f;
  light[1].ours.Plane(Layer::kLpeLDDE, 2)[light[1].ours.Index(11, 7)] = 0.5f;
  const CrosscheckNoise noise = NoiseOf(CheckLight(light), "lpe.LDDE");
  EXPECT_EQ(noise.samples, (std::vector<int>{4, 16, 64}));
  EXPECT_NEAR(noise.nrmse[0], 0.1, 1e-3);
  EXPECT_NEAR(noise.nrmse[1], 0.05, 1e-3);
  EXPECT_EQ(noise.worst, 2.5);
  EXPECT_EQ(noise.worst_x, 11);
  EXPECT_EQ(noise.worst_y, 7);
  EXPECT_EQ(noise.worst_ours, 3.0);
  EXPECT_EQ(noise.worst_reference, 0.5);

  light.pop_back();
  const CrosscheckReport two = CheckLight(light);
  ASSERT_TRUE(NoiseOf(two, "lpe.LDDE").slope.has_value());
  EXPECT_NEAR(*NoiseOf(two, "lpe.LDDE").slope, -0.5, 0.01);
  EXPECT_TRUE(NoiseOf(two, "lpe.LDE").free_of_noise);
  EXPECT_FALSE(NoiseOf(two, "lpe.LDE").slope.has_value());
  EXPECT_TRUE(NoiseOf(two, "lpe.LSE").no_such_light);
  light.pop_back();
  EXPECT_FALSE(NoiseOf(CheckLight(light), "lpe.LDDE").slope.has_value()) << "one count has no slope";
}

TEST(CrosscheckLight, WithoutLightTheVerdictSaysSo) {
  const CrosscheckReport report = CheckLight({});
  EXPECT_TRUE(report.passed());
  EXPECT_NE(CrosscheckToText(report).find("agrees, data layers alone"), std::string::npos);
}

TEST(CrosscheckLight, SurfacesThatOnlyShineHaveNoAlbedoToCompare) {
  GuideSet ours = OneObject();
  const std::size_t lamp = ours.Index(8, 8);
  ours.Plane(Layer::kAlbedo, 0)[lamp] = 3.0f * 192.0f;  // a mean difference of 1
  CrosscheckOptions options{2, true};
  EXPECT_FALSE(Crosscheck("scene", OneObject(), ours, options)->passed());
  options.without_albedo.assign(ours.pixel_count(), 0);
  options.without_albedo[lamp] = 1;
  EXPECT_TRUE(Crosscheck("scene", OneObject(), ours, options)->passed());
  options.without_albedo.assign(ours.pixel_count(), 1);
  const auto report = Crosscheck("scene", OneObject(), ours, options);
  EXPECT_TRUE(report->passed());
  EXPECT_EQ(FigureOf(*report, "albedo").note, "every surface only shines");
}

TEST(CrosscheckLight, SizesMustAgree) {
  CrosscheckLight light = EqualLight(64);
  light.ours = GuideSet(19, 16);
  auto report = Crosscheck("scene", OneObject(), OneObject());
  EXPECT_FALSE(CrosscheckLightLayers(OneObject(), OneObject(), {light}, {}, *report).ok());
}

TEST(CrosscheckLight, PicturesShareOneExposureAndShowTheSign) {
  CrosscheckLight light = EqualLight(64);
  light.ours.Plane(Layer::kLpeLDE, 1)[light.ours.Index(5, 5)] = 0.9f;
  light.ours.Plane(Layer::kLpeLDE, 1)[light.ours.Index(6, 5)] = 0.1f;
  const CrosscheckReport report = CheckLight({light}, {2, true});
  const auto pictures = std::find_if(report.pictures.begin(), report.pictures.end(),
                                     [](const CrosscheckPictures& p) { return p.layer == "lpe.LDE"; });
  ASSERT_NE(pictures, report.pictures.end());
  EXPECT_EQ(pictures->reference.At(8, 8)[0], 65535) << "the brightest channel is white";
  EXPECT_EQ(pictures->reference.At(8, 8)[1], pictures->ours.At(8, 8)[1]);
  EXPECT_GT(pictures->difference.At(5, 5)[0], pictures->difference.At(5, 5)[2]) << "orange: brighter";
  EXPECT_LT(pictures->difference.At(6, 5)[0], pictures->difference.At(6, 5)[2]) << "blue: darker";
  EXPECT_EQ(pictures->difference.At(8, 8)[0], 0);
  EXPECT_NE(pictures->look.find("+0.00 stops"), std::string::npos) << pictures->look;
}

TEST(CrosscheckLight, ThePageHoldsFiguresChartWarningsAndReasons) {
  std::vector<CrosscheckLight> light{EqualLight(4), EqualLight(16)};
  for (CrosscheckLight& count : light) {
    for (std::size_t i = 0; i < count.ours.pixel_count(); ++i) {
      count.ours.Plane(Layer::kLpeLDDE, 0)[i] += (i % 2 ? 0.4f : -0.4f) / std::sqrt(float(count.samples));
    }
  }
  CrosscheckReport report = CheckLight(light, {2, true});
  report.warnings = {"material 'a<b>': unlit"};
  report.problems = {"the baseline names the figure 'x<y>'"};
  const auto html = CrosscheckToHtml({report}, {"Cycles", "scumble crosscheck scene", "limits<1>.json"});
  ASSERT_TRUE(html.ok());
  for (const std::string part :
       {"<svg", "class=\"guide\"", "lpe.LDDE -0.50", "material &#39;a&lt;b&gt;&#39;: unlit", "x&lt;y&gt;",
        "limits&lt;1&gt;.json", "href=\"#scene1\"", "stops, clipped at white", "±"}) {
    EXPECT_NE(html->find(part), std::string::npos) << part;
  }
  EXPECT_EQ(html->find("://"), std::string::npos) << "nothing is loaded from elsewhere";
}

}  // namespace
}  // namespace scumble
