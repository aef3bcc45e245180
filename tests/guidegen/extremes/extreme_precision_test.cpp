// The loss in guides of 8 bits, half floats and floats: normals, their sources, and the chunks that grow across them.
// Every limit is derived here from the size of a step; "measured against it" shows that the limit is tight. Rounding is
// implemented once more, plainly.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/image/hash.h"
#include "core/io/guides/guide_storage.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/lookup_table.h"

namespace scumble::testing {
namespace {

enum class Kept { kEightBits, kHalf, kFloat };
constexpr std::array<Kept, 3> kAllKept = {Kept::kEightBits, Kept::kHalf, Kept::kFloat};
const char* NameOf(Kept kept) { return kept == Kept::kEightBits ? "8 bits" : kept == Kept::kHalf ? "half" : "float"; }

// Half a step at a value of [-1, 1]: the most that rounding to the nearest moves it. In 8 bits (v + 1) / 2 is a
// multiple of 1/255. Of a binary number with b bits the last counts 2^-b of the power of two above it; half floats have
// 11, and below 2^-14 no more than 2^-24 of 1; floats have 24.
double HalfStep(Kept kept, double value) {
  if (kept == Kept::kEightBits) return 1.0 / 255.0;
  int exponent = 0;
  std::frexp(value, &exponent);  // |value| < 2^exponent
  return kept == Kept::kHalf ? std::ldexp(0.5, std::max(exponent, -13) - 11) : std::ldexp(0.5, exponent - 24);
}
constexpr double LargestHalfStep(Kept kept) {  // anywhere in [-1, 1]
  return kept == Kept::kEightBits ? 1.0 / 255.0 : kept == Kept::kHalf ? 0x1p-12 : 0x1p-25;
}

double Rounded(Kept kept, double value) {
  if (kept == Kept::kEightBits) return std::nearbyint((value + 1.0) * 127.5) / 127.5 - 1.0;
  const double step = 2.0 * HalfStep(kept, value);
  return std::nearbyint(value / step) * step;
}
glm::dvec3 Rounded(Kept kept, const glm::dvec3& v) {
  return {Rounded(kept, v.x), Rounded(kept, v.y), Rounded(kept, v.z)};
}

double Angle(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Rings of the sphere's picture, by their radius.
constexpr std::array<double, 7> kRadii = {0.0, 0.5, 0.8, 0.95, 0.99, 0.999, 1.0};

// Directions evenly over the picture of a ring, at the places (t of [0, 1), angle) of a hash.
void ForDirections(int ring, int count, const std::function<void(const glm::dvec3&)>& see) {
  for (int i = 0; i < count; ++i) {
    const std::uint64_t hash = Hash(std::uint64_t(ring), std::uint64_t(i));
    const double from = kRadii[std::size_t(ring)] * kRadii[std::size_t(ring)];
    const double to = kRadii[std::size_t(ring) + 1] * kRadii[std::size_t(ring) + 1];
    const double radius = std::sqrt(from + (to - from) * (double(hash >> 11) * 0x1p-53));
    const double around = 2.0 * M_PI * (double(Mix64(hash) >> 11) * 0x1p-53);
    see({radius * std::cos(around), radius * std::sin(around), std::sqrt(1.0 - radius * radius)});
  }
}

// --- Normals ------------------------------------------------------------------------------------------------------

// A stored normal is n + d, |d_i| at most half a step e_i. Its direction is off by what of d stands across n: at most
// the largest of the eight corners of that box does, over 1 - |d|. Inside the box d is evenly spread, so the square of
// what stands across is the sum of e_i² / 3 · (1 - n_i²) in the mean. Neither knows a silhouette: stored whole, a
// normal is as good there as in the middle.
TEST(Precision, TheDirectionOfAStoredNormal) {
  for (const Kept kept : kAllKept) {
    for (int ring = 0; ring + 1 < int(kRadii.size()); ++ring) {
      double worst = 0.0, closest = 0.0, squares = 0.0, expected = 0.0;
      ForDirections(ring, 100000, [&](const glm::dvec3& n) {
        const glm::dvec3 stored = Rounded(kept, n);
        double limit = 0.0;
        glm::dvec3 half;
        for (int i = 0; i < 3; ++i) half[i] = HalfStep(kept, n[i]);
        for (int i = 0; i < 3; ++i) ASSERT_LE(std::abs(stored[i] - n[i]), half[i] * (1.0 + 1e-12));
        for (int corner = 0; corner < 4; ++corner) {
          const glm::dvec3 d = half * glm::dvec3(1.0, corner & 1 ? -1.0 : 1.0, corner & 2 ? -1.0 : 1.0);
          limit = std::max(limit, glm::length(d - n * glm::dot(n, d)) / (1.0 - glm::length(d)));
        }
        const double angle = Angle(stored, n);
        ASSERT_LE(angle, limit * (1.0 + 1e-12) + 1e-15);
        worst = std::max(worst, angle);
        closest = std::max(closest, angle / limit);
        squares += angle * angle;
        for (int i = 0; i < 3; ++i) expected += half[i] * half[i] / 3.0 * (1.0 - n[i] * n[i]);
      });
      EXPECT_GT(closest, 0.9) << NameOf(kept) << ", ring " << ring;
      // The square of what is evenly spread has a standard deviation of 0.9 of its mean; five of those of 1e5
      // directions, and half of that for the root: 0.7 %. In the last ring z spans 5.7 steps of 8 bits; in the cut one
      // its square is a quarter less than a third, with 0.23 of the directions and half of the sum: 1.4 % of the root.
      const bool cut = kept == Kept::kEightBits && ring + 2 == int(kRadii.size());
      EXPECT_NEAR(std::sqrt(squares / expected), 1.0, 0.5 * 5.0 * 0.9 / std::sqrt(1e5) + (cut ? 0.014 : 0.0))
          << NameOf(kept) << ", ring " << ring;
      std::printf("normal, %s, ring %.3f: worst %.3g deg, rms %.3g deg, %.2f of its limit\n", NameOf(kept),
                  kRadii[std::size_t(ring) + 1], glm::degrees(worst), glm::degrees(std::sqrt(squares / 1e5)), closest);
    }
  }
}

// --- Sources ------------------------------------------------------------------------------------------------------

// The most that a place in the disc's plane can turn its normal when it moves by `step`, ending inside radius `to`:
// arcsine is steepest at the rim, so it is the move straight in from there. At the rim it is acos(1 - step), about
// √(2 step): this is where 8 bits are "fuzzy".
double LargestTurn(double to, double step) {
  const double end = std::min(1.0, to + step);
  return std::asin(end) - std::asin(std::max(end - step, -1.0));
}

// The source of the analytic search is R · (n.x, n.y), cut to the usable disc. Rounding moves it by √2 · R · e at the
// most, everywhere alike, for cutting to a disc brings no two places further apart; float's sums add 2^-22 R to either
// of the two places that are compared. The paint found there was made for a normal that is farther off the closer to
// the silhouette it is: the turn of above.
struct SourceError {
  double moved = 0.0;   // of the radius
  double turned = 0.0;  // radians, of the normal that was painted there
};
SourceError ErrorOf(const PreparedExemplar& sphere, const glm::dvec3& n, const glm::dvec3& stored) {
  const glm::dvec2 at(sphere.OnDisc(glm::vec3(n))), found(sphere.OnDisc(glm::vec3(stored)));
  const auto lifted = [](const glm::dvec2& p) { return glm::dvec3(p, std::sqrt(std::max(0.0, 1.0 - glm::dot(p, p)))); };
  return {glm::distance(at, found), Angle(lifted(at), lifted(found))};
}

TEST(Precision, TheSourceOfAStoredNormal) {
  const PreparedExemplar sphere(NoisePicture(2048), 0.0, 2048);
  for (const Kept kept : {Kept::kEightBits, Kept::kHalf}) {
    const double step = std::sqrt(2.0) * LargestHalfStep(kept) + 0x1p-21;
    for (int ring = 0; ring + 1 < int(kRadii.size()); ++ring) {
      SourceError worst;
      ForDirections(ring, 100000, [&](const glm::dvec3& n) {
        const SourceError error = ErrorOf(sphere, n, Rounded(kept, n));
        worst.moved = std::max(worst.moved, error.moved);
        worst.turned = std::max(worst.turned, error.turned);
      });
      const double turn = LargestTurn(kRadii[std::size_t(ring) + 1], step);
      EXPECT_LE(worst.moved, step);
      EXPECT_LE(worst.turned, turn) << NameOf(kept) << ", ring " << ring;
      // A step of half floats is full for values above 1/2 only, and half as large in the middle; at the very rim the
      // usable disc ends half a pixel early, and of the steep last stretch that half pixel is the steepest.
      EXPECT_GT(worst.moved, 0.45 * step) << NameOf(kept) << ", ring " << ring;
      EXPECT_GT(worst.turned, 0.4 * turn) << NameOf(kept) << ", ring " << ring;
      std::printf(
          "source, %s, ring %.3f: moved %.3g px of R 256, %.3g px of R 4096 (limit %.3g); turned %.3g deg (%.3g)\n",
          NameOf(kept), kRadii[std::size_t(ring) + 1], 256 * worst.moved, 4096 * worst.moved, 4096 * step,
          glm::degrees(worst.turned), glm::degrees(turn));
    }
  }
}

// Floats' own half step is a sixteenth of what float's sums may lose, so here the truth is the formula in double: x and
// y, cut to the usable disc. Where they are cut, the length, a quotient and a product are rounded too: three steps
// more.
TEST(Precision, TheSourceOfANormalInFloats) {
  const PreparedExemplar sphere(NoisePicture(2048), 0.0, 2048);
  const double usable = sphere.OnDisc({1, 0, 0}).x;
  const auto lifted = [](const glm::dvec2& p) { return glm::dvec3(p, std::sqrt(1.0 - glm::dot(p, p))); };
  for (int ring = 0; ring + 1 < int(kRadii.size()); ++ring) {
    const double step = (ring + 2 < int(kRadii.size()) ? 2.0 : 5.0) * std::sqrt(2.0) * LargestHalfStep(Kept::kFloat);
    SourceError worst;
    ForDirections(ring, 100000, [&](const glm::dvec3& n) {
      const glm::dvec2 found(sphere.OnDisc(glm::vec3(n)));
      const glm::dvec2 truth = glm::dvec2(n) * std::min(1.0, usable / glm::length(glm::dvec2(n)));
      worst.moved = std::max(worst.moved, glm::distance(found, truth));
      worst.turned = std::max(worst.turned, Angle(lifted(truth), lifted(found)));
    });
    const double turn = LargestTurn(std::min(kRadii[std::size_t(ring) + 1], usable), step);
    EXPECT_LE(worst.moved, step) << "ring " << ring;
    EXPECT_LE(worst.turned, turn) << "ring " << ring;
    if (ring + 2 < int(kRadii.size())) {
      EXPECT_GT(worst.moved, 0.2 * step) << "below a half a step is half as large";
    }
    std::printf("source, float, ring %.3f: moved %.3g px of R 4096 (limit %.3g); turned %.3g deg (%.3g)\n",
                kRadii[std::size_t(ring) + 1], 4096 * worst.moved, 4096 * step, glm::degrees(worst.turned),
                glm::degrees(turn));
  }
}

// As guides are read from a file: brought to unit length. Then x and y are those of a direction that is off by √3 e at
// the most over the whole sphere, and so is the place found: cutting to the hemisphere and to the usable disc brings no
// two directions further apart. No silhouette shows.
TEST(Precision, TheSourceOfANormalBroughtToUnitLength) {
  const PreparedExemplar sphere(NoisePicture(2048), 0.0, 2048);
  for (const Kept kept : {Kept::kEightBits, Kept::kHalf}) {
    const double off = std::sqrt(3.0) * LargestHalfStep(kept);
    for (int ring = 0; ring + 1 < int(kRadii.size()); ++ring) {
      std::vector<glm::dvec3> normals;
      ForDirections(ring, 100000, [&](const glm::dvec3& n) { normals.push_back(n); });
      GuideSet guides = MakeGuides(
          400, 250, [&](int x, int y) { return glm::vec3(Rounded(kept, normals[std::size_t(y * 400 + x)])); });
      internal::NormalizeNormals(guides);
      SourceError worst;
      for (std::size_t i = 0; i < normals.size(); ++i) {
        const SourceError error = ErrorOf(sphere, normals[i], guides.Vec3(Layer::kNormal, i));
        worst.moved = std::max(worst.moved, error.moved);
        worst.turned = std::max(worst.turned, error.turned);
      }
      // Float's sums lose 2^-22 at either place, which turns a normal by that over its height above the disc.
      const double to = std::min(kRadii[std::size_t(ring) + 1], double(sphere.OnDisc({1, 0, 0}).x));
      const double limit = off / (1.0 - off) + 0x1p-21 / std::sqrt(1.0 - to * to);
      EXPECT_LE(worst.moved, limit);
      EXPECT_LE(worst.turned, limit) << NameOf(kept) << ", ring " << ring;
      EXPECT_GT(worst.turned, 0.45 * off) << NameOf(kept) << ", ring " << ring;
      std::printf("unit source, %s, ring %.3f: moved %.3g px of R 256, %.3g px of R 4096; turned %.3g deg (%.3g)\n",
                  NameOf(kept), kRadii[std::size_t(ring) + 1], 256 * worst.moved, 4096 * worst.moved,
                  glm::degrees(worst.turned), glm::degrees(limit));
    }
  }
}

// The same in whole pixels. A place is moved to the centre of the pixel it falls in, by √½ pixel at the most, or, where
// that pixel is outside the disc, to the nearest inside: another pixel at the most along each axis. Where in its pixel
// a place lies is chance, so along an axis it crosses a border with the chance of its move in pixels, and stays in its
// pixel with the product of both chances not to. Half floats are no chance: their steps divide a pixel of these sizes,
// so what lies within half a step of a border is put on it, where the lower pixel wins: half of that, a chance of e_c
// pixels. Of the last ring many are cut. Floats are what the search takes: it has to find the very same pixel.
TEST(Precision, TheSourceInPixels) {
  for (const int radius : {256, 1024}) {
    const PreparedExemplar sphere(NoisePicture(256), 0.0, 2 * radius);
    for (const Kept kept : kAllKept) {
      const double limit = std::sqrt(2.0) * LargestHalfStep(kept) * radius + 2.0 * (std::sqrt(0.5) + std::sqrt(2.0));
      double worst = 0.0;
      int changed = 0, changed_inside = 0;
      double expected = 0.0, variance = 0.0;
      for (int ring = 0; ring + 1 < int(kRadii.size()); ++ring) {
        const bool is_inside = ring + 2 < int(kRadii.size());
        ForDirections(ring, 20000, [&](const glm::dvec3& n) {
          const glm::vec3 whole(n), stored(Rounded(kept, n));
          const Source at = sphere.NearestNeighbour(whole), found = sphere.NearestNeighbour(stored);
          worst = std::max(worst, std::hypot(double(at.x - found.x), double(at.y - found.y)));
          changed += !(at == found);
          if (!is_inside) return;
          changed_inside += !(at == found);
          glm::dvec2 move = glm::abs(glm::dvec2(sphere.OnDisc(whole)) - glm::dvec2(sphere.OnDisc(stored)));
          if (kept == Kept::kHalf) move = {HalfStep(kept, n.x), HalfStep(kept, n.y)};
          const double stays = std::max(0.0, 1.0 - radius * move.x) * std::max(0.0, 1.0 - radius * move.y);
          expected += 1.0 - stays, variance += stays * (1.0 - stays);
        });
      }
      EXPECT_LE(worst, limit) << NameOf(kept) << ", radius " << radius;
      if (kept == Kept::kEightBits) {
        EXPECT_GE(worst, 0.9 * std::sqrt(2.0) * LargestHalfStep(kept) * radius - std::sqrt(2.0));
      }
      if (kept == Kept::kFloat) {
        EXPECT_EQ(changed, 0) << "radius " << radius;
      }
      EXPECT_NEAR(changed_inside, expected, 5.0 * std::sqrt(variance)) << NameOf(kept) << ", radius " << radius;
      std::printf("pixels, %s, R %d: worst %.2f (limit %.2f), other pixel %.3f %%\n", NameOf(kept), radius, worst,
                  limit, changed / 1200.0);
    }
  }
}

// The most that lies, in space, between a direction that is at most `to` from the middle of the disc and the nearest
// pixel's. That of the pixel which the place falls in is a step of √½ pixel; where that pixel may be outside the disc,
// it is another along each axis at the most. Near the silhouette a step turns a normal far: there the nearest is up to
// some pixels off along the rim.
double LargestGap(double to, int radius) {
  const double step = std::sqrt(0.5) / radius;
  return LargestTurn(to, to + step <= 1.0 ? step : step + std::sqrt(2.0) / radius);
}

// The pixel whose direction is nearest to n where pixels lie `shift` of one aside: tried one by one.
glm::ivec2 NearestOnLattice(const glm::dvec3& n, int radius, const glm::dvec2& shift) {
  constexpr int kReach = 3;  // LargestGap up to the ring of 0.95, rounded up
  const glm::ivec2 middle(glm::round(glm::dvec2(n) * double(radius) - shift));
  glm::ivec2 nearest(0);
  double least = std::numeric_limits<double>::infinity();
  for (int v = -kReach; v <= kReach; ++v) {
    for (int u = -kReach; u <= kReach; ++u) {
      const glm::ivec2 pixel = middle + glm::ivec2(u, v);
      const glm::dvec2 p = (glm::dvec2(pixel) + shift) / double(radius);
      const glm::dvec3 off = n - glm::dvec3(p, std::sqrt(std::max(0.0, 1.0 - glm::dot(p, p))));
      if (glm::dot(off, off) < least) least = glm::dot(off, off), nearest = pixel;
    }
  }
  return nearest;
}

constexpr std::array<int, 2> kPixelRadii = {200, 400};

// The number of directions that find another pixel, the total, and the expected number.
struct Changes {
  int seen = 0, found = 0;
  double expected = 0.0, variance = 0.0;
  void Expect(double chance) { expected += chance, variance += chance * (1.0 - chance); }
};

// Where cells of a table hold different sources, another cell is another source. Where in its cell a projected
// direction lies is chance, so along an axis it leaves the cell with the chance of its move in cells.
double ChanceOfAnotherCell(const glm::dvec3& whole, const glm::dvec3& stored) {
  const auto projected = [](const glm::dvec3& n) { return glm::dvec2(n) / std::sqrt(1.0 + n.z); };
  const glm::dvec2 move = glm::abs(projected(whole) - projected(stored)) * (0.5 * LookUpTable::kResolution);
  return 1.0 - std::max(0.0, 1.0 - move.x) * std::max(0.0, 1.0 - move.y);
}

// The same by the two searches that go by the distance in space: a tree, which is exact, and a table. Both bring a
// normal to unit length first, so it is off by δ = √3 e / (1 - √3 e), and its source is as far from it as LargestGap
// says. A table asks for the middle of its cell instead, half of Quantisation() away. So two sources are δ and two gaps
// apart in space, by table Quantisation() more, and in the picture no more than in space.
//
// How many sources are others: of a tree, as many as on a lattice of pixels that lies anywhere (both counts are chance,
// so their difference has twice the variance of one), up to the ring of 0.95, which no edge of the disc disturbs. Of a
// table, as many as come to other cells, where the middles of two cells, which are √(1 + z) times 2 / resolution apart
// at least, are farther from each other than two gaps and so have no source in common: in the middle of a large sphere.
// Radii are no powers of two here, so that steps of half floats and borders of pixels meet by chance.
void CheckPixels(const PreparedExemplar& sphere, bool is_table, Kept kept) {
  const int radius = sphere.size() / 2;
  const double cell = is_table ? LookUpTable::Quantisation(LookUpTable::kResolution) : 0.0;
  const double off = std::sqrt(3.0) * LargestHalfStep(kept) / (1.0 - std::sqrt(3.0) * LargestHalfStep(kept));
  std::uint64_t draws = 0;
  Changes all, told;
  for (int ring = 0; ring + 1 < int(kRadii.size()); ++ring) {
    const double to = std::min(1.0, kRadii[std::size_t(ring) + 1] + off + 0.5 * cell), gap = LargestGap(to, radius);
    const double limit = radius * (off + 2.0 * gap + cell) + radius * 0x1p-20;  // what float's sums lose
    const double middles = 2.0 / LookUpTable::kResolution * std::sqrt(1.0 + std::sqrt(1.0 - to * to));
    const bool is_told = is_table ? middles > 2.0 * gap : ring < 3;
    double worst = 0.0;
    ForDirections(ring, 4000, [&](const glm::dvec3& n) {
      const glm::dvec3 stored = Rounded(kept, n), unit = glm::normalize(stored);
      const Source at = sphere.NearestNeighbour(glm::vec3(n)), found = sphere.NearestNeighbour(glm::vec3(stored));
      worst = std::max(worst, std::hypot(double(at.x - found.x), double(at.y - found.y)));
      ++all.seen, all.found += !(at == found);
      if (!is_told) return;
      ++told.seen, told.found += !(at == found);
      if (is_table) return told.Expect(ChanceOfAnotherCell(n, unit));
      const std::uint64_t hash = Hash(0xb0adu, draws++);
      const glm::dvec2 shift(double(hash >> 32) * 0x1p-32, double(hash & 0xffffffffu) * 0x1p-32);
      told.expected += NearestOnLattice(n, radius, shift) != NearestOnLattice(unit, radius, shift);
    });
    EXPECT_LE(worst, limit) << "ring " << ring;
    std::printf("pixels, %s, %s, R %d, ring %.3f: worst %.2f (limit %.2f)\n", is_table ? "table" : "tree", NameOf(kept),
                radius, kRadii[std::size_t(ring) + 1], worst, limit);
  }
  if (!is_table) {
    const double share = 0.5 * (told.found + told.expected) / told.seen;
    told.variance = 2.0 * told.seen * share * (1.0 - share);
  }
  EXPECT_NEAR(told.found, told.expected, 5.0 * std::sqrt(told.variance));
  std::printf("pixels, %s, %s, R %d: other pixel %.2f %%; of %d %.2f %% (expected %.2f %%)\n",
              is_table ? "table" : "tree", NameOf(kept), radius, 100.0 * all.found / all.seen, told.seen,
              100.0 * told.found / std::max(told.seen, 1), 100.0 * told.expected / std::max(told.seen, 1));
  if (!is_table || radius == kPixelRadii.back()) {
    EXPECT_GT(told.seen, 0);
  }
}

void CheckPixels(NearestSearch search) {
  for (const int radius : kPixelRadii) {
    PreparedExemplar sphere(NoisePicture(64), 0.0, 2 * radius);
    ASSERT_TRUE(sphere.SearchBy(search, LookUpTable::kResolution, nullptr).ok());
    for (const Kept kept : {Kept::kEightBits, Kept::kHalf}) {
      SCOPED_TRACE(std::string(NameOf(kept)) + ", radius " + std::to_string(radius));
      CheckPixels(sphere, search == NearestSearch::kTable, kept);
    }
  }
}

TEST(Precision, TheSourceInPixelsByTree) { CheckPixels(NearestSearch::kTree); }
TEST(Precision, TheSourceInPixelsByTable) { CheckPixels(NearestSearch::kTable); }

// Both searches take floats, so rounding to them changes no comparison; the truth is computed in double here. The
// results, for each ring of each sphere.
constexpr int kFloatDirections = 1000;
void CheckPixelsInFloats(NearestSearch search, int rings,
                         const std::function<Source(const PreparedExemplar&, int, const glm::dvec3&, Source)>& truth) {
  for (const int radius : kPixelRadii) {
    PreparedExemplar sphere(NoisePicture(64), 0.0, 2 * radius);
    ASSERT_TRUE(sphere.SearchBy(search, LookUpTable::kResolution, nullptr).ok());
    for (int ring = 0; ring < rings; ++ring) {
      SCOPED_TRACE("radius " + std::to_string(radius) + ", ring " + std::to_string(ring));
      double worst = 0.0;
      int others = 0;
      ForDirections(ring, kFloatDirections, [&](const glm::dvec3& n) {
        const Source found = sphere.NearestNeighbour(glm::vec3(n)), at = truth(sphere, ring, n, found);
        worst = std::max(worst, std::hypot(double(at.x - found.x), double(at.y - found.y)));
        others += !(at == found);
      });
      std::printf("pixels, %s, float, R %d, ring %.3f: worst %.2f, other pixel %d of %d\n",
                  search == NearestSearch::kTree ? "tree" : "table", radius, kRadii[std::size_t(ring) + 1], worst,
                  others, kFloatDirections);
    }
  }
}

// The usable pixel whose normal is nearest to n, of those within `reach` pixels of its place: tried one by one.
Source NearestPixel(const PreparedExemplar& sphere, const glm::dvec3& n, int reach) {
  const glm::ivec2 middle(glm::floor(glm::dvec2(1.0 + n.x, 1.0 - n.y) * (0.5 * sphere.size())));
  Source nearest{};
  double least = std::numeric_limits<double>::infinity();
  for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
    for (int x = middle.x - reach; x <= middle.x + reach; ++x) {
      if (!sphere.Usable(x, y)) continue;
      const glm::dvec3 off = n - glm::dvec3(sphere.Normal(x, y));
      if (glm::dot(off, off) < least) least = glm::dot(off, off), nearest = {x, y};
    }
  }
  return nearest;
}

// The tree sums squares in double, so all that is lost is the normal's own, in u = 2^-24: half of one in each component
// where it is stored, √¾ in all; where it is brought to unit length 2.5 for the length (three squares, two sums, the
// root) and one for the quotients. That is 4.4 u, on the way to the pixel that is found and to the nearest: 9 u.
TEST(Precision, TheSourceInPixelsByTreeInFloats) {
  CheckPixelsInFloats(NearestSearch::kTree, int(kRadii.size()) - 1,
                      [](const PreparedExemplar& sphere, int ring, const glm::dvec3& n, Source found) {
                        const int radius = sphere.size() / 2;
                        const double gap = LargestGap(kRadii[std::size_t(ring) + 1], radius);
                        const Source nearest = NearestPixel(sphere, n, int(gap * radius) + 2);
                        const auto off = [&](Source at) {
                          return glm::distance(n, glm::dvec3(sphere.Normal(at.x, at.y)));
                        };
                        EXPECT_LE(off(found), off(nearest) + 9.0 * 0x1p-24);
                        return nearest;
                      });
}

// The source that a table holds for a place of the projection: what it finds for the middle of the cell there, which
// no rounding takes out of it.
Source SourceOfCell(const PreparedExemplar& sphere, const glm::dvec2& place) {
  constexpr double kHalf = 0.5 * LookUpTable::kResolution;
  const glm::dvec2 middle = (glm::floor((place + 1.0) * kHalf) + 0.5) / kHalf - 1.0;
  return sphere.NearestNeighbour(DirectionAt(middle.x, middle.y));
}

// A table is asked at (x, y) / √(1 + z), which in floats is off by 10 u along either axis at most: the normal's 4.4,
// which that takes to 4.9 at the rim, where it is steepest (√1¼); 2.5 for the sum, the root and the reciprocal, one for
// the product, and one for the place in the table, which is counted in cells up to 512. So it is the source of the
// formula's cell, or of another where that much is across a border. In the last ring middles of cells lie beyond the
// disc, where none can be asked for.
TEST(Precision, TheSourceInPixelsByTableInFloats) {
  CheckPixelsInFloats(NearestSearch::kTable, int(kRadii.size()) - 2,
                      [](const PreparedExemplar& sphere, int, const glm::dvec3& n, Source found) {
                        const glm::dvec2 place = glm::dvec2(n) / std::sqrt(1.0 + n.z);
                        bool is_near = false;
                        for (int corner = 0; corner < 4; ++corner) {
                          const glm::dvec2 off(corner & 1 ? -1.0 : 1.0, corner & 2 ? -1.0 : 1.0);
                          is_near = is_near || SourceOfCell(sphere, place + 10.0 * 0x1p-24 * off) == found;
                        }
                        EXPECT_TRUE(is_near);
                        return SourceOfCell(sphere, place);
                      });
}

// --- A scene ------------------------------------------------------------------------------------------------------

GuideSet Suzanne() {
  auto scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/suzanne.glb");
  EXPECT_TRUE(scene.ok());
  const auto view = PrepareView(*scene, "", ViewAngles{35, 25, 0}, 4.0 / 3.0, true);
  EXPECT_TRUE(view.ok());
  GuidegenOptions options;
  options.width = 480, options.height = 360;
  auto rendered = RenderGuides(*scene, view->camera, options);
  EXPECT_TRUE(rendered.ok());
  return std::move(rendered->guides);
}

GuideSet RoundedNormals(Kept kept, GuideSet guides) {
  for (int axis = 0; axis < 3; ++axis) {
    for (float& value : guides.Plane(Layer::kNormal, axis)) value = float(Rounded(kept, value));
  }
  return guides;
}

// The sphere's limits hold for whatever a camera sees, backs of smooth normals included: those with z < 0 take the rim
// along (x, y), at a distance of 1 over their length; only normals straight away from the viewer have none, and a
// picture holds them seldom. They are left out below a length of 1/2, where the way to the rim doubles an error.
TEST(Precision, ASceneKeepsTheSpheresLimits) {
  const GuideSet guides = Suzanne();
  const PreparedExemplar sphere(NoisePicture(512), 0.0, 2048);
  for (const Kept kept : {Kept::kEightBits, Kept::kHalf}) {
    const GuideSet rounded = RoundedNormals(kept, guides);
    const double step = std::sqrt(2.0) * LargestHalfStep(kept) + 0x1p-21;
    SourceError worst;
    double worst_angle = 0.0, squares = 0.0;
    int seen = 0, rim = 0;
    for (std::size_t i = 0; i < std::size_t(480) * 360; ++i) {
      if (guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
      const glm::dvec3 n(guides.Vec3(Layer::kNormal, i)), stored(rounded.Vec3(Layer::kNormal, i));
      const double angle = Angle(n, stored);
      worst_angle = std::max(worst_angle, angle);
      squares += angle * angle;
      ++seen;
      rim += std::hypot(n.x, n.y) > 0.95;
      if (n.z < 0.0 || stored.z < 0.0) continue;
      const SourceError error = ErrorOf(sphere, n, stored);
      worst.moved = std::max(worst.moved, error.moved);
      worst.turned = std::max(worst.turned, error.turned);
    }
    const double off = std::sqrt(3.0) * LargestHalfStep(kept);
    EXPECT_LE(worst_angle, off / (1.0 - off));
    EXPECT_LE(worst.moved, step);
    EXPECT_LE(worst.turned, LargestTurn(1.0, step));
    EXPECT_GT(worst_angle, 0.6 * off);
    EXPECT_GT(worst.moved, 0.6 * step);
    EXPECT_GT(worst.turned, 0.4 * LargestTurn(1.0, step));
    EXPECT_GT(rim, seen / 100);
    std::printf(
        "suzanne, %s: normals %.3g deg, rms %.3g; moved %.3g px of R 1024 (limit %.3g); turned %.3g deg (%.3g)\n",
        NameOf(kept), glm::degrees(worst_angle), glm::degrees(std::sqrt(squares / seen)), 1024 * worst.moved,
        1024 * step, glm::degrees(worst.turned), glm::degrees(LargestTurn(1.0, step)));
  }
}

// A pixel's place in a chunk is decided by ‖n - s‖ < threshold. Rounding n by d changes the distance by δ, no more than
// the reach of d along n - s, which is r = Σ e_c |u_c| for half steps e_c and the direction u (and half of |d|² over
// the distance: it is no straight line). Distances spread evenly within r of the threshold are decided otherwise where
// they lie between it and δ away: a share of |δ| / 2r. The sources compared are those of a match with twice the
// threshold: distances lie on both sides of it then. What spreads them is chance, of where a seed's paint comes from,
// and pixels of one flat surface share it; so several seeds are looked at, and how far their sums differ is how sure
// the sum of all is.
TEST(Precision, DecisionsAtTheThreshold) {
  constexpr int kSeeds = 16;
  const GuideSet guides = Suzanne();
  Style style = PlainStyle(NoisePicture(1024));
  style.transfer.rim = 0;
  style.transfer.blend_radius = 0;
  const float threshold = style.transfer.threshold;
  const PreparedExemplar sphere(style.exemplars[0].picture, 0.0, 1024);
  const GuideTest test(threshold, ThresholdMetric::kL2);
  for (const Kept kept : {Kept::kEightBits, Kept::kHalf}) {
    const GuideSet rounded = RoundedNormals(kept, guides);
    const double bend = 1.5 * LargestHalfStep(kept) * LargestHalfStep(kept) / threshold;
    const double reach = std::sqrt(3.0) * LargestHalfStep(kept) + 0x1p-20;
    int seen = 0, near = 0, flipped = 0, other_level = 0, other_offset = 0;
    double expected = 0.0;
    std::vector<double> differences;  // by seed, decisions that differ from the expected ones
    TransferOptions options;
    for (options.seed = 0; options.seed < kSeeds; ++options.seed) {
      style.transfer.threshold = 2.0f * threshold;
      const SourceField field = MustTransfer(style, guides, options).field;
      style.transfer.threshold = threshold;
      const SourceField plain = MustTransfer(style, guides, options).field;
      const SourceField after = MustTransfer(style, rounded, options).field;
      int flipped_here = 0;
      double expected_here = 0.0;
      for (int i = 0; i < 480 * 360; ++i) {
        const auto p = std::size_t(i);
        if (field.level[p] < 0) continue;
        ++seen;
        other_level += plain.level[p] != after.level[p];
        other_offset += plain.x[p] != after.x[p] || plain.y[p] != after.y[p];
        const glm::vec3 n = guides.Vec3(Layer::kNormal, p), stored = rounded.Vec3(Layer::kNormal, p);
        const glm::vec3 s = sphere.Normal(field.x[p], field.y[p]);
        const double distance = glm::distance(glm::dvec3(n), glm::dvec3(s));
        const bool flips = test.Alike(n, s) != test.Alike(stored, s);
        ASSERT_TRUE(std::abs(distance - threshold) <= reach || !flips) << NameOf(kept) << ", pixel " << i;
        flipped_here += flips;
        const glm::dvec3 u = (glm::dvec3(n) - glm::dvec3(s)) / distance;
        double within = bend;
        for (int c = 0; c < 3; ++c) within += std::abs(u[c]) * HalfStep(kept, n[c]);
        if (std::abs(distance - threshold) > within) continue;
        ++near;
        expected_here += std::abs(glm::distance(glm::dvec3(stored), glm::dvec3(s)) - distance) / (2.0 * within);
      }
      flipped += flipped_here, expected += expected_here;
      differences.push_back(flipped_here - expected_here);
    }
    EXPECT_GT(near, 500);
    EXPECT_GT(flipped, 50);
    // How sure their sum is, by how far the seeds are from each other: five deviations of it, which is little of it.
    const double mean = (flipped - expected) / kSeeds;
    double squares = 0.0;
    for (const double difference : differences) squares += (difference - mean) * (difference - mean);
    const double deviation = std::sqrt(squares / (kSeeds - 1) * kSeeds);
    EXPECT_NEAR(flipped, expected, 5.0 * deviation) << NameOf(kept);
    EXPECT_LT(5.0 * deviation, 0.5 * expected) << NameOf(kept);
    std::printf("threshold, %s: of %d near it %d decided otherwise, %.1f +- %.1f expected\n", NameOf(kept), near,
                flipped, expected, deviation);
    std::printf("threshold, %s: %.3f %% near, %.3f %% decided otherwise; level %.3f %%, source %.3f %% of %d\n",
                NameOf(kept), 100.0 * near / seen, 100.0 * flipped / seen, 100.0 * other_level / seen,
                100.0 * other_offset / seen, seen);
  }
}

}  // namespace
}  // namespace scumble::testing
