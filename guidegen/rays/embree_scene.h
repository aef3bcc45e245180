// Embree's device and committed scene, relative to the camera. Only tile_caster.cpp and single_ray.cpp cast into it.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/image/progress.h"
#include "core/image/status.h"
#include "guidegen/rays/embree.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// The point on an emissive mesh that a shadow ray aims at. It does not shade itself. So the sampled triangle does not
// count, wherever Embree's floats put it. Nor do emissive surfaces so near the ray's end that they may be the sampled
// point. Such are the next triangle, and the next part of a light that was cut into several meshes.
struct ShadowTarget {
  const PlacedObject* object = nullptr;
  std::uint32_t primitive = 0;
  float near_end = 1.0f;  // in lengths of the ray's direction
};

// The places where a camera ray passed backs of single-sided surfaces, in lengths of its direction. Embree visits boxes
// in its own order, so backs behind the hit may be among them.
struct BacksPassed {
  float nearest = std::numeric_limits<float>::infinity();
  float farthest = -std::numeric_limits<float>::infinity();
};

// The context that Embree passes to filter functions. Camera rays do not hit the back of single-sided surfaces. Shadow
// rays do, because a wall keeps its shadow when it is cut away for the viewer.
struct CastContext {
  explicit CastContext(bool for_camera_rays, RayOrder order = RayOrder::kCoherent)
      : query(order), camera_rays(for_camera_rays) {}
  RayQuery query;  // first: Embree passes its address on
  bool camera_rays;
  ShadowTarget target;
  BacksPassed* passed = nullptr;  // by a ray's id; null: not recorded
};

// Owns a device and a scene in view space, one geometry for each object. Casting rays from several threads is safe.
class EmbreeScene {
 public:
  // `isa` as in GuidegenOptions; an unknown one, or one that this machine or this build of Embree lacks, is a kUsage
  // error. Builds in the calling thread's oneTBB arena, whose size is the only limit: Embree's own "threads=" would
  // throttle oneTBB for the whole process. The hierarchy is the same at any thread count. Triangles with corners that
  // are not finite are left out. Each frame builds its own. A refit hierarchy costs a tenth, but picks other triangles
  // at edges and coincident surfaces: 57 of 99,849 pixels on a bent sheet of 80,000 triangles. A frame would then
  // depend on those before it.
  struct Needs {
    bool light_rays = false;  // rays to lights will be cast, as ShadowTarget describes, not only camera rays
    bool emitters = false;    // emitters() will be called
    bool robust = true;       // as in GuidegenOptions
  };
  // During the build `progress` is called with a share of 0; if it returns false, Build fails with kCancelled.
  static Expected<EmbreeScene> Build(std::vector<PlacedObject> objects, const std::string& isa, const Needs& needs,
                                     const Progress& progress = {});

  RTCScene handle() const { return scene_.get(); }
  RTCScene emitters() const { return emitters_.get(); }   // the objects that emit, under the same ids; null: none
  const std::string& isa() const { return isa_; }         // the one in use, never empty
  std::string version() const;                            // of the Embree that is loaded, as "4.3.3"
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
