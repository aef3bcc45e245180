// What the installed API does with values that its callers may get wrong.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "scumble/scumble.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

TEST(Library, APictureWhoseMembersDoNotFitIsAnError) {
  const TemporaryFolder folder;
  for (const char* const name : {"p.png", "p.tif", "p.exr", "p.jpg"}) {
    const std::string file = (folder / name).string();
    const auto refuses = [&](const Picture& picture, const std::string& words) {
      const Status status = SavePicture(file, picture);
      ASSERT_FALSE(status) << name << " " << words;
      EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
      EXPECT_NE(status.error().message.find(name), std::string::npos) << status.error().message;
      EXPECT_NE(status.error().message.find(words), std::string::npos) << status.error().message;
      EXPECT_FALSE(std::filesystem::exists(file));
    };
    Picture large(4, 4);
    large.width = large.height = 6000;
    refuses(large, "6000×6000 with 64 values in rgba; expected 144000000");
    Picture bare(4, 4);
    bare.rgba.clear();
    refuses(bare, "4×4 with 0 values");
    Picture more(4, 4);
    more.rgba.push_back(0);
    refuses(more, "with 65 values in rgba; expected 64");
    Picture negative(4, 4);
    negative.width = -3;
    refuses(negative, "-3×4");
    negative.height = -4;
    refuses(negative, "-3×-4");
    refuses(Picture(), "at least 1×1");
  }
  EXPECT_TRUE(SavePicture((folder / "p.png").string(), Picture(4, 4)));
}

}  // namespace
}  // namespace scumble
