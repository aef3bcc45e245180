// StyleBlit: Fast Example-Based Stylization with Local Guidance. Daniel Sýkora, Ondřej Jamriška, Ondřej Texler, Jakub
// Fišer, Michal Lukáč, Jingwan Lu, Eli Shechtman. Computer Graphics Forum 38 (2019). Section 3.2, the parallel form.
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/image/hash.h"
#include "transfer/exemplar/paint_by_normal.h"
#include "transfer/match/seed_candidate.h"
#include "transfer/match/variety.h"

namespace scumble::internal {

namespace {

// Variety changes only the direction: the source must have equal light.
Source ChooseInSpace(const MatchInput& input, const Candidate& own, int level, std::uint64_t hash) {
  if (!input.space) return ChooseAlike(input, own, level, hash);
  constexpr int kTries = 16;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Source other = ChooseAlike(input, own, level, attempt == 0 ? hash : Hash(hash, attempt));
    if (input.space->AlikeInExtra(input.test, own.exemplar, own.source, other)) return other;
  }
  return own.source;
}

}  // namespace

bool VarySource(const MatchInput& input, int level, PixelPosition q, std::uint64_t hash, SeedCandidate& made) {
  if (!CanVary(input, level, q)) return false;
  const Source own = made.candidate.source;
  made.candidate.source = ChooseInSpace(input, made.candidate, level, hash);
  made.guide_offset +=
      input.exemplar.Normal(made.candidate.source.x, made.candidate.source.y) - input.exemplar.Normal(own.x, own.y);
  return true;
}

SeedCandidate SeedOf(const MatchInput& input, const PixelGuide& guide, const Candidate& candidate) {
  SeedCandidate made{candidate};
  made.best = candidate.source;
  made.off = input.IsOff(guide, candidate.source, candidate.exemplar);
  return made;
}

std::optional<Candidate> TryCandidate(const MatchInput& input, const SeedCandidate& seed, PixelPosition q,
                                      PixelPosition p, const PixelGuide& guide) {
  const Source candidate{seed.candidate.source.x + (p.x - q.x), seed.candidate.source.y + (p.y - q.y)};
  if (!input.exemplar.Usable(candidate.x, candidate.y)) return std::nullopt;
  if (!seed.off) {
    if (!input.Alike(guide, seed.guide_offset, candidate, seed.candidate.exemplar)) return std::nullopt;
  } else {
    PixelGuide of_seed, offset_guide = guide;
    input.ReadGuide(input.guides.Index(q.x, q.y), of_seed);
    input.OffsetGuide(of_seed, seed.best, seed.candidate.exemplar, offset_guide);
    if (!input.Alike(offset_guide, seed.guide_offset, candidate, seed.candidate.exemplar)) return std::nullopt;
  }
  return Candidate{candidate, seed.candidate.exemplar, seed.guide_offset};
}

namespace {

// The candidate of a seed on the screen.
struct GridCandidate : SeedCandidate {
  int flat = -1;  // index of the wanted tone in the level's tones; -1: the surface is not flat, or variety is 0
};

// The seeds of one level with their candidates; thousands of pixels share each.
struct Level {
  SeedGrid grid;
  std::vector<std::optional<GridCandidate>> candidates;  // empty: outside the picture, or not to be painted
  std::vector<SourceVariation::Tone> tones;  // of the seeds on flat surfaces: that of their best-fitting paint
  // Searches in many dimensions are slow, and most seeds of fine levels are never needed: theirs are made on demand.
  std::unique_ptr<std::once_flag[]> asked;

  Level(const MatchInput& input, int level) : grid(input.seeds, level, input.region), candidates(grid.size()) {
    if (input.space && !(input.variety_degrees > 0.0)) {
      asked = std::make_unique<std::once_flag[]>(grid.size());
      return;
    }
    for (std::size_t s = 0; s < grid.size(); ++s) Fill(input, s);
  }

  const std::optional<GridCandidate>& CandidateOf(const MatchInput& input, std::size_t s) {
    if (asked) std::call_once(asked[s], [&] { Fill(input, s); });
    return candidates[s];
  }

  void Fill(const MatchInput& input, std::size_t s) {
    const PixelPosition q = grid.Position(s);
    if (q.x < 0 || q.y < 0 || q.x >= input.guides.width() || q.y >= input.guides.height()) return;
    const std::size_t i = input.guides.Index(q.x, q.y);
    if (!input.active[i]) return;
    PixelGuide guide;
    input.ReadGuide(i, guide);
    const Candidate own = OwnCandidate(input, guide);
    GridCandidate& made = candidates[s].emplace(GridCandidate{SeedOf(input, guide, own)});
    const int level = grid.level();
    const PixelPosition cell = grid.Cell(s);
    const std::uint64_t hash =
        Hash(input.seeds.seed, input.seeds.time_step, level + input.seeds.level_offset, cell.x, cell.y, 0x7a);
    if (!VarySource(input, level, q, hash, made)) return;
    made.flat = static_cast<int>(tones.size());
    tones.push_back(WantedTone(input, own, level));
  }
};

// The candidate of seed s of this level that p accepts, or none.
std::optional<Candidate> AcceptFrom(const MatchInput& input, Level& level, std::size_t s, int x, int y,
                                    const PixelGuide& guide) {
  const std::optional<GridCandidate>& candidate = level.CandidateOf(input, s);
  if (!candidate) return std::nullopt;
  return TryCandidate(input, *candidate, level.grid.Position(s), {x, y}, guide);
}

// The candidate that p accepts from its nearest seed; near the border of two seeds of a flat surface, from the one that
// suits it better.
std::optional<Candidate> Accept(const MatchInput& input, Level& level, int x, int y, const PixelGuide& guide) {
  if (level.tones.empty()) return AcceptFrom(input, level, level.grid.Nearest(x, y), x, y, guide);
  const auto [s, t, excess] = level.grid.NearestTwo(x, y);
  const std::optional<Candidate> nearest = AcceptFrom(input, level, s, x, y, guide);
  if (!InBorderBand(level.grid.level(), excess)) return nearest;
  if (!nearest || level.candidates[s]->flat < 0 || !level.candidates[t] || level.candidates[t]->flat < 0)
    return nearest;
  const std::optional<Candidate> other = AcceptFrom(input, level, t, x, y, guide);
  if (!other) return nearest;
  const int nearest_off = ToneError(input, *nearest, level.tones[std::size_t(level.candidates[s]->flat)]);
  const int other_off = ToneError(input, *other, level.tones[std::size_t(level.candidates[t]->flat)]);
  return SecondWins(level.grid.level(), excess, nearest_off - other_off) ? other : nearest;
}

}  // namespace

bool MatchStyleBlitPlain(const MatchInput& input, SourceField& field, RowProgress& progress) {
  // Level 0 has a seed on every pixel, so its candidate is the pixel's own nearest neighbour, accepted or not.
  std::vector<Level> levels;
  for (int level = input.levels - 1; level >= input.least_level; --level) levels.emplace_back(input, level);
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = field.Index(x, y);
      if (!input.Wants(i)) continue;
      PixelGuide guide;
      input.ReadGuide(i, guide);
      std::optional<Candidate> candidate;
      int settled = 0;
      for (Level& level : levels) {
        if ((candidate = Accept(input, level, x, y, guide))) {
          settled = level.grid.level();
          break;
        }
      }
      if (!candidate) candidate = OwnCandidate(input, guide);
      field.Set(i, candidate->source.x, candidate->source.y, candidate->exemplar, settled);
      if (!field.guide_offset.empty()) field.guide_offset[i] = candidate->guide_offset;
    }
  });
}

}  // namespace scumble::internal
