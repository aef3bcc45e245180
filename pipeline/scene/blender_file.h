// Which Blender saved a .blend, without running one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scumble {

// Major and minor version by the file's head, "BLENDER-v403", from Blender 5 on "BLENDER17-01v0500". Of compressed
// files Blender 4 leaves the head readable; nothing where it is not.
std::optional<std::pair<int, int>> SavedByBlender(const std::filesystem::path& file);

// Where a newer Blender saved the file than the one that ran: a sentence that names both. `log` holds the lines of the
// one that ran, which begin with "Blender 3.4.1". Empty where it is not so, or not known.
std::string NewerThanBlender(const std::filesystem::path& file, const std::vector<std::string>& log);

}  // namespace scumble
