// The tables of finish_keys.h.
#include <algorithm>
#include <cstdio>
#include <locale>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/image/jitter_rate.h"
#include "core/style/color_ramp.h"
#include "core/style/finish/finish_mask_keys.h"
#include "core/style/finish_keys.h"
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

// As transfer.jitter_fps.
template <class Pass>
FinishKey PassJitter(double Pass::*field) {
  FinishKey key = PassNumber("jitter_fps", field, -1.0, kMostJitterFps,
                             "redraws a second of what is random; 0: none, -1: in each frame");
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto number = AsNumber(value);
    if (!number || !(*number == -1.0 || (*number >= 0.0 && *number <= kMostJitterFps))) {
      return UsageError("expected -1 (in each frame), 0 (never) or up to 1000 redraws a second");
    }
    PassMember(pass, field) = *number;
    return Ok();
  };
  return key;
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
    const std::string meant = text ? NearestName(*text, choices) : "";
    return UsageError(expected + (meant.empty() ? "" : "; did you mean \"" + meant + "\"?"));
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
    const auto color = AsColor(value);
    if (!color) return UsageError(kColorForm);
    PassMember(pass, field) = *color;
    return Ok();
  };
  key.get = [=](const FinishPass& pass) -> KeyValue { return PassMember(pass, field); };
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
      LineWidth("object", LineClass::kObject, "share of the width of lines between objects"),
      LineWidth("occlusion", LineClass::kOcclusion,
                "share of the width of lines where a part hides another of its own object"),
      LineWidth("crease", LineClass::kCrease, "share of the width of lines along creases"),
      LineWidth("material", LineClass::kMaterial, "share of the width of lines between materials"),
      LineWidth("shadow", LineClass::kShadow, "share of the width of lines around shadows"),
      LineWidth("texture", LineClass::kTexture, "share of the width of lines where the base colour changes"),
      LineWidth("suggestive", LineClass::kSuggestive,
                "share of the width of lines in valleys that are nearly a silhouette"),
      PassNumber("crease_angle", &P::crease_angle, 0.0, 180.0,
                 "of normals beside a crease, at least, degrees; a crease continues down to two thirds of it"),
      PassNumber("texture_step", &P::texture_step, 0.0, 2.0, "of base colours beside a line, at least, in Oklab"),
      PassNumber("suggestive_reach", &P::suggestive_reach, 1.0, 64.0, "across a valley to either side, pixels"),
      PassNumber("suggestive_depth", &P::suggestive_depth, 0.0, 1.0,
                 "by which the cosine to the viewer rises over that reach, at least"),
      PassNumber("thin", &P::thin, 0.0, 2.0, "lines get thinner with distance: width * (thin_at / depth)^thin"),
      PassNumber("thin_at", &P::thin_at, 0.0, 1e9, "depth of the plain width, metres; 0: the first picture's middle"),
      PassNumber("light", &P::light, -2.0, 2.0, "lines get thinner in light: width * (1 + light * (1/2 - luminance))"),
      PassNumber("taper", &P::taper, 0.0, 512.0, "length over which lines end in a point, pixels"),
      PassNumber("wobble", &P::wobble, 0.0, 16.0, "how far lines stray, pixels"),
      PassNumber("wobble_length", &P::wobble_length, 1.0, 512.0, "of the waves of that, pixels"),
      PassJitter(&P::jitter_fps),
      PassNumber("gaps", &P::gaps, 0.0, 1.0, "share of lines that is left out, here and there"),
      PassNumber("gap_length", &P::gap_length, 1.0, 512.0, "of gaps, about, pixels"),
      PassFlag("stick", &P::stick, "waves and gaps stick to surfaces, not to the picture"),
      PassChoice("form", &P::form, {"strokes", "field"},
                 "strokes; or field, by the distance to borders alone: no taper, no wobble"),
      PassChoice("color", &P::color, {"ink", "paint", "complement"},
                 "ink, or paint: the paint beside the line, darker; or complement: its opposite hue"),
      PassColor("ink", &P::ink, "the colour of ink"),
      PassChoice("side", &P::side, {"centre", "inside", "outside"}, "of the nearer surface's border")};
}

FinishKey RampKey() {
  FinishKey key = PassText("ramp", &ToonPass::ramp,
                           "from dark to light, rows with / between: \"#202040 #fff4d0\"; or a picture's file");
  key.set = [set = key.set](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    std::shared_ptr<const ColorRamp> colors;
    if (text && IsRampText(*text)) {
      SCUMBLE_ASSIGN(ColorRamp ramp, ParseColorRamp(*text));
      colors = std::make_shared<const ColorRamp>(std::move(ramp));
    }
    SCUMBLE_RETURN_IF_ERROR(set(pass, value));
    std::get<ToonPass>(pass.effect).ramp_colors = std::move(colors);  // of a file it is read later
    return Ok();
  };
  return key;
}

FinishKey ThresholdsKey() {
  FinishKey key{"thresholds",
                KeyKind::kText,
                0.0,
                0.0,
                {},
                "",
                "tones at which bands begin, \"0.2 0.6\"; empty: even ones",
                {},
                {}};
  key.set = [](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    const std::optional<double> only = AsNumber(value);  // of two bands, quotes left off
    std::vector<double> thresholds;
    if (only) thresholds.push_back(*only);
    std::istringstream words(text ? *text : only ? "" : "none");
    words.imbue(std::locale::classic());
    for (double number; words >> number;) thresholds.push_back(number);
    double last = 0.0;
    bool grows = words.eof();
    for (const double one : thresholds) grows = grows && one > std::exchange(last, one) && one < 1.0;
    if (!grows) return UsageError("expected growing numbers between 0 and 1 with blanks between, as \"0.2 0.6\"");
    std::get<ToonPass>(pass.effect).thresholds = std::move(thresholds);
    return Ok();
  };
  key.get = [](const FinishPass& pass) -> KeyValue {
    std::string text;
    for (const double one : std::get<ToonPass>(pass.effect).thresholds) {
      char number[32];
      std::snprintf(number, sizeof number, "%s%.9g", text.empty() ? "" : " ", one);
      text += number;
    }
    return text;
  };
  return key;
}

std::vector<FinishKey> ToonKeys() {
  using P = ToonPass;
  return {
      PassWhole("bands", &P::bands, 1, 64, "bands of light"),
      ThresholdsKey(),
      PassNumber("softness", &P::softness, 0.0, 16.0, "half the width of a band's border, pixels"),
      PassNumber("shade", &P::shade, 0.0, 1.0, "lightness of the darkest band, as a share of the brightest's"),
      PassNumber("tint", &P::tint, 0.0, 1.0, "how much of the colour's hue the darkest band takes on"),
      PassColor("color", &P::color, "of tint"),
      PassChoice("base", &P::base, {"albedo", "paint"}, "what the bands shade: the scene's base colour, or the paint"),
      PassChoice(
          "light", &P::light, {"luminance", "wrapped"},
          "direct light; or wrapped: by the angle to the key light, around the form, (1/2 + cosine/2)^wrap_power"),
      PassWhole("wrap_power", &P::wrap_power, 1, 2, "of wrapped light; 2 is darker"),
      PassNumber("cast", &P::cast, 0.0, 1.0, "how much cast shadow takes of wrapped light"),
      PassChoice(
          "shading", &P::shading, {"plain", "gooch", "ramp"},
          "plain: by shade and tint; gooch: from cool to warm; or the colours of a ramp; bands = 1 is then smooth"),
      PassColor("warm", &P::warm, "of gooch, in the light"),
      PassColor("cool", &P::cool, "of gooch, in shade"),
      PassNumber("warm_base", &P::warm_base, 0.0, 1.0, "share of the base colour that is added to warm"),
      PassNumber("cool_base", &P::cool_base, 0.0, 1.0, "share of the base colour that is added to cool"),
      RampKey(),
      PassChoice("ramp_rows", &P::ramp_rows, {"depth", "facing", "highlight"},
                 "what a ramp's rows go by: distance, how far surfaces turn from the viewer, or highlights")};
}

std::vector<FinishKey> SmoothKeys() {
  using P = SmoothPass;
  return {
      PassNumber("radius", &P::radius, 0.5, 32.0, "of the filter, pixels: sigma; of kuwahara and guided the reach"),
      PassNumber("range", &P::range, 0.001, 1.0, "difference of colours that counts half, in Oklab; not of kuwahara"),
      PassWhole("passes", &P::passes, 1, 8, "times it is applied"),
      PassFlag("borders", &P::borders, "each object is smoothed by itself; wavelets also stop at normals and depths"),
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
          PassFlag("borders", &P::borders, "tone is not mixed between objects: their border makes no line"),
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
          PassChoice("along", &P::along, {"around", "along", "fixed", "light", "depth"},
                     "around forms, along them, in the fixed direction `angle`, from light to shade, or into depth"),
          PassNumber("angle", &P::angle, -180.0, 180.0, "where a surface has no direction, degrees, 0 along a row"),
          PassNumber("cross", &P::cross, 0.0, 90.0, "from one layer of strokes to the next, degrees"),
          PassWhole("layers", &P::layers, 1, 4, "layers of strokes"),
          PassNumber("fullest", &P::fullest, 0.05, 1.0, "share of ink at which the next layer begins"),
          PassNumber("bare", &P::bare, 0.0, 1.0, "tone from which on nothing is hatched"),
          PassNumber("shade", &P::shade, 0.0, 4.0,
                     "how much of the missing light is hatched; 2: the tone's square is left"),
          PassNumber("wobble", &P::wobble, 0.0, 16.0, "how far strokes stray, pixels"),
          PassJitter(&P::jitter_fps),
          PassFlag("stick", &P::stick, "strokes stick to surfaces"),
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
          PassNumber("sharpness", &P::sharpness, 0.0, 64.0, "of the steps; 0: none show"),
          PassChoice("tone", &P::tone, {"paint", "light"},
                     "whose lightness is cut: with light, the paint keeps its strokes")};
}

std::vector<FinishKey> ShadowsKeys() {
  using P = ShadowsPass;
  return {
      PassChoice("mode", &P::mode, {"black", "darker", "color", "complement", "chiaroscuro", "impression", "negative"},
                 "what shade looks like"),
      PassChoice("source", &P::source, {"cast", "form", "both"}, "cast shadows, faces turned from the light, or both"),
      PassNumber("soften", &P::soften, 0.0, 64.0,
                 "the shade's contour is evened out within each object: sigma, pixels"),
      PassNumber("full", &P::full, 0.0, 4.0, "luminance up to which a face is in full shade, 1: the brightest tenth's"),
      PassNumber("none", &P::none, 0.0, 4.0, "luminance from which on it is not"),
      PassColor("color", &P::color, "of mode color, and of tint"),
      PassNumber("tint", &P::tint, 0.0, 1.0,
                 "of mode complement: share of the colour's hue and chroma that grey paint takes on")};
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
          PassText("focus_on", &P::focus_on,
                   "an object whose middle depth is the focus; a name, in which * fits any letters")};
}

std::vector<FinishKey> PaletteKeys() {
  using P = PalettePass;
  return {
      PassText("like", &P::like, "whose colours: painting, the style's own; a picture's file; or \"#203050 #f0e0c0\""),
      PassText(
          "from", &P::from,
          "whose colours become those: a picture's file; or what was measured, as a run prints it; empty: the first "
          "picture's own"),
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
          PassJitter(&P::jitter_fps),
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
          "at", [](FinishPass& pass) -> FinishPass::Stage& { return pass.at; }, {"guides", "paint", "sheet"},
          "guides: before paint is matched; paint: objects alone; sheet: the paper behind them, too"),
      FinishChoice(
          "guide", [](FinishPass& pass) -> FinishPass::Guide& { return pass.guide; }, {"albedo", "luminance"},
          "what a pass at guides changes: base colours, which colorize and albedo edges see, or the light")};
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

}  // namespace

std::span<const FinishEffect> FinishEffects() {
  static const std::vector<FinishEffect> effects = MakeEffects();
  return effects;
}

std::span<const FinishKey> CommonFinishKeys() {
  static const std::vector<FinishKey> keys = MakeCommonKeys();
  return keys;
}

}  // namespace scumble
