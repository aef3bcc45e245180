#include "transfer/frame/fragment_paint.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <iterator>

#include "core/image/check.h"
#include "core/image/color.h"
#include "transfer/vote/tone_texture_split.h"
#include "transfer/vote/vote_sum.h"

namespace scumble::internal {
namespace {

constexpr PixelPosition kAround[] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};
constexpr std::size_t kPixelsAround = std::size(kAround);

// The squared distance from the centre of a cell to that of a pixel around, in eighths of a pixel.
constexpr int Distance(int cell, const PixelPosition& step) {
  const int dx = 8 * step.x - (2 * (cell % 4) - 3), dy = 8 * step.y - (2 * (cell / 4) - 3);
  return dx * dx + dy * dy;
}

// How many of the cells each pixel is the nearest to, of those whose bit in `around` is set.
std::array<int, kPixelsAround> CountNearest(std::uint16_t cells, unsigned around) {
  std::array<int, kPixelsAround> count = {};
  if (around == 0) return count;
  for (int cell = 0; cell < 16; ++cell) {
    if (!(cells >> cell & 1)) continue;
    std::size_t nearest = kPixelsAround;
    for (std::size_t k = 0; k < kPixelsAround; ++k) {
      if (!(around >> k & 1)) continue;
      if (nearest == kPixelsAround || Distance(cell, kAround[k]) < Distance(cell, kAround[nearest])) nearest = k;
    }
    ++count[nearest];
  }
  return count;
}

// The mean colour of cells in linear light, as pictures are composited. Otherwise as VoteSum.
struct CellSum {
  float color[3] = {0.0f, 0.0f, 0.0f};
  float alpha = 0.0f;
  std::uint32_t cells = 0;

  void Add(const std::uint16_t* texel, std::uint32_t count) {
    const float weight = static_cast<float>(count) * texel[3];
    for (int c = 0; c < 3; ++c) color[c] += weight * Srgb16ToLinear(texel[c]);
    alpha += weight;
    cells += count;
  }
  void Count(std::uint16_t* out) const {
    for (int c = 0; c < 3; ++c) out[c] = alpha > 0.0f ? Srgb16FromLinear(std::min(1.0f, color[c] / alpha)) : 0;
    out[3] = static_cast<std::uint16_t>(alpha / static_cast<float>(cells) + 0.5f);
  }
};

void ReadGuide(const MatchInput& match, const GuideSet& values, std::size_t fragment, PixelGuide& guide) {
  guide.normal = match.exemplar.WithinRim(values.Vec3(Layer::kNormal, fragment));
  guide.light = match.luminance.empty() ? 0.0f : values.Plane(Layer::kLuminance)[fragment] * match.brightness;
  if (match.space) match.space->Read(values, fragment, match.brightness, guide.extra_values);
}

}  // namespace

FragmentPaint::FragmentPaint(const FrameInput& frame) : frame_(frame), fragments_(frame.guides.fragments.get()) {
  if (fragments_ && fragments_->count() == 0) fragments_ = nullptr;
  if (!fragments_) return;
  if (frame.map && !frame.map->fragment_style.empty()) {
    SCUMBLE_CHECK_EQ(frame.map->fragment_style.size(), fragments_->count());
  }
  colors_.resize(fragments_->count());
}

std::uint16_t FragmentPaint::StyleOf(std::size_t fragment) const {
  if (!frame_.map) return 0;
  const auto& styles = frame_.map->fragment_style;
  return styles.empty() ? frame_.map->style[fragments_->pixel[fragment]] : styles[fragment];
}

// Whether pixel q shows the fragment's surface, with a normal within the crease.
bool FragmentPaint::ShowsSurface(std::size_t q, std::size_t fragment, float crease_cosine) const {
  const GuideSet& guides = frame_.guides;
  const GuideSet& own = fragments_->values;
  const auto differs = [&](Layer layer) {
    return guides.Has(layer) && guides.Plane(layer)[q] != own.Plane(layer)[fragment];
  };
  return !differs(Layer::kObject) && !differs(Layer::kMaterial) && IsWithinCrease(q, fragment, crease_cosine);
}

bool FragmentPaint::IsWithinCrease(std::size_t q, std::size_t fragment, float crease_cosine) const {
  const glm::vec3 a = frame_.guides.Vec3(Layer::kNormal, q), b = fragments_->values.Vec3(Layer::kNormal, fragment);
  return a.x * b.x + a.y * b.y + a.z * b.z > crease_cosine;
}

// Calls vote(exemplar, source, count) for the votes on the fragment's colour.
template <class Cast>
void FragmentPaint::ForEachVote(const FragmentStyle& style, const VoteInput& votes, std::size_t fragment, int x, int y,
                                const Cast& vote) const {
  const GuideSet& guides = frame_.guides;
  const SourceField& field = votes.field;
  // The pixel's source goes on at (x, y).
  const auto source_of = [&](int u, int v) {
    const std::size_t q = field.Index(u, v);
    return Source{field.x[q] + x - u, field.y[q] + y - v};
  };
  const auto is_usable = [&](const Source& source) { return style.match.exemplar.Usable(source.x, source.y); };
  const std::uint16_t known = fragments_->cells.empty() ? 0 : fragments_->cells[fragment];
  const std::uint16_t cells = known ? known : Fragments::kAllCells;
  bool any = false;  // vote yet
  const bool window_has_surface = style.edge_aware && votes.radius > 0;
  if (!style.own_sources && !window_has_surface) {
    unsigned around = 0;
    for (std::size_t k = 0; k < kPixelsAround; ++k) {
      const int u = x + kAround[k].x, v = y + kAround[k].y;
      if (u < 0 || v < 0 || u >= guides.width() || v >= guides.height() || !votes.active[field.Index(u, v)]) continue;
      if (ShowsSurface(guides.Index(u, v), fragment, style.crease_cosine)) around |= 1u << k;
    }
    const auto count = CountNearest(cells, around);
    for (std::size_t k = 0; k < kPixelsAround; ++k) {
      const int u = x + kAround[k].x, v = y + kAround[k].y;
      if (count[k] == 0) continue;
      const std::size_t q = field.Index(u, v);
      const Source on = source_of(u, v);
      vote(int(field.exemplar[q]), is_usable(on) ? on : Source{field.x[q], field.y[q]}, std::uint32_t(count[k]));
    }
    any = around != 0;
  }
  const auto weight = window_has_surface ? 1u : std::uint32_t(std::popcount(cells));
  // A window that is not cut may hold other objects alone.
  const bool shows_surface = any || window_has_surface;
  const int radius = votes.radius;
  for (int v = std::max(0, y - radius); v <= std::min(guides.height() - 1, y + radius); ++v) {
    for (int u = std::max(0, x - radius); u <= std::min(guides.width() - 1, x + radius); ++u) {
      if ((u == x && v == y) || !votes.active[field.Index(u, v)]) continue;
      if (std::max(std::abs(u - x), std::abs(v - y)) > VoteReach(field.level[field.Index(u, v)], radius)) continue;
      const std::size_t q = guides.Index(u, v);
      if (style.edge_aware) {
        if (guides.Plane(Layer::kObject)[q] != fragments_->values.Plane(Layer::kObject)[fragment]) continue;
        if (!IsWithinCrease(q, fragment, style.crease_cosine)) continue;
      }
      if (!is_usable(source_of(u, v))) continue;
      vote(int(field.exemplar[field.Index(u, v)]), source_of(u, v), weight);
      any = true;
    }
  }
  if (any && shows_surface) return;
  PixelGuide guide;
  ReadGuide(style.match, fragments_->values, fragment, guide);
  const Candidate own = OwnCandidate(style.match, guide);
  vote(own.exemplar, own.source, weight);
}

template <class Sum>
FragmentPaint::Texel FragmentPaint::Painted(const FragmentStyle& style, const VoteInput& votes, std::size_t fragment,
                                            int x, int y) const {
  const MatchInput& match = style.match;
  Sum paint, base;
  ForEachVote(style, votes, fragment, x, y, [&](int exemplar, Source source, std::uint32_t count) {
    paint.Add(match.exemplar.picture(exemplar).At(source.x, source.y), count);
    if (style.base) base.Add(style.base->picture(exemplar).At(source.x, source.y), count);
  });
  Texel texel;
  paint.Count(texel.data());
  if (style.base) {
    PixelGuide guide;
    ReadGuide(match, fragments_->values, fragment, guide);
    Texel base_vote;
    base.Count(base_vote.data());
    AddBaseLayer({match.exemplar, *style.base, match.illumination, match.space},
                 {guide.normal, guide.light, guide.extra_values}, base_vote.data(), texel.data());
  }
  if (style.tint.active()) style.tint.Apply(fragments_->values.Vec3(Layer::kAlbedo, fragment), texel.data());
  return texel;
}

void FragmentPaint::Paint(const FragmentStyle& style, int number, const VoteInput& votes, int y0, int y1) {
  if (!fragments_) return;
  const Region& region = frame_.region;
  const auto width = static_cast<std::size_t>(frame_.guides.width());
  const std::size_t from = fragments_->From(width * static_cast<std::size_t>(std::max(y0, region.y0)));
  const std::size_t to = fragments_->From(width * static_cast<std::size_t>(std::max(0, std::min(y1, region.y1))));
  for (std::size_t i = from; i < to; ++i) {
    const int x = int(fragments_->pixel[i] % width), y = int(fragments_->pixel[i] / width);
    if (x < region.x0 || x >= region.x1 || StyleOf(i) != number) continue;
    colors_[i] = votes.radius > 0 ? Painted<VoteSum>(style, votes, i, x, y) : Painted<CellSum>(style, votes, i, x, y);
  }
}

void FragmentPaint::MixPixel(std::size_t first, std::size_t end, std::uint16_t* pixel) const {
  const float whole = frame_.guides.Plane(Layer::kCoverage)[fragments_->pixel[first]];
  const auto coverage = fragments_->values.Plane(Layer::kCoverage);
  float left = 1.0f, color[3] = {0.0f, 0.0f, 0.0f}, alpha = 0.0f;
  const auto add = [&](const std::uint16_t* texel, float share) {
    const float weight = share * (static_cast<float>(texel[3]) / 65535.0f);
    for (int c = 0; c < 3; ++c) color[c] += weight * Srgb16ToLinear(texel[c]);
    alpha += weight;
  };
  for (std::size_t i = first; i < end; ++i) {
    const float share = whole > 0.0f ? std::min(left, coverage[i] / whole) : 0.0f;
    left -= share;
    add(colors_[i].data(), share);
  }
  add(pixel, left);
  for (int c = 0; c < 3; ++c) pixel[c] = alpha > 0.0f ? Srgb16FromLinear(std::min(1.0f, color[c] / alpha)) : 0;
  pixel[3] = static_cast<std::uint16_t>(std::min(65535.0f, alpha * 65535.0f + 0.5f));
}

// Calls visit(fragment, x, y) for the fragments of the region, in any order.
template <class Visit>
void FragmentPaint::ForAll(const Visit& visit) const {
  if (!fragments_) return;
  const Region& region = frame_.region;
  const auto width = static_cast<std::size_t>(frame_.guides.width());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, fragments_->count(), 1024), [&](const auto& some) {
    for (std::size_t i = some.begin(); i != some.end(); ++i) {
      const int x = int(fragments_->pixel[i] % width), y = int(fragments_->pixel[i] / width);
      if (x >= region.x0 && x < region.x1 && y >= region.y0 && y < region.y1) visit(i, x, y);
    }
  });
}

void FragmentPaint::PaintShadows(const std::function<void(int x, int y, std::uint16_t* texel)>& paint) {
  ForAll([&](std::size_t i, int x, int y) {
    if (StyleOf(i) == StyleMap::kShadowCatcher) paint(x, y, colors_[i].data());
  });
}

void FragmentPaint::Mix(Picture& out, FragmentColors* kept) const {
  if (kept) *kept = {colors_, std::vector<Texel>(colors_.size()), std::vector<Texel>(colors_.size())};
  ForAll([&](std::size_t i, int x, int y) {
    const std::vector<std::uint32_t>& pixels = fragments_->pixel;
    if (i > 0 && pixels[i - 1] == pixels[i]) return;
    std::size_t end = i + 1;
    while (end < pixels.size() && pixels[end] == pixels[i]) ++end;
    std::uint16_t* const pixel = out.At(x, y);
    if (kept) std::copy_n(pixel, 4, kept->centre[i].begin());
    MixPixel(i, end, pixel);
    if (kept) std::copy_n(pixel, 4, kept->mixed[i].begin());
  });
}

}  // namespace scumble::internal
