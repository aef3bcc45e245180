#include "guidegen/rays/embree_scene.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <stdexcept>

#include "core/image/check.h"
#include "guidegen/rays/coincident_objects.h"
#include "guidegen/rays/progress_gate.h"
#include "guidegen/surface/bsdf.h"
#include "guidegen/surface/curve.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

struct IsaInfo {
  const char* name;
  RTCDeviceProperty native_packets;  // the property in which Embree's instruction sets differ
};

// Best first.
constexpr std::array<IsaInfo, 5> kIsas = {{{"avx512", RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED},
                                           {"avx2", RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED},
                                           {"avx", RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED},
                                           {"sse4.2", RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED},
                                           {"sse2", RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED}}};

// Embree does not check the processor and crashes on the first unknown instruction, so the processor is checked first.
bool MachineHas(const std::string& isa) {
#if defined(__x86_64__)
  if (isa == "sse2") return __builtin_cpu_supports("sse2");
  if (isa == "sse4.2") return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
  if (isa == "avx") return __builtin_cpu_supports("avx");
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
                    __builtin_cpu_supports("bmi2");
  if (isa == "avx2") return avx2;
  return avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#else
  return isa == "sse2";  // elsewhere Embree maps its SSE2 code to the machine's own vectors
#endif
}

// The instruction set's packet width must be available: a build of Embree without it falls back silently.
RTCDevice OpenIfSupported(const IsaInfo& isa) {
  if (!MachineHas(isa.name)) return nullptr;
  // Disables the cache for subdivision surfaces: there are none, it takes 128 MB of addresses, and a device without
  // room for it never releases its own lock.
  RTCDevice device = rtcNewDevice(("isa=" + std::string(isa.name) + ",tessellation_cache_size=0").c_str());
  if (device && rtcGetDeviceProperty(device, isa.native_packets) == 0) {
    rtcReleaseDevice(device);
    return nullptr;
  }
  return device;
}

std::string AvailableIsas() {
  std::string names;
  for (auto isa = kIsas.rbegin(); isa != kIsas.rend(); ++isa) {
    RTCDevice device = OpenIfSupported(*isa);
    if (!device) continue;
    rtcReleaseDevice(device);
    names += (names.empty() ? "" : ", ") + std::string(isa->name);
  }
  return names;
}

// Whether the ray leaves the plane of the triangle, or runs along it, so that it cannot hit it: in float, a point in a
// large ground or just above it may be below that ground.
bool LeavesPlane(const PlacedObject& object, std::uint32_t primitive, const glm::dvec3& origin,
                 const glm::dvec3& direction) {
  const Triangle triangle = ViewTriangle(object, primitive);
  const glm::dvec3 normal =
      glm::cross(triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0]);
  return glm::dot(normal, origin - triangle.corner[0]) * glm::dot(normal, direction) >= 0.0;
}

// Whether any triangle is longer than half of its largest coordinate. On a shorter one no place has a coordinate below
// half of the largest, so rays of light from a surface on it start high enough (docs/numerics.md).
bool ReachesFar(const PlacedObject& object) {
  const std::vector<glm::uvec3>& triangles = object.mesh->triangles;
  std::atomic<bool> found = false;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end() && !found.load(std::memory_order_relaxed); ++i) {
      const Triangle triangle = ViewTriangle(object, static_cast<std::uint32_t>(i));
      double coordinate = 0.0;
      for (const glm::dvec3& corner : triangle.corner) coordinate = std::max(coordinate, LargestCoordinate(corner));
      if (LongestEdgeSquared(triangle) > 0.25 * coordinate * coordinate) found = true;
    }
  });
  return found;
}

void FilterHits(const RTCFilterFunctionNArguments* args) {
  const PlacedObject& object = *static_cast<const PlacedObject*>(args->geometryUserPtr);
  const CastContext& context = *reinterpret_cast<const CastContext*>(args->context);
  const bool cull = context.camera_rays && !object.material->double_sided;
  if (context.camera_rays && !cull && !MayHaveHoles(*object.material)) return;  // only rays of light need a test
  const bool may_be_target = context.target.object && MayEmit(*object.material);
  const unsigned count = args->N;
  for (unsigned i = 0; i < count; ++i) {
    if (args->valid[i] == 0) continue;
    ++thread_counters.filtered_hits;
    if (may_be_target &&
        (RTCRayN_tfar(args->ray, count, i) >= context.target.near_end ||
         (context.target.object == &object && RTCHitN_primID(args->hit, count, i) == context.target.primitive))) {
      args->valid[i] = 0;
      continue;
    }
    if (cull) {
      const double along = double(RTCHitN_Ng_x(args->hit, count, i)) * RTCRayN_dir_x(args->ray, count, i) +
                           double(RTCHitN_Ng_y(args->hit, count, i)) * RTCRayN_dir_y(args->ray, count, i) +
                           double(RTCHitN_Ng_z(args->hit, count, i)) * RTCRayN_dir_z(args->ray, count, i);
      if (along * object.winding > 0.0) {
        args->valid[i] = 0;
        if (context.passed) {
          BacksPassed& passed = context.passed[RTCRayN_id(args->ray, count, i)];
          passed.nearest = std::min(passed.nearest, RTCRayN_tfar(args->ray, count, i));
          passed.farthest = std::max(passed.farthest, RTCRayN_tfar(args->ray, count, i));
        }
        continue;
      }
    }
    const glm::dvec2 barycentric(RTCHitN_u(args->hit, count, i), RTCHitN_v(args->hit, count, i));
    const std::uint32_t primitive = RTCHitN_primID(args->hit, count, i);
    if (IsHole(object, primitive, barycentric)) {
      args->valid[i] = 0;
    } else if (object.reaches_far && !context.camera_rays) {
      RTCRayN* const ray = args->ray;
      const glm::dvec3 origin(RTCRayN_org_x(ray, count, i), RTCRayN_org_y(ray, count, i), RTCRayN_org_z(ray, count, i));
      const glm::dvec3 direction(RTCRayN_dir_x(ray, count, i), RTCRayN_dir_y(ray, count, i),
                                 RTCRayN_dir_z(ray, count, i));
      if (LeavesPlane(object, primitive, origin, direction)) args->valid[i] = 0;
    }
  }
}

void FillVertices(RTCGeometry geometry, const PlacedObject& object) {
  const std::vector<glm::vec3>& positions = object.mesh->positions;
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), positions.size()));
  if (!vertices) return;
  const glm::dmat3 linear(object.view_from_object);
  const glm::dvec3 origin(object.view_from_object[3]);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const glm::vec3 vertex(linear * glm::dvec3(positions[i]) + origin);
      for (int axis = 0; axis < 3; ++axis) vertices[3 * i + axis] = vertex[axis];
    }
  });
}

// Emissive objects, and those that reach far, need the filter only for rays of light. An object that is tied with
// another has it always, so that camera rays see one of the two whether light is cast or not.
RTCGeometry MakeMesh(RTCDevice device, PlacedObject& object, bool light_rays, bool tied) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  FillVertices(geometry, object);
  const std::vector<glm::uvec3>& triangles = object.mesh->triangles;
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                             sizeof(glm::uvec3), triangles.size());
  object.reaches_far = light_rays && ReachesFar(object);
  const bool asks_light = object.reaches_far || (light_rays && MayEmit(*object.material));
  if (!object.material->double_sided || MayHaveHoles(*object.material) || asks_light || tied) {
    rtcSetGeometryIntersectFilterFunction(geometry, FilterHits);
    rtcSetGeometryOccludedFilterFunction(geometry, FilterHits);
  }
  return geometry;
}

RTCGeometry MakeSphere(RTCDevice device, const PlacedObject& object) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* sphere = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 1));
  if (!sphere) return geometry;
  const glm::vec4 centre(object.view_from_object[3]);
  for (int axis = 0; axis < 3; ++axis) sphere[axis] = centre[axis];
  sphere[3] = 1.0f;
  return geometry;
}

// Round hair is not seen from its inside, through its open ends.
void LeaveOutInsides(const RTCFilterFunctionNArguments* args) {
  const unsigned count = args->N;
  for (unsigned i = 0; i < count; ++i) {
    const float along = RTCHitN_Ng_x(args->hit, count, i) * RTCRayN_dir_x(args->ray, count, i) +
                        RTCHitN_Ng_y(args->hit, count, i) * RTCRayN_dir_y(args->ray, count, i) +
                        RTCHitN_Ng_z(args->hit, count, i) * RTCRayN_dir_z(args->ray, count, i);
    if (args->valid[i] != 0 && along > 0.0f) args->valid[i] = 0;
  }
}

// The hair of Cycles, which has these of Embree too. A flat curve turns to each ray.
RTCGeometry MakeCurves(RTCDevice device, const PlacedObject& object) {
  const Mesh& mesh = *object.mesh;
  RTCGeometry geometry = rtcNewGeometry(device, mesh.curves.ribbons ? RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE
                                                                    : RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                             4 * sizeof(float), mesh.positions.size()));
  if (!points) return geometry;
  const double scale = RadiusScale(object);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec4 place(object.view_from_object * glm::dvec4(glm::dvec3(mesh.positions[i]), 1.0));
    for (int axis = 0; axis < 3; ++axis) points[4 * i + std::size_t(axis)] = place[axis];
    points[4 * i + 3] = static_cast<float>(scale * double(mesh.curves.radii[i]));
  }
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, mesh.curves.segments.data(), 0,
                             sizeof(std::uint32_t), mesh.curves.segments.size());
  if (mesh.curves.ribbons) {
    rtcSetGeometryTessellationRate(geometry, static_cast<float>(mesh.curves.pieces));
  } else {
    rtcSetGeometryIntersectFilterFunction(geometry, LeaveOutInsides);
    rtcSetGeometryOccludedFilterFunction(geometry, LeaveOutInsides);
  }
  return geometry;
}

RTCGeometry MakeGeometry(RTCDevice device, PlacedObject& object, bool light_rays, bool tied) {
  if (!object.mesh) return MakeSphere(device, object);
  return object.mesh->IsCurves() ? MakeCurves(device, object) : MakeMesh(device, object, light_rays, tied);
}

// Robust: no cracks between neighbours, and no thin object is lost.
RTCScene NewScene(RTCDevice device, bool robust) {
  RTCScene scene = rtcNewScene(device);
  if (robust) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  return scene;
}

// If the gate is cancelled, the scene is unusable.
void CommitScene(RTCScene scene, ProgressGate& gate) {
  const auto go_on = [](void* asked, double) { return static_cast<ProgressGate*>(asked)->Continue(); };
  rtcSetSceneProgressMonitorFunction(scene, go_on, &gate);
  rtcCommitScene(scene);
  rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
}

}  // namespace

Expected<EmbreeScene> EmbreeScene::Build(std::vector<PlacedObject> objects, const std::string& isa, const Needs& needs,
                                         const Progress& progress) {
  EmbreeScene scene;
  scene.objects_ = std::make_unique<std::vector<PlacedObject>>(std::move(objects));
  SCUMBLE_RETURN_IF_ERROR(scene.OpenDevice(isa));
  SCUMBLE_RETURN_IF_ERROR(scene.Commit(needs, progress));
  return scene;
}

std::string EmbreeScene::version() const {
  const auto part = [&](RTCDeviceProperty property) {
    return std::to_string(rtcGetDeviceProperty(device_.get(), property));
  };
  return part(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." + part(RTC_DEVICE_PROPERTY_VERSION_MINOR) + "." +
         part(RTC_DEVICE_PROPERTY_VERSION_PATCH);
}

Status EmbreeScene::OpenDevice(const std::string& isa) {
  rtcGetDeviceError(nullptr);  // an earlier device's error on this thread
  bool known = isa.empty();
  for (const IsaInfo& candidate : kIsas) {
    if (!isa.empty() && isa != candidate.name) continue;
    known = true;
    device_.reset(OpenIfSupported(candidate));
    if (device_) {
      isa_ = candidate.name;
      return Ok();
    }
    // No fallback to the next instruction set here: its guides would differ. Embree reports a lack of threads as an
    // unknown error.
    const RTCError error = rtcGetDeviceError(nullptr);
    if (error == RTC_ERROR_OUT_OF_MEMORY || error == RTC_ERROR_UNKNOWN) {
      return MemoryError(
          "Embree finds too little memory or no thread: allow more, or take fewer threads, as --threads 1");
    }
  }
  if (!known) {
    return UsageError("isa \"" + isa + "\" is unknown: expected one of sse2, sse4.2, avx, avx2, avx512");
  }
  return UsageError("isa \"" + isa + "\" is not available on this machine with this Embree: choose one of " +
                    AvailableIsas());
}

Status EmbreeScene::Commit(const Needs& needs, const Progress& progress) {
  std::string reason;  // the first of several is the cause of the others
  rtcSetDeviceErrorFunction(
      device_.get(),
      [](void* kept, RTCError, const char* text) {
        std::string& first = *static_cast<std::string*>(kept);
        if (first.empty() && text) first = text;
      },
      &reason);
  scene_.reset(NewScene(device_.get(), needs.robust));
  const std::vector<bool> covered = FindHiddenCoincident(*objects_);
  const std::vector<bool> tied = FindTied(*objects_, covered);
  for (std::size_t i = 0; i < objects_->size(); ++i) {
    PlacedObject& object = (*objects_)[i];
    if (covered[i] || (object.mesh && object.mesh->triangles.empty() && !object.mesh->IsCurves())) continue;
    RTCGeometry geometry = MakeGeometry(device_.get(), object, needs.light_rays, tied[i]);
    rtcSetGeometryUserData(geometry, &object);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_.get(), geometry, static_cast<unsigned>(i));
    if (needs.emitters && object.mesh && !object.mesh->IsCurves() && MayEmit(*object.material)) {
      if (!emitters_) emitters_.reset(NewScene(device_.get(), needs.robust));
      rtcAttachGeometryByID(emitters_.get(), geometry, static_cast<unsigned>(i));
    }
    rtcReleaseGeometry(geometry);
  }
  ProgressGate gate(progress, 1, 0.0, 0.0);
  CommitScene(scene_.get(), gate);
  if (emitters_) CommitScene(emitters_.get(), gate);
  rtcSetDeviceErrorFunction(device_.get(), nullptr, nullptr);
  const RTCError error = rtcGetDeviceError(device_.get());
  if (gate.cancelled()) return CancelledError();
  if (error == RTC_ERROR_NONE) return Ok();
  if (error == RTC_ERROR_OUT_OF_MEMORY) {
    return MemoryError("the scene does not fit into memory: give it fewer triangles or instances");
  }
  // Any other failure, such as a lack of threads, has no code of its own but a text.
  throw std::runtime_error(reason);
}

}  // namespace scumble
