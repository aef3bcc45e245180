#include "guidegen/cast/cast_guides.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "core/filter/more_workers.h"
#include "core/filter/outline_distance.h"
#include "core/image/stopwatch.h"
#include "guidegen/cast/tile_caster.h"
#include "guidegen/cast/tile_store.h"
#include "guidegen/light/light_passes.h"
#include "guidegen/path_layers.h"
#include "guidegen/rays/embree_scene.h"
#include "guidegen/rays/progress_gate.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

bool Continue(const Progress& progress, double share) { return !progress || progress(share); }

// The share of the progress for casting where light paths follow, which nearly always take longer.
constexpr double kCastShare = 0.05;

// Casts the tiles that the window meets. False if the caller cancelled. Lists covered pixels by tile where `pixels` is
// given.
bool CastTiles(const TileCaster& caster, const GuidegenOptions& options, const PixelWindow& window, double end,
               GuidegenResult& result, std::vector<std::vector<PathPixel>>* pixels,
               tbb::enumerable_thread_specific<TileCaster::Scratch>& scratch) {
  const int left = window.x0 / kTileSide, top = window.y0 / kTileSide;
  const std::size_t columns = std::size_t((window.x1 + kTileSide - 1) / kTileSide - left);
  const std::size_t rows = std::size_t((window.y1 + kTileSide - 1) / kTileSide - top);
  const std::size_t strips = (columns + kStripTiles - 1) / kStripTiles;  // in a row
  ProgressGate gate(options.progress, strips * rows, 0.0, end);
  if (pixels) pixels->resize(columns * rows);
  std::mutex summing;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, strips * rows), [&](const auto& range) {
    TileCaster::Scratch& own = scratch.local();
    TileCaster::Share share{gate, {}};
    const WorkMeter meter;
    for (std::size_t i = range.begin(); i != range.end() && !gate.cancelled(); ++i) {
      const std::size_t row = i / strips;
      const std::size_t first = i % strips * kStripTiles;
      const std::size_t count = std::min<std::size_t>(kStripTiles, columns - first);
      std::array<Tile, kStripTiles> tiles;
      for (std::size_t k = 0; k < count; ++k) {
        Tile& tile = tiles[k];
        tile.x0 = (left + int(first + k)) * kTileSide;
        tile.y0 = (top + int(row)) * kTileSide;
        tile.width = std::min(kTileSide, options.width - tile.x0);
        tile.height = std::min(kTileSide, options.height - tile.y0);
      }
      const auto lists =
          pixels ? std::span(*pixels).subspan(row * columns + first, count) : std::span<std::vector<PathPixel>>();
      caster.Cast(std::span(tiles).first(count), own, share, lists);
      gate.TileDone();
    }
    PublishTiles();
    const std::lock_guard lock(summing);
    result.rays.primary += share.rays.primary;
    result.rays.coverage += share.rays.coverage;
    result.rays.shadow += share.rays.shadow;
    AddWork(meter.Since(), result.work);
  });
  return !gate.cancelled();
}

// Fills what lies outside the window with background.
void ClearOutside(const PixelWindow& window, GuideSet& guides) {
  const int width = guides.width(), height = guides.height();
  if (window == PixelWindow{0, 0, width, height}) return;
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; guides.Has(info.layer) && c < ChannelCount(info.layer); ++c) {
      const auto plane = guides.Plane(info.layer, c);
      const auto clear = [&](int x0, int x1, int y) {
        std::fill(plane.begin() + std::ptrdiff_t(guides.Index(x0, y)),
                  plane.begin() + std::ptrdiff_t(guides.Index(x0, y)) + (x1 - x0), BackgroundValue(info.layer));
      };
      for (int y = 0; y < height; ++y) {
        if (y < window.y0 || y >= window.y1) {
          clear(0, width, y);
        } else {
          clear(0, window.x0, y), clear(window.x1, width, y);
        }
      }
    }
  }
}

// Planes without initial values: tiles fill them, background included.
GuideSet UnsetGuides(const GuidegenOptions& options) {
  GuideSet guides(options.width, options.height);
  for (const LayerInfo& info : AllLayers()) {
    if (AlwaysWritten().Has(info.layer) || options.layers.Has(info.layer)) guides.AddUnset(info.layer);
  }
  return guides;
}

std::string Digits(double error) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3f", error);
  return text;
}

Expected<GuidegenResult> CastInArena(LazyScene& objects, const View& view, const GuidegenOptions& options) {
  if (!Continue(options.progress, 0.0)) return CancelledError();
  GuidegenResult result;
  Stopwatch watch;
  const PathFollower follower(options.layers, view.supply, options.max_bounces);
  EmbreeScene::Needs needs;
  // Only the light of meshes without blockers needs a scene of emitters alone.
  needs.emitters = options.layers.Has(Layer::kLuminance) || options.layers.Has(Layer::kShadow);
  needs.light_rays = needs.emitters || !follower.empty();
  needs.robust = options.robust;
  SCUMBLE_ASSIGN(const LazyScene::Lease lease, objects.Get(options.isa, needs, options.progress));
  const EmbreeScene& scene = *lease.scene;
  const double build_ms = watch.Lap();
  if (lease.built) {
    result.builds = 1;
    result.build_ms = build_ms;
  }

  result.guides = UnsetGuides(options);
  for (const LayerInfo& info : AllLayers()) {
    if (!result.guides.Has(info.layer)) continue;
    for (int i = 0; i < ChannelCount(info.layer); ++i) {
      result.work.plane_bytes += result.guides.Plane(info.layer, i).size_bytes();
    }
  }
  const TileCaster caster(scene, view, options, result.guides);
  std::vector<std::vector<PathPixel>> pixels;
  const bool paths = !follower.empty();
  const PixelWindow& window = view.camera.window();
  tbb::enumerable_thread_specific<TileCaster::Scratch> scratch([&] { return TileCaster::Scratch(caster); });
  if (!CastTiles(caster, options, window, paths ? kCastShare : 1.0, result, paths ? &pixels : nullptr, scratch)) {
    return CancelledError();
  }
  ClearOutside(window, result.guides);
  for (std::vector<PathPixel>& of_tile : pixels) {
    std::erase_if(of_tile, [&](const PathPixel& pixel) {
      return !window.Contains(int(pixel.index) % options.width, int(pixel.index) / options.width);
    });
  }
  if (paths) {
    const LightPathTracer tracer(scene, view, follower, options.max_bounces);
    const LightPassResult traced = TraceLightPaths(tracer, follower, pixels, options, kCastShare, result.guides);
    if (traced.cancelled) return CancelledError();
    result.rays.shadow += traced.rays.shadow;
    result.rays.bounce += traced.rays.bounce;
    AddWork(traced.work, result.work);
    result.samples = traced.samples;
    result.noise = traced.noise;
  }
  std::vector<const FoundFragments*> found;
  LightErrors light_errors;
  for (const TileCaster::Scratch& of_thread : scratch) {
    found.push_back(&of_thread.fragments);
    light_errors += of_thread.light_errors();
  }
  result.light_error = light_errors.OfMost();
  result.guides.fragments = GatherFragments(found, window, result.guides);
  result.render_ms = watch.Lap();
  if (!Continue(options.progress, 1.0)) return CancelledError();

  result.guides.camera = view.camera.ToGuideCamera();
  if (result.guides.Has(Layer::kOutline)) {
    internal::FillOutlineDistance({window.x0, window.y0, window.x1, window.y1}, result.guides);
  }
  result.guides.attributes["scumble:generator"] = "guidegen " SCUMBLE_VERSION;
  result.guides.attributes["scumble:isa"] = scene.isa();
  result.guides.attributes["scumble:embree"] = scene.version();
  if (options.raw_normals) result.guides.attributes["scumble:raw_normals"] = "true";
  if (!options.robust) result.guides.attributes["scumble:robust"] = "false";
  if (result.samples > 0) result.guides.attributes["scumble:samples"] = std::to_string(result.samples);
  if (needs.emitters && !view.supply.may_be_met) result.guides.attributes[kLightKey] = kExactLight;
  if (result.light_error > 0.0) result.guides.attributes[kLightErrorKey] = Digits(result.light_error);
  if (options.seed != 0) result.guides.attributes["scumble:seed"] = std::to_string(options.seed);
  result.guides.attributes["scumble:normal_frame"] = options.normal_frame == NormalFrame::kEye ? "eye" : "camera";
  return result;
}

Status CheckSampling(const GuidegenOptions& options) {
  const auto refuse = [](const std::string& what, const std::string& expected) -> Status {
    return UsageError(what + " is out of range: expected " + expected);
  };
  if (options.samples < 1 || options.samples > kMaxSamples) {
    return refuse("samples " + std::to_string(options.samples), "1 to " + std::to_string(kMaxSamples));
  }
  if (!(options.light_error >= 0.0) || std::isinf(options.light_error)) {
    return refuse("light_error " + std::to_string(options.light_error),
                  "0 (a fixed number of samples) or an error like 0.015");
  }
  if (options.max_samples < 1 || options.max_samples > kMaxSamples) {
    return refuse("max_samples " + std::to_string(options.max_samples), "1 to " + std::to_string(kMaxSamples));
  }
  if (options.max_bounces < 0 || options.max_bounces > kMaxBounces) {
    return refuse("max_bounces " + std::to_string(options.max_bounces), "0 to " + std::to_string(kMaxBounces));
  }
  if (!(options.noise >= 0.0) || std::isinf(options.noise)) {
    return refuse("noise " + std::to_string(options.noise), "0 (a fixed number of samples) or an error like 0.01");
  }
  if (!(options.time_budget_seconds >= 0.0) || std::isinf(options.time_budget_seconds)) {
    return refuse("a time budget of " + std::to_string(options.time_budget_seconds) + " s",
                  "0 (no budget) or a number of seconds");
  }
  return Ok();
}

}  // namespace

Status CheckOptions(const GuidegenOptions& options, bool has_next_frame) {
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
  if (options.layers.Has(Layer::kMotion) && !has_next_frame) {
    return UnavailableError("layer " + std::string(Info(Layer::kMotion).name) +
                            " needs the next frame, too: leave it out, or give the number of a frame");
  }
  return CheckSampling(options);
}

Expected<GuidegenResult> CastGuides(LazyScene& objects, const View& view, const GuidegenOptions& options) {
  const MoreWorkers workers(options.threads);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  std::optional<Expected<GuidegenResult>> result;
  arena.execute([&] { result.emplace(CastInArena(objects, view, options)); });
  return *std::move(result);
}

}  // namespace scumble
