// Scenes in OBJ. `mtllib scene.obj` makes a file its own list of materials, so that one input has both.
#include "tests/fuzz/scene_checks.h"

namespace scumble::fuzz {
namespace {

void Run(Bytes input) { LoadFrom("scene.obj", input); }

}  // namespace
SCUMBLE_FUZZ_TARGET(obj, Run)
}  // namespace scumble::fuzz
