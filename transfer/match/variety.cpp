#include "transfer/match/variety.h"

#include <algorithm>
#include <cstdlib>

namespace scumble::internal {
namespace {

constexpr float kFlatCosine = 0.99996192f;  // half a degree
// Where a surface is flat for the 16 pixels that IsFlat reads, a seed of this level has been taken already, so choosing
// for the many seeds of finer levels would be wasted. Small pictures have no level this coarse: their coarsest counts.
constexpr int kLeastLevel = 4;
// This much less error of tone (summed over channels of 0 … 65535) is worth the whole band, which is a quarter of the
// level's grid on either side of a border between seeds one grid step apart.
constexpr std::int64_t kToneRange = 19661;

}  // namespace

bool IsFlat(const MatchInput& input, PixelPosition at, int reach) {
  const GuideSet& guides = input.guides;
  const auto object = guides.Plane(Layer::kObject);
  const std::size_t here = guides.Index(at.x, at.y);
  const glm::vec3 normal = guides.Vec3(Layer::kNormal, here);
  const int steps[4][2] = {{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}};
  for (const auto& [dx, dy] : steps) {
    const int x = at.x + dx, y = at.y + dy;
    if (x < 0 || y < 0 || x >= guides.width() || y >= guides.height()) continue;
    const std::size_t there = guides.Index(x, y);
    if (!input.Paints(there) || object[there] != object[here]) return false;
    const glm::vec3 other = guides.Vec3(Layer::kNormal, there);
    if (!(normal.x * other.x + normal.y * other.y + normal.z * other.z > kFlatCosine)) return false;
  }
  return true;
}

bool CanVary(const MatchInput& input, int level, PixelPosition seed) {
  if (!(input.variety_degrees > 0.0) || level < std::min(kLeastLevel - input.seeds.level_offset, input.levels - 1))
    return false;
  return IsFlat(input, seed, std::max(input.flat_reach, 1 << level));
}

Source ChooseAlike(const MatchInput& input, const Candidate& own, int level, std::uint64_t hash) {
  return input.exemplar.source_variation().Choose(
      input.exemplar, {own.source, own.exemplar, input.variety_degrees, 1 << (level - 1), hash});
}

SourceVariation::Tone WantedTone(const MatchInput& input, const Candidate& own, int level) {
  const SourceVariation& variation = input.exemplar.source_variation();
  // The square rounds to whole cells, so that the one around a source at the rim may hold no usable pixel.
  return variation.ToneAround(own.source, own.exemplar, 1 << (level - 1))
      .value_or(variation.ToneAt(own.source, own.exemplar));
}

bool InBorderBand(int level, std::int64_t excess) { return 2 * excess < std::int64_t{1} << (2 * level); }

int ToneError(const MatchInput& input, const Candidate& candidate, const SourceVariation::Tone& wanted) {
  const SourceVariation::Tone tone = input.exemplar.source_variation().ToneAt(candidate.source, candidate.exemplar);
  int sum = 0;
  for (int c = 0; c < 4; ++c) sum += std::abs(tone[c] - wanted[c]);
  return sum;
}

bool SecondWins(int level, std::int64_t excess, int gain_of_tone) {
  return 2 * excess * kToneRange < gain_of_tone * (std::int64_t{1} << (2 * level));
}

}  // namespace scumble::internal
