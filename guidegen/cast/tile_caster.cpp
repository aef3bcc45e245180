#include "guidegen/cast/tile_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "guidegen/light/area_light.h"
#include "guidegen/cast/tile_store.h"
#include "guidegen/rays/ray_offset.h"
#include "core/image/check.h"

namespace scumble {
namespace {

constexpr int kPacket = 8;  // of rays that ask for any hit

// A ray and the stretch of it, in lengths of its direction, on which surfaces count.
struct Segment {
  glm::dvec3 origin;
  glm::dvec3 direction;
  double near;
  double far;
};

Segment SeenBy(const CameraRays& camera, const ViewRay& ray) {
  return {ray.origin, ray.direction, camera.near_depth(), camera.far_depth()};
}

template <class Packet>
void SetLane(Packet& packet, int lane, const Segment& segment) {
  packet.org_x[lane] = float(segment.origin.x);
  packet.org_y[lane] = float(segment.origin.y);
  packet.org_z[lane] = float(segment.origin.z);
  packet.dir_x[lane] = float(segment.direction.x);
  packet.dir_y[lane] = float(segment.direction.y);
  packet.dir_z[lane] = float(segment.direction.z);
  packet.tnear[lane] = float(segment.near);
  packet.tfar[lane] = float(segment.far);
  packet.time[lane] = 0.0f;
  packet.mask[lane] = ~0u;
  packet.id[lane] = unsigned(lane);
  packet.flags[lane] = 0;
}

// Gathers any-hit rays into packets and reports each as (tag, blocked), in the order in which they were added.
template <class Tag>
class OcclusionBatch {
 public:
  OcclusionBatch(RTCScene scene, bool camera_rays) : scene_(scene), context_(camera_rays) {}

  template <class Report>
  void Add(const Segment& segment, const Tag& tag, const Report& report) {
    SetLane(packet_, count_, segment);
    tags_[count_++] = tag;
    if (count_ == kPacket) Flush(report);
  }

  template <class Report>
  void Flush(const Report& report) {
    if (count_ == 0) return;
    alignas(32) int valid[kPacket];
    for (int lane = 0; lane < kPacket; ++lane) valid[lane] = lane < count_ ? -1 : 0;
    rtcOccluded8(valid, scene_, &context_.embree, &packet_);
    const int count = std::exchange(count_, 0);
    for (int lane = 0; lane < count; ++lane) report(tags_[lane], packet_.tfar[lane] < 0.0f);
  }

 private:
  RTCScene scene_;
  CastContext context_;
  RTCRay8 packet_ = {};
  std::array<Tag, kPacket> tags_ = {};
  int count_ = 0;
};

// Calls `visit(pixel)` for each pixel of the tile, row by row.
template <class Visit>
void ForEachPixel(const Tile& tile, const Visit& visit) {
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) visit(TilePixel(column, row));
  }
}

template <class Packet>
constexpr int kRaysIn = sizeof(Packet::hit.geomID) / sizeof(unsigned);

void Cast(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8& packet) {
  rtcIntersect8(valid, scene, context, &packet);
}
void Cast(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16& packet) {
  rtcIntersect16(valid, scene, context, &packet);
}

// The smallest rotation that takes the direction to the eye to +Z.
glm::dvec3 RotateToEye(const glm::dvec3& normal, const ViewRay& ray) {
  const glm::dvec3 to_eye = glm::normalize(-ray.direction);
  const glm::dvec3 axis = glm::cross(to_eye, glm::dvec3(0.0, 0.0, 1.0));
  const glm::dvec3 turn = glm::cross(axis, normal);
  return normal + turn + glm::cross(axis, turn) / (1.0 + to_eye.z);
}

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

// Whose emission luminance and shadow ask for; nobody looks at it where neither is wanted.
std::span<const PlacedObject> LitObjects(const EmbreeScene& scene, const GuideSet& guides) {
  if (!guides.Has(Layer::kLuminance) && !guides.Has(Layer::kShadow)) return {};
  return scene.objects();
}

// Planes of more pixels than this are not found in the caches by whoever reads them next.
constexpr std::size_t kCachedPixels = std::size_t(1) << 19;

// The sampler's stream for luminance and shadow: not the light paths' own.
constexpr std::uint32_t kAreaLightStream = 1;

}  // namespace

TileCaster::TileCaster(const EmbreeScene& scene, const View& view, const GuidegenOptions& options, GuideSet& guides)
    : scene_(scene),
      view_(view),
      options_(options),
      width_(guides.width()),
      past_caches_(guides.pixel_count() > kCachedPixels),
      lights_(view.lights, LitObjects(scene, guides), view.world_radiance),
      object_records_(MakeObjectRecords(scene.objects())),
      backs_(!AllDoubleSided(scene.objects())) {
  const int n = options.aa;
  std::vector<std::array<int, 3>> ranked;  // squared distance in half subsamples, row, column
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const int dx = 2 * column + 1 - n;
      const int dy = 2 * row + 1 - n;
      ranked.push_back({dx * dx + dy * dy, row, column});
    }
  }
  std::sort(ranked.begin(), ranked.end());
  for (const auto& [distance, row, column] : ranked) offsets_.push_back({(column + 0.5) / n, (row + 0.5) / n});

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
  const LayerSet whole = AlwaysWritten();
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer) || whole.Has(info.layer)) continue;
    for (int i = 0; i < ChannelCount(info.layer); ++i) {
      planes_.others.push_back({guides.Plane(info.layer, i).data(), BackgroundValue(info.layer)});
    }
  }
  // Through moves one of the two only: which one tells the kind of the camera.
  const auto moved = [&](double x, double y) {
    const ViewRay ray = view.camera.Through(x, y);
    return view.camera.orthographic() ? ray.origin : ray.direction;
  };
  for (int x = 0; x < guides.width() + kTileSide; ++x) across_.push_back(moved(x + 0.5, 0.5).x);
  for (int y = 0; y < guides.height() + kTileSide; ++y) up_.push_back(moved(0.5, y + 0.5).y);

  lit_ = (planes_.luminance || planes_.shadow) && !lights_.empty();
  points_ = lit_ || planes_.position[0] || planes_.pref[0] || planes_.albedo[0] || planes_.motion[0] ||
            options.normal_frame == NormalFrame::kEye;
}

TileCaster::Scratch::Scratch(const TileCaster& caster)
    : triangles(caster.scene_.objects(), caster.object_records_, caster.points_), tiles(kStripTiles) {
  for (OfTile& tile : tiles) tile.lit.resize(caster.lit_ ? kTilePixels : 0);
}

void TileCaster::PlaceRays(const Tile& tile, TileRays& rays) const {
  rays.orthographic = view_.camera.orthographic();
  std::copy_n(across_.begin() + tile.x0, kTileSide, rays.across.begin());
  std::copy_n(up_.begin() + tile.y0, kTileSide, rays.up.begin());
}

// From where the ways of a packet that was cast are clear. Rays that passed backs before what they met and behind it, by
// context.passed, look again, only as far as that. The back itself may be a rounding nearer than float has it: half of
// the way counts.
template <class Packet>
void TileCaster::FindClear(const Packet& packet, const int* valid, CastContext& context, float* clear_from) const {
  constexpr int kRays = kRaysIn<Packet>;
  BacksPassed* const passed = context.passed;
  alignas(64) int again[kRays];
  bool any = false;
  for (int lane = 0; lane < kRays; ++lane) {
    const bool hidden = valid[lane] != 0 && packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID &&
                        passed[lane].nearest < packet.ray.tfar[lane] && packet.ray.tfar[lane] <= passed[lane].farthest;
    again[lane] = hidden ? -1 : 0;
    any = any || hidden;
  }
  const float near = float(view_.camera.near_depth());
  if (any) {
    Packet shorter = packet;
    for (int lane = 0; lane < kRays; ++lane) {
      if (again[lane] == 0) continue;
      passed[lane] = {};
      shorter.ray.tfar[lane] = std::nextafter(packet.ray.tfar[lane], 0.0f);
      shorter.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    scumble::Cast(again, scene_.handle(), &context.embree, shorter);
  }
  for (int lane = 0; lane < kRays; ++lane) {
    const float last = passed[lane].farthest, met = packet.ray.tfar[lane];
    clear_from[lane] = last > near && last < met ? 0.5f * (last + met) : near;
  }
}

// A square is a packet of 16 rays or two of 8.
template <class Packet>
void TileCaster::CastPackets(const Tile& tile, const TileRays& rays, bool find_clear, TileHits& hits) const {
  constexpr int kRays = kRaysIn<Packet>;
  constexpr int kRows = kRays / kSquareSide;
  CastContext context(true);
  std::array<BacksPassed, kRays> passed;
  if (find_clear && backs_) context.passed = passed.data();
  Packet packet = {};
  alignas(64) int valid[kRays];
  // Of the packets in a column and in a row of them.
  alignas(64) std::array<std::array<float, kRays>, kTileSquares> across;
  alignas(64) std::array<std::array<float, kRays>, kTileSide / kRows> up;
  for (int lane = 0; lane < kRays; ++lane) {
    SetLane(packet.ray, lane, SeenBy(view_.camera, ViewRay()));
    valid[lane] = -1;
    for (int i = 0; i < kTileSquares; ++i) {
      across[std::size_t(i)][std::size_t(lane)] = float(rays.across[std::size_t(i * kSquareSide + lane % kSquareSide)]);
    }
    for (int i = 0; i < kTileSide / kRows; ++i) {
      up[std::size_t(i)][std::size_t(lane)] = float(rays.up[std::size_t(i * kRows + lane / kSquareSide)]);
    }
  }
  const bool whole = tile.width == kTileSide && tile.height == kTileSide;
  const float far = float(view_.camera.far_depth());
  float* const packet_across = rays.orthographic ? packet.ray.org_x : packet.ray.dir_x;
  float* const packet_up = rays.orthographic ? packet.ray.org_y : packet.ray.dir_y;
  for (int row = 0; row < tile.height; row += kRows) {
    std::copy_n(up[std::size_t(row / kRows)].data(), kRays, packet_up);
    for (int column = 0; column < tile.width; column += kSquareSide) {
      std::copy_n(across[std::size_t(column / kSquareSide)].data(), kRays, packet_across);
      std::fill_n(packet.ray.tfar, kRays, far);
      std::fill_n(packet.hit.geomID, kRays, RTC_INVALID_GEOMETRY_ID);
      for (int lane = 0; !whole && lane < kRays; ++lane) {
        valid[lane] = column + lane % kSquareSide < tile.width && row + lane / kSquareSide < tile.height ? -1 : 0;
      }
      if (context.passed) passed.fill({});
      scumble::Cast(valid, scene_.handle(), &context.embree, packet);
      const std::size_t first = std::size_t(TilePixel(column, row));
      std::copy_n(packet.hit.geomID, kRays, hits.object.data() + first);
      std::copy_n(packet.hit.primID, kRays, hits.primitive.data() + first);
      if (context.passed) FindClear(packet, valid, context, hits.clear_from.data() + first);
    }
  }
}

void TileCaster::CastCentres(const Tile& tile, const TileRays& rays, bool find_clear, TileHits& hits) const {
  if (tile.width < kTileSide || tile.height < kTileSide) hits.object.fill(TileHits::kNothing);
  if (find_clear && !backs_) hits.clear_from.fill(float(view_.camera.near_depth()));
  if (scene_.wide_packets()) {
    CastPackets<RTCRayHit16>(tile, rays, find_clear, hits);
  } else {
    CastPackets<RTCRayHit8>(tile, rays, find_clear, hits);
  }
}

// Pixels that are covered all over without casting a ray. Where the centres of a pixel and of its four neighbours see
// the same triangle, the triangle's picture is convex and holds the diamond between those centres, and with it the
// whole pixel. The same goes for a sphere. Nothing follows for surfaces with holes, nor at the tile's border.
TileCaster::Mask TileCaster::FindWhole(const Tile& tile, const TileHits& hits) const {
  Mask whole;
  for (int row = 1; row < tile.height - 1; ++row) {
    for (int column = 1; column < tile.width - 1; ++column) {
      const int pixel = TilePixel(column, row);
      if (!hits.Met(pixel) || MayHaveHoles(*scene_.objects()[hits.object[pixel]].material)) continue;
      whole[pixel] = true;
      for (const int neighbour : {TilePixel(column - 1, row), TilePixel(column + 1, row), TilePixel(column, row - 1),
                                  TilePixel(column, row + 1)}) {
        whole[pixel] = whole[pixel] && hits.object[neighbour] == hits.object[pixel] &&
                       hits.primitive[neighbour] == hits.primitive[pixel];
      }
    }
  }
  return whole;
}

std::array<TileCaster::Samples, kTilePixels> TileCaster::CastSubsamples(const Tile& tile, const Mask& whole) const {
  const CameraRays& camera = view_.camera;
  std::array<Samples, kTilePixels> covered;
  OcclusionBatch<std::pair<int, int>> batch(scene_.handle(), true);
  const auto report = [&](const std::pair<int, int>& tag, bool blocked) {
    if (blocked) covered[tag.first].set(tag.second);
  };
  ForEachPixel(tile, [&](int pixel) {
    if (whole[pixel]) return;
    for (int rank = 0; rank < int(offsets_.size()); ++rank) {
      const ViewRay ray =
          camera.Through(tile.x0 + TileColumn(pixel) + offsets_[rank].x, tile.y0 + TileRow(pixel) + offsets_[rank].y);
      batch.Add(SeenBy(camera, ray), {pixel, rank}, report);
    }
  });
  batch.Flush(report);
  return covered;
}

// Looks for a surface at the covered subsamples, nearest first, and returns how many rays that took. The nearest nearly
// always has it; a ray that grazes an edge may be blocked in one packet and pass alone.
std::size_t TileCaster::CastMissed(const Tile& tile, Samples samples, int pixel, TileScratch& scratch) const {
  const CameraRays& camera = view_.camera;
  std::size_t cast = 0;
  for (std::size_t rank = 0; rank < offsets_.size(); ++rank) {
    if (!samples.test(rank)) continue;
    ++cast;
    const double x = tile.x0 + TileColumn(pixel) + offsets_[rank].x;
    const double y = tile.y0 + TileRow(pixel) + offsets_[rank].y;
    RTCRayHit8 packet = {};
    SetLane(packet.ray, 0, SeenBy(camera, camera.Through(x, y)));
    packet.hit.geomID[0] = RTC_INVALID_GEOMETRY_ID;
    alignas(32) const int valid[kPacket] = {-1};
    CastContext context(true);
    std::array<BacksPassed, kPacket> passed;
    context.passed = passed.data();
    scumble::Cast(valid, scene_.handle(), &context.embree, packet);
    if (packet.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) continue;
    scratch.hits.object[pixel] = packet.hit.geomID[0];
    scratch.hits.primitive[pixel] = packet.hit.primID[0];
    std::array<float, kPacket> clear_from;
    FindClear(packet, valid, context, clear_from.data());
    scratch.hits.clear_from[pixel] = clear_from[0];
    scratch.moved.push_back({pixel, {x, y}});
    break;
  }
  return cast;
}

// Fills the coverage, and gives pixels whose centre misses what their nearest covered subsample sees. A pixel whose
// centre is hit counts as one subsample at least, so that nothing thin is lost between them.
void TileCaster::Cover(const Tile& tile, TileScratch& scratch, RayCounts& counts) const {
  const std::size_t per_pixel = offsets_.size();
  if (per_pixel == 1) {
    for (std::size_t pixel = 0; pixel < kTilePixels; ++pixel) {
      scratch.coverage[pixel] = scratch.hits.object[pixel] != TileHits::kNothing ? 1.0f : 0.0f;
    }
    return;
  }
  const Mask whole = FindWhole(tile, scratch.hits);
  const std::array<Samples, kTilePixels> covered = CastSubsamples(tile, whole);
  counts.coverage += per_pixel * (std::size_t(tile.width) * tile.height - whole.count());
  ForEachPixel(tile, [&](int pixel) {
    std::size_t count = whole[pixel] ? per_pixel : covered[pixel].count();
    if (scratch.hits.Met(pixel)) {
      count = std::max<std::size_t>(count, 1);
    } else if (count > 0) {
      counts.coverage += CastMissed(tile, covered[pixel], pixel, scratch);
      if (!scratch.hits.Met(pixel)) count = 0;
    }
    scratch.coverage[pixel] = float(double(count) / double(per_pixel));
  });
}

glm::dvec2 TileCaster::MotionOf(const TileHits& hits, int pixel, const glm::dvec2& barycentric) const {
  const PlacedObject& next = view_.next_objects[hits.object[pixel]];
  if (!next.mesh) return glm::dvec2(0.0);
  // Both frames by the same sums, so that what stands still moves by exactly 0.
  const auto seen_at = [&](const PlacedObject& object, const CameraRays& camera) {
    const Triangle triangle = ViewTriangle(object, hits.primitive[pixel]);
    return camera.PixelOf(triangle.corner[0] + (triangle.corner[1] - triangle.corner[0]) * barycentric.x +
                          (triangle.corner[2] - triangle.corner[0]) * barycentric.y);
  };
  const std::optional<glm::dvec2> from = seen_at(scene_.objects()[hits.object[pixel]], view_.camera);
  const std::optional<glm::dvec2> to = seen_at(next, view_.next_camera);
  return from && to ? *to - *from : glm::dvec2(0.0);
}

// What no vector can tell: spheres, normal maps, degenerate triangles, rays that do not go through a pixel's centre.
void TileCaster::WritePlain(int pixel, const glm::dvec2& at, TileScratch& scratch) const {
  const TileHits& hits = scratch.hits;
  const PlacedObject& object = scene_.objects()[hits.object[pixel]];
  const ViewRay ray = view_.camera.Through(at.x, at.y);
  const SurfacePoint point = FindSurfacePoint(object, hits.primitive[pixel], ray);
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
    const glm::dvec3 normal = RotateToEye(point.normal, view_.camera.Through(at.x, at.y));
    for (int i = 0; i < 3; ++i) scratch.guides.normal[i][pixel] = float(normal[i]);
  }
  if (planes_.position[0]) Store(planes_.position, index, view_.camera.WorldFromView(point.position));
  if (planes_.pref[0]) {
    const glm::dvec3 rest = object.mesh ? RestPosition(object, hits.primitive[pixel], point.barycentric)
                                        : FindSurfacePoint(object, 0, view_.camera.Through(at.x, at.y)).rest_position;
    Store(planes_.pref, index, rest);
  }
  if (planes_.albedo[0]) {
    Store(planes_.albedo, index, glm::dvec3(SurfaceColor(object, hits.primitive[pixel], point.barycentric)));
  }
  if (planes_.motion[0]) {
    const glm::dvec2 motion = MotionOf(hits, pixel, point.barycentric);
    for (int i = 0; i < 2; ++i) planes_.motion[i][index] = float(motion[i]);
  }
  if (!lit_) return;
  scratch.lit[pixel] = point;
  scratch.lit[pixel].max_ray_offset = MaxRayOffset(view_.camera.Through(at.x, at.y), hits.clear_from[pixel], point.position);
}

void TileCaster::Light(const Tile& tile, const TileHits& hits, const std::vector<SurfacePoint>& points,
                       Share& share) const {
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
  ForEachPixel(tile, [&](int pixel) {
    if (!hits.Met(pixel)) return;
    const std::size_t index = Index(tile, pixel);
    if (lights_.CanBeMet()) {
      if (!share.gate.Continue()) return;  // thousands of samples may follow
      const Sampler sampler(std::uint32_t(index), kAreaLightStream, options_.seed);
      const AreaLighting lighting = SampleAreaLights(scene_, lights_, points[pixel], sampler, options_.samples, share.rays);
      reached[pixel] += lighting.reached;
      unoccluded[pixel] += lighting.unoccluded;
    }
    // Each light is within float's range; their sum need not be.
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    if (planes_.luminance) planes_.luminance[index] = float(std::min(reached[pixel], kMaxFloat));
    if (planes_.shadow && unoccluded[pixel] > 0.0) {
      planes_.shadow[index] = float(1.0 - reached[pixel] / unoccluded[pixel]);
    }
  });
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

void TileCaster::Fill(const Tile& tile, TriangleCache& triangles, TileScratch& scratch, Share& share,
                      std::vector<PathPixel>* pixels) const {
  const TileHits& hits = scratch.hits;
  scratch.moved.clear();
  Cover(tile, scratch, share.rays);
  FindTileSurface(hits, scratch.rays, triangles, scratch.guides, points_ ? &scratch.points : nullptr);
  for (int i = 0; i < scratch.guides.left_over_count; ++i) {
    const int pixel = scratch.guides.left_over[std::size_t(i)];
    WritePlain(pixel, Centre(tile, pixel), scratch);
  }
  for (const Moved& moved : scratch.moved) WritePlain(moved.pixel, moved.at, scratch);

  for (const Plane& plane : planes_.others) FillTile(tile, plane.background, plane.values, width_);
  if (points_ || pixels) {
    ForEachPixel(tile, [&](int pixel) {
      if (!hits.Met(pixel)) return;
      const auto found = std::find_if(scratch.moved.begin(), scratch.moved.end(),
                                      [&](const Moved& moved) { return moved.pixel == pixel; });
      const glm::dvec2 at = found != scratch.moved.end() ? found->at : Centre(tile, pixel);
      if (points_) WriteOthers(tile, pixel, at, scratch);
      if (pixels) {
        pixels->push_back({std::uint32_t(Index(tile, pixel)), hits.object[pixel], hits.primitive[pixel], at,
                           hits.clear_from[pixel]});
      }
    });
  }
  // Where nothing shines, luminance and shadow keep their background value, which is 0.
  if (lit_) Light(tile, hits, scratch.lit, share);
}

void TileCaster::Cast(std::span<const Tile> tiles, Scratch& scratch, Share& share,
                      std::span<std::vector<PathPixel>> pixels) const {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    TileScratch& own = scratch.tiles[i];
    PlaceRays(tiles[i], own.rays);
    CastCentres(tiles[i], own.rays, lit_ || !pixels.empty(), own.hits);
    share.rays.primary += std::size_t(tiles[i].width) * tiles[i].height;
  }
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    Fill(tiles[i], scratch.triangles, scratch.tiles[i], share, pixels.empty() ? nullptr : &pixels[i]);
  }
  WriteWhole(tiles, scratch);
}

}  // namespace scumble
