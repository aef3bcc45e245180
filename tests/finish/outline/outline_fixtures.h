// What tests of outlines share.
#pragma once

#include <numeric>
#include <vector>

#include "tests/finish/finish_fixtures.h"

namespace scumble {

// Ink alone: the share of each pixel that strokes cover.
inline std::vector<double> InkOf(const OutlinePass& pass, const GuideSet& guides, int threads = 0,
                                 FinishMeasures measures = {}) {
  const Picture drawn = Finished(StepOf(pass), &guides, Picture(guides.width(), guides.height()), measures, threads);
  std::vector<double> ink;
  for (std::size_t i = 3; i < drawn.rgba.size(); i += 4) ink.push_back(drawn.rgba[i] / 65535.0);
  return ink;
}

inline double Sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace scumble
