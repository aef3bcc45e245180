// Half floats, as EXR files store them.
#pragma once

#include <Imath/half.h>

namespace scumble::internal {

// The nearest half float. Brighter values than half floats reach become the brightest one: infinity is no radiance.
Imath::half ToHalf(float value);

}  // namespace scumble::internal
