// What the variants of `scumble tradeoff` are measured against: the guides of the exact variant, and the exemplars as
// they are used.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/image/guides.h"
#include "measure/energy.h"
#include "measure/guided_texture.h"
#include "measure/outline_error.h"
#include "measure/tradeoff_report.h"
#include "transfer/transfer.h"

namespace scumble {

// How far guides are from those of the exact variant.
struct GuideDifference {
  double rms = 0.0;
  double flip = 0.0;
};

// What outlines that are off count for: where two pictures have the same paint, the eye looks at their outlines
// (docs/paint-texture.md).
inline constexpr double kOutlinesInTexture = 0.2;

class TradeReference {
 public:
  // `style` is prepared for the guides' height, at `exposure` stops. Both are kept.
  TradeReference(std::shared_ptr<const GuideSet> guides, PreparedStyle style, double exposure, int threads);

  const GuideSet& guides() const { return *guides_; }

  // Fills in the energies of a picture of the guides' size, which take the most time; where `field` is not null they
  // take less. `options` as they are but for `sources` and `threads`.
  Status MeasurePaint(const Picture& picture, const SourceField* field, EnergyOptions options,
                      TradeMeasure& measure) const;
  // The exemplars as MeasureTexture takes them.
  Expected<GuidedTexture> Texture() const { return GuidedTexture::Of(Exemplars(), threads_); }
  // Fills in `texture`: the distance of the picture's paint, times 1 and kOutlinesInTexture of its error at outlines.
  Status MeasureTexture(const GuidedTexture& exemplars, const Picture& picture, TradeMeasure& measure) const;
  // Fills in what the field shows of the mosaic.
  Status MeasureMosaic(const Picture& picture, const SourceField& field, TradeMeasure& measure) const;

  // Over pixels that both cover: of normals the root of the mean squared distance, and FLIP of (n + 1) / 2 as a
  // picture; where the style weighs light, of its layer that is farthest off instead, both exposed as the exact guides
  // are, so that 1 is the exemplar's brightest tenth, and cut there. The guides must have one size.
  Expected<GuideDifference> Compare(const GuideSet& guides) const;

 private:
  EnergyTarget Target(const Picture& picture) const;
  std::vector<EnergyExemplar> Exemplars() const;
  void AddWeighedGuides();
  void AddConditions();
  void AddFreedom();
  Expected<GuideDifference> CompareNormals(const GuideSet& guides) const;
  Expected<GuideDifference> CompareLight(const GuideSet& guides, Layer layer, float white) const;

  std::shared_ptr<const GuideSet> guides_;
  PreparedStyle style_;
  double exposure_;
  int threads_;
  std::array<std::vector<float>, 3> normal_;                        // of exemplars, by pixel
  std::vector<std::uint8_t> usable_;                                // likewise
  std::vector<std::vector<float>> more_;                            // guides beside normals, of the scene
  std::vector<std::vector<std::vector<float>>> more_of_exemplars_;  // by exemplar
  std::vector<float> free_;  // of normals, what `variety` grants; empty without it
};

}  // namespace scumble
