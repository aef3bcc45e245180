#include "pipeline/variant/quality_ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "core/image/check.h"
#include "core/style/style_keyframes.h"
#include "core/style/style_keys.h"

namespace scumble {
namespace {

// What a step may set of the style, and where that would change something.
struct VariantSetting {
  StyleOverride set;
  bool (*changes)(const TransferSettings& settings);
  bool (*raises)(const TransferSettings& settings) = nullptr;  // to more than the style itself has; null: never
};

enum SettingName { kStyleBlit, kLitSphere, kCrisp, kUnsplit };

const VariantSetting& SettingOf(SettingName name) {
  static const std::vector<VariantSetting> kSettings = {
      {MakeOverride("transfer.method", std::string("styleblit")),
       [](const TransferSettings& settings) { return settings.method == Method::kBruteForce; },
       [](const TransferSettings& settings) { return settings.method == Method::kLitSphere; }},
      {MakeOverride("transfer.method", std::string("litsphere")),
       [](const TransferSettings& settings) { return settings.method != Method::kLitSphere; }},
      {MakeOverride("transfer.blend_radius", std::int64_t(0)),
       [](const TransferSettings& settings) { return settings.blend_radius != 0; }},
      {MakeOverride("transfer.hybrid", 0.0), [](const TransferSettings& settings) { return settings.hybrid != 0.0; }},
  };
  return kSettings[name];
}

// Of a pixel. Fewer samples cost noise that hardly shows in paint, so they are dropped first, but for those that the
// eye would miss.
constexpr int kManySamples = std::numeric_limits<int>::max(), kSomeSamples = 16, kFewSamples = 4;

struct LadderStep {
  int upsample;
  std::vector<SettingName> settings;
  int samples = kFewSamples;  // at most
  bool upscale = false;       // of the picture, not of its guides
};

// By rising texture, the mean over scenes and styles: docs/budget.md. The Lit Sphere comes last, where nothing else is
// quick enough.
const std::vector<LadderStep>& LadderSteps() {
  static const std::vector<LadderStep> kSteps = {
      {1, {}, kManySamples},
      {1, {}, kSomeSamples},
      {1, {}},
      {1, {kStyleBlit}},
      {2, {kStyleBlit}},
      {1, {kStyleBlit, kCrisp}},
      {4, {kStyleBlit}},
      {2, {kStyleBlit}, kFewSamples, true},
      {1, {kStyleBlit, kUnsplit}},
      {1, {kStyleBlit, kUnsplit, kCrisp}},
      {2, {kStyleBlit, kUnsplit, kCrisp}},
      {4, {kStyleBlit, kCrisp}, kFewSamples, true},
      {1, {kLitSphere, kUnsplit, kCrisp}},
      {4, {kLitSphere, kUnsplit, kCrisp}, kFewSamples, true},
  };
  return kSteps;
}

bool IsSetByUser(const StyleSet& styles, std::size_t style, const std::string& key) {
  return std::any_of(styles.overrides.begin(), styles.overrides.end(), [&](const StyleSet::Override& one) {
    if (one.key != key) return false;
    if (one.style.empty()) return true;
    const auto place = styles.opened.find(one.path);
    return place != styles.opened.end() && place->second == style;
  });
}

bool HasTrack(const Style& style, const std::string& key) {
  return std::any_of(style.tracks.begin(), style.tracks.end(), [&](const StyleTrack& one) { return one.name == key; });
}

bool ChangesSomething(const VariantSetting& setting, const StyleSet& styles) {
  for (std::size_t i = 0; i < styles.styles.size(); ++i) {
    if (IsSetByUser(styles, i, setting.set.key)) continue;
    if (HasTrack(styles.styles[i], setting.set.key) || setting.changes(styles.styles[i].transfer)) return true;
  }
  return false;
}

bool RaisesSomething(const VariantSetting& setting, const StyleSet& styles) {
  for (std::size_t i = 0; i < styles.styles.size(); ++i) {
    if (setting.raises && !IsSetByUser(styles, i, setting.set.key) && setting.raises(styles.styles[i].transfer))
      return true;
  }
  return false;
}

// Then a search in the tree for each pixel takes longer than that of the chunks for each seed.
bool WeighGuides(const StyleSet& styles) {
  return std::any_of(styles.styles.begin(), styles.styles.end(),
                     [](const Style& style) { return !style.transfer.guide_weights.ArePlain(); });
}

// How much smaller the guides can be, at most `upsample` times.
int SmallerBy(int upsample, const LadderFrame& frame) {
  if (!frame.casts || frame.fixed_guides) return 1;
  while (frame.width % upsample || frame.height % upsample) upsample /= 2;
  return upsample;
}

Variant MakeVariant(const LadderStep& step, const StyleSet& styles, const LadderFrame& frame) {
  Variant variant;
  variant.guide_scale = 1.0 / SmallerBy(step.upsample, frame);
  variant.upscale = step.upscale && variant.guide_scale < 1.0 && !frame.full_size;
  if (step.samples < frame.samples) variant.samples = step.samples;
  for (SettingName setting : step.settings) {
    if (setting == kLitSphere && WeighGuides(styles)) setting = kStyleBlit;
    if (!ChangesSomething(SettingOf(setting), styles)) continue;
    // All styles take one setting, and none may come to more than it has: then all take the least.
    if (RaisesSomething(SettingOf(setting), styles)) setting = kLitSphere;
    variant.settings.push_back(SettingOf(setting).set);
  }
  variant.name = variant.value = OptionsOf(variant);
  variant.axis = "quality";
  if (variant.name.empty()) variant.name = variant.value = "the style";
  return variant;
}

}  // namespace

std::vector<Variant> QualityLadder(const StyleSet& styles, const LadderFrame& frame) {
  std::vector<Variant> variants;
  for (const LadderStep& step : LadderSteps()) {
    Variant variant = MakeVariant(step, styles, frame);
    const bool known =
        std::any_of(variants.begin(), variants.end(), [&](const Variant& other) { return other.name == variant.name; });
    if (!known) variants.push_back(std::move(variant));
  }
  return variants;
}

Variant VariantOf(Quality quality, const StyleSet& styles, const LadderFrame& frame) {
  if (quality == Quality::kFinal) return MakeVariant(LadderSteps().front(), styles, frame);
  const bool lit = std::any_of(styles.styles.begin(), styles.styles.end(), LooksAtLight);
  const bool shrinks = SmallerBy(2, frame) > 1;
  if (quality == Quality::kDraft) {
    if (shrinks && !frame.full_size) return MakeVariant({2, {kStyleBlit}, kFewSamples, true}, styles, frame);
    // Not unsplit: large chunks without their own tone are another paint.
    return MakeVariant({lit ? 2 : 1, {kStyleBlit, kCrisp}}, styles, frame);
  }
  // Guides of normals alone take so little that nothing is gained which would not be seen.
  if (frame.casts && !lit) return MakeVariant({1, {kStyleBlit}}, styles, frame);
  return MakeVariant(shrinks ? LadderStep{2, {kStyleBlit}} : LadderStep{1, {kStyleBlit, kCrisp}}, styles, frame);
}

std::string OptionsOf(const Variant& variant) {
  std::string text;
  const auto add = [&](const std::string& option) { text += (text.empty() ? "" : " ") + option; };
  if (UpsampleOf(variant) > 1) add(fmt::format("--upsample {}", UpsampleOf(variant)));
  if (variant.upscale) add("--upscale");
  if (variant.samples > 0) add(fmt::format("--samples {}", variant.samples));
  for (const StyleOverride& setting : variant.settings) add("--set " + setting.text);
  return text;
}

Status ApplyVariant(const Variant& variant, StyleSet& styles) {
  for (const StyleOverride& setting : variant.settings) {
    const StyleKey* const key = FindStyleKey(setting.key);
    SCUMBLE_CHECK(key != nullptr);
    for (std::size_t i = 0; i < styles.styles.size(); ++i) {
      if (IsSetByUser(styles, i, setting.key)) continue;
      RemoveTrack(styles.styles[i], setting.key);
      SCUMBLE_RETURN_IF_ERROR(key->set(styles.styles[i], std::get<KeyValue>(setting.value), {}));
    }
  }
  std::vector<StyleSet::Override> first;
  for (const StyleOverride& setting : variant.settings) first.push_back({setting, ""});
  styles.overrides.insert(styles.overrides.begin(), first.begin(), first.end());
  return Ok();
}

}  // namespace scumble
