#include "transfer/shadow/shadow_paint.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/image/color.h"
#include "core/image/exact_math.h"
#include "core/image/hash.h"
#include "core/painting/bare_paper.h"

namespace scumble {
namespace {

// Places within this of a strength are as good as the nearest, and the choice has at least this many.
constexpr float kSameTone = 0.03f;
constexpr std::size_t kLeastChoice = 12;
constexpr int kSquares = 16;  // a side of the picture that is divided by chance
constexpr float kByRank =
    0.6f;  // the part of the opacity that depends on a texel's own rank; the other part is equal for all

// The opacity of a texel of that rank, 0 … 1. Over all ranks the mean is the strength.
float Shown(float rank, float strength) {
  const float none = strength < 0.5f ? std::sqrt(2.0f * strength) : 2.0f - std::sqrt(2.0f * (1.0f - strength));
  return (1.0f - kByRank) * strength + kByRank * std::clamp(none - rank, 0.0f, 1.0f);
}

float LuminanceOf(const std::uint16_t* texel) {
  return Luminance(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2]));
}

}  // namespace

DarkPlace DarkestPlace(const PreparedExemplar& exemplar) {
  const int reach = std::max(1, std::min(exemplar.width(), exemplar.height()) / 16), step = std::max(1, reach / 4);
  std::optional<DarkPlace> darkest;
  double least = std::numeric_limits<double>::infinity();
  for (int e = 0; e < exemplar.count(); ++e) {
    for (int y = reach; y < exemplar.height() - reach; y += step) {
      for (int x = reach; x < exemplar.width() - reach; x += step) {
        double sum = 0.0, alpha = 0.0, count = 0.0;
        bool inside = true;
        for (int v = y - reach; v <= y + reach && inside; v += step) {
          for (int u = x - reach; u <= x + reach && inside; u += step) {
            inside = exemplar.Usable(u, v);
            const std::uint16_t* texel = exemplar.picture(e).At(u, v);
            sum += static_cast<double>(texel[3]) * LuminanceOf(texel) + (65535 - texel[3]);
            alpha += texel[3], count += 65535.0;
          }
        }
        if (inside && alpha > 0.0 && sum / count < least) least = sum / count, darkest = {{x, y}, e, reach};
      }
    }
  }
  if (darkest) return *darkest;
  // The square fits nowhere: one dark pixel.
  const std::vector<Source> usable = exemplar.UsablePixels();
  DarkPlace pixel{usable.front(), 0, 0};
  for (int e = 0; e < exemplar.count(); ++e) {
    for (const Source& source : usable) {
      const std::uint16_t* texel = exemplar.picture(e).At(source.x, source.y);
      const double alpha = texel[3] / 65535.0, light = alpha * LuminanceOf(texel) + (1.0 - alpha);
      if (alpha > 0.0 && light < least) least = light, pixel = {source, e, 0};
    }
  }
  return pixel;
}

ShadowPaint::ShadowPaint(std::shared_ptr<const PreparedExemplar> exemplar, std::span<const Picture* const> originals)
    : exemplar_(std::move(exemplar)), dark_(DarkestPlace(*exemplar_)) {
  level_ = std::clamp(static_cast<int>(std::floor(Log2(std::max(1.0, 0.5 * dark_.reach)))), 0, 15);
  std::vector<BarePaper> papers;
  for (const Picture* picture : originals) {
    if (!exemplar_->is_sphere()) break;
    papers.push_back(FindBarePaper(*picture));
  }
  const auto cut_out = [](const BarePaper& paper) { return paper.kind == BarePaper::Kind::kTransparent; };
  const auto covered = [](const BarePaper& paper) { return paper.kind == BarePaper::Kind::kCovered; };
  if (papers.empty() || std::any_of(papers.begin(), papers.end(), covered)) {
    RankDarkPaint();
    return;
  }
  // What lies under a cut-out is unknown, and white paper inside it is as opaque as paint.
  const bool any_cut_out = std::any_of(papers.begin(), papers.end(), cut_out);
  for (BarePaper& paper : papers) {
    if (cut_out(paper)) paper = BarePaper::OfColor(glm::vec3(1.0f));
  }
  Lift(papers);
  if (any_cut_out && !ShowsBareGround())
    RankDarkPaint();
  else
    FindTones(papers);
}

void ShadowPaint::Lift(std::span<const BarePaper> papers) {
  for (int e = 0; e < exemplar_->count(); ++e) {
    Picture picture = exemplar_->picture(e);
    tbb::parallel_for(0, picture.height, [&](int y) {
      for (int x = 0; x < picture.width; ++x) LiftPaint(papers[std::size_t(e)], picture.At(x, y));
    });
    pictures_.push_back(std::move(picture));
  }
}

// Whether enough of the lifted paint is transparent to make a scale of tones.
bool ShadowPaint::ShowsBareGround() const {
  constexpr std::uint16_t kBare = 3277;  // 5%
  constexpr double kLeastBare = 0.05;
  double bare = 0.0, count = 0.0;
  for (const Picture& picture : pictures_) {
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        if (exemplar_->Usable(x, y)) count += 1.0, bare += picture.At(x, y)[3] < kBare;
      }
    }
  }
  return bare >= kLeastBare * count;
}

// The mean luminance of white light reflected by the paint over its paper, in a square. Negative: part of it is not
// usable.
float ShadowPaint::ToneAt(int e, int x, int y, int reach, float paper) const {
  const int step = std::max(1, reach / 6);
  float sum = 0.0f, count = 0.0f;
  for (int v = y - reach; v <= y + reach; v += step) {
    for (int u = x - reach; u <= x + reach; u += step) {
      if (!exemplar_->Usable(u, v)) return -1.0f;
      const std::uint16_t* texel = pictures_[std::size_t(e)].At(u, v);
      const float alpha = static_cast<float>(texel[3]) / 65535.0f;
      sum += alpha * LuminanceOf(texel) + (1.0f - alpha) * paper, count += 1.0f;
    }
  }
  return sum / count;
}

void ShadowPaint::FindTones(std::span<const BarePaper> papers) {
  const auto paper_of = [&](int e) {
    const glm::vec3 c = papers[std::size_t(e)].color;
    return Luminance(c.x, c.y, c.z);
  };
  const float darkest = ToneAt(dark_.exemplar, dark_.center.x, dark_.center.y, dark_.reach, paper_of(dark_.exemplar));
  const int reach = std::max(1, 1 << level_), step = std::max(1, reach / 2);
  for (int e = 0; e < exemplar_->count(); ++e) {
    const float paper = paper_of(e);
    if (!(paper - darkest > 0.02f)) continue;
    for (int y = reach; y < exemplar_->height() - reach; y += step) {
      for (int x = reach; x < exemplar_->width() - reach; x += step) {
        const float tone = ToneAt(e, x, y, reach, paper);
        if (tone >= 0.0f) tones_.push_back({(paper - tone) / (paper - darkest), {x, y}, e});
      }
    }
  }
  std::stable_sort(tones_.begin(), tones_.end(), [](const Tone& a, const Tone& b) { return a.strength < b.strength; });
  if (tones_.empty())
    RankDarkPaint();
  else
    FindPlaces();
}

// The share of the texels around each that are darker: the order in which they appear as a shadow grows stronger. It
// compares with the surroundings, and not with the whole place, so that strokes decide and not their tone.
void ShadowPaint::RankDarkPaint() {
  pictures_.clear();
  const int reach = 2 * dark_.reach + 1, around = std::max(2, dark_.reach / 3), step = std::max(1, around / 4);
  const Picture& picture = exemplar_->picture(dark_.exemplar);
  ranks_width_ = 2 * reach + 1;
  ranks_.assign(std::size_t(ranks_width_) * ranks_width_, 0.5f);
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const int u = dark_.center.x + x, v = dark_.center.y + y;
      if (!exemplar_->Usable(u, v)) continue;
      const float own = LuminanceOf(picture.At(u, v));
      float darker = 0.0f, count = 0.0f;
      for (int dy = -around; dy <= around; dy += step) {
        for (int dx = -around; dx <= around; dx += step) {
          if (!exemplar_->Usable(u + dx, v + dy)) continue;
          const float other = LuminanceOf(picture.At(u + dx, v + dy));
          darker += other < own ? 1.0f : other > own ? 0.0f : 0.5f, count += 1.0f;
        }
      }
      ranks_[std::size_t(y + reach) * ranks_width_ + (x + reach)] = count > 0.0f ? darker / count : 0.5f;
    }
  }
}

// By step and by square of the sphere's picture: the suitable place nearest to the square's middle. The hash chooses a
// square and not a place, because an exemplar of half the size has other places, and a preview must show the same
// paint.
void ShadowPaint::FindPlaces() {
  const auto below = [](const Tone& tone, float value) { return tone.strength < value; };
  const auto at = [&](float value) {
    return static_cast<std::size_t>(std::lower_bound(tones_.begin(), tones_.end(), value, below) - tones_.begin());
  };
  for (int step = 0; step < kSteps; ++step) {
    const float strength = static_cast<float>(step) / kSteps;
    std::size_t first = at(strength - kSameTone), last = at(strength + kSameTone);
    if (last - first < kLeastChoice) {
      last = std::min(tones_.size(), std::max(last, at(strength) + kLeastChoice / 2));
      first = std::min(first, last > kLeastChoice ? last - kLeastChoice : 0);
    }
    for (int square = 0; square < kSquares * kSquares; ++square) {
      const int x = (2 * (square % kSquares) + 1) * exemplar_->width() / (2 * kSquares);
      const int y = (2 * (square / kSquares) + 1) * exemplar_->height() / (2 * kSquares);
      const auto squared = [&](const Tone& tone) {
        const std::int64_t dx = tone.center.x - x, dy = tone.center.y - y;
        return dx * dx + dy * dy;
      };
      const auto nearer = [&](const Tone& a, const Tone& b) { return squared(a) < squared(b); };
      const auto nearest =
          std::min_element(tones_.begin() + std::ptrdiff_t(first), tones_.begin() + std::ptrdiff_t(last), nearer);
      places_.push_back({nearest->center, nearest->exemplar});
    }
  }
}

ShadowPaint::Place ShadowPaint::PlaceFor(int step, std::uint64_t hash) const {
  if (!places_.empty() && step < kSteps) {
    return places_[std::size_t(std::max(0, step)) * kSquares * kSquares + hash % std::uint64_t(kSquares * kSquares)];
  }
  const float reach = static_cast<float>(dark_.reach);
  const auto spread = [&](std::uint64_t bits) {
    return static_cast<int>(std::floor((UnitFloat(bits) - 0.5f) * reach + 0.5f));
  };
  return {{dark_.center.x + spread(hash), dark_.center.y + spread(Mix64(hash))}, dark_.exemplar};
}

void ShadowPaint::Sample(const Place& place, int dx, int dy, int step, std::uint16_t* texel) const {
  Source source{place.center.x + dx, place.center.y + dy};
  if (!exemplar_->Usable(source.x, source.y))
    source = exemplar_->Usable(place.center.x, place.center.y) ? place.center : dark_.center;
  if (!pictures_.empty()) {
    std::copy_n(pictures_[std::size_t(place.exemplar)].At(source.x, source.y), 4, texel);
    return;
  }
  std::copy_n(exemplar_->picture(place.exemplar).At(source.x, source.y), 4, texel);
  const int reach = ranks_width_ / 2, u = source.x - dark_.center.x + reach, v = source.y - dark_.center.y + reach;
  const bool ranked = u >= 0 && v >= 0 && u < ranks_width_ && v < ranks_width_;
  const float rank = ranked ? ranks_[std::size_t(v) * ranks_width_ + u] : 0.5f;
  texel[3] =
      static_cast<std::uint16_t>(static_cast<float>(texel[3]) * Shown(rank, static_cast<float>(step) / kSteps) + 0.5f);
}

}  // namespace scumble
