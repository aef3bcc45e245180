#include "pipeline/frame/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "core/image/hash.h"
#include "core/io/existing_output.h"
#include "core/io/format_dispatch.h"
#include "core/style/finish_keys.h"
#include "pipeline/finish_layers.h"
#include "pipeline/finish_set.h"

namespace scumble {
namespace {

std::uint64_t HashOfGuides(const GuideSet& guides) {
  std::uint64_t hash = Hash(guides.width(), guides.height());
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c)
      hash = Hash(hash, HashText(info.name), c, HashBytes(guides.Plane(info.layer, c)));
  }
  return hash;
}

std::uint64_t HashOfPicture(const Picture& picture) {
  return Hash(picture.width, picture.height, HashBytes(std::span<const std::uint16_t>(picture.rgba)));
}

// A text of settings without one of its parts.
std::string WithoutPart(std::string text, const std::string& name) {
  const std::size_t begin = text.find("; " + name + " ");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find(';', begin + 1);
  return text.erase(begin, end == std::string::npos ? end : end - begin);
}

std::uint64_t HashOfExemplar(const Exemplar& exemplar) {
  const std::uint64_t hash = Hash(HashOfPicture(exemplar.picture), exemplar.is_sphere);
  return exemplar.guides ? Hash(hash, HashOfGuides(*exemplar.guides)) : hash;
}

}  // namespace

std::string TextOf(const TransferSettings& settings) {
  // All members by name: one more does not compile until it is written below.
  const auto& [method, nearest, nearest_error, guide_weights, threshold, threshold_metric, levels, jitter, jitter_fps,
               coherent, blend_radius, edge_aware, crease, depth_tolerance, luminance_weight, luminance_error, colorize,
               colorize_mode, variety, hybrid, match_step, scale, rim, edge, shadow, reference_height] = settings;
  std::string text;
  for (const auto word :
       {int(method), int(nearest), int(threshold_metric), levels, int(coherent), blend_radius, int(edge_aware),
        int(luminance_error), int(colorize_mode), int(edge), int(shadow), reference_height, match_step}) {
    text += fmt::format("{} ", word);
  }
  for (const double number : {double(threshold), double(jitter), jitter_fps, crease, depth_tolerance,
                              double(luminance_weight), colorize, variety, hybrid, scale, rim}) {
    text += fmt::format("{} ", number);
  }
  if (nearest_error > 0.0) text += fmt::format("nearest_error {} ", nearest_error);
  for (const LayerInfo& info : AllLayers()) text += fmt::format("{} ", double(guide_weights[info.layer]));
  return text;
}

std::uint64_t HashOfPaint(const Style& style) {
  std::uint64_t hash = style.exemplars.size();
  for (const Exemplar& exemplar : style.exemplars) {
    const std::string light = exemplar.luminance ? fmt::format("{}", *exemplar.luminance) : "";
    hash = Hash(hash, HashOfExemplar(exemplar), HashText(light), exemplar.margin);
  }
  if (style.paper.color) hash = Hash(hash, HashBytes(std::span<const std::uint16_t>(*style.paper.color)));
  if (style.paper.picture) hash = Hash(hash, HashOfPicture(*style.paper.picture));
  return hash;
}

std::uint64_t HashOfStyles(const StyleSet& styles, std::size_t count, ExemplarHashes& known) {
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Style& style = styles.styles[i];
    hash = Hash(hash, HashText(TextOf(style.transfer)), style.exemplars.size());
    for (std::size_t e = 0; e < style.exemplars.size(); ++e) {
      const Exemplar& exemplar = style.exemplars[e];
      const auto [place, is_new] = known.try_emplace({i, e}, 0);
      if (is_new) place->second = HashOfExemplar(exemplar);
      // What it is painted for matters where there are several.
      const bool lit = style.exemplars.size() > 1 && exemplar.luminance;
      hash = Hash(hash, place->second, HashText(lit ? fmt::format("{}", *exemplar.luminance) : ""));
    }
    if (style.paper.color) hash = Hash(hash, HashBytes(std::span<const std::uint16_t>(*style.paper.color)));
    if (style.paper.picture) hash = Hash(hash, HashOfPicture(*style.paper.picture));
    for (const FinishPass& pass : style.finish) hash = Hash(hash, HashText(FinishText(pass)));
  }
  for (const FinishPass& pass : styles.finish.passes) hash = Hash(hash, HashText(FinishText(pass)));
  for (const StyleSet::Assigned& one : styles.assigned) hash = Hash(hash, HashText(one.pattern.text()), one.style);
  return hash;
}

std::string FinishMeasuresPart(const std::string& measures, std::optional<bool> measured) {
  return fmt::format("; finish_measures {}; finish_measured {}", measures.empty() ? kAnySetting : measures,
                     measured ? *measured ? "yes" : "no" : kAnySetting);
}

std::string GuidesText(const std::map<std::string, std::string>& attributes, const std::string& chosen) {
  const auto settings = attributes.find(kSettingsKey);
  return (settings == attributes.end() ? "of another program" : settings->second) + chosen;
}

std::string SettingsText(const StyleSet& styles, const PictureSettings& settings, ExemplarHashes& known) {
  const auto& [seed, over, show, upsample, upscale, fps, exposure, measured, samples, show_finish, finish_measures,
               finish_measured, guides] = settings;  // all: each makes another picture
  std::string text = fmt::format("scumble {}; style {:016x}; seed {}; over {}; show {}; upsample {}", SCUMBLE_VERSION,
                                 HashOfStyles(styles, styles.chosen, known), seed, over ? "a picture" : "nothing",
                                 !show_finish.empty() ? kShowFinish + show_finish
                                 : show               ? ExplanationNames()[std::size_t(*show)]
                                                      : "result",
                                 upsample);
  if (upscale) text += " with --upscale";
  const auto chosen = std::span(styles.styles).first(styles.chosen);
  const bool asks_for_light = std::any_of(chosen.begin(), chosen.end(), AsksForLight);
  if (!samples.empty() && asks_for_light) text += "; samples " + samples;
  // Samples are told above, and their noise shows in light alone.
  std::string made = WithoutPart(guides, "samples");
  if (!asks_for_light) made = WithoutPart(std::move(made), "seed");
  text += "; guides " + (made.empty() ? kAnySetting : fmt::format("{:016x}", HashText(made)));
  text += "; fps " + (fps ? fmt::format("{}", double(fps->numerator) / double(fps->denominator)) : kAnySetting);
  if (EverLooksAtMeasures(styles)) text += FinishMeasuresPart(finish_measures, finish_measured);
  if (std::none_of(chosen.begin(), chosen.end(), LooksAtLight)) return text;
  text += "; exposure " + (exposure ? fmt::format("{}", *exposure) : kAnySetting);
  return text + "; measured " + (measured ? *measured ? "yes" : "no" : kAnySetting);
}

}  // namespace scumble
