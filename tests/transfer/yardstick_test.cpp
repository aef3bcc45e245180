// The bench's reference must be the same algorithm: the yardstick's picture is the engine's, bit for bit.
#include "bench/performance/yardstick.h"

#include "tests/support/transfer_fixtures.h"

namespace scumble::bench {
namespace {

struct Painted {
  Picture picture;
  std::vector<YardstickSource> sources;
};

Painted PaintByYardstick(const GuideSet& guides, const PreparedStyle& style, std::int64_t time_step,
                         std::uint64_t seed) {
  const YardstickExemplar exemplar{style.exemplar->size(), style.settings.rim, style.exemplar->picture().rgba.data()};
  Yardstick yardstick(guides.width(), guides.height(), exemplar, {style.levels, style.settings.threshold, seed});
  yardstick.RenewJitter(time_step);
  Painted painted{Picture(guides.width(), guides.height()), {}};
  // A picture that was there before must not show through.
  std::fill(painted.picture.rgba.begin(), painted.picture.rgba.end(), std::uint16_t{777});
  yardstick.Paint(
      {guides.width(), guides.height(), guides.Plane(Layer::kCoverage).data(), guides.Plane(Layer::kNormal, 0).data(),
       guides.Plane(Layer::kNormal, 1).data(), guides.Plane(Layer::kNormal, 2).data()},
      painted.picture.rgba.data());
  painted.sources = yardstick.sources();
  return painted;
}

void ExpectSame(const GuideSet& guides, Style style, std::int64_t frame = 0, std::uint64_t seed = 0) {
  style.transfer.edge_aware = false;
  style.transfer.jitter_fps = -1.0;
  const auto prepared = Prepare(style, guides.height());
  ASSERT_TRUE(prepared.ok());
  TransferOptions options;
  options.frame = frame, options.seed = seed;
  options.keep_field = true;
  TransferScratch scratch;
  Picture picture;
  ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, picture).ok());
  const Painted yardstick = PaintByYardstick(guides, *prepared, frame, seed);
  EXPECT_EQ(yardstick.picture.rgba, picture.rgba);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) {
      EXPECT_EQ(yardstick.sources[i].x, YardstickSource::kNoSource);
      continue;
    }
    ASSERT_EQ(yardstick.sources[i].x, scratch.field.x[i]) << "pixel " << i;
    ASSERT_EQ(yardstick.sources[i].y, scratch.field.y[i]) << "pixel " << i;
  }
}

TEST(Yardstick, PaintsTheEnginesPicture) {
  ExpectSame(testing::HillGuides(150, 97), testing::PlainStyle(testing::NoisePicture(128)));
}

TEST(Yardstick, RenewsItsJitterAsTheEngineDoes) {
  const Style style = testing::PlainStyle(testing::NoisePicture(96));
  ExpectSame(testing::HillGuides(80, 70), style, 11);
  ExpectSame(testing::HillGuides(80, 70), style, 11, 5);
}

// Where hardly any level accepts, sources are the pixels' own, and normals that face away lie on the rim.
TEST(Yardstick, AgreesOnNormalsThatHaveNothingInCommon) {
  const GuideSet any = testing::MakeGuides(64, 48, [](int x, int y) {
    return Hash(x, y, 1) % 5 == 0 ? glm::vec3(0.0f) : testing::AnyDirection(Hash(x, y));
  });
  for (const float threshold : {0.0f, 0.125f, 0.9f}) {
    Style style = testing::PlainStyle(testing::NoisePicture(40));
    style.transfer.threshold = threshold;
    ExpectSame(any, style);
  }
}

TEST(Yardstick, AgreesOnTheSmallestPictures) {
  for (const int size : {1, 2, 3, 7}) {
    Style style = testing::PlainStyle(testing::NoisePicture(16));
    style.transfer.levels = size;
    ExpectSame(testing::SphereGuides(size), style);
    ExpectSame(testing::MakeGuides(size, 1, [](int, int) { return glm::vec3(0.0f, 0.0f, -1.0f); }), style);
  }
}

TEST(Yardstick, WeighsCoverage) {
  GuideSet guides = testing::SphereGuides(33);
  for (float& a : guides.Plane(Layer::kCoverage)) a *= 0.3f;
  ExpectSame(guides, testing::PlainStyle(testing::NoisePicture(64)));
}

}  // namespace
}  // namespace scumble::bench
