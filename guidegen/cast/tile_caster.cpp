#include "guidegen/cast/tile_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/image/check.h"
#include "guidegen/cast/ray_packets.h"
#include "guidegen/cast/tile_store.h"
#include "guidegen/rays/ray_offset.h"
#include "guidegen/surface/bsdf.h"
#include "guidegen/surface/shading_normal.h"

namespace scumble {
namespace {

void Store(const std::array<float*, 3>& planes, std::size_t index, const glm::dvec3& value) {
  if (!planes[0]) return;
  for (int i = 0; i < 3; ++i) planes[i][index] = float(value[i]);
}

float* PlaneOrNull(GuideSet& guides, Layer layer, int component = 0) {
  return guides.Has(layer) ? guides.Plane(layer, component).data() : nullptr;
}

std::array<float*, 3> PlanesOrNull(GuideSet& guides, Layer layer) {
  return {PlaneOrNull(guides, layer, 0), PlaneOrNull(guides, layer, 1), PlaneOrNull(guides, layer, 2)};
}

// The objects whose emission luminance and shadow need; empty where neither is wanted.
std::span<const PlacedObject> LitObjects(const EmbreeScene& scene, const GuideSet& guides) {
  if (!guides.Has(Layer::kLuminance) && !guides.Has(Layer::kShadow)) return {};
  return scene.objects();
}

// Planes of more pixels than this do not stay in the caches until they are read.
constexpr std::size_t kCachedPixels = std::size_t(1) << 19;

}  // namespace

TileCaster::TileCaster(const EmbreeScene& scene, const View& view, const GuidegenOptions& options, GuideSet& guides)
    : scene_(scene),
      view_(view),
      options_(options),
      width_(guides.width()),
      past_caches_(guides.pixel_count() > kCachedPixels),
      primary_(scene, view.camera, guides.width(), guides.height(), options.aa),
      point_values_(scene, view, options.normal_frame),
      fragment_caster_(scene, view, options.normal_frame, guides.layers(), guides.width()),
      lights_(view.lights, LitObjects(scene, guides), view.world_radiance),
      object_records_(MakeObjectRecords(scene.objects())) {
  planes_.coverage = PlaneOrNull(guides, Layer::kCoverage);
  planes_.depth = PlaneOrNull(guides, Layer::kDepth);
  planes_.object = PlaneOrNull(guides, Layer::kObject);
  planes_.material = PlaneOrNull(guides, Layer::kMaterial);
  planes_.luminance = PlaneOrNull(guides, Layer::kLuminance);
  planes_.shadow = PlaneOrNull(guides, Layer::kShadow);
  planes_.normal = PlanesOrNull(guides, Layer::kNormal);
  planes_.position = PlanesOrNull(guides, Layer::kPosition);
  planes_.pref = PlanesOrNull(guides, Layer::kPref);
  planes_.albedo = PlanesOrNull(guides, Layer::kAlbedo);
  planes_.motion = {PlaneOrNull(guides, Layer::kMotion, 0), PlaneOrNull(guides, Layer::kMotion, 1)};
  if (view.key_lamp) planes_.cosine = PlaneOrNull(guides, Layer::kCosine);
  planes_.uv = {PlaneOrNull(guides, Layer::kUv, 0), PlaneOrNull(guides, Layer::kUv, 1)};
  const LayerSet whole = AlwaysWritten();
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer) || whole.Has(info.layer)) continue;
    for (int i = 0; i < ChannelCount(info.layer); ++i) {
      planes_.others.push_back({guides.Plane(info.layer, i).data(), BackgroundValue(info.layer)});
    }
  }
  lit_ = (planes_.luminance || planes_.shadow) && !lights_.empty();
  points_ = lit_ || planes_.position[0] || planes_.pref[0] || planes_.albedo[0] || planes_.motion[0] ||
            planes_.cosine || planes_.uv[0] || options.normal_frame == NormalFrame::kEye;
}

TileCaster::Scratch::Scratch(const TileCaster& caster)
    : triangles(caster.scene_.objects(), caster.object_records_, caster.points_),
      area_light_tile(caster.scene_, caster.lights_,
                      {caster.options_.samples, caster.options_.light_error, caster.options_.seed}),
      tiles(kStripTiles) {
  for (OfTile& tile : tiles) tile.lit.resize(caster.lit_ ? kTilePixels : 0);
}

// Pixels that the vector code cannot do: spheres, hair, normal maps, bumps, bent normals, degenerate triangles, rays
// that miss the pixel's centre.
void TileCaster::WritePlain(int pixel, const glm::dvec2& at, TileScratch& scratch) const {
  const TileHits& hits = scratch.hits;
  const PlacedObject& object = scene_.objects()[hits.object[pixel]];
  const ViewRay ray = view_.camera.ThroughWithFootprint(at.x, at.y);
  SurfacePoint point = FindSurfacePoint(object, hits.primitive[pixel], ray);
  if (view_.bends_normals) BendShadingNormal(object, ray, point);
  scratch.guides.depth[pixel] = float(std::max(-point.position.z, 0.0));
  scratch.guides.object[pixel] = float(object.object_id);
  scratch.guides.material[pixel] = float(object.material_id);
  for (int i = 0; i < 3; ++i) scratch.guides.normal[i][pixel] = float(point.normal[i]);
  if (points_) scratch.points.Set(pixel, point);
}

void TileCaster::WriteOthers(const Tile& tile, int pixel, const glm::dvec2& at, TileScratch& scratch) const {
  const TileHits& hits = scratch.hits;
  const PlacedObject& object = scene_.objects()[hits.object[pixel]];
  const std::size_t index = Index(tile, pixel);
  const SurfacePoint point = scratch.points.At(pixel);
  if (options_.normal_frame == NormalFrame::kEye) {
    const glm::dvec3 normal = point_values_.Normal(point, view_.camera.Through(at.x, at.y));
    for (int i = 0; i < 3; ++i) scratch.guides.normal[i][pixel] = float(normal[i]);
  }
  if (planes_.position[0]) Store(planes_.position, index, view_.camera.WorldFromView(point.position));
  if (planes_.pref[0]) {
    const glm::dvec3 rest =
        point_values_.Rest(hits.object[pixel], hits.primitive[pixel], point, view_.camera.Through(at.x, at.y));
    Store(planes_.pref, index, rest);
  }
  if (planes_.albedo[0]) {
    Store(planes_.albedo, index, glm::dvec3(SurfaceColor(object, hits.primitive[pixel], point.barycentric)));
  }
  if (planes_.motion[0]) {
    const glm::dvec2 motion = point_values_.Motion(hits.object[pixel], hits.primitive[pixel], point.barycentric);
    for (int i = 0; i < 2; ++i) planes_.motion[i][index] = float(motion[i]);
  }
  if (planes_.cosine) planes_.cosine[index] = float(point_values_.Cosine(point));
  if (planes_.uv[0]) {
    const glm::dvec2 uv = point_values_.Uv(hits.object[pixel], hits.primitive[pixel], point.barycentric);
    for (int i = 0; i < 2; ++i) planes_.uv[i][index] = float(uv[i]);
  }
  if (!lit_) return;
  scratch.lit[pixel] = point;
  scratch.lit[pixel].max_ray_offset =
      MaxRayOffset(view_.camera.Through(at.x, at.y), hits.clear_from[pixel], point.position);
}

void TileCaster::Light(const Tile& tile, AreaLightTile& area_light_tile, TileScratch& scratch, Share& share) const {
  const TileHits& hits = scratch.hits;
  const std::vector<SurfacePoint>& points = scratch.lit;
  std::array<double, kTilePixels> reached = {};  // shadows included
  std::array<double, kTilePixels> unoccluded = {};
  OcclusionBatch<std::pair<int, double>> batch(scene_.handle(), false);
  const auto report = [&](const std::pair<int, double>& tag, bool blocked) {
    if (!blocked) reached[tag.first] += tag.second;
  };
  for (const PlacedLight& light : view_.lights) {
    if (!light.IsDelta()) continue;
    ForEachPixel(tile, [&](int pixel) {
      if (!hits.Met(pixel)) return;
      const LightSample sample = SampleLight(light, points[pixel]);
      if (!(sample.luminance > 0.0)) return;
      unoccluded[pixel] += sample.luminance;
      ++share.rays.shadow;
      const glm::dvec3 origin = ShadowRayOrigin(points[pixel]);
      const LightRay ray =
          sample.endless ? EndlessLightRay(origin, sample.to_light) : LightRayTo(origin, light.position);
      batch.Add({ray.origin, ray.direction, 0.0, ray.reach}, {pixel, sample.luminance}, report);
    });
    batch.Flush(report);
  }
  static_assert(AreaLightTile::kTileSide == kTileSide);
  scratch.area_lit.clear();
  for (int pixel = 0; pixel < kTilePixels; ++pixel) {  // a square after the other: neighbours share packets
    if (TileColumn(pixel) >= tile.width || TileRow(pixel) >= tile.height || !hits.Met(pixel)) continue;
    scratch.area_lit.push_back({TileColumn(pixel),
                                TileRow(pixel),
                                &points[std::size_t(pixel)],
                                std::uint32_t(Index(tile, pixel)),
                                reached[std::size_t(pixel)],
                                {}});
  }
  if (lights_.CanBeMet() && !area_light_tile.Run(scratch.area_lit, share.gate, share.rays)) return;
  for (const AreaLightPixel& one : scratch.area_lit) {
    const auto pixel = std::size_t(TilePixel(one.column, one.row));
    const double lit = reached[pixel] + one.light.reached;
    const double most = unoccluded[pixel] + one.light.unoccluded;
    // Each light is within float's range; their sum need not be.
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    const double shines = EmissionOf(hits.object[pixel], hits.primitive[pixel], points[pixel].barycentric);
    if (planes_.luminance) planes_.luminance[one.index] = float(std::min(lit + shines, kMaxFloat));
    // Nothing blocks what a surface emits itself.
    if (planes_.shadow && most > 0.0) planes_.shadow[one.index] = float(1.0 - (lit + shines) / (most + shines));
  }
}

double TileCaster::EmissionOf(std::uint32_t object, std::uint32_t primitive, const glm::dvec2& barycentric) const {
  const PlacedObject& placed = scene_.objects()[object];
  return MayEmit(*placed.material) ? Brightness(SurfaceEmission(placed, primitive, barycentric)) : 0.0;
}

void TileCaster::WriteWhole(std::span<const Tile> tiles, const Scratch& scratch) const {
  const auto store = [&](float* plane, const auto& values_of) {
    std::array<const float*, kStripTiles> values;
    for (std::size_t i = 0; i < tiles.size(); ++i) values[i] = values_of(scratch.tiles[i]).data();
    StoreTiles(tiles, values, plane, width_, past_caches_);
  };
  store(
      planes_.coverage, [](const TileScratch& tile) -> const auto& { return tile.coverage; });
  store(
      planes_.depth, [](const TileScratch& tile) -> const auto& { return tile.guides.depth; });
  store(
      planes_.object, [](const TileScratch& tile) -> const auto& { return tile.guides.object; });
  store(
      planes_.material, [](const TileScratch& tile) -> const auto& { return tile.guides.material; });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    store(
        planes_.normal[axis], [&](const TileScratch& tile) -> const auto& { return tile.guides.normal[axis]; });
  }
}

void TileCaster::Fill(const Tile& tile, Scratch& buffers, TileScratch& scratch, Share& share,
                      std::vector<PathPixel>* pixels) const {
  const TileHits& hits = scratch.hits;
  scratch.moved.clear(), buffers.beside.clear();
  share.rays.coverage +=
      primary_.Cover(tile, scratch.hits, scratch.coverage, scratch.moved, buffers.seen, buffers.beside);
  for (const PrimaryRays::Beside& beside : buffers.beside) fragment_caster_.Add(beside, buffers.fragments);
  FindTileSurface(hits, scratch.rays, buffers.triangles, view_.bends_normals, scratch.guides,
                  points_ ? &scratch.points : nullptr);
  for (int i = 0; i < scratch.guides.left_over_count; ++i) {
    const int pixel = scratch.guides.left_over[std::size_t(i)];
    WritePlain(pixel, Centre(tile, pixel), scratch);
  }
  for (const PrimaryRays::Moved& moved : scratch.moved) WritePlain(moved.pixel, moved.at, scratch);

  for (const Plane& plane : planes_.others) FillTile(tile, plane.background, plane.values, width_);
  if (points_ || pixels) {
    ForEachPixel(tile, [&](int pixel) {
      if (!hits.Met(pixel)) return;
      const auto found = std::find_if(scratch.moved.begin(), scratch.moved.end(),
                                      [&](const PrimaryRays::Moved& moved) { return moved.pixel == pixel; });
      const glm::dvec2 at = found != scratch.moved.end() ? found->at : Centre(tile, pixel);
      if (points_) WriteOthers(tile, pixel, at, scratch);
      if (pixels) {
        pixels->push_back(
            {std::uint32_t(Index(tile, pixel)), hits.object[pixel], hits.primitive[pixel], at, hits.clear_from[pixel]});
      }
    });
  }
  // Where nothing emits, luminance and shadow keep their background value, which is 0.
  if (lit_) Light(tile, buffers.area_light_tile, scratch, share);
}

void TileCaster::Cast(std::span<const Tile> tiles, Scratch& scratch, Share& share,
                      std::span<std::vector<PathPixel>> pixels) const {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    TileScratch& own = scratch.tiles[i];
    primary_.PlaceRays(tiles[i], own.rays);
    primary_.CastCentres(tiles[i], own.rays, lit_ || !pixels.empty(), own.hits);
    share.rays.primary += std::size_t(tiles[i].width) * tiles[i].height;
  }
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    Fill(tiles[i], scratch, scratch.tiles[i], share, pixels.empty() ? nullptr : &pixels[i]);
  }
  WriteWhole(tiles, scratch);
}

}  // namespace scumble
