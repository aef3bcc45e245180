// scumble compare.
#include "measure/compare.h"

#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "io/channel_file.h"
#include "io/picture_file.h"
#include "measure/heat_map.h"

namespace scumble {
namespace {

struct CompareVerb {
  std::string a;
  std::string b;
  CompareOptions options;
  std::string heat_map;
};

Expected<ExitCode> RunCompareVerb(const CompareVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(const ChannelImage a, ReadChannels(verb.a));
  SCUMBLE_ASSIGN(const ChannelImage b, ReadChannels(verb.b));
  SCUMBLE_ASSIGN(const CompareReport report, Compare(a, b, verb.options));
  if (!verb.heat_map.empty()) {
    SCUMBLE_ASSIGN(const HeatMap map, DifferenceHeatMap(a, b, {0.0, verb.options.layers}));
    SCUMBLE_RETURN_IF_ERROR(WritePicture(verb.heat_map, map.picture));
    Say(globals, verb.heat_map + ": yellow is a difference of " + std::to_string(map.full_scale));
  }
  Print(globals.json ? CompareToJson(report) : CompareToText(report));
  return report.verdict == Verdict::kFail ? ExitCode::kDiffers : ExitCode::kOk;
}

void AddThresholds(CLI::App& sub, const std::string& name, const std::string& hard, DifferenceThresholds& thresholds) {
  sub.add_option("--" + name, thresholds.absolute, "a value differs beyond this absolute difference")
      ->capture_default_str();
  sub.add_option("--" + name + "relative", thresholds.relative, "… and beyond this relative difference")
      ->capture_default_str();
  sub.add_option("--" + name + "percent", thresholds.percent, "share of the pixels that may differ, percent")
      ->capture_default_str();
  sub.add_option("--" + hard, thresholds.hard, "no value may differ by more than this")->capture_default_str();
}

}  // namespace

void AddCompareVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<CompareVerb>();
  CLI::App* sub = app.add_subcommand("compare", "how two pictures or guide files differ, by layer name");
  sub->add_option("a", verb->a, "first file")->required();
  sub->add_option("b", verb->b, "second file")->required();
  AddThresholds(*sub, "fail", "hardfail", verb->options.fail);
  AddThresholds(*sub, "warn", "hardwarn", verb->options.warn);
  sub->add_option("--allowfailures", verb->options.allow_failures, "so many pixels may differ by any amount")
      ->capture_default_str();
  sub->add_option("--layer", verb->options.layers, "compare this layer alone; repeatable")->allow_extra_args(false);
  sub->add_option("-o,--heat-map", verb->heat_map, "picture of the differences to write");
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunCompareVerb(*verb, globals); }; });
}

}  // namespace scumble
