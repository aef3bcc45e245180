// Checks that the targets of guides share.
#pragma once

#include "core/io/guide_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {

inline GuideReadOptions WhateverThereIs() {
  GuideReadOptions options;
  options.required = {Layer::kCoverage, Layer::kNormal};
  for (const LayerInfo& info : AllLayers()) options.optional.Add(info.layer);
  return options;
}

// The reader's contract: returned guides are valid, and as large as the header declares.
inline void CheckGuides(const GuideSet& guides, const GuideFileInfo& info) {
  SCUMBLE_CHECK_EQ(guides.width(), info.width);
  SCUMBLE_CHECK_EQ(guides.height(), info.height);
  SCUMBLE_CHECK(guides.Validate("guides.exr").ok());
}

}  // namespace scumble::fuzz
