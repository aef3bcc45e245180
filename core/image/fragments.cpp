#include "core/image/fragments.h"

#include <algorithm>
#include <map>

namespace scumble {
namespace {

// Whether all ids of the layer have names, or the guides name none.
bool AreNamed(const GuideSet& values, Layer layer, const std::map<std::uint32_t, std::string>& names) {
  if (!values.Has(layer) || names.empty()) return true;
  return std::ranges::all_of(values.Plane(layer), [&](float id) { return names.count(IdOf(id)) > 0; });
}

}  // namespace

std::size_t Fragments::From(std::size_t pixel_index) const {
  return static_cast<std::size_t>(std::lower_bound(pixel.begin(), pixel.end(), pixel_index) - pixel.begin());
}

Status Fragments::Validate(const GuideSet& guides, const std::string& name) const {
  const auto refuse = [&](const std::string& what) -> Status {
    return InputError(name + ": its fragments " + what + kRemedyForFragments);
  };
  if (values.pixel_count() != count()) return refuse("have values for another number of surfaces");
  if (!cells.empty() && cells.size() != count()) return refuse("have cells for another number of surfaces");
  if (count() == 0) return Ok();
  if (!values.layers().Contains(guides.layers())) {
    return refuse("hold " + values.layers().ToString() + ", the guides " + guides.layers().ToString());
  }
  if (!values.Has(Layer::kCoverage) || !values.Has(Layer::kNormal)) return refuse("have no coverage or no normal");
  const auto coverage = guides.Plane(Layer::kCoverage), own = values.Plane(Layer::kCoverage);
  for (std::size_t begin = 0; begin < count();) {
    const std::uint32_t place = pixel[begin];
    if (place >= guides.pixel_count()) return refuse("lie outside the picture");
    std::size_t end = begin;
    double sum = 0.0;
    for (; end < count() && pixel[end] == place; ++end) {
      if (!(own[end] > 0.0f)) return refuse("have a coverage of " + std::to_string(own[end]) + ", not above 0");
      sum += own[end];
    }
    if (end < count() && pixel[end] < place) return refuse("are out of order");
    if (end - begin > kMostInPixel) return refuse("are too many in one pixel");
    constexpr double kRounding = 1e-5;
    if (!(sum <= coverage[place] + kRounding)) return refuse("cover more than their pixel");
    begin = end;
  }
  if (!AreNamed(values, Layer::kObject, guides.object_names)) return refuse("show objects that the guides do not name");
  if (!AreNamed(values, Layer::kMaterial, guides.material_names)) {
    return refuse("show materials that the guides do not name");
  }
  return values.ValidateValues(name + ", its fragments");
}

}  // namespace scumble
