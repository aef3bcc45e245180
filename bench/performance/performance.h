// The parts of `make bench` that run inside one process: each measures some of the targets and adds to the report.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/performance/figures.h"
#include "bench/performance/frames.h"
#include "bench/performance/repeats.h"
#include "transfer/transfer.h"

namespace scumble::bench {

struct PerformanceOptions {
  std::vector<std::pair<int, int>> sizes{{1920, 1080},
                                         {3840, 2160}};  // of the yardstick's frames; others have the first
  std::pair<int, int> light_size{960, 540};              // of frames with light paths, which are slow to trace
  std::vector<double> megapixels{1, 2, 8, 33, 64};       // for linearity; the others are compared with the first
  int light_samples = 16;
  RepeatOptions repeats;
};

// Transfers of one prepared style, called as by a sequence: buffers are kept, guides are the caller's. Renewed jitter
// takes the next frame number at every call.
class Engine {
 public:
  // Guides of `height` rows. Threads 0: all.
  Engine(const Style& style, int height, int threads = 1);
  // Several styles; `maps` are the frame's and its mirror image's.
  Engine(const std::vector<Style>& styles, int height, std::vector<StyleMap> maps, int threads = 1);

  void Paint(const Frame& frame, bool mirrored = false);
  TransferOptions options;
  const PreparedStyle& prepared() const { return styles_.front(); }
  const Picture& picture() const { return picture_; }
  const SourceField& field() const { return scratch_.field; }  // if the options keep it
  const StageTimes& stages() const { return scratch_.times; }  // of the last frame

 private:
  std::vector<PreparedStyle> styles_;
  std::vector<StyleMap> maps_;  // empty with one style
  TransferScratch scratch_;
  Picture picture_;
};

// A contender that paints the frame and its mirror image, if there is one, in turn.
std::function<void()> Painting(Engine& engine, const Frame& frame);

// 1 and 2: against the yardstick, nanoseconds a pixel, frames a second, two threads, coherence.
void MeasureYardstick(const PerformanceOptions& options, Report& report);
void MeasureFrameRates(const PerformanceOptions& options, Report& report);
// 3: radius 8. 4: what extensions cost.
void MeasureRadius(const PerformanceOptions& options, Report& report);
void MeasureExtensions(const PerformanceOptions& options, Report& report);
void MeasureLightPaths(const PerformanceOptions& options, Report& report);
// 5: nanoseconds a pixel by size, and memory, which a separate process measures: `program` is this one.
void MeasureSizes(const PerformanceOptions& options, Report& report);
void MeasureMemory(const std::string& program, const PerformanceOptions& options, Report& report);
// The work of that process: prints bytes a pixel of a frame of that many pixels.
int PrintMemory(int width, int height, bool edge_aware);

}  // namespace scumble::bench
