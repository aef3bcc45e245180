#include "measure/crosscheck_baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/image/exact_math.h"

namespace scumble {
namespace {

constexpr int kVersion = 1;
constexpr const char* kMend = "write it with scumble crosscheck --write-baseline";

Error Wrong(const std::string& file, const std::string& place, const std::string& what) {
  return InputError(file + ": " + place + " " + what + "; " + kMend);
}

std::string NameOf(const CrosscheckFigure& figure) { return figure.layer + " " + figure.name; }

std::string SizeText(const CrosscheckSetup& setup) { return fmt::format("{}x{}", setup.width, setup.height); }

// "640x360", both above 0.
bool ReadSize(const std::string& text, CrosscheckSetup& setup) {
  const char* const end = text.data() + text.size();
  const auto [cross, bad] = std::from_chars(text.data(), end, setup.width);
  if (bad != std::errc() || cross == end || *cross != 'x') return false;
  const auto [stop, worse] = std::from_chars(cross + 1, end, setup.height);
  return worse == std::errc() && stop == end && setup.width > 0 && setup.height > 0;
}

// A whole number that an int holds.
bool ReadInt(const nlohmann::json& json, int least, int& value) {
  if (!json.is_number_integer()) return false;
  const auto wide = json.is_number_unsigned() ? static_cast<double>(json.get<std::uint64_t>())
                                              : static_cast<double>(json.get<std::int64_t>());
  if (wide < least || wide > 2147483647.0) return false;
  value = json.get<int>();
  return true;
}

Status ReadLimits(const nlohmann::json& json, const std::string& file, const std::string& place, BaselineScene& scene) {
  if (!json.is_object() || json.empty()) return Wrong(file, place, "is no object of figures");
  for (const auto& [figure, limit] : json.items()) {
    const double value = limit.is_number() ? limit.get<double>() : 0.0;
    if (!limit.is_number() || !(value >= 0.0 && std::isfinite(value))) {
      const std::string found =
          limit.is_number() ? fmt::format("{:g}", value) : std::string("of type ") + limit.type_name();
      return Wrong(file, place + "/" + figure, "is " + found + ", expected a number of 0 or more");
    }
    scene.limits[figure] = value;
  }
  return Ok();
}

Expected<BaselineScene> ReadScene(const nlohmann::json& json, const std::string& file, const std::string& place) {
  if (!json.is_object()) return Wrong(file, place, "is no object");
  BaselineScene scene;
  bool has_size = false, has_samples = false, has_bounces = false, has_limits = false;
  for (const auto& [key, value] : json.items()) {
    const std::string here = place + "/" + key;
    if (key == "size") {
      has_size = value.is_string() && ReadSize(value.get<std::string>(), scene.setup);
      if (!has_size) return Wrong(file, here, "is no size as \"640x360\"");
    } else if (key == "samples" || key == "max_bounces") {
      if (!ReadInt(value, 0, key == "samples" ? scene.setup.samples : scene.setup.max_bounces)) {
        return Wrong(file, here, "is no whole number of 0 or more");
      }
      (key == "samples" ? has_samples : has_bounces) = true;
    } else if (key == "camera") {
      if (!value.is_string()) return Wrong(file, here, "is no text");
      scene.setup.camera = value.get<std::string>();
    } else if (key == "frame") {
      int frame = 0;
      if (!ReadInt(value, -2147483647, frame)) return Wrong(file, here, "is no whole number");
      scene.setup.frame = frame;
    } else if (key == "blender_scene" || key == "view_layer") {
      if (!value.is_string()) return Wrong(file, here, "is no text");
      (key == "view_layer" ? scene.setup.view_layer : scene.setup.blender_scene) = value.get<std::string>();
    } else if (key == "limits") {
      SCUMBLE_RETURN_IF_ERROR(ReadLimits(value, file, here, scene));
      has_limits = true;
    } else {
      return Wrong(
          file, here,
          "is no key of a baseline's scene: expected size, samples, max_bounces, camera, frame, blender_scene, "
          "view_layer, limits");
    }
  }
  if (!has_size || !has_samples || !has_bounces || !has_limits) {
    return Wrong(file, place, "lacks size, samples, max_bounces or limits");
  }
  return scene;
}

double RoundedUp(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  // 0.0007 and not 0.0007000000000000001.
  return RoundToDigits(std::ceil(value / unit * (1.0 - 1e-12)) * unit, 2);
}

}  // namespace

Expected<Baseline> ParseBaseline(std::string_view text, const std::string& file) {
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& problem) {  // its own text quotes the input, of any length
    const std::string_view read = text.substr(0, problem.byte == 0 ? 0 : problem.byte - 1);
    const auto line = 1 + std::count(read.begin(), read.end(), '\n');
    const std::size_t column = read.size() - (read.rfind('\n') + 1) + 1;  // npos + 1 is 0
    return InputError(fmt::format("{} is no baseline: no JSON at line {}, column {}; {}", file, line, column, kMend));
  } catch (const nlohmann::json::exception& problem) {  // "[name.id] number overflow parsing '1e999'"
    const std::string words = problem.what();
    return InputError(fmt::format("{} is no baseline: {:.60}; {}", file, words.substr(words.find("] ") + 2), kMend));
  }
  if (!json.is_object() || !json.contains("scumble_baseline")) {
    return InputError(file + " is no baseline: it has no \"scumble_baseline\"; " + kMend);
  }
  Baseline baseline;
  for (const auto& [key, value] : json.items()) {
    if (key == "scumble_baseline") {
      if (!value.is_number_integer() || value != kVersion) {
        return Wrong(file, key, fmt::format("is not {}, the only version that this program reads", kVersion));
      }
    } else if (key == "blender") {
      if (!value.is_string()) return Wrong(file, key, "is no text");
      baseline.blender = value.get<std::string>();
    } else if (key == "scenes") {
      if (!value.is_object()) return Wrong(file, key, "is no object");
      for (const auto& [name, scene] : value.items()) {
        SCUMBLE_ASSIGN(baseline.scenes[name], ReadScene(scene, file, "scenes/" + name));
      }
    } else {
      return Wrong(file, key, "is no key of a baseline: expected scumble_baseline, blender, scenes");
    }
  }
  return baseline;
}

std::string BaselineToJson(const Baseline& baseline) {
  using OrderedJson = nlohmann::ordered_json;
  OrderedJson json{{"scumble_baseline", kVersion}, {"blender", baseline.blender}, {"scenes", OrderedJson::object()}};
  for (const auto& [name, scene] : baseline.scenes) {
    OrderedJson& item = json["scenes"][name];
    item = {
        {"size", SizeText(scene.setup)}, {"samples", scene.setup.samples}, {"max_bounces", scene.setup.max_bounces}};
    if (!scene.setup.camera.empty()) item["camera"] = scene.setup.camera;
    if (scene.setup.frame) item["frame"] = *scene.setup.frame;
    if (!scene.setup.blender_scene.empty()) item["blender_scene"] = scene.setup.blender_scene;
    if (!scene.setup.view_layer.empty()) item["view_layer"] = scene.setup.view_layer;
    item["limits"] = OrderedJson::object();
    for (const auto& [figure, limit] : scene.limits) item["limits"][figure] = limit;
  }
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

std::string BaselineMismatch(const Baseline& baseline, const std::string& scene, const CrosscheckSetup& setup) {
  const auto found = baseline.scenes.find(scene);
  if (found == baseline.scenes.end()) {
    return "the baseline has no scene " + scene + ": add it with --write-baseline";
  }
  const CrosscheckSetup& was = found->second.setup;
  std::string differs;
  const auto compare = [&](const std::string& option, const std::string& then, const std::string& now) {
    if (then != now) differs += (differs.empty() ? "" : ", ") + option + " " + then + " and not " + now;
  };
  const auto name = [](const std::string& camera) { return camera.empty() ? std::string("left out") : camera; };
  const auto number = [](const std::optional<int>& frame) {
    return frame ? std::to_string(*frame) : std::string("left out");
  };
  compare("--size", SizeText(was), SizeText(setup));
  compare("--samples", std::to_string(was.samples), std::to_string(setup.samples));
  compare("--max-bounces", std::to_string(was.max_bounces), std::to_string(setup.max_bounces));
  compare("--camera", name(was.camera), name(setup.camera));
  compare("--frame", number(was.frame), number(setup.frame));
  compare("--scene", name(was.blender_scene), name(setup.blender_scene));
  compare("--view-layer", name(was.view_layer), name(setup.view_layer));
  if (differs.empty()) return "";
  return "the baseline of " + scene + " was measured with " + differs +
         ": run it so, or measure it anew with --write-baseline";
}

std::vector<std::string> ApplyBaseline(const Baseline& baseline, const std::string& scene, CrosscheckReport& report) {
  std::vector<std::string> notes;
  const auto found = baseline.scenes.find(scene);
  if (found == baseline.scenes.end()) return notes;
  for (const auto& [name, limit] : found->second.limits) {
    const auto figure = std::find_if(report.figures.begin(), report.figures.end(),
                                     [&name = name](const CrosscheckFigure& f) { return NameOf(f) == name; });
    if (figure == report.figures.end()) {
      report.problems.push_back("the baseline names the figure '" + name +
                                "', which this run did not measure: take it out, or measure the baseline anew with "
                                "--write-baseline");
      continue;
    }
    figure->baseline_limit = limit;
    if (limit > figure->limit) {
      notes.push_back(
          fmt::format("{}: the baseline's limit of {:g} for {} is above the built-in one and counts as {:g}", scene,
                      limit, name, figure->limit));
    }
  }
  return notes;
}

void RecordInBaseline(const CrosscheckReport& report, const std::string& scene, Baseline& baseline) {
  constexpr double kRoom = 1.25;
  BaselineScene& entry = baseline.scenes[scene];
  entry = {report.setup, {}};
  for (const CrosscheckFigure& figure : report.figures) {
    const double wanted = RoundedUp(std::max(figure.value * kRoom + 2.0 * figure.error, figure.floor));
    entry.limits[NameOf(figure)] = wanted < figure.limit ? wanted : figure.limit;
  }
}

}  // namespace scumble
