// Finishing effects on pictures of any renderer: `finish`, for one frame or a range.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/run_requests.h"
#include "pipeline/sequence.h"

namespace scumble {

struct FinishRequest {
  std::string picture;                     // a file, with a place for the frame's number for a range
  std::string guides;                      // of the same view and size; empty: for effects that need none
  std::string view_layer;                  // of a multilayer file; empty: the only one
  std::string light_layer;                 // as TransferRequest has it
  std::string camera;                      // likewise
  std::vector<std::string> finishes;       // as StyleRequest has it; at least one
  std::optional<FinishMeasures> measures;  // instead of those of the first picture
  std::vector<StyleOverride> sets;         // of finish and dials alone
  std::string output;
  std::string show_finish;  // as PictureRequest has it
  std::string layers_out;   // likewise
  int bits = 8;
  int png_level = 6;
  bool fast_io = false;
  std::uint64_t seed = 0;
  std::optional<FrameRate> fps;  // as TransferRequest has it
  std::optional<int> frame;      // of a single picture: for names, key frames and jitter_fps
  int reference_height = 1080;   // lengths are pixels at this height; 0: plain pixels
  SequenceRequest sequence;
};

// The effects see the picture as it is, with its alpha. What they measure is measured on the first frame that shows
// a surface. Errors leave older files as they are.
Expected<RunReport> RunFinish(FinishRequest request, const SequenceListener& listener, const RunContext& context);

}  // namespace scumble
