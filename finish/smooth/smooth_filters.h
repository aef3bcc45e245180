// The filters of `smooth`. Each changes planes in place, by several threads; the same bytes on any number of them and
// any instruction set. Finite numbers only; any size from 1 × 1 on.
#pragma once

#include <cstddef>

#include "finish/area/float_plane.h"

namespace scumble::internal {

// Planes with `pad` places around them and room for a vector beyond each row, so that loops need not look where they
// are. Place (x, y) of the picture is at At(x, y).
struct SmoothPlanes {
  SmoothPlanes(std::size_t columns, std::size_t rows, std::size_t around);
  std::size_t At(std::size_t x, std::size_t y) const { return (y + pad) * stride + pad + x; }
  std::size_t size() const { return key.size(); }

  // Makes the next planes, unless they are there: of the same layout, 0 around.
  void MakeNext();
  void TakeNext();  // swaps both

  std::size_t width, height, pad, stride;
  FloatPlane lightness, a, b;  // Oklab; 0 around
  FloatPlane next_lightness, next_a, next_b;
  // Places are mixed where their keys are equal. NaN, also around, is equal to nothing: such a place is not looked at.
  FloatPlane key;
};

// The places around that each filter needs. `sigma` is the pass's radius in pixels of the picture.
std::size_t BilateralPad(double sigma, std::size_t longer_side);
std::size_t KuwaharaPad(double sigma, std::size_t longer_side);
std::size_t WaveletsPad(double sigma, std::size_t longer_side);

// A bilateral filter (Tomasi, Manduchi 1998), by rows and then by columns (Pham, van Vliet 2005). The weight of a
// colour at distance d is (1 - d² / c²)², and 0 from c on, Tukey's biweight; of a place it is a Gaussian up to two
// sigma. O(pixels · sigma).
void BilateralFilter(double sigma, double range, SmoothPlanes& planes);

// The anisotropic Kuwahara filter (Kyprianidis, Kang, Döllner 2009) with polynomial weights (Kyprianidis, Semmo, Kang,
// Döllner 2010). It has eight sectors of an ellipse along the edge, of axes sigma · (1 + A) and sigma / (1 + A), and
// the even ones count. A is the anisotropy of the structure tensor. O(pixels · sigma²).
void KuwaharaFilter(double sigma, double tensor_sigma, SmoothPlanes& planes);

// The guided filter (He, Sun, Tang 2010) with the picture as its own guide. All three channels have one gain, v / (v +
// range² / 4), v being the variance of colours in the window. The window of a pixel is its column as far as keys are
// equal and `sigma` reaches, and of each pixel there its row likewise. Where nothing is in the way it is a square.
// O(pixels), whatever sigma is.
void GuidedFilter(double sigma, double range, SmoothPlanes& planes);

// What the wavelets stop at besides colours and keys, laid out as the planes; empty: nothing.
struct WaveletStops {
  FloatPlane normal_x, normal_y, normal_z, depth;
};

// Edge-avoiding à-trous wavelets without their details (Dammertz, Sewtz, Hanika, Lensch 2010): 5 × 5 taps at distances
// of 1, 2, 4 … pixels; the range is halved each time. A B3 spline in place, Tukey's biweight of colours, of normals
// (half at a distance of 1/2) and of depths (half at 1/100 of the depth for each pixel). `range` holds at one pixel of
// the reference height, and `scale` such pixels are one of the picture's. So levels of equal length have equal ranges
// in pictures of any size. O(pixels · log sigma).
void WaveletsFilter(double sigma, double range, double scale, const WaveletStops& stops, SmoothPlanes& planes);

// 1 / c² of Tukey's biweight (1 - d² / c²)² that is a half at `half`.
float BiweightPerSquare(double half);

}  // namespace scumble::internal
