// Scenes in PLY, text or binary.
#include "tests/fuzz/scene_checks.h"

namespace scumble::fuzz {
namespace {

void Run(Bytes input) { LoadFrom("scene.ply", input); }

}  // namespace
SCUMBLE_FUZZ_TARGET(ply, Run)
}  // namespace scumble::fuzz
