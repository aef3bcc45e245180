// What others take for the work of `smooth` and `edges`, on the same number of threads: OpenCV's filters where it is
// there, and a plain loop.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace scumble::bench {

struct Contender {
  enum class Filter { kBilateral, kGuided, kGuidedByBoxes, kGaussians, kKuwahara };

  Filter filter;  // whose work it does
  std::string name;
  std::function<void()> run;
};

// Of a picture of that size. Those that OpenCV has on this system; ximgproc's guided filter is in its contrib part.
std::vector<Contender> OpenCvContenders(int width, int height, const std::vector<float>& rgb);

// An anisotropic Kuwahara filter of radius 6 without borders, pixel by pixel and tap by tap, in floats, without the
// structure tensor: every ellipse is a circle. Of one row in so many.
Contender PlainKuwahara(int width, int height, const std::vector<float>& rgb, int every = 1);

}  // namespace scumble::bench
