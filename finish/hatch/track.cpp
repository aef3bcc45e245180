#include "finish/hatch/track.h"

#include <cmath>

namespace scumble::internal {
namespace {

constexpr int kWays = 300;  // all around

glm::vec3 NearestWay(const std::vector<glm::vec3>& ways, glm::vec3 direction) {
  glm::vec3 nearest = ways[0];
  for (const glm::vec3 way : ways) {
    if (std::fabs(glm::dot(way, direction)) > std::fabs(glm::dot(nearest, direction))) nearest = way;
  }
  return nearest;
}

}  // namespace

std::vector<glm::vec3> AllWays() {
  std::vector<glm::vec3> ways;
  for (int i = 0; i < kWays; ++i) {  // a spiral over half a sphere; a plane has no sign
    const double z = (i + 0.5) / kWays, radius = std::sqrt(1.0 - z * z), turn = i * 137.50776405;
    ways.push_back(glm::vec3(radius * CosDegrees(turn), radius * SinDegrees(turn), z));
  }
  return ways;
}

Track TrackOf(const HatchPass& pass, float spacing, glm::vec3 per_x, glm::vec3 per_y, Axis axis,
              const std::vector<glm::vec3>& ways) {
  Track track;
  const float xx = glm::dot(per_x, per_x), xy = glm::dot(per_x, per_y), yy = glm::dot(per_y, per_y);
  const float area = xx * yy - xy * xy;
  if (!(area > 1e-6f * xx * yy) || !(area < 1e30f)) return track;
  // In the surface, what grows by as much a pixel as the place across the strokes does.
  const glm::vec2 wanted(-axis.y, axis.x);
  const glm::vec3 across =
      NearestWay(ways, per_x * (yy * wanted.x - xy * wanted.y) + per_y * (xx * wanted.y - xy * wanted.x));
  const glm::vec3 off = glm::cross(NearestWay(ways, glm::cross(per_x, per_y)), across);
  const float length = std::sqrt(glm::dot(off, off));
  if (!(length > 0.1f)) return track;
  track.is_there = true;
  const glm::vec3 along = off / length;
  for (int k = 0; k < kMostLayers; ++k) {
    const Axis turn = AxisAt(k * pass.cross);
    Track::OfLayer& layer = track.layers[std::size_t(k)];
    layer.across = turn.x * across + turn.y * along, layer.along = turn.x * along - turn.y * across;
    const glm::vec2 slope(glm::dot(per_x, layer.across), glm::dot(per_y, layer.across));
    layer.pixel = std::sqrt(glm::dot(slope, slope));
    layer.axis = layer.pixel > 0.0f ? Axis(slope.y, -slope.x) / layer.pixel : axis;
    const double level = Log2(layer.pixel * spacing * WiderBy(k)), octave = std::floor(level);
    layer.step = static_cast<float>(Exp2(octave)), layer.coarser = static_cast<float>(level - octave);
    track.is_there = track.is_there && layer.step > 1e-30f;
  }
  return track;
}

}  // namespace scumble::internal
