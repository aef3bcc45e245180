// The guide set behind the library's GuideLayers.
#pragma once

#include <memory>

#include "core/image/guides.h"
#include "scumble/guides.h"

namespace scumble {

struct GuideLayers::State {
  std::shared_ptr<const GuideSet> guides;
};

}  // namespace scumble
