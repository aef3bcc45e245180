// --show: instead of the result, the picture that explains it.
#pragma once

#include <string>
#include <vector>

#include "core/image/guides.h"
#include "measure/explain.h"
#include "scumble/picture.h"
#include "transfer/transfer.h"

namespace scumble {

// A finished transfer, as --show needs it.
struct ShownTransfer {
  const std::vector<PreparedStyle>& styles;
  const StyleMap& map;  // empty: one style everywhere
  const GuideSet& guides;
  const SourceField& field;
  double exposure = 0.0;
  const Picture& result;
};

Picture Show(Explanation what, const ShownTransfer& shown);

}  // namespace scumble
