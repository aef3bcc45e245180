// Guides' objects and materials as Cryptomatte, for compositors. Private to core/io.
#pragma once

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
  // Adds the mattes CryptoObject and CryptoMaterial of those id layers that the guides have: the channels R (id), G
  // (coverage), B and A of one level each, and the attributes cryptomatte/KEY/name, hash, conversion and manifest. A
  // pixel has one rank, its id with the coverage A; the second one is 0. An id without a name is 0. The guides and this
  // outlive the image.
  void AddTo(const GuideSet& guides, ExrImage& image);

 private:
  std::vector<float> objects_, materials_, zero_;
};

}  // namespace scumble::internal
