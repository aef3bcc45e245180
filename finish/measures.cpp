#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/image/color.h"
#include "core/image/exact_math.h"
#include "finish/finish.h"

namespace scumble {
namespace {

// Of the covered pixels whose value is finite. `values` is reordered.
double Percentile(std::vector<float>& values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<float> CoveredValues(const GuideSet& guides, Layer layer) {
  std::vector<float> values;
  if (!guides.Has(layer)) return values;
  const auto coverage = guides.Plane(Layer::kCoverage), plane = guides.Plane(layer);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    if (coverage[i] > 0.0f && plane[i] >= 0.0f && plane[i] <= 3e38f) values.push_back(plane[i]);
  }
  return values;
}

bool Looks(const OutlinePass& pass) { return (pass.thin != 0.0 && pass.thin_at == 0.0) || pass.light != 0.0; }
bool Looks(const ShadowsPass& pass) { return pass.source != ShadowsPass::Source::kCast; }
bool Looks(const SmoothPass&) { return false; }
bool Looks(const EdgesPass& pass) { return pass.tone == EdgesPass::Tone::kLight; }
bool Looks(const HatchPass& pass) {
  return pass.tone == HatchPass::Tone::kLight || pass.along == HatchPass::Along::kLight;
}
bool Looks(const ToonPass& pass) {
  const bool has_rows = pass.shading == ToonPass::Shading::kRamp && pass.ramp_rows != ToonPass::Rows::kFacing;
  return pass.light == ToonPass::Light::kLuminance || has_rows;
}
bool Looks(const RenderPass&) { return true; }
bool Looks(const DepthPass& pass) { return pass.near == 0.0 || pass.far == 0.0; }
bool Looks(const TonesPass& pass) { return pass.tone == TonesPass::Tone::kLight; }
bool Looks(const PalettePass&) { return false; }
bool Looks(const GradePass&) { return false; }
bool Looks(const PigmentPass&) { return false; }
bool Looks(const FillPass&) { return false; }

}  // namespace

double AsPrinted(double value) { return RoundToDigits(value, 6); }

bool LooksAtMeasures(std::span<const FinishPass> passes) {
  return std::any_of(passes.begin(), passes.end(), [](const FinishPass& pass) {
    const bool changes_light = pass.at == FinishPass::Stage::kGuides && pass.guide == FinishPass::Guide::kLuminance;
    const bool looks = std::visit([](const auto& effect) { return Looks(effect); }, pass.effect);
    return pass.strength > 0.0 && (changes_light || looks);
  });
}

double CoveredShare(const GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  const auto covered = std::count_if(coverage.begin(), coverage.end(), [](float value) { return value > 0.0f; });
  return static_cast<double>(covered) / static_cast<double>(std::max<std::size_t>(1, coverage.size()));
}

FinishMeasures MeasureFinish(const GuideSet& guides) {
  FinishMeasures measures;
  if (std::vector<float> depth = CoveredValues(guides, Layer::kDepth); !depth.empty()) {
    measures.near = Percentile(depth, 0.02), measures.middle = Percentile(depth, 0.5);
    measures.far = Percentile(depth, 0.98);
  }
  if (std::vector<float> light = CoveredValues(guides, Layer::kLuminance); !light.empty()) {
    const double bright = Percentile(light, 0.9);
    if (bright > 0.0) measures.bright = bright;
  }
  if (guides.Has(Layer::kLpeFull)) {
    std::vector<float> full;
    const auto coverage = guides.Plane(Layer::kCoverage);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const glm::vec3 color = guides.Vec3(Layer::kLpeFull, i);
      const float light = Luminance(color.r, color.g, color.b);
      if (coverage[i] > 0.0f && light >= 0.0f && light <= 3e38f) full.push_back(light);
    }
    const double bright = full.empty() ? 0.0 : Percentile(full, 0.9);
    if (bright > 0.0) measures.full = bright;
  }
  for (double* value : {&measures.near, &measures.middle, &measures.far, &measures.bright, &measures.full})
    *value = AsPrinted(*value);
  return measures;
}

}  // namespace scumble
