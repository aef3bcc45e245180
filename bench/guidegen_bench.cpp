// Guides against the least that their rays could cost: a bare Embree loop over the same triangles and the same rays,
// which keeps the hits' distances and nothing else. 1920 × 1080 pixels, about 100,000 triangles, most pixels covered.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "guidegen/guidegen.h"
#include "tests/guidegen_scenes.h"

namespace scumble::testing {
namespace {

constexpr int kWidth = 1920;
constexpr int kHeight = 1080;
constexpr double kDistance = 3.0;
constexpr double kAngle = 40.0;

// Ten balls of 10,000 triangles each, before a wall.
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

void Report(benchmark::State& state, std::size_t rays) {
  state.counters["Mray/s"] = benchmark::Counter(double(rays) * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
}

// Arguments: threads, aa.
void RunGuides(benchmark::State& state, const LayerSet& layers) {
  const Scene scene = BenchScene();
  GuidegenOptions options = Sized(kWidth, kHeight, layers);
  options.threads = int(state.range(0));
  options.aa = int(state.range(1));
  double build_ms = 0.0;
  double render_ms = 0.0;
  RayCounts rays;
  for (auto _ : state) {
    const auto result = RenderGuides(scene, FrontCamera(kDistance, kAngle), options);
    if (!result) return state.SkipWithError(result.error().message.c_str());
    build_ms += result->build_ms;
    render_ms += result->render_ms;
    rays = result->rays;
  }
  Report(state, rays.primary + rays.coverage + rays.shadow);
  state.counters["build_ms"] = benchmark::Counter(build_ms, benchmark::Counter::kAvgIterations);
  state.counters["render_ms"] = benchmark::Counter(render_ms, benchmark::Counter::kAvgIterations);
}

void BM_GuidesAlwaysWritten(benchmark::State& state) { RunGuides(state, {}); }
void BM_GuidesWithShadowRays(benchmark::State& state) { RunGuides(state, {Layer::kLuminance, Layer::kShadow}); }

class BareScene {
 public:
  explicit BareScene(const Scene& source) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    for (const Instance& instance : source.instances) Add(source.meshes[instance.mesh], instance.world_from_object);
    rtcCommitScene(scene_);
  }
  ~BareScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareScene(const BareScene&) = delete;
  BareScene& operator=(const BareScene&) = delete;

  // Two rows of pixels from the left to the right, in packets of 4 × 2.
  void CastRows(int y, float* depth) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const float half = float(std::tan(glm::radians(kAngle) / 2.0));
    alignas(32) int valid[8];
    std::fill(valid, valid + 8, -1);
    RTCRayHit8 packet = {};
    for (int x = 0; x < kWidth; x += 4) {
      for (int lane = 0; lane < 8; ++lane) {
        packet.ray.dir_x[lane] = (float(x + lane % 4) + 0.5f - kWidth / 2.0f) / (kHeight / 2.0f) * half;
        packet.ray.dir_y[lane] = (kHeight / 2.0f - float(y + lane / 4) - 0.5f) / (kHeight / 2.0f) * half;
        packet.ray.dir_z[lane] = -1.0f;
        packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
        packet.ray.mask[lane] = ~0u;
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect8(valid, scene_, &context, &packet);
      for (int lane = 0; lane < 8; ++lane) depth[(lane / 4) * kWidth + x + lane % 4] = packet.ray.tfar[lane];
    }
  }

 private:
  void Add(const Mesh& mesh, const glm::dmat4& world_from_object) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::dvec3 position(world_from_object * glm::dvec4(mesh.positions[i], 1.0f));
      vertices[3 * i] = float(position.x);
      vertices[3 * i + 1] = float(position.y);
      vertices[3 * i + 2] = float(position.z - kDistance);
    }
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (int corner = 0; corner < 3; ++corner) indices[3 * i + corner] = mesh.triangles[i][corner];
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  RTCDevice device_;
  RTCScene scene_;
};

// Argument: threads. The acceleration structure stands before the clock starts: compare with render_ms.
void BM_BareEmbree(benchmark::State& state) {
  const BareScene scene(BenchScene());
  std::vector<float> depth(std::size_t(kWidth) * kHeight);
  tbb::task_arena arena(int(state.range(0)));
  for (auto _ : state) {
    arena.execute([&] {
      tbb::parallel_for(0, kHeight / 2,
                        [&](int row) { scene.CastRows(2 * row, depth.data() + std::size_t(2 * row) * kWidth); });
    });
    benchmark::DoNotOptimize(depth.data());
  }
  Report(state, depth.size());
}

void BM_SphereGuides(benchmark::State& state) {
  SphereOptions options;
  options.size = int(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(RenderSphereGuides(options).ok());
}

#define SCUMBLE_REPEATED \
  Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime()->Repetitions(5)->ReportAggregatesOnly(true)
BENCHMARK(BM_BareEmbree)->SCUMBLE_REPEATED->Arg(1)->Arg(2);
BENCHMARK(BM_GuidesAlwaysWritten)->SCUMBLE_REPEATED->Args({1, 1})->Args({2, 1})->Args({2, 4});
BENCHMARK(BM_GuidesWithShadowRays)->SCUMBLE_REPEATED->Args({2, 1});
BENCHMARK(BM_SphereGuides)->SCUMBLE_REPEATED->Arg(512);

}  // namespace
}  // namespace scumble::testing

BENCHMARK_MAIN();
