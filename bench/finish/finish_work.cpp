#include "bench/finish/finish_work.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/style/finish_keys.h"
#include "pipeline/api/guide_layers.h"

namespace scumble::bench {
namespace {

template <class Value>
void Copy(const Value* from, std::size_t count, Value* to) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 18), [&](const auto& part) {
    std::memcpy(to + part.begin(), from + part.begin(), part.size() * sizeof(Value));
  });
}

}  // namespace

Expected<FinishWork> FinishWork::Make(int width, int height) {
  Stylizer stylizer;
  SceneSettings scene;
  scene.file = SCUMBLE_SOURCE_DIR "/scenes/stilllife.glb", scene.width = width, scene.height = height;
  SCUMBLE_ASSIGN(GuideLayers layers,
                 stylizer.Guides(scene, {Layer::kLuminance, Layer::kShadow, Layer::kAlbedo, Layer::kCosine}));
  SCUMBLE_ASSIGN(Picture painted, stylizer.Paint(scene, {.style = SCUMBLE_SOURCE_DIR "/exemplars/oil"}));
  return FinishWork(std::move(layers), std::move(painted));
}

FinishWork::FinishWork(GuideLayers layers, Picture painted)
    : layers_(std::move(layers)), painted_(std::move(painted)), measures_(MeasureFinish(guides())) {}

const GuideSet& FinishWork::guides() const { return *layers_.state()->guides; }

std::vector<float> FinishWork::Colors() const {
  std::vector<float> rgb;
  for (std::size_t i = 0; i < painted_.rgba.size(); ++i)
    if (i % 4 != 3) rgb.push_back(static_cast<float>(painted_.rgba[i]) / 65535.0f);
  return rgb;
}

void FinishWork::Apply(const std::vector<FinishPass>& passes, Picture& picture) const {
  const FinishFrame frame{&guides(), measures_, 1.0, 0};
  std::vector<FinishStep> steps;
  for (const FinishPass& pass : passes) steps.push_back({pass, {}});
  for (const auto stage : {FinishPass::Stage::kPaint, FinishPass::Stage::kSheet}) {
    if (const Status done = ApplyFinish(steps, stage, frame, 0, {}, picture); !done)
      std::fprintf(stderr, "%s: %s\n", passes[0].name.c_str(), done.error().message.c_str()), std::exit(3);
  }
}

void OtherMemory::Touch() {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes_.size(), 1 << 20), [&](const auto& part) {
    for (std::size_t i = part.begin(); i < part.end(); i += 64) ++bytes_[i];
  });
}

Copies::Copies(const FinishWork& work, const std::vector<FinishPass>& passes)
    : picture_(work.painted()), texels_(picture_.rgba.size()) {
  LayerSet layers;
  for (const FinishPass& pass : passes) layers.Add(RequiredLayers(pass));
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; layers.Has(info.layer) && c < ChannelCount(info.layer); ++c)
      planes_.push_back(work.guides().Plane(info.layer, c));
  }
  for (const auto& plane : planes_) copies_.emplace_back(plane.size());
}

void Copies::Run() {
  Copy(picture_.rgba.data(), picture_.rgba.size(), texels_.data());
  for (std::size_t i = 0; i < planes_.size(); ++i) Copy(planes_[i].data(), planes_[i].size(), copies_[i].data());
}

std::vector<FinishPass> Outlining(double width) {
  FinishPass pass = *MakeFinishPass("outline");
  std::get<OutlinePass>(pass.effect).width = width;
  return {pass};
}

std::vector<FinishPass> Smoothing(SmoothPass::Filter filter, double radius, int passes, bool borders) {
  FinishPass pass = *MakeFinishPass("smooth");
  auto& smooth = std::get<SmoothPass>(pass.effect);
  smooth.filter = filter, smooth.radius = radius, smooth.passes = passes, smooth.borders = borders;
  return {pass};
}

std::vector<FinishPass> Edging(EdgesPass::Tone tone, double flow, bool borders) {
  FinishPass pass = *MakeFinishPass("edges");
  auto& edges = std::get<EdgesPass>(pass.effect);
  edges.tone = tone, edges.flow = flow, edges.borders = borders;
  return {pass};
}

std::vector<FinishPass> FusedPasses() {
  return {*MakeFinishPass("tones"), *MakeFinishPass("shadows"), *MakeFinishPass("depth"), *MakeFinishPass("grade")};
}

}  // namespace scumble::bench
