// Every extension at its neutral value is the plain engine, byte for byte: a table of settings without effect, and the
// plain engine itself, without tables, regions or threads.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/plain_engine.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

constexpr int kNeutralWidth = 150, kNeutralHeight = 110;
constexpr int kOneObject = 1;

// Adds the layers that extensions read, each as rough as possible: any mistaken read shows.
GuideSet WithEveryLayer(GuideSet guides) {
  for (const Layer layer : {Layer::kLuminance, Layer::kAlbedo, Layer::kShadow, Layer::kMaterial, Layer::kPref}) {
    guides.Add(layer);
    for (int c = 0; c < ChannelCount(layer); ++c) {
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        if (guides.Plane(Layer::kCoverage)[i] > 0.0f) guides.Plane(layer, c)[i] = UnitFloat(Hash(int(layer), c, i / 3));
      }
    }
  }
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (guides.Plane(Layer::kCoverage)[i] > 0.0f) guides.Plane(Layer::kMaterial)[i] = 5.0f;
  }
  return guides;
}

// Hills, an object border and a step in depth; and a wall, on which `variety` would have its freedom.
GuideSet Hills() {
  GuideSet guides = WithEveryLayer(HillGuides(kNeutralWidth, kNeutralHeight));
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
    const int x = int(i) % kNeutralWidth, y = int(i) / kNeutralWidth;
    guides.Plane(Layer::kObject)[i] = x + y < 120 ? kOneObject : 2;
    guides.Plane(Layer::kDepth)[i] = 10.0f + 0.01f * x + (y > 70 ? 3.0f : 0.0f);
  }
  return guides;
}
GuideSet Wall() {
  return WithEveryLayer(MakeGuides(kNeutralWidth, kNeutralHeight, [](int x, int y) {
    return x > 110 && y < 40 ? glm::vec3(0.0f) : glm::normalize(glm::vec3(0.3f, 0.1f, 1.0f));
  }));
}

// The style that all others are measured against: chunks, votes and edges, nothing more.
Style Base() {
  Style style = PlainStyle(NoisePicture(128));
  style.transfer.levels = 6, style.transfer.blend_radius = 3;
  return style;
}

Picture PaintedMapped(const Style& style, const GuideSet& guides, bool mapped = false) {
  const auto prepared = Prepare(style, guides.height());
  EXPECT_TRUE(prepared.ok()) << (prepared.ok() ? "" : prepared.error().message);
  TransferOptions options;
  options.seed = kPlainSeed;
  TransferScratch scratch;
  Picture picture;
  const PreparedStyle* const styles[] = {&*prepared};
  const Status done = mapped ? Transfer(styles, MapStyles(guides, {}), guides, options, scratch, picture)
                             : Transfer(*prepared, guides, options, scratch, picture);
  EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().message);
  return picture;
}

TEST(Neutral, ThePlainEngineIsWhatThePaperSays) {
  for (const GuideSet& guides : {Hills(), Wall()}) {
    Style style = Base();
    style.transfer.edge_aware = false;
    EXPECT_TRUE(PaintedMapped(style, guides).rgba == PlainEngine(style, guides).rgba);
  }
}

// ---- what must make no difference ----------------------------------------------------------------------------------

struct Neutral {
  const char* name;
  std::function<void(Style&)> change;
  std::function<void(Style&)> from = [](Style&) {};  // to what the change is neutral, beyond Base()
  bool mapped = false;
};

std::vector<Neutral> Neutrals() {
  const auto set = [](auto field, auto value) { return [=](Style& style) { style.transfer.*field = value; }; };
  using T = TransferSettings;
  const float infinity = std::numeric_limits<float>::infinity();
  return {
      {"one exemplar, whatever its light counts",
       [=](Style& s) {
         s.exemplars[0].luminance = 0.3;
         s.transfer.luminance_weight = infinity, s.transfer.luminance_error = LuminanceError::kPublished;
       }},
      {"weight 0 and the same paint for every light",
       [](Style& s) {
         s.exemplars.push_back(s.exemplars[0]), s.exemplars.push_back(s.exemplars[0]);
         s.exemplars[0].luminance = 0.1, s.exemplars[1].luminance = 0.8, s.exemplars[2].luminance = 0.4;
         s.transfer.luminance_weight = 0.0f;
       }},
      {"weight 0 by the published error",
       [](Style& s) {
         s.exemplars.push_back(s.exemplars[0]);
         s.exemplars[0].luminance = 0.1, s.exemplars[1].luminance = 0.8;
         s.transfer.luminance_weight = 0.0f, s.transfer.luminance_error = LuminanceError::kPublished;
       }},
      {"the same paint for the same light",
       [](Style& s) {
         s.exemplars.push_back(s.exemplars[0]);
         s.exemplars[0].luminance = s.exemplars[1].luminance = 0.5;
         s.transfer.luminance_weight = 9.0f;
       }},
      {"colorize 0 in Oklab", set(&T::colorize_mode, ColorizeMode::kOklab)},
      {"a jitter rate at frame 0", set(&T::jitter_fps, -1.0)},
      {"a painted edge that the paint has not",
       [](Style& s) {
         s.paper.color.reset();
         s.transfer.edge = EdgeMode::kExemplar;
       }},
      {"shadows that nothing catches", set(&T::shadow, ShadowMode::kPaint), [](Style&) {}, true},
      {"a map of one style", [](Style&) {}, [](Style&) {}, true},
      {"an error of a tree that is not there", set(&T::nearest_error, 2.0)},
      {"the search by formula", set(&T::nearest, NearestSearch::kAnalytic)},
      {"a reference height that is the picture's", set(&T::reference_height, kNeutralHeight)},
      {"a scale of 1 of the picture's height",
       [](Style& s) { s.transfer.reference_height = kNeutralHeight, s.transfer.scale = 1.0; }},
      {"edges, where votes reach no one", set(&T::edge_aware, false), set(&T::blend_radius, 0)},
      {"a crease without edges", set(&T::crease, 1.0), set(&T::edge_aware, false)},
      {"a depth tolerance without edges", set(&T::depth_tolerance, 0.0), set(&T::edge_aware, false)},
  };
}

TEST(Neutral, ValuesThatMakeNoDifference) {
  for (const GuideSet& guides : {Hills(), Wall()}) {
    for (const Neutral& neutral : Neutrals()) {
      Style before = Base();
      neutral.from(before);
      Style after = before;
      neutral.change(after);
      EXPECT_TRUE(PaintedMapped(after, guides, neutral.mapped).rgba == PaintedMapped(before, guides).rgba)
          << neutral.name;
    }
  }
}

// Where one object fills the picture, a tolerance of its whole distance and creases that none is let every vote
// through: the largest values that a style can have are those of edge_aware = false. (A gap of background is an edge
// whatever the values are: no vote goes over it.)
TEST(Neutral, TheWidestEdgesAreNone) {
  for (GuideSet guides : {Hills(), Wall()}) {
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      guides.Plane(Layer::kObject)[i] = kOneObject;
      if (guides.Plane(Layer::kCoverage)[i] > 0.0f) continue;
      guides.Plane(Layer::kCoverage)[i] = 1.0f, guides.Plane(Layer::kDepth)[i] = 10.0f;
      guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
    }
    Style none = Base(), widest = Base();
    none.transfer.edge_aware = false;
    widest.transfer.crease = 180.0, widest.transfer.depth_tolerance = 1.0;
    EXPECT_TRUE(PaintedMapped(widest, guides).rgba == PaintedMapped(none, guides).rgba);
  }
  // And the table is not blind: with the default edges the hills' pictures differ.
  Style none = Base();
  none.transfer.edge_aware = false;
  EXPECT_FALSE(PaintedMapped(Base(), Hills()).rgba == PaintedMapped(none, Hills()).rgba);
}

// Each extension does something as soon as it leaves its neutral value, so that the tests above compare what could
// differ.
TEST(Neutral, BeyondItEveryExtensionShows) {
  const std::vector<std::pair<const char*, std::function<void(Style&)>>> changes = {
      {"light",
       [](Style& s) {
         s.exemplars.push_back(s.exemplars[0]);
         s.exemplars[0].luminance = 0.1, s.exemplars[1].luminance = 0.8;
         s.transfer.luminance_weight = 0.5f;
       }},
      {"tint", [](Style& s) { s.transfer.colorize = 0.01; }},
      {"tint in Oklab", [](Style& s) { s.transfer.colorize = 0.01, s.transfer.colorize_mode = ColorizeMode::kOklab; }},
      {"variety", [](Style& s) { s.transfer.variety = 3.0; }},
      {"scale", [](Style& s) { s.transfer.scale = 1.05; }},
      {"radius", [](Style& s) { s.transfer.blend_radius = 4; }},
  };
  for (const auto& [name, change] : changes) {
    Style style = Base();
    change(style);
    EXPECT_FALSE(PaintedMapped(style, Wall()).rgba == PaintedMapped(Base(), Wall()).rgba) << name;
  }
}

}  // namespace
}  // namespace scumble
