// Fragments as bytes in the header of a guide file: docs/guides.md states the form. Private to core/io.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/image/fragments.h"
#include "core/image/status.h"

namespace scumble::internal {

// The attribute and its type, which is none of OpenEXR's: other programs pass it over.
inline constexpr const char* kFragmentAttribute = "scumble:fragments";
inline constexpr const char* kFragmentType = "scumbleFragments";

// `half`: colour layers are rounded to half floats, as the file's channels are.
std::vector<std::byte> EncodeFragments(const GuideSet& guides, bool half);

// The number of fragments in these bytes of the file `name`, for a picture of this size. An error where they are cut
// off or longer than they say, of another version, or of a picture of another size.
Expected<std::size_t> CountFragments(std::span<const std::byte> bytes, int width, int height, const std::string& name);

// The fragments, with the layers of `guides` alone; null: there are none. The same errors, and those of
// Fragments::Validate.
Expected<std::shared_ptr<const Fragments>> DecodeFragments(std::span<const std::byte> bytes, const GuideSet& guides,
                                                           const std::string& name);

}  // namespace scumble::internal
