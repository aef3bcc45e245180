#include "transfer/style_map.h"

namespace scumble {
namespace {

// What an id is assigned; null: nothing.
template <class Assigned>
const Assigned* Find(const std::map<std::uint32_t, Assigned>& assigned, float id) {
  const auto found = assigned.find(id > 0.0f ? static_cast<std::uint32_t>(id) : 0u);
  return found != assigned.end() ? &found->second : nullptr;
}

// A layer that nothing is assigned by need not be there.
template <class Assigned>
std::span<const float> Ids(const GuideSet& guides, Layer layer, const std::map<std::uint32_t, Assigned>& assigned) {
  return assigned.empty() ? std::span<const float>() : guides.Plane(layer);
}

}  // namespace

StyleMap MapStyles(const GuideSet& guides, const StyleAssignment& assignment) {
  StyleMap map{std::vector<std::uint16_t>(guides.pixel_count(), assignment.otherwise)};
  const auto objects = Ids(guides, Layer::kObject, assignment.of_object);
  const auto materials = Ids(guides, Layer::kMaterial, assignment.of_material);
  for (std::size_t i = 0; i < map.style.size(); ++i) {
    const std::uint16_t* style = objects.empty() ? nullptr : Find(assignment.of_object, objects[i]);
    if (!style && !materials.empty()) style = Find(assignment.of_material, materials[i]);
    if (style) map.style[i] = *style;
  }
  return map;
}

void AssignStyles(const GuideSet& guides, const RankedAssignment& assignment, StyleMap& map,
                  std::span<std::size_t> pixels) {
  const auto objects = Ids(guides, Layer::kObject, assignment.of_object);
  const auto materials = Ids(guides, Layer::kMaterial, assignment.of_material);
  for (std::size_t i = 0; i < map.style.size(); ++i) {
    const RankedStyle* best = objects.empty() ? nullptr : Find(assignment.of_object, objects[i]);
    const RankedStyle* material = materials.empty() ? nullptr : Find(assignment.of_material, materials[i]);
    if (material && (!best || material->rank > best->rank)) best = material;
    if (!best) continue;
    map.style[i] = best->style;
    ++pixels[best->rank];
  }
}

}  // namespace scumble
