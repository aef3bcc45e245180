// The fuzzers' targets over their seeds, over every input that ever broke one, and over mutations of both: a short run
// of what `make fuzz` does for longer, the same one every time, in about 12 s of one core. SCUMBLE_FUZZ_RUNS in the
// environment: so many mutations for each target.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>

#include "core/image/hash.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

namespace fs = std::filesystem;

using Input = std::vector<std::uint8_t>;

struct NamedInput {
  std::string file;
  Input bytes;
};

std::vector<NamedInput> InputsOf(const std::string& kind, const std::string& target) {
  std::vector<NamedInput> inputs;
  std::error_code none;  // no crash was ever found in some
  for (const auto& entry : fs::directory_iterator(fs::path(SCUMBLE_SOURCE_DIR) / "tests/fuzz" / kind / target, none)) {
    std::ifstream file(entry.path(), std::ios::binary);
    inputs.push_back({entry.path().string(), Input(std::istreambuf_iterator<char>(file), {})});
  }
  std::sort(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) { return a.file < b.file; });
  return inputs;
}

// One to four changes: a bit, a byte, a number at the end of its range, a part of another input, a part left out or
// doubled, the end cut off.
Input Mutated(const std::vector<NamedInput>& seeds, std::uint64_t number) {
  const auto chance = [&](std::uint64_t i, std::size_t below) {
    return static_cast<std::size_t>(Hash(number, i) % std::max<std::size_t>(below, 1));
  };
  Input bytes = seeds[chance(0, seeds.size())].bytes;
  const std::size_t changes = 1 + chance(1, 4);
  for (std::uint64_t change = 0, at = 2; change < changes; ++change, at += 8) {
    if (bytes.empty()) bytes.push_back(0);
    const std::size_t place = chance(at, bytes.size()),
                      length = 1 + chance(at + 1, std::min<std::size_t>(bytes.size() - place, 16));
    const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(place);
    const auto behind = here + static_cast<std::ptrdiff_t>(length);
    switch (chance(at + 2, 7)) {
      case 0:
        bytes[place] ^= static_cast<std::uint8_t>(1u << chance(at + 3, 8));
        break;
      case 1:
        bytes[place] = static_cast<std::uint8_t>(chance(at + 3, 256));
        break;
      case 2:
        std::fill(here, behind, chance(at + 3, 2) ? std::uint8_t(0xff) : std::uint8_t(0));
        break;
      case 3: {
        const Input& other = seeds[chance(at + 3, seeds.size())].bytes;
        const std::size_t from = chance(at + 4, other.size()),
                          count = std::min(other.size() - from, chance(at + 5, 32));
        bytes.insert(here, other.begin() + static_cast<std::ptrdiff_t>(from),
                     other.begin() + static_cast<std::ptrdiff_t>(from + count));
        break;
      }
      case 4:
        bytes.erase(here, behind);
        break;
      case 5: {
        const Input twice(here, behind);
        bytes.insert(here, twice.begin(), twice.end());
        break;
      }
      default:
        bytes.resize(place);
    }
  }
  return bytes;
}

// Mutations, about one second of each target on one core: some write a file for each, some look at little before they
// refuse.
std::uint64_t RunsOf(const std::string& target) {
  static const std::map<std::string, std::uint64_t> kRuns = {
      {"baseline", 20000}, {"exr", 2000},    {"gltf", 2500},    {"guides", 3500},  {"header", 50000},
      {"http", 40000},     {"obj", 1400},    {"options", 4000}, {"picture", 3000}, {"ply", 2000},
      {"png", 50000},      {"raster", 4000}, {"state", 50000},  {"style", 3200}};
  if (const char* const asked = std::getenv("SCUMBLE_FUZZ_RUNS")) return std::strtoull(asked, nullptr, 10);
  const auto found = kRuns.find(target);
  EXPECT_NE(found, kRuns.end()) << target << " has no number of runs";
  return found == kRuns.end() ? 0 : found->second;
}

class Fuzz : public testing::TestWithParam<Target> {
 protected:
  void SetUp() override { SetIoThreads(1); }
  // Runs the target on the input: only exceptions are visible here; the sanitizers find other faults.
  static void Run(const Input& bytes, const std::string& what) {
    // A copy of the very size, so that a read behind its end is seen.
    const Input copy(bytes.begin(), bytes.end());
    EXPECT_NO_THROW(GetParam().run(copy)) << what;
  }
};

TEST_P(Fuzz, SeedsAndCrashes) {
  const auto seeds = InputsOf("corpus", GetParam().name);
  ASSERT_FALSE(seeds.empty());
  for (const auto& [file, bytes] : seeds) Run(bytes, file);
  for (const auto& [file, bytes] : InputsOf("crashes", GetParam().name)) Run(bytes, file);
  Run({}, "nothing at all");
}

TEST_P(Fuzz, MutationsOfThem) {
  const std::uint64_t runs = RunsOf(GetParam().name);
  auto seeds = InputsOf("corpus", GetParam().name);
  for (auto& crash : InputsOf("crashes", GetParam().name)) seeds.push_back(std::move(crash));
  ASSERT_FALSE(seeds.empty());
  for (std::uint64_t number = 0; number < runs && !HasFailure(); ++number) {
    const Input bytes = Mutated(seeds, number);
    const fs::path kept = fs::path(testing::TempDir()) / (GetParam().name + "-mutation-" + std::to_string(number));
    Run(bytes, "kept in " + kept.string());
    if (HasFailure())
      std::ofstream(kept, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, testing::ValuesIn(Targets()),
                         [](const auto& target) { return target.param.name; });

// A file that leaves tests/CMakeLists.txt would be forgotten without a word.
TEST(FuzzTargets, AreAllHere) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(SCUMBLE_SOURCE_DIR) / "tests/fuzz")) {
    files += entry.path().string().ends_with("_fuzz.cpp");
  }
  EXPECT_EQ(Targets().size(), files);
}

}  // namespace
}  // namespace scumble::fuzz
