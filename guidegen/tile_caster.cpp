#include "guidegen/tile_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "guidegen/soft_light.h"
#include "image/check.h"

namespace scumble {
namespace {

constexpr int kPacket = 8;
constexpr int kPacketWidth = 4;
constexpr int kPacketHeight = 2;

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
  packet.id[lane] = 0;
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

// The sampler's stream for luminance and shadow: not the light paths' own.
constexpr std::uint32_t kSoftStream = 1;

}  // namespace

TileCaster::TileCaster(const EmbreeScene& scene, const View& view, const GuidegenOptions& options, GuideSet& guides)
    : scene_(scene),
      view_(view),
      options_(options),
      width_(guides.width()),
      lights_(view.lights, LitObjects(scene, guides), view.world_radiance) {
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
}

void TileCaster::CastCentres(const Tile& tile, Hits& hits) const {
  const CameraRays& camera = view_.camera;
  CastContext context(true);
  RTCRayHit8 packet = {};
  alignas(32) int valid[kPacket];
  for (int y = 0; y < tile.height; y += kPacketHeight) {
    for (int x = 0; x < tile.width; x += kPacketWidth) {
      for (int lane = 0; lane < kPacket; ++lane) {
        const int column = x + lane % kPacketWidth;
        const int row = y + lane / kPacketWidth;
        valid[lane] = column < tile.width && row < tile.height ? -1 : 0;
        Hit& hit = hits[row * kTileSide + column];
        hit.x = tile.x0 + column + 0.5;
        hit.y = tile.y0 + row + 0.5;
        SetLane(packet.ray, lane, SeenBy(camera, camera.Through(hit.x, hit.y)));
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect8(valid, scene_.handle(), &context.embree, &packet);
      for (int lane = 0; lane < kPacket; ++lane) {
        if (valid[lane] == 0 || packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
        Hit& hit = hits[(y + lane / kPacketWidth) * kTileSide + x + lane % kPacketWidth];
        hit.object = packet.hit.geomID[lane];
        hit.primitive = packet.hit.primID[lane];
        hit.u = packet.hit.u[lane];
        hit.v = packet.hit.v[lane];
      }
    }
  }
}

// Pixels that are covered all over without casting a ray. Where the centres of a pixel and of its four neighbours see
// the same triangle, the triangle's picture is convex and holds the diamond between those centres, and with it the
// whole pixel. The same goes for a sphere. Nothing follows for surfaces with holes, nor at the tile's border.
TileCaster::Mask TileCaster::FindWhole(const Tile& tile, const Hits& hits) const {
  Mask whole;
  for (int row = 1; row < tile.height - 1; ++row) {
    for (int column = 1; column < tile.width - 1; ++column) {
      const int pixel = row * kTileSide + column;
      const Hit& hit = hits[pixel];
      if (hit.object == kNothing || MayHaveHoles(*scene_.objects()[hit.object].material)) continue;
      whole[pixel] = true;
      for (const int neighbour : {pixel - 1, pixel + 1, pixel - kTileSide, pixel + kTileSide}) {
        const Hit& other = hits[neighbour];
        whole[pixel] = whole[pixel] && other.object == hit.object && other.primitive == hit.primitive;
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
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) {
      if (whole[row * kTileSide + column]) continue;
      for (int rank = 0; rank < int(offsets_.size()); ++rank) {
        const ViewRay ray = camera.Through(tile.x0 + column + offsets_[rank].x, tile.y0 + row + offsets_[rank].y);
        batch.Add(SeenBy(camera, ray), {row * kTileSide + column, rank}, report);
      }
    }
  }
  batch.Flush(report);
  return covered;
}

// Looks for a surface at the covered subsamples, nearest first, and returns how many rays that took. The nearest nearly
// always has it; a ray that grazes an edge may be blocked in one packet and pass alone.
std::size_t TileCaster::CastMissed(const Tile& tile, Samples samples, int pixel, Hit& hit) const {
  const CameraRays& camera = view_.camera;
  std::size_t cast = 0;
  for (std::size_t rank = 0; rank < offsets_.size(); ++rank) {
    if (!samples.test(rank)) continue;
    ++cast;
    const double x = tile.x0 + pixel % kTileSide + offsets_[rank].x;
    const double y = tile.y0 + pixel / kTileSide + offsets_[rank].y;
    RTCRayHit8 packet = {};
    SetLane(packet.ray, 0, SeenBy(camera, camera.Through(x, y)));
    packet.hit.geomID[0] = RTC_INVALID_GEOMETRY_ID;
    alignas(32) const int valid[kPacket] = {-1};
    CastContext context(true);
    rtcIntersect8(valid, scene_.handle(), &context.embree, &packet);
    if (packet.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) continue;
    hit = {packet.hit.geomID[0], packet.hit.primID[0], packet.hit.u[0], packet.hit.v[0], x, y};
    break;
  }
  return cast;
}

// Fills the coverage, and gives pixels whose centre misses what their nearest covered subsample sees. A pixel whose
// centre is hit counts as one subsample at least, so that nothing thin is lost between them.
void TileCaster::Cover(const Tile& tile, Hits& hits, RayCounts& counts) const {
  const std::size_t per_pixel = offsets_.size();
  if (per_pixel == 1) {
    for (int row = 0; row < tile.height; ++row) {
      for (int column = 0; column < tile.width; ++column) {
        const int pixel = row * kTileSide + column;
        planes_.coverage[Index(tile, pixel)] = hits[pixel].object != kNothing ? 1.0f : 0.0f;
      }
    }
    return;
  }
  const Mask whole = FindWhole(tile, hits);
  const std::array<Samples, kTilePixels> covered = CastSubsamples(tile, whole);
  counts.coverage += per_pixel * (std::size_t(tile.width) * tile.height - whole.count());
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) {
      const int pixel = row * kTileSide + column;
      std::size_t count = whole[pixel] ? per_pixel : covered[pixel].count();
      if (hits[pixel].object != kNothing) {
        count = std::max<std::size_t>(count, 1);
      } else if (count > 0) {
        counts.coverage += CastMissed(tile, covered[pixel], pixel, hits[pixel]);
        if (hits[pixel].object == kNothing) count = 0;
      }
      planes_.coverage[Index(tile, pixel)] = float(double(count) / double(per_pixel));
    }
  }
}

glm::dvec2 TileCaster::MotionOf(const Hit& hit, const glm::dvec2& barycentric) const {
  const PlacedObject& next = view_.next_objects[hit.object];
  if (!next.mesh) return glm::dvec2(0.0);
  // Both frames by the same sums, so that what stands still moves by exactly 0.
  const auto pixel = [&](const PlacedObject& object, const CameraRays& camera) {
    const Triangle triangle = ViewTriangle(object, hit.primitive);
    return camera.PixelOf(triangle.corner[0] + (triangle.corner[1] - triangle.corner[0]) * barycentric.x +
                          (triangle.corner[2] - triangle.corner[0]) * barycentric.y);
  };
  const std::optional<glm::dvec2> from = pixel(scene_.objects()[hit.object], view_.camera);
  const std::optional<glm::dvec2> to = pixel(next, view_.next_camera);
  return from && to ? *to - *from : glm::dvec2(0.0);
}

SurfacePoint TileCaster::Write(std::size_t index, const Hit& hit) const {
  const PlacedObject& object = scene_.objects()[hit.object];
  const ViewRay ray = view_.camera.Through(hit.x, hit.y);
  const SurfacePoint point = FindSurfacePoint(object, hit.primitive, {hit.u, hit.v}, ray);
  planes_.depth[index] = float(std::max(-point.position.z, 0.0));
  planes_.object[index] = float(object.object_id);
  planes_.material[index] = float(object.material_id);
  const bool to_eye = options_.normal_frame == NormalFrame::kEye;
  Store(planes_.normal, index, to_eye ? RotateToEye(point.normal, ray) : point.normal);
  if (planes_.position[0]) Store(planes_.position, index, view_.camera.WorldFromView(point.position));
  Store(planes_.pref, index, point.rest_position);
  if (planes_.albedo[0]) {
    Store(planes_.albedo, index, glm::dvec3(SurfaceColor(object, hit.primitive, point.barycentric)));
  }
  if (planes_.motion[0]) {
    const glm::dvec2 motion = MotionOf(hit, point.barycentric);
    for (int i = 0; i < 2; ++i) planes_.motion[i][index] = float(motion[i]);
  }
  return point;
}

void TileCaster::Light(const Tile& tile, const Hits& hits, const std::vector<SurfacePoint>& points,
                       RayCounts& counts) const {
  std::array<double, kTilePixels> reached = {};  // shadows included
  std::array<double, kTilePixels> unoccluded = {};
  OcclusionBatch<std::pair<int, double>> batch(scene_.handle(), false);
  const auto report = [&](const std::pair<int, double>& tag, bool blocked) {
    if (!blocked) reached[tag.first] += tag.second;
  };
  for (const PlacedLight& light : view_.lights) {
    if (!light.IsDelta()) continue;
    for (int pixel = 0; pixel < kTilePixels; ++pixel) {
      if (hits[pixel].object == kNothing) continue;
      const LightSample sample = SampleLight(light, points[pixel]);
      if (!(sample.luminance > 0.0)) continue;
      unoccluded[pixel] += sample.luminance;
      ++counts.shadow;
      const glm::dvec3 origin = ShadowRayOrigin(points[pixel]);
      const glm::dvec3 way = sample.endless ? sample.to_light : light.position - origin;
      const double reach = sample.endless ? std::numeric_limits<double>::infinity() : kShadowReach;
      batch.Add({origin, way, 0.0, reach}, {pixel, sample.luminance}, report);
    }
    batch.Flush(report);
  }
  for (int pixel = 0; pixel < kTilePixels; ++pixel) {
    if (hits[pixel].object == kNothing) continue;
    const std::size_t index = Index(tile, pixel);
    if (lights_.CanBeMet()) {
      const Sampler sampler(std::uint32_t(index), kSoftStream, options_.seed);
      const SoftLight soft = SampleSoftLight(scene_, lights_, points[pixel], sampler, options_.samples, counts);
      reached[pixel] += soft.reached;
      unoccluded[pixel] += soft.unoccluded;
    }
    // Each light is within float's range; their sum need not be.
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    if (planes_.luminance) planes_.luminance[index] = float(std::min(reached[pixel], kMaxFloat));
    if (planes_.shadow && unoccluded[pixel] > 0.0) {
      planes_.shadow[index] = float(1.0 - reached[pixel] / unoccluded[pixel]);
    }
  }
}

void TileCaster::Cast(const Tile& tile, RayCounts& counts, std::vector<PathPixel>* pixels) const {
  Hits hits;
  CastCentres(tile, hits);
  counts.primary += std::size_t(tile.width) * tile.height;
  Cover(tile, hits, counts);
  const bool lit = (planes_.luminance || planes_.shadow) && !lights_.empty();
  std::vector<SurfacePoint> points(lit ? kTilePixels : 0);
  for (int pixel = 0; pixel < kTilePixels; ++pixel) {
    if (hits[pixel].object == kNothing) continue;
    const SurfacePoint point = Write(Index(tile, pixel), hits[pixel]);
    if (lit) points[pixel] = point;
    if (pixels) {
      const Hit& hit = hits[pixel];
      pixels->push_back({std::uint32_t(Index(tile, pixel)), hit.object, hit.primitive, {hit.u, hit.v}, {hit.x, hit.y}});
    }
  }
  // Where nothing shines, luminance and shadow keep their background value, which is 0.
  if (lit) Light(tile, hits, points, counts);
}

}  // namespace scumble
