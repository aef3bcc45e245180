#include "transfer/upsample_guides.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/filter/edge_test.h"
#include "core/filter/resample.h"
#include "core/image/check.h"
#include "core/image/fragments.h"

namespace scumble {
namespace {

constexpr double kCreaseDegrees = 60.0, kDepthTolerance = 0.002;
constexpr float kCreaseCosine = 0.5f;
constexpr std::int64_t kMaxPixels = std::int64_t(1) << 28;  // as in pictures that are read or made

// The neighbours along one axis of a sample at offset k of a block: the pixel itself and the one on k's side, with its
// weight in [0, 1/2).
struct Side {
  int step = 0;  // -1, 0 or 1
  float weight = 0.0f;
};
Side SideOf(int k, int factor) {
  const int off = 2 * k + 1 - factor;  // from the pixel's centre, in half samples
  return {off < 0 ? -1 : off > 0 ? 1 : 0, static_cast<float>(std::abs(off)) / static_cast<float>(2 * factor)};
}

bool IsInPixels(Layer layer) { return layer == Layer::kMotion || layer == Layer::kOutline; }

// One plane of a layer, small and large.
struct PlanePair {
  std::span<const float> from;
  std::span<float> to;
  bool is_id = false;
  float factor = 1.0f;
};

class Upsampler {
 public:
  Upsampler(const GuideSet& from, int factor, GuideSet& to)
      : from_(from), factor_(factor), to_(to), coverage_(from.Plane(Layer::kCoverage)) {
    for (int k = 0; k < factor; ++k) sides_.push_back(SideOf(k, factor));
    for (const LayerInfo& info : AllLayers()) {
      if (!from.Has(info.layer) || info.layer == Layer::kCoverage) continue;
      const bool is_id = info.layer == Layer::kObject || info.layer == Layer::kMaterial;
      const float scale = IsInPixels(info.layer) ? static_cast<float>(factor) : 1.0f;
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        planes_.push_back({from.Plane(info.layer, c), to.Plane(info.layer, c), is_id, scale});
      }
    }
    if (!from.Has(Layer::kNormal) || !from.Has(Layer::kDepth) || !from.Has(Layer::kObject)) return;
    slopes_.emplace(from);
    edges_.emplace(from, *slopes_, kCreaseDegrees, kDepthTolerance);
  }

  void Row(int y) {
    for (int x = 0; x < from_.width(); ++x) {
      const std::size_t p = from_.Index(x, y);
      if (!(coverage_[p] > 0.0f)) continue;
      bool same[3][3];  // which neighbours show this pixel's surface
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const bool inside = x + dx >= 0 && y + dy >= 0 && x + dx < from_.width() && y + dy < from_.height();
          same[dy + 1][dx + 1] = inside && SameSurface(p, from_.Index(x + dx, y + dy), dx, dy);
        }
      }
      for (int v = 0; v < factor_; ++v) {
        for (int u = 0; u < factor_; ++u) Sample(x, y, u, v, same);
      }
      Cover(x, y);
    }
  }

  // After all rows. Null: none.
  std::shared_ptr<const Fragments> LargeFragments() const {
    if (!from_.fragments || from_.fragments->count() == 0) return nullptr;
    const Fragments& fragments = *from_.fragments;
    std::vector<Placed> placed;
    for (std::size_t begin = 0; begin < fragments.count();) {
      std::size_t end = begin + 1;
      while (end < fragments.count() && fragments.pixel[end] == fragments.pixel[begin]) ++end;
      PlaceFragments(begin, end, placed);
      begin = end;
    }
    std::ranges::stable_sort(placed, {}, &Placed::pixel);
    auto large = std::make_shared<Fragments>();
    large->values = GuideSet(static_cast<int>(placed.size()), 1);
    for (const Placed& one : placed) large->pixel.push_back(one.pixel);
    for (const LayerInfo& info : AllLayers()) {
      if (!fragments.values.Has(info.layer)) continue;
      large->values.AddUnset(info.layer);
      const float scale = IsInPixels(info.layer) ? static_cast<float>(factor_) : 1.0f;
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        const auto from = fragments.values.Plane(info.layer, c);
        const auto to = large->values.Plane(info.layer, c);
        for (std::size_t i = 0; i < placed.size(); ++i) to[i] = from[placed[i].fragment] * scale;
      }
    }
    const auto coverage = large->values.Plane(Layer::kCoverage);
    for (std::size_t i = 0; i < placed.size(); ++i) coverage[i] = placed[i].coverage;
    return large;
  }

 private:
  bool SameSurface(std::size_t p, std::size_t q, int dx, int dy) const {
    if (p == q) return true;
    if (!(coverage_[q] > 0.0f)) return false;
    if (edges_) return edges_->SameSurface(edges_->At(p), edges_->At(q), dx, dy);
    if (from_.Has(Layer::kObject) && from_.Plane(Layer::kObject)[p] != from_.Plane(Layer::kObject)[q]) return false;
    if (!from_.Has(Layer::kNormal)) return true;
    const glm::vec3 a = from_.Vec3(Layer::kNormal, p), b = from_.Vec3(Layer::kNormal, q);
    return a.x * b.x + a.y * b.y + a.z * b.z > kCreaseCosine;
  }

  void Sample(int x, int y, int u, int v, const bool (&same)[3][3]) {
    const std::size_t p = from_.Index(x, y), target = to_.Index(x * factor_ + u, y * factor_ + v);
    const Side across = sides_[std::size_t(u)], down = sides_[std::size_t(v)];
    std::size_t taps[4];
    float weights[4], total = 0.0f;
    int count = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const int dx = corner & 1 ? across.step : 0, dy = corner >> 1 ? down.step : 0;
      const float weight =
          (corner & 1 ? across.weight : 1.0f - across.weight) * (corner >> 1 ? down.weight : 1.0f - down.weight);
      if (!(weight > 0.0f) || !same[dy + 1][dx + 1]) continue;
      taps[count] = from_.Index(x + dx, y + dy), weights[count++] = weight;
      total += weight;
    }
    for (const PlanePair& plane : planes_) {
      float value = plane.from[p];
      if (!plane.is_id && count > 1) {
        value = 0.0f;
        for (int t = 0; t < count; ++t) value += weights[t] * plane.from[taps[t]];
        value /= total;
      }
      plane.to[target] = value * plane.factor;
    }
    if (count > 1 && from_.Has(Layer::kNormal)) Normalise(target);
  }

  void Normalise(std::size_t target) {
    const glm::vec3 n = to_.Vec3(Layer::kNormal, target);
    const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    if (!(length > 0.0f)) return;  // impossible: all are within the crease angle of one
    for (int c = 0; c < 3; ++c) to_.Plane(Layer::kNormal, c)[target] /= length;
  }

  // By sample of a block, in rows.
  using Block = std::array<float, kMaxUpsampling * kMaxUpsampling>;

  std::size_t Target(int x, int y, int k) const {
    return to_.Index(x * factor_ + k % factor_, y * factor_ + k / factor_);
  }

  float Between(int x, int y, int u, int v) const {
    return Between(x, y, u, v, [&](std::size_t q) { return coverage_[q]; });
  }

  // A coverage between the centres of pixels; beyond the picture's edge its values are repeated.
  template <class ValueOf>
  float Between(int x, int y, int u, int v, const ValueOf& value_of) const {
    const Side across = sides_[std::size_t(u)], down = sides_[std::size_t(v)];
    const auto at = [&](int qx, int qy) {
      return value_of(from_.Index(std::clamp(qx, 0, from_.width() - 1), std::clamp(qy, 0, from_.height() - 1)));
    };
    const float above = (1.0f - across.weight) * at(x, y) + across.weight * at(x + across.step, y);
    const float below =
        (1.0f - across.weight) * at(x, y + down.step) + across.weight * at(x + across.step, y + down.step);
    return (1.0f - down.weight) * above + down.weight * below;
  }

  void Cover(int x, int y) {
    const float share = std::min(coverage_[from_.Index(x, y)], 1.0f);
    const auto out = to_.Plane(Layer::kCoverage);
    Block block;
    if (share < 1.0f) {
      for (int k = 0; k < factor_ * factor_; ++k) block[std::size_t(k)] = Between(x, y, k % factor_, k / factor_);
      Spread(share, block);
    } else {
      block.fill(1.0f);
    }
    for (int k = 0; k < factor_ * factor_; ++k) out[Target(x, y, k)] = block[std::size_t(k)];
  }

  // Turns a contour into coverage whose mean is `share`: samples above a threshold are covered, softened over one
  // sample.
  void Spread(double share, Block& block) const {
    const int count = factor_ * factor_;
    const auto covered = [&](int k, double threshold) {
      return std::clamp((block[std::size_t(k)] - threshold) * factor_ + 0.5, 0.0, 1.0);
    };
    double low = -1.0, high = 2.0;  // everything is covered, nothing is
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (low + high);
      double sum = 0.0;
      for (int k = 0; k < count; ++k) sum += covered(k, middle);
      (sum > share * count ? low : high) = middle;
    }
    for (int k = 0; k < count; ++k) block[std::size_t(k)] = static_cast<float>(covered(k, low));
  }

  // Whether the surface of fragment `a` is that of `b` of other guides.
  static bool SameIds(const GuideSet& a_of, std::size_t a, const GuideSet& b_of, std::size_t b) {
    return std::ranges::all_of(std::array{Layer::kObject, Layer::kMaterial}, [&](Layer layer) {
      return !a_of.Has(layer) || !b_of.Has(layer) || a_of.Plane(layer)[a] == b_of.Plane(layer)[b];
    });
  }

  // How much of pixel q the fragment's surface covers.
  float CoverageOf(std::size_t fragment, std::size_t q) const {
    const Fragments& fragments = *from_.fragments;
    const auto coverage = fragments.values.Plane(Layer::kCoverage);
    const bool at_centre = SameIds(fragments.values, fragment, from_, q);
    float left = coverage_[q];
    for (std::size_t f = fragments.From(q); f < fragments.count() && fragments.pixel[f] == q; ++f) {
      if (!at_centre && SameIds(fragments.values, fragment, fragments.values, f)) return coverage[f];
      left -= coverage[f];
    }
    return at_centre ? std::max(left, 0.0f) : 0.0f;
  }

  // A fragment of the large picture: its pixel, the small one whose values it has, and its coverage.
  struct Placed {
    std::uint32_t pixel;
    std::uint32_t fragment;
    float coverage;
  };

  // The fragments of one pixel, from `begin` to `end`, in its block.
  void PlaceFragments(std::size_t begin, std::size_t end, std::vector<Placed>& placed) const {
    const std::size_t p = from_.fragments->pixel[begin];
    const int x = static_cast<int>(p) % from_.width(), y = static_cast<int>(p) / from_.width();
    std::array<Block, Fragments::kMostInPixel> blocks;
    for (std::size_t f = begin; f < end; ++f) {
      Block& block = blocks[f - begin];
      for (int k = 0; k < factor_ * factor_; ++k) {
        block[std::size_t(k)] =
            Between(x, y, k % factor_, k / factor_, [&](std::size_t q) { return CoverageOf(f, q); });
      }
      Spread(from_.fragments->values.Plane(Layer::kCoverage)[f], block);
    }
    for (int k = 0; k < factor_ * factor_; ++k) {
      const std::size_t target = Target(x, y, k);
      float sum = 0.0f;
      for (std::size_t f = begin; f < end; ++f) sum += blocks[f - begin][std::size_t(k)];
      const float most = to_.Plane(Layer::kCoverage)[target], scale = sum > most ? most / sum : 1.0f;
      for (std::size_t f = begin; f < end; ++f) {
        const float coverage = blocks[f - begin][std::size_t(k)] * scale;
        if (coverage > 0.0f) placed.push_back({std::uint32_t(target), std::uint32_t(f), coverage});
      }
    }
  }

  const GuideSet& from_;
  const int factor_;
  GuideSet& to_;
  std::span<const float> coverage_;
  std::vector<Side> sides_;
  std::vector<PlanePair> planes_;
  std::optional<internal::DepthSlopes> slopes_;
  std::optional<internal::EdgeTest> edges_;
};

}  // namespace

Status CheckLargerSize(int width, int height, int factor) {
  if (std::max(width, height) <= kMaxImageSide / factor &&
      std::int64_t(width) * height <= kMaxPixels / (factor * factor)) {
    return Ok();
  }
  return UsageError("guides of " + std::to_string(width) + "×" + std::to_string(height) + " cannot be upsampled " +
                    std::to_string(factor) + " times: a picture has at most " + std::to_string(kMaxPixels) +
                    " pixels, " + std::to_string(kMaxImageSide) + " a side; take a smaller factor");
}

Expected<GuideSet> UpsampleGuides(const GuideSet& guides, int factor, int threads) {
  SCUMBLE_CHECK(factor >= 1 && factor <= kMaxUpsampling);
  if (factor == 1) return guides;
  SCUMBLE_RETURN_IF_ERROR(CheckLargerSize(guides.width(), guides.height(), factor));
  GuideSet larger(guides.width() * factor, guides.height() * factor);
  for (const LayerInfo& info : AllLayers()) {
    if (guides.Has(info.layer)) larger.Add(info.layer);
  }
  larger.attributes = guides.attributes;
  larger.object_names = guides.object_names, larger.material_names = guides.material_names;
  larger.camera = guides.camera;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    Upsampler upsampler(guides, factor, larger);
    tbb::parallel_for(0, guides.height(), [&](int y) { upsampler.Row(y); });
    larger.fragments = upsampler.LargeFragments();
  });
  return larger;
}

Picture UpscalePicture(const Picture& picture, int factor, int threads) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  return arena.execute([&] { return Resample(picture, picture.width * factor, picture.height * factor); });
}

}  // namespace scumble
