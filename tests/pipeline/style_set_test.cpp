// What the open styles read, and how to do without.
#include "pipeline/style_set.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>
#include <string_view>

#include "core/style/finish_keys.h"
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

// Values travel: the text, which is parsed once, is for messages alone.
TEST(StyleSet, NoTextOfAnOverrideIsReadAgain) {
  RunContext context;
  context.data_roots = {SCUMBLE_SOURCE_DIR};
  StyleRequest request;
  request.style = "oil", request.assigned = {"a=ink", "b=pastel"}, request.finishes = {"comic"};
  request.sets = {
      MakeOverride("transfer.blend_radius", std::int64_t(3)),
      MakeOverride("finish.ink.width", 4.0),
      {"", "finish.ink.ink", StyleOverride::Frames{{0, std::string("#000000")}, {2, std::string("#ffffff")}}, ""},
      MakeOverride("transfer.scale", 0.5)};
  for (StyleOverride& set : request.sets) set.text = "= no text [";
  request.sets.back().style = "ink";
  auto set = OpenStyles(request, context);
  ASSERT_TRUE(set) << set.error().message;
  ASSERT_EQ(set->styles.size(), 3u);
  for (const Style& style : set->styles) EXPECT_EQ(style.transfer.blend_radius, 3) << style.name;
  EXPECT_EQ(set->styles[1].transfer.scale, 0.5);
  EXPECT_NE(set->styles[2].transfer.scale, 0.5);
  ASSERT_TRUE(SetFinishFrame(set->finish, 1));
  bool has_ink = false;
  for (const FinishPass& pass : set->finish.passes) {
    if (pass.name != "ink") continue;
    has_ink = true;
    const auto& outline = std::get<OutlinePass>(pass.effect);
    EXPECT_EQ(outline.width, 4.0);
    EXPECT_NE(outline.ink[0] % 257, 0) << "a colour between two has more than 8 bits";
  }
  EXPECT_TRUE(has_ink);
}

bool FitsPlainly(std::string_view name, std::string_view pattern) {
  if (pattern.empty()) return name.empty();
  if (pattern[0] == '*')
    return FitsPlainly(name, pattern.substr(1)) || (!name.empty() && FitsPlainly(name.substr(1), pattern));
  return !name.empty() && name[0] == pattern[0] && FitsPlainly(name.substr(1), pattern.substr(1));
}

TEST(NamePattern, FitsAsItsPlainForm) {
  std::mt19937 random(7);
  const auto text = [&](const char* letters, std::size_t count) {
    std::string made(random() % 7, ' ');
    for (char& c : made) c = letters[random() % count];
    return made;
  };
  int fits = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string name = text("ab", 2), pattern = text("ab**", 4);
    ASSERT_EQ(NamePattern(pattern).Fits(name), FitsPlainly(name, pattern)) << name << " " << pattern;
    fits += FitsPlainly(name, pattern);
  }
  EXPECT_GT(fits, 2000);
}

}  // namespace
}  // namespace scumble
