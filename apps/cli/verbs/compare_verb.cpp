// scumble compare.
#include "apps/cli/verbs/compare_verb.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <set>
#include <string>

#include "apps/cli/app/options.h"
#include "apps/cli/verbs/compare_files.h"
#include "core/io/picture_file.h"
#include "measure/compare.h"
#include "measure/heat_map.h"
#include "pipeline/run_inputs.h"

namespace scumble {
namespace {

Status CheckHeatMap(const CompareVerb& verb) {
  if (verb.heat_map.empty()) return Ok();
  RunInputs files;
  files.Reads("the first file", verb.a), files.Reads("the second file", verb.b);
  if (!verb.camera.empty()) files.Reads("the camera", verb.camera);
  if (!verb.motion.empty()) files.Reads("the guides", verb.motion);
  if (!verb.motion_next.empty()) files.Reads("the next frame's guides", verb.motion_next);
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(verb.heat_map));
  return files.CheckOutput(verb.heat_map);
}

std::string MapLegend(const HeatMap& map) {
  std::string legend = map.full_scale > 0.0 ? fmt::format("yellow is a difference of {:.3g}", map.full_scale) : "";
  if (map.incomparable > 0) {
    legend += fmt::format("{}magenta are pixels with NaN, or with infinity on one side: {}", legend.empty() ? "" : ", ",
                          map.incomparable);
  }
  return legend.empty() ? "nothing differs" : legend;
}

Expected<ExitCode> RunCompareVerb(const CompareVerb& verb, const Globals& globals) {
  SCUMBLE_RETURN_IF_ERROR(CheckHeatMap(verb));
  if (verb.flip) return CompareByFlip(verb, globals);
  if (!verb.motion.empty()) return CompareByFlicker(verb, globals);
  SCUMBLE_ASSIGN(const ComparedFiles files, ReadToCompare(verb, globals));
  SCUMBLE_ASSIGN(const CompareReport report, Compare(files.a, files.b, verb.options));
  if (!verb.heat_map.empty()) {
    SCUMBLE_ASSIGN(const HeatMap map, DifferenceHeatMap(files.a, files.b, {0.0, verb.options.layers}));
    SCUMBLE_RETURN_IF_ERROR(WritePicture(verb.heat_map, map.picture));
    globals.Note(verb.heat_map + ": " + MapLegend(map));
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

// Excludes the options of thresholds and layers, and those of a third measure, which this measure ignores; except those
// in `shared`.
void ExcludeOthers(CLI::App& sub, CLI::Option* measure, const std::string& own, const std::set<std::string>& shared) {
  for (const CLI::Option* option : sub.get_options()) {
    const std::string name = option->get_name();
    if (!name.starts_with("--") || name.starts_with(own) || shared.contains(name)) continue;
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
  sub->add_option("--view-layer", verb->view_layer,
                  "view layer of multilayer files; guides are then compared by what they mean, not by channel name")
      ->type_name("NAME");
  sub->add_option("--camera", verb->camera,
                  "the .camera file of a Blender render; left out: found from its Position pass")
      ->type_name("FILE");
  sub->add_option("-o,--heat-map", verb->heat_map,
                  "picture of the differences to write: dark where equal, yellow where most")
      ->type_name("FILE");
  CLI::Option* motion =
      sub->add_option(
             "--motion", verb->motion,
             "guides of the first picture's frame, with layer motion: measure how the colours of what stays in "
             "sight change on the way to the second picture, the next frame, and nothing else; it only measures, "
             "exit code 0")
          ->type_name("FILE");
  sub->add_option("--motion-next", verb->motion_next,
                  "guides of the second picture's frame: what is hidden there is left out")
      ->type_name("FILE")
      ->needs(motion);
  CLI::Option* flip = sub->add_flag(
      "--flip", verb->flip,
      "how visible the difference of two pictures is to who flips between them, 0 to 1 "
      "(FLIP, Andersson et al. 2020), and nothing else; of one layer of light with --layer, "
      "values clamped to 0 … 1; exit code 1 where --fail is given and the mean is above it or a value is NaN");
  sub->add_option("--flip-ppd", verb->flip_options.pixels_per_degree,
                  "pixels of the display in one degree of sight; 67 is 4K, 0.7 m wide and 0.7 m away")
      ->type_name("N")
      ->needs(flip)
      ->capture_default_str();
  ExcludeOthers(*sub, motion, "--motion", {"--help", "--heat-map"});
  ExcludeOthers(*sub, flip, "--flip", {"--help", "--heat-map", "--fail", "--layer"});
  sub->footer("Thresholds are idiff's, which may be written with one dash: -fail 0.01 -failpercent 1.\n\n" +
              app.get_footer());
  AddGlobalOptions(*sub, globals);
  const CLI::Option* const fail = sub->get_option("--fail");
  sub->callback([verb, fail, &globals, &chosen] {
    if (verb->flip && fail->count() > 0) verb->flip_fail = verb->options.fail.absolute;
    chosen = [verb, &globals] { return RunCompareVerb(*verb, globals); };
  });
}

}  // namespace scumble
