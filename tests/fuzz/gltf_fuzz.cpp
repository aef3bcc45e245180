// Scenes in glTF, binary or text: at rest, and where they move at three times and from one to the next.
#include <utility>
#include <vector>

#include "tests/fuzz/scene_checks.h"

namespace scumble::fuzz {
namespace {

void FuzzGltf(Bytes input) {
  LoadFrom("scene.glb", input);
  const Expected<AnimatedScene> animated = AnimatedScene::Load(Folder() / "scene.glb", {"*"});
  CheckRefusal(animated);
  if (!animated || !animated->moves()) return;
  std::vector<Scene> poses;
  for (const double seconds : {-1.0, 0.37, animated->duration_seconds()}) {
    Expected<Scene> posed = animated->SceneAt(seconds);
    CheckRefusal(posed);
    if (!posed) continue;
    CheckScene(*posed);
    poses.push_back(*std::move(posed));
  }
  if (poses.size() > 1) DrawMotion(std::move(poses.end()[-2]), std::move(poses.back()));
}

}  // namespace
SCUMBLE_FUZZ_TARGET(gltf, FuzzGltf)
}  // namespace scumble::fuzz
