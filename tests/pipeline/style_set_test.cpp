// What the open styles read, and how to do without.
#include "pipeline/style_set.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/style/style_keys.h"

namespace scumble {
namespace {

// A style whose votes stop at edges, and nothing else.
StyleSet StyleWith(const std::function<void(TransferSettings&)>& change) {
  Style style;
  style.transfer.edge_aware = true, style.transfer.blend_radius = 2, style.transfer.variety = 0.0;
  style.transfer.edge = EdgeMode::kExact, style.transfer.coherent = false;
  change(style.transfer);
  StyleSet set;
  set.styles.push_back(style);
  return set;
}

TEST(SetsWithout, NamesTheFewestThatHelp) {
  const LayerSet depth{Layer::kDepth}, object{Layer::kObject};
  const StyleSet plain = StyleWith([](TransferSettings&) {});
  const StyleSet varied = StyleWith([](TransferSettings& settings) { settings.variety = 20.0; });
  const StyleSet painted = StyleWith([](TransferSettings& settings) { settings.edge = EdgeMode::kExemplar; });
  const StyleSet coherent = StyleWith([](TransferSettings& settings) { settings.coherent = true; });
  EXPECT_EQ(SetsWithout(plain, object), "--set transfer.edge_aware=false");
  EXPECT_EQ(SetsWithout(varied, depth), "--set transfer.edge_aware=false");
  EXPECT_EQ(SetsWithout(varied, object), "--set transfer.edge_aware=false --set transfer.variety=0");
  EXPECT_EQ(SetsWithout(painted, depth), "--set transfer.edge_aware=false --set transfer.edge=exact");
  EXPECT_EQ(SetsWithout(coherent, {Layer::kPref}), "--set transfer.coherent=false");
  EXPECT_EQ(SetsWithout(plain, {Layer::kDepth, Layer::kNormal}), "") << "all styles read normals";
  StyleSet two = plain;
  two.styles.push_back(varied.first());
  EXPECT_EQ(SetsWithout(two, object), "--set transfer.edge_aware=false --set transfer.variety=0");
}

TEST(SetsWithout, ItsOptionsAreKeysOfStyles) {
  for (const char* const key : {"transfer.edge_aware", "transfer.variety", "transfer.coherent", "transfer.edge"})
    EXPECT_TRUE(FindStyleKey(key)) << key;
}

}  // namespace
}  // namespace scumble
