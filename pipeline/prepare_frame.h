// Before a frame is painted: its styles at their keyframes, their exemplars prepared, and what is measured on the first
// frame and kept for all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/image/style.h"
#include "pipeline/finish_set.h"
#include "pipeline/frame/provenance.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"
#include "scumble/picture.h"
#include "transfer/transfer.h"

namespace scumble {

// What a sequence keeps from frame to frame.
struct PictureState {
  std::vector<PreparedStyle> prepared;            // by style; empty: not yet
  std::optional<double> exposure;                 // stops, once given or measured
  std::optional<FinishMeasures> finish_measures;  // once they are measured
  PaletteColors palette_colors;
  TransferScratch scratch;
  ExemplarHashes hashes;
  std::string over_file, over_view_layer;  // that `over` is from
  std::optional<Picture> over;             // one picture underneath all frames is read once
  int width = 0, height = 0;               // of the first frame's guides
  FinishRemarks finish_remarks;
  bool warned = false;  // of options that change nothing
  bool warned_of_size = false;
};

// Measures what finishing passes look at, unless `state` has it already, and tells it. Nothing where none looks.
// `frame`: of a sequence.
void MeasureFinishOf(const StyleSet& styles, const GuideSet& guides, std::optional<int> frame,
                     const RunContext& context, PictureState& state);

// Of two lighting conditions with one luminance only the first is ever chosen: the others, with what is wrong
// and how to fix it.
struct EqualLight {
  std::string image, what, fix;
};
std::vector<EqualLight> EqualLights(const Style& style, const PreparedStyle& prepared);

// "luminance 0.8, given" or where it is measured. `rim` is the style's.
std::string DescribeLuminance(const Exemplar& exemplar, double rim);

// Brings the styles to the request's frame and prepares what has changed since the last call; finds the exposure if it
// is not known yet. PaintPicture calls it.
Status PrepareFrame(StyleSet& styles, const GuideSet& guides, const PictureRequest& request, const RunContext& context,
                    PictureState& state);

// Settings of the transfer that are read frame by frame: where only these change, exemplars stay prepared.
bool IsReadEachFrame(const std::string& key);

// Whether the exposure is measured, and by some style is looked at.
bool MeasuresExposure(const StyleSet& styles, const PictureRequest& request);

}  // namespace scumble
