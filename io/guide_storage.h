// How guides may be stored: what the halves of guide_file.h share.
#pragma once

#include <Imath/half.h>

#include <string>

namespace scumble::internal {

// Whether it is the name of one of OpenEXR's lossless compressions.
bool IsLossless(const std::string& compression);

// The nearest half float. Brighter values than half floats reach become the brightest one: infinity is no radiance.
Imath::half ToHalf(float value);

}  // namespace scumble::internal
