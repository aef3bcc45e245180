// What the page shows, as plain values: which scene in which style, seen from where. Changed by PATCH alone.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/studio/session/catalogue.h"
#include "apps/studio/session/lane.h"
#include "core/image/status.h"
#include "core/style/style_keys.h"
#include "pipeline/requests.h"

namespace scumble {

struct StudioAssignment {
  std::string name;   // of an object or material; * stands for any text
  std::string style;  // id
};

// Finishing effects over the styles' own.
struct StudioFinish {
  std::string name;                     // of a FinishEntry
  std::map<std::string, double> dials;  // that are not at 0.5, by the names of kDials
};

struct StudioState {
  std::string scene, style;              // ids; empty: none is chosen
  std::map<std::string, KeyValue> keys;  // that differ from the first style's file
  std::vector<StudioAssignment> assignments;
  std::string camera;
  std::optional<ViewAngles> view;
  std::optional<LightAngles> light;
  std::optional<StudioFinish> finish;
  std::optional<int> frame;
  Size size{1280, 720};
  std::uint64_t seed = 0;
  std::optional<Quality> quality;  // of the final; empty: as it is, or by the budget
  double budget_ms = 0.0;          // 0: none
};

// The state with the changes of a PATCH, which api.md names. All or none: a kUsage error names the field, an unknown id
// is kInput.
Expected<StudioState> Patched(StudioState state, const nlohmann::json& changes, const Catalogue& catalogue);

// The fields of api.md that the state holds, but lists of what there is.
nlohmann::json ToJson(const StudioState& state);
nlohmann::json ToJson(const ViewAngles& view);

// What the state asks the pipeline for. `scene` is the command line's, of which the state replaces what it names.
// `is_alone`: no other style paints, so that the keys need not say which style they are of.
PictureJob JobOf(const StudioState& state, const Catalogue& catalogue, const SceneRequest& scene, bool is_alone);

// "scumble stylize …" that makes the same bytes, as a shell takes it.
// A budget stands there as the options that it `chose`.
std::string CommandOf(const PictureJob& job, const std::vector<std::string>& chosen = {});

}  // namespace scumble
