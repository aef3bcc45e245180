// The minimum cost of a picture's rays: Embree alone over the same triangles and the same rays, in every kind of packet
// that it has. Only the hits' distances are kept.
#pragma once

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "guidegen/rays/embree.h"
#include "guidegen/scene.h"

namespace scumble::testing {

enum class BareKind { kSingle, kPacket4, kPacket8, kPacket16 };
inline constexpr std::array<BareKind, 4> kBareKinds = {BareKind::kSingle, BareKind::kPacket4, BareKind::kPacket8,
                                                       BareKind::kPacket16};
inline const char* NameOf(BareKind kind) {
  constexpr const char* kNames[] = {"rtcIntersect1", "rtcIntersect4", "rtcIntersect8", "rtcIntersect16"};
  return kNames[int(kind)];
}

class BareEmbree {
 public:
  // A perspective camera at z = `distance` that looks down −Z with a vertical angle of 2 atan(`half`).
  BareEmbree(const Scene& source, int width, int height, double distance, double half)
      : width_(width), height_(height), device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    for (const Instance& instance : source.instances) {
      Add(source.meshes[std::size_t(instance.mesh)], instance.world_from_object, distance);
    }
    rtcCommitScene(scene_);
    for (int x = 0; x < width; ++x) across_.push_back(float((2.0 * (x + 0.5) - width) * half / height));
    for (int y = 0; y < height; ++y) up_.push_back(float((height - 2.0 * (y + 0.5)) * half / height));
  }
  ~BareEmbree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareEmbree(const BareEmbree&) = delete;
  BareEmbree& operator=(const BareEmbree&) = delete;

  // Tiles of 16 × 16 pixels, as guidegen's.
  void Cast(BareKind kind, int threads, float* depth) const {
    const int columns = (width_ + kSide - 1) / kSide;
    const int rows = (height_ + kSide - 1) / kSide;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      tbb::parallel_for(0, columns * rows,
                        [&](int i) { CastTile(kind, i % columns * kSide, i / columns * kSide, depth); });
    });
  }

 private:
  static constexpr int kSide = 16;

  // N rays of a Packet in blocks of `Width` columns; `intersect(valid, query, packet)`.
  template <int N, int Width, class Packet, class Intersect>
  void CastBlocks(int x0, int y0, float* depth, const Intersect& intersect) const {
    RayQuery query(RayOrder::kCoherent);
    alignas(64) Packet packet = {};
    alignas(64) std::array<int, N> valid;
    valid.fill(-1);
    std::fill_n(packet.ray.dir_z, N, -1.0f);
    std::fill_n(packet.ray.mask, N, ~0u);
    for (int y = y0; y < std::min(y0 + kSide, height_); y += N / Width) {
      for (int x = x0; x < std::min(x0 + kSide, width_); x += Width) {
        for (int lane = 0; lane < N; ++lane) {
          packet.ray.dir_x[lane] = across_[std::size_t(std::min(x + lane % Width, width_ - 1))];
          packet.ray.dir_y[lane] = up_[std::size_t(std::min(y + lane / Width, height_ - 1))];
          packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
          packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        }
        intersect(valid.data(), query, packet);
        for (int lane = 0; lane < N; ++lane) {
          const int column = x + lane % Width;
          const int row = y + lane / Width;
          if (column < width_ && row < height_) depth[std::size_t(row) * width_ + column] = packet.ray.tfar[lane];
        }
      }
    }
  }

  template <int N, int Width, class Packet>
  void CastPackets(int x0, int y0, float* depth) const {
    CastBlocks<N, Width, Packet>(x0, y0, depth, [&](const int* valid, RayQuery& query, Packet& packet) {
      Intersect(valid, scene_, query, packet);
    });
  }

  void CastTile(BareKind kind, int x0, int y0, float* depth) const {
    switch (kind) {
      case BareKind::kSingle:
        return CastBlocks<1, 1, RTCRayHitNt<1>>(x0, y0, depth, [&](const int*, RayQuery& query, auto& ray) {
          RTCRayHit one = {};
          one.ray.dir_x = ray.ray.dir_x[0];
          one.ray.dir_y = ray.ray.dir_y[0];
          one.ray.dir_z = -1.0f;
          one.ray.mask = ~0u;
          one.ray.tfar = ray.ray.tfar[0];
          one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
          Intersect(scene_, query, one);
          ray.ray.tfar[0] = one.ray.tfar;
        });
      case BareKind::kPacket4:
        return CastPackets<4, 2, RTCRayHit4>(x0, y0, depth);
      case BareKind::kPacket8:
        return CastPackets<8, 4, RTCRayHit8>(x0, y0, depth);
      case BareKind::kPacket16:
        return CastPackets<16, 4, RTCRayHit16>(x0, y0, depth);
    }
  }

  void Add(const Mesh& mesh, const glm::dmat4& world_from_object, double distance) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::dvec3 position(world_from_object * glm::dvec4(mesh.positions[i], 1.0f));
      vertices[3 * i] = float(position.x);
      vertices[3 * i + 1] = float(position.y);
      vertices[3 * i + 2] = float(position.z - distance);
    }
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (int corner = 0; corner < 3; ++corner) indices[3 * i + std::size_t(corner)] = mesh.triangles[i][corner];
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  int width_, height_;
  RTCDevice device_;
  RTCScene scene_;
  std::vector<float> across_, up_;
};

}  // namespace scumble::testing
