#include "pipeline/scene/blender_file.h"

#include <cstdio>
#include <fstream>
#include <regex>

namespace scumble {

std::optional<std::pair<int, int>> SavedByBlender(const std::filesystem::path& file) {
  constexpr std::size_t kHead = 64;
  std::string head(kHead, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), kHead);
  head.resize(std::size_t(stream.gcount()));
  static const std::regex kOld("BLENDER[-_][vV](\\d)(\\d\\d)"), kNew("BLENDER\\d\\d-\\d\\d[vV](\\d\\d)(\\d\\d)");
  std::smatch match;
  if (!std::regex_search(head, match, kOld) && !std::regex_search(head, match, kNew)) return std::nullopt;
  return std::pair(std::stoi(match[1]), std::stoi(match[2]));
}

std::string NewerThanBlender(const std::filesystem::path& file, const std::vector<std::string>& log) {
  const auto saved = SavedByBlender(file);
  if (!saved) return "";
  for (const std::string& line : log) {
    std::pair<int, int> running;
    if (std::sscanf(line.c_str(), "Blender %d.%d", &running.first, &running.second) != 2) continue;
    if (!(running < *saved)) return "";
    return "it was saved by Blender " + std::to_string(saved->first) + "." + std::to_string(saved->second) +
           ", and this is the older " + line + ": name a newer one with --blender";
  }
  return "";
}

}  // namespace scumble
