// scumble compare --motion: the change of visible surfaces from one frame to the next.
#include <fmt/format.h>

#include "apps/cli/app/json_text.h"
#include "apps/cli/verbs/compare_verb.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "measure/flicker.h"
#include "measure/heat_map.h"

namespace scumble {
namespace {

// The guides for measuring flicker; missing layers are skipped.
Expected<GuideSet> ReadMotionGuides(const std::string& path, LayerSet required) {
  GuideReadOptions options;
  options.required = required.Add(Layer::kCoverage).Add(Layer::kNormal);
  options.optional = {Layer::kDepth, Layer::kObject, Layer::kPref};
  return ReadGuides(path, options);
}

// Steps of 255 that a map of flicker shows in full yellow: constant, so that maps can be laid side by side.
constexpr double kMostFlicker = 64.0;

}  // namespace

Expected<ExitCode> CompareByFlicker(const CompareVerb& verb, const Globals& globals) {
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
    globals.Note(fmt::format("{}: yellow is a change of {:.0f} of 255", verb.heat_map, kMostFlicker));
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

}  // namespace scumble
