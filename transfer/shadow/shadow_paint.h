// The parts of an exemplar that paint shadows.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/painting/bare_paper.h"
#include "scumble/picture.h"
#include "transfer/prepared_exemplar.h"

namespace scumble {

// The darkest place of an exemplar.
struct DarkPlace {
  Source center;
  int exemplar = 0;
  int reach = 0;  // pixels around the centre that count as dark
};

// The square of usable paint, an eighth of the exemplar's shorter side wide, with the lowest mean luminance over white,
// in any lighting condition; ties to the first in (exemplar, y, x). If an exemplar is too fragmented for that, its
// darkest pixel.
DarkPlace DarkestPlace(const PreparedExemplar& exemplar);

// Paint for shadows of every strength, 0 none … 1 full. Full shadow is the darkest place's paint.
//
// Where the exemplars are spheres painted on bare paper (bare_paper.h), an intermediate strength uses the artist's own
// paint of that tone, lifted off its paper. It comes from places of the sphere whose mean luminance over the paper is
// that share of the way from bare paper to the darkest place, in linear light. A sphere that is cut out of its picture
// counts as painted on white, if white or nothing shows between its strokes.
//
// Where paint covers everything, there is no such scale. Then the darkest place's paint gets the strength as its mean
// opacity, with less where the texels around are darker, so that its strokes show. Immutable.
class ShadowPaint {
 public:
  // `originals` are the pictures that the exemplar was prepared from, in its order.
  ShadowPaint(std::shared_ptr<const PreparedExemplar> exemplar, std::span<const Picture* const> originals);

  const DarkPlace& dark() const { return dark_; }
  bool has_tones() const { return !tones_.empty(); }
  int level() const { return level_; }  // chunks come from a grid of 2^level pixels

  struct Place {
    Source center;
    int exemplar = 0;
  };
  static constexpr int kSteps = 16;
  // One of the places that suit a strength of step / kSteps; the hash chooses.
  Place PlaceFor(int step, std::uint64_t hash) const;
  // The paint (dx, dy) from a place, opacity as its alpha, for that strength.
  void Sample(const Place& place, int dx, int dy, int step, std::uint16_t* texel) const;

 private:
  struct Tone {
    float strength;
    Source center;
    int exemplar;
  };
  void Lift(std::span<const BarePaper> papers);
  bool ShowsBareGround() const;
  float ToneAt(int exemplar, int x, int y, int reach, float paper) const;
  void FindTones(std::span<const BarePaper> papers);
  void FindPlaces();
  void RankDarkPaint();

  std::shared_ptr<const PreparedExemplar> exemplar_;
  DarkPlace dark_;
  int level_ = 0;
  std::vector<Picture> pictures_;  // lifted, by exemplar; empty: the exemplar's own with ranks_
  std::vector<Tone> tones_;        // by rising strength
  std::vector<Place> places_;      // by step and square
  std::vector<float> ranks_;       // 0 … 1 by pixel around the dark place
  int ranks_width_ = 0;
};

}  // namespace scumble
