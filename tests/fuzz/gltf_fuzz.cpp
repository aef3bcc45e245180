// Scenes in glTF, binary or text: at rest, and where they move at three times.
#include "tests/fuzz/scene_checks.h"

namespace scumble::fuzz {
namespace {

void Run(Bytes input) {
  LoadFrom("scene.glb", input, true);
  const Expected<AnimatedScene> animated = AnimatedScene::Load(Folder() / "scene.glb", {"*"});
  CheckRefusal(animated);
  if (!animated || !animated->moves()) return;
  for (const double seconds : {-1.0, 0.37, animated->duration_seconds()}) {
    const Expected<Scene> posed = animated->SceneAt(seconds);
    CheckRefusal(posed);
    if (posed) CheckScene(*posed);
  }
}

}  // namespace
SCUMBLE_FUZZ_TARGET(gltf, Run)
}  // namespace scumble::fuzz
