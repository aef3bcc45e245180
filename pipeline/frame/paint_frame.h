// What `transfer` and `stylize` have in common: guides and a style in, a picture file out.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/app/options.h"
#include "pipeline/frame/provenance.h"
#include "pipeline/run/sequence.h"
#include "pipeline/style/style_set.h"
#include "core/image/guides.h"
#include "transfer/transfer.h"

namespace scumble {

struct PictureOptions {
  std::string output;
  std::string over;
  int bits = 8;
  int png_level = 6;
  bool fast_io = false;
  std::optional<int> frame;
  std::string fps;  // empty: what the guides say, or kUsualFps
  std::string exposure = "auto";
  std::uint64_t seed = 0;
  int repeat = 1;
  int upsample = 1;  // the picture is so many times as wide and high as the guides
  std::string show;  // an explanation's name; empty: the result itself
  nlohmann::ordered_json chosen = nlohmann::ordered_json::object();  // what --quality or --budget-ms took, for the report
};
// `needed`: the verb does nothing without an output.
void AddPictureOptions(CLI::App& verb, PictureOptions& options, bool needed);

// What is written for --resume to compare, of styles that are at the picture's frame. Rate, exposure and the samples of the
// guides' light where they are known already.
PictureSettings SettingsOf(const PictureOptions& options, std::optional<FrameRate> fps, std::optional<double> exposure,
                           std::optional<int> samples);

// The samples of a pixel of light that guides by their attributes were cast with; nothing where they do not tell.
std::optional<int> SamplesTold(const std::map<std::string, std::string>& attributes);

// The rate that was asked for, or that of a .blend, which its guides keep in the attribute scumble:fps.
Expected<FrameRate> RateFor(const PictureOptions& options, const GuideSet& guides);

// Stops of --exposure; nothing for auto. A usage error says what was expected.
Expected<std::optional<double>> ParseExposure(const std::string& text);

// Where the guides come from.
struct GuideSource {
  std::string name;            // the file, for messages
  StepTimes times;             // of the steps that led to them
  std::vector<PlanItem> plan;  // printed as part of the result, unless it is empty
  std::optional<SceneCost> cost = {};  // of casting them, where they were cast
  MemoryNeed memory = {};      // of the whole run
};

// What a sequence keeps from frame to frame.
struct TransferMemory {
  std::vector<PreparedStyle> prepared;  // by style; empty: not yet
  std::optional<double> exposure;       // stops, once given or measured
  TransferScratch scratch;
  ExemplarHashes hashes;
  std::string over_file;        // that `over` is from
  std::optional<Picture> over;  // one picture underneath all frames is read once
  int width = 0, height = 0;    // of the first frame's guides
  bool warned = false;          // of options that change nothing
  bool warned_of_size = false;
};

// Reads --over, unless `memory` has it already.
Status ReadOver(const std::string& file, TransferMemory& memory);

// Of two lighting conditions with one luminance only the first is ever chosen: the others, with what is wrong
// and how to mend it.
struct EqualLight {
  std::string image, what, mend;
};
std::vector<EqualLight> EqualLights(const Style& style, const PreparedStyle& prepared);

// "luminance 0.8, given" or where it is measured. `rim` is the style's.
std::string LightInWords(const Exemplar& exemplar, double rim);

// Brings the styles to options.frame and prepares what has changed since the last call; sets the exposure if
// it is not set. TransferFrame does it by itself.
Status PrepareFrame(StyleSet& styles, const GuideSet& guides, const PictureOptions& options, const Globals& globals,
                    TransferMemory& memory);

// Prepares, transfers `repeat` times and makes the picture, or the one that explains it; what it returns writes that. It reports
// the path with the time of each step, and as JSON the steps, coherence and sizes.
Expected<FrameWrite> TransferFrame(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                                    const PictureOptions& options, const Globals& globals, const Progress& progress,
                                    TransferMemory& memory);

// Whether the source field outlives the transfer, to be reported or shown: that takes more time.
bool KeepsField(const PictureOptions& options, const Globals& globals);

// Whether the exposure is measured, and by some style is looked at.
bool MeasuresExposure(const StyleSet& styles, const PictureOptions& options);

// One picture: makes it and prints the report.
Expected<ExitCode> RunTransfer(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                               const PictureOptions& options, const Globals& globals, const Progress& progress);

}  // namespace scumble
