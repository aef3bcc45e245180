#include "transfer/style_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <mutex>

#include "core/image/fragments.h"

namespace scumble {
namespace {

// The assignment of an id; null: none. Neighbours mostly have one id, so the last result is kept.
template <class Assigned>
class Finder {
 public:
  explicit Finder(const std::map<std::uint32_t, Assigned>& assigned) : assigned_(assigned), found_(Find(0)) {}
  const Assigned* At(float id) {
    const std::uint32_t whole = IdOf(id);
    if (whole != last_) last_ = whole, found_ = Find(whole);
    return found_;
  }

 private:
  const Assigned* Find(std::uint32_t id) const {
    const auto found = assigned_.find(id);
    return found != assigned_.end() ? &found->second : nullptr;
  }
  const std::map<std::uint32_t, Assigned>& assigned_;
  std::uint32_t last_ = 0;
  const Assigned* found_;
};

// A layer without assignments need not be there.
template <class Assigned>
std::span<const float> Ids(const GuideSet& guides, Layer layer, const std::map<std::uint32_t, Assigned>& assigned) {
  return assigned.empty() ? std::span<const float>() : guides.Plane(layer);
}

// Calls visit(pixel, object's, material's), null without an assignment, for ranges of pixels on all threads; `begin`
// makes a visitor for a range.
template <class Assignment, class Begin>
void ForEachPixel(const GuideSet& guides, const Assignment& assignment, const Begin& begin) {
  constexpr std::size_t kStretch = 1 << 16;
  const auto objects = Ids(guides, Layer::kObject, assignment.of_object);
  const auto materials = Ids(guides, Layer::kMaterial, assignment.of_material);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, guides.pixel_count(), kStretch), [&](const auto& stretch) {
    Finder object(assignment.of_object);
    Finder material(assignment.of_material);
    auto visit = begin();
    for (std::size_t i = stretch.begin(); i != stretch.end(); ++i) {
      visit(i, objects.empty() ? nullptr : object.At(objects[i]),
            materials.empty() ? nullptr : material.At(materials[i]));
    }
  });
}

}  // namespace

namespace {

std::vector<std::uint16_t> StylesOf(const GuideSet& guides, const StyleAssignment& assignment) {
  std::vector<std::uint16_t> style(guides.pixel_count(), assignment.otherwise);
  ForEachPixel(guides, assignment, [&] {
    return [&](std::size_t i, const std::uint16_t* object, const std::uint16_t* material) {
      if (object)
        style[i] = *object;
      else if (material)
        style[i] = *material;
    };
  });
  return style;
}

// Adds the counts of one range of pixels when the range is done.
class Counts {
 public:
  Counts(std::span<std::size_t> sums, std::mutex& mutex) : sums_(sums), mutex_(mutex), counts_(sums.size()) {}
  Counts(const Counts&) = delete;
  ~Counts() {
    const std::lock_guard lock(mutex_);
    for (std::size_t k = 0; k < counts_.size(); ++k) sums_[k] += counts_[k];
  }
  std::size_t& operator[](std::size_t k) { return counts_[k]; }

 private:
  std::span<std::size_t> sums_;
  std::mutex& mutex_;
  std::vector<std::size_t> counts_;
};

}  // namespace

StyleMap MapStyles(const GuideSet& guides, const StyleAssignment& assignment) {
  StyleMap map{StylesOf(guides, assignment), {}};
  if (guides.fragments) map.fragment_style = StylesOf(guides.fragments->values, assignment);
  return map;
}

namespace {

void Assign(const GuideSet& guides, const RankedAssignment& assignment, std::vector<std::uint16_t>& style,
            std::span<std::size_t> pixels) {
  std::mutex mutex;
  ForEachPixel(guides, assignment, [&] {
    return [&, counts = std::make_unique<Counts>(pixels, mutex)](std::size_t i, const RankedStyle* object,
                                                                 const RankedStyle* material) {
      const RankedStyle* best = object;
      if (material && (!best || material->rank > best->rank)) best = material;
      if (!best) return;
      style[i] = best->style;
      ++(*counts)[best->rank];
    };
  });
}

}  // namespace

void AssignStyles(const GuideSet& guides, const RankedAssignment& assignment, StyleMap& map,
                  std::span<std::size_t> pixels) {
  Assign(guides, assignment, map.style, pixels);
  if (!guides.fragments) return;
  if (map.fragment_style.empty()) {
    for (const std::uint32_t pixel : guides.fragments->pixel) map.fragment_style.push_back(map.style[pixel]);
  }
  std::vector<std::size_t> uncounted(pixels.size());
  Assign(guides.fragments->values, assignment, map.fragment_style, uncounted);
}

}  // namespace scumble
