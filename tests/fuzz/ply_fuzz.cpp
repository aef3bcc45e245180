// Scenes in PLY, text or binary.
#include "tests/fuzz/scene_checks.h"

namespace scumble::fuzz {
SCUMBLE_FUZZ_TARGET(ply, LoadPly)
}  // namespace scumble::fuzz
