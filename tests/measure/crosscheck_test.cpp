// The cross-check's figures and verdict on guides made by hand, and Blender's passes turned into guides.
#include "measure/crosscheck.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/io/atomic_file.h"
#include "measure/crosscheck_page.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// Two objects side by side before an empty left edge, all layers that are compared.
GuideSet TwoObjects() {
  GuideSet guides(40, 20);
  for (const Layer layer :
       {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kPosition, Layer::kAlbedo}) {
    guides.Add(layer);
  }
  for (int y = 0; y < 20; ++y) {
    for (int x = 5; x < 40; ++x) {
      const std::size_t i = guides.Index(x, y);
      guides.Plane(Layer::kCoverage)[i] = 1.0f;
      guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
      guides.Plane(Layer::kDepth)[i] = 4.0f;
      guides.Plane(Layer::kObject)[i] = x < 20 ? 7.0f : 9.0f;
      guides.Plane(Layer::kPosition, 0)[i] = 0.1f * x;
      guides.Plane(Layer::kAlbedo, 1)[i] = 0.5f;
    }
  }
  return guides;
}

const CrosscheckFigure& Figure(const CrosscheckReport& report, const std::string& layer, const std::string& name) {
  for (const CrosscheckFigure& figure : report.figures) {
    if (figure.layer == layer && figure.name == name) return figure;
  }
  ADD_FAILURE() << "no figure " << layer << " " << name;
  return report.figures.front();
}

TEST(Crosscheck, EqualGuidesAgreeInsideTheErodedMasks) {
  const auto report = Crosscheck("scene", TwoObjects(), TwoObjects());
  ASSERT_TRUE(report.ok());
  EXPECT_TRUE(report->passed());
  // Two pixels less on every side of each object: 15 - 4 and 20 - 4 columns of 20 - 4 rows.
  EXPECT_EQ(report->compared, std::size_t((11 + 16) * 16));
  for (const CrosscheckFigure& figure : report->figures) EXPECT_EQ(figure.value, 0.0) << figure.layer;
  EXPECT_NE(CrosscheckToJson({*report}).find("\"reasons\": []"), std::string::npos);
}

TEST(Crosscheck, EveryLimitCanBreak) {
  const GuideSet reference = TwoObjects();
  const auto broken = [&](auto change) {
    GuideSet ours = TwoObjects();
    for (std::size_t i = 0; i < ours.pixel_count(); ++i) {
      if (ours.Plane(Layer::kCoverage)[i] > 0.0f) change(ours, i);
    }
    const auto report = Crosscheck("scene", reference, ours);
    EXPECT_TRUE(report.ok());
    EXPECT_FALSE(report->passed());
    return *report;
  };
  const float tilt = 0.02f * 3.14159265f / 180.0f;
  const auto tilted = broken([&](GuideSet& g, std::size_t i) { g.Plane(Layer::kNormal, 0)[i] = tilt; });
  EXPECT_NEAR(Figure(tilted, "normal", "99% within").value, 0.02, 1e-5);
  EXPECT_TRUE(Figure(tilted, "normal", "99.9% within").kept());
  const auto far = broken([](GuideSet& g, std::size_t i) { g.Plane(Layer::kDepth)[i] *= 1.0001f; });
  EXPECT_NEAR(Figure(far, "depth", "99.9% within").value, 1e-4, 1e-6);
  const auto renamed = broken([](GuideSet& g, std::size_t i) { g.Plane(Layer::kObject)[i] += 1.0f; });
  EXPECT_EQ(Figure(renamed, "object", "differing").value, double(renamed.compared));
  broken([](GuideSet& g, std::size_t i) { g.Plane(Layer::kPosition, 1)[i] += 0.001f; });
  broken([](GuideSet& g, std::size_t i) { g.Plane(Layer::kAlbedo, 1)[i] += 0.01f; });
  broken([](GuideSet& g, std::size_t i) { g.Plane(Layer::kCoverage)[i] = i % 50 ? 1.0f : 0.0f; });
  broken([](GuideSet& g, std::size_t i) { g.Plane(Layer::kNormal, 2)[i] = std::nanf(""); });
}

TEST(Crosscheck, ALayerThatTheReferenceLacksFailsTheVerdict) {
  GuideSet reference = TwoObjects();
  reference.Remove(Layer::kAlbedo);
  const auto report = Crosscheck("scene", reference, TwoObjects());
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->skipped, std::vector<std::string>{"albedo"});
  EXPECT_FALSE(report->passed());
}

TEST(Crosscheck, NothingToCompareFailsTheVerdictAndUnequalSizesAreAnError) {
  GuideSet empty(40, 20);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) empty.Add(layer);
  const auto report = Crosscheck("scene", empty, empty);
  ASSERT_TRUE(report.ok());
  EXPECT_FALSE(report->passed());
  const auto json = nlohmann::json::parse(CrosscheckToJson({*report}), nullptr, false);
  ASSERT_TRUE(json.is_array());
  EXPECT_EQ(json[0]["reasons"][0], "nothing to compare: no object is wide enough, or the pictures do not agree at all");
  GuideSet small(39, 20);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) small.Add(layer);
  EXPECT_FALSE(Crosscheck("scene", empty, small).ok());
  small.Remove(Layer::kDepth);
  EXPECT_FALSE(Crosscheck("scene", small, small).ok());
}

// One pixel of an object's middle: its colour and its name are those of the background, whose id is 0.
TEST(Crosscheck, ValuesThatAreNoIdsAreShownAsNothing) {
  const auto with_pixel = [](float id) {
    GuideSet ours = TwoObjects();
    ours.Plane(Layer::kObject)[ours.Index(10, 10)] = id;
    const auto report = Crosscheck("scene", TwoObjects(), ours);
    EXPECT_TRUE(report.ok());
    return *report;
  };
  const auto look = [](const CrosscheckReport& report) {
    for (const CrosscheckPictures& pictures : report.pictures) {
      if (pictures.layer == "object") return pictures.ours.rgba;
    }
    ADD_FAILURE() << "no picture of the objects";
    return decltype(Picture::rgba)();
  };
  const CrosscheckReport nothing = with_pixel(0.0f);
  EXPECT_NE(look(nothing), look(with_pixel(7.0f)));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float id : {std::nanf(""), kInfinity, -kInfinity, -1.0f, 16777218.0f, 8589941760.0f, 1e30f}) {
    const CrosscheckReport report = with_pixel(id);
    EXPECT_EQ(report.too_thin, "id 0") << id;
    EXPECT_EQ(look(report), look(nothing)) << id;
  }
}

TEST(Crosscheck, ThePageIsOneFileAndEscapesNames) {
  const auto report = Crosscheck("a<b>&.glb", TwoObjects(), TwoObjects());
  const auto html = CrosscheckToHtml({*report}, {"Cycles", "scumble crosscheck \"a<b>\""});
  ASSERT_TRUE(html.ok());
  EXPECT_NE(html->find("a&lt;b&gt;&amp;.glb"), std::string::npos);
  EXPECT_EQ(html->find("<b>"), std::string::npos);
  EXPECT_EQ(html->find("://"), std::string::npos) << "nothing is loaded from elsewhere";
  EXPECT_NE(html->find("data:image/png;base64,iVBORw0KGgo"), std::string::npos) << "a PNG's first bytes";
}

}  // namespace
}  // namespace scumble
