// A frame begins with any content from the previous one, and must not show it.
#include "transfer/frame/frame_setup.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

constexpr int kFrameWidth = 151, kFrameHeight = 97;

// Hills with holes; coverage as hard or soft as asked for, NaN in places.
GuideSet HoledGuides(bool soft) {
  GuideSet guides = HillGuides(kFrameWidth, kFrameHeight);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const int x = int(i) % kFrameWidth, y = int(i) / kFrameWidth;
    float& coverage = guides.Plane(Layer::kCoverage)[i];
    if (Hash(x / 40, y / 20, 1) % 3 == 0) coverage = 0.0f;
    if (soft && coverage > 0.0f && Hash(x, y, 2) % 5 == 0) coverage = 0.37f;
  }
  return guides;
}

StyleMap StripedMap(int styles) {
  StyleMap map{std::vector<std::uint16_t>(std::size_t(kFrameWidth) * kFrameHeight)};
  for (std::size_t i = 0; i < map.style.size(); ++i) {
    const int x = int(i) % kFrameWidth, y = int(i) / kFrameWidth;
    const std::uint64_t piece = Hash(x / 17, y / 13) % (std::uint64_t(styles) + 2);
    map.style[i] = piece < std::uint64_t(styles)    ? static_cast<std::uint16_t>(piece)
                   : piece == std::uint64_t(styles) ? StyleMap::kPassThrough
                                                    : StyleMap::kShadowCatcher;
  }
  return map;
}

// What no transfer leaves anywhere.
void Spoil(TransferScratch& scratch, Picture& out) {
  scratch.field.Reset(kFrameWidth, kFrameHeight);
  for (std::size_t i = 0; i < scratch.field.x.size(); ++i) scratch.field.Set(i, 31000, 31000, 200, 5);
  scratch.field.guide_offset.assign(scratch.field.x.size(), glm::vec3(3.0f));
  scratch.active.assign(scratch.field.x.size(), 1);
  out = Picture(kFrameWidth, kFrameHeight);
  std::fill(out.rgba.begin(), out.rgba.end(), std::uint16_t{4711});
}

TEST(FrameSetup, NothingOfTheFrameBeforeIsLeft) {
  Style first = PlainStyle(NoisePicture(96)), second = PlainStyle(PositionPicture(80)),
        third = PlainStyle(NoisePicture(64));
  third.transfer.method = Method::kLitSphere;
  const Picture under = NoisePicture(200);
  Picture over(kFrameWidth, kFrameHeight);
  for (std::size_t i = 0; i < over.rgba.size(); ++i) over.rgba[i] = under.rgba[i % under.rgba.size()];
  for (const bool soft : {false, true}) {
    const GuideSet guides = HoledGuides(soft);
    for (const Method method : {Method::kStyleBlit, Method::kBruteForce}) {
      first.transfer.method = method;
      std::vector<PreparedStyle> prepared;
      for (const Style* style : {&first, &second, &third})
        prepared.push_back(std::move(*Prepare(*style, kFrameHeight)));
      const PreparedStyle* const styles[] = {&prepared[0], &prepared[1], &prepared[2]};
      const StyleMap map = StripedMap(3);
      for (const Picture* background : {static_cast<const Picture*>(nullptr), static_cast<const Picture*>(&over)}) {
        for (const bool mapped : {false, true}) {
          TransferOptions options;
          options.over = background;
          options.keep_field = true;
          const auto run = [&](TransferScratch& scratch, Picture& out) {
            const Status done = mapped ? Transfer(styles, map, guides, options, scratch, out)
                                       : Transfer(prepared[0], guides, options, scratch, out);
            EXPECT_TRUE(done.ok());
          };
          TransferScratch fresh, spoilt;
          Picture clean, used;
          run(fresh, clean);
          Spoil(spoilt, used);
          run(spoilt, used);
          EXPECT_EQ(used.rgba, clean.rgba) << soft << mapped;
          EXPECT_TRUE(SameField(spoilt.field, fresh.field)) << soft << mapped;
          EXPECT_EQ(spoilt.active, fresh.active);

          // A region changes only its own pixels; the field has no source for unmatched pixels.
          options.region = Region{17, 9, 130, 70};
          Spoil(spoilt, used);
          run(spoilt, used);
          for (int y = 0; y < kFrameHeight; ++y) {
            for (int x = 0; x < kFrameWidth; ++x) {
              const bool inside = x >= 17 && x < 130 && y >= 9 && y < 70;
              ASSERT_EQ(used.At(x, y)[1], inside ? clean.At(x, y)[1] : 4711) << x << ", " << y;
              const std::size_t i = guides.Index(x, y);
              if (inside) {
                ASSERT_EQ(spoilt.field.level[i], fresh.field.level[i]);
              }
              ASSERT_NE(spoilt.field.x[i], 31000);
            }
          }
        }
      }
    }
  }
}

TEST(FrameSetup, TilesAndExtentsHoldEachStylesPixels) {
  const GuideSet guides = HoledGuides(false);
  const StyleMap map = StripedMap(12);
  SourceField field;
  std::vector<std::uint8_t> active;
  Picture out;
  const internal::FrameInput input{guides, &map, 12, {0, 0, kFrameWidth, kFrameHeight}};
  const internal::FrameSetup start = internal::StartFrame(input, field, active, out);
  EXPECT_FALSE(start.softly_covered);
  EXPECT_EQ(active, std::vector<std::uint8_t>(guides.pixel_count(), 0));
  for (int s = 0; s < 12; ++s) {
    std::vector<std::uint8_t> expected(guides.pixel_count());
    Region extent{kFrameWidth, kFrameHeight, 0, 0};
    for (int y = 0; y < kFrameHeight; ++y) {
      for (int x = 0; x < kFrameWidth; ++x) {
        const std::size_t i = guides.Index(x, y);
        expected[i] = guides.Plane(Layer::kCoverage)[i] > 0.0f && map.style[i] == s;
        if (expected[i]) {
          extent = {std::min(extent.x0, x), std::min(extent.y0, y), std::max(extent.x1, x + 1),
                    std::max(extent.y1, y + 1)};
        }
      }
    }
    internal::Activate(input, s, start.tiles[std::size_t(s)], active);
    EXPECT_EQ(active, expected) << s;
    internal::Deactivate(input, start.tiles[std::size_t(s)], active);
    EXPECT_EQ(active, std::vector<std::uint8_t>(guides.pixel_count(), 0));
    const Region& found = start.extents[std::size_t(s)];
    EXPECT_EQ(found.empty(), extent.empty()) << s;
    if (extent.empty()) continue;
    EXPECT_TRUE(found.x0 == extent.x0 && found.y0 == extent.y0 && found.x1 == extent.x1 && found.y1 == extent.y1) << s;
  }
  EXPECT_TRUE(internal::StartFrame({HoledGuides(true), &map, 12, {0, 0, kFrameWidth, kFrameHeight}}, field, active, out)
                  .softly_covered);
}

}  // namespace
}  // namespace scumble
