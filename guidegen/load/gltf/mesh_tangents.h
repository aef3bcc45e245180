// Tangents of a glTF mesh, common to its primitives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "guidegen/load/gltf/meshes.h"

namespace scumble {

// Repeats the vertices that were split (split_vertices.h).
void SplitDeformation(std::span<const std::uint32_t> sources, MeshDeformation& deformation);

// Makes the tangents that primitives of one mesh lack. `load` must outlive it.
class TangentMaker {
 public:
  explicit TangentMaker(const GltfLoad& load) : load_(load) {}

  // The next primitive: whether it lacks them, and TangentPart::exact_v.
  void Add(bool wanted, std::vector<float> exact_v) { parts_.push_back({parts_.size(), wanted, std::move(exact_v)}); }

  // The primitives that were added, in their order. The tangents of those whose textures lie in one UV set are made
  // together, because neighbours have other materials. The first set joins all primitives, further ones their own, so
  // that the time stays linear.
  Status Make(std::span<DeformableMesh> loaded);

 private:
  struct Part {
    std::size_t primitive;
    bool wanted;
    std::vector<float> exact_v;
  };
  using Key = std::array<std::uint32_t, 10>;  // the UV set and its transform, as bits

  Mesh& MeshOf(const Part& part) const;
  const Material& MaterialOf(const Part& part) const;
  Key KeyOf(const Part& part) const;
  Status MakeOf(const std::vector<const Part*>& own, bool with_others);

  const GltfLoad& load_;
  std::span<DeformableMesh> loaded_;
  std::vector<Part> parts_;
};

}  // namespace scumble
