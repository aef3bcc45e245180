#include "finish/finish.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/filter/light_contour.h"
#include "core/filter/oklab_rows.h"
#include "core/filter/parallel.h"
#include "core/image/check.h"
#include "core/image/hash.h"
#include "core/image/jitter_rate.h"
#include "finish/area/area_effects.h"
#include "finish/area/ink.h"
#include "finish/area/oklab_blocks.h"
#include "finish/hatch/hatch.h"
#include "finish/jitter_rate.h"
#include "finish/outline/outline.h"
#include "finish/points/point_loop.h"
#include "finish/smooth/smooth.h"
#include "finish/tone/point_effect.h"
#include "finish/tone/toon_bands.h"

namespace scumble {
namespace {

using internal::HardLight, internal::IsOfGuides, internal::OklabBlock, internal::PointEffect, internal::PointStep;

// Background has no light and no colour of its own: what looks at them leaves it as it is, a renderer's sky too. What
// depth does to it is another thing.
std::span<const float> CoverageFor(const FinishPass& pass, const FinishFrame& frame) {
  const auto* const tones = std::get_if<TonesPass>(&pass.effect);
  const bool looks = (tones && tones->tone == TonesPass::Tone::kLight) ||
                     std::holds_alternative<ShadowsPass>(pass.effect) ||
                     std::holds_alternative<ToonPass>(pass.effect) || std::holds_alternative<RenderPass>(pass.effect) ||
                     std::holds_alternative<DepthPass>(pass.effect);
  return looks ? frame.guides->Plane(Layer::kCoverage) : std::span<const float>();
}

// Whether a point effect depends on more of the picture than the pixel: what comes before it must be painted.
bool LooksAtPicture(const FinishStep& step) {
  const auto* palette = std::get_if<PalettePass>(&step.pass.effect);
  const auto* depth = std::get_if<DepthPass>(&step.pass.effect);
  return (palette && !palette->source && !(step.colors && *step.colors)) || (depth && depth->blur > 0.0);
}

// The picture where the step's share is 1, what was before where it is 0, and of both in between: their sum by shares
// of the codes times alpha, which is what ink of so much less strength gives.
void MixByShare(const Picture& before, std::span<const std::uint16_t> shares, Picture& picture) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, shares.size(), 1 << 14), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      if (shares[i] == 65535) continue;
      const std::uint16_t* const from = before.rgba.data() + 4 * i;
      std::uint16_t* const to = picture.rgba.data() + 4 * i;
      if (shares[i] == 0 || std::equal(from, from + 4, to)) {
        std::copy_n(from, 4, to);
        continue;
      }
      const double share = shares[i] / 65535.0;
      const double of_from = from[3] * (1.0 - share), of_to = to[3] * share, alpha = of_from + of_to;
      if (!(alpha > 0.0)) continue;
      for (int c = 0; c < 3; ++c) to[c] = static_cast<std::uint16_t>((from[c] * of_from + to[c] * of_to) / alpha + 0.5);
      to[3] = static_cast<std::uint16_t>(alpha + 0.5);
    }
  });
}

// The colours that a palette changes.
ColorSpread SourceOf(const PalettePass& palette, const FinishStep& step, const Picture& picture) {
  if (palette.source) return *palette.source;
  if (step.colors && *step.colors) return **step.colors;
  ColorSpread colors = MeasureColors(picture, step.only);
  if (!step.colors) return colors;
  for (double& value : colors.mean) value = AsPrinted(value);
  for (double& value : colors.covariance) value = AsPrinted(value);
  return *(*step.colors = colors);
}

// The light that toon cuts or shades by; it lies in `light`. Borders that are not soft are steps.
std::vector<HardLight> LightsOf(const ToonPass& pass, const FinishFrame& frame, std::span<const float> light) {
  if (light.empty() || !(pass.softness > 0.0)) return {};
  const auto bright = static_cast<float>(internal::BrightestOf(pass, frame));
  return {{light, internal::kHardStep * bright, pass.bands, static_cast<float>(pass.bands) / bright}};
}

// The light whose contours shade has: those of cast shadows, where it has any. Form shade ends softly but for creases.
std::vector<HardLight> LightsOf(const ShadowsPass& pass, const FinishFrame& frame) {
  const GuideSet& guides = *frame.guides;
  const float hard = HasExactLight(guides) ? internal::kHardStep : internal::kHardStepInNoise;
  if (pass.source != ShadowsPass::Source::kForm) return {{guides.Plane(Layer::kShadow), hard}};
  return {{guides.Plane(Layer::kLuminance), hard * static_cast<float>(frame.measures.bright)}};
}

// Of green light, most of luminance.
std::vector<HardLight> LightsOf(const RenderPass&, const FinishFrame& frame) {
  const auto hard = internal::kHardStepInNoise * static_cast<float>(frame.measures.full);
  return {{frame.guides->Plane(Layer::kLpeFull, 1), hard}};
}

// The effect, where it treats each pixel by itself, and the light that it looks at. `picture`: as the steps before have
// left it, if LooksAtPicture.
std::optional<PointEffect> PointEffectOf(const FinishStep& step, const FinishFrame& frame, Picture& picture,
                                         std::vector<HardLight>& lights) {
  const FinishPass& pass = step.pass;
  const bool is_of_sheet = pass.at == FinishPass::Stage::kSheet;
  if (is_of_sheet && std::holds_alternative<FillPass>(pass.effect)) return std::nullopt;  // raises alpha
  struct {
    const FinishStep& step;
    const FinishFrame& frame;
    Picture& picture;
    std::vector<HardLight>& lights;
    std::optional<PointEffect> operator()(const OutlinePass&) { return std::nullopt; }
    std::optional<PointEffect> operator()(const SmoothPass&) { return std::nullopt; }
    std::optional<PointEffect> operator()(const EdgesPass&) { return std::nullopt; }
    std::optional<PointEffect> operator()(const HatchPass&) { return std::nullopt; }
    std::optional<PointEffect> operator()(const PigmentPass&) { return std::nullopt; }
    std::optional<PointEffect> operator()(const ToonPass& one) {
      const auto light = std::make_shared<const internal::FloatPlane>(internal::ToonLight(one, frame));
      lights = LightsOf(one, frame, *light);
      return [light, effect = internal::MakeToon(one, frame, *light)](
                 std::size_t first, std::size_t count, OklabBlock& block) { effect(first, count, block); };
    }
    std::optional<PointEffect> operator()(const RenderPass& one) {
      lights = LightsOf(one, frame);
      return internal::MakeRender(one, frame);
    }
    std::optional<PointEffect> operator()(const TonesPass& one) {
      if (one.tone == TonesPass::Tone::kPaint) return internal::MakeTones(one);
      const auto light =
          std::make_shared<const internal::FloatPlane>(internal::ToneOf(EdgesPass::Tone::kLight, frame, picture));
      lights = {{*light, internal::kHardStep}};
      return [light, effect = internal::MakeTones(one, *light)](std::size_t first, std::size_t count,
                                                                OklabBlock& block) { effect(first, count, block); };
    }
    std::optional<PointEffect> operator()(const ShadowsPass& one) {
      if (!(one.soften > 0.0)) {
        lights = LightsOf(one, frame);
        return internal::MakeShadows(one, frame);
      }
      const auto shade = std::make_shared<const internal::FloatPlane>(internal::SoftShade(one, frame));
      return [shade, effect = internal::MakeShadows(one, frame, *shade)](
                 std::size_t first, std::size_t count, OklabBlock& block) { effect(first, count, block); };
    }
    std::optional<PointEffect> operator()(const DepthPass& one) {
      if (one.blur > 0.0) {
        const Picture before = step.share.empty() ? Picture() : picture;
        internal::BlurByDepth(step, frame, picture);
        if (!before.empty()) MixByShare(before, step.share, picture);
      }
      return internal::MakeDepth(one, step.pass.at, frame);
    }
    std::optional<PointEffect> operator()(const PalettePass& one) {
      return internal::MakePalette(one, SourceOf(one, step, picture));
    }
    std::optional<PointEffect> operator()(const GradePass& one) { return internal::MakeGrade(one); }
    std::optional<PointEffect> operator()(const FillPass& one) { return internal::MakeFill(one); }
  } make{step, frame, picture, lights};
  return std::visit(make, pass.effect);
}

// What the step's pass leaves to chance, for the frame. Draw 0 has the frame's own seed.
std::uint64_t SeedOf(const FinishStep& step, const FinishFrame& frame) {
  const std::int64_t draw = JitterStep(JitterFpsOf(step.pass), frame.frame, frame.fps_numerator, frame.fps_denominator);
  return draw == 0 ? frame.seed : Hash(frame.seed, 8, draw);
}

// The frame with the step's own lengths and seed.
FinishFrame FrameOf(const FinishStep& step, FinishFrame frame) {
  frame.steady_seed = frame.seed;
  frame.seed = SeedOf(step, frame);
  if (step.reference_height < 0 || !frame.guides) return frame;
  frame.scale = step.reference_height > 0 ? double(frame.guides->height()) / step.reference_height : 1.0;
  return frame;
}

// One colour on all of the sheet, where nothing is painted, too.
void FillSheet(const FillPass& fill, double strength, std::span<const std::uint8_t> only, Picture& picture) {
  const std::uint16_t ink[4] = {fill.color[0], fill.color[1], fill.color[2],
                                static_cast<std::uint16_t>(strength * 65535.0 + 0.5)};
  for (std::size_t i = 0; i < picture.rgba.size() / 4 && ink[3] != 0; ++i) {
    if (only.empty() || only[i]) internal::LayInk(ink, picture.rgba.data() + 4 * i);
  }
}

// An effect that looks at more than the pixel itself.
void ApplyToAll(const FinishStep& step, const FinishFrame& frame, Picture& picture) {
  const FinishPass& pass = step.pass;
  if (const auto* outline = std::get_if<OutlinePass>(&pass.effect)) {
    internal::DrawOutline(*outline, pass.strength, step.only, step.share, frame, picture);
  } else if (const auto* smooth = std::get_if<SmoothPass>(&pass.effect)) {
    internal::Smooth(*smooth, pass.strength, step.only, frame, picture);
  } else if (const auto* edges = std::get_if<EdgesPass>(&pass.effect)) {
    internal::DrawEdges(*edges, pass.strength, step.only, IsOfGuides(step), frame, picture);
  } else if (const auto* hatch = std::get_if<HatchPass>(&pass.effect)) {
    internal::DrawHatch(*hatch, pass.strength, step.only, IsOfGuides(step), frame, picture);
  } else if (const auto* pigment = std::get_if<PigmentPass>(&pass.effect)) {
    internal::Pigment(*pigment, pass.strength, step.only, frame, picture);
  } else if (const auto* fill = std::get_if<FillPass>(&pass.effect)) {
    FillSheet(*fill, pass.strength, step.only, picture);
  }
}

Status Apply(std::span<const FinishStep* const> steps, FinishFrame frame, const Progress& progress, Picture& picture) {
  const double share = 1.0 / static_cast<double>(steps.size());
  for (std::size_t i = 0; i < steps.size();) {
    std::vector<PointStep> points;
    const std::size_t begin = i;
    for (; i < steps.size(); ++i) {
      if (i > begin && LooksAtPicture(*steps[i])) break;
      std::vector<HardLight> lights;
      std::optional<PointEffect> effect = PointEffectOf(*steps[i], FrameOf(*steps[i], frame), picture, lights);
      if (!effect) break;
      points.push_back({*std::move(effect), steps[i], CoverageFor(steps[i]->pass, frame), {}, std::move(lights)});
      if (const auto* depth = std::get_if<DepthPass>(&steps[i]->pass.effect))
        points.back().behind = internal::MakeDepthOfBackground(*depth, steps[i]->pass.at, frame);
    }
    if (!points.empty()) {
      internal::RowProgress rows(progress, share * double(begin), share * double(i), std::max(1, picture.height));
      if (!internal::PaintPoints(points, frame, rows, picture)) return CancelledError();
      continue;
    }
    const FinishStep& step = *steps[i++];
    const bool draws = std::holds_alternative<OutlinePass>(step.pass.effect);  // lines have the share of their surface
    Picture before;
    if (!step.share.empty() && !draws) before = picture;
    ApplyToAll(step, FrameOf(step, frame), picture);
    if (!before.empty()) MixByShare(before, step.share, picture);
    if (internal::HidesPaint(step)) frame.strokes = {};
    if (progress && !progress(share * double(i))) return CancelledError();
  }
  return Ok();
}

std::string DepthText(double given, double measured) {
  char text[80];
  std::snprintf(text, sizeof text, given > 0.0 ? "%g m" : "%g m, as measured", given > 0.0 ? given : measured);
  return text;
}

// Whether the pass's far lies beyond its near; not known where neither is given or measured.
Status CheckDepths(const FinishPass& pass, const FinishMeasures& measures) {
  const auto* depth = std::get_if<DepthPass>(&pass.effect);
  if (!depth) return Ok();
  const double near = depth->near > 0.0 ? depth->near : measures.near,
               far = depth->far > 0.0 ? depth->far : measures.far;
  const bool is_given = depth->near > 0.0 || depth->far > 0.0;
  if (!is_given || far == 0.0 || near < far) return Ok();
  return InputError("finish " + pass.name + ": near is " + DepthText(depth->near, measures.near) + ", far is " +
                    DepthText(depth->far, measures.far) + ": set finish." + pass.name + ".near below finish." +
                    pass.name + ".far");
}

Status CheckThresholds(const FinishPass& pass) {
  const auto* toon = std::get_if<ToonPass>(&pass.effect);
  if (!toon || toon->thresholds.empty() || toon->thresholds.size() + 1 == std::size_t(toon->bands)) return Ok();
  return InputError("finish " + pass.name + ": thresholds has " + std::to_string(toon->thresholds.size()) +
                    " numbers, and bands is " + std::to_string(toon->bands) + ": set finish." + pass.name +
                    ".bands to " + std::to_string(toon->thresholds.size() + 1));
}

Status CheckMask(const FinishPass& pass) {
  const FinishMask& mask = pass.mask;
  if (!(mask.near > 0.0) || !(mask.far > 0.0) || mask.near < mask.far) return Ok();
  return InputError("finish " + pass.name + ": mask_near is " + DepthText(mask.near, 0.0) + ", mask_far is " +
                    DepthText(mask.far, 0.0) + ": set mask_near below mask_far, or one of them to 0, which is open");
}

}  // namespace

Status CheckRamp(const FinishPass& pass) {
  const auto* toon = std::get_if<ToonPass>(&pass.effect);
  if (!toon || toon->shading != ToonPass::Shading::kRamp || toon->ramp_colors) return Ok();
  return InputError("finish " + pass.name + ": shading is \"ramp\", and there are no colours for it: set finish." +
                    pass.name + ".ramp to colours from dark to light, \"#202040 #fff4d0\", or to a picture's file");
}

Status CheckFinish(std::span<const FinishStep> steps, const GuideSet* guides, const FinishMeasures& measures) {
  for (const FinishStep& step : steps) {
    const LayerSet needed = RequiredLayers(step.pass), held = guides ? guides->layers() : LayerSet();
    LayerSet lacking;
    for (const LayerInfo& info : AllLayers()) {
      if (needed.Has(info.layer) && !held.Has(info.layer)) lacking.Add(info.layer);
    }
    if (!(step.pass.strength > 0.0)) continue;
    SCUMBLE_RETURN_IF_ERROR(CheckDepths(step.pass, measures));
    if (const auto* palette = std::get_if<PalettePass>(&step.pass.effect); palette && !palette->target) {
      return InputError("finish " + step.pass.name + ": there is no painting whose palette it could take: set finish." +
                        step.pass.name + ".like to a picture's file, or to colours, \"#203050 #f0e0c0\"");
    }
    SCUMBLE_RETURN_IF_ERROR(CheckRamp(step.pass));
    SCUMBLE_RETURN_IF_ERROR(CheckThresholds(step.pass));
    SCUMBLE_RETURN_IF_ERROR(CheckMask(step.pass));
    const auto* outline = std::get_if<OutlinePass>(&step.pass.effect);
    if (outline && outline->form == OutlinePass::Form::kField && outline->side != OutlinePass::Side::kCentre) {
      return InputError("finish " + step.pass.name + ": form is \"field\", which knows no sides: set finish." +
                        step.pass.name + ".side to \"centre\", or finish." + step.pass.name + ".form to \"strokes\"");
    }
    if (outline && outline->thin > 0.0 && guides && guides->camera && guides->camera->IsOrthographic()) {
      return InputError("finish " + step.pass.name +
                        ": thin makes distant lines thinner, and in an orthographic view nothing gets smaller: set "
                        "finish." +
                        step.pass.name + ".thin to 0");
    }
    if (lacking.empty()) continue;
    return InputError("finish " + step.pass.name + " needs " + lacking.ToString() + "; " +
                      (guides ? "the guides hold " + held.ToString() + ": make them with --layers " + lacking.ToString()
                              : "there are no guides: name a guide file of this picture"));
  }
  return Ok();
}

Status ApplyFinish(std::span<const FinishStep> steps, FinishPass::Stage stage, const FinishFrame& frame, int threads,
                   const Progress& progress, Picture& picture) {
  SCUMBLE_RETURN_IF_ERROR(CheckFinish(steps, frame.guides, frame.measures));
  std::vector<const FinishStep*> chosen;
  for (const FinishStep& step : steps) {
    if (step.pass.at == stage && step.pass.strength > 0.0) chosen.push_back(&step);
  }
  if (chosen.empty() || picture.empty()) return Ok();
  if (frame.guides) {
    SCUMBLE_CHECK_EQ(frame.guides->width(), picture.width);
    SCUMBLE_CHECK_EQ(frame.guides->height(), picture.height);
  }
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  return arena.execute([&] { return Apply(chosen, frame, progress, picture); });
}

}  // namespace scumble
