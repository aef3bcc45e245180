#include "finish/points/shared_pixels.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <glm/glm.hpp>
#include <iterator>
#include <variant>

#include "core/image/color.h"

namespace scumble::internal {
namespace {

// Colours by their shares of a pixel, in linear light. In doubles their order does not show.
class Mixture {
 public:
  void Add(const Texel& texel, float share) {
    const double weight = double(share) * texel[3];
    for (std::size_t c = 0; c < 3; ++c) sum_[c] += weight * double(Srgb16ToLinear(texel[c]));
    alpha_ += weight;
    is_one_ = is_one_ && (count_ == 0 || std::equal(texel.begin(), texel.begin() + 3, first_.begin()));
    if (count_++ == 0) first_ = texel;
  }
  Texel Color() const {
    Texel color = first_;
    for (std::size_t c = 0; c < 3 && alpha_ > 0.0 && !is_one_; ++c)
      color[c] = Srgb16FromLinear(static_cast<float>(std::min(1.0, sum_[c] / alpha_)));
    return color;
  }

 private:
  double sum_[3] = {}, alpha_ = 0.0;
  int count_ = 0;
  bool is_one_ = true;
  Texel first_ = {};
};

// Pixels none of whose parts a step changes keep their bits.
void Put(const Batch& batch, std::span<const Texel> made, const GivenRow& row, Picture& picture) {
  for (std::size_t i = 0; i < made.size();) {
    const std::size_t pixel = batch.parts[i].pixel;
    Mixture mixture;
    bool changes = false, has_stroke = false;
    for (; i < made.size() && batch.parts[i].pixel == pixel; ++i) {
      changes = changes || made[i] != batch.paint[i];
      has_stroke = has_stroke || batch.parts[i].is_stroke;
      mixture.Add(made[i], batch.parts[i].share);
    }
    const Texel color = changes ? mixture.Color() : row.Of(pixel);
    // Without the stroke, by the pixel's guides alone, a step may have changed it.
    if (changes || has_stroke) std::copy_n(color.begin(), 3, picture.rgba.begin() + 4 * std::ptrdiff_t(pixel));
  }
}

}  // namespace

SharedPixels::SharedPixels(std::span<const PointStep> steps, const FinishFrame& frame) : steps_(steps), frame_(frame) {
  if (!frame.guides) return;
  for (const PointStep& one : steps) {
    if (IsOfGuides(*one.step)) continue;
    strokes_ = frame.strokes;
    // Without its paint a surface can only differ by what its guides say.
    if (frame.colors || !one.coverage.empty()) fragments_ = frame.guides->fragments.get();
  }
  if (fragments_ && (fragments_->count() == 0 || !fragments_->values.Has(Layer::kObject))) fragments_ = nullptr;
}

void SharedPixels::PaintRow(const GivenRow& row, Picture& picture) const {
  const std::size_t last = row.first + row.width();  // and one
  const std::size_t end = fragments_ ? fragments_->From(last) : 0;
  std::size_t first = fragments_ ? fragments_->From(row.first) : 0;
  auto stroke = std::ranges::lower_bound(strokes_, row.first, {}, &EdgeStroke::pixel);
  Batch batch;
  for (;;) {
    const std::size_t of_fragment = first < end ? fragments_->pixel[first] : last;
    const std::size_t of_stroke = stroke != strokes_.end() ? std::min<std::size_t>(stroke->pixel, last) : last;
    Shared shared{std::min(of_fragment, of_stroke), first, first};
    if (shared.pixel == last) break;
    while (shared.end < end && fragments_->pixel[shared.end] == shared.pixel) ++shared.end;
    first = shared.end;
    const Texel given = row.Of(shared.pixel);
    if (of_stroke != shared.pixel) {
      if (given[3] != 0) AddParts(shared, given, batch);
    } else {
      if (given[3] != 0) AddStroke(*stroke, shared, given, batch);
      ++stroke;
    }
  }
  Put(batch, PaintParts(steps_, batch), row, picture);
}

// The pixel around whose centre shows the fragment's surface, the nearest to its cells; none: the picture has no such
// pixel nearby.
std::optional<std::size_t> SharedPixels::LikeOf(std::size_t fragment) const {
  constexpr int kReach = 4;
  const GuideSet& guides = *frame_.guides;
  const auto width = static_cast<std::size_t>(guides.width());
  const int x = int(fragments_->pixel[fragment] % width), y = int(fragments_->pixel[fragment] / width);
  const std::uint16_t cells = fragments_->cells.empty() ? Fragments::kAllCells : fragments_->cells[fragment];
  glm::vec2 middle(0.0f);
  for (int cell = 0; cell < 16; ++cell) {
    if (cells >> cell & 1) middle += glm::vec2(cell % 4 - 1.5f, cell / 4 - 1.5f) / (4.0f * float(std::popcount(cells)));
  }
  const auto shows_surface = [&](std::size_t pixel) {
    for (const Layer layer : {Layer::kObject, Layer::kMaterial}) {
      if (guides.Has(layer) && guides.Plane(layer)[pixel] != fragments_->values.Plane(layer)[fragment]) return false;
    }
    return true;
  };
  std::optional<std::size_t> like;
  float least = 0.0f;
  for (int reach = 1; reach <= kReach && !like; ++reach) {
    for (int v = std::max(0, y - reach); v <= std::min(guides.height() - 1, y + reach); ++v) {
      for (int u = std::max(0, x - reach); u <= std::min(guides.width() - 1, x + reach); ++u) {
        const std::size_t pixel = guides.Index(u, v);
        if (std::max(std::abs(u - x), std::abs(v - y)) != reach || !shows_surface(pixel)) continue;
        const glm::vec2 off = glm::vec2(u - x, v - y) - middle;
        const float distance = glm::dot(off, off);
        if (!like || distance < least) like = pixel, least = distance;
      }
    }
  }
  return like;
}

// The paint of the surfaces of a pixel before they were mixed; null: it is not known.
const FragmentColors* SharedPixels::ColorsOf(const Shared& shared, const Texel& texel) const {
  const FragmentColors* const colors = frame_.colors;
  if (!colors || shared.first == shared.end || colors->own.size() != fragments_->count()) return nullptr;
  const Texel& mixed = colors->mixed[shared.first];
  return std::equal(mixed.begin(), mixed.begin() + 3, texel.begin()) ? colors
                                                                     : nullptr;  // else something has changed it
}

void SharedPixels::AddParts(const Shared& shared, const Texel& given, Batch& batch) const {
  const std::size_t pixel = shared.pixel;
  const FragmentColors* const colors = ColorsOf(shared, given);
  const auto add = [&](const Texel& paint, std::size_t like, float share) {
    batch.parts.push_back({pixel, like, share, given[3]});
    batch.paint.push_back(paint);
  };
  float left = 1.0f;
  const float whole = frame_.guides->Plane(Layer::kCoverage)[pixel];
  for (std::size_t i = shared.first; i < shared.end; ++i) {
    const float coverage = fragments_->values.Plane(Layer::kCoverage)[i];
    const float share = whole > 0.0f ? std::min(left, coverage / whole) : 0.0f;
    left -= share;
    add(colors ? colors->own[i] : given, LikeOf(i).value_or(pixel), share);
  }
  add(colors ? colors->centre[shared.first] : given, pixel, left);
}

bool SharedPixels::IsBeforeAnother(const EdgeStroke& stroke) const {
  const GuideSet& guides = *frame_.guides;
  if (!(guides.Plane(Layer::kCoverage)[stroke.pixel] > 0.0f) || !guides.Has(Layer::kObject)) return false;
  return guides.Plane(Layer::kObject)[stroke.pixel] != guides.Plane(Layer::kObject)[stroke.owner];
}

// Whether a step puts something else in the place of the paint there, whatever it was.
bool SharedPixels::IsReplaced(std::size_t pixel) const {
  return std::ranges::any_of(steps_, [&](const PointStep& one) {
    const FinishStep& step = *one.step;
    const auto* const toon = std::get_if<ToonPass>(&step.pass.effect);
    const bool replaces =
        std::holds_alternative<RenderPass>(step.pass.effect) || (toon && toon->base == ToonPass::Color::kAlbedo);
    return replaces && step.pass.strength >= 1.0 && (step.only.empty() || step.only[pixel] != 0) &&
           (step.share.empty() || step.share[pixel] == 65535);
  });
}

// The stroke, and the surfaces beneath it in what it leaves of the pixel's paint, or of the sheet. Strokes whose paint
// is replaced are none any more: silhouettes before other surfaces are exact then.
void SharedPixels::AddStroke(const EdgeStroke& stroke, const Shared& shared, const Texel& given, Batch& batch) const {
  if (IsBeforeAnother(stroke) && IsReplaced(stroke.owner)) {
    if (shared.first != shared.end) AddParts(shared, given, batch);
    return;
  }
  const bool is_known = std::equal(given.begin(), given.begin() + 3, stroke.mixed.begin());  // what lies on what
  const float opacity = static_cast<float>(stroke.own[3]) / 65535.0f, alpha = static_cast<float>(given[3]) / 65535.0f;
  const float share = std::min(1.0f, opacity / alpha);
  Texel own = is_known ? stroke.own : given, beneath = is_known ? stroke.beneath : given;
  own[3] = 65535;
  batch.parts.push_back({shared.pixel, stroke.owner, share, 65535, true});
  batch.paint.push_back(own);
  if (share >= 1.0f) return;
  const std::size_t first = batch.parts.size();
  beneath[3] = static_cast<std::uint16_t>(65535.0f * std::min(1.0f, (alpha - opacity) / (1.0f - opacity)) + 0.5f);
  if (beneath[3] == 0) return;
  AddParts(shared, beneath, batch);
  float all = 0.0f;
  for (std::size_t i = first; i < batch.parts.size(); ++i)
    all += batch.parts[i].share * (static_cast<float>(batch.paint[i][3]) / 65535.0f);
  for (std::size_t i = first; i < batch.parts.size() && all > 0.0f; ++i) batch.parts[i].share *= (1.0f - share) / all;
}

}  // namespace scumble::internal
