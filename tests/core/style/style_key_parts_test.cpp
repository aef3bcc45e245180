// Keys of many parts, on which toml++ would use up the stack.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/io/atomic_file.h"
#include "core/style/style_file.h"
#include "core/style/toml_values.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

using internal::CheckTomlText;
using internal::kMostKeyParts;

std::string Key(std::size_t parts, const std::string& part = "a", const std::string& dot = ".") {
  std::string key = part;
  for (std::size_t i = 1; i < parts; ++i) key += dot + part;
  return key;
}

void ExpectTooMany(const std::string& text, int line) {
  ExpectRefusal(CheckTomlText(text, "s.toml"), {"s.toml:" + std::to_string(line) + ":", "more than 16 parts"});
}

TEST(KeyParts, AreCountedInEveryKindOfKey) {
  for (const std::string part : {"a", "\"a.b # \\\" =\"", "'a.b # ='"}) {
    for (const std::string dot : {".", " . ", "\t.\t"}) {
      const std::string most = Key(kMostKeyParts, part, dot), more = Key(kMostKeyParts + 1, part, dot);
      EXPECT_TRUE(CheckTomlText(
          most + " = 1\n[" + most + "]\n[[ " + most + " ]]\nb = {" + most + " = 1, " + most + " = 2}\n", ""))
          << most;
      ExpectTooMany("\n" + more + " = 1", 2);
      ExpectTooMany("b = 1\r\n[" + more + "]", 2);
      ExpectTooMany("[[" + more + "]]", 1);
      ExpectTooMany("b = { c = 1, " + more + " = 1}", 1);
      ExpectTooMany("b = [\n[{" + more, 2);
    }
  }
}

// A text that is taken for a string or a comment longer than it is would hide what stands behind it.
TEST(KeyParts, NothingHidesAKeyAndNoTextIsTakenForOne) {
  const std::string dots(100, '.'), more = "\n" + Key(kMostKeyParts + 1) + " = 1";
  const std::string texts[] = {"# don't \"\"\" '''" + dots,
                               "a = \"" + dots + "\"",
                               "a = '" + dots + "\\'",
                               "a = '''\n" + dots + "'' \\''''",
                               "a = \"\"\"\n" + dots + "\"\" \\\"\"\"\"\"\"",
                               "a = \"\"",
                               "a = \"\\\\\"",
                               "a = \"\\\"" + dots + "\"",
                               "a = \"\"\"\"\"\"",
                               "a = \"\"\"x\"\"\"\"\" # " + dots,
                               "a = ''''''",
                               "a = [1.5, 2.5, '" + dots + "']",
                               "a = 1.5 # " + dots,
                               "a = 1979-05-27T07:32:00.999"};
  for (const std::string& text : texts) {
    EXPECT_TRUE(CheckTomlText(text, "")) << text;
    const int lines = 2 + int(std::count(text.begin(), text.end(), '\n'));
    ExpectTooMany(text + more, lines);
  }
  for (const std::string text : {"", "#", "="}) EXPECT_TRUE(CheckTomlText(text, "")) << text;
  for (const std::string text : {"\"", "'", "\"\"\"", "'''", "\"\\", "\"\"\"\\", "'''''"}) {
    ExpectRefusal(CheckTomlText("\n" + text, "s.toml"), {"s.toml:2:", "not closed"});
  }
  EXPECT_TRUE(CheckTomlText(std::string(1, '\0'), ""));
}

// 61 KB and 100 KB: without the limit the process ends by a signal.
TEST(KeyParts, StylesAndOverridesOfVeryManyAreRefused) {
  const TemporaryFolder folder;
  for (const std::string& text : {Key(30781) + " = 1\n", "[" + Key(50000) + "]\n", "a = {" + Key(50000) + " = 1}\n"}) {
    ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", text));
    ExpectRefusal(LoadStyle(folder.path()), {"style.toml:1:", "more than 16 parts"});
  }
  // As deep as the two limits allow: refused by the parser or by its keys, in words.
  std::string deep = "b";
  for (int i = 0; i < 300; ++i) deep += " = {" + Key(kMostKeyParts);
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", deep));
  EXPECT_FALSE(LoadStyle(folder.path()));
  std::string most = Key(kMostKeyParts) + " = ";
  for (int i = 0; i < 200; ++i) most += "{" + Key(kMostKeyParts) + " = ";
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", most + "1" + std::string(200, '}')));
  ExpectRefusal(LoadStyle(folder.path()), {"unknown key"});
}

}  // namespace
}  // namespace scumble
