// How Blender is run: in whose environment, what a signal leaves behind, and what a failure says. Scripts of a few
// lines stand in for it.
#include "pipeline/scene/blender_process.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "pipeline/tradeoff.h"
#include "tests/support/cli_harness.h"
#include "tests/support/scoped_variable.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

class BlenderProcess : public CliTest {
 protected:
  void WriteProgram(const std::string& name, const std::string& body) {
    WriteText(name, "#!/bin/sh\n" + body + "\n");
    fs::permissions(At(name), fs::perms::owner_all);
  }
  CommandResult Export(const std::string& blender) {
    WriteText("shot.blend", "");
    return Run({"guidegen", "shot.blend", "--blender", blender, "-o", "g.exr"});
  }
};

// Blender's Python takes the packages beside the first python3 in PATH.
TEST_F(BlenderProcess, AVirtualEnvironmentIsNotItsOwn) {
  WriteProgram("venv/bin/python3", "exit 1");
  WriteProgram("real/blender", "{ command -v python3; command -v blender; env; } > \"" + At("seen").string() + "\"");
  fs::create_directory_symlink(At("real"), At("linked"));
  const ScopedVariable path("PATH", At("venv/bin").string() + ":" + At("linked").string() + ":" + std::getenv("PATH"));
  const ScopedVariable home("PYTHONHOME", "/nowhere"), packages("PYTHONPATH", "/nowhere"),
      first("PYTHONSTARTUP", "/nowhere");
  const ScopedVariable venv("VIRTUAL_ENV", At("venv").string()), kept("SCUMBLE_KEPT", "yes");
  EXPECT_EQ(Export("blender").code, 3);
  const std::string seen = Bytes("seen");
  const std::string real = fs::canonical(At("real")).string();
  EXPECT_EQ(seen.rfind("/usr/bin/python3\n" + real + "/blender\n", 0), 0u) << seen;
  EXPECT_NE(seen.find("\nSCUMBLE_KEPT=yes\n"), std::string::npos) << seen;
  EXPECT_NE(seen.find(At("venv/bin").string()), std::string::npos) << "the caller's PATH stands behind";
  for (const char* gone : {"\nPYTHON", "\nVIRTUAL_ENV="}) EXPECT_EQ(seen.find(gone), std::string::npos) << gone;
}

// Who uses the library has no signal handler changed, and says what a program sees of its environment.
TEST_F(BlenderProcess, ALibrarysUserIsLeftAlone) {
  WriteProgram("tools/sketch", "env > \"" + At("seen").string() + "\"");
  const ScopedVariable hidden("SCUMBLE_HIDDEN", "yes"), temporary("TMPDIR", "/nowhere");
  RunContext context;
  context.environment = {"PATH=" + At("tools").string() + ":/usr/bin", "SCUMBLE_KEPT=yes", "PYTHONHOME=/nowhere"};
  context.temporary_folder = At("");
  const auto handlers = [] {
    std::vector<void (*)(int)> all;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU, SIGCHLD}) {
      struct sigaction action = {};
      ::sigaction(signal, nullptr, &action);
      all.push_back(action.sa_handler);
    }
    return all;
  };
  const auto before = handlers();
  fs::path made;
  {
    const ScratchFolder scratch(context);
    made = scratch.path();
    EXPECT_EQ(made.parent_path(), At("").parent_path());
    const auto program = RunningProgram::Start({"sketch"}, made / "log", context);
    ASSERT_TRUE(program.ok()) << program.error().message;
    EXPECT_EQ(handlers(), before);
    const auto end = (*program)->Wait();
    ASSERT_TRUE(end.ok());
    EXPECT_EQ(end->code, 0);
  }
  EXPECT_FALSE(fs::exists(made));
  const std::string seen = Bytes("seen");
  EXPECT_NE(seen.find("SCUMBLE_KEPT=yes\n"), std::string::npos) << seen;
  EXPECT_NE(seen.find("TMPDIR=" + made.string() + "\n"), std::string::npos) << seen;
  for (const char* gone : {"SCUMBLE_HIDDEN", "PYTHONHOME"}) EXPECT_EQ(seen.find(gone), std::string::npos) << gone;

  context.temporary_folder = At("absent");
  const Status nowhere = ScratchFolder(context).Made();
  ASSERT_FALSE(nowhere.ok());
  EXPECT_EQ(nowhere.error().kind, ErrorKind::kOutput);
  EXPECT_EQ(nowhere.error().message.rfind("no folder for temporary files can be made in " + At("absent").string() +
                                              " (No such file or directory): set TMPDIR",
                                          0),
            0u)
      << nowhere.error().message;

  context.environment.clear();
  const auto none = RunProgram({"sketch"}, At("log"), context);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().kind, ErrorKind::kUnavailable);
  EXPECT_EQ(none.error().message, "sketch cannot be run (No such file or directory)");
}

// Where SIGCHLD is ignored, or another part of the process waits for all its children, how a program ended is lost.
TEST_F(BlenderProcess, WhatTheHostCollectsIsJudgedByItsProduct) {
  struct sigaction ignored = {}, before = {};
  ignored.sa_handler = SIG_IGN;
  ::sigaction(SIGCHLD, &ignored, &before);
  WriteProgram("draws", "echo 1 > \"" + At("product").string() + "\"");
  WriteProgram("fails", "echo 'scumble: error: it is torn'; exit 3");
  const RunContext context;
  const BlenderTask task{"shot.blend", "blender", "the export failed", true};
  const auto run = [&](const char* program, const char* product) {
    return CheckProgramEnd(RunProgram({At(program).string()}, At("log"), context), task, At("log"), At(product));
  };
  const Status drawn = run("draws", "product"), failed = run("fails", "none");
  ::sigaction(SIGCHLD, &before, nullptr);
  EXPECT_TRUE(drawn.ok()) << drawn.error().message;
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.error().message, "shot.blend: the export failed: it is torn");
}

TEST_F(BlenderProcess, ACancelledRunEndsItWithItsChildren) {
  WriteProgram("slow", "sleep 60 & echo $! > \"" + At("sleeper").string() + "\"; wait");
  RunContext context;
  context.is_cancelled = [&] { return !Bytes("sleeper").empty(); };
  const auto end = RunProgram({At("slow").string()}, At("log"), context);
  ASSERT_FALSE(end.ok());
  EXPECT_EQ(end.error().kind, ErrorKind::kCancelled);
}

TEST_F(BlenderProcess, MemoryOfVariantsNeedsTheProgram) {
  TradeSetup setup;
  setup.scene.scene = Scene("ball.glb"), setup.style.style = "oil";
  const auto report = MeasureTradeoff(setup, RunContext());
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.error().kind, ErrorKind::kUnavailable);
  EXPECT_NE(report.error().message.find("RunContext::program"), std::string::npos) << report.error().message;
}

// Whether a process still runs; a zombie does not.
bool Runs(const std::string& pid) {
  std::ifstream stream("/proc/" + pid + "/stat");
  const std::string stat{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t name_ends = stat.rfind(')');
  return name_ends != std::string::npos && stat.at(name_ends + 2) != 'Z';
}

// A process that was killed goes when the system next looks at it, which is not at once.
bool EndsSoon(const std::string& pid) {
  for (int tries = 0; tries < 500 && Runs(pid); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return !Runs(pid);
}

TEST_F(BlenderProcess, ASignalEndsItWithItsChildrenAndLeavesNothingBehind) {
  fs::create_directory(At("tmp"));
  const ScopedVariable temporary("TMPDIR", At("tmp").string());
  for (const auto& [name, number] : {std::pair("TERM", SIGTERM), {"INT", SIGINT}, {"HUP", SIGHUP}}) {
    // Its own temporary files, a child process that waits, and then the user's signal to the program that waits for it.
    WriteProgram("blender", "echo x > \"$TMPDIR/of_blender\"; sleep 50 & echo $! > sleeper; echo $$ > self; kill -" +
                                std::string(name) + " $PPID; sleep 50");
    for (const Arguments& verb : {Arguments{"guidegen", "shot.blend", "-o", "g.exr"},
                                  Arguments{"crosscheck", Scene("suzanne.glb"), "--size", "32", "--samples", "0"}}) {
      WriteText("shot.blend", "");
      const CommandResult result = Run(With(verb, {"--blender", "./blender"}));
      EXPECT_EQ(result.code, 128 + number) << name << result.err;
      EXPECT_TRUE(fs::is_empty(At("tmp"))) << name;
      for (const char* file : {"sleeper", "self"}) {
        std::string pid = Bytes(file);
        pid.pop_back();
        EXPECT_TRUE(EndsSoon(pid)) << name << ", " << file << " " << pid;
      }
    }
  }
  EXPECT_FALSE(Exists("g.exr"));
}

// While a frame of a range is cast, the program does not wait for Blender, which may run or have ended. The casting
// alone would take longer than the test's time limit.
TEST_F(BlenderProcess, ASignalEndsARangeWithinAFrame) {
  fs::create_directory(At("tmp"));
  const ScopedVariable temporary("TMPDIR", At("tmp").string());
  WriteText("shot.blend", "");
  const auto exported = [&](const std::string& frame) {
    for (const auto& folder : fs::directory_iterator(At("tmp"))) {
      if (fs::exists(folder.path() / ("scene." + frame + ".glb"))) return true;
    }
    return false;
  };
  for (const auto& [ending, signal] : {std::pair("sleep 50", SIGTERM), {"exit 0", SIGINT}}) {
    WriteProgram("blender",
                 "while [ \"$1\" != --output ]; do shift; done; folder=$(dirname \"$2\")\n"
                 "for frame in 1 2; do cp " +
                     Scene("suzanne.glb") +
                     " \"$folder/part\"; "
                     "mv \"$folder/part\" \"$folder/scene.$frame.glb\"; done; echo $$ > self; " +
                     ending);
    fs::remove(At("self"));
    const pid_t child = Start({"guidegen", "shot.blend", "--blender", "./blender", "--frames", "1-2", "--size", "1024",
                               "--layers", "lpe.full", "--samples", "65536", "-o", "g.#.exr"});
    for (int tries = 0; tries < 2000 && (Bytes("self").empty() || exported("1")); ++tries) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(exported("2")) << "the first is loaded, the second waits";
    ::kill(child, signal);
    const CommandResult result = Finish(child);
    EXPECT_EQ(result.code, 128 + signal) << result.err;
    EXPECT_TRUE(fs::is_empty(At("tmp"))) << ending;
    std::string blender = Bytes("self");
    if (!blender.empty()) blender.pop_back();
    EXPECT_TRUE(EndsSoon(blender)) << ending;
  }
  EXPECT_FALSE(Exists("g.1.exr"));
}

TEST_F(BlenderProcess, BothVerbsTellTheSameFailureInTheSameWords) {
  WriteProgram("talking", "echo 'Fra:1 Mem:1M'; echo 'out of paint'; echo 'Fra:2 Mem:1M'; exit 1");
  WriteProgram("killed", "kill -KILL $$");
  WriteText("shot.blend", "");
  const auto fails = [&](const std::string& blender, int code, const std::string& part) {
    for (const Arguments& verb : {Arguments{"guidegen", "shot.blend", "-o", "g.exr"},
                                  Arguments{"crosscheck", Scene("suzanne.glb"), "--size", "32", "--samples", "0"}}) {
      const CommandResult result = Run(With(verb, {"--blender", blender}));
      EXPECT_EQ(result.code, code) << result.err;
      EXPECT_NE(result.Error().find(part), std::string::npos) << result.err;
      EXPECT_EQ(result.Error().find("Fra:"), std::string::npos) << result.err;
      if (verb[0] == "crosscheck") {
        EXPECT_EQ(result.Error().find("by hand"), std::string::npos) << result.err;
      }
    }
  };
  fails("./talking", 3, ": out of paint");
  fails("./killed", 3, "ended from outside (Killed)");
  fails("./none", 5,
        "./none cannot be run (No such file or directory): install Blender (3.4.1 and 4.3.2 are tested), or name its "
        "program");
}

// Python alone stands in for Blender here: a script that lacks a part ends before it asks anything of Blender.
TEST_F(BlenderProcess, AnInstallationThatLacksAScriptIsNamed) {
  const CommandSettings settings = CopyProgram("home/bin");
  const fs::path scripts = At("home/share/scumble/blender_scripts");
  WriteText("python/bpy.py", "");
  WriteProgram("blender", "while [ \"$1\" != -P ]; do shift; done\nPYTHONPATH='" + At("python").string() +
                              "' exec python3 \"$2\"");
  WriteText("shot.blend", "");
  const auto fails = [&](const std::string& missing, bool exports, bool renders) {
    const std::string sentence = missing + ": install Scumble again";
    const Arguments with = {"--blender", "./blender"};
    const Arguments compare = {"crosscheck", Scene("suzanne.glb"), "--size", "32", "--samples", "0"};
    if (exports) {
      ExpectError(With({"guidegen", "shot.blend", "-o", "g.exr"}, with), 5,
                  {"shot.blend: " + sentence + ", or export the scene to .glb by hand"}, settings);
    }
    if (renders) ExpectError(With(compare, with), 5, {"suzanne.glb: " + sentence}, settings);
  };
  fails("blender_scripts/export_scene.py is not found beside this program", true, false);
  fs::create_directories(scripts);
  fails((scripts / "export_scene.py").string() + " is missing", true, false);
  fs::copy(SCUMBLE_SOURCE_DIR "/blender_scripts", scripts);
  fs::remove(scripts / "blend_check.py");
  fails("blender_scripts/blend_check.py is missing", true, true);
  fs::remove(scripts / "render_guides.py");
  fails((scripts / "render_guides.py").string() + " is missing", false, true);
}

TEST_F(BlenderProcess, TargetsAreCheckedBeforeItRuns) {
  WriteProgram("blender", "touch ran");
  WriteText("shot.blend", "");
  const Arguments with = {"--blender", "./blender"};
  ExpectError(With({"guidegen", "shot.blend", "-o", "nodir/g.exr"}, with), 4, {"nodir/g.exr", "there is no folder"});
  ExpectError(With({"crosscheck", Scene("suzanne.glb"), "-o", "/proc/report.html"}, with), 4, {"/proc/report.html"});
  EXPECT_FALSE(Exists("ran"));
  ExpectError({"info", "shot.blend", "--blender", "./none"}, 5, {"./none"});
  ExpectError({"info", Scene("suzanne.glb"), "--blender", "./blender"}, 2, {"--blender is for .blend scenes"});
  WriteStyle("style");
  ExpectError({"transfer", "shot.blend", "--style", "style", "-o", "p.png"}, 3, {"scumble stylize"});
}

}  // namespace
}  // namespace scumble
