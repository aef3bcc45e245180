// Marks of the edge test, of which most are told by bounds without testing, against the test itself: bit for bit, on
// surfaces that are just smooth enough for the bounds or just not.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "tests/support/transfer_fixtures.h"
#include "transfer/vote/edge/small_window_bounds.h"
#include "transfer/vote/edge/edge_masks.h"

namespace scumble {
namespace {

using namespace testing;
using internal::BitRows;
using internal::PixelStep;

float Unit(std::uint64_t seed, int x, int y) { return 2.0f * UnitFloat(Hash(seed, x, y)) - 1.0f; }

// 10^from … 10^to, evenly in the exponent.
float Magnitude(std::uint64_t hash, float from, float to) {
  return std::pow(10.0f, from + (to - from) * UnitFloat(hash));
}

// A tilted and bent surface with noise or terraces, each of any size: depths that bend as much as the test allows, more
// or less, and normals that turn as much.
GuideSet RoughSurface(int width, int height, std::uint64_t seed) {
  constexpr float kScales[] = {1.0f, 10.0f, 1000.0f, 1e-14f, 3e-16f, 1e-30f, 1e-42f, 1e36f};
  const float scale = kScales[seed % 3 ? seed % 2 : Hash(seed, 1) % std::size(kScales)];
  // Terraces are flat, and about half as high as the commonest tolerance: two at a corner are as high as it.
  const bool terraces = seed % 7 == 5;
  const float tilt = terraces ? 0.0f : Magnitude(Hash(seed, 2), -6.0f, -1.0f);
  const float bend = terraces ? 0.0f : Magnitude(Hash(seed, 3), -7.0f, -2.0f);
  const float step = terraces ? 0.002f * (0.3f + 0.3f * UnitFloat(Hash(seed, 12))) : 0.0f;
  const float noise = seed % 4 == 1 || terraces ? 0.0f : Magnitude(Hash(seed, 4), -7.0f, -2.0f);
  const float turn = Magnitude(Hash(seed, 5), seed % 7 == 6 ? -1.0f : -3.0f, seed % 7 == 6 ? 0.2f : -0.3f),
              jitter = Magnitude(Hash(seed, 6), -4.0f, 0.0f);
  const glm::vec3 ahead = AnyDirection(Hash(seed, 7));
  GuideSet guides = MakeGuides(width, height, [&](int x, int y) {
    if (seed % 5 == 2 && Hash(seed, x / 7, y / 4, 8) % 9 == 0) return glm::vec3(0.0f);
    const glm::vec3 off{Unit(seed + 1, x, y), Unit(seed + 2, x, y), Unit(seed + 3, x, y)};
    if (seed % 7 == 6) {
      // Rows that lean to either side; the middles of blocks tell nothing of what their pixels do besides.
      const float angle = (y % 2 ? 1.0f : -1.0f) * 0.5f * turn + (x % 16 == 8 ? 0.0f : 0.2f * Unit(seed + 1, x, y));
      return glm::vec3(std::sin(angle), 0.0f, std::cos(angle));
    }
    const glm::vec3 turned{std::sin(turn * x), std::cos(turn * y), std::sin(turn * (x + y))};
    return glm::normalize(ahead + 0.7f * turned + jitter * off) * (1.0f + 0.01f * jitter * Unit(seed + 4, x, y));
  });
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      const float u = static_cast<float>(x - width / 2), v = static_cast<float>(y - height / 2);
      guides.Plane(Layer::kDepth)[i] =
          scale * (1.0f + step * static_cast<float>((x / 3 + y / 3) % 4) + tilt * (u - 0.6f * v) +
                   bend * (u * u + v * u + 2.0f * v * v) / 40 + noise * Unit(seed, x, y));
      const std::uint64_t rare = Hash(seed, x, y, 9) % 400;
      if (seed % 4 == 3 && rare == 0) guides.Plane(Layer::kDepth)[i] = std::numeric_limits<float>::quiet_NaN();
      if (seed % 4 == 3 && rare == 1) guides.Plane(Layer::kDepth)[i] = std::numeric_limits<float>::infinity();
      if (seed % 4 == 3 && rare == 2) guides.Plane(Layer::kNormal, 1)[i] = std::numeric_limits<float>::quiet_NaN();
      guides.Plane(Layer::kObject)[i] = seed % 6 == 4 && (x + 2 * y) / 30 % 2 ? 2.0f : 1.0f;
      if (seed % 4 == 3 && rare == 3) guides.Plane(Layer::kObject)[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  if (seed % 11 == 5) guides.camera = OrthographicCamera(scale * UnitFloat(Hash(seed, 13)));
  return guides;
}

bool Inside(const GuideSet& guides, int x, int y) {
  return x >= 0 && y >= 0 && x < guides.width() && y < guides.height();
}

// Whether any centre stands at most `reach` from (x, y), in x and y.
bool AnyNear(const std::vector<std::uint8_t>& centres, const GuideSet& guides, int x, int y, int reach) {
  for (int v = y - reach; v <= y + reach; ++v) {
    for (int u = x - reach; u <= x + reach; ++u) {
      if (Inside(guides, u, v) && centres[guides.Index(u, v)]) return true;
    }
  }
  return false;
}

// Compares all marks that hold with the test.
void ExpectTested(const GuideSet& guides, const std::vector<std::uint8_t>& centres, double crease, double tolerance,
                  int radius, const std::string& told) {
  internal::LateSlopes slopes(guides);
  const internal::EdgeRules rules{guides, slopes, crease, tolerance};
  const internal::EdgeTest test(rules);
  const internal::MarkedTile tile{-radius, guides.height() + 2 * radius, -1, (guides.width() + 63) / 64 + 2};
  BitRows bits;
  bits.Reset(tile.first_row, tile.rows, tile.first_word, tile.words, 0);
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) bits.At(y, x / 64) |= std::uint64_t(centres[guides.Index(x, y)]) << x % 64;
  }
  internal::EdgeMarks marks;
  internal::MarkEdges(rules, radius, tile, bits, marks);
  const std::vector<PixelStep> steps = internal::ForwardSteps(radius);
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      // Marks stand only near words that hold centres.
      if (!AnyNear(centres, guides, x, y, radius)) continue;
      const bool sure = marks.sure.At(y, x / 64) >> x % 64 & 1;
      for (std::size_t k = 0; k < steps.size(); ++k) {
        const int u = x + steps[k].dx, v = y + steps[k].dy;
        if (!Inside(guides, u, v)) continue;
        const int reach = std::max(std::abs(steps[k].dx), steps[k].dy) == 1 ? radius - 1 : 0;
        if (!AnyNear(centres, guides, x, y, reach) && !AnyNear(centres, guides, u, v, reach)) continue;
        const std::size_t p = guides.Index(x, y), q = guides.Index(u, v);
        const bool same = coverage[p] > 0.0f && coverage[q] > 0.0f &&
                          test.SameSurface(test.At(p), test.At(q), steps[k].dx, steps[k].dy);
        ASSERT_EQ(marks.same[k].At(y, x / 64) >> x % 64 & 1, same)
            << told << ", radius " << radius << ", crease " << crease << ", tolerance " << tolerance << ", pixel " << x
            << ", " << y << ", step " << steps[k].dx << ", " << steps[k].dy;
        ASSERT_TRUE(same || !sure) << told << ", radius " << radius << ", pixel " << x << ", " << y;
      }
    }
  }
}

TEST(EdgeMarks, EqualTheTestOnEverySurface) {
  constexpr double kCreases[] = {60.0, 10.0, 180.0, 120.0, 1.0, 0.0},
                   kTolerances[] = {0.002, 0.02, 1e-4, 1e-6, 1.0, 0.0};
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const int width = seed % 10 == 9 ? 1 + int(seed / 10) : 130 + int(seed % 5), height = 6 + int(seed % 7);
    const GuideSet guides = RoughSurface(width, height, seed);
    std::vector<std::uint8_t> centres(guides.pixel_count());
    const std::uint64_t sparse = 1 + seed % 3 * 6;
    for (std::size_t i = 0; i < centres.size(); ++i) centres[i] = Hash(seed, i) % sparse == 0;
    const double crease = kCreases[Hash(seed, 10) % std::size(kCreases)];
    const double tolerance = kTolerances[Hash(seed, 11) % std::size(kTolerances)];
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      const std::string told = "surface " + std::to_string(seed) + " with " + hwy::TargetName(target);
      for (const int radius : {1, 2, 3}) ExpectTested(guides, centres, crease, tolerance, radius, told);
      hwy::SetSupportedTargetsForTest(0);
      if (HasFatalFailure()) return;
    }
  }
}

// What CalmMarks tells of row `y` of guides that are covered everywhere, as marks by step and pixel.
struct Told {
  std::vector<std::vector<std::uint64_t>> level, sure;
};

Told CalmOf(const GuideSet& guides, const internal::EdgeRules& rules, int radius, int y) {
  const int words = (guides.width() + 63) / 64;
  const internal::MarkedTile tile{0, guides.height(), 0, words};
  const std::size_t stride = std::size_t(words + 2) * 64;
  std::vector<float> depths(stride * std::size_t(guides.height()), std::numeric_limits<float>::quiet_NaN());
  const auto depth = [&](int row) { return depths.data() + stride * std::size_t(row) + 64; };
  for (int row = 0; row < guides.height(); ++row) {
    const auto plane = guides.Plane(Layer::kDepth).subspan(guides.Index(0, row), std::size_t(guides.width()));
    std::copy(plane.begin(), plane.end(), depth(row));
  }
  internal::CalmMarks calm(rules, radius, tile);
  const auto row_at = [&](int row) {
    const std::size_t begin = guides.Index(0, row);
    const auto plane = [&](Layer layer, int channel) { return guides.Plane(layer, channel).data() + begin; };
    return internal::EdgeRow{depth(row),
                             nullptr,
                             nullptr,
                             plane(Layer::kObject, 0),
                             {plane(Layer::kNormal, 0), plane(Layer::kNormal, 1), plane(Layer::kNormal, 2)},
                             std::int64_t(begin),
                             std::int64_t(guides.pixel_count() - begin)};
  };
  const std::vector<std::uint8_t> all(std::size_t(words), 15);
  for (int row = y; row <= y + radius; ++row) {
    calm.Add(row, {depth(row - 1), row_at(row), row_at(row + 1), guides.width()}, all.data());
  }
  calm.Compare(y, y + radius);
  Told told;
  for (std::size_t k = 0; k < internal::ForwardSteps(radius).size(); ++k) {
    told.level.emplace_back(calm.Level(k), calm.Level(k) + words);
    told.sure.emplace_back(calm.Sure(k), calm.Sure(k) + words);
  }
  return told;
}

// A ball that fills the picture, seen from near: nothing there needs a test.
TEST(CalmMarks, TellAllOfASmoothSurface) {
  const int width = 256, height = 12;
  GuideSet guides = MakeGuides(width, height, [](int x, int y) {
    const float u = (x - 128) / 400.0f, v = (y - 6) / 400.0f;
    return glm::vec3(u, v, std::sqrt(1.0f - u * u - v * v));
  });
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kDepth)[i] = 3.0f - guides.Plane(Layer::kNormal, 2)[i];
  }
  internal::LateSlopes slopes(guides);
  for (const int radius : {1, 2, 3}) {
    const std::vector<PixelStep> steps = internal::ForwardSteps(radius);
    const Told told = CalmOf(guides, {guides, slopes, 60.0, 0.002}, radius, 5);
    for (std::size_t k = 0; k < steps.size(); ++k) {
      // The first and last columns of the picture are not calm: one neighbour is missing.
      for (int x = 1 + radius; x < width - 1 - radius; ++x) {
        ASSERT_TRUE(told.sure[k][std::size_t(x / 64)] >> x % 64 & 1)
            << "radius " << radius << ", column " << x << ", step " << steps[k].dx << ", " << steps[k].dy;
      }
    }
  }
}

// What bounds promise, the test must keep, and each kind of promise must be given and withheld.
TEST(CalmMarks, PromiseNothingThatTheTestRefuses) {
  std::size_t level = 0, sure = 0, all = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    GuideSet guides = RoughSurface(256, 12, seed);
    for (float& coverage : guides.Plane(Layer::kCoverage)) coverage = 1.0f;
    internal::LateSlopes slopes(guides);
    constexpr double kTolerances[] = {0.002, 0.02, 1e-4, 2e-5, 0.5};
    const internal::EdgeRules rules{guides, slopes, seed % 2 ? 60.0 : 170.0 * UnitFloat(Hash(seed, 20)),
                                    kTolerances[seed / 2 % std::size(kTolerances)]};
    // For depths alone: normals never make a crease.
    const internal::EdgeTest test(rules), depths(guides, slopes.Get(), 180.0, rules.depth_tolerance);
    const int radius = 1 + int(seed % 3), y = 5;
    const std::vector<PixelStep> steps = internal::ForwardSteps(radius);
    const Told told = CalmOf(guides, rules, radius, y);
    for (std::size_t k = 0; k < steps.size(); ++k) {
      for (int x = 0; x < 256; ++x) {
        ++all;
        const std::uint64_t bit = std::uint64_t{1} << x % 64;
        if (!(told.level[k][std::size_t(x / 64)] & bit)) continue;
        ++level;
        const std::size_t p = guides.Index(x, y), q = guides.Index(x + steps[k].dx, y + steps[k].dy);
        const auto a = depths.At(p), b = depths.At(q);
        const glm::vec3 product = a.normal * b.normal;
        if (product.x + product.y + product.z == product.x + product.y + product.z) {
          ASSERT_TRUE(depths.SameSurface(a, b, steps[k].dx, steps[k].dy)) << "surface " << seed << ", column " << x;
        }
        if (!(told.sure[k][std::size_t(x / 64)] & bit)) continue;
        ++sure;
        ASSERT_TRUE(test.SameSurface(a, b, steps[k].dx, steps[k].dy)) << "surface " << seed << ", column " << x;
      }
    }
  }
  EXPECT_GT(sure, all / 50);
  EXPECT_GT(level, sure + all / 50);
  EXPECT_LT(level, all - all / 50);
}

}  // namespace
}  // namespace scumble
