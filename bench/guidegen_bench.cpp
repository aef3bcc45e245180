// Guides against the minimum cost of their rays (bare_embree.h), in one run: 1920 × 1080 pixels, 100,002 triangles,
// every pixel covered. "Guides" is all of RenderGuides but the hierarchy, the planes' memory included.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bench/bare_embree.h"
#include "core/image/stopwatch.h"
#include "guidegen/guidegen.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

constexpr int kWidth = 1920;
constexpr int kHeight = 1080;
constexpr double kDistance = 3.0;
constexpr double kAngle = 40.0;

// Ten spheres of 10,000 triangles each, before a wall.
Scene BenchScene() {
  Scene scene = SceneOf(BallMesh(50));
  scene.instances.clear();
  for (int i = 0; i < 10; ++i) {
    scene.instances.push_back({"ball" + std::to_string(i), 0,
                               glm::scale(Moved(-1.6 + 0.8 * (i % 5), i < 5 ? 0.5 : -0.5, 0.0), glm::dvec3(0.45))});
  }
  AddObject(scene, "wall", QuadMesh(), glm::scale(Moved(0, 0, -1), glm::dvec3(10.0)));
  scene.lights.push_back(PointLight({-2, 3, 4}, 20.0));
  return scene;
}

BareEmbree Bare(const Scene& scene) {
  return BareEmbree(scene, kWidth, kHeight, kDistance, std::tan(glm::radians(kAngle) / 2.0));
}

// Processor time of all threads: other programs affect it less than wall-clock time.
double ProcessMilliseconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

struct Times {
  double wall_ms = 0.0;
  double cpu_ms = 0.0;
};

template <class Work>
Times TimeOf(const Work& work) {
  const double cpu = ProcessMilliseconds();
  Stopwatch watch;
  work();
  return {watch.Lap(), ProcessMilliseconds() - cpu};
}

BareKind FastestKind(const BareEmbree& bare, float* depth) {
  BareKind best = kBareKinds[0];
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 2; ++round) {
    for (const BareKind kind : kBareKinds) {
      const double time = TimeOf([&] { bare.Cast(kind, 1, depth); }).cpu_ms;
      if (time < least) least = time, best = kind;
    }
  }
  return best;
}

Expected<GuidegenResult> Guides(const Scene& scene, GuidegenOptions options, int threads) {
  options.threads = threads;
  return RenderGuides(scene, FrontCamera(kDistance, kAngle), options);
}

// Arguments: threads, aa. Counters: *_cpu are thread times in ms, the others wall-clock times. guides_cpu is a frame's
// less that of a frame of 16 × 16 pixels, whose rays cost nothing beside its hierarchy.
void RunGuides(benchmark::State& state, const LayerSet& layers) {
  const int threads = int(state.range(0));
  const Scene scene = BenchScene();
  const BareEmbree bare = Bare(scene);
  std::vector<float> depth(std::size_t(kWidth) * kHeight);
  const BareKind kind = FastestKind(bare, depth.data());
  state.SetLabel(std::string("bare: ") + NameOf(kind));
  GuidegenOptions options = Sized(kWidth, kHeight, layers);
  options.aa = int(state.range(1));
  GuidegenOptions small = options;
  small.width = small.height = 16;
  Times bare_time, guide_time, build_time;
  double build_ms = 0.0;
  double render_ms = 0.0;
  std::size_t rays = 0;
  const auto add = [](const Times& from, Times& to) { to.wall_ms += from.wall_ms, to.cpu_ms += from.cpu_ms; };
  for (auto _ : state) {
    add(TimeOf([&] { bare.Cast(kind, threads, depth.data()); }), bare_time);
    std::string fault;
    add(TimeOf([&] {
          const auto result = Guides(scene, options, threads);
          if (!result) return void(fault = result.error().message);
          build_ms += result->build_ms, render_ms += result->render_ms;
          rays = result->rays.primary + result->rays.coverage + result->rays.shadow;
        }),
        guide_time);
    if (!fault.empty()) return state.SkipWithError(fault.c_str());
    add(TimeOf([&] { benchmark::DoNotOptimize(Guides(scene, small, threads).ok()); }), build_time);
  }
  const double frames = double(state.iterations());
  const auto mean = [&](double sum) { return benchmark::Counter(sum / frames); };
  state.counters["bare_ms"] = mean(bare_time.wall_ms);
  state.counters["bare_cpu"] = mean(bare_time.cpu_ms);
  state.counters["build_ms"] = mean(build_ms);
  state.counters["guides_ms"] = mean(render_ms);
  state.counters["guides_cpu"] = mean(guide_time.cpu_ms - build_time.cpu_ms);
  state.counters["ratio"] = benchmark::Counter(render_ms / bare_time.wall_ms);
  state.counters["ratio_cpu"] = benchmark::Counter((guide_time.cpu_ms - build_time.cpu_ms) / bare_time.cpu_ms);
  state.counters["fps"] = benchmark::Counter(1e3 * frames / render_ms);
  state.counters["fps_with_build"] = benchmark::Counter(1e3 * frames / guide_time.wall_ms);
  state.counters["Mray"] = benchmark::Counter(double(rays) * 1e-6);
}

void BM_GuidesAlwaysWritten(benchmark::State& state) { RunGuides(state, {}); }
void BM_GuidesPositionAlbedo(benchmark::State& state) { RunGuides(state, {Layer::kPosition, Layer::kAlbedo}); }
void BM_GuidesLuminance(benchmark::State& state) { RunGuides(state, {Layer::kLuminance}); }
void BM_GuidesWithShadowRays(benchmark::State& state) { RunGuides(state, {Layer::kLuminance, Layer::kShadow}); }

// Arguments: threads, kind. The acceleration structure is built before the measurement.
void BM_BareEmbree(benchmark::State& state) {
  const BareEmbree bare = Bare(BenchScene());
  std::vector<float> depth(std::size_t(kWidth) * kHeight);
  const BareKind kind = kBareKinds[std::size_t(state.range(1))];
  state.SetLabel(NameOf(kind));
  for (auto _ : state) bare.Cast(kind, int(state.range(0)), depth.data());
  state.counters["Mray/s"] =
      benchmark::Counter(double(depth.size()) * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
}

void BM_SphereGuides(benchmark::State& state) {
  SphereOptions options;
  options.size = int(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(RenderSphereGuides(options).ok());
}

#define SCUMBLE_REPEATED \
  Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime()->Repetitions(7)->ReportAggregatesOnly(true)
BENCHMARK(BM_BareEmbree)->SCUMBLE_REPEATED->ArgsProduct({{1}, {0, 1, 2, 3}})->Args({2, 3});
BENCHMARK(BM_GuidesAlwaysWritten)->SCUMBLE_REPEATED->Args({1, 1})->Args({2, 1})->Args({2, 4});
BENCHMARK(BM_GuidesPositionAlbedo)->SCUMBLE_REPEATED->Args({1, 1});
BENCHMARK(BM_GuidesLuminance)->SCUMBLE_REPEATED->Args({1, 1})->Args({2, 1});
BENCHMARK(BM_GuidesWithShadowRays)->SCUMBLE_REPEATED->Args({2, 1});
BENCHMARK(BM_SphereGuides)->SCUMBLE_REPEATED->Arg(512);

}  // namespace
}  // namespace scumble::testing

BENCHMARK_MAIN();
