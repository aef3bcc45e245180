// Guides' objects and materials as Cryptomatte, for compositors. Private to core/io.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/io/exr/scanline_exr.h"

namespace scumble::internal {

// The manifest of a Cryptomatte, in JSON: {"name":"8 hex digits of its hash",…}, sorted by name.
std::string ManifestToText(const std::map<std::uint32_t, std::string>& names);

// Planes that the channels of an ExrImage borrow.
class MattePlanes {
 public:
  // Adds the mattes CryptoObject and CryptoMaterial of those id layers that the guides have. Each has the channels R
  // (id), G (coverage), B and A of one level, and the attributes cryptomatte/KEY/name, hash, conversion and manifest. A
  // pixel has its id with the coverage A; where it has fragments, the two ids with the largest coverage. An id without
  // a name is 0. The layer itself is added once more as kShownObjectIds or kShownMaterialIds. The guides and this
  // outlive the image.
  void AddTo(const GuideSet& guides, ExrImage& image);

 private:
  using Planes = std::array<std::vector<float>, 4>;
  Planes objects_, materials_;
};

}  // namespace scumble::internal
