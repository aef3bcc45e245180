// Guides: what a renderer knows about each pixel of a view (normals, depth, ids, light), in named layers.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "scumble/data_folder.h"
#include "scumble/layers.h"
#include "scumble/status.h"

namespace scumble {

// Immutable and cheap to copy; any number of threads may read it.
class GuideLayers {
 public:
  // Reads guides of `scumble guidegen`, or a renderer's multilayer EXR. A kInput error says what is missing.
  static Expected<GuideLayers> Load(const std::string& file);
  // Writes an .exr with lossless compression. The file appears whole under its name, or not at all: a kOutput error
  // leaves an older file as it was. kUsage for any other ending.
  Status Save(const std::string& file) const;

  int width() const;   // pixels
  int height() const;  // pixels
  LayerSet layers() const;

  // One channel of a layer, width × height values, row 0 at the top; `component` is 0 … ChannelCount(layer) - 1. Units
  // are the layer's: Info(layer).meaning. Empty where there is no such layer or component. Valid as long as this object
  // or a copy.
  std::span<const float> Plane(Layer layer, int component = 0) const;

  struct State;
  explicit GuideLayers(std::shared_ptr<const State> state);  // for the library itself
  const std::shared_ptr<const State>& state() const { return state_; }

 private:
  std::shared_ptr<const State> state_;
};

}  // namespace scumble
