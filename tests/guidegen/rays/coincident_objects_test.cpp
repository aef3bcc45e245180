// Objects at exactly the same place: which of them are left out.
#include "guidegen/rays/coincident_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

struct Stand {
  Mesh mesh = QuadMesh();
  Material solid, single, holes, lamp;

  Stand() {
    single.double_sided = false;
    holes.alpha_mode = AlphaMode::kMask;
    lamp.emission = glm::vec3(1.0f);
  }
  PlacedObject Of(const Material& material) const { return Place(&mesh, &material, {}, glm::dmat4(1.0)); }
};

// Of two at one place the first is left out if the second hides all of it: never behind holes, nor behind a culled
// object where it is not culled. An emissive object is a light besides.
TEST(CoincidentObjects, AreCoveredByWhatHidesThemWhole) {
  const Stand stand;
  const auto first_is_covered = [&](const Material& first, const Material& second) {
    const std::vector<bool> covered = FindHiddenCoincident(std::vector{stand.Of(first), stand.Of(second)});
    EXPECT_FALSE(covered[1]);
    return bool(covered[0]);
  };
  for (const Material& under : {stand.solid, stand.single, stand.holes}) {
    EXPECT_TRUE(first_is_covered(under, stand.solid));
    EXPECT_FALSE(first_is_covered(under, stand.holes));
    EXPECT_FALSE(first_is_covered(under, stand.lamp));
  }
  EXPECT_TRUE(first_is_covered(stand.single, stand.single));
  EXPECT_FALSE(first_is_covered(stand.solid, stand.single));
  EXPECT_FALSE(first_is_covered(stand.lamp, stand.solid));
}

// A tree of masked leaves that somebody placed half a million times: nothing is covered, and each is looked at once,
// in less than a second. Were each compared with each, 1.25e11 pairs would take longer than a test may.
TEST(CoincidentObjects, WithHolesAreNotComparedWithEachOther) {
  const Stand stand;
  const std::vector<PlacedObject> leaves(500'000, stand.Of(stand.holes));
  const std::vector<bool> covered = FindHiddenCoincident(leaves);
  EXPECT_EQ(std::count(covered.begin(), covered.end(), true), 0);
  std::vector<PlacedObject> hidden = leaves;
  hidden.push_back(stand.Of(stand.solid));
  const std::vector<bool> all = FindHiddenCoincident(hidden);
  EXPECT_EQ(std::count(all.begin(), all.end(), true), 500'000);
}

// Only of those that are seen, and only where another is.
TEST(CoincidentObjects, AreTiedWhereNoneIsHidden) {
  const Stand stand;
  PlacedObject aside = stand.Of(stand.solid);
  aside.view_from_object[3][0] = 1.0;
  const auto tied = [](const std::vector<PlacedObject>& objects) {
    return FindTied(objects, FindHiddenCoincident(objects));
  };
  EXPECT_EQ(tied({stand.Of(stand.solid), aside, stand.Of(stand.single)}), (std::vector<bool>{true, false, true}));
  EXPECT_EQ(tied({stand.Of(stand.lamp), stand.Of(stand.solid)}), (std::vector<bool>{true, true}));
  EXPECT_EQ(tied({stand.Of(stand.single), stand.Of(stand.solid), aside}), (std::vector<bool>{false, false, false}));
}

}  // namespace
}  // namespace scumble::testing
