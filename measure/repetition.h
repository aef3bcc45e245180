// The repetition of a mosaic, and the visibility of its seams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/guides.h"
#include "measure/coherence.h"
#include "scumble/picture.h"

namespace scumble {

// The mean number of covered pixels for each source pixel that occurs: covered / distinct sources. 0 where nothing is
// covered.
double SourceRepetition(const SourcePlanes& planes);

struct SeamStrength {
  double along_borders = 0.0;  // mean difference of Oklab colours between neighbours in different chunks
  double inside = 0.0;         // the same inside chunks: without blending, the exemplar's own
  double excess = 0.0;         // along_borders / inside - 1; 0: seams do not stand out from the paint
  std::size_t border_pairs = 0;
  std::size_t inside_pairs = 0;
};

// Right and lower neighbours on one smooth surface: both covered, of one object, and with normals less than 15 degrees
// apart. Where the surface itself ends or turns, colours change for that reason, and no seam is to blame. A chunk
// shares one offset and exemplar. `guides` are of the picture's size; without ids all is one object. O(pixels).
SeamStrength MeasureSeams(const Picture& picture, const SourcePlanes& planes, const GuideSet& guides);

}  // namespace scumble
