// Voting, edges, and nothing from outside the painted disc.
#include <limits>

#include "tests/transfer_fixtures.h"
#include "transfer/resample.h"

namespace scumble {
namespace {

using namespace testing;

TEST(Vote, IsAPlainCopyInsideAChunk) {
  const GuideSet guides = MakeGuides(50, 40, [](int, int) { return glm::vec3(0, 0, 1); });
  Style style = PlainStyle(NoisePicture(200));
  style.transfer.levels = 12;  // cells far larger than the picture: one seed or none serves all pixels
  style.transfer.threshold = 2.0f;
  for (const int radius : {0, 1, 3, 8}) {
    style.transfer.blend_radius = radius;
    const Transferred result = MustTransfer(style, guides);
    int copies = 0;
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 50; ++x) {
        bool uniform = true;
        const std::size_t i = result.field.Index(x, y);
        for (int v = std::max(0, y - radius); v <= std::min(39, y + radius); ++v) {
          for (int u = std::max(0, x - radius); u <= std::min(49, x + radius); ++u) {
            const std::size_t q = result.field.Index(u, v);
            uniform &= result.field.x[q] - u == result.field.x[i] - x && result.field.y[q] - v == result.field.y[i] - y;
          }
        }
        if (!uniform) continue;
        ++copies;
        ASSERT_EQ(result.picture.At(x, y)[0], style.exemplars[0].picture.At(result.field.x[i], result.field.y[i])[0]);
      }
    }
    EXPECT_GT(copies, 300) << "radius " << radius;
  }
}

// The definition, pixel by pixel, against the engine on a picture full of chunk borders.
TEST(Vote, IsTheRoundedMeanOfTheNeighboursOffers) {
  const GuideSet guides = HillGuides(70, 60);
  Style style = PlainStyle(NoisePicture(90));
  style.transfer.edge_aware = false;
  for (const int radius : {1, 2, 5}) {
    style.transfer.blend_radius = radius;
    const Transferred result = MustTransfer(style, guides);
    const auto prepared = Prepare(style, 60);
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 70; ++x) {
        if (result.field.level[result.field.Index(x, y)] == SourceField::kNoSource) continue;
        std::uint64_t sum = 0, count = 0;
        for (int v = y - radius; v <= y + radius; ++v) {
          for (int u = x - radius; u <= x + radius; ++u) {
            if (u < 0 || v < 0 || u >= 70 || v >= 60) continue;
            const std::size_t q = result.field.Index(u, v);
            if (result.field.level[q] == SourceField::kNoSource) continue;
            const int sx = result.field.x[q] + x - u, sy = result.field.y[q] + y - v;
            if (!prepared->exemplar->Usable(sx, sy)) continue;
            sum += prepared->exemplar->picture().At(sx, sy)[0], ++count;
          }
        }
        ASSERT_GT(count, 0u);
        ASSERT_EQ(result.picture.At(x, y)[0], (2 * sum + count) / (2 * count)) << x << ", " << y;
      }
    }
  }
}

// Left half and right half take their paint from opposite sides of an exemplar that is black on one side and white on
// the other: any grey is a vote that crossed the edge.
GuideSet TwoHalves() {
  return MakeGuides(64, 32, [](int x, int) {
    return x < 32 ? glm::normalize(glm::vec3(-0.4f, 0, 1)) : glm::normalize(glm::vec3(0.4f, 0, 1));
  });
}

Picture BlackAndWhite(int size) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = x < size / 2 ? 0 : 65535, texel[3] = 65535;
    }
  }
  return picture;
}

std::size_t GreyPixels(const Picture& picture) {
  std::size_t grey = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) grey += picture.rgba[i] > 0 && picture.rgba[i] < 65535;
  return grey;
}

TEST(EdgeAware, VotesDoNotCrossObjectBorders) {
  GuideSet guides = TwoHalves();
  for (int y = 0; y < 32; ++y) {
    for (int x = 32; x < 64; ++x) guides.Plane(Layer::kObject)[guides.Index(x, y)] = 2.0f;
  }
  Style style = PlainStyle(BlackAndWhite(128));
  for (const int radius : {1, 4, 8}) {
    style.transfer.blend_radius = radius;
    style.transfer.edge_aware = true;
    EXPECT_EQ(GreyPixels(MustTransfer(style, guides).picture), 0u);
    style.transfer.edge_aware = false;
    EXPECT_EQ(GreyPixels(MustTransfer(style, guides).picture), 2u * radius * 32u) << "plain voting mixes, as it should";
  }
}

TEST(EdgeAware, VotesDoNotCrossDepthStepsNearOrFar) {
  for (const float distance : {0.1f, 10.0f, 10000.0f}) {
    GuideSet guides = TwoHalves();
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      guides.Plane(Layer::kDepth)[i] = distance * (i % 64 < 32 ? 1.0f : 1.2f);
    }
    Style style = PlainStyle(BlackAndWhite(128));
    style.transfer.blend_radius = 4;
    EXPECT_EQ(GreyPixels(MustTransfer(style, guides).picture), 0u) << distance;
  }
}

TEST(EdgeAware, VotesDoNotCrossCreasesButDoCrossSlopes) {
  Style style = PlainStyle(BlackAndWhite(128));
  style.transfer.blend_radius = 2;
  const GuideSet crease = MakeGuides(64, 32, [](int x, int) {
    return x < 32 ? glm::normalize(glm::vec3(-0.9f, 0, 0.4f)) : glm::normalize(glm::vec3(0.9f, 0, 0.4f));
  });
  EXPECT_EQ(GreyPixels(MustTransfer(style, crease).picture), 0u);
  // A steep but continuous slope: a metre a pixel at ten metres.
  GuideSet slope = TwoHalves();
  for (std::size_t i = 0; i < slope.pixel_count(); ++i) slope.Plane(Layer::kDepth)[i] = 10.0f + (i % 64);
  EXPECT_EQ(GreyPixels(MustTransfer(style, slope).picture), 2u * 2u * 32u);
}

// A part one pixel wide before a wall, and two such parts at different depths side by side: their own steps must not
// pass for a slope.
TEST(EdgeAware, VotesDoNotCrossPartsOnePixelWide) {
  Style style = PlainStyle(BlackAndWhite(128));
  style.transfer.blend_radius = 4;
  for (const int width : {1, 2}) {
    GuideSet guides = MakeGuides(64, 32, [&](int x, int) {
      return x < 32 || x >= 32 + width ? glm::normalize(glm::vec3(-0.4f, 0, 1)) : glm::normalize(glm::vec3(0.4f, 0, 1));
    });
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const int x = static_cast<int>(i % 64);
      guides.Plane(Layer::kDepth)[i] = x < 32 || x >= 32 + width ? 9.0f : x == 32 ? 5.0f : 4.0f;
    }
    EXPECT_EQ(GreyPixels(MustTransfer(style, guides).picture), 0u) << width;
  }
  // Background of a foreign file may have any depth; it is no neighbour.
  GuideSet alone = MakeGuides(64, 32, [](int x, int) {
    return x == 31 ? glm::normalize(glm::vec3(-0.4f, 0, 1))
           : x == 32 ? glm::normalize(glm::vec3(0.4f, 0, 1)) : glm::vec3(0.0f);
  });
  for (std::size_t i = 0; i < alone.pixel_count(); ++i) {
    alone.Plane(Layer::kDepth)[i] = i % 64 == 31 ? 5.0f : i % 64 == 32 ? 9.0f : 1e10f;
  }
  EXPECT_EQ(GreyPixels(MustTransfer(style, alone).picture), 0u);
}

TEST(EdgeAware, ChangesNothingWithoutEdges) {
  const GuideSet guides = MakeGuides(80, 60, [](int x, int y) {
    return glm::normalize(glm::vec3(0.4f * std::sin(x * 0.1f), 0.4f * std::cos(y * 0.1f), 1.0f));
  });
  Style style = PlainStyle(NoisePicture(128));
  style.transfer.blend_radius = 3;
  const Picture aware = MustTransfer(style, guides).picture;
  style.transfer.edge_aware = false;
  EXPECT_EQ(MustTransfer(style, guides).picture.rgba, aware.rgba);
}

// Grey paint in the disc, magenta around it.
Picture MagentaSurround(int size) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const bool painted = std::hypot(x + 0.5 - size / 2.0, y + 0.5 - size / 2.0) <= size / 2.0 - 0.5;
      std::uint16_t* texel = picture.At(x, y);
      const auto grey = static_cast<std::uint16_t>(20000 + Hash(x, y) % 20000);
      texel[0] = texel[2] = painted ? grey : 65535;
      texel[1] = painted ? grey : 0;
      texel[3] = 65535;
    }
  }
  return picture;
}

TEST(Rim, NoSurroundShowsInsideObjectsAtAnyScale) {
  const GuideSet all[] = {SphereGuides(120), HillGuides(130, 90), MakeGuides(90, 90, [](int x, int y) {
                            return AnyDirection(Hash(x / 4, y / 4));  // directions facing away too
                          })};
  for (const GuideSet& guides : all) {
    for (const double scale : {0.1, 0.3, 1.0, 2.0}) {
      for (const int radius : {0, 1, 4}) {
        Style style = PlainStyle(MagentaSurround(200));
        style.transfer.scale = scale;
        style.transfer.blend_radius = radius;
        const Picture picture = MustTransfer(style, guides).picture;
        for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
          ASSERT_EQ(picture.rgba[i], picture.rgba[i + 1]) << "scale " << scale << " radius " << radius;
        }
      }
    }
  }
}

TEST(Resample, KeepsSizeConstantsAndAlpha) {
  const Picture noise = NoisePicture(37);
  EXPECT_EQ(Resample(noise, 37, 37).rgba, noise.rgba);
  Picture flat(20, 30);
  for (std::size_t i = 0; i < flat.rgba.size(); ++i) flat.rgba[i] = i % 4 == 3 ? 40000 : 33333;
  for (const int size : {1, 7, 19, 64}) {
    const Picture resized = Resample(flat, size, 2 * size);
    ASSERT_EQ(resized.width, size);
    ASSERT_EQ(resized.height, 2 * size);
    for (std::size_t i = 0; i < resized.rgba.size(); ++i) ASSERT_EQ(resized.rgba[i], i % 4 == 3 ? 40000 : 33333);
  }
}

TEST(Resample, TransparentTexelsLendNoColour) {
  Picture picture(16, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = x < 8 ? 50000 : 0, texel[3] = x < 8 ? 65535 : 0;
    }
  }
  const Picture half = Resample(picture, 8, 8);
  for (int x = 0; x < 8; ++x) {
    if (half.At(x, 3)[3] > 2000) {
      EXPECT_NEAR(half.At(x, 3)[0], 50000, 1) << x;
    }
  }
}

TEST(Resample, KeepsASineThatBothSizesCanShow) {
  Picture picture(200, 1);
  for (int x = 0; x < 200; ++x) {
    std::uint16_t* texel = picture.At(x, 0);
    texel[0] = static_cast<std::uint16_t>(30000 + 20000 * std::sin((x + 0.5) * 0.1)), texel[3] = 65535;
  }
  const Picture half = Resample(picture, 100, 1);
  for (int x = 5; x < 95; ++x) EXPECT_NEAR(half.At(x, 0)[0], 30000 + 20000 * std::sin((x + 0.5) * 0.2), 200) << x;
}

}  // namespace
}  // namespace scumble
