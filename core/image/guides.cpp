#include "core/image/guides.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <system_error>

#include "core/image/check.h"
#include "core/image/fragments.h"
#include "core/image/hash.h"

namespace scumble {

GuideSet::GuideSet(int width, int height) : width_(width), height_(height) { SCUMBLE_CHECK(width >= 0 && height >= 0); }

float BackgroundValue(Layer layer) { return layer == Layer::kDepth ? std::numeric_limits<float>::infinity() : 0.0f; }

void GuideSet::Add(Layer layer) {
  if (Has(layer)) return;
  planes_[static_cast<int>(layer)].assign(pixel_count() * ChannelCount(layer), BackgroundValue(layer));
  layers_.Add(layer);
}

void GuideSet::AddUnset(Layer layer) {
  if (Has(layer)) return;
  planes_[static_cast<int>(layer)].resize(pixel_count() * ChannelCount(layer));
  layers_.Add(layer);
}

void GuideSet::Remove(Layer layer) {
  planes_[static_cast<int>(layer)] = {};
  layers_.Remove(layer);
}

std::span<float> GuideSet::Plane(Layer layer, int component) {
  SCUMBLE_CHECK(Has(layer));
  SCUMBLE_CHECK_LT(component, ChannelCount(layer));
  return std::span(planes_[static_cast<int>(layer)]).subspan(pixel_count() * component, pixel_count());
}

std::span<const float> GuideSet::Plane(Layer layer, int component) const {
  return const_cast<GuideSet*>(this)->Plane(layer, component);
}

glm::vec3 GuideSet::Vec3(Layer layer, std::size_t index) const {
  SCUMBLE_DCHECK(ChannelCount(layer) == 3);
  const float* values = planes_[static_cast<int>(layer)].data() + index;
  return {values[0], values[pixel_count()], values[2 * pixel_count()]};
}

namespace {

// Counts the pixels that break a rule and remembers the first.
class Offenders {
 public:
  explicit Offenders(int width) : width_(width) {}
  void Add(std::size_t index) {
    if (count_++ == 0) first_ = index;
  }
  bool any() const { return count_ > 0; }
  std::string Describe() const {
    return std::to_string(count_) + (count_ == 1 ? " pixel" : " pixels") + ", first at (" +
           std::to_string(first_ % width_) + ", " + std::to_string(first_ / width_) + ")";
  }

 private:
  int width_;
  std::size_t count_ = 0;
  std::size_t first_ = 0;
};

}  // namespace

Status GuideSet::Validate(const std::string& name) const {
  if (width_ < 1 || height_ < 1 || width_ > kMaxImageSide || height_ > kMaxImageSide) {
    return InputError(name + " is " + std::to_string(width_) + "×" + std::to_string(height_) +
                      " pixels: guides need at least 1×1 and at most " + std::to_string(kMaxImageSide) + " a side");
  }
  SCUMBLE_RETURN_IF_ERROR(ValidateValues(name));
  return fragments ? fragments->Validate(*this, name) : Ok();
}

Status GuideSet::ValidateValues(const std::string& name) const {
  if (!Has(Layer::kCoverage) || !Has(Layer::kNormal)) {
    return InputError(name + " holds " + layers_.ToString() + ": guides need at least A and normal");
  }
  const auto coverage = Plane(Layer::kCoverage);
  const auto x = Plane(Layer::kNormal, 0), y = Plane(Layer::kNormal, 1), z = Plane(Layer::kNormal, 2);
  const auto depth = Has(Layer::kDepth) ? Plane(Layer::kDepth) : std::span<const float>{};
  Offenders bad_coverage(width_), bad_normal(width_), bad_depth(width_);
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    if (!(coverage[i] >= 0.0f && coverage[i] <= 1.0f)) bad_coverage.Add(i);
    if (!(coverage[i] > 0.0f)) continue;
    const float squared_length = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    if (!(squared_length > 0.25f && squared_length < 4.0f)) bad_normal.Add(i);
    if (!depth.empty() && !(depth[i] >= 0.0f)) bad_depth.Add(i);
  }
  if (bad_coverage.any()) {
    return InputError(name + ": layer A is outside 0 to 1 on " + bad_coverage.Describe() +
                      ": write coverage, not a matte value or an id");
  }
  if (bad_normal.any()) {
    return InputError(name + ": layer normal is not a unit vector (NaN, zero or of another length) on " +
                      bad_normal.Describe() +
                      " of the covered ones: write normals in [-1, 1], unfiltered, "
                      "or set A to 0 there");
  }
  if (bad_depth.any()) {
    return InputError(name + ": layer depth is negative or NaN on " + bad_depth.Describe() +
                      " of the covered ones: write planar depth in metres");
  }
  for (const Layer layer : {Layer::kObject, Layer::kMaterial}) {
    if (!Has(layer)) continue;
    Offenders bad(width_);
    const auto ids = Plane(layer);
    for (std::size_t i = 0; i < pixel_count(); ++i) {
      if (coverage[i] > 0.0f && !(ids[i] >= 0.0f && ids[i] <= kMostId)) bad.Add(i);
    }
    if (bad.any()) {
      return InputError(name + ": layer " + (layer == Layer::kObject ? "object" : "material") +
                        " is NaN, negative or above 2^24 on " + bad.Describe() +
                        " of the covered ones: write ids as whole numbers that a float holds, up to 16777216");
    }
  }
  for (const LayerInfo& info : AllLayers()) {
    if (!Has(info.layer) || !info.is_color) continue;
    Offenders bad(width_);
    for (std::size_t i = 0; i < pixel_count(); ++i) {
      bool finite = true;
      for (int c = 0; c < ChannelCount(info.layer); ++c) finite &= std::isfinite(Plane(info.layer, c)[i]);
      if (coverage[i] > 0.0f && !finite) bad.Add(i);
    }
    if (bad.any()) return InputError(name + ": layer " + info.name + " is NaN or infinite on " + bad.Describe());
  }
  return Ok();
}

std::vector<std::uint32_t> IdsForNames(std::span<const std::string> names) {
  constexpr std::uint32_t kIdCount = 1u << 24;
  const std::set<std::string> sorted(names.begin(), names.end());
  std::map<std::string, std::uint32_t> ids;
  std::set<std::uint32_t> taken;
  for (const std::string& name : sorted) {
    std::uint32_t id = static_cast<std::uint32_t>(HashText(name) % (kIdCount - 1)) + 1;
    while (!taken.insert(id).second) id = id % (kIdCount - 1) + 1;
    ids[name] = id;
  }
  std::vector<std::uint32_t> result;
  result.reserve(names.size());
  for (const std::string& name : names) result.push_back(ids[name]);
  return result;
}

bool HasExactLight(const GuideSet& guides) {
  const auto found = guides.attributes.find(kLightKey);
  return found != guides.attributes.end() && found->second == kExactLight;
}

double LightErrorOf(const GuideSet& guides) {
  const auto found = guides.attributes.find(kLightErrorKey);
  if (found == guides.attributes.end()) return 0.0;
  const std::string& text = found->second;
  double error = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), error);
  return fault == std::errc() && end == text.data() + text.size() && error >= 0.0 && error <= 1.0 ? error : 0.0;
}

}  // namespace scumble
