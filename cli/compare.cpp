// scumble compare.
#include "measure/compare.h"

#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/json_text.h"
#include "cli/options.h"
#include "cli/run_files.h"
#include "io/channel_file.h"
#include "io/guide_file.h"
#include "io/picture_file.h"
#include "measure/flicker.h"
#include "measure/flip.h"
#include "measure/heat_map.h"

namespace scumble {
namespace {

struct CompareVerb {
  std::string a;
  std::string b;
  CompareOptions options;
  std::string heat_map;
  std::string motion;
  std::string motion_next;
  bool flip = false;
  FlipOptions flip_options;
};

// The guides that flicker is measured along; what is not there is not looked at.
Expected<GuideSet> ReadMotionGuides(const std::string& path, LayerSet required) {
  GuideReadOptions options;
  options.required = required.Add(Layer::kCoverage).Add(Layer::kNormal);
  options.optional = {Layer::kDepth, Layer::kObject, Layer::kPref};
  return ReadGuides(path, options);
}

// Steps of 255 that a map of flicker shows in full yellow: always the same, so that maps can be laid side by side.
constexpr double kMostFlicker = 64.0;

Status CheckHeatMap(const CompareVerb& verb) {
  if (verb.heat_map.empty()) return Ok();
  RunFiles files;
  files.Reads("the first file", verb.a), files.Reads("the second file", verb.b);
  if (!verb.motion.empty()) files.Reads("the guides", verb.motion);
  if (!verb.motion_next.empty()) files.Reads("the next frame's guides", verb.motion_next);
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(verb.heat_map));
  return files.CheckOutput(verb.heat_map);
}

Expected<ExitCode> RunFlicker(const CompareVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(const Picture a, ReadPicture(verb.a));
  SCUMBLE_ASSIGN(const Picture b, ReadPicture(verb.b));
  SCUMBLE_ASSIGN(const GuideSet guides, ReadMotionGuides(verb.motion, {Layer::kMotion}));
  GuideSet next;
  if (!verb.motion_next.empty()) {
    SCUMBLE_ASSIGN(next, ReadMotionGuides(verb.motion_next, {}));
  }
  SCUMBLE_ASSIGN(const FlickerReport report, MeasureFlicker(a, b, guides, verb.motion_next.empty() ? nullptr : &next));
  if (!verb.heat_map.empty()) {
    const Picture map = ValueHeatMap(report.changes, guides.width(), guides.height(), kMostFlicker);
    SCUMBLE_RETURN_IF_ERROR(WritePicture(verb.heat_map, map));
    Say(globals, fmt::format("{}: yellow is a change of {:.0f} of 255", verb.heat_map, kMostFlicker));
  }
  const nlohmann::ordered_json json = {{"a", verb.a},
                                       {"b", verb.b},
                                       {"flicker", report.mean},
                                       {"floor", report.floor},
                                       {"pixels", report.pixels},
                                       {"hidden", report.hidden}};
  Print(globals.json ? JsonText(json)
                     : fmt::format("flicker {:.3f} of 255 along the motion; {:.3f} is what resampling alone costs\n"
                                   "{} pixels stay in sight, {} do not\n",
                                   report.mean, report.floor, report.pixels, report.hidden));
  return ExitCode::kOk;
}

Expected<ExitCode> RunFlip(const CompareVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(const Picture a, ReadPicture(verb.a));
  SCUMBLE_ASSIGN(const Picture b, ReadPicture(verb.b));
  FlipOptions options = verb.flip_options;
  options.threads = globals.threads;
  SCUMBLE_ASSIGN(const FlipReport report, MeasureFlip(a, b, options));
  if (!verb.heat_map.empty()) {
    SCUMBLE_RETURN_IF_ERROR(WritePicture(verb.heat_map, ValueHeatMap(report.map, a.width, a.height, 1.0)));
    Say(globals, verb.heat_map + ": yellow is a FLIP of 1");
  }
  const nlohmann::ordered_json json = {{"a", verb.a},         {"b", verb.b},
                                       {"flip", report.mean}, {"flip_max", report.max},
                                       {"rms", report.rms},   {"pixels_per_degree", options.pixels_per_degree}};
  Print(globals.json ? JsonText(json)
                     : fmt::format("FLIP mean {:.6f}, most {:.6f}, at {:.2f} pixels per degree\n"
                                   "RMS  {:.6f} of 1\n",
                                   report.mean, report.max, options.pixels_per_degree, report.rms));
  return ExitCode::kOk;
}

Expected<ExitCode> RunCompareVerb(const CompareVerb& verb, const Globals& globals) {
  SCUMBLE_RETURN_IF_ERROR(CheckHeatMap(verb));
  if (verb.flip) return RunFlip(verb, globals);
  if (!verb.motion.empty()) return RunFlicker(verb, globals);
  SCUMBLE_ASSIGN(const ChannelImage a, ReadChannels(verb.a));
  SCUMBLE_ASSIGN(const ChannelImage b, ReadChannels(verb.b));
  SCUMBLE_ASSIGN(const CompareReport report, Compare(a, b, verb.options));
  if (!verb.heat_map.empty()) {
    SCUMBLE_ASSIGN(const HeatMap map, DifferenceHeatMap(a, b, {0.0, verb.options.layers}));
    SCUMBLE_RETURN_IF_ERROR(WritePicture(verb.heat_map, map.picture));
    Say(globals, map.full_scale > 0.0
                     ? fmt::format("{}: yellow is a difference of {:.3g}", verb.heat_map, map.full_scale)
                     : verb.heat_map + ": nothing differs");
  }
  Print(globals.json ? CompareToJson(report) : CompareToText(report));
  return report.verdict == Verdict::kFail ? ExitCode::kDiffers : ExitCode::kOk;
}

void AddThresholds(CLI::App& sub, const std::string& name, DifferenceThresholds& thresholds) {
  const auto add = [&](const std::string& option, double& value, const std::string& help) {
    sub.add_option("--" + option, value, help)->type_name("N")->capture_default_str();
  };
  const std::string fails = name == "fail" ? "fails" : "is warned of";
  add(name, thresholds.absolute, "a pixel " + fails + " where a value differs by more than this …");
  add(name + "relative", thresholds.relative, "… and by more than this share of the values' mean, 0.01 being 1 %");
  add(name + "percent", thresholds.percent, "percentage of the pixels that may do so");
  add("hard" + name, thresholds.hard, "no value may differ by more than this, whatever the percentage");
}

// Another measure looks at none of the options that thresholds and layers are set by, nor at those of a third one.
void ExcludeOthers(CLI::App& sub, CLI::Option* measure, const std::string& own) {
  for (const CLI::Option* option : sub.get_options()) {
    const std::string name = option->get_name();
    if (!name.starts_with("--") || name.starts_with(own) || name == "--help" || name == "--heat-map") continue;
    measure->excludes(sub.get_option(name));
  }
}

}  // namespace

void AddCompareVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<CompareVerb>();
  CLI::App* sub =
      app.add_subcommand("compare", "how two pictures or guide files differ, by layer name; exit code 1 if they do");
  sub->add_option("a", verb->a, "first file")->type_name("FILE")->required();
  sub->add_option("b", verb->b, "second file")->type_name("FILE")->required();
  AddThresholds(*sub, "fail", verb->options.fail);
  AddThresholds(*sub, "warn", verb->options.warn);
  sub->add_option("--allowfailures", verb->options.allow_failures, "number of pixels that may fail by any amount")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  sub->add_option("--layer", verb->options.layers, "compare this layer alone, as normal; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  sub->add_option("-o,--heat-map", verb->heat_map,
                  "picture of the differences to write: dark where equal, yellow where most")
      ->type_name("FILE");
  CLI::Option* motion =
      sub->add_option(
             "--motion", verb->motion,
             "guides of the first picture's frame, with layer motion: measure how the colours of what stays in "
             "sight change on the way to the second picture, the next frame, and nothing else")
          ->type_name("FILE");
  sub->add_option("--motion-next", verb->motion_next,
                  "guides of the second picture's frame: what is hidden there is left out")
      ->type_name("FILE")
      ->needs(motion);
  CLI::Option* flip = sub->add_flag("--flip", verb->flip,
                                    "how visible the difference of two pictures is to who flips between them, 0 to 1 "
                                    "(FLIP, Andersson et al. 2020), and nothing else");
  sub->add_option("--flip-ppd", verb->flip_options.pixels_per_degree,
                  "pixels of the display in one degree of sight; 67 is 4K, 0.7 m wide and 0.7 m away")
      ->type_name("N")
      ->needs(flip)
      ->capture_default_str();
  ExcludeOthers(*sub, motion, "--motion"), ExcludeOthers(*sub, flip, "--flip");
  sub->footer("Thresholds are idiff's, which may be written with one dash: -fail 0.01 -failpercent 1.\n\n" +
              app.get_footer());
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunCompareVerb(*verb, globals); }; });
}

}  // namespace scumble
