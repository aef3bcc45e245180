#include "core/style/finish_keys.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/image/hash.h"
#include "core/style/finish_mask_keys.h"
#include "core/style/nearest_name.h"

namespace scumble {
namespace {

// Of a member of one effect.
template <class Pass, class T>
T& PassMember(FinishPass& pass, T Pass::*field) {
  return std::get<Pass>(pass.effect).*field;
}
template <class Pass, class T>
const T& PassMember(const FinishPass& pass, T Pass::*field) {
  return std::get<Pass>(pass.effect).*field;
}

std::string FinishRange(double least, double most) {
  char text[80];
  std::snprintf(text, sizeof text, "%g to %g", least, most);
  return text;
}

template <class Field>  // gives double& of a pass
FinishKey FinishNumber(const char* name, Field field, double least, double most, const char* help) {
  FinishKey key{name, KeyKind::kNumber, least, most, {}, "", help + (", " + FinishRange(least, most)), {}, {}};
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto number = AsNumber(value);
    if (!number || !(*number >= least && *number <= most)) {
      return UsageError("expected a number, " + FinishRange(least, most));
    }
    field(pass) = *number;
    return Ok();
  };
  key.get = [=](const FinishPass& pass) -> KeyValue {
    FinishPass copy = pass;
    return field(copy);
  };
  return key;
}

template <class Pass>
FinishKey PassNumber(const char* name, double Pass::*field, double least, double most, const char* help) {
  return FinishNumber(
      name, [=](FinishPass& pass) -> double& { return PassMember(pass, field); }, least, most, help);
}

template <class Pass>
FinishKey PassWhole(const char* name, int Pass::*field, int least, int most, const char* help) {
  FinishKey key{
      name, KeyKind::kWhole, double(least), double(most), {}, "", help + (", " + FinishRange(least, most)), {}, {}};
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* number = std::get_if<std::int64_t>(&value);
    if (!number || *number < least || *number > most) {
      return UsageError("expected a whole number, " + FinishRange(least, most));
    }
    PassMember(pass, field) = static_cast<int>(*number);
    return Ok();
  };
  key.get = [=](const FinishPass& pass) -> KeyValue { return std::int64_t(PassMember(pass, field)); };
  return key;
}

template <class Field>  // gives an enum& of a pass, counted from 0 as `choices` are
FinishKey FinishChoice(const char* name, Field field, std::vector<std::string> choices, const char* help) {
  FinishKey key{name, KeyKind::kChoice, 0.0, 0.0, choices, "", help, {}, {}};
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    const auto found = text ? std::find(choices.begin(), choices.end(), *text) : choices.end();
    if (found != choices.end()) {
      auto& member = field(pass);
      member = static_cast<std::decay_t<decltype(member)>>(found - choices.begin());
      return Ok();
    }
    std::string expected = "expected ";
    for (std::size_t i = 0; i < choices.size(); ++i) {
      expected += (i == 0 ? "\"" : i + 1 < choices.size() ? ", \"" : " or \"") + choices[i] + '"';
    }
    return UsageError(expected);
  };
  key.get = [=](const FinishPass& pass) -> KeyValue {
    FinishPass copy = pass;
    return choices[static_cast<std::size_t>(field(copy))];
  };
  return key;
}

template <class Pass, class T>
FinishKey PassChoice(const char* name, T Pass::*field, std::vector<std::string> choices, const char* help) {
  return FinishChoice(
      name, [=](FinishPass& pass) -> T& { return PassMember(pass, field); }, std::move(choices), help);
}

template <class Pass>
FinishKey PassColor(const char* name, Rgb16 Pass::*field, const char* help) {
  FinishKey key{name, KeyKind::kText, 0.0, 0.0, {}, "", help, {}, {}};
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    const auto color = text ? ParseColor(*text) : std::nullopt;
    if (!color) return UsageError(kColorForm);
    PassMember(pass, field) = *color;
    return Ok();
  };
  key.get = [=](const FinishPass& pass) -> KeyValue {
    const Rgb16& color = PassMember(pass, field);
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", color[0] / 257u, color[1] / 257u, color[2] / 257u);
    return std::string(text);
  };
  return key;
}

template <class Pass>
FinishKey PassText(const char* name, std::string Pass::*field, const char* help) {
  FinishKey key{name, KeyKind::kText, 0.0, 0.0, {}, "", help, {}, {}};
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) return UsageError("expected a text in quotes");
    PassMember(pass, field) = *text;
    return Ok();
  };
  key.get = [=](const FinishPass& pass) -> KeyValue { return PassMember(pass, field); };
  return key;
}

template <class Pass>
FinishKey PassFlag(const char* name, bool Pass::*field, const char* help) {
  FinishKey key{name, KeyKind::kFlag, 0.0, 0.0, {}, "", help, {}, {}};
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* flag = std::get_if<bool>(&value);
    if (!flag) return UsageError("expected true or false");
    PassMember(pass, field) = *flag;
    return Ok();
  };
  key.get = [=](const FinishPass& pass) -> KeyValue { return PassMember(pass, field); };
  return key;
}

FinishKey LineWidth(const char* name, LineClass line, const char* help) {
  const auto field = [=](FinishPass& pass) -> double& {
    return std::get<OutlinePass>(pass.effect).of_class[std::size_t(line)];
  };
  return FinishNumber(name, field, 0.0, 4.0, help);
}

std::vector<FinishKey> OutlineKeys() {
  using P = OutlinePass;
  return {
      PassNumber("width", &P::width, 0.0, 64.0, "of lines, pixels"),
      PassNumber("min_width", &P::min_width, 0.0, 64.0, "that depth and light thin no line below, pixels"),
      LineWidth("silhouette", LineClass::kSilhouette, "share of the width of lines against nothing"),
      LineWidth("object", LineClass::kObject, "the same between objects"),
      LineWidth("occlusion", LineClass::kOcclusion, "the same where a part hides another of its own object"),
      LineWidth("crease", LineClass::kCrease, "the same along creases"),
      LineWidth("material", LineClass::kMaterial, "the same between materials"),
      LineWidth("shadow", LineClass::kShadow, "the same around shadows"),
      LineWidth("texture", LineClass::kTexture, "the same where the base colour changes"),
      PassNumber("crease_angle", &P::crease_angle, 0.0, 180.0, "of normals beside a crease, at least, degrees"),
      PassNumber("texture_step", &P::texture_step, 0.0, 2.0, "of base colours beside a line, at least, in Oklab"),
      PassNumber("thin", &P::thin, 0.0, 2.0, "lines get thinner with distance: width * (thin_at / depth)^thin"),
      PassNumber("thin_at", &P::thin_at, 0.0, 1e9, "depth of the plain width, metres; 0: the first picture's middle"),
      PassNumber("light", &P::light, -2.0, 2.0, "lines get thinner in light: width * (1 + light * (1/2 - luminance))"),
      PassNumber("taper", &P::taper, 0.0, 512.0, "length over which lines end in a point, pixels"),
      PassNumber("wobble", &P::wobble, 0.0, 16.0, "how far lines stray, pixels"),
      PassNumber("wobble_length", &P::wobble_length, 1.0, 512.0, "of the waves of that, pixels"),
      PassFlag("stick", &P::stick, "the waves stick to surfaces, not to the picture"),
      PassChoice("color", &P::color, {"ink", "paint", "complement"},
                 "ink, or paint: the paint beside the line, darker; or complement: its opposite hue"),
      PassColor("ink", &P::ink, "the colour of ink"),
      PassChoice("side", &P::side, {"centre", "inside", "outside"}, "of the nearer surface's border")};
}

std::vector<FinishKey> ToonKeys() {
  using P = ToonPass;
  return {
      PassWhole("bands", &P::bands, 1, 64, "bands of light"),
      PassNumber("softness", &P::softness, 0.0, 16.0, "half the width of a band's border, pixels"),
      PassNumber("shade", &P::shade, 0.0, 1.0, "lightness of the darkest band, as a share of the brightest's"),
      PassNumber("tint", &P::tint, 0.0, 1.0, "how much of the colour's hue the darkest band takes on"),
      PassColor("color", &P::color, "of tint"),
      PassChoice("base", &P::base, {"albedo", "paint"}, "what the bands shade: the scene's base colour, or the paint")};
}

std::vector<FinishKey> SmoothKeys() {
  using P = SmoothPass;
  return {
      PassNumber("radius", &P::radius, 0.5, 32.0, "of the filter, pixels: sigma; of kuwahara and guided the reach"),
      PassNumber("range", &P::range, 0.001, 1.0, "difference of colours that counts half, in Oklab; not of kuwahara"),
      PassWhole("passes", &P::passes, 1, 8, "times it is applied"),
      PassFlag("borders", &P::borders, "objects are not mixed; wavelets also stop at normals and depths"),
      PassChoice("filter", &P::filter, {"bilateral", "kuwahara", "guided", "wavelets"},
                 "bilateral; kuwahara: patches like brush marks; guided: fast at any radius; or wavelets")};
}

std::vector<FinishKey> EdgesKeys() {
  using P = EdgesPass;
  return {PassNumber("width", &P::width, 0.5, 32.0, "of a line along a step of the tone, pixels"),
          PassNumber("sharpness", &P::sharpness, 0.0, 200.0, "higher: fainter steps make lines"),
          PassNumber("threshold", &P::threshold, 0.0, 1.0, "tone below which ink begins"),
          PassNumber("slope", &P::slope, 0.1, 100.0, "how fast it gets dense below that"),
          PassNumber("fill", &P::fill, 0.0, 1.0, "1 fills what is dark with ink, 0 draws lines alone"),
          PassNumber("flow", &P::flow, 0.0, 16.0, "lines are evened out along the edge: sigma, pixels"),
          PassChoice("tone", &P::tone, {"paint", "light", "albedo"},
                     "what is looked at: the paint, the light or base colours"),
          PassChoice("draw", &P::draw, {"ink", "paint"},
                     "ink over the paint, or the paint itself on paper where lines are"),
          PassChoice("color", &P::color, {"ink", "paint", "complement"},
                     "ink, or paint: the paint below it, darker; or complement: its opposite hue"),
          PassColor("ink", &P::ink, "the colour of ink"),
          PassColor("paper", &P::paper, "behind draw = paint")};
}

std::vector<FinishKey> HatchKeys() {
  using P = HatchPass;
  return {PassNumber("spacing", &P::spacing, 2.0, 128.0, "from stroke to stroke, pixels"),
          PassNumber("patch", &P::patch, 8.0, 1024.0, "size of patches of one direction, pixels"),
          PassChoice("along", &P::along, {"around", "along", "fixed"},
                     "around forms, along them, or in the fixed direction `angle`"),
          PassNumber("angle", &P::angle, -180.0, 180.0, "where a surface has no direction, degrees, 0 along a row"),
          PassNumber("cross", &P::cross, 0.0, 90.0, "from one layer of strokes to the next, degrees"),
          PassWhole("layers", &P::layers, 1, 4, "layers of strokes"),
          PassNumber("fullest", &P::fullest, 0.05, 1.0, "share of ink at which the next layer begins"),
          PassNumber("bare", &P::bare, 0.0, 1.0, "tone from which on nothing is hatched"),
          PassNumber("wobble", &P::wobble, 0.0, 16.0, "how far strokes stray, pixels"),
          PassText("strokes", &P::strokes, "lines; or of pencil, pen, charcoal; or the file of a threshold texture"),
          PassChoice("tone", &P::tone, {"light", "paint"}, "what is looked at: the light or the paint"),
          PassColor("ink", &P::ink, "the colour of ink")};
}

std::vector<FinishKey> RenderKeys() {
  using P = RenderPass;
  return {PassNumber("exposure", &P::exposure, -16.0, 16.0, "stops; 0: the first picture's brightest tenth is at 0.8"),
          PassNumber("white", &P::white, 1.0, 100.0, "the linear value that becomes white")};
}

std::vector<FinishKey> TonesKeys() {
  using P = TonesPass;
  return {PassWhole("bins", &P::bins, 2, 64, "steps of lightness"),
          PassNumber("sharpness", &P::sharpness, 0.0, 64.0, "of the steps; 0: none show")};
}

std::vector<FinishKey> ShadowsKeys() {
  using P = ShadowsPass;
  return {
      PassChoice("mode", &P::mode, {"black", "darker", "color", "complement", "chiaroscuro", "impression", "negative"},
                 "what shade looks like"),
      PassChoice("source", &P::source, {"cast", "form", "both"}, "cast shadows, faces turned from the light, or both"),
      PassNumber("full", &P::full, 0.0, 4.0, "luminance up to which a face is in full shade, 1: the brightest tenth's"),
      PassNumber("none", &P::none, 0.0, 4.0, "luminance from which on it is not"),
      PassColor("color", &P::color, "of mode color, and the hue of complement where paint is grey")};
}

std::vector<FinishKey> DepthKeys() {
  using P = DepthPass;
  return {PassNumber("near", &P::near, 0.0, 1e9,
                     "depth where the effect begins, metres; 0: the first picture's 2nd percentile"),
          PassNumber("far", &P::far, 0.0, 1e9, "depth where it is full, metres; 0: the 98th percentile"),
          PassNumber("focus", &P::focus, 0.0, 1e9, "depth that stays as it is, metres; 0: near"),
          PassNumber("gamma", &P::gamma, 0.1, 10.0, "above 1 spares what is near"),
          PassWhole("layers", &P::layers, 0, 64, "flat layers of depth; 0: it is smooth"),
          PassChoice("metric", &P::metric, {"linear", "inverse"}, "linear in depth, or in its reciprocal"),
          PassNumber("desaturate", &P::desaturate, 0.0, 1.0, "chroma lost"),
          PassNumber("tint", &P::tint, 0.0, 1.0, "share of the colour's hue and chroma taken on"),
          PassNumber("air", &P::air, 0.0, 1.0, "share of the colour that the air adds at far"),
          PassColor("color", &P::color, "of tint and air"),
          PassNumber("blur", &P::blur, 0.0, 64.0, "sigma where the effect is full, pixels"),
          PassText("focus_on", &P::focus_on, "an object whose middle depth is the focus; a name, * and ? fit any")};
}

std::vector<FinishKey> PaletteKeys() {
  using P = PalettePass;
  return {
      PassText("like", &P::like, "whose colours: painting, the style's own; a picture's file; or \"#203050 #f0e0c0\""),
      PassText("from", &P::from, "a picture's file whose colours become those; empty: the picture's own"),
      PassNumber("gain", &P::gain, 1.0, 16.0, "most that the spread of colours grows"),
      PassFlag("keep_lightness", &P::keep_lightness, "hue and chroma change alone")};
}

std::vector<FinishKey> PigmentKeys() {
  using P = PigmentPass;
  return {PassNumber("edge", &P::edge, 0.0, 4.0, "pigment that gathers inside borders of objects"),
          PassNumber("edge_width", &P::edge_width, 0.5, 128.0, "of that, pixels"),
          PassNumber("turbulence", &P::turbulence, 0.0, 2.0, "more and less pigment in clouds"),
          PassNumber("turbulence_size", &P::turbulence_size, 2.0, 2048.0, "of the largest clouds, pixels"),
          PassNumber("granulation", &P::granulation, 0.0, 2.0, "grains of pigment"),
          PassNumber("grain_size", &P::grain_size, 0.5, 64.0, "of grains, pixels"),
          PassNumber("thin", &P::thin, 0.0, 1.0, "less pigment where it is light"),
          PassNumber("tremor", &P::tremor, 0.0, 32.0, "how far shapes stray, pixels"),
          PassNumber("tremor_size", &P::tremor_size, 2.0, 512.0, "of the waves of that, pixels"),
          PassFlag("stick", &P::stick, "clouds stick to surfaces, not to the picture")};
}

std::vector<FinishKey> GradeKeys() {
  using P = GradePass;
  return {PassNumber("saturation", &P::saturation, 0.0, 4.0, "factor of chroma"),
          PassNumber("contrast", &P::contrast, 0.0, 4.0, "factor of lightness around its middle"),
          PassNumber("lift", &P::lift, -1.0, 1.0, "added to lightness")};
}

std::vector<FinishKey> MakeCommonKeys() {
  std::vector<FinishKey> keys = {
      FinishNumber(
          "strength", [](FinishPass& pass) -> double& { return pass.strength; }, 0.0, 1.0, "share of the effect"),
      FinishChoice(
          "at", [](FinishPass& pass) -> FinishPass::Stage& { return pass.at; }, {"paint", "sheet"},
          "paint: objects alone; sheet: the paper behind them, too")};
  for (FinishKey& key : FinishMaskKeys()) keys.push_back(std::move(key));
  const FinishPass defaults{"", OutlinePass(), FinishPass::Stage::kPaint, 1.0, {}, {}};
  for (FinishKey& key : keys) key.default_value = ToText(key.get(defaults));
  return keys;
}

std::vector<FinishEffect> MakeEffects() {
  std::vector<FinishEffect> effects = {
      {"render", "the light of the scene itself instead of the paint", RenderPass(), RenderKeys()},
      {"toon", "flat bands of light instead of the paint, or over it", ToonPass(), ToonKeys()},
      {"smooth", "even colour, sharp edges", SmoothPass(), SmoothKeys()},
      {"tones", "lightness in steps", TonesPass(), TonesKeys()},
      {"shadows", "what is in shade: darker, black, in another colour", ShadowsPass(), ShadowsKeys()},
      {"depth", "what is far: paler, tinted, in haze, in layers", DepthPass(), DepthKeys()},
      {"palette", "the colours of an example", PalettePass(), PaletteKeys()},
      {"grade", "saturation, contrast and lightness", GradePass(), GradeKeys()},
      {"pigment", "watercolour: darker edges, clouds, grains, a trembling hand", PigmentPass(), PigmentKeys()},
      {"fill", "one colour instead of the paint", FillPass(), {PassColor("color", &FillPass::color, "of everything")}},
      {"edges", "lines where the tone changes", EdgesPass(), EdgesKeys()},
      {"hatch", "strokes of ink in the shade, around the forms", HatchPass(), HatchKeys()},
      {"outline", "ink lines along silhouettes, objects, creases, shadows", OutlinePass(), OutlineKeys()}};
  for (FinishEffect& effect : effects) {
    const FinishPass defaults{"", effect.defaults, FinishPass::Stage::kPaint, 1.0, {}, {}};
    for (FinishKey& key : effect.keys) key.default_value = ToText(key.get(defaults));
  }
  return effects;
}

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

std::span<const FinishEffect> FinishEffects() {
  static const std::vector<FinishEffect> effects = MakeEffects();
  return effects;
}

std::span<const FinishKey> CommonFinishKeys() {
  static const std::vector<FinishKey> keys = MakeCommonKeys();
  return keys;
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
    const auto* text = std::get_if<std::string>(&value);
    if (!text) return UsageError("expected names with commas between");
    std::vector<std::string>& list = name == "objects" ? pass.objects : pass.materials;
    list.clear();
    for (std::size_t begin = 0; begin <= text->size() && !text->empty();) {
      const std::size_t end = std::min(text->find(',', begin), text->size());
      list.push_back(text->substr(begin, end - begin));
      begin = end + 1;
    }
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
      if (factor == 0.0) pass.strength = 0.0;
    }
  } else if (dial == "detail") {
    // Evening out: all of it and more below the middle, less and less above.
    const double even = 2.0 - factor;
    auto* const smooth = std::get_if<SmoothPass>(&pass.effect);
    auto* const tones = std::get_if<TonesPass>(&pass.effect);
    if (smooth && even > 1.0) smooth->radius = std::min(32.0, smooth->radius * even);
    if (tones && even > 1.0) tones->bins = std::max(2, static_cast<int>(tones->bins / even + 0.5));
    if (smooth || tones) pass.strength *= std::min(1.0, even);
  } else if (dial == "light") {
    if (auto* const shadows = std::get_if<ShadowsPass>(&pass.effect)) {
      pass.strength = UpTo(1.0, pass.strength * factor);
      if (factor > 1.0)
        shadows->full = UpTo(4.0, shadows->full * factor), shadows->none = UpTo(4.0, shadows->none * factor);
    }
    if (auto* const toon = std::get_if<ToonPass>(&pass.effect)) {
      toon->shade = UpTo(1.0, 1.0 - (1.0 - toon->shade) * factor);
      toon->tint = UpTo(1.0, toon->tint * factor);
    }
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

std::string FinishText(const FinishPass& pass) {
  std::string text = EffectOf(pass).name;
  for (const auto keys : {CommonFinishKeys(), std::span<const FinishKey>(EffectOf(pass).keys)}) {
    for (const FinishKey& key : keys) {
      const std::string value = ToText(key.get(pass));
      if (value != key.default_value) text += " " + key.name + "=" + value;
    }
  }
  // A file may change under its name.
  if (const auto* palette = std::get_if<PalettePass>(&pass.effect)) {
    for (const auto& colors : {palette->target, palette->source}) {
      if (!colors) continue;
      for (const double number : colors->mean) text += " " + ToText(KeyValue(number));
      for (const double number : colors->covariance) text += " " + ToText(KeyValue(number));
    }
  }
  if (const auto* hatch = std::get_if<HatchPass>(&pass.effect); hatch && hatch->texture) {
    const auto& finest = hatch->texture->levels.front().thresholds;
    text += " " + ToText(KeyValue(std::int64_t(HashBytes(std::span<const float>(finest)) >> 1)));
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
