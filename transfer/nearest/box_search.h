// The search of transfer/nearest/box_tree.h.
#pragma once

#include <cstdint>

#include "transfer/nearest/box_tree.h"

namespace scumble::internal {

// The place of the point that BoxTree::Nearest asks for; `first` is a place to begin with.
std::uint32_t SearchBoxes(const BoxTree& tree, const float* query, std::uint32_t first);

// The same of BoxTree::ApproximateNearest.
std::uint32_t SearchBoxesRoughly(const BoxTree& tree, const float* query, double error);

}  // namespace scumble::internal
