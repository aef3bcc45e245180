// The guide layers: one table that names them, for files, plans and messages.
#pragma once

#include <bitset>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "scumble/status.h"

namespace scumble {

// By pixel, as floats. Values on the background are 0 where nothing else is said.
enum class Layer {
  kCoverage,   // "A": 0 … 1; 0 is the background
  kNormal,     // unit shading normal in view space: x right, y up, z to the viewer
  kDepth,      // planar view depth, metres; infinity on the background
  kObject,     // 24-bit id of the object, 0 on the background
  kMaterial,   // 24-bit id of the material, 0 on the background
  kPosition,   // in the world, metres, y up
  kPref,       // position at rest, in the object's own space
  kMotion,     // pixels to the same point in the next frame: x right, y down
  kAlbedo,     // base colour, textured, linear Rec. 709
  kLuminance,  // direct light on a white Lambert surface, shadows included; linear
  kShadow,     // share of the direct light that is blocked, 0 … 1
  kLpeFull,    // radiance with all reflections; linear Rec. 709, as the others below
  kLpeLDE,     // direct diffuse light
  kLpeLSE,     // direct specular light
  kLpeLDDE,    // diffuse light after one diffuse reflection
  kLpeLD12E,   // the first two diffuse bounces together
  kCosine,     // of the normal to the key light, -1 … 1
  kUv,         // texture coordinates, (0, 0) lower left
  kOutline,    // pixels to the outline of the object, at most 256
};
inline constexpr int kLayerCount = 19;

struct LayerInfo {
  Layer layer;
  const char* name;                       // "normal"; the coverage layer is called "A"
  std::span<const char* const> channels;  // full channel names as written to EXR: "normal.X", …
  bool is_color;                          // colour layers may be stored as half; data layers never
  const char* meaning;                    // one line for `info` and `--explain`
};

const LayerInfo& Info(Layer layer);
std::span<const LayerInfo> AllLayers();  // in the order of the enum
int ChannelCount(Layer layer);

// A set of layers: what a style needs, what a file holds.
class LayerSet {
 public:
  LayerSet() = default;
  LayerSet(std::initializer_list<Layer> layers) {
    for (Layer layer : layers) Add(layer);
  }
  LayerSet& Add(Layer layer) { return bits_.set(static_cast<int>(layer)), *this; }
  LayerSet& Add(const LayerSet& other) { return bits_ |= other.bits_, *this; }
  LayerSet& Remove(Layer layer) { return bits_.reset(static_cast<int>(layer)), *this; }
  bool Has(Layer layer) const { return bits_.test(static_cast<int>(layer)); }
  bool Contains(const LayerSet& other) const { return (bits_ & other.bits_) == other.bits_; }
  bool empty() const { return bits_.none(); }
  bool operator==(const LayerSet&) const = default;
  std::string ToString() const;  // "A, normal, depth"

 private:
  std::bitset<kLayerCount> bits_;
};

// The layers that every guide set holds.
LayerSet AlwaysWritten();

// "normal,depth" or "lpe.LDE" → a set. Errors name the unknown word and list what there is.
Expected<LayerSet> ParseLayers(std::string_view comma_separated);

}  // namespace scumble
