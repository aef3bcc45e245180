// From the other surfaces that subsamples see to the guides' Fragments. Internal to cast_guides.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/image/fragments.h"
#include "guidegen/cast/point_values.h"
#include "guidegen/cast/primary_rays.h"

namespace scumble {

// The fragments that one thread has found, in any order.
struct FoundFragments {
  struct Found {
    std::uint32_t pixel;
    glm::vec2 at;  // of the subsample, from the pixel's centre
    std::uint16_t cells;
    std::size_t first;  // of its values
  };
  std::vector<Found> found;
  std::vector<float> values;  // by fragment, of all channels in the order of the layers; those of light are 0
};

// Finds the values of fragments, except light. Immutable; free to use from any thread.
class FragmentCaster {
 public:
  // All outlive it. `layers` are those of the guides, whose pictures are `width` pixels wide.
  FragmentCaster(const EmbreeScene& scene, const View& view, NormalFrame frame, const LayerSet& layers, int width);

  void Add(const PrimaryRays::Beside& beside, FoundFragments& found) const;

 private:
  const EmbreeScene& scene_;
  const View& view_;
  const PointValues point_values_;
  const LayerSet layers_;
  const int width_;
};

// All that the threads have found inside the window, in the order of Fragments, with their light from `guides`, which
// is complete. Null: nothing.
std::shared_ptr<const Fragments> GatherFragments(std::span<const FoundFragments* const> by_thread,
                                                 const PixelWindow& window, const GuideSet& guides);

}  // namespace scumble
