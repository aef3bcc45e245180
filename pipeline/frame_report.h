// What is reported of a frame: of guides that were made, or of a picture that was painted. Applications turn it into
// text and JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/image/layers.h"
#include "pipeline/memory_limit.h"
#include "pipeline/scene_guides.h"

namespace scumble {

// One step's time over several runs, in milliseconds.
struct StepSpread {
  std::string name;
  double median = 0, least = 0, most = 0;
};

struct StyleInReport {
  std::string given;  // as the user or the scene names it
  std::string name;
  int exemplars = 0;
  int exemplar_size = 0;  // the longer side
  int exemplar_width = 0, exemplar_height = 0;
  int levels = 0;
  int blend_radius = 0;
  std::vector<float> luminances;  // of each exemplar; empty: the style does not look at light
};

// Measured only where PictureRequest::measure_chunks asks for it.
struct ChunksReport {
  std::size_t covered_pixels = 0;
  double coherence = 0;
  std::size_t chunks = 0;
  double mean_chunk_area = 0;
};

struct PictureReport {
  std::string output;
  int width = 0, height = 0;
  int upsample = 1;
  bool upscale = false;
  int repeat = 1;
  std::uint64_t seed = 0;
  std::vector<StyleInReport> styles;  // the default first
  std::optional<double> exposure;     // stops, where some style looks at light
  std::optional<ChunksReport> chunks;
  std::vector<StepSpread> steps;
  std::string layers_output = {};        // the file of layers; empty: none
  std::vector<std::string> layers = {};  // in it, from the lowest
};

struct GuidesReport {
  std::string output;  // empty: a plan alone
  int width = 0, height = 0;
  LayerSet layers;
  int samples = 0;
  double noise = 0.0;
  bool open_ended = false;  // noise or the clock decided how many samples were taken
  StepTimes times;
  bool explain = false;  // the plan is wanted as text, too
};

struct FrameReport {
  std::variant<PictureReport, GuidesReport> made;
  std::vector<PlanItem> plan;     // empty: not asked for
  MemoryNeed memory;              // estimated for the whole run
  std::optional<SceneCost> cost;  // of casting, where rays were cast
  std::uint64_t bytes_written = 0;
  double write_ms = 0;  // encoding and writing
};

}  // namespace scumble
