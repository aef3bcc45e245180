// The guide layers: one table that names them, for files, plans and messages.
#pragma once

#include <bitset>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "scumble/status.h"

namespace scumble {

enum class Layer {
  kCoverage,
  kNormal,
  kDepth,
  kObject,
  kMaterial,
  kPosition,
  kPref,
  kMotion,
  kAlbedo,
  kLuminance,
  kShadow,
  kLpeFull,
  kLpeLDE,
  kLpeLSE,
  kLpeLDDE,
  kLpeLD12E,
  kCosine,
  kUv,
  kOutline,
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
