// Embree's packets of any-hit rays.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <utility>

#include "guidegen/rays/embree_scene.h"

namespace scumble {

inline constexpr int kPacket = 8;  // any-hit rays

// A ray and the part of it, in lengths of its direction, on which surfaces count.
struct Segment {
  glm::dvec3 origin;
  glm::dvec3 direction;
  double near;
  double far;
};

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
    Occlude(valid, scene_, context_.query, packet_);
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

}  // namespace scumble
