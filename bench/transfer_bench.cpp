// The transfer's stages on the Suzanne scene at 1920 × 1080 with a 1024² exemplar: milliseconds a frame, and
// nanoseconds a covered pixel for matching and voting. Arguments are blend radius and threads.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "image/hash.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

template <class T>
T OrStop(Expected<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(1);
}

const GuideSet& SuzanneGuides() {
  static const GuideSet guides = [] {
    Scene scene = OrStop(LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/suzanne.glb"));
    const PreparedView view = OrStop(PrepareView(scene, "", std::nullopt, 16.0 / 9.0, false));
    GuidegenOptions options;
    options.width = 1920, options.height = 1080;
    return std::move(OrStop(RenderGuides(scene, view.camera, options)).guides);
  }();
  return guides;
}

Style NoiseStyle() {
  Exemplar exemplar{"noise", Picture(1024, 1024)};
  for (std::size_t i = 0; i < exemplar.picture.rgba.size(); ++i) {
    exemplar.picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(i) & 0xffff);
  }
  Style style;
  style.name = "noise";
  style.exemplars.push_back(std::move(exemplar));
  return style;
}

void BM_Transfer(benchmark::State& state) {
  const GuideSet& guides = SuzanneGuides();
  Style style = NoiseStyle();
  style.transfer.blend_radius = static_cast<int>(state.range(0));
  const PreparedStyle prepared = OrStop(Prepare(style, guides.height()));
  TransferOptions options;
  options.threads = static_cast<int>(state.range(1));
  TransferScratch scratch;
  Picture picture;
  double match_ms = 0, vote_ms = 0;
  for (auto _ : state) {
    OrStop(Transfer(prepared, guides, options, scratch, picture));
    match_ms += scratch.times.match_ms, vote_ms += scratch.times.vote_ms;
  }
  double covered = 0;
  for (const float a : guides.Plane(Layer::kCoverage)) covered += a > 0.0f;
  const double per_pixel = 1e6 / (covered * static_cast<double>(state.iterations()));
  state.counters["match_ns_per_covered_pixel"] = match_ms * per_pixel;
  state.counters["vote_ns_per_covered_pixel"] = vote_ms * per_pixel;
  state.counters["covered_percent"] = 100.0 * covered / static_cast<double>(guides.pixel_count());
}
BENCHMARK(BM_Transfer)->Unit(benchmark::kMillisecond)->UseRealTime()->ArgNames({"radius", "threads"})
    ->Args({1, 1})->Args({1, 2})->Args({0, 1})->Args({8, 1});

}  // namespace
}  // namespace scumble

BENCHMARK_MAIN();
