// Half floats, as EXR files store them.
#pragma once

#include <Imath/half.h>

namespace scumble::internal {

// The nearest half float. Values beyond the range become the largest half float, because infinity is no radiance.
Imath::half ToHalf(float value);

}  // namespace scumble::internal
