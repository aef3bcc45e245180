// Targets of requests and the token of a run.
#include "apps/studio/http/target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "apps/studio/http/token.h"

namespace scumble {
namespace {

TEST(StudioTarget, IsDecoded) {
  const auto target = ParseTarget("/api/pick?x=3&y=4&name=a%20b+c%C3%A9&empty&last=");
  ASSERT_TRUE(target.ok());
  EXPECT_EQ(target->path, "/api/pick");
  EXPECT_EQ(target->query.size(), 5u);
  EXPECT_EQ(target->query.at("name"), "a b c\u00e9");
  EXPECT_EQ(target->query.at("empty"), "");
  EXPECT_EQ(ParseTarget("/a%62c")->path, "/abc");
}

TEST(StudioTarget, OthersAreRefused) {
  for (const std::string text :
       {"", "*", "api", "http://127.0.0.1/", "/../etc/passwd", "/web/..%2f..%2fetc", "/web/%2e%2e/x", "//evil", "/a%",
        "/a%2", "/a%zz", "/a%00b", "/a%0ab", "/%ff", "/a?x=%00", "/a?x=1&x=2", "/a?x=%c3", "/a?%"}) {
    EXPECT_FALSE(ParseTarget(text).ok()) << text;
  }
}

TEST(StudioToken, IsLongAndNew) {
  std::set<std::string> tokens;
  for (int i = 0; i < 50; ++i) tokens.insert(MakeToken());
  EXPECT_EQ(tokens.size(), 50u);
  EXPECT_THAT(*tokens.begin(), testing::MatchesRegex("[0-9a-f]{64}"));
  EXPECT_TRUE(EqualInConstantTime("abc", "abc"));
  EXPECT_FALSE(EqualInConstantTime("abc", "abd"));
  EXPECT_FALSE(EqualInConstantTime("abc", "ab"));
}

}  // namespace
}  // namespace scumble
