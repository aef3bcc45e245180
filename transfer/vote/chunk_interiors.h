// Where a vote need not be held, because all would vote for the same.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/filter/region.h"
#include "transfer/field/source_field.h"

namespace scumble::internal {

// One value for each pixel of the region, in rows: 1 where the whole window of `radius` around it, as far as it is in the
// picture, is active and of one chunk: one exemplar, and sources that differ as the pixels do. Some windows that are whole
// chunks but for inactive pixels are not told. O(pixels of the region grown by the radius), whatever the radius.
std::vector<std::uint8_t> ChunkInteriors(const SourceField& field, std::span<const std::uint8_t> active, int radius,
                                         const Region& region);

}  // namespace scumble::internal
