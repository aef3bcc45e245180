#include "bench/performance/yardstick.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/image/hash.h"

namespace scumble::bench {

Yardstick::Yardstick(int width, int height, const YardstickExemplar& exemplar, const YardstickSettings& settings)
    : width_(width),
      height_(height),
      exemplar_(exemplar),
      settings_(settings),
      jitter_(std::size_t(settings.levels)),
      sources_(std::size_t(width) * height) {
  const double radius = exemplar.size * std::max(0.0, 1.0 - exemplar.rim / (0.5 * exemplar.size));
  usable_squared_ = std::max<std::int64_t>(2, static_cast<std::int64_t>(std::floor(radius * radius)));
  usable_radius_ = static_cast<float>(std::sqrt(static_cast<double>(usable_squared_)) / exemplar.size);
}

void Yardstick::RenewJitter(std::int64_t time_step) {
  for (int level = 1; level < settings_.levels; ++level) {
    JitterTable& table = jitter_[std::size_t(level)];
    table.columns = ((width_ - 1) >> level) + 3, table.rows = ((height_ - 1) >> level) + 3;
    table.cells.resize(std::size_t(table.columns) * table.rows);
    Place* cell = table.cells.data();
    for (int row = -1; row < table.rows - 1; ++row) {
      for (int column = -1; column < table.columns - 1; ++column, ++cell) {
        const std::uint64_t hash = Hash(settings_.seed, time_step, level, column, row);
        *cell = {UnitFloat(hash), UnitFloat(Mix64(hash))};
      }
    }
  }
}

// h · (b + j), rounded down, b being the cell that p is in.
Yardstick::Place Yardstick::SeedPoint(Place p, float h, const JitterTable& table) const {
  const Place b{std::floor(p.x / h), std::floor(p.y / h)};
  const int column = static_cast<int>(b.x) + 1, row = static_cast<int>(b.y) + 1;
  const Place j = table.cells[std::size_t(row) * table.columns + column];
  return {h * b.x + std::floor(h * j.x), h * b.y + std::floor(h * j.y)};
}

Yardstick::Place Yardstick::NearestSeed(Place p, int level) const {
  const JitterTable& table = jitter_[std::size_t(level)];
  const float h = static_cast<float>(1 << level);
  Place nearest;
  float least = std::numeric_limits<float>::infinity();
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      const Place s = SeedPoint({p.x + h * static_cast<float>(x), p.y + h * static_cast<float>(y)}, h, table);
      const float distance = std::sqrt((s.x - p.x) * (s.x - p.x) + (s.y - p.y) * (s.y - p.y));
      if (distance < least) least = distance, nearest = s;
    }
  }
  return nearest;
}

bool Yardstick::Usable(Pixel u) const {
  if (u.x < 0 || u.y < 0 || u.x >= exemplar_.size || u.y >= exemplar_.size) return false;
  const std::int64_t dx = 2 * u.x + 1 - exemplar_.size, dy = 2 * u.y + 1 - exemplar_.size;
  return dx * dx + dy * dy <= usable_squared_;
}

// A sphere shows normals up to its rim; those beyond become the rim's.
Yardstick::Normal Yardstick::OnDisc(Normal n) const {
  const float length = std::sqrt(n.x * n.x + n.y * n.y);
  if (n.z < 0.0f && !(length > 0.0f)) return {0.0f, usable_radius_, n.z};
  if (!(n.z < 0.0f || length > usable_radius_)) return n;
  return {n.x / length * usable_radius_, n.y / length * usable_radius_, n.z};
}

Yardstick::Normal Yardstick::ComparedAt(const YardstickGuides& guides, std::size_t i) const {
  Normal n{guides.normal_x[i], guides.normal_y[i], guides.normal_z[i]};
  if (!(n.x * n.x + n.y * n.y > usable_radius_ * usable_radius_) && !(n.z < 0.0f)) return n;
  n = OnDisc(n);
  n.z = std::sqrt(std::max(0.0f, 1.0f - n.x * n.x - n.y * n.y));
  return n;
}

// argmin over u of ‖normal - G_S(u)‖: on a sphere the place with that normal.
Yardstick::Pixel Yardstick::BestSource(Normal n) const {
  n = OnDisc(n);
  const float nx = n.x, ny = n.y;
  const float half = 0.5f * static_cast<float>(exemplar_.size);
  const int last = exemplar_.size - 1;
  const Pixel u{std::clamp(static_cast<int>(std::ceil(nx * half + half)) - 1, 0, last),
                std::clamp(static_cast<int>(std::ceil(half - ny * half)) - 1, 0, last)};
  return Usable(u) ? u : NearestUsable(nx, ny, u);
}

// Rounding to texels may leave the disc by one.
Yardstick::Pixel Yardstick::NearestUsable(float nx, float ny, Pixel from) const {
  const float size = static_cast<float>(exemplar_.size);
  Pixel best = from;
  float least = std::numeric_limits<float>::infinity();
  for (int reach = 1; reach <= exemplar_.size && least == std::numeric_limits<float>::infinity(); ++reach) {
    for (int y = from.y - reach; y <= from.y + reach; ++y) {
      for (int x = from.x - reach; x <= from.x + reach; ++x) {
        if (!Usable({x, y})) continue;
        const float dx = nx - static_cast<float>(2 * x + 1 - exemplar_.size) / size;
        const float dy = ny + static_cast<float>(2 * y + 1 - exemplar_.size) / size;
        if (dx * dx + dy * dy < least) least = dx * dx + dy * dy, best = {x, y};
      }
    }
  }
  return best;
}

Yardstick::Pixel Yardstick::MatchPixel(const YardstickGuides& guides, Pixel p) const {
  const std::size_t i = std::size_t(p.y) * width_ + p.x;
  const Normal n = ComparedAt(guides, i);
  const float bound = settings_.threshold * settings_.threshold;
  const float size = static_cast<float>(exemplar_.size);
  for (int level = settings_.levels - 1; level >= 1; --level) {
    const Place seed = NearestSeed({static_cast<float>(p.x), static_cast<float>(p.y)}, level);
    const Pixel q{static_cast<int>(seed.x), static_cast<int>(seed.y)};
    if (q.x < 0 || q.y < 0 || q.x >= width_ || q.y >= height_) continue;
    const std::size_t k = std::size_t(q.y) * width_ + q.x;
    if (!(guides.coverage[k] > 0.0f)) continue;
    const Pixel best = BestSource(ComparedAt(guides, k));
    const Pixel u{best.x + (p.x - q.x), best.y + (p.y - q.y)};
    if (!Usable(u)) continue;
    const float sx = static_cast<float>(2 * u.x + 1 - exemplar_.size) / size;
    const float sy = -(static_cast<float>(2 * u.y + 1 - exemplar_.size) / size);
    const float sz = std::sqrt(std::max(0.0f, 1.0f - sx * sx - sy * sy));
    const float error = (n.x - sx) * (n.x - sx) + (n.y - sy) * (n.y - sy) + (n.z - sz) * (n.z - sz);
    if (error < bound) return u;
  }
  return BestSource(n);
}

// The mean of the texels that the chunks of the nine pixels around p would put there.
void Yardstick::VotePixel(Pixel p, std::uint16_t* rgb) const {
  std::uint32_t sum[3] = {0, 0, 0};
  std::uint32_t votes = 0;
  for (int y = std::max(0, p.y - 1); y <= std::min(height_ - 1, p.y + 1); ++y) {
    for (int x = std::max(0, p.x - 1); x <= std::min(width_ - 1, p.x + 1); ++x) {
      const YardstickSource q = sources_[std::size_t(y) * width_ + x];
      if (q.x == YardstickSource::kNoSource) continue;
      const Pixel u{q.x + (p.x - x), q.y + (p.y - y)};
      if (!Usable(u)) continue;
      const std::uint16_t* texel = exemplar_.rgba + 4 * (std::size_t(u.y) * exemplar_.size + u.x);
      for (int c = 0; c < 3; ++c) sum[c] += texel[c];
      ++votes;
    }
  }
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint16_t>((sum[c] + votes / 2) / votes);
}

void Yardstick::Paint(const YardstickGuides& guides, std::uint16_t* rgba) {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = std::size_t(y) * width_ + x;
      if (guides.coverage[i] > 0.0f) {
        const Pixel u = MatchPixel(guides, {x, y});
        sources_[i] = {static_cast<std::int16_t>(u.x), static_cast<std::int16_t>(u.y)};
      } else {
        sources_[i] = {};
      }
    }
  }
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = std::size_t(y) * width_ + x;
      std::uint16_t* out = rgba + 4 * i;
      std::fill_n(out, 4, std::uint16_t{0});
      if (!(guides.coverage[i] > 0.0f)) continue;
      VotePixel({x, y}, out);
      out[3] = static_cast<std::uint16_t>(65535.0f * std::min(guides.coverage[i], 1.0f) + 0.5f);
    }
  }
}

}  // namespace scumble::bench
