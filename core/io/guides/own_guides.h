// Guides in the plain files that WriteGuides makes. Not for other folders.
#pragma once

#include <filesystem>
#include <optional>

#include "core/image/guides.h"
#include "core/io/guide_file.h"

namespace scumble::internal {

// As ReadGuides and InspectGuides. Nothing where the file holds anything else than guides without a view layer, or
// anything is wrong with it: the module of core/io/format_dispatch.h reads it, or says why nobody can.
std::optional<GuideSet> ReadPlainGuides(const std::filesystem::path& path, const GuideReadOptions& options);
std::optional<GuideFileInfo> InspectPlainGuides(const std::filesystem::path& path);

}  // namespace scumble::internal
