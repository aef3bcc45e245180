#include "guidegen/cast_guides.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <string>

#include "guidegen/embree_scene.h"
#include "guidegen/tile_caster.h"
#include "image/stopwatch.h"

namespace scumble {
namespace {

constexpr Layer kUnavailableLayers[] = {Layer::kMotion, Layer::kLpeFull, Layer::kLpeLDE,
                                        Layer::kLpeLSE, Layer::kLpeLDDE, Layer::kLpeLD12E};

// Counts tiles and passes the share on, one caller at a time; a thread that finds the line busy works on instead.
class ProgressGate {
 public:
  ProgressGate(const Progress& progress, std::size_t total) : progress_(progress), total_(total) {}

  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  void TileDone() {
    const std::size_t done = done_.fetch_add(1, std::memory_order_relaxed) + 1;
    if (!progress_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || done <= reported_ || cancelled()) return;
    reported_ = done;
    // The end is told once, after the last tile, by CastGuides.
    if (done < total_ && !progress_(double(done) / double(total_))) cancelled_ = true;
  }

 private:
  const Progress& progress_;
  const std::size_t total_;
  std::atomic<std::size_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
  std::size_t reported_ = 0;
};

bool Continue(const Progress& progress, double share) { return !progress || progress(share); }

// False where the caller asked to stop.
bool CastTiles(const TileCaster& caster, const GuidegenOptions& options, RayCounts& counts) {
  const std::size_t columns = (options.width + kTileSide - 1) / kTileSide;
  const std::size_t rows = (options.height + kTileSide - 1) / kTileSide;
  ProgressGate gate(options.progress, columns * rows);
  std::atomic<std::size_t> primary{0};
  std::atomic<std::size_t> coverage{0};
  std::atomic<std::size_t> shadow{0};
  tbb::parallel_for(std::size_t(0), columns * rows, [&](std::size_t i) {
    if (gate.cancelled()) return;
    Tile tile;
    tile.x0 = int(i % columns) * kTileSide;
    tile.y0 = int(i / columns) * kTileSide;
    tile.width = std::min(kTileSide, options.width - tile.x0);
    tile.height = std::min(kTileSide, options.height - tile.y0);
    RayCounts cast;
    caster.Cast(tile, cast);
    primary += cast.primary;
    coverage += cast.coverage;
    shadow += cast.shadow;
    gate.TileDone();
  });
  counts = {primary, coverage, shadow};
  return !gate.cancelled();
}

GuideSet EmptyGuides(const GuidegenOptions& options) {
  GuideSet guides(options.width, options.height);
  for (const LayerInfo& info : AllLayers()) {
    if (AlwaysWritten().Has(info.layer) || options.layers.Has(info.layer)) guides.Add(info.layer);
  }
  return guides;
}

Expected<GuidegenResult> CastInArena(View view, const GuidegenOptions& options) {
  if (!Continue(options.progress, 0.0)) return CancelledError();
  GuidegenResult result;
  Stopwatch watch;
  SCUMBLE_ASSIGN(const EmbreeScene scene, EmbreeScene::Build(std::move(view.objects), options.isa));
  result.build_ms = watch.Lap();

  result.guides = EmptyGuides(options);
  const TileCaster caster(scene, view, options, result.guides);
  if (!CastTiles(caster, options, result.rays)) return CancelledError();
  result.render_ms = watch.Lap();
  if (!Continue(options.progress, 1.0)) return CancelledError();

  result.guides.camera = view.camera.ToGuideCamera();
  result.guides.attributes["scumble:generator"] = "guidegen " SCUMBLE_VERSION;
  result.guides.attributes["scumble:isa"] = scene.isa();
  result.guides.attributes["scumble:normal_frame"] = options.normal_frame == NormalFrame::kEye ? "eye" : "camera";
  return result;
}

}  // namespace

Status CheckOptions(const GuidegenOptions& options) {
  const auto in_range = [](int side) { return side >= 1 && side <= kMaxImageSide; };
  if (!in_range(options.width) || !in_range(options.height)) {
    return UsageError("a picture of " + std::to_string(options.width) + "x" + std::to_string(options.height) +
                      " pixels cannot be made: each side must be 1 to " + std::to_string(kMaxImageSide));
  }
  if (options.aa < 1 || options.aa > kMaxAa) {
    return UsageError("aa " + std::to_string(options.aa) + " is out of range: expected 1 to " + std::to_string(kMaxAa) +
                      " subsamples along each side of a pixel");
  }
  if (options.threads < 0) {
    return UsageError("threads " + std::to_string(options.threads) + " is out of range: expected 0 (all) or more");
  }
  for (const Layer layer : kUnavailableLayers) {
    if (!options.layers.Has(layer)) continue;
    return UnavailableError("layer " + std::string(Info(layer).name) +
                            " is not built into this version's guidegen: leave it out, or take it from Blender");
  }
  return Ok();
}

Expected<GuidegenResult> CastGuides(View view, const GuidegenOptions& options) {
  // oneTBB has no workers beyond the machine's cores unless it is told that more are welcome.
  std::optional<tbb::global_control> more_workers;
  if (options.threads > tbb::this_task_arena::max_concurrency()) {
    more_workers.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(options.threads));
  }
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  std::optional<Expected<GuidegenResult>> result;
  arena.execute([&] { result.emplace(CastInArena(std::move(view), options)); });
  return *std::move(result);
}

}  // namespace scumble
