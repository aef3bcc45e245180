// What finishing effects and presets promise (docs/finish.md), on small pictures of the still life in oil. The figures
// of the documents are of large ones: bench/finish/finish_measures_bench.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "pipeline/api/guide_layers.h"
#include "scumble/stylizer.h"
#include "tests/support/finish_chains.h"

namespace scumble {
namespace {

const std::string kRoot = SCUMBLE_SOURCE_DIR;

// Lengths in the pictures of 240 lines are those of 540: lines are a pixel wide then.
constexpr double kScale = 0.5;

struct StillLife {
  Picture painted;
  GuideLayers large, small;
  TwoSizes Sizes() const { return {painted, *large.state()->guides, *small.state()->guides, kScale}; }
};

Expected<StillLife> MakeStillLife() {
  SCUMBLE_ASSIGN(const std::vector<FinishedChain> chains, ChainsToMeasure(kRoot, {}));
  Stylizer stylizer;
  SceneSettings large;
  large.file = kRoot + "/scenes/stilllife.glb", large.width = 424, large.height = 240, large.coverage_samples = 4;
  SceneSettings small = large;
  small.width = 212, small.height = 120;
  const LayerSet layers = LayersOfChains(chains);
  SCUMBLE_ASSIGN(Picture painted, stylizer.Paint(large, {.style = kRoot + "/exemplars/oil"}));
  SCUMBLE_ASSIGN(GuideLayers of_large, stylizer.Guides(large, layers));
  SCUMBLE_ASSIGN(GuideLayers of_small, stylizer.Guides(small, layers));
  return StillLife{std::move(painted), std::move(of_large), std::move(of_small)};
}

const StillLife& TheStillLife() {
  static const Expected<StillLife> still_life = MakeStillLife();
  EXPECT_TRUE(still_life) << still_life.error().message;
  return *still_life;
}

TEST(FinishPromises, HalfTheSizeLooksTheSame) {
  const StillLife& still_life = TheStillLife();
  const auto chains = ChainsToMeasure(kRoot, MeasureColors(still_life.painted));
  ASSERT_TRUE(chains) << chains.error().message;
  for (const FinishedChain& chain : *chains) {
    const auto pair = FinishBoth(chain, still_life.Sizes());
    ASSERT_TRUE(pair) << chain.name << ": " << pair.error().message;
    const auto flip = MeasureFlip(pair->halved, pair->small);
    ASSERT_TRUE(flip);
    // Thin lines cover more of small pictures.
    const bool has_lines = std::any_of(chain.passes.begin(), chain.passes.end(), [](const FinishPass& pass) {
      return std::holds_alternative<OutlinePass>(pass.effect) || std::holds_alternative<EdgesPass>(pass.effect) ||
             std::holds_alternative<HatchPass>(pass.effect);
    });
    EXPECT_LE(flip->mean, has_lines ? 0.14 : 0.08) << chain.name;
  }
}

TEST(FinishPromises, WhatSticksHardlyFlickers) {
  const std::vector<FinishedChain> chains = StickingChains();
  const auto orbit = MakeOrbit(kRoot, LayersOfChains(chains), 424, 240, 2);
  ASSERT_TRUE(orbit) << orbit.error().message;
  for (const FinishedChain& chain : chains) {
    const auto mean = FlickerOf(chain, *orbit, kScale);
    ASSERT_TRUE(mean) << chain.name;
    // The pictures are small, so that noise counts for more.
    EXPECT_TRUE(IsCalm(chain, *mean, 1.25)) << chain.name << ": " << mean->flicker << ", its floor " << mean->floor;
  }
}

// The share of pixels that differ visibly.
double ShareChanged(const Picture& one, const Picture& other) {
  std::size_t changed = 0;
  for (std::size_t i = 0; i < one.rgba.size(); i += 4) {
    bool differs = false;
    for (std::size_t c = 0; c < 4; ++c) differs |= std::abs(int(one.rgba[i + c]) - int(other.rgba[i + c])) > 5 * 257;
    changed += differs;
  }
  return 4.0 * double(changed) / double(one.rgba.size());
}

TEST(FinishPromises, EachDialShowsInEachPreset) {
  const StillLife& still_life = TheStillLife();
  const GuideSet& guides = *still_life.large.state()->guides;
  const FinishFrame frame{&guides, MeasureFinish(guides), 1.0, 0};  // as `scumble finish` has it
  const auto presets = PresetChains(kRoot);
  ASSERT_TRUE(presets) << presets.error().message;
  EXPECT_GE(presets->size(), 12u);
  for (const FinishedChain& preset : *presets) {
    Picture at_rest = still_life.painted;
    ASSERT_TRUE(ApplyChain(preset, frame, at_rest));
    for (const char* const dial : kDials) {
      for (const double value : {0.0, 1.0}) {
        FinishedChain turned = preset;
        ASSERT_TRUE(TurnFinishDial(turned.passes, std::string(kDialKeys) + dial, value));
        Picture picture = still_life.painted;
        ASSERT_TRUE(ApplyChain(turned, frame, picture));
        const double share = ShareChanged(at_rest, picture);
        EXPECT_GE(share, 0.015) << preset.name << ": " << dial << " = " << value;
      }
    }
  }
}

}  // namespace
}  // namespace scumble
