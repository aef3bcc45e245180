// Resizing of exemplars, papers and pictures.
#pragma once

#include "scumble/picture.h"

namespace scumble {

// Lanczos-3 (Duchon 1979), separable, edges repeated, widened when shrinking. Colours are averaged in the sRGB encoding
// they were painted in, weighted by alpha. Weights are 14-bit integers, so every machine gives the same bytes.
// The same size returns the same picture. On the threads of the caller's arena (oneTBB).
Picture Resample(const Picture& source, int width, int height);

}  // namespace scumble
