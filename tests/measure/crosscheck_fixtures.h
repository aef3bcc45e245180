// Guides of both sides made by hand, for the cross-check's tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "measure/crosscheck.h"

namespace scumble {

constexpr Layer kCrosscheckLight[] = {Layer::kLpeFull, Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLpeLDDE,
                                      Layer::kLpeLD12E};

inline void FillLayer(GuideSet& guides, Layer layer, glm::vec3 value) {
  guides.Add(layer);
  for (int c = 0; c < 3; ++c) {
    for (float& v : guides.Plane(layer, c)) v = value[c];
  }
}

// One object that fills the picture: 16 × 12 pixels are compared.
inline GuideSet OneObject() {
  GuideSet guides(20, 16);
  for (const Layer layer :
       {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kPosition, Layer::kAlbedo}) {
    guides.Add(layer);
  }
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kCoverage)[i] = 1.0f;
    guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
    guides.Plane(Layer::kDepth)[i] = 4.0f;
    guides.Plane(Layer::kObject)[i] = 7.0f;
  }
  return guides;
}

// LDE (1, 0.5, 0.5), LSE 0, LDDE 0.5, LD12E (1.25, 0.75, 0.75), full = LDE + LDDE.
inline GuideSet DiffuseLight() {
  GuideSet guides(20, 16);
  FillLayer(guides, Layer::kLpeLDE, {1.0f, 0.5f, 0.5f});
  FillLayer(guides, Layer::kLpeLSE, glm::vec3(0.0f));
  FillLayer(guides, Layer::kLpeLDDE, glm::vec3(0.5f));
  FillLayer(guides, Layer::kLpeLD12E, {1.25f, 0.75f, 0.75f});
  FillLayer(guides, Layer::kLpeFull, {1.5f, 1.0f, 1.0f});
  return guides;
}

inline CrosscheckLight EqualLight(int samples) {
  return {samples, {DiffuseLight(), std::vector<std::uint8_t>(20 * 16, 0), false}, DiffuseLight()};
}

inline CrosscheckReport CheckLight(const std::vector<CrosscheckLight>& light,
                                   const CrosscheckOptions& options = {2, false}) {
  auto report = Crosscheck("scene", OneObject(), OneObject(), options);
  EXPECT_TRUE(report.ok());
  report->setup.max_bounces = 8;
  const Status status = CrosscheckLightLayers(OneObject(), OneObject(), light, options, *report);
  EXPECT_TRUE(status.ok());
  return *report;
}

inline CrosscheckFigure FigureOf(const CrosscheckReport& report, const std::string& layer,
                                 const std::string& name = "mean difference") {
  for (const CrosscheckFigure& figure : report.figures) {
    if (figure.layer == layer && figure.name == name) return figure;
  }
  ADD_FAILURE() << "no figure " << layer << " " << name;
  return {};
}

inline CrosscheckNoise NoiseOf(const CrosscheckReport& report, const std::string& layer) {
  for (const CrosscheckNoise& noise : report.noise) {
    if (noise.layer == layer) return noise;
  }
  ADD_FAILURE() << "no noise of " << layer;
  return {};
}

}  // namespace scumble
