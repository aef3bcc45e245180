// Voting chunk by chunk in large windows against the definition, vote by vote.
#include "transfer/vote/wide/wide_vote.h"

#include <hwy/targets.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/transfer_fixtures.h"
#include "transfer/exemplar/usable_rows.h"
#include "transfer/vote/tone_texture_split.h"

namespace scumble {
namespace {

using namespace testing;

struct WideCase {
  GuideSet guides;
  SourceField field;
  std::vector<std::uint8_t> active;
  PreparedExemplar exemplar;

  internal::VoteInput Input(int radius, const Region& region) const {
    return {field, active, exemplar, radius, nullptr, region};
  }
};

// The definition.
Picture PlainVotes(const internal::VoteInput& input) {
  Picture out(input.field.width, input.field.height);
  const Progress unheard;
  internal::RowProgress progress(unheard, 0.0, 1.0, 1);
  EXPECT_TRUE(internal::VotePlainly(input, out, progress));
  return out;
}

Picture WideVotes(const internal::VoteInput& input, int threads = 1) {
  Picture out(input.field.width, input.field.height);
  const Progress unheard;
  internal::RowProgress progress(unheard, 0.0, 1.0, 1);
  tbb::task_arena(threads).execute([&] { EXPECT_TRUE(internal::WideVote(input, out, progress)); });
  return out;
}

// What the chunks look like.
enum class Pieces { kOne, kLarge, kSmall, kNoise, kMixed };

Source PieceAt(Pieces pieces, int x, int y) {
  switch (pieces) {
    case Pieces::kOne:
      return {};
    case Pieces::kLarge: {
      const std::uint64_t hash = Hash((x + y / 3) / 37, (y - x / 5) / 29, 1);
      return {int(hash % 40), int(hash / 64 % 40)};
    }
    case Pieces::kSmall: {
      const std::uint64_t hash = Hash(x / 3, y / 4, 2);
      return {int(hash % 7), int(hash / 64 % 7)};
    }
    case Pieces::kNoise:
      return {int(Hash(x, y, 3) % 50), int(Hash(x, y, 4) % 50)};
    case Pieces::kMixed:
      return PieceAt(Pieces(1 + Hash(x / 50, y / 40) % 3), x, y);
  }
  return {};
}

// Pixels of the field take their paint from a square of `size` texels, repeated; `holes` of 64 blocks are inactive.
void FillField(WideCase& all, Pieces pieces, int size, int exemplars, int holes) {
  const int width = all.guides.width(), height = all.guides.height();
  all.field.Reset(width, height);
  all.active.assign(all.guides.pixel_count(), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (int(Hash(x / 9, y / 7, 5) % 64) < holes) continue;
      const Source shift = PieceAt(pieces, x, y);
      Source source{(x + shift.x) % size, (y + shift.y) % size};
      // A pixel's own source is usable, by the contract of matching.
      while (!all.exemplar.Usable(source.x, source.y)) source = {(source.x + size / 2) / 2, (source.y + size / 2) / 2};
      const std::size_t i = all.field.Index(x, y);
      all.field.Set(i, source.x, source.y, exemplars > 1 ? int(Hash(x / 31, y / 23, 6) % exemplars) : 0,
                    int(Hash(x / 17, y / 19, 7) % 9));
      all.active[i] = 1;
    }
  }
}

std::vector<Picture> Paints(int size, int count, bool opaque) {
  std::vector<Picture> paints;
  for (int k = 0; k < count; ++k) {
    paints.push_back(Picture(size, size));
    for (std::size_t i = 0; i < paints[k].rgba.size(); ++i) {
      const bool alpha = i % 4 == 3;
      const std::uint64_t hash = Hash(i, k);
      paints[k].rgba[i] = static_cast<std::uint16_t>(alpha && (opaque || hash % 5 > 1) ? 65535
                                                     : hash % 7 == 0                   ? 65535
                                                                                       : hash);
      if (alpha && !opaque && hash % 5 == 0) paints[k].rgba[i] = 0;
    }
  }
  return paints;
}

PreparedExemplar Prepared(const std::vector<Picture>& paints, double rim) {
  std::vector<const Picture*> pointers;
  for (const Picture& paint : paints) pointers.push_back(&paint);
  return PreparedExemplar(pointers, rim, paints.front().width);
}

WideCase MakeCase(int width, int height, Pieces pieces, int size, int exemplars, bool opaque, int holes) {
  WideCase made{GuideSet(width, height), {}, {}, Prepared(Paints(size, exemplars, opaque), 1.0)};
  FillField(made, pieces, size, exemplars, holes);
  return made;
}

Region Whole(const WideCase& all) { return {0, 0, all.guides.width(), all.guides.height()}; }

// White paint at one pixel of a black chunk.
TEST(WideVote, AChunkVotesOverOneCellOfItsGrid) {
  Picture paint(128, 128);
  std::fill(paint.rgba.begin(), paint.rgba.end(), std::uint16_t{65535});
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 64; ++x) std::fill_n(paint.At(x, y), 3, std::uint16_t{0});
  }
  for (int level = 0; level <= 4; ++level) {
    WideCase all{GuideSet(31, 31), {}, std::vector<std::uint8_t>(31 * 31, 1), Prepared({paint}, 0.0)};
    all.field.Reset(31, 31);
    for (int i = 0; i < 31 * 31; ++i) all.field.Set(std::size_t(i), 30 + i % 31, 45 + i / 31, 0, 6);
    all.field.Set(all.field.Index(15, 15), 85, 64, 0, level);
    for (const int radius : {2, 3, 8}) {
      const Picture painted = WideVotes(all.Input(radius, Whole(all)));
      const int reach = std::min(radius, 1 << level);
      for (int y = 0; y < 31; ++y) {
        for (int x = 0; x < 31; ++x) {
          const bool reached = std::max(std::abs(x - 15), std::abs(y - 15)) <= reach;
          ASSERT_EQ(painted.At(x, y)[0] > 0, reached) << x << ", " << y << ", level " << level << ", radius " << radius;
        }
      }
    }
  }
}

TEST(WideVote, EqualsTheDefinitionForEveryRadius) {
  const WideCase all = MakeCase(83, 71, Pieces::kLarge, 200, 1, true, 9);
  for (int radius = 0; radius <= 64; radius += radius < 10 ? 1 : 9) {
    const internal::VoteInput input = all.Input(radius, Whole(all));
    EXPECT_EQ(WideVotes(input).rgba, PlainVotes(input).rgba) << radius;
  }
}

TEST(WideVote, EqualsTheDefinitionForEveryKindOfField) {
  for (const Pieces pieces : {Pieces::kOne, Pieces::kLarge, Pieces::kSmall, Pieces::kNoise, Pieces::kMixed}) {
    for (const int size : {16, 17, 40, 300}) {
      for (const int exemplars : {1, 3}) {
        for (const bool opaque : {true, false}) {
          const WideCase all = MakeCase(140, 75, pieces, size, exemplars, opaque, 4);
          for (const int radius : {3, 8}) {
            const internal::VoteInput input = all.Input(radius, Whole(all));
            ASSERT_EQ(WideVotes(input).rgba, PlainVotes(input).rgba)
                << int(pieces) << ", exemplar " << size << " × " << exemplars << ", opaque " << opaque << ", radius "
                << radius;
          }
        }
      }
    }
  }
}

// The largest sums that there are: white texels only, and the widest window.
TEST(WideVote, SumsHaveRoom) {
  Picture white(300, 300);
  std::fill(white.rgba.begin(), white.rgba.end(), std::uint16_t{65535});
  WideCase all{GuideSet(260, 256), {}, {}, Prepared({white}, 0.0)};
  FillField(all, Pieces::kLarge, 200, 1, 0);
  const internal::VoteInput input = all.Input(internal::kWidestRadius, {125, 125, 132, 130});
  const Picture found = WideVotes(input);
  EXPECT_EQ(found.rgba, PlainVotes(input).rgba);
  EXPECT_EQ(found.At(128, 127)[0], 65535);
}

TEST(WideVote, PicturesOfAnyShape) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 90}, {200, 1}, {64, 64}, {65, 63}, {63, 130}, {129, 2}}) {
    const WideCase all = MakeCase(width, height, Pieces::kMixed, 120, 2, true, 6);
    for (const int radius : {3, 20}) {
      const internal::VoteInput input = all.Input(radius, Whole(all));
      EXPECT_EQ(WideVotes(input).rgba, PlainVotes(input).rgba) << width << " × " << height << ", " << radius;
    }
  }
}

TEST(WideVote, RegionsThreadsAndAFewActivePixels) {
  WideCase all = MakeCase(210, 150, Pieces::kMixed, 150, 2, true, 30);
  for (const Region& region :
       {Region{0, 0, 210, 150}, Region{13, 21, 57, 44}, Region{100, 0, 209, 149}, Region{5, 5, 5, 9}}) {
    const internal::VoteInput input = all.Input(9, region);
    const Picture expected = PlainVotes(input);
    for (const int threads : {1, 2, 3}) EXPECT_EQ(WideVotes(input, threads).rgba, expected.rgba) << threads;
  }
  std::fill(all.active.begin(), all.active.end(), std::uint8_t{0});
  EXPECT_EQ(WideVotes(all.Input(9, Whole(all))).rgba, Picture(210, 150).rgba);
  all.active[all.field.Index(209, 149)] = 1;
  all.field.Set(all.field.Index(209, 149), 75, 70, 0, 1);
  EXPECT_EQ(WideVotes(all.Input(9, Whole(all))).rgba, PlainVotes(all.Input(9, Whole(all))).rgba);
}

// A rectangle reported as usable is usable; and most of the middle of a sphere is reported so.
TEST(UsableRows, RectanglesThatAreUsable) {
  for (const int size : {1, 2, 5, 16, 33}) {
    const PreparedExemplar exemplar = Prepared(Paints(size, 1, true), 1.0);
    const internal::UsableRows usable(exemplar);
    for (int k = 0; k < 4000; ++k) {
      const int x = int(Hash(k, 1) % (size + 4)) - 2, y = int(Hash(k, 2) % (size + 4)) - 2;
      const Region texels{x, y, x + int(Hash(k, 3) % (size + 2)), y + int(Hash(k, 4) % (size + 2))};
      bool all = !texels.empty();
      for (int v = texels.y0; v < texels.y1; ++v) {
        for (int u = texels.x0; u < texels.x1; ++u) all = all && exemplar.Usable(u, v);
      }
      EXPECT_EQ(usable.AllOf(texels), all) << size << ": " << x << ", " << y << " … " << texels.x1 << ", " << texels.y1;
    }
  }
}

// A painted scene is usable in any shape, also in several spans a row.
TEST(WideVote, ExemplarsOfAnyShape) {
  const Picture paint = NoisePicture(120);
  const GuideSet shape = MakeGuides(120, 120, [](int x, int y) {
    return x % 40 < 31 && (x + y) % 50 < 44 ? glm::normalize(glm::vec3(x - 60, y - 60, 60)) : glm::vec3(0.0f);
  });
  const Picture* const pictures[] = {&paint};
  auto exemplar = PreparedExemplar::OfScene(pictures, shape, 1.0, 120, 120, "scene");
  ASSERT_TRUE(exemplar.ok());
  WideCase all{GuideSet(130, 90), {}, {}, *exemplar};
  all.field.Reset(130, 90);
  all.active.assign(130 * 90, 0);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 130; ++x) {
      const std::uint64_t shift = Hash(x / 17, y / 19);
      const Source source{(x + int(shift % 90)) % 120, (y + int(shift / 128 % 90)) % 120};
      if (!all.exemplar.Usable(source.x, source.y)) continue;
      all.field.Set(all.field.Index(x, y), source.x, source.y, 0, 1);
      all.active[all.field.Index(x, y)] = 1;
    }
  }
  for (const int radius : {3, 12}) {
    const internal::VoteInput input = all.Input(radius, Whole(all));
    EXPECT_EQ(WideVotes(input).rgba, PlainVotes(input).rgba) << radius;
  }
}

TEST(WideVote, SameOnEveryInstructionSet) {
  const WideCase all = MakeCase(150, 100, Pieces::kMixed, 90, 2, true, 8);
  const internal::VoteInput input = all.Input(7, Whole(all));
  const Picture expected = PlainVotes(input);
  for (std::uint32_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & (0u - rest));
    EXPECT_EQ(WideVotes(input).rgba, expected.rgba) << hwy::TargetName(rest & (0u - rest));
  }
  hwy::SetSupportedTargetsForTest(0);
}

// Hills with creases, blocks at hashed depths, objects, and holes; or with values that no scene should have.
void FillGuides(WideCase& all, bool extreme) {
  GuideSet& guides = all.guides;
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kFar = std::numeric_limits<float>::infinity();
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      // Inactive pixels may be covered, by another style; active ones always are.
      guides.Plane(Layer::kCoverage)[i] = all.active[i] || Hash(x / 11, y / 8, 7) % 3 == 0 ? 1.0f : 0.0f;
      const std::uint64_t block = Hash(x / 26, y / 19, 8);
      const glm::vec3 n =
          glm::normalize(glm::vec3(std::sin(x * 0.05f), block % 5 == 0 ? 2.0f : std::cos(y * 0.04f), 0.8f));
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = n[c];
      const float u = static_cast<float>(x), v = static_cast<float>(y);
      guides.Plane(Layer::kDepth)[i] =
          5.0f + 0.01f * u - 0.007f * v + 2e-5f * u * v + 0.04f * static_cast<float>(block / 8 % 3 / 2);
      guides.Plane(Layer::kObject)[i] = x + y > guides.width() ? 1.0f : 2.0f;
      if (!extreme || Hash(x / 13, y / 15, 9) % 4 != 0) continue;
      const float odd[] = {0.0f, 1e30f, 1e-38f, kFar, -kFar, kNaN, -3.0f, 5.0f};
      guides.Plane(Layer::kDepth)[i] = odd[Hash(x, y) % 8];
      guides.Plane(Layer::kNormal, int(Hash(x, y, 1) % 3))[i] = odd[Hash(x, y, 2) % 8];
      if (Hash(x, y, 3) % 9 == 0) guides.Plane(Layer::kObject)[i] = kNaN;
    }
  }
}

std::size_t Different(const Picture& a, const Picture& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) count += a.rgba[i] != b.rgba[i];
  return count;
}

TEST(WideVote, EdgesAreTheDefinitions) {
  for (const bool extreme : {false, true}) {
    for (const Pieces pieces : {Pieces::kLarge, Pieces::kMixed}) {
      for (const bool opaque : {true, false}) {
        WideCase all = MakeCase(120, 80, pieces, 110, 2, opaque, 3);
        FillGuides(all, extreme);
        // Half of them are seen without perspective: 0.002 of 10 m are 0.02 m, of which steps of 0.04 m are none.
        if (opaque == (pieces == Pieces::kMixed)) all.guides.camera = OrthographicCamera(10.0);
        internal::LazyDepthGradient slopes(all.guides);
        for (const int radius : {1, 4, 8, 11}) {
          for (const auto& [crease, tolerance] : {std::pair{60.0, 0.002}, {180.0, 0.0}, {25.0, 0.02}, {180.0, 1.0}}) {
            const internal::EdgeRules rules{all.guides, slopes, crease, tolerance};
            internal::VoteInput input = all.Input(radius, Whole(all));
            input.edges = &rules;
            const Picture found = WideVotes(input);
            ASSERT_EQ(Different(found, PlainVotes(input)), 0u)
                << extreme << int(pieces) << opaque << ", radius " << radius << ", crease " << crease << ", tolerance "
                << tolerance;
            if (!extreme && tolerance < 1.0 && radius > 1) {
              input.edges = nullptr;
              EXPECT_GT(Different(found, WideVotes(input)), 300u) << "edges should matter here";
            }
          }
        }
      }
    }
  }
}

// A step in depth between two columns, at the picture's bottom: windows cross it at every slant.
TEST(WideVote, EdgesAreTheDefinitionsAtEveryColumn) {
  for (int edge = 30; edge < 50; ++edge) {
    WideCase all = MakeCase(80, 56, Pieces::kSmall, 150, 1, true, 0);
    FillGuides(all, false);
    for (int y = 0; y < 56; ++y) {
      for (int x = 0; x < 80; ++x) {
        const std::size_t i = all.guides.Index(x, y);
        all.guides.Plane(Layer::kDepth)[i] = 4.0f + 0.005f * static_cast<float>(x) + (x < edge ? 0.0745f : 0.0f);
        all.guides.Plane(Layer::kObject)[i] = 1.0f;
      }
    }
    internal::LazyDepthGradient slopes(all.guides);
    const internal::EdgeRules rules{all.guides, slopes, 180.0, 0.01};
    internal::VoteInput input = all.Input(8, Whole(all));
    input.edges = &rules;
    EXPECT_EQ(Different(WideVotes(input), PlainVotes(input)), 0u) << edge;
  }
}

TEST(WideVote, EdgesInPicturesOfAnyShapeRegionsAndThreads) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 90}, {200, 1}, {65, 63}, {63, 130}}) {
    WideCase all = MakeCase(width, height, Pieces::kMixed, 120, 2, true, 6);
    FillGuides(all, false);
    internal::LazyDepthGradient slopes(all.guides);
    const internal::EdgeRules rules{all.guides, slopes, 60.0, 0.002};
    for (const int radius : {4, 17, 64}) {
      for (const Region& region : {Whole(all), Region{width / 3, height / 4, width, (height + 1) / 2}}) {
        internal::VoteInput input = all.Input(radius, region);
        input.edges = &rules;
        const Picture expected = PlainVotes(input);
        for (const int threads : {1, 2, 3}) {
          EXPECT_EQ(Different(WideVotes(input, threads), expected), 0u) << width << " × " << height << ", " << radius;
        }
      }
    }
  }
}

TEST(WideVote, EdgesAreTheSameOnEveryInstructionSet) {
  WideCase all = MakeCase(150, 100, Pieces::kMixed, 90, 2, true, 8);
  FillGuides(all, true);
  internal::LazyDepthGradient slopes(all.guides);
  const internal::EdgeRules rules{all.guides, slopes, 60.0, 0.002};
  internal::VoteInput input = all.Input(7, Whole(all));
  input.edges = &rules;
  const Picture expected = PlainVotes(input);
  for (std::uint32_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & (0u - rest));
    EXPECT_EQ(Different(WideVotes(input), expected), 0u) << hwy::TargetName(rest & (0u - rest));
  }
  hwy::SetSupportedTargetsForTest(0);
}

// The callback on finished pixels (here: turned to their negatives, which doing twice undoes) runs once for each, after
// their last write, in every form of voting.
TEST(Vote, TellsOfEveryFinishedPixelOnce) {
  WideCase all = MakeCase(2300, 70, Pieces::kMixed, 150, 1, true, 20);
  all.guides.Add(Layer::kNormal);
  std::ranges::fill(all.guides.Plane(Layer::kNormal, 2), 1.0f);
  const PreparedExemplar tones = MakeBaseLayers(all.exemplar, 2.0);
  const Illumination even_light;
  for (const Region& region : {Whole(all), Region{13, 21, 1100, 66}, Region{2050, 0, 2299, 1}, Region{5, 5, 5, 9}}) {
    for (const int radius : {0, 1, 3, 9}) {
      const auto paint = [&](bool negative, int way) {
        Picture out(all.field.width, all.field.height);
        internal::VoteInput input = all.Input(radius, region);
        const auto turn = [&](int y, int x0, int x1) {
          ASSERT_TRUE(y >= region.y0 && y < region.y1 && x0 >= region.x0 && x1 <= region.x1);
          for (int x = x0; x < x1; ++x) {
            for (int c = 0; c < 4 && all.active[all.field.Index(x, y)]; ++c) out.At(x, y)[c] ^= 0xffff;
          }
        };
        if (negative) input.finished = turn;
        Picture base_votes;
        const Progress unheard;
        internal::RowProgress progress(unheard, 0.0, 1.0, 1);
        tbb::task_arena(2).execute([&] {
          const internal::HybridInput hybrid{input, all.guides, even_light, {}, tones};
          EXPECT_TRUE(way == 0   ? internal::Vote(input, out, progress)
                      : way == 1 ? internal::VotePlainly(input, out, progress)
                                 : internal::VoteHybrid(hybrid, base_votes, out, progress));
        });
        return out;
      };
      for (const int way : {0, 1, 2}) {
        Picture expected = paint(false, way);
        for (int y = region.y0; y < region.y1; ++y) {
          for (int x = region.x0; x < region.x1; ++x) {
            for (int c = 0; c < 4 && all.active[all.field.Index(x, y)]; ++c) expected.At(x, y)[c] ^= 0xffff;
          }
        }
        EXPECT_TRUE(paint(true, way).rgba == expected.rgba) << "way " << way << ", radius " << radius;
      }
    }
  }
}

}  // namespace
}  // namespace scumble
