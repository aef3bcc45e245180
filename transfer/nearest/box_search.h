// The search of transfer/nearest/box_tree.h.
#pragma once

#include <cstdint>

#include "transfer/nearest/box_tree.h"

namespace scumble::internal {

// The place of BoxTree::Nearest's point; the search begins at place `first`.
std::uint32_t SearchBoxes(const BoxTree& tree, const float* query, std::uint32_t first);

// The search of BoxTree::ApproximateNearest.
std::uint32_t SearchBoxesRoughly(const BoxTree& tree, const float* query, double error);

}  // namespace scumble::internal
