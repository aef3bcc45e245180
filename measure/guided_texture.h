// Guided texture distance: what does paint look like, locally, where the surface is turned like this, and does the
// picture have it?
//
// The disc of normals is cut into 52 cells of about equal area. In each, the distribution of local features
// (paint_pyramid.h) over the picture's pixels is compared with that over the exemplar's by a sliced Wasserstein
// distance (Rabin, Peyré, Delon, Bernot 2012): features are divided by their standard deviation over the exemplar,
// projected on fixed directions, and sorted; the distance is the mean difference of 64 quantiles, over all slices, and
// over all cells by the root of the picture's area in them. Cells of guide space take the place of the spatial tags of
// Heitz, Vanhoey, Chambon, Belcour 2021.
//
// Any arrangement that keeps the exemplar's strokes scores little, whatever pixel lies where. Flat, smeared, blurred,
// noisy and rescaled paint does not have the distributions, and the borders of a mosaic add bars that the exemplar does
// not have. That one place is repeated is not seen: see measure/repetition.h.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "core/image/status.h"
#include "measure/energy.h"

namespace scumble {

struct GuidedTextureReport {
  double distance = 0.0;  // over the cells of tone and of all octaves; 0: the same distributions
  double tone = 0.0;
  std::array<double, 4> strokes = {};  // by octave, the finest first; 0: too few pixels
  std::size_t measured = 0;            // pixels of the picture whose tone counts
};

// Exemplars, measured once. Immutable; free to use from any thread.
class GuidedTexture {
 public:
  // The exemplars are read, and not kept. Where there are several, a pixel's is the one whose first guide beside
  // normals is nearest, taken to be the same everywhere on it, as for lighting conditions. Errors (kInput): no
  // exemplar, planes of a wrong size. O(pixels). `threads` 0: all; no figure depends on them.
  static Expected<GuidedTexture> Of(std::span<const EnergyExemplar> exemplars, int threads = 0);
  ~GuidedTexture();
  GuidedTexture(GuidedTexture&&) noexcept;
  GuidedTexture& operator=(GuidedTexture&&) noexcept;

  // `surface`: by pixel of the target the number of its surface, not below 0: strokes are not measured across its
  // border. Pixels with a coverage below 0.999 are left out, `free` is not read. Errors (kInput): planes of a wrong
  // size. O(pixels); about 90 bytes for each.
  Expected<GuidedTextureReport> Measure(const EnergyTarget& target, std::span<const float> surface,
                                        int threads = 0) const;

  // The distance between one half of the exemplars and the other, in blocks of 24 pixels: what paint of one kind
  // differs by. The first half has half of the pixels, so a picture may score less. Empty: they are too small to be
  // measured.
  std::optional<double> floor() const;

 private:
  struct Impl;
  explicit GuidedTexture(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace scumble
