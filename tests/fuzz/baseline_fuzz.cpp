// Baselines of a cross-check, in JSON. A baseline survives writing and reading again.
#include "measure/crosscheck_baseline.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

void FuzzBaseline(Bytes input) {
  const auto baseline = ParseBaseline(AsText(input), "b.json");
  CheckRefusal(baseline, 1000 + 4 * input.size());  // names stand in it as they are
  if (!baseline) return;
  const auto again = ParseBaseline(BaselineToJson(*baseline), "b.json");
  SCUMBLE_CHECK(again.ok() && again->blender == baseline->blender);
  SCUMBLE_CHECK_EQ(again->scenes.size(), baseline->scenes.size());
  for (const auto& [name, scene] : baseline->scenes) {
    SCUMBLE_CHECK(BaselineMismatch(*again, name, scene.setup).empty());
    SCUMBLE_CHECK(again->scenes.at(name).limits == scene.limits);
  }
}

}  // namespace
SCUMBLE_FUZZ_TARGET(baseline, FuzzBaseline)
}  // namespace scumble::fuzz
