// Guides in the plain files that WriteGuides makes. Private to core/io.
#pragma once

#include <filesystem>
#include <optional>

#include "core/image/guides.h"
#include "core/io/guide_file.h"

namespace scumble::internal {

// Like ReadGuides and InspectGuides, but empty if the file is damaged, or holds anything besides guides without a view
// layer. Then the module of core/io/format_dispatch.h reads it or reports the error. Fragments, which the module does
// not read, are an error where they are damaged.
std::optional<Expected<GuideSet>> ReadPlainGuides(const std::filesystem::path& path, const GuideReadOptions& options);
std::optional<Expected<GuideFileInfo>> InspectPlainGuides(const std::filesystem::path& path);

}  // namespace scumble::internal
