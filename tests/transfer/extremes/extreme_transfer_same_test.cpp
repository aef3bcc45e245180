// Equal bytes at the ends of every scale: with 1, 2, 3 and 7 threads, with every set of vector instructions, by bands
// of rows and through a field, whole and in parts. The reference is one thread with the least instructions.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/every_instruction_set.h"
#include "tests/support/numbers.h"
#include "tests/support/plain_engine.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

// Every layer that a transfer may read, on hills with a hole.
GuideSet Guides(int width, int height) {
  GuideSet guides = HillGuides(width, height);
  for (const Layer layer : {Layer::kLuminance, Layer::kAlbedo, Layer::kPref}) {
    guides.Add(layer);
    for (int c = 0; c < ChannelCount(layer); ++c) {
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        guides.Plane(layer, c)[i] = layer == Layer::kPref ? 0.01f * static_cast<float>(c == 0 ? i % width : i / width)
                                                          : 2.0f * UnitFloat(Hash(int(layer), c, i / 7));
      }
    }
  }
  return guides;
}

// The same with NaN and infinity at some covered pixels: through the public call, which accepts guides without a file.
GuideSet OddGuides(int width, int height) {
  GuideSet guides = Guides(width, height);
  const float odd[] = {-1.0f, kNan, kInfinity, -kInfinity, 65504.0f, 65520.0f, 1e38f, kDenormal, -0.0f};
  for (const Layer layer :
       {Layer::kLuminance, Layer::kAlbedo, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kPref}) {
    for (int c = 0; c < ChannelCount(layer); ++c) {
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        if (Hash(int(layer), c, i, 9) % 11 == 0)
          guides.Plane(layer, c)[i] = odd[Hash(i, c, int(layer)) % std::size(odd)];
      }
    }
  }
  return guides;
}

struct Extreme {
  std::string name;
  Style style;
  std::uint64_t seed = 3;
  int reached = 0;  // the level that settles a pixel at the least by this seed; 0: whichever does
};

Style Base() {
  Style style = PlainStyle(NoisePicture(64));
  style.transfer.levels = 6;
  return style;
}

Style Lit(float weight, LuminanceError form) {
  Style style = Base();
  for (const double luminance : {0.8, 0.15, 0.4}) {
    style.exemplars.push_back(style.exemplars[0]);
    style.exemplars.back().luminance = luminance;
  }
  style.exemplars[0].luminance = 0.1;
  style.transfer.luminance_weight = weight, style.transfer.luminance_error = form;
  return style;
}

std::vector<Extreme> Extremes(const GuideSet& guides) {
  std::vector<Extreme> all;
  const auto add = [&](const std::string& name, Style style) { all.push_back({name, std::move(style)}); };
  for (const float threshold : {0.0f, kDenormal, 1e-20f, 1e30f, kInfinity}) {
    for (const ThresholdMetric metric : {ThresholdMetric::kL2, ThresholdMetric::kL1}) {
      Style style = Base();
      style.transfer.threshold = threshold, style.transfer.threshold_metric = metric;
      add("threshold " + std::to_string(threshold), style);
    }
  }
  for (const int levels : {1, 2, 15, 16}) {
    Style style = Base();
    style.transfer.levels = levels;
    add("levels " + std::to_string(levels), style);
    // The coarsest seed is in the picture, and its candidate is accepted at any distance. In rows and single pixels
    // there is hardly one.
    if (levels < 3 || guides.height() == 1 || guides.width() == 1) continue;
    all.back().style.transfer.threshold = kInfinity;
    all.back().reached = levels - 1, all.back().seed = SeedThatReaches(levels - 1, guides);
  }
  for (const int radius : {0, 3, 4, 64}) {
    Style style = Base();
    style.transfer.blend_radius = radius;
    add("radius " + std::to_string(radius), style);
  }
  for (const float weight : {0.0f, kDenormal, 1e9f, std::numeric_limits<float>::max(), kInfinity}) {
    for (const LuminanceError form : {LuminanceError::kExcess, LuminanceError::kPublished}) {
      add("weight " + std::to_string(weight), Lit(weight, form));
    }
  }
  Style tiny = Lit(1e-22f, LuminanceError::kExcess);
  tiny.transfer.threshold = 1e-21f;
  add("what light leaves of a tiny threshold", tiny);
  Style both = Lit(kInfinity, LuminanceError::kExcess);
  both.transfer.threshold = kInfinity;
  add("both infinite", both);
  for (const ColorizeMode mode : {ColorizeMode::kMultiply, ColorizeMode::kOklab}) {
    Style tinted = Base();
    tinted.transfer.colorize = 1.0, tinted.transfer.colorize_mode = mode;
    add("tinted", tinted);
  }
  Style pixel = PlainStyle(NoisePicture(1));
  pixel.transfer.blend_radius = 64;
  add("an exemplar of one pixel", pixel);
  Style free = Base();
  free.transfer.variety = 90.0;
  add("variety 90", free);
  return all;
}

struct Job {
  const PreparedStyle& prepared;
  const GuideSet& guides;
  std::uint64_t seed = 3;
};

Transferred WithField(const Job& job, int threads) {
  TransferOptions options;
  options.threads = threads, options.keep_field = true, options.seed = job.seed;
  TransferScratch scratch;
  Transferred result;
  EXPECT_TRUE(Transfer(job.prepared, job.guides, options, scratch, result.picture).ok());
  result.field = std::move(scratch.field);
  return result;
}

Picture Painted(const Job& job, int threads) {
  TransferOptions options;
  options.threads = threads, options.seed = job.seed;
  TransferScratch scratch;
  Picture picture;
  EXPECT_TRUE(Transfer(job.prepared, job.guides, options, scratch, picture).ok());
  return picture;
}

Picture InPieces(const Job& job, int width, int height) {
  const GuideSet& guides = job.guides;
  TransferOptions options;
  options.seed = job.seed;
  TransferScratch scratch;
  Picture picture;
  for (int y = 0; y < guides.height(); y += height) {
    for (int x = 0; x < guides.width(); x += width) {
      options.region = Region{x, y, x + width, y + height};
      EXPECT_TRUE(Transfer(job.prepared, guides, options, scratch, picture).ok());
    }
  }
  return picture;
}

void ExpectTheSame(const GuideSet& guides, const std::string& where) {
  // oneTBB has no workers beyond the machine's cores unless the limit is raised.
  const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 7);
  for (const Extreme& extreme : Extremes(guides)) {
    const auto prepared = Prepare(extreme.style, guides.height());
    ASSERT_TRUE(prepared.ok()) << extreme.name << ": " << (prepared.ok() ? "" : prepared.error().message);
    const Job job{*prepared, guides, extreme.seed};
    Transferred least;
    OnTheLeastInstructionSet([&] { least = WithField(job, 1); });
    const std::vector<std::uint16_t>& plain = least.picture.rgba;
    const std::vector<std::int8_t>& levels = least.field.level;
    if (extreme.reached > 0) {
      EXPECT_EQ(*std::max_element(levels.begin(), levels.end()), extreme.reached) << where << ", " << extreme.name;
    }
    const auto expect = [&](const Picture& picture, const std::string& how) {
      EXPECT_TRUE(picture.rgba == plain) << where << ", " << extreme.name << ", " << how;
    };
    OnEveryInstructionSet([&] {
      expect(Painted(job, 1), "bands");
      expect(WithField(job, 2).picture, "a field");
    });
    for (const int threads : {2, 3, 7}) {
      expect(Painted(job, threads), std::to_string(threads) + " threads, bands");
      expect(WithField(job, threads).picture, std::to_string(threads) + " threads, a field");
    }
    expect(InPieces(job, 47, 29), "in pieces");
  }
}

TEST(ExtremeSame, OnHills) { ExpectTheSame(Guides(99, 50), "hills"); }
TEST(ExtremeSame, OnNumbersThatAreNone) { ExpectTheSame(OddGuides(91, 44), "odd"); }
TEST(ExtremeSame, OnOnePixel) { ExpectTheSame(OddGuides(1, 1), "1×1"); }
TEST(ExtremeSame, OnARow) { ExpectTheSame(OddGuides(530, 1), "a row"); }
TEST(ExtremeSame, OnAColumn) { ExpectTheSame(OddGuides(1, 140), "a column"); }

// Sources of a style that weighs light are found in a tree of more dimensions.
Style Weighed(float weight) {
  Style style = Base();
  GuideSet guides = SphereGuides(64);
  guides.Add(Layer::kLuminance);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kLuminance)[i] = UnitFloat(Hash(i, 5));
  style.exemplars[0].guides = std::move(guides);
  style.transfer.guide_weights[Layer::kLuminance] = weight;
  return style;
}

// Methods whose matching has one form for all instruction sets, but for the tree; all have fast votes.
TEST(ExtremeSame, OtherWaysToMatch) {
  const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 7);
  const GuideSet guides = OddGuides(90, 60);
  for (const int way : {0, 1, 2, 3, 4, 5, 6, 7}) {
    Style style = way < 5 ? Lit(1e9f, LuminanceError::kExcess) : Weighed(way == 5 ? 1e-20f : way == 6 ? 1.0f : 1e9f);
    style.transfer.threshold = way % 2 ? 1e30f : kDenormal;
    if (way == 0) style.transfer.method = Method::kLitSphere;
    if (way == 1) style.transfer.coherent = true;
    if (way == 2) style.transfer.match_step = 8;
    if (way == 3) style.transfer.hybrid = 1e6;
    if (way == 4) style.transfer.hybrid = kInfinity, style.transfer.blend_radius = 64;
    if (way == 6) style.transfer.method = Method::kLitSphere;
    const auto prepared = Prepare(style, guides.height());
    ASSERT_TRUE(prepared.ok()) << way;
    const Job job{*prepared, guides};
    const Picture one = Painted(job, 1);
    OnEveryInstructionSet([&] { EXPECT_TRUE(Painted(job, 1).rgba == one.rgba) << way; });
    for (const int threads : {2, 3, 7}) EXPECT_TRUE(Painted(job, threads).rgba == one.rgba) << way;
    EXPECT_TRUE(InPieces(job, 41, 23).rgba == one.rgba) << way;
  }
}

}  // namespace
}  // namespace scumble
