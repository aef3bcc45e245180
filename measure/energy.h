// The energy of a stylised picture: its distance, patch by patch, from the exemplar's paint under the same guides.
//
// For a pixel p of the target and a position u of an exemplar,
//
//   E(p, u) = Σ |C_T(p + o) − C_S(u + o)|²  +  λ · |G_T(p) − G_S(u)|²,    o in [−2, 2]²
//   |G_T(p) − G_S(u)|² = max(0, |N_T(p) − N_S(u)| − free(p))² + Σ (other guides)²
//
// with C the colours as painted (R, G and B, sRGB-encoded, 0 … 1, straight: alpha does not matter) and G the guides:
// unit normals N, of which the target may permit some distance, and any further planes. Patch-based synthesis minimises
// it, as StyLit does [Fišer et al. 2016, eq. 1]. Guides are compared in the middle only: 5×5 normals of another form
// never agree with any method, and that would dominate the figure. Three means of it:
//
//   energy   over the measured p of the target, of the least E(p, u) over all u: does the picture show only the
//            exemplar's paint? With λ = 0, any straight copy scores 0, from any place; otherwise no more than λ times
//            its own guide error, as the place of its source is among the u. 0 is a picture whose patches all are in
//            the exemplar under equal guides.
//   missing  over the exemplar's u that the scene needs, of the least E(p, u) over all p: is all of the exemplar's
//            paint in the picture? Smeared or averaged paint is near to *some* smooth patch, so the energy alone
//            favours it (the wash-out that StyLit avoids); but its grain is missing. A position is needed where its
//            normal differs from some normal of the target by at most 1/8 in x, y and z, the threshold of chunks; a
//            grid decides that, which lets some pass that differ by up to 1/4.
//   both     the sum: the bidirectional similarity of Simakov et al. 2008. Methods and settings are ranked by it.
//
// Figures depend on the scene, the style and the size: compare those of one. With one random seed all methods are
// measured in the same places, so their differences are more certain than each one's standard error.
//
// The patch is cut where p + o is outside or not measured, and for `missing` where u + o is not usable: the sum
// of a patch with n places is multiplied by 25 / n, so that silhouettes have equal weight. A patch fits where all of
// its places exist on the other side. If no position has room for 5×5, patches are 3×3, or single pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/image/status.h"
#include "measure/coherence.h"
#include "measure/mosaic/stratified_sample.h"
#include "scumble/picture.h"

namespace scumble {

// Planes are views of width × height values of the picture, rows from the top; they are not stored.
struct EnergyTarget {
  const Picture* picture = nullptr;              // best without paper behind it
  std::array<std::span<const float>, 3> normal;  // view space, unit on pixels that are measured
  std::span<const float> coverage;               // 0 … 1
  // Guides beside normals, multiplied by the square root of their weight; as many as the exemplars have.
  std::vector<std::span<const float>> more_guides = {};
  // By pixel, 0 … 2: the distance between normals that costs nothing there. A style's `variety` permits it on flat
  // surfaces; an artist's setting is no error. Empty: 0 everywhere.
  std::span<const float> free = {};
};

// At the size and with the paint that the transfer used.
struct EnergyExemplar {
  const Picture* picture = nullptr;
  std::array<std::span<const float>, 3> normal;
  std::span<const std::uint8_t> usable;  // not 0: usable
  std::vector<std::span<const float>> more_guides = {};
};

struct EnergyOptions {
  // The weight of the guides, 0 … 1e12. At 10 a place that is one threshold of chunks off (1/8) costs as much as a mean
  // error of 0.046 of each colour value in a patch.
  double lambda = 10.0;
  float least_coverage = 0.999f;  // pixels covered less are not measured: the background would show in their colour
  std::size_t samples = 4096;  // patches to measure on either side, rounded up to even; 0, or as many as there are: all
  std::uint64_t seed = 0;      // random seed of the choice
  int threads = 0;             // 0: all; the result does not depend on them
  // The sources of the picture's paint, if known: good first candidates. The result does not depend on them, and
  // unusable positions are skipped. Only covered pixels are read.
  const SourcePlanes* sources = nullptr;
};

// The result at one pixel.
struct EnergySample {
  int x = 0, y = 0;  // of the target
  int exemplar = 0;  // the nearest patch; of equally near ones the first in the order of exemplars and rows
  int source_x = 0, source_y = 0;
  double color = 0.0;    // the sum over the patch, times 25 / n
  double guide = 0.0;    // without λ
  double degrees = 0.0;  // between the normals in the middle of both
  bool operator==(const EnergySample&) const = default;
};

struct EnergyReport {
  Estimate both;    // energy + missing
  Estimate energy;  // of color + λ · guide
  Estimate color;   // of the target's patches
  Estimate guide;
  Estimate degrees;
  Estimate missing;                   // of color + λ · guide of the exemplars' patches; 0 where the scene needs none
  std::size_t measured = 0;           // pixels of the target in the mask
  std::size_t asked_for = 0;          // positions of exemplars that the scene needs
  int patch_side = 5;                 // of the target's patches
  std::vector<EnergySample> samples;  // of the target, along a Z-order curve of the picture
};

// Samples are stratified: the valid places are cut along a Z-order curve into strata of equal length, and a hash of the
// seed picks two of each. The nearest patch is exact: every skipped position has a lower bound above the best. Nothing
// measured: all figures 0. Errors (kInput): planes of a wrong size, no exemplar, none with a usable position, guides
// that are NaN or beyond ±1e6 where they count, different numbers of guides or more than 32, a free distance that is
// not 0 … 2; (kUsage): a λ out of range. O(samples · (positions / 64 + those that bounds leave)); about 250 bytes for
// each usable position, and each measured pixel.
Expected<EnergyReport> MeasureEnergy(const EnergyTarget& target, std::span<const EnergyExemplar> exemplars,
                                     const EnergyOptions& options = {});

// The guide error of a method: the mean angle in degrees between each pixel's normal and that of its source, over all
// covered pixels of `sources` that are measured by `least_coverage`. 0 where there is none. Errors as above, and
// sources that lie outside their exemplar.
Expected<double> MeanSourceDegrees(const EnergyTarget& target, std::span<const EnergyExemplar> exemplars,
                                   const SourcePlanes& sources, float least_coverage = 0.999f);

}  // namespace scumble
