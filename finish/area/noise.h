// Smooth chance.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace scumble::internal {

// Smooth noise, -1 … 1, of a lattice with cells of size 1: the same at the same place, whatever runs through it.
float Noise(std::uint64_t seed, glm::vec2 at);

}  // namespace scumble::internal
