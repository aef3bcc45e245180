#include "guidegen/cast/cast_fragments.h"

#include <algorithm>
#include <tuple>

#include "guidegen/path_layers.h"
#include "guidegen/surface/shading_normal.h"

namespace scumble {
namespace {

bool IsLight(Layer layer) {
  return layer == Layer::kLuminance || layer == Layer::kShadow || PathLayerExpression(layer) != nullptr;
}

// The pixel whose light a fragment takes, as core/image/fragments.h says.
std::size_t PlaceOfLight(const FoundFragments::Found& found, float object, float material, const GuideSet& guides) {
  const int width = guides.width(), height = guides.height();
  const int x = int(found.pixel) % width, y = int(found.pixel) / width;
  const auto objects = guides.Plane(Layer::kObject), materials = guides.Plane(Layer::kMaterial);
  std::size_t nearest = found.pixel;
  float least = 0.0f;  // squared distance, once a pixel shows the surface
  for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
      const std::size_t i = guides.Index(u, v);
      if (objects[i] != object || materials[i] != material) continue;
      const float dx = float(u - x) - found.at.x, dy = float(v - y) - found.at.y;
      const float distance = dx * dx + dy * dy;
      if (nearest == found.pixel || distance < least) nearest = i, least = distance;
    }
  }
  return nearest;
}

}  // namespace

FragmentCaster::FragmentCaster(const EmbreeScene& scene, const View& view, NormalFrame frame, const LayerSet& layers,
                               int width)
    : scene_(scene), view_(view), point_values_(scene, view, frame), layers_(layers), width_(width) {}

void FragmentCaster::Add(const PrimaryRays::Beside& beside, FoundFragments& found) const {
  const PlacedObject& object = scene_.objects()[beside.object];
  const ViewRay ray = view_.camera.ThroughWithFootprint(beside.at.x, beside.at.y);
  SurfacePoint point = FindSurfacePoint(object, beside.primitive, ray);
  if (view_.bends_normals) BendShadingNormal(object, ray, point);
  const int x = int(beside.at.x), y = int(beside.at.y);
  found.found.push_back({std::uint32_t(y) * std::uint32_t(width_) + std::uint32_t(x),
                         glm::vec2(beside.at - glm::dvec2(x + 0.5, y + 0.5)), beside.cells, found.values.size()});
  const auto put = [&](double value) { found.values.push_back(float(value)); };
  const auto put_all = [&](const auto& values) {
    for (int i = 0; i < values.length(); ++i) put(values[i]);
  };
  for (const LayerInfo& info : AllLayers()) {
    if (!layers_.Has(info.layer)) continue;
    switch (info.layer) {
      case Layer::kCoverage:
        put(beside.coverage);
        break;
      case Layer::kNormal:
        put_all(point_values_.Normal(point, ray));
        break;
      case Layer::kDepth:
        put(std::max(-point.position.z, 0.0));
        break;
      case Layer::kObject:
        put(object.object_id);
        break;
      case Layer::kMaterial:
        put(object.material_id);
        break;
      case Layer::kPosition:
        put_all(view_.camera.WorldFromView(point.position));
        break;
      case Layer::kPref:
        put_all(point_values_.Rest(beside.object, beside.primitive, point, ray));
        break;
      case Layer::kMotion:
        put_all(point_values_.Motion(beside.object, beside.primitive, point.barycentric));
        break;
      case Layer::kAlbedo:
        put_all(glm::dvec3(SurfaceColor(object, beside.primitive, point.barycentric)));
        break;
      case Layer::kCosine:
        put(point_values_.Cosine(point));
        break;
      case Layer::kOutline:
        put(0.5);  // several surfaces share the pixel
        break;
      case Layer::kUv:
        put_all(point_values_.Uv(beside.object, beside.primitive, point.barycentric));
        break;
      default:
        for (int i = 0; i < ChannelCount(info.layer); ++i) put(0.0);
    }
  }
}

std::shared_ptr<const Fragments> GatherFragments(std::span<const FoundFragments* const> by_thread,
                                                 const PixelWindow& window, const GuideSet& guides) {
  std::vector<std::pair<const FoundFragments*, const FoundFragments::Found*>> all;
  for (const FoundFragments* some : by_thread) {
    for (const FoundFragments::Found& one : some->found) {
      const int x = int(one.pixel) % guides.width(), y = int(one.pixel) / guides.width();
      if (window.Contains(x, y)) all.emplace_back(some, &one);
    }
  }
  if (all.empty()) return nullptr;
  int channels = 0, object = 0, material = 0;
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    if (info.layer == Layer::kObject) object = channels;
    if (info.layer == Layer::kMaterial) material = channels;
    channels += ChannelCount(info.layer);
  }
  const auto value = [](const auto& one, int channel) { return one.first->values[one.second->first + channel]; };
  // A pixel's surfaces differ in their ids, so the order does not depend on the threads. Coverage is the first channel.
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return std::tuple(a.second->pixel, -value(a, 0), value(a, object), value(a, material)) <
           std::tuple(b.second->pixel, -value(b, 0), value(b, object), value(b, material));
  });
  auto fragments = std::make_shared<Fragments>();
  fragments->values = GuideSet(int(all.size()), 1);
  for (const auto& one : all) {
    fragments->pixel.push_back(one.second->pixel);
    fragments->cells.push_back(one.second->cells);
  }
  int channel = 0;
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    fragments->values.AddUnset(info.layer);
    for (int c = 0; c < ChannelCount(info.layer); ++c, ++channel) {
      const auto plane = fragments->values.Plane(info.layer, c);
      for (std::size_t i = 0; i < all.size(); ++i) plane[i] = value(all[i], channel);
      if (!IsLight(info.layer)) continue;
      const auto light = guides.Plane(info.layer, c);
      for (std::size_t i = 0; i < all.size(); ++i) {
        plane[i] = light[PlaceOfLight(*all[i].second, value(all[i], object), value(all[i], material), guides)];
      }
    }
  }
  return fragments;
}

}  // namespace scumble
