// Every bundled style, with all of its features: equal bytes for any number of threads and any cutting into regions,
// and for any previous content of the picture. The styles are those in exemplars/, so that a new one is tested
// automatically.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/filter/resample.h"
#include "core/image/hash.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr int kWidth = 61, kHeight = 45;  // no tile below divides them

// The still life with soft silhouettes and every layer that a style reads, or may.
GuideSet StillLife(const LayerSet& layers) {
  auto scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/stilllife.glb");
  EXPECT_TRUE(scene.ok());
  const auto view = PrepareView(*scene, "", ViewAngles{35, 25, 0}, static_cast<double>(kWidth) / kHeight, true);
  EXPECT_TRUE(view.ok());
  GuidegenOptions options;
  options.width = kWidth, options.height = kHeight, options.aa = 4, options.samples = 1;
  options.layers = AlwaysWritten();
  options.layers.Add(Layer::kAlbedo).Add(Layer::kLuminance).Add(Layer::kShadow).Add(Layer::kPref).Add(layers);
  auto rendered = RenderGuides(*scene, view->camera, options);
  EXPECT_TRUE(rendered.ok());
  return std::move(rendered->guides);
}

// Settings of a style beyond its own file.
struct Variant {
  const char* name;
  std::function<void(TransferSettings&)> set;
  bool lit = false;     // where the style has one exemplar: that a second time, painted for less light
  bool mapped = false;  // the floor catches shadows, one object is left out, another has a style of its own
};

// All but the first in plain pixels: even a picture this small then has levels, chunks and votes.
std::vector<Variant> Variants() {
  const auto pixels = [](std::function<void(TransferSettings&)> more) {
    return [more = std::move(more)](TransferSettings& settings) {
      settings.reference_height = 0, settings.scale = 0.5, settings.levels = 5;
      more(settings);
    };
  };
  // Styles in greys tint by default: those use the other mode.
  const auto oklab = [](TransferSettings& s) {
    const bool already = s.colorize == 1.0 && s.colorize_mode == ColorizeMode::kOklab;
    s.colorize = 1.0, s.colorize_mode = already ? ColorizeMode::kMultiply : ColorizeMode::kOklab;
  };
  const auto edge = [](TransferSettings& s) { s.edge = EdgeMode::kExemplar, s.scale = 2.0; };
  return {
      {"as it is", [](TransferSettings&) {}},
      {"plain pixels", pixels([](TransferSettings&) {})},
      {"votes", pixels([](TransferSettings& s) { s.blend_radius = 5; })},
      {"tinted", pixels([](TransferSettings& s) { s.colorize = 0.7; })},
      {"tinted in Oklab", pixels(oklab)},
      {"painted edge", pixels(edge)},
      {"painted edge, tinted", pixels([=](TransferSettings& s) { edge(s), oklab(s); })},
      {"varied", pixels([](TransferSettings& s) { s.variety = 15.0, s.jitter_fps = 12.0; })},
      {"Lit Sphere", pixels([](TransferSettings& s) { s.method = Method::kLitSphere; })},
      {"brute force", pixels([](TransferSettings& s) { s.method = Method::kBruteForce; })},
      {"lit", pixels([](TransferSettings& s) { s.luminance_weight = 2.0f; }), true},
      {"mapped", pixels([](TransferSettings& s) { s.shadow = ShadowMode::kPaint; }), false, true},
      {"all at once", pixels([=](TransferSettings& s) {
         edge(s), oklab(s);
         s.blend_radius = 3, s.variety = 10.0, s.shadow = ShadowMode::kPaint, s.jitter_fps = 12.0;
       }),
       true, true},
  };
}

// A style prepared for the picture, and its map.
struct Painter {
  std::vector<PreparedStyle> prepared;
  std::vector<const PreparedStyle*> styles;
  StyleMap map;
  bool mapped = false;

  Picture Paint(const GuideSet& guides, int threads, const std::vector<Region>& regions) const {
    Picture picture(kWidth, kHeight);
    if (!regions.empty()) {  // what was in it before must not matter
      for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = static_cast<std::uint16_t>(Hash(9, i));
    }
    TransferScratch scratch;
    TransferOptions options;
    options.seed = 3, options.frame = 7, options.threads = threads, options.exposure = 0.5;
    const auto paint = [&] {
      const Status done = mapped ? Transfer(styles, map, guides, options, scratch, picture)
                                 : Transfer(prepared.front(), guides, options, scratch, picture);
      EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().message);
    };
    if (regions.empty()) paint();
    for (const Region& region : regions) options.region = region, paint();
    return picture;
  }
};

std::uint32_t IdOf(const GuideSet& guides, const std::string& object) {
  for (const auto& [id, name] : guides.object_names) {
    if (name == object) return id;
  }
  ADD_FAILURE() << "the still life has no object " << object;
  return 0;
}

Painter MakePainter(Style style, const Variant& variant, const GuideSet& guides) {
  Painter painter;
  painter.mapped = variant.mapped;
  variant.set(style.transfer);
  // Only a sphere has a painted edge that goes on along outlines.
  for (const Exemplar& exemplar : style.exemplars) {
    if (!exemplar.is_sphere) style.transfer.edge = EdgeMode::kExact;
  }
  if (variant.lit && style.exemplars.size() == 1) {
    style.exemplars.push_back(style.exemplars.front());
    style.exemplars[0].luminance = 0.7, style.exemplars[1].luminance = 0.1;
  }
  const auto prepare = [&] {
    auto prepared = Prepare(style, kHeight);
    ASSERT_TRUE(prepared.ok()) << prepared.error().message;
    painter.prepared.push_back(std::move(*prepared));
  };
  prepare();
  if (variant.mapped) {
    style.transfer.scale *= 0.7, style.transfer.blend_radius = 2;
    prepare();
    StyleAssignment assignment;
    assignment.of_object = {{IdOf(guides, "Floor"), StyleMap::kShadowCatcher},
                            {IdOf(guides, "Curtain"), StyleMap::kPassThrough},
                            {IdOf(guides, "WallLeft"), 1}};
    painter.map = MapStyles(guides, assignment);
  }
  for (const PreparedStyle& one : painter.prepared) painter.styles.push_back(&one);
  return painter;
}

std::vector<Region> Tiles(int width, int height) {
  std::vector<Region> tiles;
  for (int y = 0; y < kHeight; y += height) {
    for (int x = 0; x < kWidth; x += width) {
      tiles.push_back({x, y, std::min(x + width, kWidth), std::min(y + height, kHeight)});
    }
  }
  return tiles;
}

// The exemplar with fewer pixels: large exemplars would only take time, for the picture has 45 rows.
Exemplar Smaller(Exemplar exemplar) {
  constexpr int kSide = 128;
  if (exemplar.is_sphere || !exemplar.guides) {
    exemplar.picture = Resample(exemplar.picture, kSide, kSide);
    return exemplar;
  }
  const GuideSet& all = *exemplar.guides;
  GuideSet few(kSide, kSide);
  for (const LayerInfo& info : AllLayers()) {
    if (!all.Has(info.layer)) continue;
    few.Add(info.layer);
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          few.Plane(info.layer, c)[few.Index(x, y)] =
              all.Plane(info.layer, c)[all.Index(x * all.width() / kSide, y * all.height() / kSide)];
        }
      }
    }
  }
  exemplar.picture = Resample(exemplar.picture, kSide, kSide);
  exemplar.guides = std::move(few);
  return exemplar;
}

void ExpectSame(const Picture& picture, const Picture& whole, const std::string& what) {
  std::size_t differing = 0, first = 0;
  for (std::size_t i = whole.rgba.size(); i-- > 0;) {
    if (picture.rgba[i] != whole.rgba[i]) ++differing, first = i / 4;
  }
  EXPECT_EQ(differing, 0u) << what << ": first at (" << first % kWidth << ", " << first / kWidth << ")";
}

TEST(BundledStyles, SameBytesForAnyThreadsAndRegions) {
  const auto folders = FindStyles(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars");
  ASSERT_GE(folders.size(), 4u);
  LayerSet layers;
  std::vector<Style> styles;
  for (const auto& folder : folders) {
    auto loaded = LoadStyle(folder);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    layers.Add(RequiredLayers(*loaded));
    styles.push_back(std::move(*loaded));
  }
  const GuideSet guides = StillLife(layers);
  int with_edge = 0;
  std::size_t painted = 0;
  for (std::size_t number = 0; number < styles.size(); ++number) {
    const auto& folder = folders[number];
    const Style& loaded = styles[number];
    Style small = loaded;
    for (Exemplar& exemplar : small.exemplars) exemplar = Smaller(std::move(exemplar));
    // So few pixels are far from one another: the smallest thresholds would leave no chunk of two of them.
    small.transfer.threshold = std::max(small.transfer.threshold, 0.25f);
    std::vector<std::uint16_t> plain;
    for (const Variant& variant : Variants()) {
      SCOPED_TRACE(folder.filename().string() + ", " + variant.name);
      const bool as_it_is = std::string(variant.name) == "as it is";
      const Painter painter = MakePainter(as_it_is ? loaded : small, variant, guides);
      ASSERT_FALSE(painter.styles.empty());
      with_edge += !painter.prepared.front().rims.empty();
      const Picture whole = painter.Paint(guides, 1, {});
      if (std::string(variant.name) == "plain pixels")
        plain = whole.rgba;
      else
        EXPECT_TRUE(whole.rgba != plain) << "it does nothing, so nothing is tested";
      ExpectSame(painter.Paint(guides, 4, {}), whole, "4 threads");
      // Rows and columns of single pixels are many regions: each variant is cut into one of the two, by turns.
      const std::pair<int, int> line = painted++ % 2 == 0 ? std::pair{kWidth, 1} : std::pair{1, kHeight};
      for (const auto& [width, height] : {std::pair{17, 13}, {40, 31}, line}) {
        ExpectSame(painter.Paint(guides, 1, Tiles(width, height)), whole,
                   std::to_string(width) + "×" + std::to_string(height));
      }
      ExpectSame(painter.Paint(guides, 3, Tiles(17, 13)), whole, "3 threads, 17×13");
    }
  }
  EXPECT_GT(with_edge, 0) << "no bundled style has a painted edge that could continue";
}

}  // namespace
}  // namespace scumble
