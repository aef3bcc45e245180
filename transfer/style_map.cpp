#include "transfer/style_map.h"

namespace scumble {
namespace {

std::uint16_t Find(const std::map<std::uint32_t, std::uint16_t>& styles, float id, std::uint16_t otherwise) {
  const auto found = styles.find(id > 0.0f ? static_cast<std::uint32_t>(id) : 0u);
  return found != styles.end() ? found->second : otherwise;
}

}  // namespace

StyleMap MapStyles(const GuideSet& guides, const StyleAssignment& assignment) {
  StyleMap map{std::vector<std::uint16_t>(guides.pixel_count(), assignment.otherwise)};
  AssignStyles(guides, assignment, map);
  return map;
}

void AssignStyles(const GuideSet& guides, const StyleAssignment& assignment, StyleMap& map) {
  if (!assignment.of_material.empty()) {
    const auto material = guides.Plane(Layer::kMaterial);
    for (std::size_t i = 0; i < map.style.size(); ++i) {
      map.style[i] = Find(assignment.of_material, material[i], map.style[i]);
    }
  }
  if (!assignment.of_object.empty()) {
    const auto object = guides.Plane(Layer::kObject);
    for (std::size_t i = 0; i < map.style.size(); ++i) {
      map.style[i] = Find(assignment.of_object, object[i], map.style[i]);
    }
  }
}

}  // namespace scumble
