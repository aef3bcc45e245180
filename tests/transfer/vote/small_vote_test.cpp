// Votes in small windows, made 64 pixels at a time, against the plain form: equal bytes for every width, radius,
// instruction set and number of threads.
#include "transfer/vote/small_vote.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

// Fields, guides and paint as rough as they come, all from one number.
struct SmallCase {
  int width = 0, height = 0;
  GuideSet guides;
  SourceField field;
  std::vector<std::uint8_t> active, covered;
  std::optional<PreparedExemplar> exemplar;
};

enum class PaintKind { kOpaque, kExtreme, kMixed, kTransparent };
enum class CoverKind { kAll, kNone, kOne, kHoles, kStripes };

std::uint16_t AlphaOf(PaintKind paint, std::uint64_t hash) {
  const bool any = paint == PaintKind::kTransparent || (paint == PaintKind::kMixed && hash % 8 == 0);
  if (!any) return 65535;
  return hash / 8 % 3 == 0 ? 0 : static_cast<std::uint16_t>(hash);
}

Picture PaintOf(int size, PaintKind paint, std::uint64_t seed) {
  Picture picture(size, size);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    const std::uint64_t hash = Hash(seed, i);
    constexpr std::uint16_t kEnds[] = {0, 1, 32767, 32768, 65534, 65535};
    picture.rgba[i] = paint == PaintKind::kExtreme ? kEnds[hash % 6] : static_cast<std::uint16_t>(hash);
    if (i % 4 == 3) picture.rgba[i] = AlphaOf(paint, hash);
  }
  return picture;
}

bool CoveredAt(CoverKind cover, int x, int y, int width, int height, std::uint64_t seed) {
  if (cover == CoverKind::kOne) return x == width / 2 && y == height / 2;
  if (cover == CoverKind::kHoles) return Hash(seed, x / 5, y / 3) % 7 != 0;
  if (cover == CoverKind::kStripes) return (x + 2 * y) / 40 % 2 == 0;
  return cover == CoverKind::kAll;
}

SmallCase MakeCase(int width, int height, int size, PaintKind paint, CoverKind cover, int exemplars,
                   std::uint64_t seed) {
  SmallCase made;
  made.width = width, made.height = height;
  made.guides = MakeGuides(width, height, [&](int x, int y) {
    if (!CoveredAt(cover, x, y, width, height, seed)) return glm::vec3(0.0f);
    return glm::normalize(glm::vec3(std::sin(x * 0.2f), std::cos(y * 0.15f), 0.6f));
  });
  made.field.Reset(width, height);
  made.active.assign(made.guides.pixel_count(), 0);
  made.covered = made.active;
  std::vector<Picture> pictures;
  for (int k = 0; k < exemplars; ++k) pictures.push_back(PaintOf(size, paint, Hash(seed, k)));
  std::vector<const Picture*> pointers;
  for (const Picture& picture : pictures) pointers.push_back(&picture);
  made.exemplar.emplace(pointers, seed % 2 ? 0.0 : 1.5, size);
  const std::vector<Source> usable = made.exemplar->UsablePixels();
  const float odd[] = {
      0.0f,  1e30f,   1e-38f,  std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
      -3.0f, 3.4e38f, -3.4e38f};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = made.guides.Index(x, y);
      const std::uint64_t block = Hash(seed, x / 6, y / 9);
      float& depth = made.guides.Plane(Layer::kDepth)[i];
      depth = 5.0f + 0.02f * x - 0.013f * y + 0.05f * static_cast<float>(block % 3);
      if (block % 16 == 5) depth = odd[Hash(seed, x, y) % std::size(odd)];
      made.guides.Plane(Layer::kObject)[i] = x + y > width ? 1.0f : 2.0f;
      if (block % 32 == 7)
        made.guides.Plane(Layer::kNormal, int(block / 32 % 3))[i] = odd[Hash(seed, y, x) % std::size(odd)];
      if (!(made.guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      made.covered[i] = 1;
      made.active[i] = seed % 3 != 0 || Hash(seed, x / 11, y / 13) % 4 != 0;
      if (!made.active[i]) continue;
      // Chunks of 1 to 40 pixels a side, from anywhere on the disc, near the rim too.
      const int side = 1 + static_cast<int>(Hash(seed, y / 16) % 4) * 13;
      const std::uint64_t chunk = Hash(seed, x / side, y / side, 3);
      const Source& at = usable[chunk % usable.size()];
      const Source moved{at.x + x % side, at.y + y % side};
      const Source own = made.exemplar->Usable(moved.x, moved.y) ? moved : at;
      made.field.Set(i, own.x, own.y, int(chunk >> 40) % exemplars, 1);
    }
  }
  return made;
}

struct Variant {
  int radius = 0;
  bool edges = false;
  bool tell_covered = false;
  double crease = 60.0, tolerance = 0.002;
  Region region;
  int threads = 1;
};

template <class Voter>
Picture Voted(const SmallCase& given, const Variant& way, const Voter& voter) {
  Picture out(given.width, given.height);
  std::fill(out.rgba.begin(), out.rgba.end(), std::uint16_t{4711});  // unpainted pixels stay
  internal::LazyDepthGradient slopes(given.guides);
  internal::EdgeRules edges{given.guides, slopes, way.crease, way.tolerance};
  if (way.tell_covered) edges.covered = given.covered;
  const Progress unheard;
  internal::RowProgress progress(unheard, 0.0, 1.0, given.height);
  const internal::VoteInput input{given.field, given.active, *given.exemplar, way.radius, way.edges ? &edges : nullptr,
                                  way.region};
  tbb::task_arena arena(way.threads);
  arena.execute([&] { EXPECT_TRUE(voter(input, out, progress)); });
  return out;
}

void ExpectPlain(const SmallCase& given, const Variant& way, const std::string& told) {
  const Picture plain = Voted(given, way, internal::VotePlainly), fast = Voted(given, way, internal::VoteSmall);
  if (plain.rgba == fast.rgba) return;
  for (std::size_t i = 0; i < plain.rgba.size(); ++i) {
    ASSERT_EQ(fast.rgba[i], plain.rgba[i])
        << told << ", radius " << way.radius << ", edges " << way.edges << ", pixel " << i / 4 % given.width << ", "
        << i / 4 / given.width << " channel " << i % 4;
  }
}

// Runs check() with each instruction set that this machine has.
template <class Check>
void OnEveryTarget(const Check& check) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    check(std::string(hwy::TargetName(target)));
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(SmallVote, EqualsThePlainVoteAtEveryRadiusAndTarget) {
  std::uint64_t seed = 1;
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 70}, {70, 1}, {3, 5}, {64, 33}, {65, 40}, {127, 64}, {191, 37}}) {
    for (const CoverKind cover :
         {CoverKind::kAll, CoverKind::kHoles, CoverKind::kStripes, CoverKind::kOne, CoverKind::kNone}) {
      for (const PaintKind paint :
           {PaintKind::kOpaque, PaintKind::kExtreme, PaintKind::kMixed, PaintKind::kTransparent}) {
        const SmallCase given =
            MakeCase(width, height, 20 + 31 * int(seed % 4), paint, cover, 1 + int(seed / 2 % 3), seed);
        ++seed;
        Variant way;
        way.region = {0, 0, width, height};
        way.tell_covered = seed % 2 == 0;
        way.crease = seed % 5 == 0 ? 180.0 : 60.0;
        way.tolerance = seed % 7 == 0 ? 0.0 : 0.002;
        for (int radius = 0; radius <= internal::kSmallRadius; ++radius) {
          way.radius = radius;
          for (const bool edges : {false, true}) {
            way.edges = edges && radius > 0;
            const Picture plain = Voted(given, way, internal::VotePlainly);
            OnEveryTarget([&](const std::string& target) {
              if (Voted(given, way, internal::VoteSmall).rgba == plain.rgba) return;
              ExpectPlain(given, way, target + " at " + std::to_string(width) + "×" + std::to_string(height));
            });
            if (HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

TEST(SmallVote, RegionsAndThreadsMakeNoDifference) {
  // Wider than a tile, so that tiles meet inside.
  const SmallCase given = MakeCase(2200, 75, 90, PaintKind::kMixed, CoverKind::kHoles, 2, 7);
  for (const Region& region :
       {Region{0, 0, 2200, 75}, Region{13, 21, 57, 44}, Region{64, 32, 128, 64}, Region{63, 31, 2111, 65},
        Region{2047, 0, 2050, 75}, Region{2199, 74, 2200, 75}, Region{}}) {
    for (const int radius : {0, 1}) {
      for (const int threads : {1, 2, 3}) {
        ExpectPlain(given, {radius, radius > 0, false, 60.0, 0.002, region, threads},
                    "threads " + std::to_string(threads));
        if (HasFatalFailure()) return;
      }
    }
  }
}

// Opaque paint in every sum that nine votes of the ends of the range can have.
TEST(SmallVote, MeansAreRoundedAsWeighedOnesAre) {
  const SmallCase given = MakeCase(300, 200, 120, PaintKind::kExtreme, CoverKind::kAll, 1, 11);
  OnEveryTarget([&](const std::string& target) {
    ExpectPlain(given, {1, false, false, 60.0, 0.002, {0, 0, 300, 200}, 1}, target);
  });
}

TEST(SmallVote, StopsWhenAsked) {
  const SmallCase given = MakeCase(100, 100, 50, PaintKind::kOpaque, CoverKind::kAll, 1, 5);
  Picture out(100, 100);
  const Progress stop = [](double) { return false; };
  internal::RowProgress progress(stop, 0.0, 1.0, 100);
  const internal::VoteInput input{given.field, given.active, *given.exemplar, 1, nullptr, {0, 0, 100, 100}};
  EXPECT_FALSE(internal::VoteSmall(input, out, progress));
}

}  // namespace
}  // namespace scumble
