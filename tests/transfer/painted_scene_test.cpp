// The painted scenes: sphere, floor and wall under a light. Their guides are those of scenes/ball.glb. By guides of
// light a target's shadows take the paint of the exemplar's shadow; by normals alone they cannot.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/io/guide_file.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

const std::string kSource = SCUMBLE_SOURCE_DIR;
constexpr const char* kSceneStyles[] = {"scene-ink", "scene-oil", "scene-pastel"};

// `view`: none for the scene's own camera.
GuideSet RenderBall(int width, int height, int samples, const LayerSet& layers, std::optional<ViewAngles> view = {}) {
  auto scene = LoadScene(kSource + "/scenes/ball.glb");
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  const auto prepared = PrepareView(*scene, "", view, static_cast<double>(width) / height, true);
  EXPECT_TRUE(prepared.ok());
  GuidegenOptions options;
  options.width = width, options.height = height, options.samples = samples;
  options.layers = AlwaysWritten();
  options.layers.Add(layers);
  auto rendered = RenderGuides(*scene, prepared->camera, options);
  EXPECT_TRUE(rendered.ok());
  return std::move(rendered->guides);
}

// The guides that the styles share, with what is always written.
GuideSet Committed(const LayerSet& layers) {
  GuideReadOptions options;
  options.required = AlwaysWritten();
  options.required.Add(layers);
  auto read = ReadGuides(kSource + "/exemplars/scene/guides.exr", options);
  EXPECT_TRUE(read.ok()) << read.error().message;
  return std::move(*read);
}

// The mean of a layer's channel over a square of pixels.
double MeanOf(const GuideSet& guides, Layer layer, int c, int x0, int y0, int side) {
  double sum = 0.0;
  for (int y = y0; y < y0 + side; ++y) {
    for (int x = x0; x < x0 + side; ++x) sum += guides.Plane(layer, c)[guides.Index(x, y)];
  }
  return sum / (double(side) * side);
}

TEST(PaintedScene, GuidesAreThoseOfTheCommittedScene) {
  const LayerSet light{Layer::kLuminance, Layer::kShadow,  Layer::kLpeFull, Layer::kLpeLDE,
                       Layer::kLpeLSE,    Layer::kLpeLDDE, Layer::kLpeLD12E};
  LayerSet layers = light;
  const GuideSet committed = Committed(layers.Add(Layer::kAlbedo));
  // A third of its size: the middle of every third pixel is the middle of one here.
  ASSERT_EQ(committed.width(), committed.height());
  ASSERT_EQ(committed.width() % 48, 0);
  const int side = committed.width() / 3;
  const GuideSet fresh = RenderBall(side, side, 16, layers);

  std::size_t elsewhere = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const std::size_t here = fresh.Index(x, y), there = committed.Index(3 * x + 1, 3 * y + 1);
      if (fresh.Plane(Layer::kObject)[here] != committed.Plane(Layer::kObject)[there]) {
        ++elsewhere;
        continue;
      }
      EXPECT_EQ(fresh.Plane(Layer::kMaterial)[here], committed.Plane(Layer::kMaterial)[there]);
      EXPECT_NEAR(fresh.Plane(Layer::kDepth)[here], committed.Plane(Layer::kDepth)[there], 1e-3);
      EXPECT_LT(glm::distance(fresh.Vec3(Layer::kNormal, here), committed.Vec3(Layer::kNormal, there)), 2e-3f);
      EXPECT_LT(glm::distance(fresh.Vec3(Layer::kAlbedo, here), committed.Vec3(Layer::kAlbedo, there)), 2e-3f);
    }
  }
  EXPECT_LE(elsewhere, 4u) << "an outline may fall a hair to the other side";

  constexpr int kBlock = 16;  // here; three times as wide there
  for (const LayerInfo& info : AllLayers()) {
    if (!light.Has(info.layer)) continue;
    double off = 0.0, all = 0.0;
    for (int y = 0; y < side; y += kBlock) {
      for (int x = 0; x < side; x += kBlock) {
        for (int c = 0; c < ChannelCount(info.layer); ++c) {
          const double expected = MeanOf(fresh, info.layer, c, x, y, kBlock);
          off += std::fabs(MeanOf(committed, info.layer, c, 3 * x, 3 * y, 3 * kBlock) - expected);
          all += expected;
        }
      }
    }
    EXPECT_GT(all, 0.0) << info.name << " is empty";
    EXPECT_LT(off, 0.03 * all) << info.name << ": means of blocks";
  }
}

// The mean colour, in Oklab, of a picture where the floor lies in the sphere's shadow.
glm::dvec3 ColorInShadow(const Picture& picture, const GuideSet& guides) {
  glm::dvec3 sum(0.0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const auto name = guides.object_names.find(static_cast<std::uint32_t>(guides.Plane(Layer::kObject)[i]));
    if (name == guides.object_names.end() || name->second != "Floor" || guides.Plane(Layer::kShadow)[i] < 0.95f)
      continue;
    const std::uint16_t* texel = picture.rgba.data() + 4 * i;
    sum += glm::dvec3(OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])}));
    ++count;
  }
  EXPECT_GT(count, 50u) << "there must be a shadow to look at";
  return sum / static_cast<double>(count);
}

Picture Stylise(const Style& style, const GuideSet& guides) {
  std::vector<PreparedStyle> prepared;
  auto one = Prepare(style, guides.height());
  EXPECT_TRUE(one.ok()) << one.error().message;
  prepared.push_back(std::move(*one));
  TransferOptions options;
  options.exposure = MeasureExposure(prepared, guides).value_or(0.0);
  TransferScratch scratch;
  Picture picture;
  const Status done = Transfer(prepared.front(), guides, options, scratch, picture);
  EXPECT_TRUE(done.ok()) << done.error().message;
  return picture;
}

TEST(PaintedScene, ShadowsTakeThePaintOfTheExemplarsShadow) {
  const LayerSet layers{Layer::kAlbedo, Layer::kLuminance, Layer::kShadow, Layer::kLpeLSE};
  const GuideSet target = RenderBall(240, 180, 16, layers, ViewAngles{14.0, 24.0, 9.0});
  const GuideSet own = Committed({Layer::kShadow});
  for (const char* name : kSceneStyles) {
    SCOPED_TRACE(name);
    auto style = LoadStyle(kSource + "/exemplars/" + name);
    ASSERT_TRUE(style.ok()) << style.error().message;
    ASSERT_FALSE(style->transfer.guide_weights.ArePlain());
    ASSERT_TRUE(LayerSet(layers).Add(AlwaysWritten()).Contains(RequiredLayers(*style)));
    style->transfer.reference_height = 0, style->transfer.levels = 5, style->transfer.scale = 0.5;
    const glm::dvec3 painted = ColorInShadow(style->exemplars[0].picture, own);
    const glm::dvec3 by_light = ColorInShadow(Stylise(*style, target), target);
    style->transfer.guide_weights = GuideWeights();
    const glm::dvec3 by_normals = ColorInShadow(Stylise(*style, target), target);
    EXPECT_LT(glm::distance(by_light, painted), 0.06);
    EXPECT_GT(glm::distance(by_normals, painted), 0.20) << "by normals alone the floor is the same in light and shade";
    EXPECT_GT(glm::distance(by_normals, by_light), 0.20);
  }
}

TEST(PaintedScene, StylesShareOneGuideFile) {
  for (const char* name : kSceneStyles) {
    const auto style = LoadStyle(kSource + "/exemplars/" + name);
    ASSERT_TRUE(style.ok()) << style.error().message;
    EXPECT_TRUE(std::filesystem::equivalent(style->exemplars[0].guides_file, kSource + "/exemplars/scene/guides.exr"));
    EXPECT_EQ(style->exemplars[0].picture.width, style->exemplars[0].guides->width());
    EXPECT_FALSE(style->exemplars[0].is_sphere);
  }
}

}  // namespace
}  // namespace scumble
