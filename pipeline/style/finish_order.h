// What is likely wrong with the order of finishing effects.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "pipeline/style_set.h"

namespace scumble {

// One sentence for each doubt: lines that a later pass blurs or steps, passes that a later one covers. Passes without
// strength are left out; so are those whose pixels are limited, since they may not meet.
std::vector<std::string> OrderDoubts(std::span<const FinishPass> passes);

// Those of each style's chain with the run's after it, each once; and outlines on painted edges, which they do not
// follow.
std::vector<std::string> OrderDoubts(const StyleSet& styles);

}  // namespace scumble
