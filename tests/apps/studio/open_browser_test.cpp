// Opening the browser: a script takes its place.
#include "apps/studio/open_browser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kAddress = "http://127.0.0.1:4321/?token=secret";

class OpenBrowser : public testing::Test {
 protected:
  OpenBrowser() {
    fs::create_directories(folder_ / "tmp");
    context_.temporary_folder = folder_ / "tmp";
    context_.environment = {"PATH=" + folder_.path().string() + ":/usr/bin:/bin", "DISPLAY=:9"};
    context_.on_message = [this](const Message& message) { notes_.push_back(message.text); };
  }

  // A browser that writes down what it is called with, and what it is sent on to.
  void Fake(const std::string& name) {
    std::ofstream(folder_ / name) << "#!/bin/sh\necho \"" << name << " $*\" > " << (folder_ / "made").string()
                                  << "\ncat \"$1\" >> " << (folder_ / "made").string() << "\nmv "
                                  << (folder_ / "made").string() << " " << (folder_ / "said").string() << "\n";
    fs::permissions(folder_ / name, fs::perms::owner_all);
  }
  std::string Said() const {
    for (int i = 0; i < 1000 && !fs::exists(folder_ / "said"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::ifstream file(folder_ / "said");
    return std::string(std::istreambuf_iterator<char>(file), {});
  }

  TemporaryFolder folder_;  // its own, since cases run side by side
  RunContext context_;
  std::vector<std::string> notes_;
};

TEST_F(OpenBrowser, TheAddressIsInAFileAndInNoArgument) {
  Fake("xdg-open");
  const auto browser = OpenedBrowser::Start(kAddress, context_);
  ASSERT_TRUE(browser);
  struct stat status;
  ASSERT_EQ(::stat(browser->file().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  EXPECT_EQ(browser->file().extension(), ".html");
  const std::string said = Said(), line = said.substr(0, said.find('\n'));
  EXPECT_EQ(line, "xdg-open " + browser->file().string());
  EXPECT_THAT(said, HasSubstr("url=" + std::string(kAddress) + "\""));
  browser->PageWasFetched();
  for (int i = 0; i < 1000 && fs::exists(browser->file()); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_FALSE(fs::exists(browser->file()));
  EXPECT_TRUE(notes_.empty());
}

TEST_F(OpenBrowser, TheFileGoesWithTheStudio) {
  Fake("xdg-open");
  { const auto browser = OpenedBrowser::Start(kAddress, context_); }
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
}

TEST_F(OpenBrowser, TheVariableGoesFirst) {
  Fake("xdg-open");
  Fake("lynx");
  context_.environment = {"PATH=" + folder_.path().string() + ":/usr/bin:/bin", "BROWSER=missing:lynx %s:xdg-open"};
  const auto browser = OpenedBrowser::Start(kAddress, context_);
  ASSERT_TRUE(browser);
  EXPECT_THAT(Said(), HasSubstr("lynx " + browser->file().string()));
}

TEST_F(OpenBrowser, WithoutABrowserANoteSaysSo) {
  context_.environment = {"PATH=" + folder_.path().string(), "DISPLAY=:9"};
  EXPECT_FALSE(OpenedBrowser::Start(kAddress, context_));  // no xdg-open
  Fake("xdg-open");
  context_.environment = {"PATH=" + folder_.path().string()};
  EXPECT_FALSE(OpenedBrowser::Start(kAddress, context_));  // no display
  context_.environment = {"PATH=" + folder_.path().string(), "WAYLAND_DISPLAY=wayland-0"};
  context_.temporary_folder = folder_ / "none";
  EXPECT_FALSE(OpenedBrowser::Start(kAddress, context_));
  ASSERT_EQ(notes_.size(), 3u);
  for (const std::string& note : notes_) {
    EXPECT_THAT(note, HasSubstr("open the address above"));
    EXPECT_THAT(note, Not(HasSubstr("secret")));
  }
}

}  // namespace
}  // namespace scumble
