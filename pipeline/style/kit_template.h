// The kit's sphere as it is before anybody paints on it.
#pragma once

#include <optional>

#include "core/image/status.h"
#include "core/image/style.h"
#include "scumble/picture.h"

namespace scumble {

struct BareTemplates {
  Picture drawn;    // template.png's
  Picture printed;  // template.pdf's, as a scan without fault shows it
};

// What the exemplar was painted over, the size of its picture: drawn in the light that its guides show; without guides
// in the key light. Nothing for painted scenes, for guides without luminance, and for pictures below 16 pixels.
Expected<std::optional<BareTemplates>> FindBareTemplates(const Exemplar& exemplar, int threads);

}  // namespace scumble
