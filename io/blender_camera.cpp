#include "io/blender_camera.h"

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <vector>

#include "io/atomic_file.h"
#include "io/guide_header.h"

namespace scumble {
namespace {

constexpr std::size_t kMaxCameraBytes = 64 << 20;
constexpr float kBackgroundDepth = 1e9f;  // Blender writes 1e10

glm::dvec3 GltfFromBlender(glm::dvec3 v) { return {v.x, v.z, -v.y}; }

glm::vec3 Get(const GuideSet& guides, Layer layer, std::size_t i) { return guides.Vec3(layer, i); }

void Set(GuideSet& guides, Layer layer, std::size_t i, glm::vec3 value) {
  for (int c = 0; c < 3; ++c) guides.Plane(layer, c)[i] = value[c];
}

void ConvertVectors(const BlenderCamera& camera, GuideSet& guides) {
  const glm::dmat3 view_from_world(camera.camera.view_from_world);
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const bool covered = coverage[i] > 0.0f;
    if (guides.Has(Layer::kNormal)) {
      const glm::dvec3 world = GltfFromBlender(Get(guides, Layer::kNormal, i));
      Set(guides, Layer::kNormal, i, covered ? glm::vec3(view_from_world * world) : glm::vec3(0.0f));
    }
    if (guides.Has(Layer::kPosition)) {
      const glm::vec3 world(GltfFromBlender(Get(guides, Layer::kPosition, i)));
      Set(guides, Layer::kPosition, i, covered ? world : glm::vec3(0.0f));
    }
  }
}

void ConvertIds(const BlenderCamera& camera, GuideSet& guides) {
  std::vector<std::string> names;
  std::map<std::uint32_t, std::size_t> place;  // of an index in `names`
  const auto ids = guides.Plane(Layer::kObject);
  for (const float value : ids) {
    const auto index = value > 0.0f ? static_cast<std::uint32_t>(value) : 0u;
    if (index == 0 || !place.try_emplace(index, names.size()).second) continue;
    const auto named = camera.objects.find(index);
    names.push_back(named != camera.objects.end() ? named->second : "index " + std::to_string(index));
  }
  const std::vector<std::uint32_t> hashed = IdsForNames(names);
  for (std::size_t n = 0; n < names.size(); ++n) guides.object_names[hashed[n]] = names[n];
  for (float& value : ids) {
    const auto index = value > 0.0f ? static_cast<std::uint32_t>(value) : 0u;
    value = index == 0 ? 0.0f : static_cast<float>(hashed[place[index]]);
  }
}

}  // namespace

Expected<BlenderCamera> ReadBlenderCamera(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxCameraBytes));
  std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  BlenderCamera result;
  std::optional<glm::dmat4> view, clip;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::size_t space = line.find(' ');
    const std::string key = line.substr(0, space), rest = space == std::string::npos ? "" : line.substr(space + 1);
    const std::size_t second = rest.find(' ');
    if (key == "camera") result.camera.name = rest;
    else if (key == "viewFromWorld") view = internal::MatrixFromText(rest);
    else if (key == "clipFromView") clip = internal::MatrixFromText(rest);
    else if (key == "object" && second != std::string::npos && second > 0 && second < 9 &&
             rest.find_first_not_of("0123456789") == second) {
      result.objects[static_cast<std::uint32_t>(std::stoul(rest))] = rest.substr(second + 1);
    } else if (!line.empty()) {
      return InputError(path.string() + ":" + std::to_string(number) + ": '" + line.substr(0, 40) +
                        "' is no line of a .camera file, as blender_scripts/render_guides.py writes it");
    }
  }
  if (!view || !clip) {
    return InputError(path.string() + " lacks viewFromWorld or clipFromView with 16 numbers: write it with "
                      "blender_scripts/render_guides.py");
  }
  result.camera.view_from_world = *view;
  result.camera.clip_from_view = *clip;
  return result;
}

void ConvertBlenderPasses(const BlenderCamera& camera, GuideSet& guides) {
  if (guides.Has(Layer::kCoverage)) ConvertVectors(camera, guides);
  if (guides.Has(Layer::kDepth)) {
    for (float& depth : guides.Plane(Layer::kDepth)) {
      if (!(depth < kBackgroundDepth)) depth = std::numeric_limits<float>::infinity();
    }
  }
  if (guides.Has(Layer::kObject)) ConvertIds(camera, guides);
  guides.camera = camera.camera;
}

}  // namespace scumble
