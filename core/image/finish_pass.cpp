#include "core/image/finish_pass.h"

namespace scumble {
namespace {

LayerSet Of(const OutlinePass& pass) {
  const auto is_on = [&](LineClass line) { return pass.of_class[std::size_t(line)] > 0.0; };
  LayerSet layers{Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject};
  if (is_on(LineClass::kMaterial)) layers.Add(Layer::kMaterial);
  if (is_on(LineClass::kTexture)) layers.Add(Layer::kAlbedo);
  if (is_on(LineClass::kShadow)) layers.Add(Layer::kShadow);
  if (pass.light != 0.0) layers.Add(Layer::kLuminance);
  const bool strays = pass.wobble > 0.0 && pass.form == OutlinePass::Form::kStrokes;
  if (pass.stick && (strays || pass.gaps > 0.0)) layers.Add(Layer::kPref);
  return layers;
}

LayerSet Of(const ShadowsPass& pass) {
  LayerSet layers{Layer::kCoverage};
  if (pass.source != ShadowsPass::Source::kForm) layers.Add(Layer::kShadow);
  if (pass.source != ShadowsPass::Source::kCast) layers.Add(Layer::kLuminance);
  if (pass.soften > 0.0) layers.Add(Layer::kObject);
  return layers;
}

LayerSet Of(const ToonPass& pass) {
  LayerSet layers{Layer::kCoverage, Layer::kObject};
  if (pass.light == ToonPass::Light::kLuminance) {
    layers.Add(Layer::kLuminance);
  } else {
    layers.Add(Layer::kCosine);
    if (pass.cast > 0.0) layers.Add(Layer::kShadow);
  }
  if (pass.shading == ToonPass::Shading::kRamp) {
    if (pass.ramp_rows == ToonPass::Rows::kDepth) layers.Add(Layer::kDepth);
    if (pass.ramp_rows == ToonPass::Rows::kFacing) layers.Add(Layer::kNormal);
    if (pass.ramp_rows == ToonPass::Rows::kHighlight) layers.Add({Layer::kLpeLSE, Layer::kLuminance});
  } else if (pass.base == ToonPass::Color::kAlbedo) {
    layers.Add(Layer::kAlbedo);
  }
  return layers;
}

LayerSet Of(const SmoothPass& pass) {
  if (!pass.borders) return {};
  if (pass.filter == SmoothPass::Filter::kWavelets) return {Layer::kObject, Layer::kNormal, Layer::kDepth};
  return {Layer::kObject};
}

LayerSet Of(const EdgesPass& pass) {
  LayerSet layers;
  if (pass.tone != EdgesPass::Tone::kPaint) layers.Add(Layer::kCoverage);
  if (pass.tone == EdgesPass::Tone::kLight) layers.Add(Layer::kLuminance);
  if (pass.tone == EdgesPass::Tone::kAlbedo) layers.Add(Layer::kAlbedo);
  if (pass.borders) layers.Add(Layer::kObject);
  return layers;
}

LayerSet Of(const HatchPass& pass) {
  LayerSet layers;
  using Along = HatchPass::Along;
  if (pass.along != Along::kFixed) layers.Add({Layer::kCoverage, Layer::kObject});
  if (pass.along == Along::kAround || pass.along == Along::kAlong) layers.Add(Layer::kNormal);
  if (pass.along == Along::kDepth) layers.Add(Layer::kDepth);
  if (pass.along == Along::kLight || pass.tone == HatchPass::Tone::kLight)
    layers.Add({Layer::kCoverage, Layer::kLuminance});
  if (pass.stick) layers.Add({Layer::kCoverage, Layer::kObject, Layer::kDepth, Layer::kPref});
  return layers;
}

LayerSet Of(const RenderPass&) { return {Layer::kCoverage, Layer::kLpeFull}; }
LayerSet Of(const DepthPass& pass) {
  return pass.focus_on.empty() ? LayerSet{Layer::kDepth} : LayerSet{Layer::kDepth, Layer::kCoverage, Layer::kObject};
}

LayerSet Of(const PigmentPass& pass) {
  LayerSet layers;
  if (pass.edge > 0.0) layers.Add({Layer::kCoverage, Layer::kObject});
  if (pass.stick) layers.Add({Layer::kCoverage, Layer::kObject, Layer::kDepth, Layer::kPref});
  return layers;
}

LayerSet Of(const PalettePass&) { return {}; }
LayerSet Of(const TonesPass& pass) {
  return pass.tone == TonesPass::Tone::kLight ? LayerSet{Layer::kCoverage, Layer::kLuminance} : LayerSet();
}
LayerSet Of(const GradePass&) { return {}; }
LayerSet Of(const FillPass&) { return {}; }

}  // namespace

Layer ChangedLayer(FinishPass::Guide guide) {
  return guide == FinishPass::Guide::kAlbedo ? Layer::kAlbedo : Layer::kLuminance;
}

LayerSet RequiredLayers(const FinishPass& pass) {
  if (!(pass.strength > 0.0)) return {};
  LayerSet layers = std::visit([](const auto& effect) { return Of(effect); }, pass.effect);
  if (!pass.objects.empty()) layers.Add(Layer::kObject);
  if (!pass.materials.empty()) layers.Add(Layer::kMaterial);
  if (pass.mask.HasDepth()) layers.Add(Layer::kDepth);
  if (pass.at == FinishPass::Stage::kGuides) layers.Add({Layer::kCoverage, ChangedLayer(pass.guide)});
  return layers;
}

}  // namespace scumble
