// Fragments against the same scene at as many pixels as there are subsamples.
#include "core/image/fragments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

using Ids = std::pair<float, float>;  // object and material

// Balls before a wall, some of them one object; every border is between surfaces.
Scene BallsBeforeAWall() {
  Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(0, 0, -2), glm::dvec3(8.0)));
  scene.materials.emplace_back().name = "other";
  Mesh other = BallMesh(12);
  other.material = 1;
  AddObject(scene, "left", BallMesh(12), Moved(-0.7, 0.1, 0));
  AddObject(scene, "right", other, Moved(0.6, -0.2, -0.5));
  AddObject(scene, "left", BallMesh(5), glm::scale(Moved(0.1, 0.9, 0.6), glm::dvec3(0.3)));
  scene.lights.push_back(PointLight({3, 3, 6}, 100.0));
  return scene;
}

GuidegenOptions Smooth(int width, int height, int aa, LayerSet layers = {}) {
  GuidegenOptions options = Sized(width, height, layers);
  options.aa = aa;
  return options;
}

Ids IdsAt(const GuideSet& guides, std::size_t i) {
  return {guides.Plane(Layer::kObject)[i], guides.Plane(Layer::kMaterial)[i]};
}

constexpr int kWidth = 61, kHeight = 47, kAa = 4;
const LayerSet kAll = {Layer::kPosition, Layer::kAlbedo, Layer::kPref, Layer::kLuminance, Layer::kShadow};

void ExpectTheSurfacesOfAllSubsamples(const Scene& scene) {
  const Camera camera = LookingAt({0.5, 0.8, 6}, {0, 0, 0});
  const GuideSet guides = Render(scene, camera, Smooth(kWidth, kHeight, kAa, kAll)).guides;
  const GuideSet fine = Render(scene, camera, Sized(kWidth * kAa, kHeight * kAa, kAll)).guides;
  ASSERT_TRUE(guides.fragments);
  const Fragments& fragments = *guides.fragments;
  ASSERT_EQ(fragments.values.layers(), guides.layers());
  std::size_t next = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t i = guides.Index(x, y);
      std::map<Ids, std::vector<std::size_t>> seen;  // pixels of the fine picture
      for (int k = 0; k < kAa * kAa; ++k) {
        const std::size_t at = fine.Index(x * kAa + k % kAa, y * kAa + k / kAa);
        if (fine.Plane(Layer::kCoverage)[at] > 0.0f) seen[IdsAt(fine, at)].push_back(at);
      }
      seen.erase(IdsAt(guides, i));
      float sum = 0.0f;
      for (std::size_t n = 0; n < seen.size(); ++n, ++next) {
        ASSERT_LT(next, fragments.count());
        ASSERT_EQ(fragments.pixel[next], i);
        const auto found = seen.find(IdsAt(fragments.values, next));
        ASSERT_NE(found, seen.end());
        const float coverage = fragments.values.Plane(Layer::kCoverage)[next];
        EXPECT_FLOAT_EQ(coverage, float(found->second.size()) / (kAa * kAa)) << x << ", " << y;
        sum += coverage;
        unsigned cells = 0;  // with 4 × 4 subsamples, one each
        for (const std::size_t at : found->second) {
          const int u = int(at) % (kWidth * kAa) - x * kAa, v = int(at) / (kWidth * kAa) - y * kAa;
          cells |= 1u << (4 * v + u);
        }
        EXPECT_EQ(fragments.cells[next], cells) << x << ", " << y;
        // One of its subsamples has just these values.
        const bool is_one = std::any_of(found->second.begin(), found->second.end(), [&](std::size_t at) {
          const auto near = [&](Layer layer) {
            return glm::length(fine.Vec3(layer, at) - fragments.values.Vec3(layer, next)) < 1e-5f;
          };
          return near(Layer::kNormal) && near(Layer::kPosition) && near(Layer::kAlbedo) && near(Layer::kPref);
        });
        EXPECT_TRUE(is_one) << x << ", " << y;
      }
      EXPECT_LE(sum, guides.Plane(Layer::kCoverage)[i]);
    }
  }
  EXPECT_EQ(next, fragments.count());
  EXPECT_GT(next, 100u);
}

TEST(Fragments, AreTheSurfacesOfThePictureOfAllSubsamples) { ExpectTheSurfacesOfAllSubsamples(BallsBeforeAWall()); }

// A card before a wall, with holes that its texture's alpha cuts out.
TEST(Fragments, HolesThatAlphaCutsOutHaveThemToo) {
  Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(0, 0, -2), glm::dvec3(8.0)));
  Material& pierced = scene.materials.emplace_back();
  pierced.name = "pierced", pierced.alpha_mode = AlphaMode::kMask;
  Picture picture(5, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = 40000;
      picture.At(x, y)[3] = x % 2 && y % 2 ? 0 : 65535;
    }
  }
  pierced.base_color_texture.texture = 0, pierced.base_color_texture.nearest = true;
  scene.textures.push_back(picture);
  Mesh card = QuadMesh();
  card.material = 1;
  AddObject(scene, "card", card, glm::rotate(Moved(0.1, 0, 0), 0.3, glm::dvec3(0, 1, 0.5)));
  scene.lights.push_back(PointLight({3, 3, 6}, 100.0));
  ExpectTheSurfacesOfAllSubsamples(scene);
}

TEST(Fragments, ChangeNoLayer) {
  const Camera camera = LookingAt({0.5, 0.8, 6}, {0, 0, 0});
  const GuideSet plain = Render(BallsBeforeAWall(), camera, Sized(kWidth, kHeight, kAll)).guides;
  const GuideSet smooth = Render(BallsBeforeAWall(), camera, Smooth(kWidth, kHeight, kAa, kAll)).guides;
  EXPECT_FALSE(plain.fragments);
  for (const LayerInfo& info : AllLayers()) {
    if (!plain.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      EXPECT_TRUE(std::ranges::equal(plain.Plane(info.layer, c), smooth.Plane(info.layer, c))) << info.name;
    }
  }
}

TEST(Fragments, AreTheSameOnAnyNumberOfThreads) {
  const Camera camera = LookingAt({0.5, 0.8, 6}, {0, 0, 0});
  GuidegenOptions options = Smooth(kWidth, kHeight, kAa, kAll);
  options.threads = 1;
  const GuideSet one = Render(BallsBeforeAWall(), camera, options).guides;
  options.threads = 3;
  const GuideSet three = Render(BallsBeforeAWall(), camera, options).guides;
  ASSERT_EQ(one.fragments->pixel, three.fragments->pixel);
  ASSERT_EQ(one.fragments->cells, three.fragments->cells);
  for (const LayerInfo& info : AllLayers()) {
    if (!one.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      EXPECT_TRUE(
          std::ranges::equal(one.fragments->values.Plane(info.layer, c), three.fragments->values.Plane(info.layer, c)))
          << info.name;
    }
  }
}

TEST(Fragments, GrowWithTheBordersLength) {
  const Camera camera = LookingAt({0.5, 0.8, 6}, {0, 0, 0});
  const auto count = [&](int scale) {
    return double(
        Render(BallsBeforeAWall(), camera, Smooth(kWidth * scale, kHeight * scale, 2)).guides.fragments->count());
  };
  EXPECT_NEAR(count(4) / count(2), 2.0, 0.2);
}

TEST(Fragments, OneSurfaceHasNone) {
  EXPECT_FALSE(Render(SceneOf(BallMesh(12)), FrontCamera(4.0), Smooth(20, 20, 4)).guides.fragments);
  Scene two = SceneOf(BallMesh(12), Moved(-0.5, 0, 0));
  AddObject(two, "thing", BallMesh(12), Moved(0.5, 0, 0));  // another mesh of the same object
  EXPECT_FALSE(Render(two, FrontCamera(5.0), Smooth(20, 20, 4)).guides.fragments);
}

TEST(Fragments, LightIsThatOfTheSurfaceBeside) {
  // A lit quad before the border of a dark one, that faces away from the lamp.
  Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(0, 0, -1), glm::dvec3(8.0)));
  AddObject(scene, "front", QuadMesh(), glm::rotate(Moved(1.03, 0, 0), 1.2, glm::dvec3(0, 1, 0)));
  scene.lights.push_back(PointLight({0, 0, 9}, 100.0));
  const GuideSet guides = Render(scene, FlatCamera(5.0, 1.0), Smooth(16, 16, 4, {Layer::kLuminance})).guides;
  ASSERT_TRUE(guides.fragments);
  const Fragments& fragments = *guides.fragments;
  for (std::size_t f = 0; f < fragments.count(); ++f) {
    const int x = int(fragments.pixel[f]) % 16, y = int(fragments.pixel[f]) / 16;
    bool is_beside = false;
    for (int v = std::max(0, y - 1); v <= std::min(15, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(15, x + 1); ++u) {
        const std::size_t q = guides.Index(u, v);
        is_beside = is_beside || (IdsAt(guides, q) == IdsAt(fragments.values, f) &&
                                  guides.Plane(Layer::kLuminance)[q] == fragments.values.Plane(Layer::kLuminance)[f]);
      }
    }
    EXPECT_TRUE(is_beside) << x << ", " << y;
  }
}

TEST(Fragments, FourSurfacesAreKept) {
  // One pixel with 16 rows of subsamples: three strips of two rows and three of one, before a wall that the centre
  // sees.
  Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(0, 0, -1), glm::dvec3(8.0)));
  for (int i = 0; i < 6; ++i) {
    const int row = i < 3 ? 3 * i : 10 + 2 * (i - 3), rows = i < 3 ? 2 : 1;
    const double y = 1.0 - 0.125 * (row + 0.5 * rows);
    AddObject(scene, "strip " + std::to_string(i), QuadMesh(),
              glm::scale(Moved(0, y, 0), glm::dvec3(4.0, 0.9 * 0.0625 * rows, 1.0)));
  }
  const GuideSet guides = Render(scene, FlatCamera(5.0, 1.0), Smooth(1, 1, 16)).guides;
  ASSERT_TRUE(guides.fragments);
  const Fragments& fragments = *guides.fragments;
  ASSERT_EQ(fragments.count(), std::size_t(Fragments::kMostInPixel));
  const auto coverage = fragments.values.Plane(Layer::kCoverage);
  for (std::size_t f = 0; f < fragments.count(); ++f) {
    const std::string name = guides.object_names.at(unsigned(fragments.values.Plane(Layer::kObject)[f]));
    EXPECT_TRUE(name == "strip 0" || name == "strip 1" || name == "strip 2") << name;
    // Of the wall's 7 rows and the 6 of these strips.
    EXPECT_FLOAT_EQ(coverage[f], 2.0f / 13.0f);
  }
}

TEST(Fragments, ThinObjectAtACentreKeepsItsShare) {
  // Thinner than the distance of subsamples, through the centres of a column.
  Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(0, 0, -1), glm::dvec3(8.0)));
  AddObject(scene, "wire", QuadMesh(), glm::scale(Moved(0, 0, 0), glm::dvec3(0.01, 4.0, 1.0)));
  const GuideSet guides = Render(scene, FlatCamera(5.0, 1.0), Smooth(9, 9, 2)).guides;
  ASSERT_TRUE(guides.fragments);
  for (std::size_t f = 0; f < guides.fragments->count(); ++f) {
    // The wire counts as one subsample beside the four that see the wall.
    EXPECT_EQ(guides.fragments->pixel[f] % 9, 4u);
    EXPECT_FLOAT_EQ(guides.fragments->values.Plane(Layer::kCoverage)[f], 0.8f);
  }
  EXPECT_EQ(guides.fragments->count(), 9u);
}

}  // namespace
}  // namespace scumble::testing
