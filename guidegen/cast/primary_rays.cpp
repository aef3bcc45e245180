#include "guidegen/cast/primary_rays.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/image/fragments.h"
#include "guidegen/cast/ray_packets.h"

namespace scumble {
namespace {

template <class Packet>
constexpr int kRaysIn = sizeof(Packet::hit.geomID) / sizeof(unsigned);

}  // namespace

PrimaryRays::PrimaryRays(const EmbreeScene& scene, const CameraRays& camera, int width, int height, int aa)
    : scene_(scene), camera_(camera), backs_(!AllDoubleSided(scene.objects())) {
  const int n = aa;
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
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> surfaces;
  for (const PlacedObject& object : scene.objects()) surfaces[{object.object_id, object.material_id}] = 0;
  std::uint32_t number = 0;
  for (auto& [ids, surface] : surfaces) surface = number++;
  for (const PlacedObject& object : scene.objects()) {
    surfaces_.push_back(surfaces.at({object.object_id, object.material_id}));
  }
  one_surface_ = surfaces.size() < 2;
  // Pixels differ in the ray's origin or in its direction, depending on the camera's kind.
  const auto moved = [&](double x, double y) {
    const ViewRay ray = camera.Through(x, y);
    return camera.orthographic() ? ray.origin : ray.direction;
  };
  for (int x = 0; x < width + kTileSide; ++x) across_.push_back(moved(x + 0.5, 0.5).x);
  for (int y = 0; y < height + kTileSide; ++y) up_.push_back(moved(0.5, y + 0.5).y);
}

void PrimaryRays::PlaceRays(const Tile& tile, TileRays& rays) const {
  rays.orthographic = camera_.orthographic();
  std::copy_n(across_.begin() + tile.x0, kTileSide, rays.across.begin());
  std::copy_n(up_.begin() + tile.y0, kTileSide, rays.up.begin());
}

// The distance from which each ray of a cast packet is clear. A ray that passed backs both before and behind its hit,
// by context.passed, is cast again, only as far as that hit. The back itself may be a rounding error nearer than float
// has it, so half of the distance counts.
template <class Packet>
void PrimaryRays::FindClear(const Packet& packet, const int* valid, CastContext& context, float* clear_from) const {
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
  const float near = float(camera_.near_depth());
  if (any) {
    Packet shorter = packet;
    for (int lane = 0; lane < kRays; ++lane) {
      if (again[lane] == 0) continue;
      passed[lane] = {};
      shorter.ray.tfar[lane] = std::nextafter(packet.ray.tfar[lane], 0.0f);
      shorter.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    Intersect(again, scene_.handle(), context.query, shorter);
  }
  for (int lane = 0; lane < kRays; ++lane) {
    const float last = passed[lane].farthest, met = packet.ray.tfar[lane];
    clear_from[lane] = last > near && last < met ? 0.5f * (last + met) : near;
  }
}

// A square is a packet of 16 rays or two of 8.
template <class Packet>
void PrimaryRays::CastPackets(const Tile& tile, const TileRays& rays, bool find_clear, TileHits& hits) const {
  constexpr int kRays = kRaysIn<Packet>;
  constexpr int kRows = kRays / kSquareSide;
  CastContext context(true);
  std::array<BacksPassed, kRays> passed;
  if (find_clear && backs_) context.passed = passed.data();
  Packet packet = {};
  alignas(64) int valid[kRays];
  // The rays of the packets in a column and in a row.
  alignas(64) std::array<std::array<float, kRays>, kTileSquares> across;
  alignas(64) std::array<std::array<float, kRays>, kTileSide / kRows> up;
  for (int lane = 0; lane < kRays; ++lane) {
    SetLane(packet.ray, lane, SeenBy(camera_, ViewRay()));
    valid[lane] = -1;
    for (int i = 0; i < kTileSquares; ++i) {
      across[std::size_t(i)][std::size_t(lane)] = float(rays.across[std::size_t(i * kSquareSide + lane % kSquareSide)]);
    }
    for (int i = 0; i < kTileSide / kRows; ++i) {
      up[std::size_t(i)][std::size_t(lane)] = float(rays.up[std::size_t(i * kRows + lane / kSquareSide)]);
    }
  }
  const bool whole = tile.width == kTileSide && tile.height == kTileSide;
  const float far = float(camera_.far_depth());
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
      Intersect(valid, scene_.handle(), context.query, packet);
      const std::size_t first = std::size_t(TilePixel(column, row));
      std::copy_n(packet.hit.geomID, kRays, hits.object.data() + first);
      std::copy_n(packet.hit.primID, kRays, hits.primitive.data() + first);
      if (context.passed) FindClear(packet, valid, context, hits.clear_from.data() + first);
    }
  }
}

void PrimaryRays::CastCentres(const Tile& tile, const TileRays& rays, bool find_clear, TileHits& hits) const {
  if (tile.width < kTileSide || tile.height < kTileSide) hits.object.fill(TileHits::kNothing);
  if (find_clear && !backs_) hits.clear_from.fill(float(camera_.near_depth()));
  if (scene_.wide_packets()) {
    CastPackets<RTCRayHit16>(tile, rays, find_clear, hits);
  } else {
    CastPackets<RTCRayHit8>(tile, rays, find_clear, hits);
  }
}

// Finds pixels that are covered completely without casting a ray. If the centres of a pixel and of its four neighbours
// see one triangle, the triangle's picture is convex and holds the diamond between those centres, and so the whole
// pixel. A sphere's picture is convex too. Hair, surfaces with holes and pixels at the tile's border are never counted.
PrimaryRays::Mask PrimaryRays::FindWhole(const Tile& tile, const TileHits& hits) const {
  Mask whole;
  for (int row = 1; row < tile.height - 1; ++row) {
    for (int column = 1; column < tile.width - 1; ++column) {
      const int pixel = TilePixel(column, row);
      if (!hits.Met(pixel)) continue;
      const PlacedObject& object = scene_.objects()[hits.object[pixel]];
      if (MayHaveHoles(*object.material) || (object.mesh && object.mesh->IsCurves())) continue;
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

std::array<PrimaryRays::Samples, kTilePixels> PrimaryRays::CastSubsamples(const Tile& tile, const Mask& whole) const {
  std::array<Samples, kTilePixels> covered;
  OcclusionBatch<std::pair<int, int>> batch(scene_.handle(), true);
  const auto report = [&](const std::pair<int, int>& tag, bool blocked) {
    if (blocked) covered[tag.first].set(tag.second);
  };
  ForEachPixel(tile, [&](int pixel) {
    if (whole[pixel]) return;
    for (int rank = 0; rank < int(offsets_.size()); ++rank) {
      const ViewRay ray =
          camera_.Through(tile.x0 + TileColumn(pixel) + offsets_[rank].x, tile.y0 + TileRow(pixel) + offsets_[rank].y);
      batch.Add(SeenBy(camera_, ray), {pixel, rank}, report);
    }
  });
  batch.Flush(report);
  return covered;
}

// CastSubsamples by the same packets of rays, for which any hit would not do: they find the nearest surface.
std::array<PrimaryRays::Samples, kTilePixels> PrimaryRays::FindSubsamples(const Tile& tile, const Mask& whole,
                                                                          SubsampleHits& seen) const {
  std::array<Samples, kTilePixels> covered;
  const std::size_t per_pixel = offsets_.size();
  seen.object.resize(kTilePixels * per_pixel), seen.primitive.resize(kTilePixels * per_pixel);
  CastContext context(true);
  RTCRayHit8 packet = {};
  std::array<std::pair<int, int>, kPacket> tags = {};  // pixel and rank
  int count = 0;
  const auto flush = [&] {
    alignas(32) int valid[kPacket];
    for (int lane = 0; lane < kPacket; ++lane) {
      valid[lane] = lane < count ? -1 : 0;
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    Intersect(valid, scene_.handle(), context.query, packet);
    for (int lane = 0; lane < count; ++lane) {
      const auto [pixel, rank] = tags[std::size_t(lane)];
      const std::size_t place = std::size_t(pixel) * per_pixel + std::size_t(rank);
      seen.object[place] = packet.hit.geomID[lane], seen.primitive[place] = packet.hit.primID[lane];
      if (packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID) covered[std::size_t(pixel)].set(std::size_t(rank));
    }
    count = 0;
  };
  ForEachPixel(tile, [&](int pixel) {
    if (whole[pixel]) return;
    for (int rank = 0; rank < int(per_pixel); ++rank) {
      const ViewRay ray =
          camera_.Through(tile.x0 + TileColumn(pixel) + offsets_[rank].x, tile.y0 + TileRow(pixel) + offsets_[rank].y);
      SetLane(packet.ray, count, SeenBy(camera_, ray));
      tags[std::size_t(count)] = {pixel, rank};
      if (++count == kPacket) flush();
    }
  });
  if (count > 0) flush();
  return covered;
}

// The surfaces of a pixel besides that of its hit. That one counts as at least one subsample, as for coverage.
void PrimaryRays::FindBeside(const Tile& tile, int pixel, const TileHits& hits, const Samples& covered,
                             const SubsampleHits& seen, float coverage, std::vector<Beside>& beside) const {
  struct Share {
    std::uint32_t surface;
    int count;
    glm::dvec2 sum;  // of its subsamples' places
    Samples samples;
    std::uint16_t cells;
  };
  const std::size_t per_pixel = offsets_.size();
  const std::uint32_t* const object = seen.object.data() + std::size_t(pixel) * per_pixel;
  const std::uint32_t centre = surfaces_[hits.object[std::size_t(pixel)]];
  int own = 0;
  std::array<Share, kMaxAa * kMaxAa> shares;
  std::size_t count = 0;
  for (std::size_t rank = 0; rank < per_pixel; ++rank) {
    if (!covered.test(rank)) continue;
    const std::uint32_t surface = surfaces_[object[rank]];
    if (surface == centre) {
      ++own;
      continue;
    }
    const auto cell = std::uint16_t(1 << (4 * int(4 * offsets_[rank].y) + int(4 * offsets_[rank].x)));
    const auto end = shares.begin() + std::ptrdiff_t(count);
    const auto known = std::find_if(shares.begin(), end, [&](const Share& one) { return one.surface == surface; });
    if (known == end) {
      shares[count++] = {surface, 0, glm::dvec2(0.0), {}, 0};
    }
    ++known->count, known->sum += glm::dvec2(offsets_[rank].x, offsets_[rank].y), known->samples.set(rank),
        known->cells |= cell;
  }
  if (count == 0) return;
  std::sort(shares.begin(), shares.begin() + std::ptrdiff_t(count), [](const Share& a, const Share& b) {
    return a.count != b.count ? a.count > b.count : a.surface < b.surface;
  });
  count = std::min<std::size_t>(count, Fragments::kMostInPixel);
  int kept = std::max(own, 1);
  for (std::size_t i = 0; i < count; ++i) kept += shares[i].count;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec2 mean = shares[i].sum / double(shares[i].count);
    const auto off = [&](std::size_t sample) {
      const double dx = offsets_[sample].x - mean.x, dy = offsets_[sample].y - mean.y;
      return dx * dx + dy * dy;
    };
    std::size_t rank = per_pixel;
    for (std::size_t sample = 0; sample < per_pixel; ++sample) {
      if (shares[i].samples.test(sample) && (rank == per_pixel || off(sample) < off(rank))) rank = sample;
    }
    beside.push_back({pixel,
                      {tile.x0 + TileColumn(pixel) + offsets_[rank].x, tile.y0 + TileRow(pixel) + offsets_[rank].y},
                      object[rank],
                      seen.primitive[std::size_t(pixel) * per_pixel + rank],
                      float(double(coverage) * shares[i].count / kept),
                      shares[i].cells});
  }
}

// Looks for a surface at the covered subsamples, nearest first, and returns the number of rays cast. The nearest one
// nearly always has it. A ray that grazes an edge may be blocked in one packet and pass alone.
std::size_t PrimaryRays::CastMissed(const Tile& tile, Samples samples, int pixel, TileHits& hits,
                                    std::vector<Moved>& moved) const {
  std::size_t cast = 0;
  for (std::size_t rank = 0; rank < offsets_.size(); ++rank) {
    if (!samples.test(rank)) continue;
    ++cast;
    const double x = tile.x0 + TileColumn(pixel) + offsets_[rank].x;
    const double y = tile.y0 + TileRow(pixel) + offsets_[rank].y;
    RTCRayHit8 packet = {};
    SetLane(packet.ray, 0, SeenBy(camera_, camera_.Through(x, y)));
    packet.hit.geomID[0] = RTC_INVALID_GEOMETRY_ID;
    alignas(32) const int valid[kPacket] = {-1};
    CastContext context(true);
    std::array<BacksPassed, kPacket> passed;
    context.passed = passed.data();
    Intersect(valid, scene_.handle(), context.query, packet);
    if (packet.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) continue;
    hits.object[pixel] = packet.hit.geomID[0];
    hits.primitive[pixel] = packet.hit.primID[0];
    std::array<float, kPacket> clear_from;
    FindClear(packet, valid, context, clear_from.data());
    hits.clear_from[pixel] = clear_from[0];
    moved.push_back({pixel, {x, y}});
    break;
  }
  return cast;
}

std::size_t PrimaryRays::Cover(const Tile& tile, TileHits& hits, std::array<float, kTilePixels>& coverage,
                               std::vector<Moved>& moved, SubsampleHits& seen, std::vector<Beside>& beside) const {
  const std::size_t per_pixel = offsets_.size();
  if (per_pixel == 1) {
    for (std::size_t pixel = 0; pixel < kTilePixels; ++pixel) {
      coverage[pixel] = hits.object[pixel] != TileHits::kNothing ? 1.0f : 0.0f;
    }
    return 0;
  }
  const Mask whole = FindWhole(tile, hits);
  const std::array<Samples, kTilePixels> covered =
      one_surface_ ? CastSubsamples(tile, whole) : FindSubsamples(tile, whole, seen);
  std::size_t cast = per_pixel * (std::size_t(tile.width) * tile.height - whole.count());
  ForEachPixel(tile, [&](int pixel) {
    std::size_t count = whole[pixel] ? per_pixel : covered[pixel].count();
    if (hits.Met(pixel)) {
      count = std::max<std::size_t>(count, 1);
    } else if (count > 0) {
      cast += CastMissed(tile, covered[pixel], pixel, hits, moved);
      if (!hits.Met(pixel)) count = 0;
    }
    coverage[pixel] = float(double(count) / double(per_pixel));
    if (one_surface_ || whole[pixel] || count == 0) return;
    FindBeside(tile, pixel, hits, covered[pixel], seen, coverage[pixel], beside);
  });
  return cast;
}

}  // namespace scumble
