// Votes against their plain definition, and steps on slanted surfaces, which no vote may cross.
#include "transfer/vote/edge/support_regions.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "tests/support/transfer_fixtures.h"
#include "transfer/vote/vote.h"

namespace scumble {
namespace {

using namespace testing;

struct Limits {
  float crease_cosine, tolerance;
};

float SlopeAt(const GuideSet& guides, int x, int y, int dx, int dy) {
  const auto covered = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < guides.width() && v < guides.height() &&
           guides.Plane(Layer::kCoverage)[guides.Index(u, v)] > 0.0f;
  };
  const auto depth = [&](int u, int v) { return guides.Plane(Layer::kDepth)[guides.Index(u, v)]; };
  if (!covered(x - dx, y - dy) || !covered(x, y) || !covered(x + dx, y + dy)) return 0.0f;
  const float back = depth(x, y) - depth(x - dx, y - dy), front = depth(x + dx, y + dy) - depth(x, y);
  if (!(back * front > 0.0f)) return 0.0f;
  return std::fabs(back) < std::fabs(front) ? back : front;
}

bool NormalsAlike(const GuideSet& guides, const Limits& limits, glm::ivec2 p, glm::ivec2 q) {
  const glm::vec3 a = guides.Vec3(Layer::kNormal, guides.Index(p.x, p.y));
  const glm::vec3 b = guides.Vec3(Layer::kNormal, guides.Index(q.x, q.y));
  return a.x * b.x + a.y * b.y + a.z * b.z > limits.crease_cosine;
}

// The edge test between neighbours of one row or column.
bool StepIsOpen(const GuideSet& guides, const Limits& limits, glm::ivec2 a, glm::ivec2 b) {
  const std::size_t p = guides.Index(a.x, a.y), q = guides.Index(b.x, b.y);
  if (!(guides.Plane(Layer::kCoverage)[p] > 0.0f) || !(guides.Plane(Layer::kCoverage)[q] > 0.0f)) return false;
  if (guides.Plane(Layer::kObject)[p] != guides.Plane(Layer::kObject)[q]) return false;
  const int dx = std::abs(b.x - a.x), dy = std::abs(b.y - a.y);
  const float slope = SlopeAt(guides, a.x, a.y, dx, dy), other = SlopeAt(guides, b.x, b.y, dx, dy);
  const float near = guides.Plane(Layer::kDepth)[p], far = guides.Plane(Layer::kDepth)[q];
  const float expected = static_cast<float>(b.x - a.x + b.y - a.y) * (0.5f * (slope + other));
  const float give = std::min(std::fabs(slope), std::fabs(other)) + limits.tolerance * std::min(near, far);
  return std::fabs(far - near - expected) <= give && NormalsAlike(guides, limits, a, b);
}

// Whether two pixels of one row or column are on one arm: every step between them and every pair of normals.
bool OnOneArm(const GuideSet& guides, const Limits& limits, glm::ivec2 a, glm::ivec2 b) {
  const glm::ivec2 step = glm::sign(b - a);
  for (glm::ivec2 p = a; p != b; p += step) {
    if (!StepIsOpen(guides, limits, p, p + step)) return false;
    for (glm::ivec2 q = p; q != b;) {
      q += step;
      if (!NormalsAlike(guides, limits, p, q)) return false;
    }
  }
  return true;
}

// Whether q is in the support region of p.
bool Joined(const GuideSet& guides, const Limits& limits, int px, int py, int qx, int qy) {
  const glm::ivec2 corner(px, qy);
  return OnOneArm(guides, limits, {px, py}, corner) && OnOneArm(guides, limits, corner, {qx, qy});
}

Picture PlainVote(const GuideSet& guides, const SourceField& field, const PreparedExemplar& exemplar, int radius,
                  const Limits* limits) {
  Picture out(field.width, field.height);
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      if (!(guides.Plane(Layer::kCoverage)[field.Index(x, y)] > 0.0f)) continue;
      std::array<std::uint64_t, 4> sum{};
      std::uint64_t votes = 0;
      for (int v = std::max(0, y - radius); v <= std::min(field.height - 1, y + radius); ++v) {
        for (int u = std::max(0, x - radius); u <= std::min(field.width - 1, x + radius); ++u) {
          const std::size_t q = field.Index(u, v);
          if (!(guides.Plane(Layer::kCoverage)[q] > 0.0f)) continue;
          if (std::max(std::abs(u - x), std::abs(v - y)) > 1 << field.level[q]) continue;
          const int sx = field.x[q] + x - u, sy = field.y[q] + y - v;
          if (!exemplar.Usable(sx, sy) || (limits && !Joined(guides, *limits, x, y, u, v))) continue;
          const std::uint16_t* texel = exemplar.picture(field.exemplar[q]).At(sx, sy);
          for (int c = 0; c < 3; ++c) sum[c] += std::uint64_t{texel[3]} * texel[c];
          sum[3] += texel[3], ++votes;
        }
      }
      std::uint16_t* pixel = out.At(x, y);
      for (int c = 0; c < 3; ++c) pixel[c] = sum[3] ? static_cast<std::uint16_t>((sum[c] + sum[3] / 2) / sum[3]) : 0;
      pixel[3] = static_cast<std::uint16_t>((sum[3] + votes / 2) / votes);
    }
  }
  return out;
}

std::vector<std::uint8_t> Covered(const GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::vector<std::uint8_t> active(coverage.size());
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = coverage[i] > 0.0f;
  return active;
}

Picture EngineVote(const GuideSet& guides, const SourceField& field, const PreparedExemplar& exemplar, int radius,
                   const internal::EdgeRules* edges, const Region& region) {
  Picture out(guides.width(), guides.height());
  const std::vector<std::uint8_t> active = Covered(guides);
  const Progress unheard;
  internal::RowProgress progress(unheard, 0.0, 1.0, guides.height());
  EXPECT_TRUE(internal::Vote({field, active, exemplar, radius, edges, region}, out, progress));
  return out;
}

// Hills and blocks at hashed depths, two objects, holes; or values that no scene should have.
GuideSet RoughGuides(int width, int height, bool extreme) {
  GuideSet guides = MakeGuides(width, height, [&](int x, int y) {
    if (Hash(x / 7, y / 5, 9) % 11 == 0) return glm::vec3(0.0f);
    return glm::normalize(glm::vec3(std::sin(x * 0.2f), std::cos(y * 0.15f), 0.6f));
  });
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      const std::uint64_t block = Hash(x / 6, y / 9);
      guides.Plane(Layer::kDepth)[i] = 5.0f + 0.02f * x - 0.013f * y + 0.05f * static_cast<float>(block % 3);
      guides.Plane(Layer::kObject)[i] = x + y > width ? 1.0f : 2.0f;
      if (!extreme || block % 4 != 0) continue;
      const float odd[] = {
          0.0f, 1e30f, 1e-38f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), -3.0f};
      guides.Plane(Layer::kDepth)[i] = odd[Hash(x, y) % 6];
    }
  }
  return guides;
}

// Chunks of 1 to 30 pixels with any offset, and transparent paint in parts.
SourceField RoughField(const GuideSet& guides, int size) {
  SourceField field;
  field.Reset(guides.width(), guides.height());
  for (int y = 0; y < field.height; ++y) {
    for (int x = 0; x < field.width; ++x) {
      const std::uint64_t chunk = y < field.height / 2 ? Hash(x / 30, y / 25) : Hash(x / 4, y);
      const int ox = static_cast<int>(chunk % 15), oy = static_cast<int>(chunk / 16 % 15);
      if (guides.Plane(Layer::kCoverage)[field.Index(x, y)] > 0.0f) {
        field.Set(field.Index(x, y), size / 4 + ox + x % (size / 2), size / 4 + oy + y % (size / 2),
                  int(chunk / 999 % 2), 1);
      }
    }
  }
  return field;
}

TEST(Support, VotesEqualTheirPlainForm) {
  for (const bool extreme : {false, true}) {
    const GuideSet guides = RoughGuides(76, 52, extreme);
    internal::LazyDepthGradient slopes(guides);
    Picture first = NoisePicture(300), second = NoisePicture(300);
    for (std::size_t i = 0; i < second.rgba.size(); i += 4) {
      first.rgba[i + 3] = static_cast<std::uint16_t>(i % 28 == 0 ? 0 : Hash(i));
      second.rgba[i + 1] = 7;
    }
    const std::vector<const Picture*> pictures{&first, &second};
    const PreparedExemplar exemplar(pictures, 0.0, 300);
    const SourceField field = RoughField(guides, 300);
    const Region all{0, 0, 76, 52};
    for (const int radius : {0, 1, 2, 3, 8}) {
      EXPECT_EQ(EngineVote(guides, field, exemplar, radius, nullptr, all).rgba,
                PlainVote(guides, field, exemplar, radius, nullptr).rgba)
          << radius;
      for (const double tolerance : {0.0, 0.002}) {
        const internal::EdgeRules edges{guides, slopes, 60.0, tolerance};
        const Limits limits{static_cast<float>(0.5 + 1e-16), static_cast<float>(tolerance)};
        const Picture expected = PlainVote(guides, field, exemplar, radius, &limits);
        EXPECT_EQ(EngineVote(guides, field, exemplar, radius, &edges, all).rgba, expected.rgba)
            << radius << ", " << tolerance;
        const Region part{13, 21, 57, 44};
        const Picture found = EngineVote(guides, field, exemplar, radius, &edges, part);
        for (int y = part.y0; y < part.y1; ++y) {
          ASSERT_TRUE(std::equal(found.At(part.x0, y), found.At(part.x0, y) + 4 * (part.x1 - part.x0),
                                 expected.At(part.x0, y)));
        }
      }
    }
  }
}

// The property behind the fast forms: q is on an arm of p if p is on one of q, and so are all pixels between the two.
TEST(Support, ArmsAreSymmetricAndHereditary) {
  for (const bool extreme : {false, true}) {
    const GuideSet guides = RoughGuides(60, 44, extreme);
    const std::vector<std::uint8_t> active = Covered(guides);
    internal::LazyDepthGradient slopes(guides);
    const internal::EdgeRules edges{guides, slopes, 40.0, 0.002};
    const internal::SupportRegions regions(edges, active, 9, {0, 0, 60, 44});
    std::vector<std::vector<std::uint8_t>> across(active.size(), std::vector<std::uint8_t>(60)), down = across;
    std::size_t cut = 0;
    for (int y = 0; y < 44; ++y) {
      for (int x = 0; x < 60; ++x) {
        if (!active[guides.Index(x, y)]) continue;
        regions.ForEach(x, y, [&](std::size_t q, int dx, int dy) {
          ASSERT_EQ(q, guides.Index(x + dx, y + dy));
          if (dy == 0) across[guides.Index(x, y)][std::size_t(x + dx)] = 1;
          if (dx == 0) down[guides.Index(x, y)][std::size_t(y + dy)] = 1;
        });
      }
    }
    const auto check = [&](const auto& on_arm, glm::ivec2 p, glm::ivec2 step, int far) {
      const glm::ivec2 q = p + far * step;
      if (q.x >= 60 || q.y >= 44) return;
      const auto at = [&](glm::ivec2 a, glm::ivec2 b) {
        return on_arm[guides.Index(a.x, a.y)][std::size_t(step.x ? b.x : b.y)] != 0;
      };
      ASSERT_EQ(at(p, q), at(q, p));
      if (!at(p, q)) ++cut;
      for (int i = 0; at(p, q) && i <= far; ++i) {
        for (int j = i; j <= far; ++j) ASSERT_TRUE(at(p + i * step, p + j * step)) << p.x << ", " << p.y;
      }
    };
    for (int y = 0; y < 44; ++y) {
      for (int x = 0; x < 60; ++x) {
        for (int far = 0; far <= 9 && active[guides.Index(x, y)]; ++far) {
          check(across, {x, y}, {1, 0}, far), check(down, {x, y}, {0, 1}, far);
        }
      }
    }
    EXPECT_GT(cut, 3000u);
  }
}

// A rod seen from the side turns by half a circle within its width: pixels far across it do not vote for each other,
// though every step is open.
TEST(Support, ArmsEndWhereASurfaceTurnsByTheCrease) {
  const GuideSet guides = MakeGuides(40, 30, [](int x, int) {
    const float angle = (static_cast<float>(x) - 19.5f) * 0.15f;
    return std::fabs(angle) < 1.5f ? glm::vec3(std::sin(angle), 0, std::cos(angle)) : glm::vec3(0.0f);
  });
  const std::vector<std::uint8_t> active = Covered(guides);
  internal::LazyDepthGradient slopes(guides);
  const internal::EdgeRules edges{guides, slopes, 60.0, 0.002};
  const internal::SupportRegions regions(edges, active, 9, {0, 0, 40, 30});
  int widest = 0, highest = 0;
  regions.ForEach(19, 15,
                  [&](std::size_t, int dx, int dy) { widest = std::max(widest, dx), highest = std::max(highest, dy); });
  EXPECT_EQ(widest, 6) << "6 · 0.15 rad are 51.6 degrees";
  EXPECT_EQ(highest, 9);
}

// Black paint on objects in front and white on those behind: grey is a vote that crossed.
std::size_t Ghosts(const GuideSet& guides, const std::vector<std::uint8_t>& front, int radius, double tolerance,
                   bool joined) {
  constexpr int kSize = 200;
  Picture paint(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) paint.At(x, y)[0] = x < kSize / 2 ? 0 : 65535, paint.At(x, y)[3] = 65535;
  }
  const PreparedExemplar exemplar(paint, 0.0, kSize);
  SourceField field;
  field.Reset(guides.width(), guides.height());
  for (std::size_t i = 0; i < front.size(); ++i) field.Set(i, front[i] ? kSize / 4 : 3 * kSize / 4, kSize / 2, 0, 0);
  internal::LazyDepthGradient slopes(guides);
  const internal::EdgeRules edges{guides, slopes, 180.0, tolerance};
  const Picture out = EngineVote(guides, field, exemplar, radius, joined ? &edges : nullptr,
                                 Region{0, 0, guides.width(), guides.height()});
  std::size_t ghosts = 0;
  for (std::size_t i = 0; i < front.size(); ++i) ghosts += out.rgba[4 * i] != (front[i] ? 0 : 65535);
  return ghosts;
}

// One object of one normal: only depth separates. Fingers, stairs, blobs and single pixels stand before a slanted
// surface, by more than twice its slope per pixel and the tolerance.
TEST(Support, StepsOnSlantedSurfacesAreNeverCrossed) {
  const auto shapes = std::array{+[](int x, int y) { return y > 8 && x % 16 > 8 && x % 16 < 13; },  // fingers
                                 +[](int x, int) { return x >= 40; },                               // one edge
                                 +[](int x, int y) { return 2 * x > 3 * y; },                       // a slanting edge
                                 +[](int x, int y) { return Hash(x / 5, y / 5) % 3 == 0; },         // blobs
                                 +[](int x, int y) { return (x + y) % 24 == 0; },  // a wire one pixel wide
                                 +[](int x, int y) { return std::hypot(x - 40.0, y - 28.0) < 14.5; }};  // a disc
  for (const auto shape : shapes) {
    for (const glm::vec2 slope :
         {glm::vec2(0), glm::vec2(0.005f, 0), glm::vec2(0.002f, 0.005f), glm::vec2(0.03f, -0.02f)}) {
      for (const double tolerance : {0.0, 1e-4, 2e-3, 1e-2}) {
        const float step =
            1.05f * (2.0f * (std::fabs(slope.x) + std::fabs(slope.y)) + static_cast<float>(tolerance) * 6.0f) + 0.001f;
        GuideSet guides = MakeGuides(80, 56, [](int, int) { return glm::vec3(0, 0, 1); });
        std::vector<std::uint8_t> front(guides.pixel_count());
        for (int y = 0; y < 56; ++y) {
          for (int x = 0; x < 80; ++x) {
            const std::size_t i = guides.Index(x, y);
            front[i] = shape(x, y);
            guides.Plane(Layer::kDepth)[i] = 4.0f + slope.x * x + slope.y * y - (front[i] ? step : 0.0f);
          }
        }
        for (const int radius : {1, 8}) {
          EXPECT_EQ(Ghosts(guides, front, radius, tolerance, true), 0u)
              << "slope " << slope.x << ", " << slope.y << " step " << step << " tolerance " << tolerance;
          EXPECT_GT(Ghosts(guides, front, radius, tolerance, false), 50u) << "plain voting mixes, as it should";
        }
      }
    }
  }
}

// The slanted surface itself goes on being one: votes are as many as without edges.
TEST(Support, SlopesAndCurvesAreNoSteps) {
  for (const double bend : {0.0, 1e-4, 1e-3}) {
    GuideSet guides = MakeGuides(70, 50, [](int, int) { return glm::vec3(0, 0, 1); });
    for (int y = 0; y < 50; ++y) {
      for (int x = 0; x < 70; ++x) {
        guides.Plane(Layer::kDepth)[guides.Index(x, y)] =
            static_cast<float>(6.0 + 0.01 * x + 0.004 * y + bend * (x * x - 0.5 * y * y + 0.3 * x * y));
      }
    }
    internal::LazyDepthGradient slopes(guides);
    const internal::EdgeRules edges{guides, slopes, 60.0, 0.002};
    const Picture paint = NoisePicture(300);
    const PreparedExemplar exemplar(paint, 0.0, 300);
    SourceField field = RoughField(guides, 300);
    std::fill(field.exemplar.begin(), field.exemplar.end(), std::uint8_t{0});
    const Region inside{6, 6, 64, 44};  // at the picture's border slopes are not known
    EXPECT_EQ(EngineVote(guides, field, exemplar, 4, &edges, inside).rgba,
              EngineVote(guides, field, exemplar, 4, nullptr, inside).rgba)
        << bend;
  }
}

}  // namespace
}  // namespace scumble
