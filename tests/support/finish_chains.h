// Every finishing effect and preset, applied as a run applies them, and what they promise of size and time.
#pragma once

#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/style/finish_keys.h"
#include "core/style/finish_preset.h"
#include "core/style/style_file.h"
#include "finish/finish.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "measure/flicker.h"
#include "measure/flip.h"
#include "pipeline/finish_files.h"
#include "pipeline/run_context.h"
#include "transfer/transfer.h"

namespace scumble {

struct FinishedChain {
  std::string name;
  std::vector<FinishPass> passes;
  // Under a slow move of the camera: of the flicker that there would be if the picture moved along with the surfaces.
  // 0: nothing is promised.
  double most_of_floor = 0.0;
};

// The bundled presets, with the files that they name. `root` holds finish/.
inline Expected<std::vector<FinishedChain>> PresetChains(const std::string& root) {
  RunContext context;
  context.data_roots = {root};
  std::vector<FinishedChain> chains;
  for (const std::filesystem::path& file : FindFinishPresets(root + "/finish/presets")) {
    SCUMBLE_ASSIGN(FinishPreset preset, LoadFinishPreset(file));
    SCUMBLE_RETURN_IF_ERROR(ReadFinishFiles(nullptr, context, preset.passes));
    chains.push_back({"preset " + preset.name, std::move(preset.passes)});
  }
  return chains;
}

// Every effect and preset as it comes, and effects whose keys make another one of them. Without `render`, which no
// painting is left of. `palette`: what that effect goes to.
inline Expected<std::vector<FinishedChain>> ChainsToMeasure(const std::string& root, const ColorSpread& palette) {
  std::vector<FinishedChain> chains;
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
  with("hatch, stick", "hatch", [](auto& effect) { std::get<HatchPass>(effect).stick = true; });
  with("smooth, kuwahara 6", "smooth", [](auto& effect) {
    std::get<SmoothPass>(effect).filter = SmoothPass::Filter::kKuwahara, std::get<SmoothPass>(effect).radius = 6.0;
  });
  with("smooth, wavelets", "smooth",
       [](auto& effect) { std::get<SmoothPass>(effect).filter = SmoothPass::Filter::kWavelets; });
  with("hatch, pencil 12", "hatch", [](auto& effect) {
    std::get<HatchPass>(effect).strokes = "pencil", std::get<HatchPass>(effect).spacing = 12.0;
  });
  RunContext context;
  context.data_roots = {root};
  SCUMBLE_RETURN_IF_ERROR(ReadFinishFiles(nullptr, context, chains.back().passes));
  SCUMBLE_ASSIGN(const std::vector<FinishedChain> presets, PresetChains(root));
  chains.insert(chains.end(), presets.begin(), presets.end());
  return chains;
}

// Effects that stick to surfaces, and the same without that, on one flat colour: no paint hides what they do.
inline std::vector<FinishedChain> StickingChains() {
  std::vector<FinishedChain> chains;
  FinishPass fill = *MakeFinishPass("fill");
  std::get<FillPass>(fill.effect).color = {0x8080, 0x9090, 0xb0b0};  // pigment leaves white as it is
  for (const bool stick : {false, true}) {
    const std::string end = stick ? ", stick" : ", no stick";
    const auto add = [&](const std::string& name, FinishPass::Effect effect, double most) {
      FinishPass pass = *MakeFinishPass("outline");
      pass.effect = std::move(effect);
      chains.push_back({name + " on a fill" + end, {fill, std::move(pass)}, stick ? most : 0.0});
    };
    OutlinePass outline;
    outline.wobble = 3.0, outline.stick = stick;
    add("outline, wobble 3", outline, 1.2);
    outline.wobble = 0.0, outline.gaps = 0.4;
    add("outline, gaps 0.4", outline, 1.2);
    HatchPass hatch;
    hatch.stick = stick;
    add("hatch", hatch, 1.2);
    PigmentPass pigment;
    pigment.stick = stick;
    add("pigment", pigment, 0.0);
    pigment.tremor = 0.0;
    add("pigment without tremor", pigment, 0.0);
    // Its dark edge lies along silhouettes, which move over surfaces. Wide, faint clouds hardly have a floor.
    pigment.granulation = 0.0, pigment.edge = 0.0, pigment.turbulence = 2.0, pigment.turbulence_size = 30.0;
    add("pigment, clouds alone", pigment, 1.2);
  }
  return chains;
}

inline LayerSet LayersOfChains(std::span<const FinishedChain> chains) {
  LayerSet layers;
  for (const FinishedChain& chain : chains) {
    for (const FinishPass& pass : chain.passes) layers.Add(RequiredLayers(pass));
  }
  return layers;
}

inline Status ApplyChain(const FinishedChain& chain, const FinishFrame& frame, Picture& picture) {
  std::vector<FinishStep> steps;
  for (const FinishPass& pass : chain.passes) steps.push_back({pass, {}});
  for (const auto stage : {FinishPass::Stage::kPaint, FinishPass::Stage::kSheet})
    SCUMBLE_RETURN_IF_ERROR(ApplyFinish(steps, stage, frame, 0, {}, picture));
  return Ok();
}

// Means of 2 × 2 pixels in the encoding, as paint of partial coverage lies over paper.
inline Picture Halved(const Picture& picture) {
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

// One painting and its guides, and those of half its size.
struct TwoSizes {
  const Picture& painted;
  const GuideSet &large, &small;
  double scale = 1.0;  // of lengths in the large picture
};

// A chain on the large picture, halved; and on the small one.
struct HalfPair {
  Picture halved, small;
};
inline Expected<HalfPair> FinishBoth(const FinishedChain& chain, const TwoSizes& sizes) {
  const FinishMeasures measures = MeasureFinish(sizes.large);
  Picture whole = sizes.painted, small = Halved(sizes.painted);
  SCUMBLE_RETURN_IF_ERROR(ApplyChain(chain, {&sizes.large, measures, sizes.scale, 0}, whole));
  SCUMBLE_RETURN_IF_ERROR(ApplyChain(chain, {&sizes.small, measures, 0.5 * sizes.scale, 0}, small));
  return HalfPair{Halved(whole), std::move(small)};
}

// Successive frames of the still life, painted in oil, the camera going round it by half a degree a frame.
struct Orbit {
  std::vector<GuideSet> guides;
  std::vector<Picture> painted;
};
inline Expected<Orbit> MakeOrbit(const std::string& root, LayerSet layers, int width, int height, int frames) {
  SCUMBLE_ASSIGN(Scene scene, LoadScene(root + "/scenes/stilllife.glb"));
  SCUMBLE_ASSIGN(const PreparedView view, PrepareView(scene, "", {}, double(width) / height, false));
  SCUMBLE_ASSIGN(Style style, LoadStyle(root + "/exemplars/oil", {}));
  style.transfer.coherent = true;
  SCUMBLE_ASSIGN(const PreparedStyle prepared, Prepare(style, height));
  const auto camera_at = [&](int frame) {
    Camera camera = view.camera;
    camera.world_from_camera =
        glm::rotate(glm::dmat4(1.0), glm::radians(0.5 * frame), glm::dvec3(0.0, 1.0, 0.0)) * camera.world_from_camera;
    return camera;
  };
  GuidegenOptions options;
  options.width = width, options.height = height, options.aa = 2;
  options.layers = layers;
  options.layers.Add({Layer::kPref, Layer::kMotion});
  Orbit orbit;
  TransferScratch scratch;
  for (int frame = 0; frame < frames; ++frame) {
    SCUMBLE_ASSIGN(GuidegenResult made,
                   RenderGuides(scene, camera_at(frame), NextFrame{scene, camera_at(frame + 1)}, options));
    TransferOptions transfer;
    transfer.frame = frame;
    SCUMBLE_RETURN_IF_ERROR(Transfer(prepared, made.guides, transfer, scratch, orbit.painted.emplace_back()));
    orbit.guides.push_back(std::move(made.guides));
  }
  return orbit;
}

struct MeanFlicker {
  double flicker = 0.0, floor = 0.0;
};
// Whether what the chain promises holds.
inline bool IsCalm(const FinishedChain& chain, const MeanFlicker& mean, double tolerance = 1.0) {
  return chain.most_of_floor == 0.0 || mean.flicker <= tolerance * chain.most_of_floor * mean.floor;
}

// Of the paintings after that chain. `scale`: of its lengths.
inline Expected<MeanFlicker> FlickerOf(const FinishedChain& chain, const Orbit& orbit, double scale) {
  const auto& [guides, painted] = orbit;
  const FinishMeasures measures = MeasureFinish(guides[0]);
  const auto steps = static_cast<double>(painted.size() - 1);
  MeanFlicker mean;
  Picture last;
  for (std::size_t frame = 0; frame < painted.size(); ++frame) {
    Picture picture = painted[frame];
    if (!chain.passes.empty())
      SCUMBLE_RETURN_IF_ERROR(ApplyChain(chain, {&guides[frame], measures, scale, 0}, picture));
    if (frame > 0) {
      SCUMBLE_ASSIGN(const FlickerReport report, MeasureFlicker(last, picture, guides[frame - 1], &guides[frame]));
      mean.flicker += report.mean / steps, mean.floor += report.floor / steps;
    }
    last = std::move(picture);
  }
  return mean;
}

}  // namespace scumble
