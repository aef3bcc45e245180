// Voting, edges, and no colour from outside the painted disc.
#include "transfer/vote/vote.h"

#include <limits>
#include <set>

#include "core/filter/resample.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "tests/support/transfer_fixtures.h"

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
            if (std::max(std::abs(u - x), std::abs(v - y)) > 1 << result.field.level[q]) continue;
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
    // Single pixels beside the border may belong to small chunks, which do not vote as far.
    EXPECT_NEAR(GreyPixels(MustTransfer(style, guides).picture), 2 * radius * 32, radius) << "plain voting mixes";
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
    return x == 31   ? glm::normalize(glm::vec3(-0.4f, 0, 1))
           : x == 32 ? glm::normalize(glm::vec3(0.4f, 0, 1))
                     : glm::vec3(0.0f);
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

// Which objects' paint is where, after a vote in which every object has a pure colour of its own: the number of pixels
// that show any other.
class Ghosting {
 public:
  static constexpr int kStripe = 41;  // wider than the window, so a vote never leaves its object's stripe of paint

  explicit Ghosting(const GuideSet& guides) : guides_(guides), active_(guides.pixel_count(), 0) {
    std::map<float, int> stripes;
    const auto object = guides.Plane(Layer::kObject), coverage = guides.Plane(Layer::kCoverage);
    for (const float id : object) stripes.try_emplace(id, static_cast<int>(stripes.size()));
    const int size = 2 * kStripe * static_cast<int>(stripes.size());  // the stripes lie across the disc's middle
    Picture paint(size, size);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        paint.At(x, y)[0] = static_cast<std::uint16_t>(1000 * (x / kStripe)), paint.At(x, y)[3] = 65535;
      }
    }
    exemplar_.emplace(paint, 0.0, size);
    field_.Reset(guides.width(), guides.height());
    for (std::size_t i = 0; i < active_.size(); ++i) {
      active_[i] = coverage[i] > 0.0f;
      const int stripe = stripes[object[i]] + static_cast<int>(stripes.size()) / 2;
      if (active_[i]) field_.Set(i, stripe * kStripe + kStripe / 2, size / 2, 0, 0);
    }
  }

  std::size_t Count(int radius, const internal::EdgeRules* edges) const {
    Picture out(guides_.width(), guides_.height());
    const Region all{0, 0, guides_.width(), guides_.height()};
    const Progress unheard;
    internal::RowProgress progress(unheard, 0.0, 1.0, guides_.height());
    const internal::VoteInput input{field_, active_, *exemplar_, radius, edges, all};
    EXPECT_TRUE(internal::Vote(input, out, progress));
    std::size_t ghosts = 0;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      ghosts += active_[i] && out.rgba[4 * i] != exemplar_->picture().At(field_.x[i], field_.y[i])[0];
    }
    return ghosts;
  }

 private:
  const GuideSet& guides_;
  std::vector<std::uint8_t> active_;
  std::optional<PreparedExemplar> exemplar_;
  SourceField field_;
};

// A branch with leaves, a sphere of wire and the frame of a chair before walls.
GuideSet ThinParts() {
  Expected<Scene> scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/stilllife.glb");
  EXPECT_TRUE(scene);
  Expected<PreparedView> view = PrepareView(*scene, "", std::nullopt, 16.0 / 9.0, false);
  EXPECT_TRUE(view);
  GuidegenOptions options;
  options.width = 320, options.height = 180;
  return std::move(RenderGuides(*scene, view->camera, options)->guides);
}

TEST(EdgeAware, NoGhostingAtAnyTolerance) {
  const GuideSet guides = ThinParts();
  const Ghosting ghosting(guides);
  internal::LazyDepthGradient slopes(guides);
  for (const int radius : {1, 8}) {
    EXPECT_GT(ghosting.Count(radius, nullptr), radius == 8 ? 7000u : 5000u) << "plain voting mixes, as it should";
    for (const double tolerance : {0.0, 1e-4, 3e-4, 1e-3, 2e-3, 1e-2, 3e-2, 1e-1, 1.0}) {
      for (const double crease : {60.0, 180.0}) {
        const internal::EdgeRules edges{guides, slopes, crease, tolerance};
        EXPECT_EQ(ghosting.Count(radius, &edges), 0u) << "radius " << radius << ", tolerance " << tolerance;
      }
    }
  }
}

// As if the whole scene were one object, so that only depth and creases separate its parts: the remaining ghosts must
// decrease with the tolerance.
TEST(EdgeAware, DepthAndCreasesAloneStopMostGhosts) {
  const GuideSet guides = ThinParts();
  const Ghosting ghosting(guides);
  GuideSet one_object = guides;
  for (float& id : one_object.Plane(Layer::kObject)) id = id > 0.0f ? 1.0f : 0.0f;
  internal::LazyDepthGradient slopes(one_object);
  const std::size_t plain = ghosting.Count(8, nullptr);
  std::size_t last = 0;
  for (const double tolerance : {0.0, 1e-4, 1e-3, 2e-3, 1e-2, 1e-1}) {
    const internal::EdgeRules edges{one_object, slopes, 60.0, tolerance};
    const std::size_t ghosts = ghosting.Count(8, &edges);
    // Parts that touch are one surface there, so some always remain.
    if (tolerance == 0.0) {
      EXPECT_LT(ghosts, plain / 50);
    }
    if (tolerance <= 0.002) {
      EXPECT_LT(ghosts, plain / 12) << tolerance;
    }
    EXPECT_LT(ghosts, plain / 2) << tolerance;
    EXPECT_GE(ghosts, last) << "a larger tolerance lets more through";
    last = ghosts;
  }
}

// The same in small windows. A test of every pair of pixels, and of every step on the straight line between them, would
// let through 304, 516 and 766 of the 7749, 12824 and 16824 pixels that plain voting mixes.
TEST(EdgeAware, SmallWindowsLetFewGhostsThrough) {
  const GuideSet guides = ThinParts();
  const Ghosting ghosting(guides);
  GuideSet one_object = guides;
  for (float& id : one_object.Plane(Layer::kObject)) id = id > 0.0f ? 1.0f : 0.0f;
  internal::LazyDepthGradient slopes(one_object);
  for (const int radius : {1, 2, 3}) {
    const std::size_t plain = ghosting.Count(radius, nullptr);
    const internal::EdgeRules exact{one_object, slopes, 60.0, 0.0}, usual{one_object, slopes, 60.0, 0.002};
    EXPECT_LT(ghosting.Count(radius, &exact), plain / 100) << radius;
    EXPECT_LT(ghosting.Count(radius, &usual), plain / 25) << radius;
  }
}

// Fingers before a slanted face of the same object, a tenth of the distance in front of it.
TEST(EdgeAware, FingersSurviveRadiusEight) {
  Style style = PlainStyle(BlackAndWhite(128));
  style.transfer.blend_radius = 8;
  for (const float distance : {0.2f, 2.0f, 200.0f}) {
    GuideSet guides = MakeGuides(96, 48, [](int x, int y) {
      const bool finger = y > 10 && (x % 16 == 3 || (x % 16 > 8 && x % 16 < 12));
      return glm::normalize(glm::vec3(finger ? 0.4f : -0.4f, 0, 1));
    });
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const float slanted =
          distance * (1.0f + 0.004f * static_cast<float>(i % 96) - 0.002f * static_cast<float>(i / 96));
      guides.Plane(Layer::kDepth)[i] = slanted - (guides.Plane(Layer::kNormal)[i] > 0.0f ? 0.1f * distance : 0.0f);
    }
    for (const double tolerance : {0.0, 1e-4, 2e-3, 1e-2, 5e-2}) {
      style.transfer.depth_tolerance = tolerance;
      EXPECT_EQ(GreyPixels(MustTransfer(style, guides).picture), 0u) << distance << " m, tolerance " << tolerance;
    }
    style.transfer.depth_tolerance = 0.2;
    EXPECT_GT(GreyPixels(MustTransfer(style, guides).picture), 2000u) << "the step is within the tolerance";
    style.transfer.depth_tolerance = TransferSettings().depth_tolerance;
  }
}

// An orthographic camera's picture does not depend on its distance, so the distance must not affect edges: the step is
// measured by the height that is seen, for steps above 2^-20 of the distance at least. Depths are sixteenths of a metre
// below 2^20 m, exact wherever the camera stands.
TEST(EdgeAware, AnOrthographicCameraMayStandAnywhere) {
  Style style = PlainStyle(BlackAndWhite(128));
  for (const int radius : {1, 3, 8}) {
    style.transfer.blend_radius = radius;
    for (const double height : {40.0, 2000.0}) {
      std::size_t first = 0;
      for (const float distance : {2.0f, 64.0f, 65536.0f, 524288.0f}) {
        GuideSet guides =
            MakeGuides(96, 48, [](int x, int) { return glm::normalize(glm::vec3(x % 16 < 4 ? 0.4f : -0.4f, 0, 1)); });
        guides.camera = OrthographicCamera(height);
        for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
          const float slanted =
              distance + 16.0f + 0.125f * static_cast<float>(i % 96) - 0.0625f * static_cast<float>(i / 96);
          guides.Plane(Layer::kDepth)[i] = slanted - (guides.Plane(Layer::kNormal)[i] > 0.0f ? 1.0f : 0.0f);
        }
        // 0.002 of 40 m are 0.08 m, less than the step of 1 m; 0.002 of 2000 m are 4 m, more than it.
        const std::size_t grey = GreyPixels(MustTransfer(style, guides).picture);
        if (distance == 2.0f) first = grey;
        EXPECT_EQ(grey, first) << height << " m high, " << distance << " m away, radius " << radius;
        EXPECT_EQ(grey > 0, height == 2000.0) << distance << " m away, radius " << radius;
      }
    }
  }
}

TEST(EdgeAware, TheCreaseAngleIsWhatItSays) {
  Style style = PlainStyle(BlackAndWhite(128));
  style.transfer.blend_radius = 3;
  for (const double angle : {20.0, 60.0, 90.0, 150.0}) {
    const float half = static_cast<float>(angle * 3.14159265358979 / 360.0);
    const GuideSet guides = MakeGuides(
        64, 32, [&](int x, int) { return glm::vec3((x < 32 ? -1.0f : 1.0f) * std::sin(half), 0.0f, std::cos(half)); });
    style.transfer.crease = angle - 1.0;
    EXPECT_EQ(GreyPixels(MustTransfer(style, guides).picture), 0u) << angle;
    style.transfer.crease = angle + 1.0;
    EXPECT_NEAR(GreyPixels(MustTransfer(style, guides).picture), 6 * 32, 6) << angle;
    style.transfer.crease = 180.0;
    EXPECT_NEAR(GreyPixels(MustTransfer(style, guides).picture), 6 * 32, 6) << angle;
  }
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
  int visible = 0;
  for (int x = 0; x < 8; ++x) {
    if (half.At(x, 3)[3] <= 2000) continue;
    ++visible;
    EXPECT_NEAR(half.At(x, 3)[0], 50000, 1) << x;
  }
  EXPECT_GE(visible, 4);
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
