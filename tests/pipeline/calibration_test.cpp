// The variant chosen by the times of a fake clock: nothing here depends on the machine.
#include "pipeline/variant/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/budget_choice.h"
#include "tests/support/sphere_guides.h"

namespace scumble {
namespace {

class MemoryCache : public TableCache {
 public:
  std::optional<std::vector<std::byte>> Load(const std::string& key) override {
    const auto found = kept.find(key);
    if (found == kept.end()) return std::nullopt;
    return found->second;
  }
  void Store(const std::string& key, std::span<const std::byte> bytes) override {
    kept[key] = {bytes.begin(), bytes.end()};
    ++stores;
  }
  void Overwrite(const std::string& text) {
    for (auto& [key, bytes] : kept) {
      const auto as_bytes = std::as_bytes(std::span(text));
      bytes = {as_bytes.begin(), as_bytes.end()};
    }
  }
  std::map<std::string, std::vector<std::byte>> kept;
  int stores = 0;
};

// Variants whose runs take the listed times, repeatedly.
struct FakeClock {
  std::vector<std::vector<double>> ms;
  std::vector<int> runs = std::vector<int>(ms.size(), 0);

  MeasureVariant Measure() {
    return [this](std::size_t variant) -> Expected<double> {
      const auto run = static_cast<std::size_t>(runs[variant]++);
      return ms[variant][run % ms[variant].size()];
    };
  }
  int Total() const { return std::accumulate(runs.begin(), runs.end(), 0); }
};

Calibration Ladder(std::size_t variants, TableCache* cache = nullptr) {
  Calibration calibration{"a machine and a scene", {}, cache, false};
  for (std::size_t variant = 0; variant < variants; ++variant)
    calibration.variants.push_back("way " + std::to_string(variant));
  calibration.cold = variants - 1;
  return calibration;
}

PickedVariant MustPick(const Calibration& calibration, double budget_ms, FakeClock& clock) {
  const auto picked = PickVariant(calibration, budget_ms, clock.Measure());
  EXPECT_TRUE(picked.ok());
  return picked.ok() ? *picked : PickedVariant();
}

// slowest + 2 (slowest − median) + the addition of a cold start, by hand.
TEST(Calibration, WhatIsPredictedLiesAsFarBeyondTheSlowestAsThatIsBeyondTheMedian) {
  EXPECT_EQ(PredictedMs(std::vector<double>{7.0}, 0.0), 7.0);
  EXPECT_EQ(PredictedMs(std::vector<double>{4.0, 4.0, 4.0}, 0.0), 4.0) << "no spread, no margin";
  EXPECT_EQ(PredictedMs(std::vector<double>{10.0, 12.0, 11.0}, 0.0), 14.0);
  EXPECT_EQ(PredictedMs(std::vector<double>{10.0, 20.0}, 0.0), 30.0);
  EXPECT_EQ(PredictedMs(std::vector<double>{10.0, 12.0, 11.0}, 1.0), 15.0);
  EXPECT_EQ(PredictedMs(std::vector<double>{10.0, 12.0, 11.0}, 3.0), 17.0);
  EXPECT_EQ(PredictedMs({}, 1.0), std::numeric_limits<double>::infinity());
}

// The last variant's first run takes 35 ms, its later ones 10: 25 ms belong to the process, and are added to any
// variant's time.
TEST(Calibration, AProcessThatHasJustBegunTakesLonger) {
  std::vector<double> last(30, 10.0);
  last.front() = 35.0;
  FakeClock clock{{{20.0}, last}};
  EXPECT_EQ(MustPick(Ladder(2), 45.0, clock).predicted_ms, 45.0);
  FakeClock again{clock.ms};
  const PickedVariant picked = MustPick(Ladder(2), 44.0, again);
  EXPECT_EQ(picked.variant, 1u);
  EXPECT_EQ(picked.predicted_ms, 35.0);
  EXPECT_EQ(again.runs[1], 1 + kCalibrationRuns) << "the cold one is not one of the nine";
}

TEST(Calibration, AColdStartIsMeasuredByTheVariantThatIsNamed) {
  Calibration ladder = Ladder(3);
  ladder.cold = 1;
  FakeClock clock{{{20.0}, {10.0}, {5.0}}};
  ASSERT_TRUE(PickVariant(ladder, 100.0, clock.Measure()).ok());
  EXPECT_EQ(clock.runs, (std::vector<int>{kCalibrationRuns, 3, 0}));
}

// In the next process the first run is as cold: it is made, and does not count.
TEST(Calibration, WhatIsMeasuredLaterIsMeasuredWarmToo) {
  MemoryCache cache;
  FakeClock clock{{{50.0}, {10.0}}};
  MustPick(Ladder(2, &cache), 20.0, clock);
  std::vector<double> last(30, 10.0);
  last.front() = 1000.0;
  FakeClock later{{{50.0}, last}};
  EXPECT_EQ(MustPick(Ladder(2, &cache), 60.0, later).predicted_ms, 50.0);
  EXPECT_EQ(later.runs, (std::vector<int>{kCalibrationRuns - 1, 1}));
}

// Of n + 1 equal draws each is the slowest with equal chance: one more run is beyond the slowest of nine in 1 of 10. So
// in 4,000 trials of runs of any spread at most 400 miss, and 3.3 standard deviations of √(4000 · 0.1 · 0.9) = 19 more.
TEST(Calibration, NineRunsOfTenAreWithinTheSlowestOfNineWhateverTheirSpread) {
  std::uint64_t state = 1;
  const auto next = [&] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return double(state >> 40) / double(1 << 24);
  };
  int missed = 0, beyond = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::vector<double> runs;
    for (int run = 0; run <= kCalibrationRuns; ++run) runs.push_back(10.0 / (0.05 + next()));  // a long tail
    const double later = runs.back();
    runs.pop_back();
    beyond += later > *std::max_element(runs.begin(), runs.end());
    missed += later > PredictedMs(runs, 0.0);
  }
  EXPECT_NEAR(beyond, 400, 63);
  EXPECT_LE(missed, 200 + 45) << "one of twenty";
}

TEST(Calibration, TheMostAccurateThatFitsIsTakenAndNothingBelowItIsMeasured) {
  FakeClock clock{{{50.0}, {30.0}, {20.0}, {5.0}}};
  const PickedVariant picked = MustPick(Ladder(4), 30.0, clock);
  EXPECT_EQ(picked.variant, 1u);
  EXPECT_TRUE(picked.fits);
  EXPECT_EQ(picked.predicted_ms, 30.0);
  EXPECT_EQ(picked.measured, 1 + kCalibrationRuns + 2) << "what is too slow costs one run";
  EXPECT_EQ(clock.runs, (std::vector<int>{1, kCalibrationRuns, 0, 3})) << "the last one tells what a cold start costs";
}

// Times need not fall along the ladder: a variant farther down that is slower is passed over like any other.
TEST(Calibration, ASlowerWayFurtherDownIsPassedOver) {
  FakeClock clock{{{50.0}, {70.0}, {20.0}}};
  EXPECT_EQ(MustPick(Ladder(3), 40.0, clock).variant, 2u);
}

TEST(Calibration, AWayThatFitsButForItsSpreadIsTooSlow) {
  // Nine runs: 20 seven times, 29 twice; slowest 29, median 20, predicted 47.
  FakeClock clock{{{20.0, 20.0, 20.0, 29.0, 20.0, 20.0, 29.0, 20.0, 20.0}, {10.0}}};
  EXPECT_EQ(MustPick(Ladder(2), 30.0, clock).variant, 1u);
  FakeClock again{clock.ms};
  const PickedVariant enough = MustPick(Ladder(2), 47.0, again);
  EXPECT_EQ(enough.variant, 0u);
  EXPECT_EQ(enough.predicted_ms, 47.0);
}

TEST(Calibration, WhereNothingFitsTheQuickestIsTakenAndItsTimeNamed) {
  FakeClock clock{{{50.0}, {9.0}, {20.0}}};
  const PickedVariant picked = MustPick(Ladder(3), 5.0, clock);
  EXPECT_EQ(picked.variant, 1u) << "the quickest, wherever it stands";
  EXPECT_FALSE(picked.fits);
  EXPECT_EQ(picked.predicted_ms, 9.0);
  EXPECT_EQ(clock.runs[1], kCalibrationRuns);
  FakeClock slow{clock.ms};
  EXPECT_EQ(MustPick(Ladder(3), 4.0, slow).predicted_ms, 9.0);
  EXPECT_EQ(slow.runs[1], kHopelessRuns) << "over twice the budget: more runs would change nothing";
}

// The last variant smears strokes. It is taken only where it is quicker by more than a quarter.
TEST(Calibration, WhereNothingFitsStrokesAreNotGivenUpForATenthOfTheTime) {
  FakeClock clock{{{50.0}, {24.0}, {22.0}}};
  const PickedVariant picked = MustPick(Ladder(3), 15.0, clock);
  EXPECT_EQ(picked.variant, 1u);
  EXPECT_FALSE(picked.fits);
  EXPECT_EQ(picked.predicted_ms, 24.0);
  EXPECT_EQ(clock.runs[0], 1) << "what is far from the quickest is not run again";
  FakeClock far{{{50.0}, {28.0}, {22.0}}};
  EXPECT_EQ(MustPick(Ladder(3), 15.0, far).variant, 2u);
}

TEST(Calibration, WhereNothingFitsOneSlowRunDoesNotDecide) {
  FakeClock clock{{{50.0}, {32.0, 24.0}, {22.0}}};
  EXPECT_EQ(MustPick(Ladder(3), 15.0, clock).variant, 1u);
}

// Building the scene takes all of the time, whichever variant paints it.
TEST(Calibration, WhereAllTakeTheSameTheStyleStays) {
  FakeClock clock{{{10.0}, {9.5}, {9.0}, {9.0}}};
  EXPECT_EQ(MustPick(Ladder(4), 4.0, clock).variant, 0u);
  EXPECT_EQ(clock.runs, (std::vector<int>{3, 1, 3, 3})) << "no more is measured than that takes";
}

// The machine was busy while the first process calibrated. The second one finds out that what was left out fits.
TEST(Calibration, AMomentOfLoadDoesNotDecideForGood) {
  MemoryCache cache;
  std::vector<double> last(30, 40.0);
  last.front() = 90.0;
  FakeClock busy{{{86.0}, {70.0}, last}};
  const PickedVariant first = MustPick(Ladder(3, &cache), 40.0, busy);
  EXPECT_EQ(first.variant, 2u);
  EXPECT_FALSE(first.fits) << "a cold start took 50 ms more";
  FakeClock quiet{{{22.0}, {12.0}, {9.0}}};
  const PickedVariant second = MustPick(Ladder(3, &cache), 40.0, quiet);
  EXPECT_EQ(second.variant, 0u);
  EXPECT_TRUE(second.fits);
  EXPECT_EQ(second.predicted_ms, 22.0);
  FakeClock never{{{1e9}, {1e9}, {1e9}}};
  for (int later = 0; later < 20; ++later) EXPECT_EQ(MustPick(Ladder(3, &cache), 40.0, never).variant, 0u);
  EXPECT_EQ(never.Total(), 0) << "nothing is left out, so nothing is measured again";
}

// However long the load lasts, what was left out is looked at again, less and less often.
TEST(Calibration, WhatWasLeftOutIsMeasuredAgainAtTheSecondPickTheFourthAndTheEighth) {
  MemoryCache cache;
  FakeClock clock{{{50.0}, {10.0}}};
  std::vector<int> measuring;
  for (int pick = 1; pick <= 16; ++pick) {
    const int before = clock.runs[0];
    const PickedVariant picked = MustPick(Ladder(2, &cache), 20.0, clock);
    EXPECT_EQ(picked.variant, 1u);
    EXPECT_EQ(picked.predicted_ms, 10.0);
    if (picked.measured > 0) measuring.push_back(pick);
    EXPECT_LE(clock.runs[0] - before, 1) << "it costs one run";
  }
  EXPECT_EQ(measuring, (std::vector<int>{1, 2, 4, 8, 16}));
}

// Load at the second pick does not spoil what the first one found.
TEST(Calibration, TheQuickerTimesStay) {
  MemoryCache cache;
  FakeClock quiet{{{50.0}, {10.0}}}, busy{{{200.0}, {40.0}}};
  MustPick(Ladder(2, &cache), 20.0, quiet);
  EXPECT_EQ(MustPick(Ladder(2, &cache), 20.0, busy).variant, 1u);
  EXPECT_EQ(MustPick(Ladder(2, &cache), 20.0, busy).predicted_ms, 10.0);
  FakeClock later{quiet.ms};
  EXPECT_EQ(MustPick(Ladder(2, &cache), 60.0, later).variant, 0u) << "50 ms are known to be possible";
}

// Times that another process stores while this one measures are not lost: it had a larger budget, and has measured the
// first variant.
TEST(Calibration, TimesOfTwoProcessesAreJoined) {
  MemoryCache cache;
  FakeClock one{{{50.0}, {30.0}, {5.0}}}, other{one.ms};
  bool begun = false;
  const MeasureVariant measure = [&](std::size_t variant) -> Expected<double> {
    if (!std::exchange(begun, true)) {
      EXPECT_EQ(MustPick(Ladder(3, &cache), 60.0, other).variant, 0u);
    }
    return one.Measure()(variant);
  };
  const auto picked = PickVariant(Ladder(3, &cache), 30.0, measure);
  ASSERT_TRUE(picked.ok());
  EXPECT_EQ(picked->variant, 1u);
  FakeClock later{one.ms};
  EXPECT_EQ(MustPick(Ladder(3, &cache), 60.0, later).variant, 0u);
  EXPECT_EQ(later.Total(), 0);
  EXPECT_EQ(MustPick(Ladder(3, &cache), 30.0, later).variant, 1u);
  EXPECT_EQ(later.runs[1], 0);
}

// Times were stored on a busy machine. While one process measures one more variant, another measures all of them anew:
// the old values, the cost of a first run too, do not return.
TEST(Calibration, WhatAnotherProcessMeasuresAnewStays) {
  MemoryCache cache;
  FakeClock busy{{{90.0}, {30.0}, {25.0, 5.0, 5.0}}}, quiet{{{40.0}, {10.0}, {4.0}}};
  EXPECT_EQ(MustPick(Ladder(3, &cache), 60.0, busy).predicted_ms, 50.0) << "30, and 20 for the first run";
  bool begun = false;
  const MeasureVariant measure = [&](std::size_t variant) -> Expected<double> {
    if (!std::exchange(begun, true)) {
      Calibration anew = Ladder(3, &cache);
      anew.anew = true;
      EXPECT_EQ(MustPick(anew, 20.0, quiet).variant, 1u);
    }
    return busy.Measure()(variant);
  };
  const auto picked = PickVariant(Ladder(3, &cache), 200.0, measure);
  ASSERT_TRUE(picked.ok());
  EXPECT_EQ(picked->variant, 0u);
  FakeClock never{{{1e9}, {1e9}, {1e9}}};
  const PickedVariant later = MustPick(Ladder(3, &cache), 20.0, never);
  EXPECT_EQ(later.variant, 1u);
  EXPECT_EQ(later.predicted_ms, 10.0);
  EXPECT_EQ(never.runs[1], 0);
}

TEST(Calibration, KnownTimesAreNotMeasuredAgain) {
  MemoryCache cache;
  FakeClock clock{{{50.0}, {30.0}, {5.0}}};
  for (int pick = 0; pick < 2; ++pick) MustPick(Ladder(3, &cache), 30.0, clock);
  const int first = clock.Total();
  const PickedVariant again = MustPick(Ladder(3, &cache), 30.0, clock);
  EXPECT_EQ(again.variant, 1u);
  EXPECT_EQ(again.predicted_ms, 30.0);
  EXPECT_EQ(again.measured, 0);
  EXPECT_EQ(clock.Total(), first);
  // A larger budget: what was given up at its first run is measured to the end, the others are known.
  const PickedVariant more = MustPick(Ladder(3, &cache), 60.0, clock);
  EXPECT_EQ(more.variant, 0u);
  EXPECT_EQ(more.measured, kCalibrationRuns - 1);
  const int stores = cache.stores;
  MustPick(Ladder(3, &cache), 60.0, clock);
  EXPECT_EQ(cache.stores, stores) << "nothing new and nothing left out, nothing written";
  // A smaller one: 30 is known to be too much.
  EXPECT_EQ(MustPick(Ladder(3, &cache), 10.0, clock).variant, 2u);
}

TEST(Calibration, OtherCircumstancesHaveOtherTimes) {
  MemoryCache cache;
  FakeClock clock{{{50.0}, {30.0}}};
  Calibration ladder = Ladder(2, &cache);
  MustPick(ladder, 40.0, clock);
  FakeClock quicker{{{20.0}, {10.0}}};
  ladder.circumstances = "another machine";
  EXPECT_EQ(MustPick(ladder, 40.0, quicker).variant, 0u);
  EXPECT_EQ(cache.kept.size(), 2u);
}

TEST(Calibration, AnewForgetsWhatWasKept) {
  MemoryCache cache;
  FakeClock slow{{{50.0}, {30.0}}}, quick{{{20.0}, {10.0}}};
  Calibration ladder = Ladder(2, &cache);
  for (int pick = 0; pick < 2; ++pick) EXPECT_EQ(MustPick(ladder, 40.0, slow).variant, 1u);
  EXPECT_EQ(MustPick(ladder, 40.0, quick).variant, 1u) << "times are kept";
  ladder.anew = true;
  EXPECT_EQ(MustPick(ladder, 40.0, quick).variant, 0u);
  ladder.anew = false;
  FakeClock never{{{1e9}, {1e9}}};
  EXPECT_EQ(MustPick(ladder, 40.0, never).variant, 0u) << "the new times are kept";
  EXPECT_EQ(never.Total(), 0);
}

TEST(Calibration, ABrokenCacheIsMeasuredOver) {
  MemoryCache cache;
  FakeClock clock{{{50.0}, {30.0}}};
  for (int pick = 0; pick < 2; ++pick) MustPick(Ladder(2, &cache), 40.0, clock);
  const std::vector<std::byte>& bytes = cache.kept.begin()->second;
  const std::string good(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  // The later clock says 20 ms of the first variant: it is picked where the times that are kept are not taken.
  const auto is_taken = [](const std::string& text) {
    MemoryCache again;
    FakeClock before{{{50.0}, {30.0}}}, later{{{20.0}, {10.0}}};
    for (int pick = 0; pick < 2; ++pick) MustPick(Ladder(2, &again), 40.0, before);
    again.Overwrite(text);
    const PickedVariant picked = MustPick(Ladder(2, &again), 40.0, later);
    EXPECT_EQ(picked.variant == 0, later.runs[0] == kCalibrationRuns) << text;
    return picked.variant != 0;
  };
  EXPECT_TRUE(is_taken(good)) << good;
  for (const std::string& text : {std::string(), std::string("{"), std::string("\n"), "more\n" + good}) {
    EXPECT_FALSE(is_taken(text)) << text;
  }
  const std::string name = "circumstances a machine and a scene\n";
  const std::pair<std::string, std::string> changes[] = {{name, ""},
                                                         {name, "circumstances others\n"},
                                                         {"cold_ms 0\n", ""},
                                                         {"cold_ms 0", "cold_ms -1"},
                                                         {"cold_ms 0", "cold_ms x"},
                                                         {"cold_ms 0", "cold_ms inf"},
                                                         {"picks 2", "picks -2"},
                                                         {"picks 2", "picks inf"},
                                                         {"runs 9 ", "runs 99 "},
                                                         {"runs 9 ", "runs x "},
                                                         {"runs 1 50 ", "runs 1 -50 "},
                                                         {"runs 1 50 ", "runs 1 x "},
                                                         {"runs 1 50 ", "runs 1 inf "}};
  for (const auto& [from, to] : changes) {
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from << " in " << good;
    EXPECT_FALSE(is_taken(text.replace(at, from.size(), to))) << text;
  }
}

// A variant that the ladder no longer has does not matter.
TEST(Calibration, TimesOfVariantsThatThereAreNoMoreDoNotCount) {
  MemoryCache cache;
  FakeClock clock{{{50.0}, {30.0}, {5.0}}};
  MustPick(Ladder(3, &cache), 10.0, clock);
  Calibration less = Ladder(3, &cache);
  less.variants = {"way 1"}, less.cold = 0;
  FakeClock one{{{30.0}}};
  EXPECT_EQ(MustPick(less, 100.0, one).variant, 0u);
}

TEST(Calibration, WhatCannotBeMeasuredIsAnError) {
  MemoryCache cache;
  int left = 3;
  const auto picked = PickVariant(Ladder(2, &cache), 10.0, [&](std::size_t) -> Expected<double> {
    if (--left < 0) return InputError("the scene is gone");
    return 5.0;
  });
  ASSERT_FALSE(picked.ok());
  EXPECT_EQ(picked.error().message, "the scene is gone");
}

TEST(Calibration, TimesStayWhereTheirRenewalIsCancelled) {
  MemoryCache cache;
  FakeClock clock{{{50.0}, {10.0}}};
  EXPECT_EQ(MustPick(Ladder(2, &cache), 20.0, clock).variant, 1u);
  const auto before = cache.kept;
  int runs = 0;
  const auto picked = PickVariant(Ladder(2, &cache), 20.0, [&](std::size_t) -> Expected<double> {
    if (++runs > 2) return CancelledError();
    return 60.0;
  });
  ASSERT_FALSE(picked.ok());
  EXPECT_EQ(picked.error().kind, ErrorKind::kCancelled);
  EXPECT_GT(runs, 2) << "times were being renewed";
  EXPECT_EQ(cache.kept, before);
}

TEST(ChooseForGuides, StopsWhereTheProgressCallbackAsksForIt) {
  RunContext context;
  context.data_roots = {SCUMBLE_SOURCE_DIR};
  int calls = 0;
  context.on_progress = [&](const std::string&) -> Progress { return [&](double) { return ++calls < 2; }; };
  StyleRequest style;
  style.style = "oil";
  auto styles = OpenStyles(style, context);
  ASSERT_TRUE(styles.ok()) << styles.error().message;
  BudgetRequest budget;
  budget.budget_ms = 1000.0;
  PictureRequest picture;
  GuideSet guides = SphereGuides(16);
  guides.Add(Layer::kObject);
  const auto choice = ChooseForGuides(budget, guides, {}, "sphere", "", *styles, picture, context);
  ASSERT_FALSE(choice.ok());
  EXPECT_EQ(choice.error().kind, ErrorKind::kCancelled) << choice.error().message;
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace scumble
