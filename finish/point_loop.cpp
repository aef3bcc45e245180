#include "finish/point_loop.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <glm/glm.hpp>
#include <iterator>
#include <optional>
#include <variant>
#include <vector>

#include "core/filter/oklab_rows.h"
#include "core/filter/wide_loops.h"
#include "core/image/color.h"
#include "core/image/fragments.h"
#include "core/image/scalar_lane.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/surface_share.h"

namespace scumble::internal {
namespace {

// From one colour to the other, as far as the share says.
SCUMBLE_WIDE_LOOPS void Mix(const float* shares, const float* from, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; ++i) {
    const float mixed = from[i] + (to[i] - from[i]) * shares[i];
    to[i] = shares[i] >= 1.0f ? to[i] : mixed;
  }
}

void MixColors(const float* shares, std::size_t count, const OklabBlock& from, OklabBlock& to) {
  Mix(shares, from.lightness.data(), count, to.lightness.data());
  Mix(shares, from.a.data(), count, to.a.data());
  Mix(shares, from.b.data(), count, to.b.data());
}

// Codes of 16 bits towards others, in linear light, as far as the share says.
SCUMBLE_WIDE_LOOPS void MixCodes(const float* shares, const std::uint16_t* others, std::size_t count,
                                 std::uint16_t* codes) {
  for (std::size_t i = 0; i < count; ++i) {
    const float from = scalar::LinearFromCode(codes[i]), to = scalar::LinearFromCode(others[i]);
    codes[i] = scalar::Rounded(scalar::ClampedCode(from + (to - from) * shares[i]));
  }
}

using Texel = FragmentColors::Texel;

// A surface that shows in a share of a pixel, and a pixel whose guides are like its own.
struct Part {
  std::size_t pixel, like;
  float share;
  std::uint16_t alpha;     // of the pixel, without its stroke
  bool is_stroke = false;  // of a painted edge: all of it is a surface, whatever the guides cover of the pixel
};

// `count` pixels of a picture, from `first` on; or that many parts of pixels.
struct Pixels {
  std::size_t first, count;
  const std::uint16_t* texels;
  const Part* parts = nullptr;

  std::size_t Of(std::size_t i) const { return parts ? parts[i].like : first + i; }
};

// Whether the step does the same to a colour wherever it is.
bool IsOfColors(const FinishStep& step) {
  const auto* const tones = std::get_if<TonesPass>(&step.pass.effect);
  return (tones && tones->tone == TonesPass::Tone::kPaint) || std::holds_alternative<PalettePass>(step.pass.effect) ||
         std::holds_alternative<GradePass>(step.pass.effect) || std::holds_alternative<FillPass>(step.pass.effect);
}

void Copy(const OklabBlock& from, std::size_t first, std::size_t count, std::size_t place, OklabBlock& to) {
  std::copy_n(from.lightness.begin() + std::ptrdiff_t(first), count, to.lightness.begin() + std::ptrdiff_t(place));
  std::copy_n(from.a.begin() + std::ptrdiff_t(first), count, to.a.begin() + std::ptrdiff_t(place));
  std::copy_n(from.b.begin() + std::ptrdiff_t(first), count, to.b.begin() + std::ptrdiff_t(place));
}

// `effect` is one of the step's.
void ApplyEffect(const PointEffect& effect, const FinishStep& step, const Pixels& pixels, OklabBlock& block) {
  if (!pixels.parts || IsOfColors(step)) return effect(pixels.first, pixels.count, block);
  OklabBlock run;  // of neighbours
  for (std::size_t i = 0, end = 0; i < pixels.count; i = end) {
    const std::size_t like = pixels.parts[i].like;
    while (end < pixels.count && pixels.parts[end].like == like + (end - i)) ++end;
    Copy(block, i, end - i, 0, run);
    effect(like, end - i, run);
    Copy(run, 0, end - i, i, block);
  }
}

// How much of each pixel of a block is the surface: made once, for all steps that ask.
class Surface {
 public:
  using Shares = std::array<float, kOklabBlock>;

  // The same coverage and stage for all steps of a loop.
  const Shares& Of(const PointStep& one, const Pixels& pixels) {
    if (!is_made_) {
      const float* coverage = one.coverage.data() + pixels.first;
      Shares of_parts;
      for (std::size_t i = 0; i < pixels.count && pixels.parts; ++i)
        of_parts[i] = pixels.parts[i].is_stroke ? 1.0f : one.coverage[pixels.parts[i].pixel];
      if (pixels.parts) coverage = of_parts.data();
      kinds_ = SurfaceShares(coverage, pixels.texels, IsOfGuides(*one.step), pixels.count, shares_.data());
      is_made_ = true;
    }
    return shares_;
  }
  const ShareKinds& kinds() const { return kinds_; }

 private:
  Shares shares_;
  ShareKinds kinds_;
  bool is_made_ = false;
};

// How much of each pixel's change stays.
enum class Weight { kNothing, kParts, kAll };

Weight WeightsOf(const PointStep& one, const Pixels& pixels, Surface& surface, float* shares) {
  const std::size_t count = pixels.count;
  const FinishStep& step = *one.step;
  const auto strength = static_cast<float>(step.pass.strength);
  Weight weight = strength < 1.0f || !step.share.empty() || !step.only.empty() ? Weight::kParts : Weight::kAll;
  const bool has_coverage = !one.coverage.empty() && !one.behind;
  if (has_coverage) {
    surface.Of(one, pixels);
    if (surface.kinds().all_zero) return Weight::kNothing;
    if (!surface.kinds().all_one) weight = Weight::kParts;
  }
  if (weight == Weight::kAll) return weight;
  std::fill_n(shares, count, strength);
  for (std::size_t i = 0; i < count && !step.share.empty(); ++i)
    shares[i] = strength * (static_cast<float>(step.share[pixels.Of(i)]) / 65535.0f);
  for (std::size_t i = 0; i < count && !step.only.empty(); ++i) shares[i] = step.only[pixels.Of(i)] ? shares[i] : 0.0f;
  if (has_coverage) {
    const Surface::Shares& of_surface = surface.Of(one, pixels);
    for (std::size_t i = 0; i < count; ++i) shares[i] *= of_surface[i];
  }
  return weight;
}

// The part of mixed pixels that is background takes what the step does to that.
void MixBehind(const PointStep& one, const Pixels& pixels, Surface& surface, const OklabBlock& before,
               OklabBlock& block) {
  Surface::Shares shares = surface.Of(one, pixels);
  OklabBlock behind = before;
  ApplyEffect(one.behind, *one.step, pixels, behind);
  for (std::size_t i = 0; i < pixels.count; ++i) shares[i] = shares[i] > 0.0f ? shares[i] : 1.0f;
  MixColors(shares.data(), pixels.count, behind, block);
}

// Texels whose colour no step changes keep their bits, those of alpha 0 too.
void PaintBlock(std::span<const PointStep> steps, const Pixels& pixels, std::uint16_t* texels) {
  const std::size_t count = pixels.count;
  OklabBlock given, block, before;
  OklabFromTexels(texels, count, given);
  block = given;
  Surface surface;
  for (const PointStep& one : steps) {
    Surface::Shares shares;
    const Weight weight = WeightsOf(one, pixels, surface, shares.data());
    if (weight == Weight::kNothing) continue;
    if (one.behind) surface.Of(one, pixels);
    const bool mixes_behind = one.behind && surface.kinds().is_mixed;
    if (weight == Weight::kParts || mixes_behind) before = block;
    ApplyEffect(one.apply, *one.step, pixels, block);
    if (mixes_behind) MixBehind(one, pixels, surface, before, block);
    if (weight == Weight::kParts) MixColors(shares.data(), count, before, block);
  }
  PutBlock(given, 1.0f, nullptr, count, block, texels);
}

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

// A row of a picture as it was before the steps.
struct GivenRow {
  int y;
  std::size_t first;  // pixel
  std::vector<std::uint16_t> texels;

  std::size_t width() const { return texels.size() / 4; }
  Texel Of(std::size_t pixel) const {
    const std::uint16_t* const texel = texels.data() + 4 * (pixel - first);
    return {texel[0], texel[1], texel[2], texel[3]};
  }
};

// The parts of pixels one after the other, and the paint of each without the steps.
struct Batch {
  std::vector<Part> parts;
  std::vector<Texel> paint;
};

// What the steps make of each part.
std::vector<Texel> PaintParts(std::span<const PointStep> steps, const Batch& batch) {
  const std::size_t count = batch.parts.size();
  std::vector<Texel> made = batch.paint, alphas(count);
  for (std::size_t i = 0; i < count; ++i) alphas[i][3] = batch.parts[i].alpha;
  for (std::size_t i = 0; i < count; i += kOklabBlock) {
    const Pixels some{0, std::min(kOklabBlock, count - i), alphas[i].data(), batch.parts.data() + i};
    PaintBlock(steps, some, made[i].data());
  }
  return made;
}

// The pixels that several surfaces share, strokes of painted edges among them.
class SharedPixels {
 public:
  SharedPixels(std::span<const PointStep> steps, const FinishFrame& frame) : steps_(steps), frame_(frame) {
    if (!frame.guides) return;
    for (const PointStep& one : steps) {
      if (IsOfGuides(*one.step)) continue;
      strokes_ = frame.strokes;
      // Without its paint a surface can only differ by what its guides say.
      if (frame.colors || !one.coverage.empty()) fragments_ = frame.guides->fragments.get();
    }
    if (fragments_ && (fragments_->count() == 0 || !fragments_->values.Has(Layer::kObject))) fragments_ = nullptr;
  }

  bool any() const { return fragments_ != nullptr || !strokes_.empty(); }

  // The row has been painted without them.
  void PaintRow(const GivenRow& row, Picture& picture) const {
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

 private:
  // Pixels none of whose parts a step changes keep their bits.
  static void Put(const Batch& batch, std::span<const Texel> made, const GivenRow& row, Picture& picture) {
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

  struct Shared {
    std::size_t pixel, first, end;  // with its fragments
  };
  // The pixel around whose centre shows the fragment's surface, the nearest to its cells; none: the picture has no such
  // pixel nearby.
  std::optional<std::size_t> LikeOf(std::size_t fragment) const {
    constexpr int kReach = 4;
    const GuideSet& guides = *frame_.guides;
    const auto width = static_cast<std::size_t>(guides.width());
    const int x = int(fragments_->pixel[fragment] % width), y = int(fragments_->pixel[fragment] / width);
    const std::uint16_t cells = fragments_->cells.empty() ? Fragments::kAllCells : fragments_->cells[fragment];
    glm::vec2 middle(0.0f);
    for (int cell = 0; cell < 16; ++cell) {
      if (cells >> cell & 1)
        middle += glm::vec2(cell % 4 - 1.5f, cell / 4 - 1.5f) / (4.0f * float(std::popcount(cells)));
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
  const FragmentColors* ColorsOf(const Shared& shared, const Texel& texel) const {
    const FragmentColors* const colors = frame_.colors;
    if (!colors || shared.first == shared.end || colors->own.size() != fragments_->count()) return nullptr;
    const Texel& mixed = colors->mixed[shared.first];
    return std::equal(mixed.begin(), mixed.begin() + 3, texel.begin()) ? colors
                                                                       : nullptr;  // else something has changed it
  }

  void AddParts(const Shared& shared, const Texel& given, Batch& batch) const {
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

  bool IsBeforeAnother(const EdgeStroke& stroke) const {
    const GuideSet& guides = *frame_.guides;
    if (!(guides.Plane(Layer::kCoverage)[stroke.pixel] > 0.0f) || !guides.Has(Layer::kObject)) return false;
    return guides.Plane(Layer::kObject)[stroke.pixel] != guides.Plane(Layer::kObject)[stroke.owner];
  }
  // Whether a step puts something else in the place of the paint there, whatever it was.
  bool IsReplaced(std::size_t pixel) const {
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
  void AddStroke(const EdgeStroke& stroke, const Shared& shared, const Texel& given, Batch& batch) const {
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

  std::span<const PointStep> steps_;
  const FinishFrame& frame_;
  const Fragments* fragments_ = nullptr;
  std::span<const EdgeStroke> strokes_ = {};
};

// The pixels beside hard contours of the light that steps look at. In the share that lies beyond, the steps see the
// guides of the pixel on that side.
class ContourPixels {
 public:
  ContourPixels(std::span<const PointStep> steps, const FinishFrame& frame) : steps_(steps) {
    for (const PointStep& one : steps) {
      for (const HardLight& light : one.lights) {
        if (!IsOfGuides(*one.step)) contours_.push_back({one, LightContour(light, *frame.guides)});
      }
    }
  }

  bool any() const { return !contours_.empty(); }

  // The row has been painted without them.
  void PaintRow(const GivenRow& row, Picture& picture) const {
    std::array<Batch, 2> batches;  // mixed in one after the other
    std::vector<std::uint8_t> is_known(contours_.size() > 1 ? row.width() : 0);
    for (const Contour& contour : contours_) {
      contour.light.ForEachInRow(row.y, [&](int x, std::uint32_t sides) {
        const std::size_t pixel = row.first + std::size_t(x);
        if (!MayChange(*contour.step.step, pixel) || row.Of(pixel)[3] == 0) return;
        if (!is_known.empty() && is_known[std::size_t(x)] != 0) return;
        const auto both = contour.light.BeyondOf(x, row.y, sides);
        for (std::size_t k = 0; k < 2 && both[k].share >= kLeastShare; ++k) {
          if (!is_known.empty()) is_known[std::size_t(x)] = 1;
          batches[k].parts.push_back({pixel, both[k].pixel, both[k].share, row.Of(pixel)[3]});
          batches[k].paint.push_back(row.Of(pixel));
        }
      });
    }
    for (const Batch& batch : batches) Put(batch, PaintParts(steps_, batch), picture);
  }

 private:
  static constexpr float kLeastShare = 1.0f / 32.0f;  // less does not show
  struct Contour {
    const PointStep& step;
    LightContour light;
  };

  static void Put(const Batch& batch, std::span<const Texel> made, Picture& picture) {
    std::vector<std::uint16_t> own, beyond;
    std::vector<float> shares;
    for (std::size_t i = 0; i < made.size(); ++i) {
      const auto texel = picture.rgba.begin() + 4 * std::ptrdiff_t(batch.parts[i].pixel);
      own.insert(own.end(), texel, texel + 3);
      beyond.insert(beyond.end(), made[i].begin(), made[i].begin() + 3);
      shares.insert(shares.end(), 3, batch.parts[i].share);
    }
    MixCodes(shares.data(), beyond.data(), own.size(), own.data());
    for (std::size_t i = 0; i < made.size(); ++i)
      std::copy_n(own.data() + 3 * i, 3, picture.rgba.data() + 4 * batch.parts[i].pixel);
  }

  static bool MayChange(const FinishStep& step, std::size_t pixel) {
    return (step.only.empty() || step.only[pixel] != 0) && (step.share.empty() || step.share[pixel] != 0);
  }

  std::span<const PointStep> steps_;
  std::vector<Contour> contours_;
};

}  // namespace

bool IsOfGuides(const FinishStep& step) { return step.pass.at == FinishPass::Stage::kGuides; }

bool PaintPoints(std::span<const PointStep> steps, const FinishFrame& frame, RowProgress& progress, Picture& picture) {
  const SharedPixels shared(steps, frame);
  const ContourPixels contours(steps, frame);
  return ForEachRow({0, 0, picture.width, picture.height}, progress, [&](int y) {
    const auto width = static_cast<std::size_t>(picture.width), begin = std::size_t(y) * width;
    GivenRow row{y, begin, {}};
    if (contours.any() || shared.any()) row.texels.assign(picture.At(0, y), picture.At(0, y) + 4 * width);
    for (std::size_t x = 0; x < width; x += kOklabBlock) {
      std::uint16_t* const texels = picture.At(static_cast<int>(x), y);
      PaintBlock(steps, {begin + x, std::min(kOklabBlock, width - x), texels}, texels);
    }
    if (contours.any()) contours.PaintRow(row, picture);
    if (shared.any()) shared.PaintRow(row, picture);
  });
}

}  // namespace scumble::internal
