// Takes the sphere of an exemplar's picture as it lies, where it does not fill the picture.
#pragma once

#include <string>

#include "core/image/status.h"
#include "core/image/style.h"

namespace scumble {

// For an exemplar without guides, which would say where the sphere is. If the picture shows one sphere that clearly
// does not fill it (FindSphere), the picture is cut to the square around that sphere, and `cut` says where. Parts of
// the square beyond the file repeat its edge. A picture that fills its square stays as it is, byte for byte, and so
// does one of which the style says so (`fills`).
//
// kInput for a whole template, in its place (LooksLikeTemplate) or elsewhere (FindTemplate); for an ellipse; for
// several spheres. kInput also for paint that clearly does not fill the picture and shows no clear sphere. The message
// says why, as far as it can be told, and what to do.
Status PlaceSphere(Exemplar& exemplar);

// What `cut` says, without the file's name.
std::string DescribeCut(const SphereCut& cut);

}  // namespace scumble
