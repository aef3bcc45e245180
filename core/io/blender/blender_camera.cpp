#include "core/io/blender_camera.h"

#include <optional>
#include <sstream>
#include <string>

#include "core/io/atomic_file.h"
#include "core/io/guides/guide_header.h"

namespace scumble {
namespace {

constexpr std::size_t kMaxCameraBytes = 1 << 20;

}  // namespace

Expected<GuideCamera> ReadBlenderCamera(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxCameraBytes));
  std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  GuideCamera result;
  std::optional<glm::dmat4> view, clip;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::size_t space = line.find(' ');
    const std::string key = line.substr(0, space), rest = space == std::string::npos ? "" : line.substr(space + 1);
    if (key == "camera")
      result.name = rest;
    else if (key == "viewFromWorld")
      view = internal::MatrixFromText(rest);
    else if (key == "clipFromView")
      clip = internal::MatrixFromText(rest);
    else if (!line.empty()) {
      return InputError(path.string() + ":" + std::to_string(number) + ": '" + line.substr(0, 40) +
                        "' is no line of a .camera file, as blender_scripts/render_guides.py writes it");
    }
  }
  if (!view || !clip) {
    return InputError(path.string() +
                      " lacks viewFromWorld or clipFromView with 16 numbers: write it with "
                      "blender_scripts/render_guides.py");
  }
  result.view_from_world = *view;
  result.clip_from_view = *clip;
  return result;
}

}  // namespace scumble
