// Keys that are put into the text of a style.toml.
#include "core/style/style_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace scumble {
namespace {

std::string Edited(const std::string& text, const std::vector<std::string>& settings) {
  const auto edited = WithSettings(text, settings, "style.toml");
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

TEST(StyleEdit, RefusesWhatItCannotChange) {
  const auto inline_table = WithSettings("transfer = { levels = 5 }\n", {"transfer.threshold=0.2"}, "my/style.toml");
  ASSERT_FALSE(inline_table.ok());
  EXPECT_THAT(inline_table.error().message, testing::AllOf(testing::HasSubstr("my/style.toml"),
                                                           testing::HasSubstr("set transfer.threshold=0.2 by hand")));
  EXPECT_FALSE(WithSettings("[transfer\n", {"transfer.threshold=0.2"}, "style.toml").ok());
}

}  // namespace
}  // namespace scumble
