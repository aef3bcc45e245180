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
  return {Premultiplied(texel, 0), Premultiplied(texel, 1), Premultiplied(texel, 2), texel[3]};
}

Color TexelAt(const Picture& picture, Source at) { return ColorOf(picture.At(at.x, at.y)); }

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
  Color sum{};
  std::int64_t total = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    const std::int64_t weight = std::int64_t(dx ? right : kOne - right) * (dy ? below : kOne - below);
    if (weight == 0 || !exemplar.Usable(x + dx, y + dy)) continue;
    const Color texel = TexelAt(tone, {x + dx, y + dy});
    for (int c = 0; c < 4; ++c) sum[c] += weight * texel[c];
    total += weight;
  }
  if (total == 0) return TexelAt(tone, exemplar.NearestNeighbour(normal));
  for (std::int64_t& value : sum) value = (value + total / 2) / total;
  return sum;
}

void Store(const Color& color, std::uint16_t* out) {
  const std::int64_t alpha = std::clamp<std::int64_t>(color[3], 0, 65535);
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
