#include "finish/outline/outline.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/image/oklab.h"
#include "finish/area/even_light.h"
#include "finish/area/ink.h"
#include "finish/area/noise.h"
#include "finish/outline/border_map.h"
#include "finish/outline/line_chains.h"
#include "finish/outline/strokes.h"

namespace scumble::internal {
namespace {

// Lines of fewer borders with a free end are noise of the guides, at the reference height.
constexpr double kShortest = 4.0;

// Ink from the paint beside a line: a third as light and half as colourful, of its own or of the opposite hue. `texel`
// keeps its alpha.
void InkFromPaint(bool is_complement, std::uint16_t* texel) {
  glm::vec3 lab = OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
  const float chroma = is_complement ? -0.5f : 0.5f;
  lab = {lab.x / 3.0f, lab.y * chroma, lab.z * chroma};
  const glm::vec3 linear = LinearFromOklab(lab);
  for (int c = 0; c < 3; ++c) texel[c] = Srgb16FromLinear(linear[c]);
}

// Shadows and base colours leave crumbs: lines by themselves that reach less far than this many of their widths.
constexpr float kCrumb = 3.0f;

// `scale`: pixels of the guides for one of the reference height.
bool IsCrumb(const OutlinePass& pass, float scale, const LineChain& chain) {
  const auto goes_on = [](LineEnd end) { return end == LineEnd::kJunction || end == LineEnd::kPictureEdge; };
  if (!chain.closed && (goes_on(chain.begin) || goes_on(chain.end))) return false;
  glm::vec2 least = chain.points.front().at, most = least;
  double share = 0.0;
  for (const LinePoint& point : chain.points) {
    if (point.line != LineClass::kShadow && point.line != LineClass::kTexture) return false;
    least = glm::min(least, point.at), most = glm::max(most, point.at);
    share = std::max(share, pass.of_class[std::size_t(point.line)]);
  }
  const glm::vec2 reach = most - least;
  return std::max(reach.x, reach.y) < kCrumb * static_cast<float>(pass.width * share) * scale;
}

// The lines to draw. `frame`: with the guides of the borders, which are `factor` times smaller than the picture. With a
// mask each piece of a line between two objects has the owner that it has by itself: if all were of one, the mask of
// the other would lose the line.
std::vector<LineChain> LinesOf(const OutlinePass& pass, const FinishFrame& frame, int factor,
                               std::span<const float> shadow, BorderMap& borders, bool has_mask) {
  // Of small guides a step of a border is several pixels of the picture: it is evened out.
  const double shortest = std::max(kShortest, kShortest * frame.scale / factor);
  std::vector<LineChain> lines =
      TraceLines(borders, *frame.guides, shadow, shortest, factor > 1 ? 1.0f : 0.5f, !has_mask);
  std::erase_if(lines,
                [&](const LineChain& line) { return IsCrumb(pass, static_cast<float>(frame.scale / factor), line); });
  return lines;
}

// Pieces of lines whose owner `is_masked` are left out: where they cross others, these show.
template <class IsMasked>
StrokeCover CoverByStrokes(const OutlinePass& pass, const FinishFrame& frame, int factor, const LineNoise& noise,
                           std::vector<LineChain> chains, bool with_owner, const IsMasked& is_masked) {
  for (LineChain& chain : chains) {
    const auto times = static_cast<float>(factor);
    for (LinePoint& point : chain.points) point.at *= times;
    chain.first *= times, chain.last *= times;
  }
  std::vector<std::vector<StrokePiece>> strokes(chains.size());
  tbb::parallel_for(std::size_t(0), chains.size(),
                    [&](std::size_t i) { strokes[i] = StrokeOf(pass, frame, noise, std::move(chains[i])); });
  std::vector<StrokePiece> pieces;
  for (const auto& stroke : strokes) {
    std::copy_if(stroke.begin(), stroke.end(), std::back_inserter(pieces),
                 [&](const StrokePiece& piece) { return !is_masked(piece.owner); });
  }
  return CoverOf(pieces, frame.guides->width() * factor, frame.guides->height() * factor, with_owner);
}

// Leaves the borders of lines, as CoverByDistance takes them. A field has one line for each pixel, so that one whose
// owner `is_masked` must not stand before another.
template <class IsMasked>
void KeepLines(const std::vector<LineChain>& lines, const IsMasked& is_masked, BorderMap& borders) {
  std::ranges::fill(borders.right, std::uint8_t{0}), std::ranges::fill(borders.below, std::uint8_t{0});
  for (const LineChain& line : lines) {
    for (const LinePoint& point : line.points) {
      if (is_masked(point.owner)) continue;
      const std::size_t other = OtherSide(point, borders.width), first = std::min<std::size_t>(point.owner, other);
      const int owner = point.owner > other ? kSecondOwns : 0;
      (point.to_owner.x != 0.0f ? borders.right : borders.below)[first] =
          static_cast<std::uint8_t>(1 + int(point.line) + owner);
    }
  }
}

// The pixel in the middle of a block of factor × factor, which a pixel of a smaller picture stands for.
class BlockMiddle {
 public:
  BlockMiddle(int small_width, int factor) : width_(std::size_t(small_width)), factor_(std::size_t(factor)) {}
  std::size_t operator()(std::size_t small) const {
    const std::size_t x = small % width_, y = small / width_;
    return (y * factor_ + factor_ / 2) * (width_ * factor_) + x * factor_ + factor_ / 2;
  }

 private:
  std::size_t width_, factor_;
};

// The pixel whose paint a line has. Beside another object the owner's paint is a mix of both: there it is the next
// pixel within the owner's object, if there is one.
class PaintOfOwner {
 public:
  explicit PaintOfOwner(const GuideSet& guides)
      : coverage_(guides.Plane(Layer::kCoverage)),
        object_(guides.Plane(Layer::kObject)),
        width_(std::ptrdiff_t(guides.width())) {}

  std::size_t operator()(std::size_t owner) const {
    if (IsWithin(owner, object_[owner])) return owner;
    for (const std::ptrdiff_t step : {width_, -width_, std::ptrdiff_t(1), std::ptrdiff_t(-1)}) {
      const std::size_t next = Next(owner, step);
      if (coverage_[next] > 0.0f && object_[next] == object_[owner] && IsWithin(next, object_[owner])) return next;
    }
    return owner;
  }

 private:
  // The pixel itself where the picture ends.
  std::size_t Next(std::size_t pixel, std::ptrdiff_t step) const {
    const auto at = std::ptrdiff_t(pixel), next = at + step;
    const bool is_in_row = (step != 1 && step != -1) || next / width_ == at / width_;
    return next >= 0 && next < std::ptrdiff_t(object_.size()) && is_in_row ? std::size_t(next) : pixel;
  }
  // Whether no other object is beside it.
  bool IsWithin(std::size_t pixel, float object) const {
    for (const std::ptrdiff_t step : {width_, -width_, std::ptrdiff_t(1), std::ptrdiff_t(-1)}) {
      const std::size_t next = Next(pixel, step);
      if (coverage_[next] > 0.0f && object_[next] != object) return false;
    }
    return true;
  }

  std::span<const float> coverage_, object_;
  std::ptrdiff_t width_;
};

}  // namespace

void DrawOutline(const OutlinePass& pass, double strength, std::span<const std::uint8_t> only,
                 std::span<const std::uint16_t> shares, const FinishFrame& frame, Picture& picture) {
  const bool is_field = pass.form == OutlinePass::Form::kField, strays = pass.wobble > 0.0 && !is_field;
  FinishFrame traced = frame;
  if (frame.small_guides && !is_field) traced.guides = frame.small_guides;
  const GuideSet& guides = *traced.guides;
  const int width = guides.width(), height = guides.height(), factor = picture.width / width;
  const double scale = frame.scale / factor;  // pixels of those guides for one of the reference height
  const BlockMiddle middle(width, factor);
  std::vector<std::uint8_t> small_only;
  if (factor > 1 && !only.empty()) {
    small_only.resize(guides.pixel_count());
    for (std::size_t i = 0; i < small_only.size(); ++i) small_only[i] = only[middle(i)];
    only = small_only;
  }
  FloatPlane shadow;
  if (pass.of_class[std::size_t(LineClass::kShadow)] > 0.0 && !HasExactLight(guides)) {
    shadow = EvenedLight(guides.Plane(Layer::kShadow), LitSurfaceOf(guides), width, height, LightNoiseOf(guides),
                         is_field ? frame.Apart() : 1);
  }
  std::span<const float> shade = shadow;
  if (shade.empty() && guides.Has(Layer::kShadow)) shade = guides.Plane(Layer::kShadow);
  BorderMap borders = FindBorders(pass, guides, scale, only, shade);
  std::optional<SurfaceScale> surface;
  std::optional<NoiseField> across, down, gaps;
  if (pass.stick && (strays || pass.gaps > 0.0)) surface.emplace(guides);
  if (pass.stick && strays) {
    const double wave = pass.wobble_length * scale;
    across.emplace(Hash(frame.seed, 1), wave, &*surface, width, height);
    down.emplace(Hash(frame.seed, 2), wave, &*surface, width, height);
  }
  if (pass.gaps > 0.0) {
    gaps.emplace(Hash(frame.seed, 3), pass.gap_length * scale, surface ? &*surface : nullptr, width, height);
  }
  const LineNoise noise{across ? &*across : nullptr, down ? &*down : nullptr, gaps ? &*gaps : nullptr};
  const bool of_paint = pass.color != OutlinePass::Color::kInk, with_owner = of_paint || !shares.empty();
  const auto is_masked = [&](std::uint32_t owner) { return !shares.empty() && shares[middle(owner)] == 0; };
  std::vector<LineChain> lines = LinesOf(pass, traced, factor, shade, borders, !shares.empty());
  if (is_field) KeepLines(lines, is_masked, borders);
  const StrokeCover cover = is_field
                                ? CoverByDistance(pass, traced, noise.gaps, borders, with_owner)
                                : CoverByStrokes(pass, traced, factor, noise, std::move(lines), with_owner, is_masked);
  const PaintOfOwner painted(guides);
  std::vector<std::uint16_t> paint;  // as it was before the lines
  if (of_paint) paint = picture.rgba;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cover.share.size(), 1 << 14), [&](const auto& part) {
    std::uint32_t last_owner = 0;
    bool has_last = false;
    std::uint16_t last_ink[4] = {};
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      if (!(cover.share[i] > 0.0f)) continue;
      std::uint16_t texel[4] = {pass.ink[0], pass.ink[1], pass.ink[2], 65535};
      if (of_paint) {
        const std::uint32_t owner = cover.owner[i];
        if (!has_last || owner != last_owner) {
          std::copy_n(paint.data() + 4 * middle(painted(owner)), 4, last_ink);
          InkFromPaint(pass.color == OutlinePass::Color::kComplement, last_ink);
          last_owner = owner, has_last = true;
        }
        std::copy_n(last_ink, 3, texel);
      }
      const float share = shares.empty() ? 1.0f : static_cast<float>(shares[middle(cover.owner[i])]) / 65535.0f;
      texel[3] = static_cast<std::uint16_t>(cover.share[i] * static_cast<float>(strength) * share * 65535.0f + 0.5f);
      if (texel[3] == 0) continue;
      std::uint16_t* const pixel = picture.rgba.data() + 4 * i;
      LayInk(texel, pixel);
    }
  });
}

}  // namespace scumble::internal
