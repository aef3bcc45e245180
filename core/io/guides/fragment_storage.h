// Fragments as bytes in the header of a guide file: docs/guides.md states the form. Private to core/io.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/image/fragments.h"

namespace scumble::internal {

// The attribute and its type, which is none of OpenEXR's: other programs pass it over.
inline constexpr const char* kFragmentAttribute = "scumble:fragments";
inline constexpr const char* kFragmentType = "scumbleFragments";

// `half`: colour layers are rounded to half floats, as the file's channels are.
std::vector<std::byte> EncodeFragments(const GuideSet& guides, bool half);

// The number of fragments that these bytes promise; 0 where they are none.
std::size_t CountFragments(std::span<const std::byte> bytes);

// The fragments, with the layers of `guides` alone. Null where the bytes are damaged, of a later version, or of a
// picture of another size.
std::shared_ptr<const Fragments> DecodeFragments(std::span<const std::byte> bytes, const GuideSet& guides);

}  // namespace scumble::internal
