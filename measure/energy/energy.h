// The energy of a stylised picture: how far it is, patch by patch, from what the exemplar shows under the same guides.
//
// For a pixel p of the target and a position u of an exemplar,
//
//   E(p, u) = Σ |C_T(p + o) − C_S(u + o)|²  +  λ · |G_T(p) − G_S(u)|²,    o in [−2, 2]²
//   |G_T(p) − G_S(u)|² = max(0, |N_T(p) − N_S(u)| − free(p))² + Σ (other guides)²
//
// with C the colours as painted (R, G and B, sRGB-encoded, 0 … 1, straight: alpha does not matter) and G the guides:
// unit normals N, of which the target may grant some distance, and whatever planes are added to them. It is what
// patch-based synthesis minimises, as StyLit does [Fišer et al. 2016, eq. 1]. Guides are compared in the middle:
// normals of 5×5 pixels of another form never agree, whatever the method, and that would be most of the figure. Three
// means of it:
//
//   energy   over the target's p that are measured, of the least E(p, u) over all u. Is all that the picture shows the
//            exemplar's? With λ = 0, any straight copy scores 0, wherever it came from; otherwise no more than λ times
//            its own guide error, as the place that it was copied from is one of those looked at. 0 is a picture all of
//            whose patches stand in the exemplar under the very same guides.
//   missing  over the exemplar's u that the scene asks for, of the least E(p, u) over all p. Is all that the exemplar
//            shows in the picture? Paint that is smeared or averaged is near to *some* smooth patch, so the energy
//            alone favours it (the wash-out that StyLit works against); but the grain that it lost is missing. A
//            position is asked for where its normal differs from some normal of the target by at most 1/8 in x, y and
//            z, the threshold of chunks; a grid decides that, which lets some pass that differ by up to 1/4.
//   both     the sum: the bidirectional similarity of Simakov et al. 2008. Methods and settings are ranked by it.
//
// Figures depend on the scene, the style and the size: compare those of one. With one seed all methods are looked at in
// the same places, so that what they differ by is surer than the standard errors of each.
//
// The patch is cut where p + o is outside or not measured, seen from the other side where u + o is not usable: the sum
// of a patch with n places is multiplied by 25 / n, so that silhouettes weigh like everything else. It fits where all
// places that count are there on the other side. Where nothing has room for 5×5, patches are 3×3, or single pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/image/status.h"
#include "measure/energy/stratified_sample.h"
#include "measure/mosaic/coherence.h"
#include "scumble/picture.h"

namespace scumble {

// Planes are views of width × height values of the picture, rows from the top; nothing is kept.
struct EnergyTarget {
  const Picture* picture = nullptr;              // best without paper behind it
  std::array<std::span<const float>, 3> normal;  // view space, unit on pixels that are measured
  std::span<const float> coverage;               // 0 … 1
  // Guides beside normals, multiplied by the square root of what each counts; as many as the exemplars have.
  std::vector<std::span<const float>> more_guides = {};
  // By pixel, 0 … 2: how far from the pixel's own a normal may be, as the distance of the two, without cost. A style's
  // `variety` grants it on flat surfaces; what an artist asked for is no error. Empty: 0 everywhere.
  std::span<const float> free = {};
};

// At the size at which it was used, with the paint that was used.
struct EnergyExemplar {
  const Picture* picture = nullptr;
  std::array<std::span<const float>, 3> normal;
  std::span<const std::uint8_t> usable;  // not 0: may be shown
  std::vector<std::span<const float>> more_guides = {};
};

struct EnergyOptions {
  // What guides count, 0 … 1e12. At 10 a place that is one threshold of chunks off (1/8) costs as much as a mean error
  // of 0.046 of each colour value in a patch.
  double lambda = 10.0;
  float least_coverage = 0.999f;  // pixels covered less are not measured: what lies behind would show in their colour
  std::size_t samples = 4096;  // patches to look at on either side, rounded up to even; 0, or as many as there are: all
  std::uint64_t seed = 0;      // which
  int threads = 0;             // 0: all; they do not matter to the result
  // Where the picture took its paint from, if known: good first guesses. They do not matter to the result, and
  // positions that are not usable are passed over. Only covered pixels are read.
  const SourcePlanes* sources = nullptr;
};

// What was found at one pixel.
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
  Estimate missing;  // of color + λ · guide of the exemplars' patches; 0 where the scene asks for none
  Estimate missing_color;
  Estimate missing_guide;
  std::size_t measured = 0;           // pixels of the target that count
  std::size_t asked_for = 0;          // positions of exemplars
  int patch_side = 5;                 // of the target's patches
  std::vector<EnergySample> samples;  // those of the target, along a Z-order curve of the picture
};

// Samples are stratified: the places that count are cut along a Z-order curve into pieces of equal length, and a hash
// of the seed picks two of each. The nearest patch is exact: whatever is not looked at has a lower bound above the
// best. Nothing measured: all figures 0. Errors (kInput): planes of a wrong size, no exemplar, none with a usable
// position, guides that are NaN or beyond ±1e6 where they count, different numbers of guides or more than 32,
// a free distance that is not 0 … 2; (kUsage):
// a λ out of range. O(samples · (positions / 64 + those that bounds leave)); about 250 bytes for each usable position,
// and each measured pixel.
Expected<EnergyReport> MeasureEnergy(const EnergyTarget& target, std::span<const EnergyExemplar> exemplars,
                                     const EnergyOptions& options = {});

// Mean angle in degrees between each pixel's normal and that of the place its paint was taken from, over all covered
// pixels of `sources` that are measured by `least_coverage`: the guide error of a method as such. 0 where there is
// none. Errors as above, and sources that lie outside their exemplar.
Expected<double> MeanSourceDegrees(const EnergyTarget& target, std::span<const EnergyExemplar> exemplars,
                                   const SourcePlanes& sources, float least_coverage = 0.999f);

}  // namespace scumble
