// GuideSet: the data of every pixel that a renderer hands to the transfer.
//
// Conventions, for the whole code base:
//   - Row 0 is the top row; pixel (x, y) covers [x, x+1) × [y, y+1), its centre at +0.5.
//   - View space is right-handed: +X right, +Y up, +Z towards the viewer. World space is glTF's: metres, +Y up.
//   - `normal` is the unit shading normal in view space, in [-1, 1], never packed.
//   - `depth` is the planar view depth in metres, positive; `position` is in world space, metres.
//   - Radiance is linear Rec.709, scene-referred.
//   - Data layers are point-sampled at pixel centres. A pixel whose centre misses but whose coverage is above 0 takes
//     every data layer from its covered subsample nearest the centre.
//   - With several subsamples a pixel, those that see other surfaces than the centre are kept apart (`fragments`).
//   - Background: A = 0, normal = position = 0, depth = +infinity, ids = 0.
//   - Ids are 24-bit hashes of the object's full name (IdsForNames), exact in a float; 0 is the background.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/layers.h"
#include "core/image/plane_allocator.h"
#include "core/image/status.h"

namespace scumble {

// The view of the guides. Written to the EXR header as worldToCamera and worldToNDC.
struct GuideCamera {
  std::string name;
  glm::dmat4 view_from_world{1.0};
  glm::dmat4 clip_from_view{1.0};  // OpenGL's clip space, y up

  // Whether the view is orthographic: depth then gives no sizes.
  bool IsOrthographic() const { return clip_from_view[2][3] == 0.0 && clip_from_view[3][3] != 0.0; }
};

struct Fragments;

// Owns its pixels: every layer is `ChannelCount` planes of width × height floats, rows from the top.
// Copyable and movable; concurrent reads are safe, writes to different pixels too.
class GuideSet {
 public:
  GuideSet() = default;
  GuideSet(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t pixel_count() const { return std::size_t(width_) * height_; }

  LayerSet layers() const { return layers_; }
  bool Has(Layer layer) const { return layers_.Has(layer); }

  // Adds the layer, filled with its background value. Does nothing where the layer exists.
  void Add(Layer layer);
  // Adds the layer unset, for callers that write every pixel. The first touch of a large plane is expensive, so the
  // threads that fill it do it.
  void AddUnset(Layer layer);
  void Remove(Layer layer);

  // One plane of width × height floats. The layer must exist.
  std::span<float> Plane(Layer layer, int component = 0);
  std::span<const float> Plane(Layer layer, int component = 0) const;

  std::size_t Index(int x, int y) const { return std::size_t(y) * width_ + x; }
  glm::vec3 Vec3(Layer layer, std::size_t index) const;

  // Ok, or the first thing that makes the set unusable: an impossible size, or coverage outside [0, 1]. On covered
  // pixels also: normals that are NaN or zero, depth that is NaN or negative, ids that are NaN, negative or above
  // kMostId, and non-finite colours. The message counts the bad pixels and names the first. O(pixels). `name` stands
  // for the set in the message.
  Status Validate(const std::string& name) const;
  // Validate without its limits of size.
  Status ValidateValues(const std::string& name) const;

  // Free text that travels in the file's header: generator, isa, ….
  std::map<std::string, std::string> attributes;
  std::map<std::uint32_t, std::string> object_names;
  std::map<std::uint32_t, std::string> material_names;
  // The styles that the scene's author assigned to objects, by id: names of styles, paths, or arguments of the command
  // line.
  std::map<std::uint32_t, std::string> object_styles;
  std::map<std::uint32_t, std::string> material_styles;
  std::optional<GuideCamera> camera;
  // The other surfaces of pixels that show several (core/image/fragments.h); null: none are known. Copies share them.
  std::shared_ptr<const Fragments> fragments;

 private:
  int width_ = 0;
  int height_ = 0;
  LayerSet layers_;
  std::array<std::vector<float, PlaneAllocator<float>>, kLayerCount> planes_;
};

// The layer's value on the background.
float BackgroundValue(Layer layer);

// The largest id: floats hold all whole numbers up to here.
inline constexpr float kMostId = 1 << 24;

// The id that a value of an id layer stands for. 0, the background's id, if the value is NaN, negative or above
// kMostId.
inline std::uint32_t IdOf(float value) {
  return value > 0.0f && value <= kMostId ? static_cast<std::uint32_t>(value) : 0u;
}

// Largest width or height of any picture or guide set that is read or made.
inline constexpr int kMaxImageSide = 32768;
inline constexpr std::int64_t kMaxPicturePixels = std::int64_t(1) << 28;  // 16384²; files of more are refused

// Ids for names, in the order given: 24-bit hashes in [1, 2^24), a collision moves the alphabetically later name to
// the next free id. Adding a name does not change the others' ids, save in a collision. Equal names share an id.
std::vector<std::uint32_t> IdsForNames(std::span<const std::string> names);

// The attribute of guides whose luminance and shadow needed no random samples, as no light has an extent, and its
// value.
inline constexpr const char* kLightKey = "scumble:light";
inline constexpr const char* kExactLight = "exact";
// Whether luminance and shadow are known to be without noise.
bool HasExactLight(const GuideSet& guides);

// The attribute of guides whose pixels chose their samples of luminance and shadow. It is the estimated standard error,
// a share of each pixel's light, that nine of ten pixels do not exceed.
inline constexpr const char* kLightErrorKey = "scumble:light_error";
// Its value; 0 where it is unknown, or no number from 0 to 1.
double LightErrorOf(const GuideSet& guides);

}  // namespace scumble
