// What a picture was made with, as text that is kept in its file: --resume makes pictures again that other settings
// made.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "measure/explain.h"
#include "pipeline/frame_rate.h"
#include "pipeline/style_set.h"

namespace scumble {

// Hashes of exemplars by their place in a set: pictures take the longest.
using ExemplarHashes = std::map<std::pair<std::size_t, std::size_t>, std::uint64_t>;

struct PictureSettings {
  std::uint64_t seed = 0;
  bool over = false;  // something lies underneath
  std::optional<Explanation> show;
  int upsample = 1;
  bool upscale = false;
  std::optional<FrameRate> fps;    // where it is known
  std::optional<double> exposure;  // where it is known; counts for styles of several exemplars, as does the next
  std::optional<bool> measured;    // whether --exposure auto found it; empty: the stops alone count
  // Of a pixel of light in the guides, as SamplesText has it; empty: unknown. Counts for styles that ask for any.
  std::string samples;
  std::string show_finish = {};  // of one finishing pass
  // What finishing effects measured or were given, as MeasuresText has it; empty: unknown. Counts where any looks, as
  // does whether it was measured; empty: the numbers alone count.
  std::string finish_measures = {};
  std::optional<bool> finish_measured = {};
  std::string guides = {};  // how they were made and chosen, as GuidesText has it; empty: unknown
};

// Of guides with these attributes: their attribute scumble:settings, and the layers chosen in their file, "; view_layer
// 'X'". Never empty.
std::string GuidesText(const std::map<std::string, std::string>& attributes, const std::string& chosen);

// All settings of the transfer, as text: equal texts, equal settings.
std::string TextOf(const TransferSettings& settings);

// Of one style: its exemplars, their light, its paper; not its settings.
std::uint64_t HashOfPaint(const Style& style);

// Of what the first `count` styles are and who has them: settings, exemplars, light, paper, assignments.
std::uint64_t HashOfStyles(const StyleSet& styles, std::size_t count, ExemplarHashes& known);

// The parts "; finish_measures …; finish_measured …" of such a text.
std::string FinishMeasuresPart(const std::string& measures, std::optional<bool> measured);

// The text: parts "name value" with semicolons between, as core/io/existing_output.h compares them; a part that is left
// out agrees with all. It holds only what both stylize and transfer know, and what changes the picture: equal pictures
// are equal files. Whether exposure and finishing effects were measured is an exception, because what was measured is
// not known where it is compared. The styles must be at the picture's frame (SetStyleFrame). Those that a scene asks
// for are left out.
std::string SettingsText(const StyleSet& styles, const PictureSettings& settings, ExemplarHashes& known);

}  // namespace scumble
