// Painting one frame: prepared styles and guides in, a picture in memory out. Every run, trial and measurement of this
// library paints through these functions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/progress.h"
#include "finish/finish.h"
#include "pipeline/finish_layers.h"
#include "pipeline/frame_rate.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"
#include "scumble/picture.h"
#include "transfer/transfer.h"

namespace scumble {

// Prepares a style for pictures of this height, with look-up tables from the context's cache folder.
Expected<PreparedStyle> PrepareStyle(const Style& style, int height, const RunContext& context);

// The stops that were given, or measured on the guides; 0 where no style looks at light.
double ExposureOf(std::optional<double> given, std::span<const PreparedStyle> prepared, const GuideSet& guides,
                  int threads);

// The rate that was given, or that of the guides' attribute scumble:fps, or FrameRate().
FrameRate RateOf(std::optional<FrameRate> given, const GuideSet& guides);

// What is applied to the paint, in order; see finish/finish.h.
struct FrameFinish {
  std::vector<FinishStep> steps;
  FinishMeasures measures;
  int reference_height = 0;                // of lengths; 0: they are pixels
  const GuideSet* small_guides = nullptr;  // as FinishFrame has them
};

struct FrameSettings {
  std::uint64_t seed = 0;
  int frame = 0;
  FrameRate fps;
  double exposure = 0.0;                // stops
  const Picture* over = nullptr;        // underneath; null: nothing
  bool keep_field = false;              // the source field stays in the scratch memory
  const FrameFinish* finish = nullptr;  // null: nothing
  double* finish_ms = nullptr;          // null, or where its time is added
  LayersWanted layers_wanted = {};      // of the finish
  FinishedLayers* layers = nullptr;     // where they are put
};

// Paints one frame. `map` says which style paints which pixel; null: the first one paints all. Errors as of Transfer.
Status PaintFrame(std::span<const PreparedStyle> prepared, const StyleMap* map, const GuideSet& guides,
                  const FrameSettings& settings, const RunContext& context, const Progress& progress,
                  TransferScratch& scratch, Picture& picture);

}  // namespace scumble
