// What finishing effects promise of size and time, measured: prints two tables.
//   half size: FLIP between an effect at 540 lines and the effect at 1080 lines, halved. Both see one painting.
//   flicker: of effects under a slow move of the camera, beside that of the painting alone (measure/compare/flicker.h).
//   finish_measures [flicker | half [NAME [FOLDER]]]
// With NAME, `half` measures only chains whose names contain it, and puts both pictures of each into FOLDER.
#include <algorithm>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/finish_file.h"
#include "core/style/finish_keys.h"
#include "core/style/style_file.h"
#include "finish/finish.h"
#include "guidegen/guidegen.h"
#include "guidegen/load/load_scene.h"
#include "guidegen/scene/framing.h"
#include "measure/compare/flicker.h"
#include "measure/compare/flip.h"
#include "pipeline/guide_layers.h"
#include "scumble/stylizer.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

struct Chain {
  std::string name;
  std::vector<FinishPass> passes;
};

// Every effect and preset as it comes. Without `render`, which no painting is left of.
std::vector<Chain> ChainsToMeasure(const ColorSpread& palette) {
  std::vector<Chain> chains;
  for (const FinishEffect& effect : FinishEffects()) {
    if (effect.name == "render") continue;
    FinishPass pass = *MakeFinishPass(effect.name);
    if (auto* const one = std::get_if<PalettePass>(&pass.effect)) one->target = palette;
    chains.push_back({effect.name, {pass}});
  }
  const auto with = [&](const std::string& name, const std::string& effect, const auto& set) {
    FinishPass pass = *MakeFinishPass(effect);
    set(pass.effect);
    chains.push_back({name, {pass}});
  };
  with("depth, blur 12", "depth", [](auto& effect) { std::get<DepthPass>(effect).blur = 12.0; });
  with("shadows, soften 8", "shadows", [](auto& effect) { std::get<ShadowsPass>(effect).soften = 8.0; });
  with("edges, flow 3", "edges", [](auto& effect) { std::get<EdgesPass>(effect).flow = 3.0; });
  with("edges, borders", "edges", [](auto& effect) { std::get<EdgesPass>(effect).borders = true; });
  with("smooth, kuwahara 6", "smooth", [](auto& effect) {
    std::get<SmoothPass>(effect).filter = SmoothPass::Filter::kKuwahara, std::get<SmoothPass>(effect).radius = 6.0;
  });
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(SCUMBLE_SOURCE_DIR "/finish/presets"))
    files.push_back(file.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    if (const auto preset = LoadFinishPreset(file)) chains.push_back({"preset " + preset->name, preset->passes});
  }
  return chains;
}

Status ApplyChain(const Chain& chain, const FinishFrame& frame, Picture& picture) {
  std::vector<FinishStep> steps;
  for (const FinishPass& pass : chain.passes) steps.push_back({pass, {}});
  for (const auto stage : {FinishPass::Stage::kPaint, FinishPass::Stage::kSheet})
    SCUMBLE_RETURN_IF_ERROR(ApplyFinish(steps, stage, frame, 0, {}, picture));
  return Ok();
}

// Means of 2 × 2 pixels in the encoding, as paint of partial coverage lies over paper.
Picture Halved(const Picture& picture) {
  Picture half(picture.width / 2, picture.height / 2);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      double sum[4] = {};
      for (int k = 0; k < 4; ++k) {
        const std::uint16_t* const texel = picture.At(2 * x + k % 2, 2 * y + k / 2);
        for (int c = 0; c < 3; ++c) sum[c] += double(texel[c]) * texel[3];
        sum[3] += texel[3];
      }
      if (!(sum[3] > 0.0)) continue;
      for (int c = 0; c < 3; ++c) half.At(x, y)[c] = static_cast<std::uint16_t>(sum[c] / sum[3] + 0.5);
      half.At(x, y)[3] = static_cast<std::uint16_t>(sum[3] / 4.0 + 0.5);
    }
  }
  return half;
}

Status MeasureHalfSize(const std::string& part, const std::string& folder) {
  std::printf("| effect, 540 lines against 1080 halved | stilllife, FLIP | snail |\n|---|---|---|\n");
  std::vector<std::string> rows;
  for (const char* const name : {"stilllife", "snail"}) {
    Stylizer stylizer;
    SceneSettings large;
    large.file = std::string(SCUMBLE_SOURCE_DIR "/scenes/") + name + ".glb", large.width = 1920, large.height = 1080;
    large.coverage_samples = 4;
    SceneSettings small = large;
    small.width = 960, small.height = 540;
    SCUMBLE_ASSIGN(const Picture painted, stylizer.Paint(large, {.style = SCUMBLE_SOURCE_DIR "/exemplars/oil"}));
    std::vector<Chain> chains = ChainsToMeasure(MeasureColors(painted));
    std::erase_if(chains, [&](const Chain& chain) { return chain.name.find(part) == std::string::npos; });
    LayerSet layers;
    for (const Chain& chain : chains) {
      for (const FinishPass& pass : chain.passes) layers.Add(RequiredLayers(pass));
    }
    SCUMBLE_ASSIGN(const GuideLayers of_large, stylizer.Guides(large, layers));
    SCUMBLE_ASSIGN(const GuideLayers of_small, stylizer.Guides(small, layers));
    const GuideSet &large_guides = *of_large.state()->guides, &small_guides = *of_small.state()->guides;
    const FinishMeasures measures = MeasureFinish(large_guides);
    for (std::size_t i = 0; i < chains.size(); ++i) {
      Picture whole = painted, half = Halved(painted);
      SCUMBLE_RETURN_IF_ERROR(ApplyChain(chains[i], {&large_guides, measures, 1.0, 0}, whole));
      SCUMBLE_RETURN_IF_ERROR(ApplyChain(chains[i], {&small_guides, measures, 0.5, 0}, half));
      const Picture halved = Halved(whole);
      SCUMBLE_ASSIGN(const FlipReport report, MeasureFlip(halved, half));
      if (!folder.empty()) {
        const std::string file = folder + "/" + name + " " + chains[i].name;
        SCUMBLE_RETURN_IF_ERROR(WritePicture(file + ", halved.png", halved, {8, 1}));
        SCUMBLE_RETURN_IF_ERROR(WritePicture(file + ", 540 lines.png", half, {8, 1}));
      }
      char text[32];
      std::snprintf(text, sizeof text, " %.3f%s |", report.mean, report.mean > 0.05 ? " !" : "");
      if (rows.size() <= i) rows.push_back("| " + chains[i].name + " |");
      rows[i] += text;
    }
  }
  for (const std::string& row : rows) std::printf("%s\n", row.c_str());
  return Ok();
}

constexpr int kFrames = 7;

// The still life, the camera going round it by half a degree a frame.
Expected<std::vector<GuideSet>> TurningGuides(const LayerSet& layers) {
  SCUMBLE_ASSIGN(Scene scene, LoadScene(SCUMBLE_SOURCE_DIR "/scenes/stilllife.glb"));
  SCUMBLE_ASSIGN(const PreparedView view, PrepareView(scene, "", {}, 16.0 / 9.0, false));
  const auto camera_at = [&](int frame) {
    Camera camera = view.camera;
    camera.world_from_camera =
        glm::rotate(glm::dmat4(1.0), glm::radians(0.5 * frame), glm::dvec3(0.0, 1.0, 0.0)) * camera.world_from_camera;
    return camera;
  };
  GuidegenOptions options;
  options.width = 960, options.height = 540, options.aa = 2;
  options.layers = layers;
  options.layers.Add({Layer::kPref, Layer::kMotion});
  std::vector<GuideSet> guides;
  for (int frame = 0; frame < kFrames; ++frame) {
    SCUMBLE_ASSIGN(GuidegenResult made,
                   RenderGuides(scene, camera_at(frame), NextFrame{scene, camera_at(frame + 1)}, options));
    guides.push_back(std::move(made.guides));
  }
  return guides;
}

Status MeasureFlickerOfEffects() {
  SCUMBLE_ASSIGN(Style style, LoadStyle(SCUMBLE_SOURCE_DIR "/exemplars/oil", {}));
  style.transfer.coherent = true;
  SCUMBLE_ASSIGN(const PreparedStyle prepared, Prepare(style, 540));
  std::vector<Chain> chains = ChainsToMeasure({});
  const auto with = [&](const std::string& name, FinishPass::Effect effect) {
    FinishPass pass = *MakeFinishPass("outline");
    pass.effect = std::move(effect);
    chains.push_back({name, {pass}});
  };
  for (const bool stick : {false, true}) {
    const std::string end = stick ? ", stick" : ", no stick";
    OutlinePass outline;
    outline.wobble = 3.0, outline.stick = stick;
    with("outline, wobble 3" + end, outline);
    PigmentPass pigment;
    pigment.stick = stick;
    with("pigment" + end, pigment);
    pigment.tremor = 0.0;
    with("pigment without tremor" + end, pigment);
    pigment.granulation = 0.0;
    with("pigment without tremor and grains" + end, pigment);
  }
  LayerSet layers;
  for (const Chain& chain : chains) {
    for (const FinishPass& pass : chain.passes) layers.Add(RequiredLayers(pass));
  }
  SCUMBLE_ASSIGN(const std::vector<GuideSet> guides, TurningGuides(layers));
  std::vector<Picture> painted(kFrames);
  TransferScratch scratch;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    TransferOptions options;
    options.frame = static_cast<int>(frame);
    SCUMBLE_RETURN_IF_ERROR(Transfer(prepared, guides[frame], options, scratch, painted[frame]));
  }
  const FinishMeasures measures = MeasureFinish(guides[0]);
  const ColorSpread spread = MeasureColors(painted[0]);
  chains.insert(chains.begin(), {"the painting alone", {}});
  std::printf("| effect | flicker | floor | flicker : floor | : painting |\n|---|---|---|---|---|\n");
  double alone = 0.0;
  for (Chain& chain : chains) {
    for (FinishPass& pass : chain.passes) {
      if (auto* const one = std::get_if<PalettePass>(&pass.effect)) one->target = spread;
    }
    Picture last;
    double flicker = 0.0, floor = 0.0;
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      Picture picture = painted[frame];
      if (!chain.passes.empty())
        SCUMBLE_RETURN_IF_ERROR(ApplyChain(chain, {&guides[frame], measures, 0.5, 0}, picture));
      if (frame > 0) {
        SCUMBLE_ASSIGN(const FlickerReport report, MeasureFlicker(last, picture, guides[frame - 1], &guides[frame]));
        flicker += report.mean / (kFrames - 1), floor += report.floor / (kFrames - 1);
      }
      last = std::move(picture);
    }
    if (alone == 0.0) alone = flicker;
    std::printf("| %s | %.2f | %.2f | %.2f | %.2f |\n", chain.name.c_str(), flicker, floor, flicker / floor,
                flicker / alone);
    std::fflush(stdout);
  }
  return Ok();
}

}  // namespace
}  // namespace scumble

int main(int count, char** arguments) {
  const std::string which = count > 1 ? arguments[1] : "", part = count > 2 ? arguments[2] : "";
  scumble::Status done = scumble::Ok();
  if (which != "flicker") done = scumble::MeasureHalfSize(part, count > 3 ? arguments[3] : "");
  if (done && which != "half") done = scumble::MeasureFlickerOfEffects();
  if (!done) return std::fprintf(stderr, "%s\n", done.error().message.c_str()), 1;
  return 0;
}
