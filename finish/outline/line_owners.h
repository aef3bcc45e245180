// Which of two objects the line between them belongs to.
#pragma once

#include "core/image/guides.h"
#include "finish/outline/line_chains.h"

namespace scumble::internal {

// Gives each stretch of a line between two objects to one of them. Border by border the owner may change from pixel to
// pixel where they touch: paint of one, then of the other. The nearer one counts, over a stretch of the line. Where the
// objects meet, the rest of the line decides. If they meet all along, the owner of most borders decides.
void SettleOwners(const GuideSet& guides, LineChain& chain);

}  // namespace scumble::internal
