#include "transfer/exemplar/guide_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/image/check.h"
#include "transfer/exemplar/illumination.h"
#include "transfer/lookup_table.h"

namespace scumble {
namespace {

constexpr Layer kExposedBy[] = {Layer::kLuminance, Layer::kLpeLDE,  Layer::kLpeLD12E,
                                Layer::kLpeFull,   Layer::kLpeLDDE, Layer::kLpeLSE};

// `factor` applies to radiance. NaN counts as 0.
float Coordinate(bool radiance, float value, float factor) {
  if (!(value > 0.0f)) return 0.0f;
  if (!radiance) return std::min(value, 1.0f);
  const float light = value * factor;
  return light <= std::numeric_limits<float>::max() ? light / (1.0f + light) : 1.0f;
}

// Of a distance as a share of the reach.
float Closeness(float share) { return share < 1.0f ? 1.0f - std::max(share, 0.0f) : 0.0f; }

// The pixel of a sphere's guides for a pixel of the resized exemplar. On the rim, where the sphere covers no pixel
// centre, the nearest covered one on the line to the middle.
std::size_t Sample(const GuideSet& guides, int x, int y, int width, int height) {
  const auto at = [](int i, int side, int guides_side) {
    return static_cast<int>((2 * std::int64_t(i) + 1) * guides_side / (2 * std::int64_t(side)));
  };
  int u = at(x, width, guides.width()), v = at(y, height, guides.height());
  const auto coverage = guides.Plane(Layer::kCoverage);
  while (!(coverage[guides.Index(u, v)] > 0.0f)) {
    const int dx = guides.width() / 2 - u, dy = guides.height() / 2 - v;
    if (dx == 0 && dy == 0) break;
    // One step along the axis that is farther off the middle.
    if (std::abs(dx) >= std::abs(dy))
      u += dx > 0 ? 1 : -1;
    else
      v += dy > 0 ? 1 : -1;
  }
  return guides.Index(u, v);
}

}  // namespace

Expected<GuideSpace> GuideSpace::Build(const GuideWeights& weights, std::span<const Exemplar> exemplars,
                                       std::shared_ptr<const PreparedExemplar> prepared, double nearest_error,
                                       double scale) {
  SCUMBLE_CHECK_EQ(static_cast<int>(exemplars.size()), prepared->count());
  GuideSpace space;
  space.exemplar_ = std::move(prepared);
  space.nearest_error_ = nearest_error;
  space.outline_reach_ = static_cast<float>(kOutlineReach * scale);
  space.normal_weight_ = weights[Layer::kNormal];
  for (const LayerInfo& info : AllLayers()) {
    if (!(weights[info.layer] > 0.0f) || info.layer == Layer::kNormal) continue;
    SCUMBLE_CHECK(GuideWeights::CanWeigh(info.layer));
    space.layers_.push_back(info.layer), space.weights_.push_back(weights[info.layer]);
    for (int c = 0; c < ChannelCount(info.layer); ++c, ++space.extra_dimensions_) {
      space.parts_.push_back({info.layer, c, GuideWeights::IsRadiance(info.layer), weights[info.layer]});
    }
    for (const Exemplar& exemplar : exemplars) {
      if (exemplar.guides && exemplar.guides->Has(info.layer)) continue;
      return InputError(exemplar.name + " has no guides with layer " + info.name +
                        ", and transfer.guide_weights asks for it: make guides that hold it, or leave its weight at 0");
    }
  }
  SCUMBLE_CHECK(space.dimensions() > 0 && space.extra_dimensions_ <= kMaxExtra);
  for (const Layer layer : kExposedBy) {
    if (!(weights[layer] > 0.0f)) continue;
    if (!space.has_radiance_) space.has_radiance_ = true, space.radiance_ = layer;
    double white = 0.0;
    for (const Exemplar& exemplar : exemplars) white = std::max(white, BrightPercentile(*exemplar.guides, layer));
    if (!(static_cast<float>(white) > 0.0f)) continue;
    space.is_lit_ = true, space.radiance_ = layer, space.white_ = static_cast<float>(white);
    break;
  }
  for (int k = 0; k < space.exemplar_->count(); ++k) {
    space.values_.emplace_back();
    if (space.extra_dimensions_ > 0) space.SampleExemplar(*exemplars[std::size_t(k)].guides, space.values_.back());
    space.trees_.push_back(space.PlantTree(k));
  }
  return space;
}

void GuideSpace::ReadAll(const GuideSet& guides, std::size_t pixel, const Units& units, float* extra_values) const {
  for (const Part& part : parts_) {
    const float value = guides.Plane(part.layer, part.component)[pixel];
    const float coordinate = part.layer == Layer::kOutline ? Closeness(value / units.outline_reach)
                                                           : Coordinate(part.radiance, value, units.light);
    *extra_values++ = part.weight * coordinate;
  }
}

void GuideSpace::Read(const GuideSet& scene, std::size_t pixel, float brightness, float* extra_values) const {
  ReadAll(scene, pixel, {brightness / white_, outline_reach_}, extra_values);
}

void GuideSpace::SampleExemplar(const GuideSet& guides, std::vector<float>& values) const {
  values.resize(std::size_t(exemplar_->width()) * exemplar_->height() * static_cast<std::size_t>(extra_dimensions_));
  // The guides may have more or fewer pixels than the exemplar.
  const float per_pixel = static_cast<float>(guides.height()) / static_cast<float>(exemplar_->height());
  const Units units{1.0f / white_, outline_reach_ * per_pixel};
  for (int y = 0; y < exemplar_->height(); ++y) {
    for (int x = 0; x < exemplar_->width(); ++x) {
      if (!exemplar_->Usable(x, y)) continue;
      const std::size_t from = Sample(guides, x, y, exemplar_->width(), exemplar_->height());
      ReadAll(guides, from, units, values.data() + Offset({x, y}));
    }
  }
}

GuideSpace::Tree GuideSpace::PlantTree(int k) const {
  std::vector<Source> sources = exemplar_->UsablePixels();
  std::vector<float> coordinates;
  coordinates.reserve(sources.size() * static_cast<std::size_t>(dimensions()));
  for (const Source& source : sources) {
    ForEachCoordinate(k, source, [&](float value) { coordinates.push_back(value); });
  }
  return {PointTree(dimensions(), std::move(coordinates)), std::move(sources)};
}

Source GuideSpace::Nearest(int k, glm::vec3 normal, const float* extra_values) const {
  std::array<float, 3 + kMaxExtra> query;
  std::size_t n = 0;
  if (normal_weight_ > 0.0f) {
    const glm::vec3 facing = normal_weight_ * FacingDirection(normal);
    query[0] = facing.x, query[1] = facing.y, query[2] = facing.z, n = 3;
  }
  std::copy(extra_values, extra_values + extra_dimensions_, query.begin() + static_cast<std::ptrdiff_t>(n));
  const Tree& tree = trees_[std::size_t(k)];
  // Pixels come in rows, and neighbours resemble each other. The start of a search does not change its result.
  thread_local std::uint32_t place = 0;
  return tree.sources[tree.points.Nearest({query.data(), n + static_cast<std::size_t>(extra_dimensions_)}, place,
                                          nearest_error_)];
}

void GuideSpace::Blend(int k, float share, float* extra_values) const {
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const Range range = RangeOf(k, layers_[l]);
    const float value = weights_[l] * (range.least + share * (range.largest - range.least));
    for (int c = 0; c < ChannelCount(layers_[l]); ++c) *extra_values++ = value;
  }
}

GuideSpace::Range GuideSpace::RangeOf(int k, Layer layer, int channel) const {
  std::size_t from = 0, l = 0;
  for (; l < layers_.size() && layers_[l] != layer; ++l) from += static_cast<std::size_t>(ChannelCount(layers_[l]));
  SCUMBLE_CHECK(l < layers_.size() && channel < ChannelCount(layer));
  Range range{1.0f, 0.0f};
  for (const Source& source : trees_[std::size_t(k)].sources) {
    const float value = ExtraValuesAt(k, source)[from + static_cast<std::size_t>(channel)] / weights_[l];
    range = {std::min(range.least, value), std::max(range.largest, value)};
  }
  return range;
}

GuideSpace::Range GuideSpace::RangeOf(int k, Layer layer) const {
  Range range = RangeOf(k, layer, 0);
  for (int c = 1; c < ChannelCount(layer); ++c) {
    const Range more = RangeOf(k, layer, c);
    range = {std::min(range.least, more.least), std::max(range.largest, more.largest)};
  }
  return range;
}

}  // namespace scumble
