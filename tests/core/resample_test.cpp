// Resizing against its definition, pixel by pixel.
#include "core/filter/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

namespace scumble {
namespace {

double Lanczos(double x) {
  if (std::abs(x) < 1e-9) return 1.0;
  if (std::abs(x) >= 3.0) return 0.0;
  const double angle = std::numbers::pi * x;
  return 3.0 * std::sin(angle) * std::sin(angle / 3.0) / (angle * angle);
}

// One axis, in floating point and without any rounding but that to 16 bits at the end.
std::vector<double> Along(const std::vector<double>& line, int to) {
  const int from = static_cast<int>(line.size()) / 4;
  const double ratio = double(from) / to, widening = std::max(1.0, ratio);
  std::vector<double> result;
  for (int i = 0; i < to; ++i) {
    const double centre = (i + 0.5) * ratio;
    double sum = 0.0, alpha = 0.0, color[3] = {0.0, 0.0, 0.0};
    for (int s = int(std::floor(centre - 3.0 * widening)); s <= int(std::ceil(centre + 3.0 * widening)); ++s) {
      const double weight = Lanczos((s + 0.5 - centre) / widening);
      const double* const pixel = line.data() + 4 * std::size_t(std::clamp(s, 0, from - 1));
      sum += weight, alpha += weight * pixel[3];
      for (int c = 0; c < 3; ++c) color[c] += weight * pixel[3] * pixel[c];
    }
    for (int c = 0; c < 3; ++c) result.push_back(alpha > 0.5 ? color[c] / alpha : 0.0);
    result.push_back(alpha / sum);
    for (std::size_t c = result.size() - 4; c < result.size(); ++c)
      result[c] = std::round(std::clamp(result[c], 0.0, 65535.0));
  }
  return result;
}

Picture Plain(const Picture& source, int width, int height) {
  std::vector<std::vector<double>> columns(static_cast<std::size_t>(width));
  for (int y = 0; y < source.height; ++y) {
    const std::vector<double> row(source.At(0, y), source.At(0, y) + 4 * source.width);
    const std::vector<double> wide = width == source.width ? row : Along(row, width);
    for (int x = 0; x < width; ++x)
      columns[std::size_t(x)].insert(columns[std::size_t(x)].end(), wide.begin() + 4 * x, wide.begin() + 4 * x + 4);
  }
  Picture result(width, height);
  for (int x = 0; x < width; ++x) {
    const std::vector<double>& column = columns[std::size_t(x)];
    const std::vector<double> tall = height == source.height ? column : Along(column, height);
    for (int y = 0; y < height; ++y) {
      for (int c = 0; c < 4; ++c) result.At(x, y)[c] = static_cast<std::uint16_t>(tall[std::size_t(4 * y + c)]);
    }
  }
  return result;
}

// Opaque, transparent and half transparent parts, and borders between them at any place.
Picture Patchwork(int width, int height) {
  Picture picture(width, height);
  std::uint32_t state = 5;
  const auto next = [&state] { return static_cast<std::uint16_t>((state = state * 1664525u + 1013904223u) >> 16); };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint16_t* const pixel = picture.At(x, y);
      for (int c = 0; c < 3; ++c) pixel[c] = next();
      const int part = (x / 11 + y / 7) % 3;
      pixel[3] = part == 0 ? 65535 : part == 1 ? 0 : next();
    }
  }
  return picture;
}

// Weights of 14 bits differ from exact ones by 2^-15, of eight pixels, along two axes.
TEST(Resample, FollowsItsDefinition) {
  const Picture source = Patchwork(61, 43);
  for (const auto& [width, height] : {std::pair{122, 86}, {183, 43}, {61, 90}, {30, 20}, {200, 21}}) {
    const Picture made = Resample(source, width, height), plain = Plain(source, width, height);
    ASSERT_EQ(made.rgba.size(), plain.rgba.size());
    int most_alpha = 0, most_color = 0;
    for (std::size_t i = 0; i < made.rgba.size(); ++i) {
      const int off = std::abs(int(made.rgba[i]) - int(plain.rgba[i]));
      if (i % 4 == 3) most_alpha = std::max(most_alpha, off);
      // Where hardly anything covers, a colour is divided by next to nothing.
      if (i % 4 != 3 && plain.rgba[i - i % 4 + 3] > 16384) most_color = std::max(most_color, off);
    }
    EXPECT_LE(most_alpha, 40) << width << "x" << height;
    EXPECT_LE(most_color, 160) << width << "x" << height;
  }
}

// What is opaque stays so, what is transparent has no colour, and equal colours stay equal.
TEST(Resample, KeepsFlatColors) {
  Picture flat(20, 20);
  for (std::size_t i = 0; i < flat.rgba.size(); i += 4) {
    flat.rgba[i] = 12345, flat.rgba[i + 1] = 65535, flat.rgba[i + 3] = (i / 4) % 20 < 10 ? 65535 : 0;
  }
  const Picture large = Resample(flat, 60, 40);
  for (int y = 0; y < 40; ++y) {
    EXPECT_EQ(std::vector<std::uint16_t>(large.At(3, y), large.At(3, y) + 4),
              (std::vector<std::uint16_t>{12345, 65535, 0, 65535}));
    EXPECT_EQ(std::vector<std::uint16_t>(large.At(55, y), large.At(55, y) + 4), (std::vector<std::uint16_t>(4, 0)));
  }
  EXPECT_EQ(Resample(flat, 20, 20).rgba, flat.rgba);
}

}  // namespace
}  // namespace scumble
