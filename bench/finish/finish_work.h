// What finishing effects are timed on: a painting with its guides, copies of the bytes that an effect reads and writes,
// and passes by their keys.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/guides.h"
#include "core/image/status.h"
#include "finish/finish.h"
#include "scumble/picture.h"
#include "scumble/stylizer.h"

namespace scumble::bench {

// The still life in oil, with all layers that effects read, but for light paths.
class FinishWork {
 public:
  static Expected<FinishWork> Make(int width, int height);

  const Picture& painted() const { return painted_; }
  const GuideSet& guides() const;
  std::vector<float> Colors() const;  // of the painting: red, green and blue, 0 … 1

  // All stages of the passes. Ends the program if an effect fails.
  void Apply(const std::vector<FinishPass>& passes, Picture& picture) const;

 private:
  FinishWork(GuideLayers layers, Picture painted);

  GuideLayers layers_;
  Picture painted_;
  FinishMeasures measures_;
};

// Fills the caches with something else: a frame's transfer, too, leaves them full of other things.
class OtherMemory {
 public:
  void Touch();

 private:
  std::vector<unsigned char> bytes_ = std::vector<unsigned char>(std::size_t(256) << 20);
};

// Copies the picture, and the layers that passes need, by all threads.
class Copies {
 public:
  Copies(const FinishWork& work, const std::vector<FinishPass>& passes);
  void Run();

 private:
  const Picture& picture_;
  std::vector<std::uint16_t> texels_;
  std::vector<std::span<const float>> planes_;
  std::vector<std::vector<float>> copies_;
};

// One pass each, with these values and defaults for others.
std::vector<FinishPass> Outlining(double width);
std::vector<FinishPass> Smoothing(SmoothPass::Filter filter, double radius, int passes, bool borders = false);
std::vector<FinishPass> Edging(EdgesPass::Tone tone, double flow = 0.0, bool borders = false);
// Those of single pixels, which run as one.
std::vector<FinishPass> FusedPasses();

}  // namespace scumble::bench
