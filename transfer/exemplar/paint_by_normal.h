// Other places on an exemplar with paint for a surface of one normal: by normal, and by tone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "transfer/source.h"

namespace scumble {

class PreparedExemplar;

// Immutable once made; concurrent reads are safe. It keeps no reference to the exemplar, which is an argument of every
// call.
class SourceVariation {
 public:
  // Sums over all usable pixels of all pictures. O(pixels · pictures).
  explicit SourceVariation(const PreparedExemplar& exemplar);

  struct Wanted {
    Source own;          // the source that would be taken otherwise; usable
    int picture = 0;     // of the exemplar
    double degrees = 0;  // how far from own's normal, 0 … 90
    int half_width = 1;  // of the square of paint around a source whose tone is compared, in pixels
    std::uint64_t hash = 0;
  };

  // A usable source whose normal is within the degrees of own's. Up to 24 are drawn by the hash, evenly among the
  // exemplar's pixels. The first is taken whose square has in its four quarters about the tone of the square around
  // `own`; if none has, the nearest one. (Quarters, because paint that is light on one side and dark on the other would
  // show its border although its mean is right.) `own` if no draw succeeds.
  Source Choose(const PreparedExemplar& exemplar, const Wanted& wish) const;

  // The mean colour (times alpha) and alpha of the usable pixels in a square around a source, to whole cells: 0 … 65535
  // each; empty where no pixel there is usable. All arithmetic is in integers.
  using Tone = std::array<std::int32_t, 4>;
  std::optional<Tone> ToneAround(Source source, int picture, int half_width) const;

  // The tone near a usable source, some 1/64 of the exemplar wide and without steps: fast enough for each pixel.
  Tone ToneAt(Source source, int picture) const;

 private:
  struct Sums {
    std::array<std::int64_t, 4> color{};
    std::int64_t count = 0;
  };
  std::optional<Tone> ToneOf(int picture, int x0, int y0, int x1, int y1) const;
  std::int64_t Unlikeness(Source source, const Wanted& wish, const Tone& tone) const;
  std::optional<Source> Draw(const PreparedExemplar& exemplar, Source own, double chord, float cosine, std::uint64_t a,
                             std::uint64_t b) const;

  int shift_ = 0, cell_ = 1;    // pixels a side of a summed cell: 2^shift
  int columns_ = 0, rows_ = 0;  // cells
  std::vector<std::vector<Sums>>
      tables_;  // by picture: sums of everything above and to the left, (columns + 1) × (rows + 1)
  std::vector<std::vector<Tone>> corners_;  // by picture: tones around the cells' corners

  // Scenes only: usable pixels by the cell that their normal's (x, y) is in, and where each cell begins.
  std::vector<std::uint32_t> by_normal_;
  std::vector<std::uint32_t> begins_;
};

}  // namespace scumble
