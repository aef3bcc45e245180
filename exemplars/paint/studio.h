// The inputs of every style's painter.
#pragma once

#include <cstdint>
#include <filesystem>

#include "exemplars/paint/sphere.h"

namespace scumble::paint {

struct Studio {
  std::filesystem::path brushes;  // the folder that holds tanda/, deevad/, classic/
  int size = 1024;
  std::uint64_t seed = 1;
  std::filesystem::path scene;  // guides of the sphere on its floor, for the styles that paint it
  Light light = Light::kKey;    // used by the styles that are painted for several lights
};

}  // namespace scumble::paint
