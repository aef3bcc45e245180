#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/finish/contenders.h"
#include "bench/finish/finish_reports.h"
#include "core/image/stopwatch.h"
#include "core/style/color_ramp.h"
#include "core/style/finish_keys.h"
#include "finish/area/gaussian_rows.h"
#include "tests/support/finish_chains.h"

namespace scumble::bench {
namespace {

// `before` each run, which is not timed.
Spread Timed(
    int runs, const std::function<void()>& work, const std::function<void()>& before = [] {}) {
  std::vector<double> ms;
  for (int i = 0; i < runs; ++i) {
    before();
    Stopwatch watch;
    work();
    ms.push_back(watch.Lap());
  }
  return SpreadOf(std::move(ms));
}

class Table {
 public:
  Table(const FinishWork& work, int runs, std::string part) : work_(work), runs_(runs), part_(std::move(part)) {
    std::printf("%-36s %7s %16s %7s %7s\n", "work", "ms", "quartiles", "copies", "copy");
  }

  // Median milliseconds; 0 if the name has not the part that is wanted.
  double Measure(const std::string& name, const std::vector<FinishPass>& passes) {
    if (name.find(part_) == std::string::npos) return 0.0;
    Picture picture = work_.painted();
    const auto before = [&] {
      picture.rgba = work_.painted().rgba;
      other_.Touch();
    };
    const Spread copy = TimeOfCopies(passes);
    const Spread spread = Timed(
        runs_, [&] { work_.Apply(passes, picture); }, before);
    Print(name, spread, copy);
    return spread.median;
  }

  // Work that changes nothing, beside a copy of the picture.
  void Measure(const std::string& name, const std::function<void()>& run) {
    if (name.find(part_) == std::string::npos) return;
    const Spread spread = Timed(runs_, run, [&] { other_.Touch(); });
    Print(name, spread, TimeOfCopies({}));
  }

  // Another's time, and what part of it ours took, if that was measured. Beside a copy of the picture.
  void Against(const Contender& contender, double ours, const char* name) {
    if (!(ours > 0.0)) return;
    const Spread spread = Timed(std::min(runs_, 5), contender.run);
    Print(contender.name, spread, TimeOfCopies({}));
    std::printf("  %s takes %.2f of that\n", name, ours / spread.median);
  }

 private:
  Spread TimeOfCopies(const std::vector<FinishPass>& passes) {
    Copies copies(work_, passes);
    return Timed(
        runs_, [&] { copies.Run(); }, [&] { other_.Touch(); });
  }

  static void Print(const std::string& name, const Spread& spread, const Spread& copy) {
    std::printf("%-36s %7.1f %7.1f … %6.1f %7.1f %7.1f\n", name.c_str(), spread.median, spread.low, spread.high,
                spread.median / copy.median, copy.median);
  }

  const FinishWork& work_;
  int runs_;
  std::string part_;
  OtherMemory other_;
};

std::vector<FinishPass> Wrapped(ToonPass::Shading shading, ToonPass::Rows rows, int bands) {
  FinishPass pass = *MakeFinishPass("toon");
  auto& one = std::get<ToonPass>(pass.effect);
  one.light = ToonPass::Light::kWrapped, one.shading = shading, one.ramp_rows = rows, one.bands = bands;
  one.ramp_colors = std::make_shared<const ColorRamp>(*ParseColorRamp("#202040 #fff4d0 / #405060 #c0d0e0"));
  return {pass};
}

void MeasureEffects(const Picture& painted, Table& table) {
  for (const FinishEffect& effect : FinishEffects()) {
    if (effect.name == "render") continue;  // needs light paths
    FinishPass pass = *MakeFinishPass(effect.name);
    if (auto* const palette = std::get_if<PalettePass>(&pass.effect)) palette->target = MeasureColors(painted);
    table.Measure(effect.name, {pass});
  }
  using Shading = ToonPass::Shading;
  table.Measure("toon, wrapped", Wrapped(Shading::kPlain, ToonPass::Rows::kDepth, 3));
  table.Measure("toon, gooch, 1 band", Wrapped(Shading::kGooch, ToonPass::Rows::kDepth, 1));
  table.Measure("toon, ramp by depth, 1 band", Wrapped(Shading::kRamp, ToonPass::Rows::kDepth, 1));
  table.Measure("toon, ramp by facing, 3 bands", Wrapped(Shading::kRamp, ToonPass::Rows::kFacing, 3));
  for (const double blur : {4.0, 32.0}) {
    FinishPass depth = *MakeFinishPass("depth");
    std::get<DepthPass>(depth.effect).blur = blur;
    table.Measure("depth, blur " + std::to_string(int(blur)), {depth});
  }
  table.Measure("tones, shadows, depth, grade", FusedPasses());
  for (std::size_t count = 1; count < FusedPasses().size(); ++count) {  // what each further pass adds
    std::vector<FinishPass> passes = FusedPasses();
    passes.resize(count);
    table.Measure("of these the first " + std::to_string(count), passes);
  }
  table.Measure("palette statistics", [&] { MeasureColors(painted); });
  for (const double width : {2.0, 8.0, 32.0})
    table.Measure("outline, width " + std::to_string(int(width)), Outlining(width));
  for (const double soften : {8.0, 64.0}) {
    FinishPass shadows = *MakeFinishPass("shadows");
    std::get<ShadowsPass>(shadows.effect).soften = soften;
    table.Measure("shadows, soften " + std::to_string(int(soften)), {shadows});
  }
}

// Filters and edges, beside others'.
void MeasureFilters(const FinishWork& work, Table& table) {
  using Filter = SmoothPass::Filter;
  using Tone = EdgesPass::Tone;
  const double bilateral = table.Measure("smooth bilateral, radius 3, 4 passes", Smoothing(Filter::kBilateral, 3, 4));
  const double kuwahara = table.Measure("smooth kuwahara, radius 6, 1 pass", Smoothing(Filter::kKuwahara, 6, 1));
  const double guided = table.Measure("smooth guided, radius 4, 1 pass", Smoothing(Filter::kGuided, 4, 1));
  table.Measure("smooth guided, radius 32, 1 pass", Smoothing(Filter::kGuided, 32, 1));
  table.Measure("smooth wavelets, radius 4, 1 pass", Smoothing(Filter::kWavelets, 4, 1, true));
  const double dog = table.Measure("edges of light", Edging(Tone::kLight));
  table.Measure("edges of paint", Edging(Tone::kPaint));
  table.Measure("edges of light, flow 3", Edging(Tone::kLight, 3.0));
  table.Measure("edges of paint, flow 3", Edging(Tone::kPaint, 3.0));
  table.Measure("edges of light, borders", Edging(Tone::kLight, 0.0, true));
  table.Measure("edges of light, borders, flow 3", Edging(Tone::kLight, 3.0, true));

  const std::vector<float> rgb = work.Colors();
  const int width = work.painted().width, height = work.painted().height;
  table.Against(PlainKuwahara(width, height, rgb), kuwahara, "smooth kuwahara");
  for (const Contender& contender : OpenCvContenders(width, height, rgb)) {
    switch (contender.filter) {
      case Contender::Filter::kBilateral:
        table.Against(contender, bilateral, "smooth bilateral, 4 passes");
        break;
      case Contender::Filter::kGaussians:
        table.Against(contender, dog, "edges of light");
        break;
      default:
        table.Against(contender, guided, "smooth guided");
    }
  }
  internal::FloatPlane plane(rgb.size() / 3);
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = rgb[3 * i];
  const auto pair = [&] {
    internal::ForEachGaussianPair(plane, width, height, 2.0 / 2.055, 21.0f, -20.0f, 1.0f, [](int, const float*) {});
  };
  table.Against({Contender::Filter::kGaussians, "two Gaussians of edges alone", pair}, dog, "edges of light");
}

}  // namespace

Status PrintFinishTable(const FinishWork& work, int runs, const std::string& part) {
  Table table(work, runs, part);
  MeasureEffects(work.painted(), table);
  SCUMBLE_ASSIGN(const std::vector<FinishedChain> presets, PresetChains(SCUMBLE_SOURCE_DIR));
  for (const FinishedChain& preset : presets) table.Measure(preset.name, preset.passes);
  MeasureFilters(work, table);
  return Ok();
}

}  // namespace scumble::bench
