// Scenes in OBJ. `mtllib scene.obj` makes a file its own list of materials, so that one input has both.
#include "tests/fuzz/scene_checks.h"

namespace scumble::fuzz {
SCUMBLE_FUZZ_TARGET(obj, LoadObj)
}  // namespace scumble::fuzz
