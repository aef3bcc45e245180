// Committed limits of a cross-check, measured once. They can tighten the built-in limits and never loosen them.
//
// A baseline is JSON:
//   {"scumble_baseline": 1, "blender": "3.4.1",
//    "scenes": {"suzanne.glb": {"size": "640x360", "samples": 64, "max_bounces": 8,
//                               "limits": {"normal 99% within": 0.0007}}}}
// A scene may name its "camera" and "frame", if they were chosen. Figures are named by layer and name.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/status.h"
#include "measure/crosscheck.h"

namespace scumble {

struct BaselineScene {
  CrosscheckSetup setup;
  std::map<std::string, double> limits;  // finite, 0 or more
};

struct Baseline {
  std::string blender;                          // version that made the reference; empty: unknown
  std::map<std::string, BaselineScene> scenes;  // by file name, without folders
};

// `file` is for messages. Errors name the place in the file: no JSON, another version, unknown keys, values of a wrong
// type, negative limits.
Expected<Baseline> ParseBaseline(std::string_view text, const std::string& file);

// Two spaces of indentation, scenes and limits in alphabetical order, ending in a newline.
std::string BaselineToJson(const Baseline& baseline);

// The reason why the baseline does not apply to a scene of that file name rendered so, with the remedy; empty if it
// applies. Call it before the renders.
std::string BaselineMismatch(const Baseline& baseline, const std::string& scene, const CrosscheckSetup& setup);

// Puts the baseline's limits into the report. A figure in the baseline that was not measured fails the verdict. Returns
// warnings for stderr: limits above the built-in ones, which have no effect.
std::vector<std::string> ApplyBaseline(const Baseline& baseline, const std::string& scene, CrosscheckReport& report);

// Makes the report's figures the scene's entry. Each limit is measured × 1.25, for light plus twice the standard error,
// rounded up to two digits. It is never above the built-in limit, and never below the step of counting or rounding.
void RecordInBaseline(const CrosscheckReport& report, const std::string& scene, Baseline& baseline);

}  // namespace scumble
