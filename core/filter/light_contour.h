// Where light ends at a hard contour, as a lamp's shadow does, or crosses a border between two tones: which share of a
// pixel lies on the other side.
//
// Light is known at pixel centres alone, so a contour is a staircase of steps between pixels. A straight contour has
// steps of one length along rows or columns, and runs through the middle of each riser (Reshetov, "Morphological
// antialiasing", 2009). The share is the area of the pixel beyond that line. A step is traced for at most kReach pixels
// to each side and ends at another object, where the line goes on as it is. Where both sides of a corner are longer
// than a pixel, the corner is one of the shadow, and only its outermost half pixel is cut off.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/guides.h"

namespace scumble::internal {

// Neighbours whose light differs by more of the brightest are on two sides of a contour: on smooth forms light does not
// change so fast. Light that has the noise of samples changes by chance, too.
inline constexpr float kHardStep = 0.1f, kHardStepInNoise = 0.25f;

// Light whose contours count, by pixel.
struct HardLight {
  std::span<const float> tone = {};
  float least = 0.0f;  // contours are where neighbours of one object differ by more
  int bands = 0;       // above 1: and lie in different bands, of which per_tone times the tone is the number
  float per_tone = 1.0f;
  // Instead of bands, rising: if any, contours are where neighbours also lie on two sides of one of them.
  std::span<const float> borders = {};
};

class LightContour {
 public:
  static constexpr int kReach = 16;
  // The share of a pixel that lies beyond a contour, and the neighbour whose light it has. Less than 1.
  struct Beyond {
    float share = 0.0f;
    std::size_t pixel = 0;
  };

  // Keeps references to the light, its borders and the guides. Without objects all that is covered is one.
  LightContour(const HardLight& light, const GuideSet& guides);

  // Sides of a pixel.
  static constexpr std::uint32_t kLeft = 1, kRight = 2, kAbove = 4, kBelow = 8, kAllSides = 15;

  // What lies beyond the contours on some sides of a pixel: on the left and right, or above and below, where that takes
  // more. Near 45 degrees sides of both kinds see one line. Shares are for mixing one after the other: each is of the
  // pixel as the ones before have left it. 0 where there is no contour.
  std::array<Beyond, 2> BeyondOf(int x, int y, std::uint32_t sides = kAllSides) const;

  // Calls visit(x, sides) for the pixels of a row that may have a contour beside them, on those sides. Fast where there
  // is none.
  template <class Visit>
  void ForEachInRow(int y, const Visit& visit) const {
    ForEachInRow(y, 0, width_, visit);
  }
  // For those of columns x0 … x1 - 1.
  template <class Visit>
  void ForEachInRow(int y, int x0, int x1, const Visit& visit) const {
    std::array<std::uint32_t, kSome> marks;
    for (int x = x0; x < x1; x += kSome) {
      const int end = x + kSome < x1 ? x + kSome : x1;
      if (!MayHave(x, end, y) || !Mark(x, end, y, marks.data())) continue;
      for (int u = x; u < end; ++u) {
        if (marks[std::size_t(u - x)]) visit(u, marks[std::size_t(u - x)]);
      }
    }
  }

 private:
  static constexpr int kSome = 64;

  bool MayHave(int x0, int x1, int y) const;
  bool Mark(int x0, int x1, int y, std::uint32_t* marks) const;
  float ShareBeyond(int x, int y, int side_x, int side_y) const;

  HardLight light_;
  std::span<const float> coverage_, object_;
  int width_, height_;
};

}  // namespace scumble::internal
