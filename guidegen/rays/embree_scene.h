// Embree's device and committed scene, relative to the camera. Only tile_caster.cpp and single_ray.cpp cast into it.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/image/progress.h"
#include "core/image/status.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// The place on an emissive mesh that a shadow ray goes to. It does not shade itself. So the triangle that was sampled
// does not count, wherever Embree's floats put it. Nor do emissive surfaces so near the ray's end that they may be the
// sampled place: the next triangle, or the next part of a light that was cut into several meshes.
struct ShadowTarget {
  const PlacedObject* object = nullptr;
  std::uint32_t primitive = 0;
  float near_end = 1.0f;  // in lengths of the ray's direction
};

// Where a camera ray passed backs of single-sided surfaces, in lengths of its direction. Embree visits boxes in its own
// order, so backs behind the hit may be among them.
struct BacksPassed {
  float nearest = std::numeric_limits<float>::infinity();
  float farthest = -std::numeric_limits<float>::infinity();
};

// What Embree hands to filter functions. Camera rays do not see the back of single-sided surfaces; shadow rays do,
// because a wall keeps its shadow when it is cut away for the viewer.
struct CastContext {
  explicit CastContext(bool for_camera_rays) : camera_rays(for_camera_rays) {
    rtcInitIntersectContext(&embree);
    embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  }
  RTCIntersectContext embree;  // first: Embree passes its address on
  bool camera_rays;
  ShadowTarget target;
  BacksPassed* passed = nullptr;  // by a ray's id; null: not recorded
};

// Owns a device and a scene in view space, one geometry for each object. Casting rays from several threads is safe.
class EmbreeScene {
 public:
  // `isa` as in GuidegenOptions; one that is unknown, or that this machine or this build of Embree lacks, is a kUsage
  // error. Builds in the calling thread's oneTBB arena, whose size is the only limit: Embree's own "threads=" would
  // throttle oneTBB for the whole process. The hierarchy is the same at any thread count. Triangles with corners that
  // are not finite are left out.
  struct Needs {
    bool light_rays = false;  // rays to lights will be cast, as ShadowTarget has them, not only those of the camera
    bool emitters = false;    // emitters() will be asked for
    bool robust = true;       // as in GuidegenOptions
  };
  // While it builds, `progress` is asked with a share of 0 whether to go on; if it says no, Build fails with
  // kCancelled.
  static Expected<EmbreeScene> Build(std::vector<PlacedObject> objects, const std::string& isa, const Needs& needs,
                                     const Progress& progress = {});

  RTCScene handle() const { return scene_.get(); }
  RTCScene emitters() const { return emitters_.get(); }   // the objects that emit, under the same ids; null: none
  const std::string& isa() const { return isa_; }         // what is in use, never empty
  bool wide_packets() const { return isa_ == "avx512"; }  // whether packets of 16 rays are faster than those of 8
  const std::vector<PlacedObject>& objects() const { return *objects_; }  // by Embree's geometry id

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };

  EmbreeScene() = default;
  Status OpenDevice(const std::string& isa);
  Status Commit(const Needs& needs, const Progress& progress);

  // Filter functions keep pointers to the objects, so they must not move with this. Order matters: the scene goes
  // before its device, the device before the objects.
  std::unique_ptr<std::vector<PlacedObject>> objects_;
  std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
  std::unique_ptr<RTCSceneTy, ReleaseScene> scene_;
  std::unique_ptr<RTCSceneTy, ReleaseScene> emitters_;
  std::string isa_;
};

}  // namespace scumble
