// The finished picture: alpha, paper, the background, determinism, sizes, refusals.
#include <limits>

#include "core/image/color.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

Picture FlatPicture(int width, int height, std::uint16_t r, std::uint16_t g, std::uint16_t b, std::uint16_t a) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    picture.rgba[i] = r, picture.rgba[i + 1] = g, picture.rgba[i + 2] = b, picture.rgba[i + 3] = a;
  }
  return picture;
}

TEST(Determinism, ThreadsAndRegionsDoNotChangeAByte) {
  const GuideSet guides = HillGuides(203, 151);
  Style style = PlainStyle(NoisePicture(160));
  style.transfer.blend_radius = 3;
  TransferOptions options;
  options.seed = 5;
  options.threads = 1;
  const Picture one = MustTransfer(style, guides, options).picture;
  for (const int threads : {0, 2, 3, 7}) {
    options.threads = threads;
    EXPECT_EQ(MustTransfer(style, guides, options).picture.rgba, one.rgba) << threads;
  }
  const auto prepared = Prepare(style, guides.height());
  for (const int tile : {16, 50, 128}) {
    Picture tiled;
    TransferScratch scratch;
    for (int y = 0; y < guides.height(); y += tile) {
      for (int x = 0; x < guides.width(); x += tile) {
        options.region = Region{x, y, x + tile, y + tile};
        ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, tiled).ok());
      }
    }
    EXPECT_EQ(tiled.rgba, one.rgba) << tile;
  }
}

TEST(Determinism, SeedAndTimeStepChooseThePattern) {
  const GuideSet guides = HillGuides(120, 90);
  Style style = PlainStyle(NoisePicture(160));
  style.transfer.jitter_fps = -1.0;
  TransferOptions options;
  const Picture first = MustTransfer(style, guides, options).picture;
  options.seed = 1;
  EXPECT_NE(MustTransfer(style, guides, options).picture.rgba, first.rgba);
  options.seed = 0, options.frame = 1;
  EXPECT_NE(MustTransfer(style, guides, options).picture.rgba, first.rgba);
}

TEST(Compose, AlphaIsCoverageTimesPaint) {
  GuideSet guides = MakeGuides(3, 1, [](int x, int) { return x == 2 ? glm::vec3(0.0f) : glm::vec3(0, 0, 1); });
  guides.Plane(Layer::kCoverage)[1] = 0.25f;
  const Style opaque = PlainStyle(FlatPicture(32, 32, 11111, 22222, 33333, 65535));
  const Picture picture = MustTransfer(opaque, guides).picture;
  EXPECT_EQ(picture.rgba,
            (std::vector<std::uint16_t>{11111, 22222, 33333, 65535, 11111, 22222, 33333, 16384, 0, 0, 0, 0}));
  const Style glass = PlainStyle(FlatPicture(32, 32, 11111, 22222, 33333, 32768));
  EXPECT_EQ(MustTransfer(glass, guides).picture.At(0, 0)[3], 32768);
  EXPECT_EQ(MustTransfer(glass, guides).picture.At(1, 0)[3], 8192);
}

TEST(Compose, PaperColourAndPictureBlendInLinearLight) {
  GuideSet guides = MakeGuides(3, 1, [](int x, int) { return x == 2 ? glm::vec3(0.0f) : glm::vec3(0, 0, 1); });
  guides.Plane(Layer::kCoverage)[1] = 0.5f;
  Style style = PlainStyle(FlatPicture(32, 32, 65535, 65535, 65535, 65535));
  style.paper.color = {0, 0, 0};
  const Picture on_black = MustTransfer(style, guides).picture;
  EXPECT_EQ(on_black.At(0, 0)[0], 65535);
  EXPECT_NEAR(on_black.At(1, 0)[0], 0.735357f * 65535, 40) << "half of the light is sRGB 0.7354";
  EXPECT_EQ(on_black.At(2, 0)[0], 0);
  for (int x = 0; x < 3; ++x) EXPECT_EQ(on_black.At(x, 0)[3], 65535);

  style.paper.color.reset();
  style.paper.picture = Picture(2, 2);
  style.paper.picture->rgba = {100, 200, 300, 65535, 400, 500, 600, 65535, 1, 1, 1, 65535, 1, 1, 1, 65535};
  EXPECT_EQ(MustTransfer(style, guides).picture.At(2, 0)[0], 100) << "tiled";

  const Picture under = FlatPicture(3, 1, 9, 8, 7, 65535);
  TransferOptions options;
  options.over = &under;
  const Picture over = MustTransfer(style, guides, options).picture;
  EXPECT_EQ(over.At(0, 0)[0], 65535);
  EXPECT_EQ(over.At(2, 0)[2], 7) << "the picture underneath replaces the paper";
}

TEST(Compose, APictureOfAnotherSizeUnderneathIsRefusedWithBothSizes) {
  const GuideSet guides = SphereGuides(16);
  const Picture under(15, 16);
  TransferOptions options;
  options.over = &under;
  TransferScratch scratch;
  Picture out;
  const Status done = Transfer(*Prepare(PlainStyle(NoisePicture(16)), 16), guides, options, scratch, out);
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.error().kind, ErrorKind::kInput);
  EXPECT_NE(done.error().message.find("15×16"), std::string::npos);
  EXPECT_NE(done.error().message.find("16×16"), std::string::npos);
}

TEST(ReferenceHeight, LengthsFollowTheOutput) {
  Style style = PlainStyle(NoisePicture(400));
  style.transfer.reference_height = 1080;
  style.transfer.blend_radius = 4;
  const auto size_levels_radius = [&](int height) {
    const auto prepared = Prepare(style, height);
    return std::array<int, 3>{prepared->exemplar->size(), prepared->levels, prepared->blend_radius};
  };
  EXPECT_EQ(size_levels_radius(1080), (std::array<int, 3>{400, 7, 4}));
  EXPECT_EQ(size_levels_radius(540), (std::array<int, 3>{200, 6, 2}));
  EXPECT_EQ(size_levels_radius(2160), (std::array<int, 3>{800, 8, 8}));
  EXPECT_EQ(size_levels_radius(135), (std::array<int, 3>{50, 4, 1})) << "what blends goes on blending";
  EXPECT_EQ(size_levels_radius(764), (std::array<int, 3>{283, 7, 3})) << "nearer to 1080 than to 540";
  EXPECT_EQ(size_levels_radius(763), (std::array<int, 3>{283, 6, 3})) << "nearer to 540";
  style.transfer.scale = 0.5;
  EXPECT_EQ(size_levels_radius(1080), (std::array<int, 3>{200, 7, 4}));
  style.transfer.reference_height = 0;
  EXPECT_EQ(size_levels_radius(99), (std::array<int, 3>{200, 7, 4}));
}

// Broad stripes across the exemplar. A preview of half the size shows as many of them as the final picture.
TEST(ReferenceHeight, APreviewLooksLikeTheFinal) {
  Picture stripes(256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      std::uint16_t* texel = stripes.At(x, y);
      texel[0] = texel[1] = texel[2] = (x / 8) % 2 ? 60000 : 5000, texel[3] = 65535;
    }
  }
  const auto changes_along_the_middle = [&](int size, int reference) {
    Style style = PlainStyle(stripes);
    style.transfer.reference_height = reference;
    style.transfer.jitter = 0.0f;
    const GuideSet wall = MakeGuides(size, size, [](int, int) { return glm::vec3(0, 0, 1); });
    const Picture picture = MustTransfer(style, wall).picture;
    int changes = 0;
    for (int x = 1; x < size; ++x) {
      changes += (picture.At(x, size / 2)[0] > 32000) != (picture.At(x - 1, size / 2)[0] > 32000);
    }
    return changes;
  };
  const int final_changes = changes_along_the_middle(512, 512), preview_changes = changes_along_the_middle(256, 512);
  EXPECT_NEAR(preview_changes, final_changes, 0.1 * final_changes);
  EXPECT_NEAR(changes_along_the_middle(256, 0), 0.5 * final_changes, 0.15 * final_changes)
      << "without it the preview shows half as many";
}

// The share of a half-size picture's pixels that take their paint from where the full picture takes it.
double SharedSources(const SourceField& full, const SourceField& half) {
  std::size_t covered = 0, same = 0;
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      const std::size_t p = half.Index(x, y), q = full.Index(2 * x, 2 * y);
      if (half.level[p] == SourceField::kNoSource || full.level[q] == SourceField::kNoSource) continue;
      ++covered;
      same += std::abs(2 * half.x[p] - full.x[q]) <= 3 && std::abs(2 * half.y[p] - full.y[q]) <= 3;
    }
  }
  return static_cast<double>(same) / static_cast<double>(covered);
}

// The chunks of a preview are those of the final picture at half the size, jittered seeds and all. Near their borders
// the coarser pixels decide otherwise; with other seeds only chance agreement is left.
TEST(ReferenceHeight, APreviewHasTheFinalPicturesChunks) {
  const auto field_at = [](int size, std::uint64_t seed) {
    Style style = PlainStyle(NoisePicture(512));
    style.transfer.reference_height = 512;
    TransferOptions options;
    options.seed = seed;
    return MustTransfer(style, HillGuides(size, size), options).field;
  };
  const SourceField full = field_at(512, 0);
  const double same_seeds = SharedSources(full, field_at(256, 0)), other_seeds = SharedSources(full, field_at(256, 1));
  EXPECT_GT(same_seeds, 0.65);
  EXPECT_LT(other_seeds, 0.5 * same_seeds);
}

TEST(Sizes, OnePixelOneRowOneColumnAndNothingCovered) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 33}, {33, 1}, {5, 4}}) {
    const GuideSet covered = MakeGuides(width, height, [](int, int) { return glm::vec3(0, 0, 1); });
    const GuideSet empty = MakeGuides(width, height, [](int, int) { return glm::vec3(0.0f); });
    for (const int exemplar : {1, 2, 40}) {
      for (const int levels : {1, 16}) {
        Style style = PlainStyle(NoisePicture(exemplar));
        style.transfer.levels = levels;
        style.transfer.blend_radius = 64;
        const Picture picture = MustTransfer(style, covered).picture;
        for (std::size_t i = 3; i < picture.rgba.size(); i += 4) ASSERT_EQ(picture.rgba[i], 65535);
        const Picture nothing = MustTransfer(style, empty).picture;
        for (const std::uint16_t value : nothing.rgba) ASSERT_EQ(value, 0);
      }
    }
  }
}

TEST(Refusals, SettingsOutsideTheirRangesAndImpossibleExemplars) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refuses = [](auto change) {
    Style style = PlainStyle(NoisePicture(8));
    change(style);
    return !Prepare(style, 100).ok();
  };
  EXPECT_FALSE(refuses([](Style&) {}));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.threshold = nan; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.threshold = -1.0f; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.levels = 0; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.levels = 17; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.jitter = 1.5f; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.blend_radius = -1; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.scale = 0.0; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.rim = nan; }));
  EXPECT_FALSE(refuses([&](Style& s) { s.transfer.rim = 2.0; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.rim = 2.1; })) << "more than half of a radius of 4";
  EXPECT_TRUE(refuses([&](Style& s) { s.exemplars[0].picture = Picture(300, 300), s.transfer.scale = 64.0; }))
      << "19200 pixels a side";
  EXPECT_TRUE(refuses([&](Style& s) { s.exemplars[0].picture = Picture(8, 9); }));
  EXPECT_TRUE(refuses([&](Style& s) { s.exemplars[0].picture = Picture(); }));
  EXPECT_TRUE(refuses([&](Style& s) { s.exemplars.assign(5, s.exemplars[0]); }));
  EXPECT_TRUE(refuses([&](Style& s) { s.exemplars[0].luminance = -0.1; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.luminance_weight = -1.0f; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.colorize = 1.5; }));
  EXPECT_TRUE(refuses([&](Style& s) { s.transfer.variety = nan; }));
}

TEST(Refusals, AMissingLayerIsNamed) {
  GuideSet guides = SphereGuides(16);
  guides.Remove(Layer::kDepth);
  TransferScratch scratch;
  Picture out;
  Style style = PlainStyle(NoisePicture(16));
  const Status done = Transfer(*Prepare(style, 16), guides, {}, scratch, out);
  ASSERT_FALSE(done.ok());
  EXPECT_NE(done.error().message.find("depth"), std::string::npos);
  style.transfer.edge_aware = false;
  EXPECT_TRUE(Transfer(*Prepare(style, 16), guides, {}, scratch, out).ok()) << "only edge-aware voting reads depth";
}

TEST(Refusals, BruteForceIsForSmallPictures) {
  Style style = PlainStyle(NoisePicture(16));
  style.transfer.method = Method::kBruteForce;
  const GuideSet large = MakeGuides(2000, 600, [](int, int) { return glm::vec3(0.0f); });
  TransferScratch scratch;
  Picture out;
  const Status done = Transfer(*Prepare(style, 600), large, {}, scratch, out);
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.error().kind, ErrorKind::kUsage);
}

TEST(Progress, RisesAndCanStop) {
  const GuideSet guides = HillGuides(100, 300);
  const auto prepared = Prepare(PlainStyle(NoisePicture(64)), 300);
  TransferScratch scratch;
  Picture out;
  TransferOptions options;
  std::vector<double> shares;
  options.threads = 1;
  options.progress = [&](double share) { return shares.push_back(share), true; };
  ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, out).ok());
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_NEAR(shares.back(), 1.0, 1e-9);
  options.progress = [&](double share) { return share < 0.3; };
  const Status stopped = Transfer(*prepared, guides, options, scratch, out);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
}

TEST(Prepare, IsCancelledBetweenAnyTwoSteps) {
  Style style = PlainStyle(NoisePicture(64));
  style.transfer.hybrid = 4.0;
  style.transfer.shadow = ShadowMode::kPaint;
  style.transfer.edge = EdgeMode::kExemplar;
  const auto prepare = [&](int steps) {
    PrepareOptions options;
    options.is_cancelled = [&steps] { return steps-- == 0; };
    return Prepare(style, 64, options);
  };
  int steps = 0;
  for (; steps < 100; ++steps) {
    const auto prepared = prepare(steps);
    if (prepared.ok()) break;
    EXPECT_EQ(prepared.error().kind, ErrorKind::kCancelled) << prepared.error().message;
  }
  EXPECT_GE(steps, 6);
  EXPECT_LT(steps, 100);
}

}  // namespace
}  // namespace scumble
