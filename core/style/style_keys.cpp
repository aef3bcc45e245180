#include "core/style/style_keys.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "core/image/jitter_rate.h"
#include "core/io/picture_file.h"
#include "core/style/finish_keys.h"

namespace scumble {
namespace {

constexpr double kMaxGuideWeight = 1000.0;

std::string Range(double low, double high) {
  char text[80];
  if (std::isinf(high))
    std::snprintf(text, sizeof text, "%g or more", low);
  else
    std::snprintf(text, sizeof text, "%g to %g", low, high);
  return text;
}

// The nearest number that the field holds. Too large a value becomes infinite, and a value above 0 stays above: a
// threshold of 0 accepts nothing, the smallest one exact copies.
template <class T>
T Rounded(double number) {
  using Limits = std::numeric_limits<T>;
  if (number > static_cast<double>(Limits::max())) return Limits::infinity();
  const T rounded = static_cast<T>(number);
  return number > 0.0 ? std::max(rounded, Limits::denorm_min()) : rounded;
}

// `most` is a slider's where `high` is infinite.
template <class T>
KeyForm Number(T TransferSettings::*field, double low, double high, double step, double most = 0.0) {
  KeyForm form{KeyKind::kNumber, low, std::isinf(high) ? most : high, std::isinf(high), step, {}, {}};
  form.set = [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto number = AsNumber(value);
    if (!number || !(*number >= low && *number <= high)) return UsageError("expected a number, " + Range(low, high));
    style.transfer.*field = Rounded<T>(*number);
    return Ok();
  };
  return form;
}

KeyForm Whole(int TransferSettings::*field, int low, int high) {
  KeyForm form{KeyKind::kWhole, double(low), double(high), false, 1.0, {}, {}};
  form.set = [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto* number = std::get_if<std::int64_t>(&value);
    if (!number || *number < low || *number > high) {
      const bool has_point = std::holds_alternative<double>(value);
      return UsageError(std::string("expected a whole number") + (has_point ? " without a decimal point, " : ", ") +
                        Range(low, high));
    }
    style.transfer.*field = static_cast<int>(*number);
    return Ok();
  };
  return form;
}

KeyForm Flag(bool TransferSettings::*field) {
  KeyForm form{KeyKind::kFlag, 0.0, 0.0, false, 0.0, {}, {}};
  form.set = [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto* flag = std::get_if<bool>(&value);
    if (!flag) return UsageError("expected true or false");
    style.transfer.*field = *flag;
    return Ok();
  };
  return form;
}

KeyForm Text(std::string Style::*field) {
  KeyForm form;
  form.set = [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) return UsageError("expected a text in quotes");
    style.*field = *text;
    return Ok();
  };
  return form;
}

template <class T>
KeyForm Choice(T TransferSettings::*field, const std::vector<std::pair<std::string, T>>& choices) {
  KeyForm form{KeyKind::kChoice, 0.0, 0.0, false, 0.0, {}, {}};
  std::string expected = "expected ";
  for (std::size_t i = 0; i < choices.size(); ++i) {
    form.choices.push_back(choices[i].first);
    expected += (i == 0 ? "\"" : i + 1 < choices.size() ? ", \"" : " or \"") + choices[i].first + '"';
  }
  form.set = [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    for (const auto& [name, choice] : choices) {
      if (text && *text == name) return style.transfer.*field = choice, Ok();
    }
    return UsageError(expected);
  };
  return form;
}

KeyForm MethodChoice() {
  KeyForm form = Choice<Method>(
      &TransferSettings::method,
      {{"litsphere", Method::kLitSphere}, {"styleblit", Method::kStyleBlit}, {"bruteforce", Method::kBruteForce}});
  form.set = [known = form.set](Style& style, const KeyValue& value, const std::filesystem::path& folder) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    if (text && *text == "stylit") return UnavailableError("method stylit is not built into this version");
    style.unpainted.clear();
    if (text && IsUnpainted(*text)) {
      style.unpainted = *text;
      style.transfer.method = Method::kLitSphere;
      return Ok();
    }
    Status done = known(style, value, folder);
    if (!done) done = UsageError(done.error().message + "; \"toon\" and \"render\" need no painting");
    return done;
  };
  for (const char* name : {"toon", "render"}) form.choices.push_back(name);
  return form;
}

Status SetJitterFps(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto number = AsNumber(value);
  if (!number || !(*number == -1.0 || (*number >= 0.0 && *number <= kMostJitterFps))) {
    return UsageError("expected -1 (every frame), 0 (frozen) or up to 1000 renewals a second");
  }
  style.transfer.jitter_fps = *number;
  return Ok();
}

Status SetPaper(Style& style, const KeyValue& value, const std::filesystem::path& folder) {
  const auto* text = std::get_if<std::string>(&value);
  if (!text)
    return UsageError(std::string("expected a picture's name, a colour, or \"\" for transparent; ") + kColorForm);
  style.paper = {};
  if (text->empty()) return Ok();
  if (text->front() == '#') {
    const auto color = ParseColor(*text);
    if (!color) return UsageError(kColorForm);
    style.paper.color = *color;
    return Ok();
  }
  std::error_code failed;
  if (!text->ends_with('/') && !std::filesystem::exists(folder / *text, failed) && !failed) {
    return InputError("cannot read " + (folder / *text).string() + ": there is no such file; " + kColorForm);
  }
  const std::filesystem::path file = folder / *text;
  SCUMBLE_ASSIGN(style.paper.picture, style.read_picture ? style.read_picture(file) : ReadPicture(file));
  style.paper.file = file;
  return Ok();
}

KeyForm GuideWeight(Layer layer) {
  KeyForm form{KeyKind::kNumber, 0.0, kMaxGuideWeight, false, 0.1, {}, {}};
  form.set = [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto number = AsNumber(value);
    if (!number || !(*number >= 0.0 && *number <= kMaxGuideWeight)) {
      return UsageError("expected a number, " + Range(0.0, kMaxGuideWeight));
    }
    style.transfer.guide_weights[layer] = static_cast<float>(*number);
    return Ok();
  };
  return form;
}

// transfer.guide_weights.normal and so on.
void AddGuideWeights(std::vector<StyleKey>& keys) {
  for (const LayerInfo& info : AllLayers()) {
    if (!GuideWeights::CanWeigh(info.layer)) continue;
    const bool normal = info.layer == Layer::kNormal;
    keys.push_back({GuideWeight(info.layer), kGuideWeights + std::string(info.name), normal ? "1.0" : "0.0",
                    normal ? "how much normals count where paint is looked for and chunks end, 0 to 1000"
                           : "weight of this layer beside that of normals, 0 to 1000: " + std::string(info.meaning),
                    "Guide weights", true});
  }
}

std::vector<StyleKey> MakeKeys() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  using T = TransferSettings;
  std::vector<StyleKey> keys = {
      {Text(&Style::name), "name", "\"\"", "what the style is called", "Style", false},
      {Text(&Style::licence), "licence", "\"\"", "SPDX name of the licence", "Style", false},
      {MethodChoice(), "transfer.method", "\"styleblit\"",
       "litsphere, styleblit or bruteforce; toon or render: without a painting", "Matching", true},
      {Choice<NearestSearch>(&T::nearest, {{"auto", NearestSearch::kAuto},
                                           {"analytic", NearestSearch::kAnalytic},
                                           {"table", NearestSearch::kTable},
                                           {"tree", NearestSearch::kTree}}),
       "transfer.nearest", "\"auto\"", "how sources are found: analytic (spheres), table, or tree: exact and slow",
       "Matching", true},
      {Number(&T::nearest_error, 0.0, 10.0, 0.1), "transfer.nearest_error", "0.0",
       "how much farther than the nearest a source from the tree may be, as a share, 0 to 10; 0: exact", "Matching",
       true},
      {Number(&T::threshold, 0.0, kInfinity, 0.005, 2.0), "transfer.threshold", "0.125",
       "largest guide distance inside a chunk, between unit normals", "Matching", false},
      {Choice<ThresholdMetric>(&T::threshold_metric, {{"l2", ThresholdMetric::kL2}, {"l1", ThresholdMetric::kL1}}),
       "transfer.threshold_metric", "\"l2\"", "l2, or l1: the authors' own test", "Matching", false},
      {Whole(&T::levels, 1, 16), "transfer.levels", "7", "seed grids of 2^(levels-1) to 1 pixels, 1 to 16", "Matching",
       true},
      {Number(&T::jitter, 0.0, 1.0, 0.05), "transfer.jitter", "1.0", "how far seeds leave their grid, 0 to 1",
       "Movement", false},
      {{KeyKind::kNumber, -1.0, kMostJitterFps, false, 1.0, {}, SetJitterFps},
       "transfer.jitter_fps",
       "0",
       "renewals of the jitter a second; 0 frozen, -1 every frame",
       "Movement",
       false},
      {Flag(&T::coherent), "transfer.coherent", "false", "chunks stick to surfaces that move, instead of the screen",
       "Matching", false},
      {Whole(&T::blend_radius, 0, 64), "transfer.blend_radius", "1", "voting window, pixels, 0 to 64", "Blending",
       true},
      {Flag(&T::edge_aware), "transfer.edge_aware", "true",
       "votes do not cross object borders, depth steps and creases", "Blending", true},
      {Number(&T::crease, 0.0, 180.0, 1.0), "transfer.crease", "60",
       "angle of normals that votes do not cross, degrees, 0 to 180; 180: any is crossed", "Blending", false},
      {Number(&T::depth_tolerance, 0.0, 1.0, 0.0005), "transfer.depth_tolerance", "0.002",
       "depth step that votes do cross, as a share of the distance (orthographic: of the view's height), 0 to 1",
       "Blending", false},
      {Number(&T::luminance_weight, 0.0, kInfinity, 0.05, 4.0), "transfer.luminance_weight", "0.3",
       "how much light counts inside a chunk, with several exemplars", "Light and colour", true},
      {Choice<LuminanceError>(&T::luminance_error,
                              {{"excess", LuminanceError::kExcess}, {"published", LuminanceError::kPublished}}),
       "transfer.luminance_error", "\"excess\"", "excess, or published: the thesis's own", "Light and colour", true},
      {Number(&T::colorize, 0.0, 1.0, 0.05), "transfer.colorize", "0.0",
       "0 exemplar colours to 1 fully tinted by the scene", "Light and colour", true},
      {Choice<ColorizeMode>(&T::colorize_mode,
                            {{"multiply", ColorizeMode::kMultiply}, {"oklab", ColorizeMode::kOklab}}),
       "transfer.colorize_mode", "\"multiply\"", "multiply, or oklab: for coloured exemplars", "Light and colour",
       true},
      {Number(&T::variety, 0.0, 90.0, 1.0), "transfer.variety", "0.0",
       "freedom of choice on flat surfaces, degrees, 0 to 90", "Matching", false},
      {Number(&T::hybrid, 0.0, kInfinity, 0.5, 64.0), "transfer.hybrid", "0.0",
       "tone by Lit Sphere, texture in chunks: width of the split, sigma in exemplar pixels, 0 or more; 0: no split",
       "Blending", true},
      {Whole(&T::match_step, 1, kMaxMatchStep), "transfer.match_step", "1",
       "pixels from one that is matched to the next, 1 to 8; 1: all are, slowest and best", "Matching", false},
      {Number(&T::scale, 1e-3, 64.0, 0.05), "transfer.scale", "1.0", "exemplar size, 0.001 to 64", "Sphere and paper",
       true},
      {Number(&T::rim, 0.0, 16384.0, 0.5), "transfer.rim", "2",
       "exemplar pixels at the painted edge that are never used, at least", "Sphere and paper", true},
      {Whole(&T::reference_height, 0, 32768), "transfer.reference_height", "1080",
       "lengths are pixels at this output height; 0: plain pixels", "Sphere and paper", true},
      {Choice<EdgeMode>(&T::edge, {{"exact", EdgeMode::kExact}, {"exemplar", EdgeMode::kExemplar}}), "transfer.edge",
       "\"exact\"", "silhouettes: exact, or exemplar: its painted edge goes on along them", "Sphere and paper", true},
      {Choice<ShadowMode>(&T::shadow, {{"none", ShadowMode::kNone}, {"paint", ShadowMode::kPaint}}), "transfer.shadow",
       "\"none\"", "none, or paint: shadows on what --assign NAME=catcher names", "Light and colour", true},
      {{KeyKind::kFile, 0.0, 0.0, false, 0.0, {}, SetPaper},
       "transfer.paper",
       "\"\"",
       "picture or colour behind; empty: transparent",
       "Sphere and paper",
       true},
  };
  AddGuideWeights(keys);
  return keys;
}

}  // namespace

std::string KindName(KeyKind kind) {
  constexpr const char* kNames[] = {"number", "whole", "flag", "choice", "text", "file"};
  return kNames[static_cast<std::size_t>(kind)];
}

KeyValue StyleKey::Default() const {
  const char *begin = default_value.data(), *end = begin + default_value.size();
  if (kind == KeyKind::kFlag) return default_value == "true";
  if (kind == KeyKind::kWhole) {
    std::int64_t whole = 0;
    std::from_chars(begin, end, whole);
    return whole;
  }
  if (kind == KeyKind::kNumber) {
    double number = 0.0;
    std::from_chars(begin, end, number);
    return number;
  }
  return default_value.substr(1, default_value.size() - 2);  // without the quotes
}

std::optional<double> AsNumber(const KeyValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  return std::nullopt;
}

bool IsUnpainted(const std::string& method) { return method == "toon" || method == "render"; }

std::span<const StyleKey> StyleKeys() {
  static const std::vector<StyleKey> keys = MakeKeys();
  return keys;
}

const StyleKey* FindStyleKey(const std::string& name) {
  for (const StyleKey& key : StyleKeys()) {
    if (key.name == name) return &key;
  }
  return nullptr;
}

std::string ToText(const KeyValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* text = std::get_if<std::string>(&value)) return '"' + *text + '"';
  if (const auto* color = std::get_if<Rgb16>(&value)) return '"' + ColorText(*color) + '"';
  if (const auto* names = std::get_if<std::vector<std::string>>(&value)) {
    std::string list;
    for (const std::string& name : *names) list += (list.empty() ? "\"" : ", \"") + name + '"';
    return "[" + list + "]";
  }
  char number[40];
  std::snprintf(number, sizeof number, "%g", std::get<double>(value));
  return number;
}

}  // namespace scumble
