#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

using Matrix3 = std::array<std::array<double, 3>, 3>;

// Colours nearer to each other than this standard deviation count as one.
constexpr double kLeastVariance = 1e-3 * 1e-3;

Matrix3 Product(const Matrix3& a, const Matrix3& b) {
  Matrix3 product{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) product[i][j] += a[i][k] * b[k][j];
    }
  }
  return product;
}

// Turns the axes p and q so that m[p][q] becomes 0; the columns of `axes` follow.
void Rotate(std::size_t p, std::size_t q, Matrix3& m, Matrix3& axes) {
  if (m[p][q] == 0.0) return;
  const double theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
  const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
  const auto turn = [&](double& at_p, double& at_q) {
    const double old_p = at_p, old_q = at_q;
    at_p = c * old_p - s * old_q, at_q = s * old_p + c * old_q;
  };
  for (std::size_t k = 0; k < 3; ++k) turn(m[k][p], m[k][q]);
  for (std::size_t k = 0; k < 3; ++k) turn(m[p][k], m[q][k]);
  for (std::size_t k = 0; k < 3; ++k) turn(axes[k][p], axes[k][q]);
}

// A symmetric matrix with its eigenvalues changed by `change`; Jacobi's rotations.
template <class Change>
Matrix3 WithEigenvalues(Matrix3 m, const Change& change) {
  Matrix3 axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < 16; ++sweep) {
    Rotate(0, 1, m, axes), Rotate(0, 2, m, axes), Rotate(1, 2, m, axes);
  }
  Matrix3 changed{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double value = change(m[k][k]);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) changed[i][j] += axes[i][k] * value * axes[j][k];
    }
  }
  return changed;
}

// Without lightness, its row and column are those of a variance of 1 that has nothing to do with the others.
Matrix3 MatrixOf(const ColorSpread& spread, bool with_lightness) {
  const auto& [ll, la, lb, aa, ab, bb] = spread.covariance;
  if (!with_lightness) return {{{1, 0, 0}, {0, aa, ab}, {0, ab, bb}}};
  return {{{ll, la, lb}, {la, aa, ab}, {lb, ab, bb}}};
}

// The symmetric A with A S A = T that moves colours least.
Matrix3 MapOf(const Matrix3& from, const Matrix3& to, double gain) {
  const auto floored = [](double value) { return std::max(value, kLeastVariance); };
  const auto root = [&](double value) { return std::sqrt(floored(value)); };
  const Matrix3 half = WithEigenvalues(from, root);
  const Matrix3 per_half = WithEigenvalues(from, [&](double value) { return 1.0 / root(value); });
  const auto plain_root = [](double value) { return std::sqrt(std::max(value, 0.0)); };
  const Matrix3 middle = WithEigenvalues(Product(Product(half, WithEigenvalues(to, floored)), half), plain_root);
  Matrix3 map = Product(Product(per_half, middle), per_half);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < i; ++j) map[i][j] = map[j][i] = 0.5 * (map[i][j] + map[j][i]);
  }
  return WithEigenvalues(map, [&](double value) { return std::clamp(value, 0.0, gain); });
}

struct ColorSums {
  double weight = 0.0;
  std::array<double, 3> first{};
  std::array<double, 6> second{};
};

void AddColors(const std::uint16_t* texels, const std::uint8_t* only, std::size_t count, ColorSums& sums) {
  OklabBlock block;
  OklabFromTexels(texels, count, block);
  for (std::size_t i = 0; i < count; ++i) {
    if (only && !only[i]) continue;
    const double w = texels[4 * i + 3], l = block.lightness[i], a = block.a[i], b = block.b[i];
    sums.weight += w;
    const std::array<double, 3> first{l, a, b};
    const std::array<double, 6> second{l * l, l * a, l * b, a * a, a * b, b * b};
    for (std::size_t k = 0; k < 3; ++k) sums.first[k] += w * first[k];
    for (std::size_t k = 0; k < 6; ++k) sums.second[k] += w * second[k];
  }
}

}  // namespace

PointEffect MakePalette(const PalettePass& pass, const ColorSpread& source) {
  const bool with_lightness = !pass.keep_lightness;
  const ColorSpread& target = *pass.target;
  const Matrix3 exact = MapOf(MatrixOf(source, with_lightness), MatrixOf(target, with_lightness), pass.gain);
  std::array<std::array<float, 3>, 3> map{};
  std::array<float, 3> from{}, to{};
  for (std::size_t i = 0; i < 3; ++i) {
    from[i] = static_cast<float>(source.mean[i]), to[i] = static_cast<float>(target.mean[i]);
    for (std::size_t j = 0; j < 3; ++j) map[i][j] = static_cast<float>(exact[i][j]);
  }
  return [=](std::size_t, std::size_t count, OklabBlock& block) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::array<float, 3> off{block.lightness[i] - from[0], block.a[i] - from[1], block.b[i] - from[2]};
      const auto moved = [&](std::size_t k) {
        return to[k] + map[k][0] * off[0] + map[k][1] * off[1] + map[k][2] * off[2];
      };
      if (with_lightness) block.lightness[i] = moved(0);
      block.a[i] = moved(1), block.b[i] = moved(2);
    }
  };
}

}  // namespace scumble::internal

namespace scumble {

ColorSpread MeasureColors(const Picture& picture, std::span<const std::uint8_t> only) {
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<internal::ColorSums> rows(static_cast<std::size_t>(picture.height));
  tbb::parallel_for(std::size_t(0), rows.size(), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; x += internal::kOklabBlock) {
      const std::size_t p = y * width + x, count = std::min(internal::kOklabBlock, width - x);
      internal::AddColors(picture.rgba.data() + 4 * p, only.empty() ? nullptr : only.data() + p, count, rows[y]);
    }
  });
  internal::ColorSums sums;  // in one order
  for (const auto& row : rows) {
    sums.weight += row.weight;
    for (std::size_t k = 0; k < 3; ++k) sums.first[k] += row.first[k];
    for (std::size_t k = 0; k < 6; ++k) sums.second[k] += row.second[k];
  }
  ColorSpread spread;
  if (!(sums.weight > 0.0)) return spread;
  for (std::size_t k = 0; k < 3; ++k) spread.mean[k] = sums.first[k] / sums.weight;
  const auto& [l, a, b] = spread.mean;
  const std::array<double, 6> of_means{l * l, l * a, l * b, a * a, a * b, b * b};
  for (std::size_t k = 0; k < 6; ++k) spread.covariance[k] = sums.second[k] / sums.weight - of_means[k];
  return spread;
}

}  // namespace scumble
