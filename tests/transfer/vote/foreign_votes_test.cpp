// Votes from other surfaces, whose truth is known: each pixel's true surface is told apart by an id that voting does
// not see, or by paint of its own.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/vote/edge/support_regions.h"
#include "transfer/vote/vote.h"

namespace scumble {
namespace {

using namespace testing;

// A picture and the true surface of each pixel.
struct KnownSurfaces {
  GuideSet guides;  // one object
  std::vector<float> surface;
  std::vector<std::uint8_t> active;
};

KnownSurfaces AsOneObject(GuideSet guides) {
  KnownSurfaces known{std::move(guides), {}, {}};
  const auto id = known.guides.Plane(Layer::kObject), coverage = known.guides.Plane(Layer::kCoverage);
  known.surface.assign(id.begin(), id.end());
  for (const float share : coverage) known.active.push_back(share > 0.0f);
  std::fill(id.begin(), id.end(), 1.0f);
  return known;
}

// A branch with leaves, a sphere of wire and the frame of a chair before walls.
KnownSurfaces StillLifeSurfaces() {
  Expected<Scene> scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/stilllife.glb");
  EXPECT_TRUE(scene);
  Expected<PreparedView> view = PrepareView(*scene, "", std::nullopt, 16.0 / 9.0, false);
  EXPECT_TRUE(view);
  GuidegenOptions options;
  options.width = 192, options.height = 108;
  return AsOneObject(std::move(RenderGuides(*scene, view->camera, options)->guides));
}

// Discs that face the viewer at hashed depths before a slanted wall, and wires that lean by more than the tolerance.
KnownSurfaces DiscsAndWires() {
  GuideSet guides = MakeGuides(200, 120, [](int, int) { return glm::vec3(0, 0, 1); });
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      const auto wall = static_cast<float>(9.0 + 0.004 * x - 0.003 * y);
      guides.Plane(Layer::kDepth)[i] = wall;
      const int column = x / 25, row = y / 24;
      const std::uint64_t cell = Hash(column, row);
      if (std::hypot(x - 25.0 * column - 12.0, y - 24.0 * row - 11.0) < 4.0 + double(cell % 7)) {
        guides.Plane(Layer::kDepth)[i] = 5.0f + 0.3f * static_cast<float>(cell % 10);
        guides.Plane(Layer::kObject)[i] = static_cast<float>(2 + column + 8 * row);
      } else if ((x + 2 * y) % 31 == 0 || (3 * x - y + 1000) % 53 == 0) {
        guides.Plane(Layer::kDepth)[i] = wall - 0.06f;
        guides.Plane(Layer::kObject)[i] = 100.0f;
      }
    }
  }
  return AsOneObject(std::move(guides));
}

struct VoteCount {
  double foreign = 0.0, all = 0.0;
  double share() const { return foreign / all; }
};

VoteCount OfSupportRegions(const KnownSurfaces& known, const internal::EdgeRules& edges, int radius) {
  const Region all{0, 0, known.guides.width(), known.guides.height()};
  const internal::SupportRegions regions(edges, known.active, radius, all);
  VoteCount count;
  for (int y = 0; y < all.y1; ++y) {
    for (int x = 0; x < all.x1; ++x) {
      const std::size_t p = known.guides.Index(x, y);
      if (!known.active[p]) continue;
      regions.ForEach(x, y, [&](std::size_t q, int, int) {
        count.all += 1.0, count.foreign += known.surface[q] != known.surface[p];
      });
    }
  }
  return count;
}

// Each pair of pixels by itself: the two look like one surface over their distance, and so does each step of the
// digital straight line between them.
class StraightLines {
 public:
  StraightLines(const KnownSurfaces& known, const internal::EdgeRules& edges)
      : known_(known), slopes_(edges.slopes.Get()), cosine_(edges.CreaseCosine()), tolerance_(edges.Tolerance()) {}

  VoteCount Count(int radius) const {
    VoteCount count;
    const int width = known_.guides.width(), height = known_.guides.height();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!known_.active[Index({x, y})]) continue;
        for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v) {
          for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u) {
            if (!Joined({x, y}, {u, v})) continue;
            count.all += 1.0, count.foreign += known_.surface[Index({u, v})] != known_.surface[Index({x, y})];
          }
        }
      }
    }
    return count;
  }

 private:
  std::size_t Index(glm::ivec2 p) const { return known_.guides.Index(p.x, p.y); }

  bool LookAlike(glm::ivec2 a, glm::ivec2 b) const {
    const std::size_t p = Index(a), q = Index(b);
    if (!known_.active[p] || !known_.active[q]) return false;
    const glm::vec2 far = b - a;
    const glm::vec2 from(slopes_.x[p], slopes_.y[p]), to(slopes_.x[q], slopes_.y[q]);
    const auto depth = known_.guides.Plane(Layer::kDepth);
    const float expected = 0.5f * glm::dot(from + to, far);
    const float gentler = glm::dot(glm::min(glm::abs(from), glm::abs(to)), glm::abs(far));
    return std::fabs(depth[q] - depth[p] - expected) <= gentler + tolerance_.At(std::min(depth[p], depth[q])) &&
           glm::dot(known_.guides.Vec3(Layer::kNormal, p), known_.guides.Vec3(Layer::kNormal, q)) > cosine_;
  }

  bool Joined(glm::ivec2 p, glm::ivec2 q) const {
    if (p == q) return true;
    if (!LookAlike(p, q)) return false;
    for (glm::ivec2 at = q - p; at != glm::ivec2(0);) {
      const int n = std::max(std::abs(at.x), std::abs(at.y));
      const auto before = [&](int side) { return static_cast<int>(std::round(double(side) * (n - 1) / n)); };
      const glm::ivec2 next(before(at.x), before(at.y));
      if (!LookAlike(p + next, p + at)) return false;
      at = next;
    }
    return true;
  }

  const KnownSurfaces& known_;
  const internal::DepthSlopes& slopes_;
  float cosine_;
  internal::DepthTolerance tolerance_;
};

// Support regions let votes turn a corner; the share of votes from other surfaces stays within twice that of straight
// lines.
TEST(ForeignVotes, AreAtMostTwiceThoseOfStraightLines) {
  for (const KnownSurfaces& known : {StillLifeSurfaces(), DiscsAndWires()}) {
    internal::LazyDepthGradient slopes(known.guides);
    for (const double tolerance : {0.0, 0.002}) {
      const internal::EdgeRules edges{known.guides, slopes, 60.0, tolerance};
      const StraightLines lines(known, edges);
      for (const int radius : {1, 2, 3}) {
        const VoteCount found = OfSupportRegions(known, edges, radius), straight = lines.Count(radius);
        EXPECT_LE(found.share(), 2.0 * straight.share()) << "radius " << radius << ", tolerance " << tolerance;
        EXPECT_GT(found.all, 0.8 * straight.all) << "votes of the surface itself are not given up for it";
      }
    }
  }
}

// Any depths and normals, and objects of hashed pixels, blobs and diagonals: only the ids tell them apart.
GuideSet ScatteredObjects(int width, int height, int kind) {
  GuideSet guides = MakeGuides(width, height, [&](int x, int y) {
    if (Hash(x, y, 5) % 13 == 0) return glm::vec3(0.0f);
    return kind == 0 ? glm::vec3(0, 0, 1) : AnyDirection(Hash(x, y, 6));
  });
  const float odd[] = {
      0.0f, 1e30f, 1e-38f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), -3.0f};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      const std::array<std::uint64_t, 3> object{Hash(x, y, 7) % 4, Hash(x / 6, y / 5, 7) % 5, std::uint64_t(x + y) / 3};
      guides.Plane(Layer::kObject)[i] = 1.0f + static_cast<float>(object[std::size_t(y * 3 / height)] % 5);
      if (kind == 2) guides.Plane(Layer::kDepth)[i] = odd[Hash(x, y, 8) % 6];
    }
  }
  return guides;
}

// Every object has paint of one value of its own, and a pixel that shows another value took a vote from another object.
TEST(ForeignVotes, NoneComesFromAnotherObject) {
  constexpr int kColumns = 90, kRows = 60, kSide = 50, kSize = 300;  // stripes of paint wider than any window
  Picture paint(kSize, kSize);
  for (int i = 0; i < kSize * kSize; ++i) {
    std::uint16_t* texel = paint.At(i % kSize, i / kSize);
    texel[0] = static_cast<std::uint16_t>(1000 * (i % kSize / kSide)), texel[3] = 65535;
  }
  const PreparedExemplar exemplar(paint, 0.0, kSize);
  const Region all{0, 0, kColumns, kRows};
  for (const int kind : {0, 1, 2}) {
    const GuideSet guides = ScatteredObjects(kColumns, kRows, kind);
    const auto object = guides.Plane(Layer::kObject), coverage = guides.Plane(Layer::kCoverage);
    SourceField field;
    field.Reset(kColumns, kRows);
    std::vector<std::uint8_t> active(guides.pixel_count());
    for (std::size_t i = 0; i < active.size(); ++i) {
      active[i] = coverage[i] > 0.0f;
      if (active[i]) field.Set(i, int(object[i]) * kSide - kSide / 2, kSize / 2, 0, int(Hash(i) % 6));
    }
    internal::LazyDepthGradient slopes(guides);
    for (const int radius : {1, 2, 3, 4, 8, 20}) {
      for (const double tolerance : {0.0, 0.002, 1e6}) {
        const internal::EdgeRules edges{guides, slopes, 180.0, tolerance};
        for (const auto vote : {internal::Vote, internal::VotePlainly}) {
          Picture out(kColumns, kRows);
          const Progress unheard;
          internal::RowProgress progress(unheard, 0.0, 1.0, kRows);
          ASSERT_TRUE(vote({field, active, exemplar, radius, &edges, all}, out, progress));
          std::size_t foreign = 0;
          for (std::size_t i = 0; i < active.size(); ++i) {
            foreign += active[i] && out.rgba[4 * i] != 1000 * (int(object[i]) - 1);
          }
          EXPECT_EQ(foreign, 0u) << "kind " << kind << ", radius " << radius << ", tolerance " << tolerance;
        }
      }
    }
  }
}

}  // namespace
}  // namespace scumble
