// Our guides against a reference renderer's of the same view: figures, limits, a verdict.
#pragma once

#include <string>
#include <vector>

#include "image/guides.h"
#include "image/picture.h"
#include "image/status.h"

namespace scumble {

// One figure and the limit it must keep.
struct CrosscheckFigure {
  std::string layer;  // "normal"
  std::string name;   // "99% within"
  std::string unit;   // "degrees"
  double value = 0;
  double limit = 0;
  bool kept() const { return value <= limit; }  // NaN keeps no limit
};

// A layer side by side, for people.
struct CrosscheckPictures {
  std::string layer;
  Picture reference;
  Picture ours;
  Picture difference;       // black to yellow; full at the figure's limit times `full_scale`
  std::string full_scale;   // what yellow means, in words
};

struct CrosscheckReport {
  std::string scene;
  int width = 0;
  int height = 0;
  std::size_t compared = 0;  // pixels inside the eroded masks
  std::vector<CrosscheckFigure> figures;
  std::vector<CrosscheckPictures> pictures;
  std::vector<std::string> skipped;  // layers that the reference lacks: they fail the verdict
  bool passed() const;
};

struct CrosscheckOptions {
  int erode_pixels = 2;          // compared are pixels whose neighbourhood shows one and the same object in both
  bool make_pictures = true;
};

// Compares coverage over the whole picture, and normal, depth, position, object ids and albedo inside the object masks
// eroded by `erode_pixels`. Limits: normals 99% within 0.01° and 99.9% within 0.1°; depth and position 99.9% within 1e-5
// relative; coverage equal but for 0.02% of the pixels; ids equal; albedo 0.002 in the mean. Both sets must hold A,
// normal, depth and object; sizes must agree.
Expected<CrosscheckReport> Crosscheck(const std::string& scene, const GuideSet& reference, const GuideSet& ours,
                                      const CrosscheckOptions& options = {});

// A table for a terminal, the verdict last.
std::string CrosscheckToText(const CrosscheckReport& report);
std::string CrosscheckToJson(const std::vector<CrosscheckReport>& reports);

}  // namespace scumble
