#include "style/dark_squares.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

namespace scumble {
namespace {

constexpr float kDarker = 0.9f;

// Which pixels are dark, with a frame of one light pixel around them: no outline runs out of the picture.
struct Mask {
  int width = 0;  // the frame's included
  int height = 0;
  std::vector<std::uint8_t> dark;
};

Mask DarkerThanAround(const GreyPlane& plane, int radius) {
  Mask mask{plane.width + 2, plane.height + 2, {}};
  mask.dark.assign(std::size_t(mask.width) * mask.height, 0);
  // Sums over all that lies above and left of a pixel's corner.
  const std::size_t stride = std::size_t(plane.width) + 1;
  std::vector<double> sums(stride * (plane.height + 1), 0.0);
  for (int y = 0; y < plane.height; ++y) {
    double row = 0;
    for (int x = 0; x < plane.width; ++x) {
      row += plane.At(x, y);
      sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
    }
  }
  for (int y = 0; y < plane.height; ++y) {
    const std::size_t y0 = std::max(0, y - radius), y1 = std::min(plane.height, y + radius + 1);
    for (int x = 0; x < plane.width; ++x) {
      const std::size_t x0 = std::max(0, x - radius), x1 = std::min(plane.width, x + radius + 1);
      const double sum =
          sums[y1 * stride + x1] - sums[y0 * stride + x1] - sums[y1 * stride + x0] + sums[y0 * stride + x0];
      const double mean = sum / double((x1 - x0) * (y1 - y0));
      mask.dark[std::size_t(y + 1) * mask.width + x + 1] = plane.At(x, y) < kDarker * mean;
    }
  }
  return mask;
}

struct Box {
  int x0, y0, x1, y1;  // inclusive
};

// Empties the patch that holds pixel `start`, its pixels marked as seen, and returns its box. Neighbours share a side.
Box TakePatch(Mask& mask, std::size_t start, std::vector<std::size_t>& stack) {
  constexpr std::uint8_t kSeen = 2;
  const int w = mask.width;
  Box box{w, mask.height, 0, 0};
  stack.assign(1, start);
  mask.dark[start] = kSeen;
  while (!stack.empty()) {
    const std::size_t at = stack.back();
    stack.pop_back();
    const int x = int(at % w), y = int(at / w);
    box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y)};
    for (const std::size_t next : {at - 1, at + 1, at - w, at + w}) {
      if (mask.dark[next] == 1) mask.dark[next] = kSeen, stack.push_back(next);
    }
  }
  return box;
}

// The outer outline, clockwise along the pixels' sides, from the upper left corner of the patch's first pixel by rows.
std::vector<glm::dvec2> Outline(const Mask& mask, std::size_t first) {
  const int w = mask.width, start_x = int(first % w), start_y = int(first / w);
  const auto dark = [&](int x, int y) { return mask.dark[std::size_t(y) * w + x] != 0; };
  std::vector<glm::dvec2> points;
  int x = start_x, y = start_y, dx = 1, dy = 0;
  do {
    points.emplace_back(x - 1, y - 1);  // without the mask's frame
    x += dx, y += dy;
    // The pixels ahead of this corner, to the right and to the left of the way.
    const int right_x = x + (dx - dy - 1) / 2, right_y = y + (dx + dy - 1) / 2;
    const int left_x = x + (dx + dy - 1) / 2, left_y = y + (dy - dx - 1) / 2;
    if (!dark(right_x, right_y)) {
      std::swap(dx, dy), dx = -dx;
    } else if (dark(left_x, left_y)) {
      std::swap(dx, dy), dy = -dy;
    }
  } while (x != start_x || y != start_y || dx != 1 || dy != 0);
  return points;
}

double DistanceToLine(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 along = b - a, to = p - a;
  const double length = glm::length(along);
  return length > 0 ? std::abs(along.x * to.y - along.y * to.x) / length : glm::length(to);
}

// Points of an outline between which it stays closer than `tolerance` to straight lines (Ramer, Douglas and Peucker),
// but no more than `most`: then nothing is a quadrilateral any more.
void Simplify(std::span<const glm::dvec2> outline, std::size_t begin, std::size_t end, double tolerance,
              std::size_t most, std::vector<std::size_t>& kept) {
  const auto at = [&](std::size_t i) { return outline[i % outline.size()]; };
  double worst = tolerance;
  std::size_t where = begin;
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double distance = DistanceToLine(at(i), at(begin), at(end));
    if (distance > worst) worst = distance, where = i;
  }
  if (where == begin || kept.size() > most) return;
  Simplify(outline, begin, where, tolerance, most, kept);
  kept.push_back(where % outline.size());
  Simplify(outline, where, end, tolerance, most, kept);
}

std::size_t Farthest(std::span<const glm::dvec2> points, glm::dvec2 from) {
  const auto nearer = [&](glm::dvec2 a, glm::dvec2 b) {
    return glm::dot(a - from, a - from) < glm::dot(b - from, b - from);
  };
  return std::size_t(std::max_element(points.begin(), points.end(), nearer) - points.begin());
}

bool ToQuad(std::span<const glm::dvec2> outline, double tolerance, double least_side, Quad& quad) {
  glm::dvec2 mean(0.0);
  for (const glm::dvec2 p : outline) mean += p / double(outline.size());
  // The point farthest from the middle is a corner, and so is the one farthest from that.
  const std::size_t a = Farthest(outline, mean), b = Farthest(outline, outline[a]);
  const std::size_t low = std::min(a, b), high = std::max(a, b);
  std::vector<std::size_t> kept{low};
  Simplify(outline, low, high, tolerance, 4, kept);
  kept.push_back(high);
  Simplify(outline, high, low + outline.size(), tolerance, 4, kept);
  if (kept.size() != 4) return false;
  for (std::size_t i = 0; i < 4; ++i) quad[i] = outline[kept[i]];
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec2 side = quad[(i + 1) % 4] - quad[i], next = quad[(i + 2) % 4] - quad[(i + 1) % 4];
    const double turn = side.x * next.y - side.y * next.x;
    if (glm::length(side) < least_side || !(turn > 0.25 * glm::length(side) * glm::length(next))) return false;
    if (glm::length(next) > 3.0 * glm::length(side) || glm::length(side) > 3.0 * glm::length(next)) return false;
  }
  return true;
}

}  // namespace

float GreyPlane::Between(glm::dvec2 at) const {
  const double u = std::clamp(at.x - 0.5, 0.0, width - 1.0), v = std::clamp(at.y - 0.5, 0.0, height - 1.0);
  const int x = std::min(int(u), std::max(0, width - 2)), y = std::min(int(v), std::max(0, height - 2));
  const int x1 = std::min(x + 1, width - 1), y1 = std::min(y + 1, height - 1);
  const float fx = float(u - x), fy = float(v - y);
  return (At(x, y) * (1 - fx) + At(x1, y) * fx) * (1 - fy) + (At(x, y1) * (1 - fx) + At(x1, y1) * fx) * fy;
}

std::vector<Quad> FindDarkSquares(const GreyPlane& plane, int radius, double least_side) {
  std::vector<Quad> found;
  if (plane.width < 3 || plane.height < 3) return found;
  Mask mask = DarkerThanAround(plane, radius);
  std::vector<std::size_t> stack;
  for (std::size_t i = 0; i < mask.dark.size(); ++i) {
    if (mask.dark[i] != 1) continue;
    const Box box = TakePatch(mask, i, stack);
    const int wide = box.x1 - box.x0 + 1, tall = box.y1 - box.y0 + 1;
    if (std::min(wide, tall) < least_side) continue;
    // Patches that are the background of the whole picture are not worth the walk.
    if (wide > plane.width * 3 / 4 || tall > plane.height * 3 / 4) continue;
    Quad quad;
    const std::vector<glm::dvec2> outline = Outline(mask, i);
    // Along pixels' sides a convex outline is as long as its box's; twice that is ragged enough.
    if (outline.size() > std::size_t(4) * (wide + tall)) continue;
    if (ToQuad(outline, std::max(1.5, 0.04 * (wide + tall)), least_side, quad)) found.push_back(quad);
  }
  return found;
}

}  // namespace scumble
