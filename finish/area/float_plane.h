// Planes of floats that filters work on.
#pragma once

#include <vector>

#include "core/image/plane_allocator.h"

namespace scumble::internal {

// Not cleared when it is made or grows: a plane of a large picture takes longer to clear than to filter.
using FloatPlane = std::vector<float, PlaneAllocator<float>>;

}  // namespace scumble::internal
