// Matchers: each fills a SourceField. All run inside the caller's oneTBB arena, write only wanted active pixels of
// `region`, and leave the others unchanged. False: the progress callback cancelled.
#pragma once

#include <cstdint>
#include <span>

#include "core/filter/parallel.h"
#include "core/image/guides.h"
#include "transfer/exemplar/guide_space.h"
#include "transfer/exemplar/illumination.h"
#include "transfer/nearest/guide_distance.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/seeds/seeds.h"
#include "transfer/source_field.h"

namespace scumble::internal {

// The guide values of one pixel of the scene.
struct PixelGuide {
  glm::vec3 normal;
  float light;                                // exposed luminance, for the choice of exemplars
  float extra_values[GuideSpace::kMaxExtra];  // the extra dimensions of a GuideSpace; only with one
};

// The input of a match. `field` has the picture's size already.
struct MatchInput {
  const GuideSet& guides;
  // 1: a pixel that this style paints. Empty where there is no such plane: then `covered` replaces it, and only Paints
  // reads it.
  std::span<const std::uint8_t> active;
  const PreparedExemplar& exemplar;
  const Illumination& illumination;
  std::span<const float> luminance;  // exposed; empty where the illumination is not active
  GuideTest test;
  SeedRules seeds;
  int levels = 1;  // effective, at the output's size
  double variety_degrees = 0.0;
  int flat_reach = 16;  // pixels around a seed that must be flat for `variety`
  Region region;
  std::span<const std::uint8_t> wanted = {};  // 1: active pixels to match; empty: all of them
  int least_level = 1;                        // finer grids of seeds are left out
  const GuideSpace* space = nullptr;          // null: matches by normals alone, with weight 1
  float brightness = 1.0f;                    // of the scene's radiance in that space
  // Pixels of coverage above 0 that this style paints; without painters it paints all.
  struct Covered {
    std::span<const float> coverage;
    std::span<const std::uint16_t> painters;  // by pixel, as a StyleMap has them
    int style = 0;
  } covered = {};

  bool Paints(std::size_t i) const {
    if (!active.empty()) return active[i] != 0;
    return covered.coverage[i] > 0.0f && (covered.painters.empty() || covered.painters[i] == covered.style);
  }
  bool Wants(std::size_t i) const { return wanted.empty() ? active[i] != 0 : wanted[i] != 0; }
  float LuminanceAt(std::size_t i) const { return luminance.empty() ? 0.0f : luminance[i]; }

  void ReadGuide(std::size_t i, PixelGuide& guide) const {
    guide.normal = exemplar.WithinRim(guides.Vec3(Layer::kNormal, i));
    guide.light = LuminanceAt(i);
    if (space) space->Read(guides, i, brightness, guide.extra_values);
  }

  // The source in exemplar k that is nearest to a guide.
  Source NearestTo(const PixelGuide& guide, int k) const {
    return space ? space->Nearest(k, guide.normal, guide.extra_values) : exemplar.NearestNeighbour(guide.normal);
  }

  // Whether a pixel may show `at` of exemplar k, its light included. Its normal is compared after the guide offset
  // `guide_offset` is added.
  bool Alike(const PixelGuide& guide, glm::vec3 guide_offset, Source at, int k) const {
    const float extra = illumination.Error(guide.light, k);
    if (space) return space->Alike(test, k, guide.normal + guide_offset, guide.extra_values, at, extra);
    return test.Alike(guide.normal + guide_offset, exemplar.Normal(at.x, at.y), extra);
  }
  // Whether no source in the exemplar is within the threshold of a seed, `best` being the nearest: for example a shadow
  // on a surface towards the light, where the exemplar shows all such surfaces lit. Its chunk would contain no pixel.
  // Instead the pixels around it are compared with the seed's own difference as a guide offset. Normals alone are
  // always compared directly.
  bool IsOff(const PixelGuide& seed, Source best, int k) const {
    return space && space->extra_dimensions() > 0 && !space->Alike(test, k, seed.normal, seed.extra_values, best, 0.0f);
  }
  void OffsetGuide(const PixelGuide& seed, Source best, int k, PixelGuide& guide) const {
    guide.normal += exemplar.Normal(best.x, best.y) - seed.normal;
    const float* there = space->ExtraValuesAt(k, best);
    for (int d = 0; d < space->extra_dimensions(); ++d) guide.extra_values[d] += there[d] - seed.extra_values[d];
  }

  // The distance that is compared with the threshold there.
  float Distance(const PixelGuide& guide, glm::vec3 guide_offset, Source at, int k) const {
    const float extra = illumination.Error(guide.light, k);
    if (space) return space->Distance(test, k, guide.normal + guide_offset, guide.extra_values, at) + extra;
    return test.Distance(guide.normal + guide_offset, exemplar.Normal(at.x, at.y)) + extra;
  }
};

// A candidate source for a pixel: the nearest neighbour to its guide, in the exemplar that suits its light.
struct Candidate {
  Source source;
  int exemplar = 0;
  glm::vec3 guide_offset{0.0f};  // guide offset of the seed's source: the pixel's own guide is shifted equally
};
Candidate OwnCandidate(const MatchInput& input, std::size_t pixel);
Candidate OwnCandidate(const MatchInput& input, const PixelGuide& guide);  // for a pixel whose guide has been read

// Every pixel takes its own nearest neighbour.
bool MatchLitSphere(const MatchInput& input, SourceField& field, RowProgress& progress);

// Parallel StyleBlit, from coarse to fine: the nearest seed q has the source u*; pixel p takes u* + (p - q) if that is
// usable and its guide is like p's, light included. A seed outside the picture or on an inactive pixel fails its level.
// If no level accepts, p takes its own u*. The plain form is written for reading and does everything. The SIMD form
// does sixteen pixels at once, cannot match in a GuideSpace, and gives equal bytes.
bool MatchStyleBlitPlain(const MatchInput& input, SourceField& field, RowProgress& progress);
bool MatchStyleBlitTiles(const MatchInput& input, SourceField& field, RowProgress& progress);
inline bool MatchStyleBlit(const MatchInput& input, SourceField& field, RowProgress& progress) {
  return input.space ? MatchStyleBlitPlain(input, field, progress) : MatchStyleBlitTiles(input, field, progress);
}

// StyleBlit with seeds on the surface (transfer/seeds/surface_seeds.h): guides need pref, depth and object ids. Seeds
// depend on all active pixels of the picture, whatever the region.
bool MatchCoherent(const MatchInput& input, SourceField& field, RowProgress& progress);

// Sýkora's algorithm 1: the first free pixel in row order is the next anchor; its u* is tried on every free pixel of
// the picture by the rule above. One thread, O(chunks × pixels).
bool MatchBruteForce(const MatchInput& input, SourceField& field, RowProgress& progress);

}  // namespace scumble::internal
