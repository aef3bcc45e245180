// Embree 3 or 4, whichever CMake found, and the few calls in which they differ: Embree 4 takes the settings of a cast
// apart from its context, and has no streams of rays. Nothing else includes Embree.
#pragma once

#if SCUMBLE_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

namespace scumble {

enum class RayOrder { kCoherent, kIncoherent };

#if SCUMBLE_EMBREE == 3

// What goes with each cast. Filter functions receive the context's address.
struct RayQuery {
  explicit RayQuery(RayOrder order) {
    rtcInitIntersectContext(&context);
    context.flags =
        order == RayOrder::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  RTCIntersectContext context;
};

// The nearest hit of a ray, and of the rays of a packet whose `valid` is -1.
inline void Intersect(RTCScene scene, RayQuery& query, RTCRayHit& ray) { rtcIntersect1(scene, &query.context, &ray); }
inline void Intersect(const int* valid, RTCScene scene, RayQuery& query, RTCRayHit4& rays) {
  rtcIntersect4(valid, scene, &query.context, &rays);
}
inline void Intersect(const int* valid, RTCScene scene, RayQuery& query, RTCRayHit8& rays) {
  rtcIntersect8(valid, scene, &query.context, &rays);
}
inline void Intersect(const int* valid, RTCScene scene, RayQuery& query, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &query.context, &rays);
}

// Whether there is any hit: tfar is then negative.
inline void Occlude(RTCScene scene, RayQuery& query, RTCRay& ray) { rtcOccluded1(scene, &query.context, &ray); }
inline void Occlude(const int* valid, RTCScene scene, RayQuery& query, RTCRay8& rays) {
  rtcOccluded8(valid, scene, &query.context, &rays);
}

#else

struct RayQuery {
  explicit RayQuery(RayOrder order)
      : flags(order == RayOrder::kCoherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT) {
    rtcInitRayQueryContext(&context);
  }
  RTCIntersectArguments ToIntersect() {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = flags;
    arguments.context = &context;
    return arguments;
  }
  RTCOccludedArguments ToOcclude() {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = flags;
    arguments.context = &context;
    return arguments;
  }
  RTCRayQueryContext context;
  RTCRayQueryFlags flags;
};

inline void Intersect(RTCScene scene, RayQuery& query, RTCRayHit& ray) {
  RTCIntersectArguments arguments = query.ToIntersect();
  rtcIntersect1(scene, &ray, &arguments);
}
inline void Intersect(const int* valid, RTCScene scene, RayQuery& query, RTCRayHit4& rays) {
  RTCIntersectArguments arguments = query.ToIntersect();
  rtcIntersect4(valid, scene, &rays, &arguments);
}
inline void Intersect(const int* valid, RTCScene scene, RayQuery& query, RTCRayHit8& rays) {
  RTCIntersectArguments arguments = query.ToIntersect();
  rtcIntersect8(valid, scene, &rays, &arguments);
}
inline void Intersect(const int* valid, RTCScene scene, RayQuery& query, RTCRayHit16& rays) {
  RTCIntersectArguments arguments = query.ToIntersect();
  rtcIntersect16(valid, scene, &rays, &arguments);
}

inline void Occlude(RTCScene scene, RayQuery& query, RTCRay& ray) {
  RTCOccludedArguments arguments = query.ToOcclude();
  rtcOccluded1(scene, &ray, &arguments);
}
inline void Occlude(const int* valid, RTCScene scene, RayQuery& query, RTCRay8& rays) {
  RTCOccludedArguments arguments = query.ToOcclude();
  rtcOccluded8(valid, scene, &rays, &arguments);
}

#endif

}  // namespace scumble
