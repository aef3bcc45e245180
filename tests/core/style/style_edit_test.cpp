// Keys that are put into the text of a style.toml.
#include "core/style/style_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace scumble {
namespace {

std::string Edited(const std::string& text, const std::vector<std::string>& settings) {
  const auto edited = WithSettings(text, *ParseStyleOverrides(settings), "style.toml");
  EXPECT_TRUE(edited.ok()) << (edited.ok() ? "" : edited.error().message);
  return edited.ok() ? *edited : "";
}

TEST(StyleEdit, ChangesTheValueAndNothingElse) {
  const std::string text =
      "# äöü, mine\nname = \"Öl\"\n\n[transfer]  # how\nthreshold = 0.125   # fine\nvariety=15\n\n[paper]\ncolor = "
      "\"#fff\"\n";
  EXPECT_EQ(Edited(text, {"transfer.threshold=0.2"}),
            "# äöü, mine\nname = \"Öl\"\n\n[transfer]  # how\nthreshold = 0.2   # fine\nvariety=15\n\n[paper]\ncolor = "
            "\"#fff\"\n");
  EXPECT_EQ(
      Edited(text, {"transfer.variety=8", "transfer.hybrid=4"}),
      "# äöü, mine\nname = \"Öl\"\n\n[transfer]  # how\nhybrid = 4\nthreshold = 0.125   # fine\nvariety=8\n\n[paper]\n"
      "color = \"#fff\"\n");
}

TEST(StyleEdit, AddsTheTableWhereThereIsNone) {
  EXPECT_EQ(Edited("name = \"a\"", {"transfer.hybrid=4", "transfer.variety=0"}),
            "name = \"a\"\n\n[transfer]\nvariety = 0\nhybrid = 4\n");
  EXPECT_EQ(Edited("[transfer]", {"transfer.hybrid=4"}), "[transfer]\nhybrid = 4\n");
  EXPECT_EQ(Edited("", {"transfer.hybrid=4"}), "\n[transfer]\nhybrid = 4\n");
}

TEST(StyleEdit, OtherFormsOfTheSameTable) {
  EXPECT_EQ(Edited("transfer.threshold = 0.1\n", {"transfer.threshold=0.2"}), "transfer.threshold = 0.2\n");
  EXPECT_EQ(Edited("transfer = { threshold = 0.1, levels = 5 }\n", {"transfer.threshold=0.2"}),
            "transfer = { threshold = 0.2, levels = 5 }\n");
}

TEST(StyleEdit, TakesEveryKeyOfTheTable) {
  for (const StyleKey& key : StyleKeys()) {
    const std::string value = TomlText(key.Default());
    const std::string text = "# mine\n\n[[exemplar]]\nimage = \"lit.png\"  # äöü\n";
    const std::string added = Edited(text, {key.name + "=" + value});
    EXPECT_THAT(added, testing::HasSubstr("image = \"lit.png\"  # äöü\n")) << key.name;
    EXPECT_THAT(added, testing::HasSubstr("= " + value + "\n")) << key.name;
    EXPECT_EQ(Edited(added, {key.name + "=" + value}), added) << key.name;
  }
}

TEST(StyleEdit, TextsFlagsAndTables) {
  EXPECT_EQ(Edited("name = \"Öl\" # ä\n[transfer]\nedge_aware = true\n", {"name=\"Ölß\"", "transfer.edge_aware=false"}),
            "name = \"Ölß\" # ä\n[transfer]\nedge_aware = false\n");
  EXPECT_EQ(Edited("name = \"Öl\" # ä\n[transfer]\n", {"licence=\"CC0-1.0\""}),
            "name = \"Öl\" # ä\nlicence = \"CC0-1.0\"\n[transfer]\n");
  const std::string weights = "[transfer.guide_weights]\n\"lpe.LDE\" = 1.0  # light\n";
  EXPECT_EQ(Edited(weights, {"transfer.guide_weights.lpe.LDE=2.5"}),
            "[transfer.guide_weights]\n\"lpe.LDE\" = 2.5  # light\n");
  EXPECT_EQ(Edited(weights, {"transfer.guide_weights.normal=0.5"}),
            "[transfer.guide_weights]\nnormal = 0.5\n\"lpe.LDE\" = 1.0  # light\n");
  EXPECT_EQ(Edited(weights, {"transfer.levels=5"}), weights + "\n[transfer]\nlevels = 5\n");
  EXPECT_EQ(Edited("[transfer]\nthreshold = [[1, 0.1], [24, 0.3]]  # moves\n", {"transfer.threshold=0.2"}),
            "[transfer]\nthreshold = 0.2  # moves\n");
}

TEST(StyleEdit, ValuesAreExact) {
  EXPECT_EQ(TomlText(0.1234567890123), "0.1234567890123");
  EXPECT_EQ(TomlText(std::string("a\"b\\c\n")), "\"a\\\"b\\\\c\\u000a\"");
  EXPECT_EQ(TomlText(true), "true");
  EXPECT_EQ(TomlText(std::int64_t(7)), "7");
}

TEST(StyleEdit, RefusesWhatItCannotChange) {
  EXPECT_EQ(WithSettings("", *ParseStyleOverrides({"transfer.bogus=1"}), "s").error().kind, ErrorKind::kUsage);
  EXPECT_EQ(WithSettings("", *ParseStyleOverrides({"transfer.levels=[[1, 2]]"}), "s").error().kind, ErrorKind::kUsage);
  EXPECT_EQ(Edited("", {"name=1\n[transfer]"}), "name = \"1\\u000a[transfer]\"\n") << "a text, and no more";
  const auto inline_table =
      WithSettings("transfer = { levels = 5 }\n", *ParseStyleOverrides({"transfer.threshold=0.2"}), "my/style.toml");
  ASSERT_FALSE(inline_table.ok());
  EXPECT_THAT(inline_table.error().message, testing::AllOf(testing::HasSubstr("my/style.toml"),
                                                           testing::HasSubstr("set transfer.threshold=0.2 by hand")));
  EXPECT_FALSE(WithSettings("[transfer\n", *ParseStyleOverrides({"transfer.threshold=0.2"}), "style.toml").ok());
}

}  // namespace
}  // namespace scumble
