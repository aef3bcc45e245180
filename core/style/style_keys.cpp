#include "core/style/style_keys.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <system_error>
#include <vector>

#include "core/io/picture_file.h"

namespace scumble {
namespace {

using Setter = decltype(StyleKey::set);

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

template <class T>
Setter Number(T TransferSettings::*field, double low, double high) {
  return [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto number = AsNumber(value);
    if (!number || !(*number >= low && *number <= high)) return UsageError("expected a number, " + Range(low, high));
    style.transfer.*field = Rounded<T>(*number);
    return Ok();
  };
}

Setter Whole(int TransferSettings::*field, int low, int high) {
  return [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto* number = std::get_if<std::int64_t>(&value);
    if (!number || *number < low || *number > high) return UsageError("expected a whole number, " + Range(low, high));
    style.transfer.*field = static_cast<int>(*number);
    return Ok();
  };
}

Setter Flag(bool TransferSettings::*field) {
  return [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto* flag = std::get_if<bool>(&value);
    if (!flag) return UsageError("expected true or false");
    style.transfer.*field = *flag;
    return Ok();
  };
}

Setter Text(std::string Style::*field) {
  return [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) return UsageError("expected a text in quotes");
    style.*field = *text;
    return Ok();
  };
}

Status SetMethod(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && *text == "litsphere") return style.transfer.method = Method::kLitSphere, Ok();
  if (text && *text == "styleblit") return style.transfer.method = Method::kStyleBlit, Ok();
  if (text && *text == "bruteforce") return style.transfer.method = Method::kBruteForce, Ok();
  if (text && *text == "stylit") return UnavailableError("method stylit is not built into this version");
  return UsageError("expected \"litsphere\", \"styleblit\" or \"bruteforce\"");
}

Status SetNearest(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && *text == "auto") return style.transfer.nearest = NearestSearch::kAuto, Ok();
  if (text && *text == "analytic") return style.transfer.nearest = NearestSearch::kAnalytic, Ok();
  if (text && *text == "table") return style.transfer.nearest = NearestSearch::kTable, Ok();
  if (text && *text == "tree") return style.transfer.nearest = NearestSearch::kTree, Ok();
  return UsageError("expected \"auto\", \"analytic\", \"table\" or \"tree\"");
}

Status SetMetric(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && *text == "l2") return style.transfer.threshold_metric = ThresholdMetric::kL2, Ok();
  if (text && *text == "l1") return style.transfer.threshold_metric = ThresholdMetric::kL1, Ok();
  return UsageError("expected \"l2\" or \"l1\"");
}

Status SetLuminanceError(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && *text == "excess") return style.transfer.luminance_error = LuminanceError::kExcess, Ok();
  if (text && *text == "published") return style.transfer.luminance_error = LuminanceError::kPublished, Ok();
  return UsageError("expected \"excess\" or \"published\"");
}

Status SetColorizeMode(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && *text == "multiply") return style.transfer.colorize_mode = ColorizeMode::kMultiply, Ok();
  if (text && *text == "oklab") return style.transfer.colorize_mode = ColorizeMode::kOklab, Ok();
  return UsageError("expected \"multiply\" or \"oklab\"");
}

Status SetEdge(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && *text == "exact") return style.transfer.edge = EdgeMode::kExact, Ok();
  if (text && *text == "exemplar") return style.transfer.edge = EdgeMode::kExemplar, Ok();
  return UsageError("expected \"exact\" or \"exemplar\"");
}

Status SetShadow(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && *text == "none") return style.transfer.shadow = ShadowMode::kNone, Ok();
  if (text && *text == "paint") return style.transfer.shadow = ShadowMode::kPaint, Ok();
  return UsageError("expected \"none\" or \"paint\"");
}

Status SetJitterFps(Style& style, const KeyValue& value, const std::filesystem::path&) {
  const auto number = AsNumber(value);
  if (!number || !(*number == -1.0 || (*number >= 0.0 && *number <= 1000.0))) {
    return UsageError("expected -1 (every frame), 0 (frozen) or up to 1000 renewals a second");
  }
  style.transfer.jitter_fps = *number;
  return Ok();
}

constexpr const char* kColor = "a colour is # and six hexadecimal digits, two each of red, green and blue: \"#f4efe6\"";

Status SetPaper(Style& style, const KeyValue& value, const std::filesystem::path& folder) {
  const auto* text = std::get_if<std::string>(&value);
  if (!text) return UsageError(std::string("expected a picture's name, a colour, or \"\" for transparent; ") + kColor);
  style.paper = {};
  if (text->empty()) return Ok();
  if (text->front() == '#') {
    unsigned rgb = 0;
    const char *begin = text->data() + 1, *end = text->data() + text->size();
    const auto parsed = std::from_chars(begin, end, rgb, 16);
    if (end - begin != 6 || parsed.ec != std::errc() || parsed.ptr != end) {
      return UsageError(kColor);
    }
    const auto channel = [&](int shift) { return static_cast<std::uint16_t>(((rgb >> shift) & 255u) * 257u); };
    style.paper.color = {channel(16), channel(8), channel(0)};
    return Ok();
  }
  std::error_code failed;
  if (!text->ends_with('/') && !std::filesystem::exists(folder / *text, failed) && !failed) {
    return InputError("cannot read " + (folder / *text).string() + ": there is no such file; " + kColor);
  }
  SCUMBLE_ASSIGN(style.paper.picture, ReadPicture(folder / *text));
  return Ok();
}

Setter GuideWeight(Layer layer) {
  return [=](Style& style, const KeyValue& value, const auto&) -> Status {
    const auto number = AsNumber(value);
    if (!number || !(*number >= 0.0 && *number <= kMaxGuideWeight)) {
      return UsageError("expected a number, " + Range(0.0, kMaxGuideWeight));
    }
    style.transfer.guide_weights[layer] = static_cast<float>(*number);
    return Ok();
  };
}

// transfer.guide_weights.normal and so on.
void AddGuideWeights(std::vector<StyleKey>& keys) {
  for (const LayerInfo& info : AllLayers()) {
    if (!GuideWeights::CanWeigh(info.layer)) continue;
    const bool normal = info.layer == Layer::kNormal;
    keys.push_back({kGuideWeights + std::string(info.name), normal ? "1.0" : "0.0",
                    normal ? "how much normals count where paint is looked for and pieces end, 0 to 1000"
                           : "the same of " + std::string(info.meaning),
                    true, GuideWeight(info.layer)});
  }
}

std::vector<StyleKey> MakeKeys() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  using T = TransferSettings;
  std::vector<StyleKey> keys = {
      {"name", "\"\"", "what the style is called", true, Text(&Style::name)},
      {"licence", "\"\"", "SPDX name of the licence", true, Text(&Style::licence)},
      {"transfer.method", "\"styleblit\"", "litsphere, styleblit or bruteforce", true, SetMethod},
      {"transfer.nearest", "\"auto\"", "how sources are found: analytic (spheres), table, or tree: exact and slow",
       true, SetNearest},
      {"transfer.nearest_error", "0.0",
       "how much farther than the nearest a source from the tree may be, as a share, 0 to 10; 0: exact", true,
       Number(&T::nearest_error, 0.0, 10.0)},
      {"transfer.threshold", "0.125", "largest guide distance inside a chunk, between unit normals", true,
       Number(&T::threshold, 0.0, kInfinity)},
      {"transfer.threshold_metric", "\"l2\"", "l2, or l1: the authors' own test", true, SetMetric},
      {"transfer.levels", "7", "seed grids of 2^(levels-1) to 1 pixels, 1 to 16", true, Whole(&T::levels, 1, 16)},
      {"transfer.jitter", "1.0", "how far seeds leave their grid, 0 to 1", true, Number(&T::jitter, 0.0, 1.0)},
      {"transfer.jitter_fps", "0", "renewals of the jitter a second; 0 frozen, -1 every frame", true, SetJitterFps},
      {"transfer.coherent", "false", "pieces stick to surfaces that move, instead of the screen", true,
       Flag(&T::coherent)},
      {"transfer.blend_radius", "1", "voting window, pixels, 0 to 64", true, Whole(&T::blend_radius, 0, 64)},
      {"transfer.edge_aware", "true", "votes do not cross object borders, depth steps and creases", true,
       Flag(&T::edge_aware)},
      {"transfer.crease", "60", "angle of normals that votes do not cross, degrees, 0 to 180; 180: any is crossed",
       true, Number(&T::crease, 0.0, 180.0)},
      {"transfer.depth_tolerance", "0.002",
       "depth step that votes do cross, as a share of the distance (orthographic: of the view's height), 0 to 1", true,
       Number(&T::depth_tolerance, 0.0, 1.0)},
      {"transfer.luminance_weight", "0.3", "how much light counts inside a chunk, with several exemplars", true,
       Number(&T::luminance_weight, 0.0, kInfinity)},
      {"transfer.luminance_error", "\"excess\"", "excess, or published: the thesis's own", true, SetLuminanceError},
      {"transfer.colorize", "0.0", "0 exemplar colours to 1 fully tinted by the scene", true,
       Number(&T::colorize, 0.0, 1.0)},
      {"transfer.colorize_mode", "\"multiply\"", "multiply, or oklab: for coloured exemplars", true, SetColorizeMode},
      {"transfer.variety", "0.0", "freedom of choice on flat surfaces, degrees, 0 to 90", true,
       Number(&T::variety, 0.0, 90.0)},
      {"transfer.hybrid", "0.0",
       "tone by Lit Sphere, texture in pieces: width of the split, sigma in exemplar pixels, 0 or more; 0: no split",
       true, Number(&T::hybrid, 0.0, kInfinity)},
      {"transfer.match_step", "1", "pixels from one that is matched to the next, 1 to 8; 1: all are, slowest and best",
       true, Whole(&T::match_step, 1, kMaxMatchStep)},
      {"transfer.scale", "1.0", "exemplar size, above 0 to 64", true, Number(&T::scale, 1e-3, 64.0)},
      {"transfer.rim", "2", "exemplar pixels at the painted edge that are never used, at least", true,
       Number(&T::rim, 0.0, 16384.0)},
      {"transfer.reference_height", "1080", "lengths are pixels at this output height; 0: plain pixels", true,
       Whole(&T::reference_height, 0, 32768)},
      {"transfer.edge", "\"exact\"", "silhouettes: exact, or exemplar: its painted edge goes on along them", true,
       SetEdge},
      {"transfer.shadow", "\"none\"", "none, or paint: shadows on what --assign NAME=catcher names", true, SetShadow},
      {"transfer.paper", "\"\"", "picture or colour behind; empty: transparent", true, SetPaper},
  };
  AddGuideWeights(keys);
  return keys;
}

}  // namespace

std::optional<double> AsNumber(const KeyValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  return std::nullopt;
}

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
  char number[40];
  std::snprintf(number, sizeof number, "%g", std::get<double>(value));
  return number;
}

}  // namespace scumble
