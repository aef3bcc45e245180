#include "core/style/finish_keys.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/image/hash.h"
#include "core/style/color_ramp.h"
#include "core/style/finish/finish_mask_keys.h"
#include "core/style/finish/finish_tables.h"
#include "core/style/nearest_name.h"

namespace scumble {
namespace {

template <class Named>
std::vector<std::string> NamesOf(std::span<const Named> list) {
  std::vector<std::string> names;
  for (const Named& one : list) names.push_back(one.name);
  return names;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string DidYouMean(const std::string& given, const std::vector<std::string>& names) {
  const std::string meant = NearestName(given, names);
  return meant.empty() ? "" : "; did you mean " + meant + "?";
}

}  // namespace

std::optional<Rgb16> ParseColor(const std::string& text) {
  unsigned rgb = 0;
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  const auto parsed = std::from_chars(text.data() + 1, text.data() + text.size(), rgb, 16);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return std::nullopt;
  const auto channel = [&](int shift) { return static_cast<std::uint16_t>(((rgb >> shift) & 255u) * 257u); };
  return Rgb16{channel(16), channel(8), channel(0)};
}

std::string ColorText(const Rgb16& color) {
  const bool has_8_bits = std::all_of(color.begin(), color.end(), [](unsigned channel) { return channel % 257 == 0; });
  char text[16];
  std::snprintf(text, sizeof text, has_8_bits ? "#%02x%02x%02x" : "#%04x%04x%04x", color[0] / (has_8_bits ? 257u : 1u),
                color[1] / (has_8_bits ? 257u : 1u), color[2] / (has_8_bits ? 257u : 1u));
  return text;
}

std::optional<Rgb16> AsColor(const KeyValue& value) {
  if (const auto* color = std::get_if<Rgb16>(&value)) return *color;
  const auto* text = std::get_if<std::string>(&value);
  return text ? ParseColor(*text) : std::nullopt;
}

const FinishEffect* FindFinishEffect(const std::string& name) {
  for (const FinishEffect& effect : FinishEffects()) {
    if (effect.name == name) return &effect;
  }
  return nullptr;
}

const FinishEffect& EffectOf(const FinishPass& pass) {
  const auto has_it = [&](const FinishEffect& one) { return one.defaults.index() == pass.effect.index(); };
  return *std::find_if(FinishEffects().begin(), FinishEffects().end(), has_it);
}

const FinishKey* FindFinishKey(const FinishPass& pass, const std::string& name) {
  for (const auto keys : {std::span<const FinishKey>(EffectOf(pass).keys), CommonFinishKeys()}) {
    for (const FinishKey& key : keys) {
      if (key.name == name) return &key;
    }
  }
  return nullptr;
}

Expected<FinishPass> MakeFinishPass(const std::string& effect) {
  if (const FinishEffect* found = FindFinishEffect(effect)) {
    return FinishPass{effect, found->defaults, FinishPass::Stage::kPaint, 1.0, {}, {}};
  }
  const auto names = NamesOf(FinishEffects());
  return UsageError("there is no effect '" + effect + "'; there are " + Listed(names) + DidYouMean(effect, names));
}

Status SetFinishKey(FinishPass& pass, const std::string& name, const KeyValue& value) {
  if (const FinishKey* key = FindFinishKey(pass, name)) return key->set(pass, value);
  if (name == "objects" || name == "materials") {
    const auto* names = std::get_if<std::vector<std::string>>(&value);
    if (!names) {
      return UsageError(std::holds_alternative<std::string>(value) ? internal::kNamesExpected
                                                                   : "expected names with commas between");
    }
    (name == "objects" ? pass.objects : pass.materials) = *names;
    return Ok();
  }
  auto names = NamesOf(std::span<const FinishKey>(EffectOf(pass).keys));
  for (const FinishKey& key : CommonFinishKeys()) names.push_back(key.name);
  return UsageError("effect " + EffectOf(pass).name + " has no key '" + name + "'; it has " + Listed(names) +
                    DidYouMean(name, names));
}

Expected<std::size_t> SetFinishKeys(std::span<FinishPass> passes, const std::string& key, const KeyValue& value) {
  const std::size_t begin = std::string_view(kFinishKeys).size(), dot = key.find('.', begin);
  if (key.rfind(kFinishKeys, 0) != 0 || dot == std::string::npos) {
    return UsageError("expected finish.NAME.KEY, as in finish.outline.width");
  }
  const std::string name = key.substr(begin, dot - begin);
  std::size_t count = 0;
  for (FinishPass& pass : passes) {
    if (pass.name != name) continue;
    SCUMBLE_RETURN_IF_ERROR(SetFinishKey(pass, key.substr(dot + 1), value));
    ++count;
  }
  return count;
}

namespace {

double UpTo(double most, double value) { return std::clamp(value, 0.0, most); }

// Gooch's cool side, `factor` times as far from the warm one.
void TurnCool(double factor, ToonPass& toon) {
  if (factor == 1.0) return;
  for (std::size_t c = 0; c < toon.cool.size(); ++c) {
    const double warm = toon.warm[c] / 257u, cool = toon.cool[c] / 257u;  // whole steps of 1/255, which text can hold
    const double turned = UpTo(255.0, warm + (cool - warm) * factor);
    toon.cool[c] = static_cast<std::uint16_t>(257u * static_cast<unsigned>(turned + 0.5));
  }
  toon.cool_base = UpTo(1.0, toon.warm_base + (toon.cool_base - toon.warm_base) * factor);
}

// `factor` is 0 … 2.
void TurnDial(const std::string& dial, double factor, FinishPass& pass) {
  if (dial == "lines") {
    if (auto* const outline = std::get_if<OutlinePass>(&pass.effect))
      outline->width = UpTo(64.0, outline->width * factor);
    if (auto* const edges = std::get_if<EdgesPass>(&pass.effect)) {
      edges->width = std::clamp(edges->width * factor, 0.5, 32.0);
      if (factor == 0.0) pass.strength = 0.0;
    }
    if (auto* const hatch = std::get_if<HatchPass>(&pass.effect)) {
      hatch->bare = UpTo(1.0, hatch->bare * factor);
      if (factor > 1.0) hatch->spacing = std::max(2.0, hatch->spacing / factor);
      if (factor == 0.0) pass.strength = 0.0;
    }
  } else if (dial == "detail") {
    // Evening out: all of it and more below the middle, less and less above.
    const double even = 2.0 - factor;
    auto* const smooth = std::get_if<SmoothPass>(&pass.effect);
    auto* const tones = std::get_if<TonesPass>(&pass.effect);
    if (smooth && even > 1.0) smooth->radius = std::min(32.0, smooth->radius * even);
    // Of the paint's own lightness fewer tones would be rougher: more strokes cross the higher steps.
    if (tones && even > 1.0 && tones->tone == TonesPass::Tone::kLight)
      tones->bins = std::max(2, static_cast<int>(tones->bins / even + 0.5));
    if (smooth) pass.strength = UpTo(1.0, pass.strength * even);
    if (tones) pass.strength *= std::min(1.0, even);
    // Lines inside objects.
    if (auto* const outline = std::get_if<OutlinePass>(&pass.effect)) {
      for (const LineClass line :
           {LineClass::kCrease, LineClass::kMaterial, LineClass::kTexture, LineClass::kSuggestive}) {
        double& share = outline->of_class[std::size_t(line)];
        share = UpTo(4.0, share * factor);
      }
    }
  } else if (dial == "light") {
    if (auto* const shadows = std::get_if<ShadowsPass>(&pass.effect)) {
      pass.strength = UpTo(1.0, pass.strength * factor);
      if (factor > 1.0)
        shadows->full = UpTo(4.0, shadows->full * factor), shadows->none = UpTo(4.0, shadows->none * factor);
    }
    if (auto* const hatch = std::get_if<HatchPass>(&pass.effect)) hatch->shade = UpTo(4.0, hatch->shade * factor);
    if (auto* const toon = std::get_if<ToonPass>(&pass.effect)) {
      toon->shade = UpTo(1.0, 1.0 - (1.0 - toon->shade) * factor);
      toon->tint = UpTo(1.0, toon->tint * factor);
      TurnCool(factor, *toon);
    }
    if (auto* const outline = std::get_if<OutlinePass>(&pass.effect))
      outline->light = std::clamp(outline->light * factor, -2.0, 2.0);
  } else if (auto* const outline = std::get_if<OutlinePass>(&pass.effect)) {
    outline->thin = UpTo(2.0, outline->thin * factor);
  } else if (auto* const depth = std::get_if<DepthPass>(&pass.effect)) {
    for (double* const part : {&depth->desaturate, &depth->tint, &depth->air}) *part = UpTo(1.0, *part * factor);
    depth->blur = UpTo(64.0, depth->blur * factor);
  }
}

}  // namespace

Status TurnFinishDial(std::span<FinishPass> passes, const std::string& key, const KeyValue& value) {
  const std::string name = key.substr(std::string_view(kDialKeys).size());
  const std::vector<std::string> names(std::begin(kDials), std::end(kDials));
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    return UsageError("there is no dial '" + name + "'; there are " + Listed(names) + DidYouMean(name, names));
  }
  const auto number = AsNumber(value);
  if (!number || !(*number >= 0.0 && *number <= 1.0)) return UsageError("expected a number, 0 to 1");
  for (FinishPass& pass : passes) TurnDial(name, 2.0 * *number, pass);
  return Ok();
}

namespace {

// Numbers with all digits of a float.
std::string ExactText(const KeyValue& value) {
  const auto* number = std::get_if<double>(&value);
  if (!number || !std::isfinite(*number)) return ToText(value);
  char text[40];
  const char* const end = std::to_chars(text, text + sizeof text, static_cast<float>(*number)).ptr;
  return std::string(static_cast<const char*>(text), end);
}

}  // namespace

std::string FinishText(const FinishPass& pass) {
  std::string text = EffectOf(pass).name;
  const FinishPass defaults{"", EffectOf(pass).defaults, FinishPass::Stage::kPaint, 1.0, {}, {}};
  for (const auto keys : {CommonFinishKeys(), std::span<const FinishKey>(EffectOf(pass).keys)}) {
    for (const FinishKey& key : keys) {
      const std::string value = ExactText(key.get(pass));
      if (value != ExactText(key.get(defaults))) text += " " + key.name + "=" + value;
    }
  }
  // A file may change under its name.
  if (const auto* palette = std::get_if<PalettePass>(&pass.effect)) {
    for (const auto& colors : {palette->target, palette->source}) {
      if (!colors) continue;
      for (const double number : colors->mean) text += " " + ExactText(KeyValue(number));
      for (const double number : colors->covariance) text += " " + ExactText(KeyValue(number));
    }
  }
  if (const auto* hatch = std::get_if<HatchPass>(&pass.effect); hatch && hatch->texture) {
    const auto& finest = hatch->texture->levels.front().thresholds;
    text += " " + ToText(KeyValue(std::int64_t(HashBytes(std::span<const float>(finest)) >> 1)));
  }
  const auto* toon = std::get_if<ToonPass>(&pass.effect);
  if (toon && toon->ramp_colors && !IsRampText(toon->ramp)) {
    const auto& colors = toon->ramp_colors->colors;
    text += " " + ToText(KeyValue(std::int64_t(HashBytes(std::span<const Rgb16>(colors)) >> 1)));
  }
  for (const std::string& name : pass.objects) text += " object " + name;
  for (const std::string& name : pass.materials) text += " material " + name;
  if (pass.mask.picture) {
    char content[24];
    std::snprintf(content, sizeof content, " of %016llx",
                  static_cast<unsigned long long>(HashBytes(std::span<const std::uint16_t>(pass.mask.picture->rgba))));
    text += content;
  }
  return text;
}

}  // namespace scumble
