#include "transfer/vote/tone_texture_split.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/filter/masked_blur.h"
#include "core/image/color.h"
#include "core/image/fragments.h"

namespace scumble {

PreparedExemplar MakeBaseLayers(const PreparedExemplar& exemplar, double sigma) {
  std::vector<std::uint8_t> usable(std::size_t(exemplar.width()) * exemplar.height());
  for (const Source& at : exemplar.UsablePixels()) usable[std::size_t(at.y) * exemplar.width() + at.x] = 1;
  std::vector<Picture> base_layers;
  for (int k = 0; k < exemplar.count(); ++k) {
    Picture base = internal::MaskedBlur(exemplar.picture(k), usable, sigma);
    for (std::size_t i = 0; i < base.rgba.size(); i += 4) {
      const std::uint32_t alpha = base.rgba[i + 3];
      for (std::size_t c = i; c < i + 3 && alpha > 0; ++c) {
        base.rgba[c] = static_cast<std::uint16_t>(std::min(65535u, (base.rgba[c] * 65535u + alpha / 2) / alpha));
      }
    }
    base_layers.push_back(std::move(base));
  }
  return exemplar.WithPictures(std::move(base_layers));
}

}  // namespace scumble

namespace scumble::internal {
namespace {

constexpr float kLeastShare = 1.0f / 32.0f;  // of a pixel; less does not show

using Color = std::array<std::int64_t, 4>;  // premultiplied, of 65535

Color ColorOf(const std::uint16_t* texel) {
  if (texel[3] == 65535) return {texel[0], texel[1], texel[2], 65535};
  return {Premultiplied(texel, 0), Premultiplied(texel, 1), Premultiplied(texel, 2), texel[3]};
}

Color TexelAt(const Picture& picture, Source at) { return ColorOf(picture.At(at.x, at.y)); }

// The texel left above a place of the unit disc, in 1/256 of a texel.
struct TexelPlace {
  int x, y;                    // whole texels
  std::uint32_t right, below;  // 0 … 255
};

TexelPlace PlaceOf(glm::vec2 place, float half) {
  const auto floor_of = [](float value) {
    const int whole = static_cast<int>(value);
    return whole - (static_cast<float>(whole) > value ? 1 : 0);
  };
  const int u = floor_of((place.x * half + half - 0.5f) * 256 + 0.5f);
  const int v = floor_of((half - place.y * half - 0.5f) * 256 + 0.5f);
  return {u >> 8, v >> 8, static_cast<std::uint32_t>(u & 255), static_cast<std::uint32_t>(v & 255)};
}

// The mean of the usable ones of 2 × 2 texels there. False: none is.
bool MeanOfCorners(const PreparedExemplar& exemplar, const Picture& tone, const TexelPlace& place, Color& mean) {
  mean = {};
  std::int64_t total = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    const std::int64_t weight =
        std::int64_t(dx ? place.right : 256 - place.right) * (dy ? place.below : 256 - place.below);
    if (weight == 0 || !exemplar.Usable(place.x + dx, place.y + dy)) continue;
    const Color texel = TexelAt(tone, {place.x + dx, place.y + dy});
    for (std::size_t c = 0; c < 4; ++c) mean[c] += weight * texel[c];
    total += weight;
  }
  if (total == 0) return false;
  for (std::int64_t& value : mean) value = (value + total / 2) / total;
  return true;
}

// The base layer for a normal, interpolated. Otherwise neighbours across a texel's border would differ by a whole step,
// which a small exemplar on a large round form shows as bands.
Color ToneFor(const PreparedExemplar& exemplar, const Picture& tone, glm::vec3 normal) {
  if (!exemplar.is_sphere()) return TexelAt(tone, exemplar.NearestNeighbour(normal));
  const TexelPlace place = PlaceOf(exemplar.OnDisc(normal), 0.5f * static_cast<float>(exemplar.size()));
  Color mean;
  if (MeanOfCorners(exemplar, tone, place, mean)) return mean;
  return TexelAt(tone, exemplar.NearestNeighbour(normal));
}

void Store(const Color& color, std::uint16_t* out) {
  const std::int64_t alpha = std::clamp<std::int64_t>(color[3], 0, 65535);
  if (alpha == 65535) {
    for (std::size_t c = 0; c < 3; ++c)
      out[c] = static_cast<std::uint16_t>(std::clamp<std::int64_t>(color[c], 0, alpha));
    out[3] = 65535;
    return;
  }
  for (int c = 0; c < 3; ++c) {
    const std::int64_t value = std::clamp<std::int64_t>(color[c], 0, alpha);
    out[c] = alpha > 0 ? static_cast<std::uint16_t>((value * 65535 + alpha / 2) / alpha) : 0;
  }
  out[3] = static_cast<std::uint16_t>(alpha);
}

// That share of another colour, straight alpha, in linear light.
void Mix(const std::uint16_t* other, float share, std::uint16_t* texel) {
  if (std::equal(other, other + 4, texel)) return;
  const float own_alpha = (1.0f - share) * texel[3], other_alpha = share * other[3], alpha = own_alpha + other_alpha;
  for (int c = 0; c < 3 && alpha > 0.0f; ++c) {
    const float sum = own_alpha * Srgb16ToLinear(texel[c]) + other_alpha * Srgb16ToLinear(other[c]);
    texel[c] = Srgb16FromLinear(std::min(1.0f, sum / alpha));
  }
  texel[3] = static_cast<std::uint16_t>(alpha + 0.5f);
}

}  // namespace

void AddBaseLayer(const HybridLayers& layers, const HybridGuide& guide, const std::uint16_t* base_vote,
                  std::uint16_t* texel) {
  const int own = layers.illumination.Choose(guide.light);
  const Picture& tone = layers.base.picture(own);
  Color color = layers.space ? TexelAt(tone, layers.space->Nearest(own, guide.normal, guide.extra_values))
                             : ToneFor(layers.paint, tone, guide.normal);
  const Color paint_color = ColorOf(texel), base_color = ColorOf(base_vote);
  for (std::size_t c = 0; c < 4; ++c) color[c] += paint_color[c] - base_color[c];
  Store(color, texel);
}

// AddBaseLayer for a sphere without a space, where all that it reads is opaque: the same numbers in 32 bits and without
// a division. False, and nothing is done: something is not opaque or not usable.
inline bool HybridTone::AddOpaque(glm::vec3 normal, int own, const std::uint16_t* base_vote,
                                  std::uint16_t* texel) const {
  const TexelPlace at = PlaceOf(layers_.paint.OnDisc(normal), half_);
  if (at.y < 0 || at.y + 1 >= rows_.height) return false;
  if (at.x < std::max(rows_.first[at.y], rows_.first[at.y + 1])) return false;
  if (at.x + 1 > std::min(rows_.last[at.y], rows_.last[at.y + 1])) return false;
  const std::uint16_t* const upper = layers_.base.picture(own).At(at.x, at.y);
  const std::uint16_t* const lower = upper + 4 * std::size_t(rows_.width);
  if ((upper[3] & upper[7] & lower[3] & lower[7] & base_vote[3] & texel[3]) != 65535) return false;
  const std::uint32_t weights[4] = {(256 - at.right) * (256 - at.below), at.right * (256 - at.below),
                                    (256 - at.right) * at.below, at.right * at.below};
  for (std::size_t c = 0; c < 3; ++c) {
    // At most 65536 · 65535 + 32768, which 32 bits hold.
    const std::uint32_t tone = (weights[0] * upper[c] + weights[1] * upper[c + 4] + weights[2] * lower[c] +
                                weights[3] * lower[c + 4] + 32768u) >>
                               16;
    const int value = static_cast<int>(tone) + texel[c] - base_vote[c];
    texel[c] = static_cast<std::uint16_t>(std::clamp(value, 0, 65535));
  }
  return true;
}

HybridTone::HybridTone(const HybridLayers& layers, const HybridFrame& frame)
    : layers_(layers),
      frame_(frame),
      rows_(layers.paint.Rows()),
      half_(0.5f * static_cast<float>(layers.paint.size())),
      may_be_quick_(layers.paint.is_sphere() && !layers.space),
      has_several_(layers.paint.count() > 1) {
  for (int c = 0; c < 3; ++c) normals_[c] = frame.guides.Plane(Layer::kNormal, c);
  const std::span<const float> borders = layers.illumination.borders();
  if (!frame.luminance.empty() && !borders.empty())
    borders_.emplace(HardLight{frame.luminance, 0.0f, 0, 1.0f, borders}, frame.guides);
}

// AddBaseLayer of that pixel, with the exemplar that suits the light.
inline void HybridTone::Add(std::size_t pixel, float light, const std::uint16_t* base_vote,
                            std::uint16_t* texel) const {
  const glm::vec3 normal(normals_[0][pixel], normals_[1][pixel], normals_[2][pixel]);
  const int own = has_several_ ? layers_.illumination.Choose(light) : 0;
  if (may_be_quick_ && AddOpaque(normal, own, base_vote, texel)) return;
  float extra_values[GuideSpace::kMaxExtra];
  if (layers_.space) layers_.space->Read(frame_.guides, pixel, frame_.brightness, extra_values);
  AddBaseLayer(layers_, {normal, light, extra_values}, base_vote, texel);
}

// Before their votes are overwritten.
std::vector<HybridTone::BorderPixel> HybridTone::BesideBorders(const std::uint8_t* active, int y, int x0, int x1,
                                                               const Picture& out) const {
  std::vector<BorderPixel> beside;
  if (!borders_) return beside;
  const Fragments* const fragments = frame_.guides.fragments.get();
  const std::size_t first = std::size_t(y) * std::size_t(out.width);
  borders_->ForEachInRow(y, x0, x1, [&](int x, std::uint32_t sides) {
    if (!active[x]) return;
    const std::size_t i = first + std::size_t(x);
    if (fragments && std::ranges::binary_search(fragments->pixel, static_cast<std::uint32_t>(i))) return;
    for (const LightContour::Beyond& beyond : borders_->BeyondOf(x, y, sides)) {
      if (beyond.share < kLeastShare) return;
      BorderPixel& one = beside.emplace_back(BorderPixel{x, {}, beyond});
      std::copy_n(out.At(x, y), 4, one.vote.begin());
    }
  });
  return beside;
}

void HybridTone::AddToRow(const std::uint8_t* active, int y, int x0, int x1, const Picture& base_votes,
                          Picture& out) const {
  const std::size_t first = std::size_t(y) * std::size_t(out.width);
  std::vector<BorderPixel> beside = BesideBorders(active, y, x0, x1, out);
  for (int x = x0; x < x1; ++x) {
    if (!active[x]) continue;
    const std::size_t i = first + std::size_t(x);
    Add(i, LightOf(i), base_votes.At(x, y), out.At(x, y));
  }
  for (BorderPixel& one : beside) {
    Add(first + std::size_t(one.x), LightOf(one.beyond.pixel), base_votes.At(one.x, y), one.vote.data());
    Mix(one.vote.data(), one.beyond.share, out.At(one.x, y));
  }
}

bool VoteHybrid(const HybridInput& input, Picture& base_votes, Picture& out, RowProgress& progress) {
  const VoteInput& paint = input.votes;
  if (base_votes.width != out.width || base_votes.height != out.height) base_votes = Picture(out.width, out.height);
  const VoteInput base{paint.field, paint.active, input.base, paint.radius, paint.edges, paint.region};
  if (!Vote(base, base_votes, progress)) return false;
  const HybridTone tone({paint.exemplar, input.base, input.illumination, input.space},
                        {input.guides, input.luminance, input.brightness});
  VoteInput both = paint;
  both.finished = [&](int y, int x0, int x1) {
    tone.AddToRow(paint.active.data() + paint.field.Index(0, y), y, x0, x1, base_votes, out);
    if (paint.finished) paint.finished(y, x0, x1);
  };
  return Vote(both, out, progress);
}

}  // namespace scumble::internal
