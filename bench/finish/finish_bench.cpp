// The time of each finishing effect at 1080p, as a ratio to a copy of the bytes that it reads and writes, in the same
// run and on the same threads: the picture and the layers that the effect needs. Before each, the caches are emptied: a
// frame's transfer, too, leaves them full of other things. Prints the table of docs/finish.md.
// Where OpenCV is installed (libopencv-imgproc-dev, libopencv-contrib-dev), its filters are timed, too.
//   finish_bench [RUNS [NAME]]    only work whose name has NAME in it
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/finish/rivals.h"
#include "core/image/stopwatch.h"
#include "core/style/color_ramp.h"
#include "core/style/finish_keys.h"
#include "finish/area/gaussian_rows.h"
#include "finish/finish.h"
#include "pipeline/guide_layers.h"
#include "scumble/stylizer.h"
#include "tests/support/finish_chains.h"

namespace scumble {
namespace {

struct Spread {
  double median = 0, least = 0, most = 0;
};

// `before` each run, which is not timed.
template <class Work, class Before>
Spread Timed(int runs, const Work& work, const Before& before) {
  std::vector<double> ms;
  for (int i = 0; i < runs; ++i) {
    before();
    Stopwatch watch;
    work();
    ms.push_back(watch.Lap());
  }
  std::sort(ms.begin(), ms.end());
  return {ms[ms.size() / 2], ms.front(), ms.back()};
}

template <class Work>
Spread Timed(int runs, const Work& work) {
  return Timed(runs, work, [] {});
}

// Fills the caches with something else.
class OtherMemory {
 public:
  void Touch() {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes_.size(), 1 << 20), [&](const auto& part) {
      for (std::size_t i = part.begin(); i < part.end(); i += 64) ++bytes_[i];
    });
  }

 private:
  std::vector<unsigned char> bytes_ = std::vector<unsigned char>(std::size_t(256) << 20);
};

// Copies of one picture and of layers of its size, made by all threads.
class Copies {
 public:
  Copies(const Picture& picture, const GuideSet& guides, OtherMemory& other)
      : guides_(guides), picture_(picture), texels_(picture.rgba), other_(other) {}

  Spread Time(int runs, const LayerSet& layers) {
    std::vector<std::span<const float>> planes;
    for (const LayerInfo& info : AllLayers()) {
      for (int c = 0; layers.Has(info.layer) && c < ChannelCount(info.layer); ++c)
        planes.push_back(guides_.Plane(info.layer, c));
    }
    planes_.resize(std::max(planes_.size(), planes.size()));
    for (std::size_t i = 0; i < planes.size(); ++i) planes_[i].resize(planes[i].size());
    const auto copy = [&] {
      Copy(picture_.rgba.data(), picture_.rgba.size(), texels_.data());
      for (std::size_t i = 0; i < planes.size(); ++i) Copy(planes[i].data(), planes[i].size(), planes_[i].data());
    };
    return Timed(runs, copy, [&] { other_.Touch(); });
  }

 private:
  template <class Value>
  static void Copy(const Value* from, std::size_t count, Value* to) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 18), [&](const auto& part) {
      std::memcpy(to + part.begin(), from + part.begin(), part.size() * sizeof(Value));
    });
  }

  const GuideSet& guides_;
  const Picture& picture_;
  std::vector<std::uint16_t> texels_;
  std::vector<std::vector<float>> planes_;
  OtherMemory& other_;
};

int Run(int runs, const std::string& part) {
  Stylizer stylizer;
  SceneSettings scene;
  scene.file = SCUMBLE_SOURCE_DIR "/scenes/stilllife.glb", scene.width = 1920, scene.height = 1080;
  const auto layers = stylizer.Guides(scene, {Layer::kLuminance, Layer::kShadow, Layer::kAlbedo, Layer::kCosine});
  const auto painted = stylizer.Paint(scene, {.style = SCUMBLE_SOURCE_DIR "/exemplars/oil"});
  if (!layers || !painted) {
    return std::fprintf(stderr, "%s\n", (layers ? painted.error() : layers.error()).message.c_str()), 3;
  }
  const GuideSet& guides = *layers->state()->guides;
  const FinishFrame frame{&guides, MeasureFinish(guides), 1.0, 0};

  OtherMemory other;
  Copies copies(*painted, guides, other);
  const Spread plain = copies.Time(runs, {});
  std::printf("%-36s %7s %16s %7s %7s\n", "work", "ms", "spread", "copies", "copy");
  const auto print = [&](const std::string& name, const Spread& spread, const Spread& copy) {
    std::printf("%-36s %7.1f %7.1f … %6.1f %7.1f %7.1f\n", name.c_str(), spread.median, spread.least, spread.most,
                spread.median / copy.median, copy.median);
  };
  const auto measure = [&](const std::string& name, const std::vector<FinishPass>& passes) {
    if (name.find(part) == std::string::npos) return 0.0;
    std::vector<FinishStep> steps;
    for (const FinishPass& pass : passes) steps.push_back({pass, {}});
    Picture picture = *painted;
    const auto apply = [&] {
      for (const auto stage : {FinishPass::Stage::kPaint, FinishPass::Stage::kSheet}) {
        if (const Status done = ApplyFinish(steps, stage, frame, 0, {}, picture); !done)
          std::fprintf(stderr, "%s: %s\n", name.c_str(), done.error().message.c_str()), std::exit(3);
      }
    };
    LayerSet needed;
    for (const FinishPass& pass : passes) needed.Add(RequiredLayers(pass));
    const Spread copy = copies.Time(runs, needed);
    const Spread spread = Timed(runs, apply, [&] {
      picture.rgba = painted->rgba;
      other.Touch();
    });
    print(name, spread, copy);
    return spread.median;
  };
  const int picture_width = painted->width, picture_height = painted->height;
  for (const FinishEffect& effect : FinishEffects()) {
    if (effect.name == "render") continue;  // needs light paths
    FinishPass pass = *MakeFinishPass(effect.name);
    if (auto* const palette = std::get_if<PalettePass>(&pass.effect)) palette->target = MeasureColors(*painted);
    measure(effect.name, {pass});
  }
  const auto toon = [](ToonPass::Shading shading, ToonPass::Rows rows, int bands) {
    FinishPass pass = *MakeFinishPass("toon");
    auto& one = std::get<ToonPass>(pass.effect);
    one.light = ToonPass::Light::kWrapped, one.shading = shading, one.ramp_rows = rows, one.bands = bands;
    one.ramp_colors = std::make_shared<const ColorRamp>(*ParseColorRamp("#202040 #fff4d0 / #405060 #c0d0e0"));
    return std::vector<FinishPass>{pass};
  };
  measure("toon, wrapped", toon(ToonPass::Shading::kPlain, ToonPass::Rows::kDepth, 3));
  measure("toon, gooch, 1 band", toon(ToonPass::Shading::kGooch, ToonPass::Rows::kDepth, 1));
  measure("toon, ramp by depth, 1 band", toon(ToonPass::Shading::kRamp, ToonPass::Rows::kDepth, 1));
  measure("toon, ramp by facing, 3 bands", toon(ToonPass::Shading::kRamp, ToonPass::Rows::kFacing, 3));
  for (const double blur : {4.0, 32.0}) {
    FinishPass depth = *MakeFinishPass("depth");
    std::get<DepthPass>(depth.effect).blur = blur;
    measure("depth, blur " + std::to_string(int(blur)), {depth});
  }
  measure("tones, shadows, depth, grade",
          {*MakeFinishPass("tones"), *MakeFinishPass("shadows"), *MakeFinishPass("depth"), *MakeFinishPass("grade")});
  for (const double width : {2.0, 8.0, 32.0}) {
    FinishPass outline = *MakeFinishPass("outline");
    std::get<OutlinePass>(outline.effect).width = width;
    measure("outline, width " + std::to_string(int(width)), {outline});
  }
  const auto smooth = [](SmoothPass::Filter filter, double radius, int times, bool borders) {
    FinishPass pass = *MakeFinishPass("smooth");
    auto& one = std::get<SmoothPass>(pass.effect);
    one.filter = filter, one.radius = radius, one.passes = times, one.borders = borders;
    return std::vector<FinishPass>{pass};
  };
  const auto edges = [](EdgesPass::Tone tone, double flow) {
    FinishPass pass = *MakeFinishPass("edges");
    std::get<EdgesPass>(pass.effect).tone = tone, std::get<EdgesPass>(pass.effect).flow = flow;
    return std::vector<FinishPass>{pass};
  };
  using Filter = SmoothPass::Filter;
  const double bilateral = measure("smooth bilateral, radius 3, 4 passes", smooth(Filter::kBilateral, 3, 4, false));
  const double kuwahara = measure("smooth kuwahara, radius 6, 1 pass", smooth(Filter::kKuwahara, 6, 1, false));
  const double guided = measure("smooth guided, radius 4, 1 pass", smooth(Filter::kGuided, 4, 1, false));
  measure("smooth guided, radius 32, 1 pass", smooth(Filter::kGuided, 32, 1, false));
  measure("smooth wavelets, radius 4, 1 pass", smooth(Filter::kWavelets, 4, 1, true));
  const double dog = measure("edges of light", edges(EdgesPass::Tone::kLight, 0.0));
  measure("edges of paint", edges(EdgesPass::Tone::kPaint, 0.0));
  measure("edges of light, flow 3", edges(EdgesPass::Tone::kLight, 3.0));
  measure("edges of paint, flow 3", edges(EdgesPass::Tone::kPaint, 3.0));
  for (const double flow : {0.0, 3.0}) {
    auto within = edges(EdgesPass::Tone::kLight, flow);
    std::get<EdgesPass>(within[0].effect).borders = true;
    measure("edges of light, borders" + std::string(flow > 0.0 ? ", flow 3" : ""), within);
  }
  for (const double soften : {8.0, 64.0}) {
    FinishPass shadows = *MakeFinishPass("shadows");
    std::get<ShadowsPass>(shadows.effect).soften = soften;
    measure("shadows, soften " + std::to_string(int(soften)), {shadows});
  }
  const auto presets = PresetChains(SCUMBLE_SOURCE_DIR);
  if (!presets) return std::fprintf(stderr, "%s\n", presets.error().message.c_str()), 3;
  for (const FinishedChain& preset : *presets) measure(preset.name, preset.passes);
  std::vector<float> rgb;
  for (std::size_t i = 0; i < painted->rgba.size(); ++i)
    if (i % 4 != 3) rgb.push_back(static_cast<float>(painted->rgba[i]) / 65535.0f);
  const auto against = [&](const Rival& rival, double ours, const char* name) {
    if (!(ours > 0.0)) return;
    const Spread spread = Timed(std::min(runs, 5), rival.run);
    print(rival.name, spread, plain);
    std::printf("  %s takes %.2f of that\n", name, ours / spread.median);
  };
  against(PlainKuwahara(picture_width, picture_height, rgb), kuwahara, "smooth kuwahara");
  for (const Rival& rival : OpenCvRivals(picture_width, picture_height, rgb)) {
    const bool is_pair = rival.filter == Rival::Filter::kGaussians;
    const double ours = is_pair ? dog : rival.filter == Rival::Filter::kGuided ? guided : bilateral;
    against(rival, ours,
            is_pair                                  ? "edges of light"
            : rival.filter == Rival::Filter::kGuided ? "smooth guided"
                                                     : "smooth bilateral, 4 passes");
  }
  if (dog > 0.0) {
    internal::FloatPlane plane(rgb.size() / 3);
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = rgb[3 * i];
    const Spread pair = Timed(runs, [&] {
      internal::ForEachGaussianPair(plane, picture_width, picture_height, 2.0 / 2.055, 21.0f, -20.0f, 1.0f,
                                    [](int, const float*) {});
    });
    print("two Gaussians of edges alone", pair, plain);
  }
  return 0;
}

}  // namespace
}  // namespace scumble

int main(int count, char** arguments) {
  return scumble::Run(count > 1 ? std::max(1, std::atoi(arguments[1])) : 9, count > 2 ? arguments[2] : "");
}
