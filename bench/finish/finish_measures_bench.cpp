// What finishing effects promise of size and time, measured: prints two tables; exit code 1 if a promise is broken.
//   half size: FLIP between an effect at 540 lines and the effect at 1080 lines, halved. Both see one painting.
//   flicker: of effects under a slow move of the camera, beside that of the painting alone (measure/compare/flicker.h).
//   finish_measures_bench [flicker | half [NAME [FOLDER]]]
// With NAME, only chains whose names contain it are measured; `half` puts both pictures of each into FOLDER.
#include <cstdio>
#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "finish/finish.h"
#include "pipeline/guide_layers.h"
#include "scumble/stylizer.h"
#include "tests/support/finish_chains.h"

namespace scumble {
namespace {

constexpr double kMostFlip = 0.05;

// Both return whether every promise holds.
Expected<bool> MeasureHalfSize(const std::string& part, const std::string& folder) {
  std::printf("| effect, 540 lines against 1080 halved | stilllife, FLIP | snail |\n|---|---|---|\n");
  std::vector<std::string> rows;
  bool holds = true;
  for (const char* const name : {"stilllife", "snail"}) {
    Stylizer stylizer;
    SceneSettings large;
    large.file = std::string(SCUMBLE_SOURCE_DIR "/scenes/") + name + ".glb", large.width = 1920, large.height = 1080;
    large.coverage_samples = 4;
    SceneSettings small = large;
    small.width = 960, small.height = 540;
    SCUMBLE_ASSIGN(const Picture painted, stylizer.Paint(large, {.style = SCUMBLE_SOURCE_DIR "/exemplars/oil"}));
    SCUMBLE_ASSIGN(std::vector<FinishedChain> chains, ChainsToMeasure(SCUMBLE_SOURCE_DIR, MeasureColors(painted)));
    std::erase_if(chains, [&](const FinishedChain& chain) { return chain.name.find(part) == std::string::npos; });
    const LayerSet layers = LayersOfChains(chains);
    SCUMBLE_ASSIGN(const GuideLayers of_large, stylizer.Guides(large, layers));
    SCUMBLE_ASSIGN(const GuideLayers of_small, stylizer.Guides(small, layers));
    const TwoSizes sizes{painted, *of_large.state()->guides, *of_small.state()->guides};
    for (std::size_t i = 0; i < chains.size(); ++i) {
      SCUMBLE_ASSIGN(const HalfPair pair, FinishBoth(chains[i], sizes));
      SCUMBLE_ASSIGN(const FlipReport report, MeasureFlip(pair.halved, pair.small));
      if (!folder.empty()) {
        const std::string file = folder + "/" + name + " " + chains[i].name;
        SCUMBLE_RETURN_IF_ERROR(WritePicture(file + ", halved.png", pair.halved, {8, 1}));
        SCUMBLE_RETURN_IF_ERROR(WritePicture(file + ", 540 lines.png", pair.small, {8, 1}));
      }
      const bool is_kept = report.mean <= kMostFlip;
      holds = holds && is_kept;
      char text[32];
      std::snprintf(text, sizeof text, " %.3f%s |", report.mean, is_kept ? "" : " !");
      if (rows.size() <= i) rows.push_back("| " + chains[i].name + " |");
      rows[i] += text;
    }
  }
  for (const std::string& row : rows) std::printf("%s\n", row.c_str());
  return holds;
}

constexpr int kFrames = 7;

Expected<bool> MeasureFlickerOfEffects(const std::string& part) {
  SCUMBLE_ASSIGN(std::vector<FinishedChain> chains, ChainsToMeasure(SCUMBLE_SOURCE_DIR, {}));
  const std::vector<FinishedChain> sticking = StickingChains();
  chains.insert(chains.end(), sticking.begin(), sticking.end());
  std::erase_if(chains, [&](const FinishedChain& chain) { return chain.name.find(part) == std::string::npos; });
  SCUMBLE_ASSIGN(const Orbit orbit, MakeOrbit(SCUMBLE_SOURCE_DIR, LayersOfChains(chains), 960, 540, kFrames));
  const ColorSpread spread = MeasureColors(orbit.painted[0]);
  chains.insert(chains.begin(), {"the painting alone", {}});
  std::printf("| effect | flicker | floor | flicker : floor | : painting |\n|---|---|---|---|---|\n");
  double alone = 0.0;
  bool holds = true;
  for (FinishedChain& chain : chains) {
    for (FinishPass& pass : chain.passes) {
      if (auto* const one = std::get_if<PalettePass>(&pass.effect)) one->target = spread;
    }
    SCUMBLE_ASSIGN(const MeanFlicker mean, FlickerOf(chain, orbit, 0.5));
    if (alone == 0.0) alone = mean.flicker;
    const bool is_kept = IsCalm(chain, mean, alone);
    holds = holds && is_kept;
    std::printf("| %s | %.2f | %.2f | %.2f | %.2f%s |\n", chain.name.c_str(), mean.flicker, mean.floor,
                mean.flicker / mean.floor, mean.flicker / alone, is_kept ? "" : " !");
    std::fflush(stdout);
  }
  return holds;
}

}  // namespace
}  // namespace scumble

int main(int count, char** arguments) {
  const std::string which = count > 1 ? arguments[1] : "", part = count > 2 ? arguments[2] : "";
  scumble::Expected<bool> sizes = true, time = true;
  if (which != "flicker") sizes = scumble::MeasureHalfSize(part, count > 3 ? arguments[3] : "");
  if (sizes && which != "half") time = scumble::MeasureFlickerOfEffects(part);
  for (const auto* const part_done : {&sizes, &time}) {
    if (!*part_done) return std::fprintf(stderr, "%s\n", part_done->error().message.c_str()), 3;
  }
  if (*sizes && *time) return 0;
  return std::fprintf(stderr, "what has ! breaks a promise of docs/finish.md\n"), 1;
}
