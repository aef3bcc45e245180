// What finishing effects promise of size and time, measured: prints two tables; exit code 1 if a promise is broken.
//   half size: FLIP between an effect at 540 lines and the effect at 1080 lines, halved. Both see one painting. On the
//   ball paint fills the frame; there the effect is measured by itself, too, on paint of 540 lines at both sizes.
//   flicker: of effects under a slow move of the camera, beside its floor (measure/flicker.h) and that of the
//   painting alone. What sticks to surfaces is measured on one flat colour.
//   finish_measures_bench [flicker | half [NAME [FOLDER]]]
// With NAME, only chains whose names contain it are measured; `half` puts both pictures of each into FOLDER.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "finish/finish.h"
#include "pipeline/api/guide_layers.h"
#include "scumble/stylizer.h"
#include "tests/support/finish_chains.h"

namespace scumble {
namespace {

// What half the size is measured on. Paint has detail that half the size cannot hold. Effects that are not linear
// (tones, kuwahara) show it, the more of it the more paint there is. Doubled paint has none; but wavelets, whose range
// follows the size, expect it.
constexpr double kMostFlip = 0.05;
struct Subject {
  const char* name;
  const char* scene;
  bool is_doubled;  // the large painting is the small one with each pixel four times: no detail is lost
  double most;
};
constexpr Subject kSubjects[] = {{"stilllife", "stilllife", false, kMostFlip},
                                 {"snail", "snail", false, kMostFlip},
                                 {"ball", "ball", false, 0.07},
                                 {"ball, paint of 540 lines", "ball", true, 0.06}};

Picture Doubled(const Picture& small) {
  Picture large(2 * small.width, 2 * small.height);
  for (int y = 0; y < large.height; ++y) {
    for (int x = 0; x < large.width; ++x) std::copy_n(small.At(x / 2, y / 2), 4, large.At(x, y));
  }
  return large;
}

// Both return whether every promise holds.
Expected<bool> MeasureHalfSize(const std::string& part, const std::string& folder) {
  std::string head = "| FLIP of 540 lines against 1080 halved |", rule = "|---|";
  for (const Subject& subject : kSubjects) head += std::string(" ") + subject.name + " |", rule += "---|";
  std::vector<std::string> rows;
  bool holds = true;
  for (const Subject& subject : kSubjects) {
    Stylizer stylizer;
    SceneSettings large;
    large.file = std::string(SCUMBLE_SOURCE_DIR "/scenes/") + subject.scene + ".glb", large.width = 1920,
    large.height = 1080;
    large.coverage_samples = 4;
    SceneSettings small = large;
    small.width = 960, small.height = 540;
    SCUMBLE_ASSIGN(Picture painted, stylizer.Paint(large, {.style = SCUMBLE_SOURCE_DIR "/exemplars/oil"}));
    if (subject.is_doubled) painted = Doubled(Halved(painted));
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
        const std::string file = folder + "/" + subject.name + " " + chains[i].name;
        SCUMBLE_RETURN_IF_ERROR(WritePicture(file + ", halved.png", pair.halved, {8, 1}));
        SCUMBLE_RETURN_IF_ERROR(WritePicture(file + ", 540 lines.png", pair.small, {8, 1}));
      }
      const bool is_kept = report.mean <= subject.most;
      holds = holds && is_kept;
      char text[32];
      std::snprintf(text, sizeof text, " %.3f%s |", report.mean, is_kept ? "" : " !");
      if (rows.size() <= i) rows.push_back("| " + chains[i].name + " |");
      rows[i] += text;
    }
  }
  std::printf("%s\n%s\n", head.c_str(), rule.c_str());
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
    const bool is_kept = IsCalm(chain, mean);
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
