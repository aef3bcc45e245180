#include "pipeline/prepare_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/painting/soft_edge.h"
#include "core/style/finish_keys.h"
#include "core/style/place_sphere.h"
#include "core/style/style_keyframes.h"
#include "core/style/style_keys.h"
#include "measure/paint_faults.h"
#include "pipeline/frame/frame_painter.h"

namespace scumble {
namespace {

Expected<PreparedStyle> PrepareAndWarn(const Style& style, int height, const RunContext& context) {
  SCUMBLE_ASSIGN(PreparedStyle prepared, PrepareStyle(style, height, context));
  if (style.transfer.edge == EdgeMode::kExemplar && prepared.rims.empty()) {
    context.Warn(
        "style " + style.name +
        ": transfer.edge is \"exemplar\", but the exemplar has no painted edge, because its paint does not end "
        "near the rim on bare paper; outlines stay exact. Leave paper free in the corners, or set it to \"exact\"");
  }
  return prepared;
}

// Of exemplars that are used otherwise than as they stand in their files.
void NoteExemplarUse(const Style& style, const RunContext& context) {
  for (const Exemplar& exemplar : style.exemplars) {
    if (exemplar.cut) context.Note(exemplar.name + ": " + DescribeCut(*exemplar.cut));
    const int soft_edge = exemplar.is_sphere ? SoftEdge(exemplar.picture) : 0;
    if (soft_edge > style.transfer.rim) {
      context.Warn(fmt::format("{}: {}; accept this with --set transfer.rim={}, or flatten the picture on its paper",
                               exemplar.name, DescribeSoftEdge(soft_edge), soft_edge));
    }
  }
}

LayerSet LayersRead(const StyleSet& styles) {
  LayerSet read = LayersOverTime(styles.finish);
  for (const Style& style : styles.styles) {
    if (const Expected<LayerSet> of_style = LayersOverTime(style)) read.Add(*of_style);
  }
  return read;
}

}  // namespace

void MeasureFinishOf(const StyleSet& styles, const GuideSet& guides, std::optional<int> frame,
                     const RunContext& context, PictureState& state) {
  if (state.finish_measures || !EverLooksAtMeasures(styles)) return;
  state.finish_measures = styles.options.finish_measures;
  if (!state.finish_measures) state.finish_measures = MeasureAndTell(guides, LayersRead(styles), frame, context);
}

bool IsReadEachFrame(const std::string& key) {
  if (key.rfind(kFinishKeys, 0) == 0) return true;
  const StyleKey* const found = FindStyleKey(key);
  return found && !found->needs_preparing;
}

Status PrepareFrame(StyleSet& styles, const GuideSet& guides, const PictureRequest& request, const RunContext& context,
                    PictureState& state) {
  const int height = guides.height() * request.GuideFactor();
  const bool all = state.prepared.empty() || state.prepared.front().output_height != height;
  SCUMBLE_RETURN_IF_ERROR(SetFinishFrame(styles.finish, request.frame.value_or(0)));
  for (std::size_t i = 0; i < styles.styles.size(); ++i) {
    SCUMBLE_ASSIGN(const auto changed, SetStyleFrame(styles.styles[i], request.frame.value_or(0)));
    if (all || changed.empty() || i >= state.prepared.size()) continue;
    if (std::all_of(changed.begin(), changed.end(), IsReadEachFrame)) {
      state.prepared[i].settings = styles.styles[i].transfer;
      state.prepared[i].required = TransferLayers(styles.styles[i]);
      continue;
    }
    Expected<PreparedStyle> one = PrepareAndWarn(styles.styles[i], height, context);
    if (!one) {
      state.prepared.resize(i);  // the style has moved on: what was prepared of it is stale
      return std::move(one).error();
    }
    state.prepared[i] = *std::move(one);
  }
  if (all) state.prepared.clear();
  // All of them, or those that the scene has asked for since.
  for (std::size_t i = state.prepared.size(); i < styles.styles.size(); ++i) {
    SCUMBLE_RETURN_IF_ERROR(context.CheckNotCancelled());
    SCUMBLE_ASSIGN(PreparedStyle one, PrepareAndWarn(styles.styles[i], height, context));
    NoteExemplarUse(styles.styles[i], context);
    for (const auto& [image, what, fix] : EqualLights(styles.styles[i], one)) {
      context.Warn(image + " " + what + ": " + fix);
    }
    state.prepared.push_back(std::move(one));
  }
  if (state.exposure) return Ok();
  state.exposure = ExposureOf(request.exposure, state.prepared, guides, context.threads);
  if (!MeasuresExposure(styles, request)) return Ok();
  if (CoveredShare(guides) == 0.0) {
    context.Warn(
        "the picture shows no surface, so no exposure was measured, and it is 0 stops: where it is one of a sequence, "
        "give --exposure of a frame that shows something");
  } else {
    context.Note(fmt::format("exposure: {:.2f} stops; --exposure {:.2f} repeats it", *state.exposure, *state.exposure));
  }
  return Ok();
}

std::vector<EqualLight> EqualLights(const Style& style, const PreparedStyle& prepared) {
  std::vector<EqualLight> equal;
  const auto luminances = prepared.illumination.luminances();
  for (std::size_t later = 1; later < luminances.size(); ++later) {
    const auto first = std::find(luminances.begin(), luminances.begin() + std::ptrdiff_t(later), luminances[later]);
    const auto index = static_cast<std::size_t>(first - luminances.begin());
    if (index == later) continue;
    equal.push_back(
        {style.exemplars[later].name,
         fmt::format("has the luminance {:.4g} as {} has, which stands first and is taken, so it never shows",
                     luminances[later], style.exemplars[index].name),
         "give each [[exemplar]] its own"});
  }
  return equal;
}

std::string DescribeLuminance(const Exemplar& exemplar, double rim) {
  const bool by_guides = exemplar.guides && exemplar.guides->Has(Layer::kLuminance);
  const char* const source = exemplar.luminance ? "given"
                             : by_guides        ? "measured from its guides"
                                                : "measured from its paint";
  return fmt::format("luminance {:.4g}, {}", LuminanceOf(exemplar, rim), source);
}

bool MeasuresExposure(const StyleSet& styles, const PictureRequest& request) {
  return !request.exposure && std::any_of(styles.styles.begin(), styles.styles.end(), LooksAtLight);
}

}  // namespace scumble
