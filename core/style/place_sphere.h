// Takes the sphere of an exemplar's picture as it lies, where it does not fill the picture.
#pragma once

#include <string>

#include "core/image/status.h"
#include "core/image/style.h"

namespace scumble {

// For an exemplar without guides, which would say where the sphere is. If the picture shows one sphere that clearly
// does not fill it (FindSphere), the picture is cut to the square around that sphere, and `cut` says where; parts of
// the square beyond the file repeat its edge. A picture that fills its square stays as it is, byte for byte. So does a
// square whose sphere is not clear: `doubt` is set. A whole template (LooksLikeTemplate) is left alone.
//
// kInput for an ellipse, for several spheres, and for a picture that is no square and shows no clear sphere.
Status PlaceSphere(Exemplar& exemplar);

// Clauses without the file's name: what `cut` and `doubt` say, and what to do about the latter.
std::string DescribeCut(const SphereCut& cut);
std::string DescribeDoubt(SphereDoubt doubt);
std::string RemedyForDoubt(SphereDoubt doubt);

}  // namespace scumble
