// What `transfer` and `stylize` have in common: guides and a style in, a picture file out.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/options.h"
#include "cli/style_set.h"
#include "image/guides.h"

namespace scumble {

struct PictureOptions {
  std::string output;
  std::string over;
  int bits = 8;
  int png_level = 6;
  std::optional<int> frame;
  std::string fps = "24";
  std::string exposure = "auto";
  std::uint64_t seed = 0;
  int repeat = 1;
  std::string show;  // an explanation's name; empty: the result itself
};
void AddPictureOptions(CLI::App& verb, PictureOptions& options);

// Where the guides come from.
struct GuideSource {
  std::string name;            // the file, for messages
  StepTimes times;             // of the steps that led to them
  std::vector<PlanItem> plan;  // printed as part of the result, unless it is empty
};

// Prepares, transfers `repeat` times, writes the picture, or the one that explains it, and prints its path with the time of each step. Under --json
// the steps, coherence and sizes as an object.
Expected<ExitCode> RunTransfer(const StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                               const PictureOptions& options, const Globals& globals, const Progress& progress);

}  // namespace scumble
