// Where styles are found.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/image/style.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"

namespace scumble {

// Folders that may hold bundled styles.
std::vector<std::filesystem::path> StyleFolders(const RunContext& context);

// Whether that is the folder of a bundled style, or a file in one.
bool IsBundledStyle(const std::filesystem::path& path, const RunContext& context);

// Where a style is: a path, relative to the folder `base`, or the name of a bundled one. A kInput error lists those.
Expected<std::filesystem::path> FindStyle(const std::string& name, const RunContext& context,
                                          const std::filesystem::path& base = {});

// Loads one style with its overrides.
Expected<Style> OpenStyle(const StyleRequest& request, const RunContext& context);

}  // namespace scumble
