// A run stopped by a full disk or by a signal leaves only whole files.
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

class CliInterrupted : public CliTest {
 protected:
  static constexpr int kSize = 96;

  // Guides of which the picture of one frame alone is large: all others show nothing.
  void WriteFrames(int frames, int large) {
    GuideSet nothing = Ball(kSize);
    for (float& coverage : nothing.Plane(Layer::kCoverage)) coverage = 0.0f;
    for (int frame = 1; frame <= frames; ++frame) {
      WriteGuideFile("g." + std::to_string(frame) + ".exr", frame == large ? Ball(kSize) : nothing);
    }
  }
  std::vector<std::string> Names(const std::string& start) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(Work())) {
      if (const std::string name = entry.path().filename(); name.starts_with(start)) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  // Of files that are being written. Empty where the folder changed while it was read.
  std::vector<std::string> Unfinished() const {
    try {
      return Names(".");
    } catch (const fs::filesystem_error&) {
      return {};
    }
  }

  // Runs until a file is being written, then sends the signal.
  CommandResult RunAndSignal(const Arguments& arguments, int signal) {
    const pid_t child = Start(arguments);
    // Caught between its making and its end: stopped meanwhile, so that the signal finds it there.
    bool is_caught = false;
    while (!is_caught) {
      siginfo_t state = {};
      EXPECT_EQ(::waitid(P_PID, static_cast<id_t>(child), &state, WEXITED | WNOHANG | WNOWAIT), 0);
      if (state.si_pid == child) break;  // it is over
      if (!Unfinished().empty()) {
        ::kill(child, SIGSTOP);
        ::waitid(P_PID, static_cast<id_t>(child), &state, WSTOPPED | WEXITED | WNOWAIT);
        is_caught = state.si_code == CLD_STOPPED && !Unfinished().empty();
        if (!is_caught) ::kill(child, SIGCONT);
      }
      std::this_thread::yield();
    }
    EXPECT_TRUE(is_caught) << Joined(arguments) << ": was over before a file was seen that was being written";
    ::kill(child, signal);
    ::kill(child, SIGCONT);
    return Finish(child);
  }
};

TEST_F(CliInterrupted, AFullDiskInTheMiddleOfASequence) {
  WriteStyle("style");
  WriteFrames(5, 3);
  CommandSettings full;
  full.file_size_limit = 4096;
  const Arguments transfer = {"transfer", "g.#.exr", "--style", "style", "--frames", "1-5"};
  for (const std::string ending : {".png", ".exr"}) {
    for (const char* threads : {"1", "3"}) {
      for (const auto& name : Names("p.")) fs::remove(At(name));
      WriteText("p.3" + ending, "an older one");
      const CommandResult result = Run(With(transfer, {"--threads", threads, "-o", "p.#" + ending}), full);
      EXPECT_EQ(result.code, 4) << result.err;
      EXPECT_EQ(result.Error(), "frame 3: cannot write p.3" + ending + ": File too large") << result.err;
      EXPECT_EQ(Names("p."), (std::vector<std::string>{"p.1" + ending, "p.2" + ending, "p.3" + ending}));
      EXPECT_EQ(Unfinished(), std::vector<std::string>());
      for (const char* frame : {"p.1", "p.2"}) {
        EXPECT_NE(result.out.find(std::string(frame) + ending), std::string::npos) << "is reported: " << result.out;
        const auto picture = ReadPicture(At(frame + ending));
        ASSERT_TRUE(picture) << picture.error().message;
        EXPECT_EQ(picture->width, kSize);
      }
      EXPECT_EQ(result.out.find("p.3" + ending), std::string::npos) << result.out;
      EXPECT_EQ(Bytes("p.3" + ending), "an older one");
    }
  }
  // With room again, the missing frames are made.
  const CommandResult rest = RunOk(With(transfer, {"--resume", "-o", "p.#.exr"}));
  EXPECT_NE(rest.out.find("3 made, 2 kept"), std::string::npos) << rest.out;
}

TEST_F(CliInterrupted, AFullDiskAtTheLastFrame) {
  WriteStyle("style");
  WriteFrames(2, 2);
  CommandSettings full;
  full.file_size_limit = 4096;
  const CommandResult result =
      Run({"transfer", "g.#.exr", "--style", "style", "--frames", "1-2", "--json", "-o", "p.#.png"}, full);
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_EQ(result.Error(), "frame 2: cannot write p.2.png: File too large") << result.err;
  EXPECT_EQ(Names("p."), std::vector<std::string>{"p.1.png"});
  EXPECT_EQ(Unfinished(), std::vector<std::string>());
}

TEST_F(CliInterrupted, GuidesOnAFullDisk) {
  CommandSettings full;
  full.file_size_limit = 4096;
  const CommandResult result =
      Run({"guidegen", Scene("suzanne.glb"), "--size", "64", "--frames", "1-3", "-o", "g.#.exr"}, full);
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_EQ(result.Error(), "frame 1: cannot write g.1.exr: File too large") << result.err;
  EXPECT_EQ(Names("g"), std::vector<std::string>());
  EXPECT_EQ(Unfinished(), std::vector<std::string>());
}

// Like a shell's `ulimit -f`: the system would end the program by default.
TEST_F(CliInterrupted, ALimitOfFileSizesIsAnErrorOfWriting) {
  WriteText("run.sh", std::string("ulimit -f 1; exec ") + SCUMBLE_BINARY + " guidegen " + Scene("suzanne.glb") +
                          " --size 64 -o g.exr\n");
  CommandSettings shell;
  shell.program = "/bin/sh";
  const CommandResult result = Run({"run.sh"}, shell);
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_EQ(result.Error(), "cannot write g.exr: File too large");
  EXPECT_EQ(Unfinished(), std::vector<std::string>());
}

TEST_F(CliInterrupted, SignalsLeaveNoTemporaryFiles) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(kSize));
  for (const std::string ending : {".png", ".exr", ".tif"}) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
      const CommandResult result = RunAndSignal({"transfer", "g.exr", "--style", "style", "--frames", "1-9999",
                                                 "--threads", signal == SIGHUP ? "1" : "2", "-o", "p.####" + ending},
                                                signal);
      EXPECT_EQ(result.code, 128 + signal) << result.err;
      EXPECT_EQ(result.Error(), "") << "a signal is no failure to write";
      EXPECT_EQ(Unfinished(), std::vector<std::string>()) << ending << " " << signal;
      for (const std::string& name : Names("p.")) {
        EXPECT_TRUE(ReadPicture(At(name))) << name;
        fs::remove(At(name));
      }
    }
  }
}

TEST_F(CliInterrupted, SignalsLeaveNoTemporaryGuides) {
  const CommandResult result = RunAndSignal(
      {"guidegen", Scene("suzanne.glb"), "--size", "64", "--frames", "1-9999", "-o", "g.####.exr"}, SIGTERM);
  EXPECT_EQ(result.code, 128 + SIGTERM) << result.err;
  EXPECT_EQ(Unfinished(), std::vector<std::string>());
}

TEST_F(CliInterrupted, ASignalThatIsIgnoredStaysIgnored) {
  WriteText("run.sh", std::string("trap '' HUP; (sleep 0.1; kill -HUP $$) & exec ") + SCUMBLE_BINARY + " guidegen " +
                          Scene("suzanne.glb") + " --size 64 --frames 1-40 -o g.####.exr\n");
  CommandSettings shell;
  shell.program = "/bin/sh";
  EXPECT_EQ(Run({"run.sh"}, shell).code, 0);
  EXPECT_EQ(Names("g.").size(), 40u);
}

}  // namespace
}  // namespace scumble
