// Comparison and coherence, with numbers worked out by hand.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/io/channel_file.h"
#include "measure/coherence.h"
#include "measure/compare.h"
#include "measure/heat_map.h"
#include "tests/support/numbers.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

ChannelImage Row(const std::string& name, const std::vector<std::string>& names,
                 const std::vector<std::vector<float>>& planes) {
  ChannelImage image;
  image.name = name;
  image.width = static_cast<int>(planes[0].size());
  image.height = 1;
  image.names = names;
  image.planes = planes;
  return image;
}

// Compares one row of one channel.
CompareReport CompareRows(const std::vector<float>& a, const std::vector<float>& b,
                          const CompareOptions& options = {}) {
  auto report = Compare(Row("a.exr", {"depth.Z"}, {a}), Row("b.exr", {"depth.Z"}, {b}), options);
  EXPECT_TRUE(report) << report.error().message;
  return *report;
}

// Thresholds that let every finite difference pass.
CompareOptions Lenient() {
  CompareOptions options;
  options.fail.absolute = options.warn.absolute = 1000.0;
  return options;
}

TEST(Compare, StatisticsByHand) {
  // Differences 0, 0, 0, 0.5: mean 0.125, RMS sqrt(0.25 / 4) = 0.25, peak 4, PSNR 20·log10(16).
  const CompareReport report = CompareRows({1, 2, 4, 0}, {1, 2, 4, 0.5f});
  EXPECT_DOUBLE_EQ(report.stats.mean, 0.125);
  EXPECT_DOUBLE_EQ(report.stats.rms, 0.25);
  EXPECT_DOUBLE_EQ(report.stats.peak, 4.0);
  EXPECT_NEAR(report.stats.psnr_db, 24.0823996531, 1e-9);
  EXPECT_EQ(report.stats.values, 4u);
  EXPECT_EQ(report.stats.different, 1u);
  ASSERT_TRUE(report.stats.worst);
  EXPECT_EQ(report.stats.worst->channel, "depth.Z");
  EXPECT_EQ(report.stats.worst->x, 3);
  EXPECT_EQ(report.stats.worst->y, 0);
  EXPECT_EQ(report.stats.worst->a, 0.0f);
  EXPECT_EQ(report.stats.worst->b, 0.5f);
  EXPECT_EQ(report.verdict, Verdict::kFail);
  EXPECT_EQ(report.reasons,
            (std::vector<std::string>{"1 pixel is over 'fail', allowed none", "1 pixel is over 'warn', allowed none"}));
}

TEST(Compare, PeakIsAtLeastOneAndCountsNegativeValues) {
  EXPECT_DOUBLE_EQ(CompareRows({0.25f}, {0.5f}).stats.peak, 1.0);
  EXPECT_DOUBLE_EQ(CompareRows({-8.0f}, {-9.0f}).stats.peak, 9.0);
}

TEST(Compare, IdenticalIsEqual) {
  const CompareReport report = CompareRows({1, kInfinity, -kInfinity, 0.0f}, {1, kInfinity, -kInfinity, -0.0f});
  EXPECT_EQ(report.verdict, Verdict::kEqual);
  EXPECT_EQ(report.stats.different, 0u);
  EXPECT_FALSE(report.stats.worst);
  EXPECT_EQ(report.stats.psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(report.reasons.empty());
}

TEST(Compare, WorstPixelIsNamedInTheWholePicture) {
  ChannelImage a = Row("a", {"Z"}, {{0, 0, 0, 0, 0, 0}});
  a.width = 3;
  a.height = 2;
  a.x = 10;
  a.y = 20;
  ChannelImage b = a;
  b.planes[0][4] = 1;
  const auto report = Compare(a, b);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->stats.worst->x, 11);
  EXPECT_EQ(report->stats.worst->y, 21);
}

TEST(Compare, NanIsADifferenceEvenWhereBothHaveIt) {
  for (const float other : {kNan, 1.0f, kInfinity}) {
    const CompareReport report = CompareRows({kNan, 1.0f}, {other, 1.0f}, Lenient());
    EXPECT_EQ(report.verdict, Verdict::kFail);
    EXPECT_EQ(report.stats.incomparable, 1u);
    EXPECT_EQ(report.pixels.over_fail, 1u);
    EXPECT_EQ(report.stats.mean, 0.0);
    EXPECT_EQ(report.stats.worst->difference, std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(report.stats.worst->a));
  }
}

TEST(Compare, InfinityEqualsOnlyItself) {
  EXPECT_EQ(CompareRows({kInfinity}, {kInfinity}, Lenient()).verdict, Verdict::kEqual);
  EXPECT_EQ(CompareRows({kInfinity}, {-kInfinity}, Lenient()).verdict, Verdict::kFail);
  EXPECT_EQ(CompareRows({kInfinity}, {3.0e38f}, Lenient()).verdict, Verdict::kFail);
}

TEST(Compare, AbsoluteThresholdIsStrict) {
  CompareOptions options;
  options.fail.absolute = options.warn.absolute = 0.5;
  EXPECT_EQ(CompareRows({0}, {0.5f}, options).verdict, Verdict::kEqual);
  EXPECT_EQ(CompareRows({0}, {0.5625f}, options).verdict, Verdict::kFail);
}

TEST(Compare, RelativeThresholdIsOfTheMeanAndBothMustBeExceeded) {
  CompareOptions options = Lenient();
  options.fail.absolute = 0.25;
  options.fail.relative = 0.2;
  // |3 − 5| / 4 = 0.5 and |30 − 32| / 31 = 0.06.
  EXPECT_EQ(CompareRows({3}, {5}, options).verdict, Verdict::kFail);
  EXPECT_EQ(CompareRows({30}, {32}, options).verdict, Verdict::kEqual);
  // Far apart in proportion, but under the absolute threshold.
  EXPECT_EQ(CompareRows({0}, {0.125f}, options).verdict, Verdict::kEqual);
}

TEST(Compare, FailPercentAllowsThatShareOfPixels) {
  CompareOptions options;
  options.warn.absolute = 10.0;
  options.fail.percent = 25.0;
  EXPECT_EQ(CompareRows({0, 0, 0, 0}, {1, 0, 0, 0}, options).verdict, Verdict::kEqual);
  EXPECT_EQ(CompareRows({0, 0, 0, 0}, {1, 1, 0, 0}, options).verdict, Verdict::kFail);
}

TEST(Compare, AllowedFailuresMayFailByAnyAmount) {
  CompareOptions options;
  options.warn.absolute = 1000.0;
  options.fail.hard = 5.0;
  options.allow_failures = 1;
  EXPECT_EQ(CompareRows({0, 0, 0}, {100, 0, 0}, options).verdict, Verdict::kEqual);
  EXPECT_EQ(CompareRows({0, 0, 0}, {1, 1, 0}, options).verdict, Verdict::kFail);
}

TEST(Compare, HardFailIsLookedAtWithoutAnyFailure) {
  // idiff 2.4 passes this: no pixel is over 'fail', so it never looks at 'hardfail'.
  CompareOptions options = Lenient();
  options.fail.hard = 0.25;
  const CompareReport report = CompareRows({0, 0}, {0.5f, 0}, options);
  EXPECT_EQ(report.verdict, Verdict::kFail);
  EXPECT_EQ(report.pixels.over_fail, 0u);
  EXPECT_EQ(report.pixels.over_hardfail, 1u);
}

TEST(Compare, WarningsDoNotDependOnFailures) {
  CompareOptions options = Lenient();
  options.warn.absolute = 0.25;
  EXPECT_EQ(CompareRows({0, 0}, {0.5f, 0}, options).verdict, Verdict::kWarn);
  options.warn.percent = 50.0;
  EXPECT_EQ(CompareRows({0, 0}, {0.5f, 0}, options).verdict, Verdict::kEqual);
  options.warn.hard = 0.375;
  EXPECT_EQ(CompareRows({0, 0}, {0.5f, 0}, options).verdict, Verdict::kWarn);
}

TEST(Compare, APixelCountsOnceHoweverManyChannelsDiffer) {
  const auto report = Compare(Row("a", {"R", "G", "B", "depth.Z"}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}),
                              Row("b", {"R", "G", "B", "depth.Z"}, {{1, 0}, {1, 0}, {1, 0}, {1, 0}}));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->pixels.over_fail, 1u);
  ASSERT_EQ(report->layers.size(), 2u);
  EXPECT_EQ(report->layers[0].name, "color");
  EXPECT_EQ(report->layers[0].channels.size(), 3u);
  EXPECT_DOUBLE_EQ(report->layers[0].stats.mean, 0.5);
}

TEST(Compare, ChannelsMeetByNameNotByOrder) {
  const auto report = Compare(Row("a", {"normal.X", "A"}, {{0.25f}, {1}}), Row("b", {"A", "normal.X"}, {{1}, {0.25f}}));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, Verdict::kEqual);
}

TEST(Compare, ChannelsWithoutAPartnerFail) {
  const auto report = Compare(Row("a", {"A", "depth.Z"}, {{1}, {2}}), Row("b", {"A", "object.ID"}, {{1}, {2}}));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, Verdict::kFail);
  EXPECT_EQ(report->only_in_a, std::vector<std::string>{"depth.Z"});
  EXPECT_EQ(report->only_in_b, std::vector<std::string>{"object.ID"});
  EXPECT_EQ(report->reasons, (std::vector<std::string>{"only in a: depth.Z", "only in b: object.ID"}));

  CompareOptions options;
  options.layers = {"A"};
  const auto chosen =
      Compare(Row("a", {"A", "depth.Z"}, {{1}, {2}}), Row("b", {"A", "object.ID"}, {{1}, {2}}), options);
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->verdict, Verdict::kEqual);
}

TEST(Compare, ErrorsSayWhatIsWrong) {
  const ChannelImage one = Row("a.exr", {"A"}, {{1}});
  const ChannelImage two = Row("b.exr", {"A"}, {{1, 1}});
  const ChannelImage other = Row("c.exr", {"depth.Z"}, {{1}});
  const auto size = Compare(one, two);
  ASSERT_FALSE(size);
  EXPECT_EQ(size.error().message, "a.exr is 1×1, b.exr is 2×1: render both at one size and position to compare them");
  const auto names = Compare(one, other);
  ASSERT_FALSE(names);
  EXPECT_NE(names.error().message.find("no channel in common"), std::string::npos);
  CompareOptions options;
  options.layers = {"normal"};
  const auto layer = Compare(one, one, options);
  ASSERT_FALSE(layer);
  EXPECT_NE(layer.error().message.find("'normal'"), std::string::npos);
}

TEST(Compare, SenselessThresholdsAreRefused) {
  const ChannelImage one = Row("a.exr", {"A"}, {{1}});
  for (const double bad : {-1.0, std::nan("")}) {
    for (double DifferenceThresholds::*member : {&DifferenceThresholds::absolute, &DifferenceThresholds::relative,
                                                 &DifferenceThresholds::percent, &DifferenceThresholds::hard}) {
      CompareOptions options;
      options.fail.*member = bad;
      const auto report = Compare(one, one, options);
      ASSERT_FALSE(report);
      EXPECT_EQ(report.error().kind, ErrorKind::kUsage);
    }
  }
  CompareOptions options;
  options.warn.percent = 101.0;
  EXPECT_FALSE(Compare(one, one, options));
}

TEST(Compare, AnglesOfNormals) {
  const float sine = static_cast<float>(std::sin(0.001));
  const float cosine = static_cast<float>(std::cos(0.001));
  // 0°, 90°, 180°, 0.0573°; a pixel that is background in one; a pixel that is background in both.
  const ChannelImage a =
      Row("a", {"normal.X", "normal.Y", "normal.Z"}, {{0, 1, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0}, {1, 0, 1, 1, 1, 0}});
  const ChannelImage b = Row("b", {"normal.X", "normal.Y", "normal.Z"},
                             {{0, 0, 0, sine, 0, 0}, {0, 1, 0, 0, 0, 0}, {1, 0, -1, cosine, 0, 0}});
  const auto report = Compare(a, b);
  ASSERT_TRUE(report);
  ASSERT_TRUE(report->layers[0].angles);
  const AngularStats& angles = *report->layers[0].angles;
  EXPECT_EQ(angles.pixels, 4u);
  EXPECT_EQ(angles.unmatched, 1u);
  const double small = 0.001 * 180.0 / M_PI;
  EXPECT_NEAR(angles.mean_degrees, (90.0 + 180.0 + small) / 4.0, 1e-5);
  EXPECT_NEAR(angles.p50_degrees, small, 1e-5);  // the second of 0, 0.0573, 90, 180
  EXPECT_NEAR(angles.p99_degrees, 180.0, 1e-9);
  EXPECT_NEAR(angles.max_degrees, 180.0, 1e-9);
  EXPECT_EQ(angles.worst_x, 2);
}

TEST(Compare, PercentilesAreByNearestRank) {
  // 1,000 normals turned by 0.01°, 0.02°, … 10°.
  std::vector<float> x, z;
  for (int i = 1; i <= 1000; ++i) {
    x.push_back(static_cast<float>(std::sin(i * 0.01 * M_PI / 180.0)));
    z.push_back(static_cast<float>(std::cos(i * 0.01 * M_PI / 180.0)));
  }
  const std::vector<float> zero(1000, 0.0f);
  const std::vector<float> one(1000, 1.0f);
  const std::vector<std::string> names = {"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"};
  const auto report = Compare(Row("a", names, {zero, zero, one}), Row("b", names, {x, zero, z}));
  ASSERT_TRUE(report);
  ASSERT_TRUE(report->layers[0].angles);
  EXPECT_NEAR(report->layers[0].angles->p50_degrees, 5.0, 1e-4);
  EXPECT_NEAR(report->layers[0].angles->p99_degrees, 9.9, 1e-4);
  EXPECT_NEAR(report->layers[0].angles->p99_9_degrees, 9.99, 1e-4);
  EXPECT_NEAR(report->layers[0].angles->mean_degrees, 5.005, 1e-4);
}

TEST(Compare, LayersAreWhatStandsBeforeTheLastDot) {
  EXPECT_EQ(LayerOfChannel("ViewLayer.Normal.X"), "ViewLayer.Normal");
  EXPECT_EQ(LayerOfChannel("lpe.LDE.R"), "lpe.LDE");
  EXPECT_EQ(LayerOfChannel("G"), "color");
  EXPECT_EQ(LayerOfChannel("A"), "A");
}

TEST(Compare, JsonIsValidAndHoldsNonFiniteNumbersAsText) {
  const CompareReport report = CompareRows({kNan, 1}, {1, 1});
  const auto json = nlohmann::json::parse(CompareToJson(report));
  EXPECT_EQ(json["verdict"], "fail");
  EXPECT_EQ(json["width"], 2);
  EXPECT_EQ(json["layers"][0]["name"], "depth");
  EXPECT_EQ(json["layers"][0]["stats"]["worst"]["a"], "nan");
  EXPECT_EQ(json["stats"]["worst"]["difference"], "inf");
  EXPECT_EQ(json["stats"]["psnr_db"], "inf");
  EXPECT_EQ(json["options"]["fail"]["hard"], "inf");
  EXPECT_TRUE(nlohmann::json::parse(CompareToJson(CompareRows({1}, {1})))["stats"]["worst"].is_null());
}

TEST(Compare, TextNamesTheWorstPixelAndEndsInTheVerdict) {
  const std::string text = CompareToText(CompareRows({1, 2, 4, 0}, {1, 2, 4, 0.5f}));
  EXPECT_NE(text.find("at (3, 0) depth.Z: 0 against 0.5"), std::string::npos) << text;
  EXPECT_NE(text.find("1 pixel (25 %) over fail 1e-06"), std::string::npos) << text;
  EXPECT_EQ(text.substr(text.size() - 5), "fail\n");
}

TEST(Compare, GuideSetsInMemory) {
  GuideSet guides(2, 1);
  guides.Add(Layer::kCoverage);
  guides.Add(Layer::kNormal);
  guides.Add(Layer::kDepth);
  const ChannelImage channels = ChannelsOf(guides, "ours");
  EXPECT_EQ(channels.names, (std::vector<std::string>{"A", "normal.X", "normal.Y", "normal.Z", "depth.Z"}));
  const auto report = Compare(channels, channels);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, Verdict::kEqual);
}

TEST(HeatMap, RunsFromBlueToYellowAtItsScale) {
  const ChannelImage a = Row("a", {"Z"}, {{0, 0, 0, kNan}});
  const ChannelImage b = Row("b", {"Z"}, {{0, 1, 2, 0}});
  const auto map = DifferenceHeatMap(a, b);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->full_scale, 2.0);
  const auto* equal = map->picture.At(0, 0);
  const auto* half = map->picture.At(1, 0);
  const auto* full = map->picture.At(2, 0);
  const auto* nan = map->picture.At(3, 0);
  EXPECT_GT(equal[2], equal[0]);
  EXPECT_GT(full[0], full[2]);
  EXPECT_GT(half[1], equal[1]);
  EXPECT_LT(half[1], full[1]);
  EXPECT_EQ(nan[0], 65535);
  EXPECT_EQ(nan[1], 0);
  EXPECT_EQ(nan[2], 65535);
  for (int x = 0; x < 4; ++x) EXPECT_EQ(map->picture.At(x, 0)[3], 65535);

  const auto clipped = DifferenceHeatMap(a, b, {1.0, {}});
  ASSERT_TRUE(clipped);
  EXPECT_EQ(clipped->full_scale, 1.0);
  EXPECT_EQ(clipped->picture.At(1, 0)[0], clipped->picture.At(2, 0)[0]);
  EXPECT_FALSE(DifferenceHeatMap(a, b, {-1.0, {}}));
  const auto same = DifferenceHeatMap(b, b);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->full_scale, 0.0);
}

CoherenceReport Coherence(int width, const std::vector<std::int16_t>& x, const std::vector<std::int16_t>& y,
                          const std::vector<std::uint8_t>& covered, const std::vector<std::uint8_t>& exemplar = {}) {
  return MeasureCoherence({width, static_cast<int>(x.size()) / width, x, y, covered, exemplar});
}

TEST(Coherence, StraightCopyIsOneChunk) {
  const CoherenceReport report = Coherence(3, {5, 6, 7, 5, 6, 7}, {2, 2, 2, 3, 3, 3}, {1, 1, 1, 1, 1, 1});
  EXPECT_EQ(report.covered, 6u);
  EXPECT_EQ(report.pairs, 7u);  // 2 · 2 to the right, 3 downwards
  EXPECT_EQ(report.coherent_pairs, 7u);
  EXPECT_EQ(report.share, 1.0);
  EXPECT_EQ(report.chunks, 1u);
  EXPECT_EQ(report.largest_chunk, 6u);
  EXPECT_EQ(report.mean_chunk_area, 6.0);
}

TEST(Coherence, CutAndBackground) {
  // Top row: two pixels of one offset, then one of another. Bottom row: background under the first, then a pixel that
  // continues the first chunk from above, then one that continues nothing.
  const CoherenceReport report = Coherence(3, {5, 6, 90, 0, 6, 40}, {2, 2, 2, 0, 3, 9}, {1, 1, 1, 0, 1, 1});
  EXPECT_EQ(report.covered, 5u);
  EXPECT_EQ(report.pairs, 5u);
  EXPECT_EQ(report.coherent_pairs, 2u);
  EXPECT_DOUBLE_EQ(report.share, 0.4);
  EXPECT_EQ(report.chunks, 3u);
  EXPECT_EQ(report.largest_chunk, 3u);
  EXPECT_DOUBLE_EQ(report.mean_chunk_area, 5.0 / 3.0);
}

TEST(Coherence, EqualOffsetsThatDoNotTouchAreTwoChunks) {
  const CoherenceReport report = Coherence(3, {0, 1, 2}, {0, 0, 0}, {1, 0, 1});
  EXPECT_EQ(report.pairs, 0u);
  EXPECT_EQ(report.share, 0.0);
  EXPECT_EQ(report.chunks, 2u);
}

TEST(Coherence, RowsDoNotWrapAround) {
  const CoherenceReport report = Coherence(2, {0, 1, 2, 3}, {0, 0, 0, 0}, {1, 1, 1, 1});
  EXPECT_EQ(report.coherent_pairs, 2u);
  EXPECT_EQ(report.chunks, 2u);
}

TEST(Coherence, AnotherExemplarIsAnotherChunk) {
  const CoherenceReport report = Coherence(2, {0, 1}, {0, 0}, {1, 1}, {0, 1});
  EXPECT_EQ(report.coherent_pairs, 0u);
  EXPECT_EQ(report.chunks, 2u);
}

TEST(Coherence, ExtremePositionsDoNotOverflow) {
  const CoherenceReport report = Coherence(2, {32767, -32768}, {-32768, 32767}, {1, 1});
  EXPECT_EQ(report.coherent_pairs, 0u);
}

TEST(Coherence, NothingIsNothing) {
  const CoherenceReport report = MeasureCoherence({});
  EXPECT_EQ(report.covered, 0u);
  EXPECT_EQ(report.chunks, 0u);
  EXPECT_EQ(report.mean_chunk_area, 0.0);
}

// A folder that goes away with the test.
class ChannelFile : public ::testing::Test {
 protected:
  // Writes the parts as float; their values count up from 0 across parts, channels fastest.
  std::string WriteParts(std::vector<OIIO::ImageSpec> specs) {
    const std::string path = (folder_ / "parts.exr").string();
    auto output = OIIO::ImageOutput::create(path);
    EXPECT_TRUE(output->open(path, static_cast<int>(specs.size()), specs.data()));
    float value = 0;
    for (std::size_t p = 0; p < specs.size(); ++p) {
      EXPECT_TRUE(p == 0 || output->open(path, specs[p], OIIO::ImageOutput::AppendSubimage));
      std::vector<float> pixels(std::size_t(specs[p].width) * specs[p].height * specs[p].nchannels);
      for (float& pixel : pixels) pixel = value++;
      EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
    }
    EXPECT_TRUE(output->close());
    return path;
  }

  static OIIO::ImageSpec Part(const std::string& name, const std::vector<std::string>& channels, int width = 2) {
    OIIO::ImageSpec spec(width, 1, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames = channels;
    spec.full_width = 2;  // the parts of one EXR must agree on the whole picture's size, and may on no more
    spec.attribute("oiio:subimagename", name);
    return spec;
  }

  TemporaryFolder folder_;
};

TEST_F(ChannelFile, ReadsEveryChannelByName) {
  const auto image = ReadChannels(WriteParts({Part("", {"normal.X", "depth.Z"})}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 2);
  EXPECT_EQ(image->height, 1);
  ASSERT_NE(image->Find("normal.X"), nullptr);
  ASSERT_NE(image->Find("depth.Z"), nullptr);
  EXPECT_EQ(*image->Find("normal.X"), (std::vector<float>{0, 2}));
  EXPECT_EQ(*image->Find("depth.Z"), (std::vector<float>{1, 3}));
  EXPECT_EQ(image->Find("normal.Y"), nullptr);
}

TEST_F(ChannelFile, PartsArePrefixedOnlyWhereNamesRepeat) {
  const auto image = ReadChannels(WriteParts({Part("left", {"Y"}), Part("right", {"Y"}), Part("deep", {"Z"})}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->names, (std::vector<std::string>{"left.Y", "right.Y", "Z"}));
  EXPECT_EQ(image->planes[1], (std::vector<float>{2, 3}));
}

TEST_F(ChannelFile, PartsOfDifferentSizesAreRefused) {
  const auto image = ReadChannels(WriteParts({Part("a", {"Y"}), Part("b", {"Z"}, 3)}));
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().message.find("part 1 is 3×1"), std::string::npos) << image.error().message;
}

TEST_F(ChannelFile, IntegersAreScaledAndAlphaIsLeftAlone) {
  const std::string path = (folder_ / "grey.png").string();
  auto output = OIIO::ImageOutput::create(path);
  OIIO::ImageSpec spec(2, 1, 4, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  ASSERT_TRUE(output->open(path, spec));
  const unsigned char pixels[] = {255, 51, 0, 0, 102, 204, 255, 51};
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, pixels));
  ASSERT_TRUE(output->close());
  const auto image = ReadChannels(path);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->names, (std::vector<std::string>{"R", "G", "B", "A"}));
  const std::vector<std::vector<int>> expected = {{255, 102}, {51, 204}, {0, 255}, {0, 51}};
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_FLOAT_EQ(image->planes[c][i], static_cast<float>(expected[c][i]) / 255.0f);
    }
  }
}

TEST_F(ChannelFile, MissingFileIsAnError) {
  const auto image = ReadChannels(folder_ / "none.exr");
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().message.find("none.exr"), std::string::npos);
}

}  // namespace
}  // namespace scumble
