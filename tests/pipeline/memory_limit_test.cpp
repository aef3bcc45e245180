// The memory limit: its value, its source, and refusals.
#include "pipeline/memory_limit.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

constexpr std::uint64_t kMega = 1 << 20, kGiga = 1 << 30;

class MemoryLimitTest : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    const std::filesystem::path path = root_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  // A machine with 4 GiB to give, on which this process has 100 MiB.
  void Machine() {
    Write("proc/meminfo", "MemTotal:       16000000 kB\nMemFree:          100000 kB\nMemAvailable:    4194304 kB\n");
    Write("proc/self/status", "Name:\tscumble\nVmSize:\t  204800 kB\nVmHWM:\t  120000 kB\nVmRSS:\t  102400 kB\n");
  }
  MemoryLimit Limit(std::uint64_t asked = 0) const {
    RunContext context;
    context.max_memory = asked;
    return LimitFor(context, root_ / "");
  }
  TemporaryFolder root_;
};

TEST_F(MemoryLimitTest, TheMachineGivesWhatIsAvailableOnTopOfWhatThereIs) {
  Machine();
  EXPECT_EQ(Limit().bytes, 4 * kGiga + 100 * kMega);
  EXPECT_FALSE(Limit().asked);
  EXPECT_EQ(Limit(7).bytes, 7u) << "the option goes before the machine";
  EXPECT_TRUE(Limit(7).asked);
}

TEST_F(MemoryLimitTest, AMachineThatDoesNotTellRefusesNothing) {
  MemoryNeed need;
  need.Take("all", std::uint64_t(1) << 62);
  EXPECT_TRUE(CheckMemory(need, Limit(), "take less"));
}

// Version 2: the group's limit without what it has, files that can be dropped apart; a parent's, where that is less.
TEST_F(MemoryLimitTest, TheLeastOfItsControlGroups) {
  Machine();
  Write("proc/self/cgroup", "0::/farm/job\n");
  Write("sys/fs/cgroup/farm/job/memory.max", "max\n");
  EXPECT_EQ(Limit().bytes, 4 * kGiga + 100 * kMega) << "no limit";
  Write("sys/fs/cgroup/farm/job/memory.max", "1073741824\n");
  Write("sys/fs/cgroup/farm/job/memory.current", "314572800\n");
  Write("sys/fs/cgroup/farm/job/memory.stat", "anon 1\ninactive_file 104857600\n");
  EXPECT_EQ(Limit().bytes, (1024 - 300 + 100 + 100) * kMega);
  Write("sys/fs/cgroup/farm/memory.max", "524288000\n");
  EXPECT_EQ(Limit().bytes, (500 + 100) * kMega);
  Write("sys/fs/cgroup/memory.max", "104857600\n");
  EXPECT_EQ(Limit().bytes, 200 * kMega) << "in a container the mounted folder is the group's own";
  Write("proc/self/cgroup", "4:cpu:/\n5:cpuset,memory:/job\n");
  Write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "209715200\n");
  Write("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "104857600\n");
  EXPECT_EQ(Limit().bytes, 200 * kMega) << "version 1";
}

TEST_F(MemoryLimitTest, DamagedFilesTellNothing) {
  Write("proc/meminfo", "MemAvailable: much\n");
  Write("proc/self/cgroup", "nonsense\n::\n0:\n");
  MemoryNeed need;
  need.Take("all", 1);
  EXPECT_TRUE(CheckMemory(need, Limit(), ""));
}

// The peak is the largest sum of permanent and temporary memory.
TEST(MemoryNeed, ThePeakIsTheLargestSum) {
  MemoryNeed need;
  need.Take("a", 100);
  need.TakeTransient("b", 50);
  EXPECT_EQ(need.peak(), 150u);
  need.Take("c", 30);
  EXPECT_EQ(need.peak(), 150u) << "b was given back before";
  ASSERT_EQ(need.parts().size(), 2u);
  EXPECT_EQ(need.parts()[1].name, "b");
  need.Take("a", 60);
  EXPECT_EQ(need.peak(), 190u);
  ASSERT_EQ(need.parts().size(), 2u) << "a's two parts are one";
  EXPECT_EQ(need.parts()[0].bytes, 160u);
  need.Take("huge", ~std::uint64_t(0));
  EXPECT_EQ(need.peak(), ~std::uint64_t(0)) << "it never wraps";
}

TEST(MemoryNeed, TheRefusalSaysHowMuchWhatForHowMuchThereIsAndWhatToDo) {
  MemoryNeed need;
  need.Take("guides", 3 * kGiga);
  need.Take("picture", kGiga);
  const Status asked = CheckMemory(need, MemoryLimit{kGiga, "--max-memory allows", true}, "take a smaller --size");
  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().kind, ErrorKind::kUsage);
  EXPECT_EQ(
      asked.error().message,
      "this takes up to 4.0 GiB of memory (guides 3.0 GiB, picture 1.0 GiB), and --max-memory allows 1.0 GiB: take a "
      "smaller --size, or allow more");
  const Status machine = CheckMemory(need, MemoryLimit{kGiga, "the machine has", false}, "take a smaller --size");
  ASSERT_FALSE(machine);
  EXPECT_EQ(machine.error().kind, ErrorKind::kMemory);
  EXPECT_NE(machine.error().message.find("--max-memory 4096M to try all the same"), std::string::npos);
  EXPECT_TRUE(CheckMemory(need, MemoryLimit{4 * kGiga, "the machine has", false}, "")) << "what fits exactly";
}

TEST(MemoryAmounts, AreReadInPowersOf1024) {
  const auto bytes = [](const char* text) { return ParseBytes(text).value(); };
  EXPECT_EQ(bytes("4G"), 4 * kGiga);
  EXPECT_EQ(bytes("1.5g"), kGiga + kGiga / 2);
  EXPECT_EQ(bytes("800M"), 800 * kMega);
  EXPECT_EQ(bytes("64k"), 65536u);
  EXPECT_EQ(bytes("2T"), 2048 * kGiga);
  EXPECT_EQ(bytes("123456"), 123456u);
  for (const char* wrong :
       {"", "0", "-1G", "4X", "4GB", "G", "1e99", "nan", "inf", "0.1", "99999999999T", " 4G", "4 G"}) {
    EXPECT_FALSE(ParseBytes(wrong)) << wrong;
  }
}

TEST(MemoryAmounts, AreSaidWithTwoDigits) {
  EXPECT_EQ(BytesToText(0), "0 bytes");
  EXPECT_EQ(BytesToText(999), "999 bytes");
  EXPECT_EQ(BytesToText(1000), "1.0 KiB");
  EXPECT_EQ(BytesToText(kMega), "1.0 MiB");
  EXPECT_EQ(BytesToText(25 * kMega), "25 MiB");
  EXPECT_EQ(BytesToText(4 * kGiga + kGiga / 2), "4.5 GiB");
}

TEST(CheckMemory, LargeExemplarsHaveTheirOwnRemedy) {
  MemoryNeed need;
  need.Take("guides", kMega), need.Take("exemplars", 2 * kMega);
  const Status status = CheckMemory(need, MemoryLimit{kMega, "--max-memory allows", true}, "take a smaller --size");
  ASSERT_FALSE(status.ok());
  EXPECT_NE(
      status.error().message.find("a smaller transfer.scale or a larger transfer.reference_height, or allow more"),
      std::string::npos)
      << status.error().message;
}

// A large need is reported before it is allocated; frames with equal needs are not reported again.
TEST(MuchMemory, IsSaidOnceBeforeItIsTaken) {
  std::string notes;
  RunContext loud;
  loud.max_memory = 1024 * kGiga;
  loud.on_message = [&](const Message& message) { notes += message.text; };
  const RunContext quiet = loud.WithoutNotes();
  const auto noted = [&](const RunContext& context, std::uint64_t bytes) {
    MemoryNeed need;
    need.Take("guides", bytes);
    notes.clear();
    EXPECT_TRUE(CheckMemory(need, context, "").ok());
    return notes;
  };
  EXPECT_EQ(noted(loud, kMuchMemory - 1), "");
  EXPECT_EQ(noted(quiet, 8 * kGiga), "");
  EXPECT_EQ(noted(loud, 8 * kGiga), "takes up to 8.0 GiB of memory; --max-memory allows 1.0 TiB");
  EXPECT_EQ(noted(loud, 8 * kGiga), "");
  EXPECT_EQ(noted(loud, 11 * kGiga), "");
  EXPECT_EQ(noted(loud, 12 * kGiga), "takes up to 12 GiB of memory; --max-memory allows 1.0 TiB");
}

}  // namespace
}  // namespace scumble
