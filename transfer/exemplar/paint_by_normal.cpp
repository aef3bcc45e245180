#include "transfer/exemplar/paint_by_normal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/image/exact_math.h"
#include "core/image/hash.h"
#include "transfer/prepared_exemplar.h"

namespace scumble {
namespace {

constexpr int kTries = 24;
constexpr int kNormalCells = 64;  // a side
// Root of the mean squared distance, as a share of the encoded range. With a larger value chunks become visible; with a
// smaller one so few places are left that they repeat.
constexpr double kTolerance = 0.08;

int NormalCell(float coordinate) {
  return std::clamp(static_cast<int>(std::floor((coordinate * 0.5f + 0.5f) * kNormalCells)), 0, kNormalCells - 1);
}

// 0 … count - 1 by the hash's upper half. Unlike the remainder it is an equal share of any count, so a preview of half
// the size chooses as the final picture does.
std::uint64_t ShareOf(std::uint64_t hash, std::uint64_t count) { return (hash >> 32) * count >> 32; }

}  // namespace

SourceVariation::SourceVariation(const PreparedExemplar& exemplar)
    : shift_(std::max(0, static_cast<int>(std::bit_width(static_cast<unsigned>(exemplar.size()))) - 8)),
      cell_(1 << shift_),
      columns_((exemplar.width() + cell_ - 1) / cell_),
      rows_((exemplar.height() + cell_ - 1) / cell_) {
  const std::size_t stride = std::size_t(columns_) + 1;
  for (int k = 0; k < exemplar.count(); ++k) {
    std::vector<Sums> table(stride * (std::size_t(rows_) + 1));
    for (int y = 0; y < exemplar.height(); ++y) {
      for (int x = 0; x < exemplar.width(); ++x) {
        if (!exemplar.Usable(x, y)) continue;
        const std::uint16_t* texel = exemplar.picture(k).At(x, y);
        Sums& sums = table[(std::size_t(y / cell_) + 1) * stride + std::size_t(x / cell_) + 1];
        for (int c = 0; c < 3; ++c) sums.color[c] += std::int64_t(texel[c]) * texel[3] / 65535;
        sums.color[3] += texel[3];
        ++sums.count;
      }
    }
    for (std::size_t i = stride; i < table.size(); ++i) {
      if (i % stride == 0) continue;
      const Sums &left = table[i - 1], &above = table[i - stride], &corner = table[i - stride - 1];
      for (int c = 0; c < 4; ++c) table[i].color[c] += left.color[c] + above.color[c] - corner.color[c];
      table[i].count += left.count + above.count - corner.count;
    }
    tables_.push_back(std::move(table));
    std::vector<Tone> corners;
    for (int row = 0; row <= rows_; ++row) {
      for (int column = 0; column <= columns_; ++column) {
        const int x = column * cell_, y = row * cell_;
        corners.push_back(ToneOf(k, x - cell_, y - cell_, x + cell_, y + cell_).value_or(Tone{}));
      }
    }
    corners_.push_back(std::move(corners));
  }
  if (exemplar.is_sphere()) return;
  const std::vector<Source> usable = exemplar.UsablePixels();
  const auto cell_of = [&](Source source) {
    const glm::vec3 normal = exemplar.Normal(source.x, source.y);
    return std::size_t(NormalCell(normal.y)) * kNormalCells + std::size_t(NormalCell(normal.x));
  };
  begins_.assign(kNormalCells * kNormalCells + 1, 0);
  for (const Source& source : usable) ++begins_[cell_of(source) + 1];
  for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  by_normal_.resize(usable.size());
  for (const Source& source : usable) {
    by_normal_[next[cell_of(source)]++] =
        static_cast<std::uint32_t>(source.y) * static_cast<std::uint32_t>(exemplar.width()) +
        static_cast<std::uint32_t>(source.x);
  }
}

std::optional<SourceVariation::Tone> SourceVariation::ToneOf(int picture, int x0, int y0, int x1, int y1) const {
  const auto cell = [&](int at, int cells) { return std::clamp((at + cell_ / 2) / cell_, 0, cells); };
  int c0 = cell(std::max(0, x0), columns_), c1 = cell(std::max(0, x1), columns_);
  int r0 = cell(std::max(0, y0), rows_), r1 = cell(std::max(0, y1), rows_);
  if (c0 >= c1 || r0 >= r1) return std::nullopt;
  const std::vector<Sums>& table = tables_[std::size_t(picture)];
  const std::size_t stride = std::size_t(columns_) + 1;
  const Sums &a = table[r0 * stride + c0], &b = table[r0 * stride + c1], &c = table[r1 * stride + c0],
             &d = table[r1 * stride + c1];
  const std::int64_t count = a.count - b.count - c.count + d.count;
  if (count == 0) return std::nullopt;
  Tone tone;
  for (int i = 0; i < 4; ++i)
    tone[i] = static_cast<std::int32_t>((a.color[i] - b.color[i] - c.color[i] + d.color[i]) / count);
  return tone;
}

std::optional<SourceVariation::Tone> SourceVariation::ToneAround(Source source, int picture, int half_width) const {
  const int half = std::max(half_width, cell_);
  return ToneOf(picture, source.x - half, source.y - half, source.x + half, source.y + half);
}

SourceVariation::Tone SourceVariation::ToneAt(Source source, int picture) const {
  const int column = source.x >> shift_, row = source.y >> shift_;
  // Twice the distance of the pixel's centre from the left and upper corners.
  const std::int64_t fx = 2 * (source.x - column * cell_) + 1, fy = 2 * (source.y - row * cell_) + 1, whole = 2 * cell_;
  const auto* corner = &corners_[std::size_t(picture)][std::size_t(row) * (std::size_t(columns_) + 1) + column];
  const auto* below = corner + columns_ + 1;
  Tone tone;
  for (int c = 0; c < 4; ++c) {
    const std::int64_t upper = (whole - fx) * corner[0][c] + fx * corner[1][c];
    const std::int64_t lower = (whole - fx) * below[0][c] + fx * below[1][c];
    tone[c] = static_cast<std::int32_t>(((whole - fy) * upper + fy * lower) >> (2 * shift_ + 2));
  }
  return tone;
}

// The mean squared distance of the quarters' tones from `tone`.
std::int64_t SourceVariation::Unlikeness(Source source, const Wanted& wish, const Tone& tone) const {
  const int half = std::max(wish.half_width, cell_);
  std::int64_t sum = 0, quarters = 0;
  for (const int dx : {-half, 0}) {
    for (const int dy : {-half, 0}) {
      const auto quarter =
          ToneOf(wish.picture, source.x + dx, source.y + dy, source.x + dx + half, source.y + dy + half);
      if (!quarter) continue;
      for (int i = 0; i < 4; ++i) {
        const std::int64_t difference = (*quarter)[i] - tone[i];
        sum += difference * difference;
      }
      ++quarters;
    }
  }
  return quarters > 0 ? sum / quarters : std::numeric_limits<std::int64_t>::max();
}

// One pixel of those around the cone, evenly distributed; empty where it is outside.
std::optional<Source> SourceVariation::Draw(const PreparedExemplar& exemplar, Source own, double chord, float cosine,
                                            std::uint64_t a, std::uint64_t b) const {
  const glm::vec3 normal = exemplar.Normal(own.x, own.y);
  Source source;
  if (exemplar.is_sphere()) {
    const int reach = std::max(1, static_cast<int>(std::ceil(0.5 * exemplar.size() * chord)));
    const auto side = static_cast<std::uint64_t>(2 * reach + 1);
    source = {own.x - reach + static_cast<int>(ShareOf(a, side)), own.y - reach + static_cast<int>(ShareOf(b, side))};
    if (!exemplar.Usable(source.x, source.y)) return std::nullopt;
  } else {
    const float reach = static_cast<float>(chord);
    const int x0 = NormalCell(normal.x - reach), x1 = NormalCell(normal.x + reach);
    const int y0 = NormalCell(normal.y - reach), y1 = NormalCell(normal.y + reach);
    std::uint64_t total = 0;
    // The cells of one row lie side by side, so each row of the box is one range.
    const auto row = [&](int y, int x) { return begins_[std::size_t(y) * kNormalCells + std::size_t(x)]; };
    for (int y = y0; y <= y1; ++y) total += row(y, x1 + 1) - row(y, x0);
    std::uint64_t index = ShareOf(a, total);  // `own` is among them
    for (int y = y0;; ++y) {
      const std::uint64_t count = row(y, x1 + 1) - row(y, x0);
      if (index >= count) {
        index -= count;
        continue;
      }
      const std::uint32_t pixel = by_normal_[row(y, x0) + index];
      source = {static_cast<int>(pixel % std::uint32_t(exemplar.width())),
                static_cast<int>(pixel / std::uint32_t(exemplar.width()))};
      break;
    }
  }
  const glm::vec3 other = exemplar.Normal(source.x, source.y);
  if (!(normal.x * other.x + normal.y * other.y + normal.z * other.z >= cosine)) return std::nullopt;
  return source;
}

Source SourceVariation::Choose(const PreparedExemplar& exemplar, const Wanted& wish) const {
  const std::optional<Tone> tone = ToneAround(wish.own, wish.picture, wish.half_width);
  if (!tone) return wish.own;
  constexpr auto kMost = static_cast<std::int64_t>(kTolerance * 65535 * kTolerance * 65535);
  const double chord = 2.0 * SinDegrees(0.5 * wish.degrees);
  const float cosine = static_cast<float>(CosDegrees(wish.degrees));
  Source best = wish.own;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const std::uint64_t a = Mix64(wish.hash + 2 * attempt), b = Mix64(wish.hash + 2 * attempt + 1);
    const std::optional<Source> source = Draw(exemplar, wish.own, chord, cosine, a, b);
    if (!source) continue;
    const std::int64_t unlike = Unlikeness(*source, wish, *tone);
    if (unlike <= kMost) return *source;
    if (unlike < least) best = *source, least = unlike;
  }
  return best;
}

}  // namespace scumble
