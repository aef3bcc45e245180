// Limits of a cross-check that a team commits: measured once, kept since. They can tighten the built-in limits and
// never loosen them.
//
// A baseline is JSON:
//   {"scumble_baseline": 1, "blender": "3.4.1",
//    "scenes": {"suzanne.glb": {"size": "640x360", "samples": 64, "max_bounces": 8, "limits": {"normal 99% within":
//    0.0007}}}}
// A scene may name its "camera" and "frame", where they were chosen. Figures are named by layer and name.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/status.h"
#include "measure/crosscheck/crosscheck.h"

namespace scumble {

struct BaselineScene {
  CrosscheckSetup setup;
  std::map<std::string, double> limits;  // finite, 0 or more
};

struct Baseline {
  std::string blender;                          // version that made the reference; empty: not said
  std::map<std::string, BaselineScene> scenes;  // by file name, without folders
};

// `file` is for messages. Errors name the place in the file: no JSON, another version, unknown keys, values of a wrong
// type, negative limits.
Expected<Baseline> ParseBaseline(std::string_view text, const std::string& file);

// Two spaces of indentation, scenes and limits in alphabetical order, ending in a newline.
std::string BaselineToJson(const Baseline& baseline);

// Why the baseline cannot judge a scene of that file name rendered so, with how to mend it; empty where it can. To be
// asked before the renders.
std::string BaselineMismatch(const Baseline& baseline, const std::string& scene, const CrosscheckSetup& setup);

// Puts the baseline's limits into the report. A figure that it names and that was not measured fails the verdict.
// Returns what deserves a line on stderr: limits above the built-in ones, which stay without effect.
std::vector<std::string> ApplyBaseline(const Baseline& baseline, const std::string& scene, CrosscheckReport& report);

// Makes the report's figures the scene's entry: measured × 1.25, and for light twice the standard error on top, rounded
// up to two digits, never above the built-in limit and never below what counting or rounding makes senseless.
void RecordInBaseline(const CrosscheckReport& report, const std::string& scene, Baseline& baseline);

}  // namespace scumble
