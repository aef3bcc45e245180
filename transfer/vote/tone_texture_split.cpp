#include "transfer/vote/tone_texture_split.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/filter/masked_blur.h"

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

using Color = std::array<std::int64_t, 4>;  // premultiplied, of 65535

Color ColorOf(const std::uint16_t* texel) {
  if (texel[3] == 65535) return {texel[0], texel[1], texel[2], 65535};
  return {Premultiplied(texel, 0), Premultiplied(texel, 1), Premultiplied(texel, 2), texel[3]};
}

Color TexelAt(const Picture& picture, Source at) { return ColorOf(picture.At(at.x, at.y)); }

// The mean of 2 × 2 opaque usable texels from (x, y) on, `right` and `below` of 256 between them. False: one is not.
// What MeanOfCorners does with sums of 64 bits and divisions, in a tenth of the time.
bool MeanOfOpaqueCorners(const PreparedExemplar& exemplar, const Picture& tone, int x, int y, std::uint32_t right,
                         std::uint32_t below, Color& mean) {
  if (!exemplar.Usable(x, y) || !exemplar.Usable(x + 1, y)) return false;
  if (!exemplar.Usable(x, y + 1) || !exemplar.Usable(x + 1, y + 1)) return false;
  const std::uint16_t* const upper = tone.At(x, y);
  const std::uint16_t* const lower = tone.At(x, y + 1);
  if ((upper[3] & upper[7] & lower[3] & lower[7]) != 65535) return false;
  const std::uint32_t weights[4] = {(256 - right) * (256 - below), right * (256 - below), (256 - right) * below,
                                    right * below};
  for (std::size_t c = 0; c < 3; ++c) {
    // At most 65536 · 65535 + 32768, which 32 bits hold.
    mean[c] = (weights[0] * upper[c] + weights[1] * upper[c + 4] + weights[2] * lower[c] + weights[3] * lower[c + 4] +
               32768u) >>
              16;
  }
  mean[3] = 65535;
  return true;
}

// The same of those that are usable. False: none is.
bool MeanOfCorners(const PreparedExemplar& exemplar, const Picture& tone, int x, int y, int right, int below,
                   Color& mean) {
  mean = {};
  std::int64_t total = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    const std::int64_t weight = std::int64_t(dx ? right : 256 - right) * (dy ? below : 256 - below);
    if (weight == 0 || !exemplar.Usable(x + dx, y + dy)) continue;
    const Color texel = TexelAt(tone, {x + dx, y + dy});
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
  constexpr int kOne = 256;
  const glm::vec2 place = exemplar.OnDisc(normal);
  const float half = 0.5f * static_cast<float>(exemplar.size());
  const int u = static_cast<int>(std::floor((place.x * half + half - 0.5f) * kOne + 0.5f));
  const int v = static_cast<int>(std::floor((half - place.y * half - 0.5f) * kOne + 0.5f));
  const int x = u >> 8, y = v >> 8, right = u & (kOne - 1), below = v & (kOne - 1);
  Color mean;
  if (MeanOfOpaqueCorners(exemplar, tone, x, y, static_cast<std::uint32_t>(right), static_cast<std::uint32_t>(below),
                          mean) ||
      MeanOfCorners(exemplar, tone, x, y, right, below, mean))
    return mean;
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

bool VoteHybrid(const HybridInput& input, Picture& out, RowProgress& progress) {
  const VoteInput& paint = input.votes;
  const Region& region = paint.region;
  Picture base_votes(out.width, out.height);
  const VoteInput base{paint.field, paint.active, input.base, paint.radius, paint.edges, region};
  if (!Vote(base, base_votes, progress)) return false;
  const HybridLayers layers{paint.exemplar, input.base, input.illumination, input.space};
  VoteInput both = paint;
  both.finished = [&](int y, int x0, int x1) {
    for (int x = x0; x < x1; ++x) {
      const std::size_t p = paint.field.Index(x, y);
      if (!paint.active[p]) continue;
      float extra_values[GuideSpace::kMaxExtra];
      if (input.space) input.space->Read(input.guides, p, input.brightness, extra_values);
      const float light = input.luminance.empty() ? 0.0f : input.luminance[p];
      AddBaseLayer(layers, {input.guides.Vec3(Layer::kNormal, p), light, extra_values}, base_votes.At(x, y),
                   out.At(x, y));
    }
    if (paint.finished) paint.finished(y, x0, x1);
  };
  return Vote(both, out, progress);
}

}  // namespace scumble::internal
