// Mirrored guides and a mirrored picture give the mirrored picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/style/finish_keys.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

Picture Mirrored(Picture picture) {
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width / 2; ++x)
      std::swap_ranges(picture.At(x, y), picture.At(x, y) + 4, picture.At(picture.width - 1 - x, y));
  }
  return picture;
}

GuideSet Mirrored(GuideSet guides) {
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.layers().Has(info.layer)) continue;
    for (int c = 0; c < static_cast<int>(info.channels.size()); ++c) {
      const auto plane = guides.Plane(info.layer, c);
      for (int y = 0; y < guides.height(); ++y) {
        const auto row = plane.begin() + std::ptrdiff_t(guides.Index(0, y));
        std::reverse(row, row + guides.width());
      }
      if (info.layer == Layer::kNormal && c == 0) {
        for (float& value : plane) value = -value;
      }
    }
  }
  return guides;
}

struct MirrorCase {
  std::string name;
  FinishPass::Effect effect;
  int most;  // difference of codes times alpha
};

// What sums of floats round otherwise from right to left: bilateral, Kuwahara's and wavelet filters, and the curve that
// flow follows, whose direction has no sign.
constexpr int kOfRounding = 4;
// The levels of the blur begin at the left and upper edge of what is blurred.
constexpr int kOfBlur = 200;
// Closed lines are smoothed from where they begin: a line may lie a seventh of a pixel elsewhere.
constexpr int kOfLines = 10000;

int MostOf(const std::string& effect) {
  if (effect == "outline") return kOfLines;
  return effect == "smooth" ? kOfRounding : 0;
}

// Of chance, where strokes and clouds come from the picture's place, nothing is mirrored: hatching, the pigment's
// clouds, grains and tremor, an outline's waves and gaps.
std::vector<MirrorCase> MirrorCases() {
  std::vector<MirrorCase> cases;
  for (const FinishEffect& effect : FinishEffects()) {
    if (effect.name == "hatch" || effect.name == "pigment") continue;
    cases.push_back({effect.name, effect.defaults, MostOf(effect.name)});
  }
  PigmentPass pigment;
  pigment.turbulence = pigment.granulation = pigment.tremor = 0.0;
  cases.push_back({"pigment_edge", pigment, 0});
  for (const auto& [name, filter] : {std::pair{"smooth_kuwahara", SmoothPass::Filter::kKuwahara},
                                     {"smooth_guided", SmoothPass::Filter::kGuided},
                                     {"smooth_wavelets", SmoothPass::Filter::kWavelets}}) {
    SmoothPass smooth;
    smooth.filter = filter;
    cases.push_back({name, smooth, kOfRounding});
  }
  for (const bool borders : {false, true}) {
    EdgesPass edges;
    edges.borders = borders;
    if (borders) cases.push_back({"edges_borders", edges, 0});
    edges.flow = 3.0;
    cases.push_back({borders ? "edges_flow_borders" : "edges_flow", edges, kOfRounding});
  }
  ShadowsPass shadows;
  shadows.soften = 5.0;
  cases.push_back({"shadows_soften", shadows, 0});
  OutlinePass field;
  field.form = OutlinePass::Form::kField;
  cases.push_back({"outline_field", field, kOfLines});
  DepthPass blur;
  blur.blur = 6.0;
  cases.push_back({"depth_blur", blur, kOfBlur});
  return cases;
}

class MirroredEffect : public ::testing::TestWithParam<MirrorCase> {};

TEST_P(MirroredEffect, IsTheEffectMirrored) {
  const GuideSet guides = LitBalls();
  Picture picture = ColorfulPicture(guides.width(), guides.height());
  for (std::size_t i = 0; i < guides.pixel_count(); ++i)
    picture.rgba[4 * i + 3] = static_cast<std::uint16_t>(guides.Plane(Layer::kCoverage)[i] * 65535.0f);
  FinishPass::Effect effect = GetParam().effect;
  if (auto* const palette = std::get_if<PalettePass>(&effect)) palette->target = ColorSpread{{0.4, 0.1, 0.0}, {0.02}};
  if (auto* const grade = std::get_if<GradePass>(&effect)) grade->contrast = 1.5;
  const FinishMeasures measures = MeasureFinish(guides);
  const Picture made = Finished(StepOf(effect), &guides, picture, measures);
  ASSERT_NE(made.rgba, picture.rgba);
  const GuideSet other = Mirrored(guides);
  const Picture expected = Mirrored(Finished(StepOf(effect), &other, Mirrored(picture), measures));
  if (GetParam().most == 0) {
    EXPECT_TRUE(made.rgba == expected.rgba);
    return;
  }
  double most = 0.0;
  for (std::size_t i = 0; i < made.rgba.size(); ++i) {
    const double alpha = made.rgba[i | 3] / 65535.0, other_alpha = expected.rgba[i | 3] / 65535.0;
    most = std::max(most, std::fabs(made.rgba[i] * alpha - expected.rgba[i] * other_alpha));
  }
  EXPECT_LE(most, GetParam().most);
}

INSTANTIATE_TEST_SUITE_P(All, MirroredEffect, ::testing::ValuesIn(MirrorCases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace scumble
