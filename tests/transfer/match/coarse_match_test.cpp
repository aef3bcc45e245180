// Matching some pixels and upsampling to the others, against the rule pixel by pixel.
#include <limits>
#include <optional>
#include <vector>

#include "tests/support/transfer_fixtures.h"
#include "transfer/nearest/guide_distance.h"

namespace scumble {
namespace {

using namespace testing;

// Hills, a wire one pixel wide across the hole in them, a second object, and light from one side.
GuideSet ThinGuides(int width, int height) {
  GuideSet guides = HillGuides(width, height);
  guides.Add(Layer::kLuminance);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      const bool wire = y == height / 2 || x == width / 3;
      if (wire) {
        const glm::vec3 n = glm::normalize(glm::vec3(-0.6f, 0.5f, 0.4f));
        for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = n[c];
        guides.Plane(Layer::kCoverage)[i] = 0.3f;
        guides.Plane(Layer::kDepth)[i] = 5.0f;
        guides.Plane(Layer::kObject)[i] = 2.0f;
      }
      guides.Plane(Layer::kLuminance)[i] = x > width / 2 ? 0.1f : 0.9f;
    }
  }
  return guides;
}

Style TwoLights(int size) {
  Style style = PlainStyle(NoisePicture(size));
  style.exemplars[0].luminance = 0.8;
  style.exemplars.push_back({"dark.png", PositionPicture(size), 0.1});
  return style;
}

// ---- The rule, from its words ---------------------------------------------------------------------------------------

struct Stand {
  int x, y;
};

// The active pixel of a block nearest its centre.
std::optional<Stand> StandOf(const GuideSet& guides, int column, int row, int step) {
  std::optional<Stand> best;
  double least = std::numeric_limits<double>::infinity();
  for (int y = row * step; y < std::min((row + 1) * step, guides.height()); ++y) {
    for (int x = column * step; x < std::min((column + 1) * step, guides.width()); ++x) {
      if (x < 0 || y < 0 || !(guides.Plane(Layer::kCoverage)[guides.Index(x, y)] > 0.0f)) continue;
      const double dx = x + 0.5 - (column + 0.5) * step, dy = y + 0.5 - (row + 0.5) * step;
      if (dx * dx + dy * dy < least) least = dx * dx + dy * dy, best = Stand{x, y};
    }
  }
  return best;
}

// `full` is matched pixel by pixel; a pixel that stands for a block is matched as it is there, but for grids of seeds
// that are not coarser than the blocks.
SourceField FieldByTheRule(const Style& style, const GuideSet& guides, const SourceField& full, int step) {
  const auto prepared = Prepare(style, guides.height());
  const PreparedExemplar& exemplar = *prepared->exemplar;
  const GuideTest test(style.transfer.threshold, style.transfer.threshold_metric);
  SourceField field;
  field.Reset(guides.width(), guides.height());
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t p = guides.Index(x, y);
      if (!(guides.Plane(Layer::kCoverage)[p] > 0.0f)) continue;
      const glm::vec3 guide = guides.Vec3(Layer::kNormal, p);
      const float light = guides.Plane(Layer::kLuminance)[p];
      // Blocks whose centres are less than a step away, by column and by row; the own one first.
      std::vector<std::pair<int, int>> blocks{{y / step, x / step}};
      for (int row = -1; row <= guides.height() / step; ++row) {
        for (int column = -1; column <= guides.width() / step; ++column) {
          const double dx = (column + 0.5) * step - (x + 0.5), dy = (row + 0.5) * step - (y + 0.5);
          if (!(dx > -step && dx <= step && dy > -step && dy <= step)) continue;
          if (row != y / step || column != x / step) blocks.push_back({row, column});
        }
      }
      std::optional<Source> best;
      int best_level = -1, best_exemplar = 0;
      float best_error = 0.0f;
      for (const auto& [row, column] : blocks) {
        const auto stand = StandOf(guides, column, row, step);
        if (!stand) continue;
        const std::size_t q = guides.Index(stand->x, stand->y);
        Source own{full.x[q], full.y[q]};
        int level = full.level[q], of = full.exemplar[q];
        if (level > 0 && 1 << level <= step) {
          own = exemplar.NearestNeighbour(guides.Vec3(Layer::kNormal, q)), level = 0;
          of = prepared->illumination.Choose(guides.Plane(Layer::kLuminance)[q]);
        }
        const Source source{own.x + x - stand->x, own.y + y - stand->y};
        if (!exemplar.Usable(source.x, source.y)) continue;
        const float extra = prepared->illumination.Error(light, of);
        const glm::vec3 there = exemplar.Normal(source.x, source.y);
        if (!test.Alike(guide, there, extra)) continue;
        const float error = glm::length(guide - there) + extra;
        if (best && (level < best_level || (level == best_level && error >= best_error - 1e-6f))) continue;
        best = source, best_level = level, best_exemplar = of, best_error = error;
      }
      if (!best)
        best = exemplar.NearestNeighbour(guide), best_level = 0, best_exemplar = prepared->illumination.Choose(light);
      field.Set(p, best->x, best->y, best_exemplar, best_level);
    }
  }
  return field;
}

TEST(MatchStep, IsTheRulePixelByPixel) {
  const GuideSet guides = ThinGuides(83, 61);
  for (const Method method : {Method::kStyleBlit, Method::kLitSphere}) {
    Style style = TwoLights(90);
    style.transfer.method = method;
    const SourceField full = MustTransfer(style, guides).field;
    for (const int step : {2, 3, 4, 8}) {
      style.transfer.match_step = step;
      const SourceField field = MustTransfer(style, guides).field;
      const SourceField expected = FieldByTheRule(style, guides, full, step);
      std::size_t differ = 0, changed = 0;
      for (std::size_t i = 0; i < field.x.size(); ++i) {
        ASSERT_EQ(field.level[i] == SourceField::kNoSource, full.level[i] == SourceField::kNoSource);
        // Two sources whose errors are equal but for the rounding of the reference may change places.
        differ += field.x[i] != expected.x[i] || field.y[i] != expected.y[i] || field.level[i] != expected.level[i] ||
                  field.exemplar[i] != expected.exemplar[i];
        changed += field.x[i] != full.x[i] || field.y[i] != full.y[i];
      }
      EXPECT_LE(differ, 3u) << "step " << step;
      EXPECT_GT(changed, 100u) << "step " << step << ": or nothing was tested";
    }
  }
}

TEST(MatchStep, OneIsThePlainEngine) {
  const GuideSet guides = ThinGuides(70, 50);
  Style style = TwoLights(64);
  const Transferred plain = MustTransfer(style, guides);
  style.transfer.match_step = 1;
  const Transferred one = MustTransfer(style, guides);
  EXPECT_EQ(one.picture.rgba, plain.picture.rgba);
  EXPECT_TRUE(SameField(one.field, plain.field));
}

double SameSources(const SourceField& a, const SourceField& b) {
  double same = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    if (a.level[i] == SourceField::kNoSource) continue;
    count += 1.0;
    same += a.x[i] == b.x[i] && a.y[i] == b.y[i] && a.exemplar[i] == b.exemplar[i];
  }
  return same / count;
}

TEST(MatchStep, MostPixelsKeepTheirSource) {
  const GuideSet guides = HillGuides(300, 240);
  Style style = PlainStyle(NoisePicture(300));
  const SourceField full = MustTransfer(style, guides).field;
  double before = 1.0;
  for (const int step : {2, 4, 8}) {
    style.transfer.match_step = step;
    const double same = SameSources(full, MustTransfer(style, guides).field);
    EXPECT_LT(same, before) << step;
    EXPECT_GT(same, step == 2 ? 0.8 : 0.5) << step;
    before = same;
  }
}

// A seed with another source by variety is compared with the guide of that source, by pixels in between too. (The
// borders of chunks follow the paint there, pixel by pixel, which matching one pixel of sixteen cannot.)
TEST(MatchStep, KnowsWhatVarietyMoved) {
  const GuideSet guides = MakeGuides(200, 160, [](int, int) { return glm::normalize(glm::vec3(0.2f, 0.1f, 1.0f)); });
  Style style = PlainStyle(NoisePicture(300));
  style.transfer.variety = 30.0;
  const SourceField full = MustTransfer(style, guides).field;
  style.transfer.match_step = 4;
  EXPECT_GT(SameSources(full, MustTransfer(style, guides).field), 0.85);
}

TEST(MatchStep, SeedsOnTheSurfaceAreTheSameForAll) {
  GuideSet guides = HillGuides(200, 160);
  guides.Add(Layer::kPref);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kPref, 0)[i] = 0.01f * static_cast<float>(i % 200);
    guides.Plane(Layer::kPref, 1)[i] = -0.01f * static_cast<float>(i / 200);
  }
  Style style = PlainStyle(NoisePicture(300));
  style.transfer.coherent = true;
  const SourceField full = MustTransfer(style, guides).field;
  style.transfer.match_step = 2;
  const Transferred coarse = MustTransfer(style, guides);
  EXPECT_GT(SameSources(full, coarse.field), 0.8);
  const auto prepared = Prepare(style, 160);
  ASSERT_TRUE(prepared.ok());
  Picture tiled;
  TransferScratch scratch;
  TransferOptions options;
  for (int y = 0; y < 160; y += 53) {
    options.region = Region{0, y, 200, y + 53};
    ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, tiled).ok());
  }
  EXPECT_EQ(tiled.rgba, coarse.picture.rgba);
}

TEST(MatchStep, AnySizeOfPictureWillDo) {
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{{1, 1}, {1, 9}, {7, 1}, {2, 3}, {9, 8}}) {
    const GuideSet guides = MakeGuides(
        width, height, [](int x, int y) { return glm::normalize(glm::vec3(0.1f * x - 0.3f, 0.2f - 0.05f * y, 1.0f)); });
    for (const Method method : {Method::kStyleBlit, Method::kLitSphere, Method::kBruteForce}) {
      Style style = PlainStyle(NoisePicture(16));
      style.transfer.method = method;
      style.transfer.match_step = 8;
      const Transferred result = MustTransfer(style, guides);
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        EXPECT_NE(result.field.level[i], SourceField::kNoSource);
        EXPECT_EQ(result.picture.rgba[4 * i + 3], 65535);
      }
    }
  }
}

TEST(MatchStep, ThreadsRegionsAndOtherStylesDoNotChangeAByte) {
  const GuideSet guides = ThinGuides(131, 97);
  StyleMap map{std::vector<std::uint16_t>(guides.pixel_count())};
  for (std::size_t i = 0; i < map.style.size(); ++i) {
    const bool leave = i % 131 > 120;
    map.style[i] = leave ? StyleMap::kPassThrough : guides.Plane(Layer::kObject)[i] == 2.0f;
  }
  for (const int step : {2, 5, 8}) {
    Style first = TwoLights(120), second = PlainStyle(PositionPicture(60));
    first.transfer.match_step = step, first.transfer.blend_radius = 3, first.transfer.variety = 15.0;
    first.transfer.hybrid = 6.0;
    second.transfer.match_step = step, second.transfer.method = Method::kLitSphere;
    const auto a = Prepare(first, 97), b = Prepare(second, 97);
    ASSERT_TRUE(a.ok() && b.ok());
    const PreparedStyle* const styles[] = {&*a, &*b};
    TransferOptions options;
    TransferScratch scratch;
    options.threads = 1;
    Picture whole, other, tiled;
    ASSERT_TRUE(Transfer(styles, map, guides, options, scratch, whole).ok());
    options.threads = 3;
    ASSERT_TRUE(Transfer(styles, map, guides, options, scratch, other).ok());
    EXPECT_EQ(other.rgba, whole.rgba) << step;
    for (int y = 0; y < 97; y += 21) {
      for (int x = 0; x < 131; x += 29) {
        options.region = Region{x, y, x + 29, y + 21};
        ASSERT_TRUE(Transfer(styles, map, guides, options, scratch, tiled).ok());
      }
    }
    EXPECT_EQ(tiled.rgba, whole.rgba) << step;
  }
}

TEST(MatchStep, IsRefusedOutOfRange) {
  Style style = PlainStyle(NoisePicture(32));
  for (const int bad : {0, -2, 9}) {
    style.transfer.match_step = bad;
    const auto prepared = Prepare(style, 32);
    ASSERT_FALSE(prepared.ok());
    EXPECT_NE(prepared.error().message.find("transfer.match_step"), std::string::npos);
  }
}

}  // namespace
}  // namespace scumble
