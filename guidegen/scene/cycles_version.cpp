#include "guidegen/cycles_version.h"

#include <charconv>

namespace scumble {

bool IsCycles4(std::string_view version) {
  int major = 0;
  std::from_chars(version.data(), version.data() + version.size(), major);
  return major >= 4;
}

bool ShadeAsCycles(std::string_view version, Scene& scene) {
  const bool cycles4 = IsCycles4(version);
  bool changed = false;
  for (Material& material : scene.materials) {
    changed = changed || material.cycles4 != cycles4;
    material.cycles4 = cycles4;
  }
  return changed;
}

}  // namespace scumble
