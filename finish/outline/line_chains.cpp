#include "finish/outline/line_chains.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "finish/outline/border_grid.h"
#include "finish/outline/line_owners.h"

namespace scumble::internal {
namespace {

constexpr std::uint8_t kTaken = 0x80;  // a border that is in a line already

class Tracer {
 public:
  Tracer(BorderMap& map, const GuideSet& guides, std::span<const float> shadow)
      : grid_(map),
        width_(map.width),
        height_(map.height),
        owner_(guides),
        coverage_(guides.Plane(Layer::kCoverage)),
        shadow_(shadow) {}

  std::vector<LineChain> Trace(double shortest) {
    Prune(shortest);
    std::vector<LineChain> chains;
    const auto add = [&](LineChain chain) {
      const bool is_alone = chain.begin != LineEnd::kJunction && chain.end != LineEnd::kJunction;
      const bool is_noise = double(chain.points.size()) < (chain.closed ? 2.0 * shortest : is_alone ? shortest : 0.0);
      if (!is_noise) chains.push_back(std::move(chain));
    };
    // From ends and junctions first; what is left then are rings.
    grid_.ForEachBorder([&](const Border& border) {
      for (const Corner& corner : BorderGrid::Corners(border)) {
        if (!(At(border) & kTaken) && Degree(corner) != 2) add(Walk(border, corner));
      }
    });
    grid_.ForEachBorder([&](const Border& border) {
      if (!(At(border) & kTaken)) add(Walk(border, BorderGrid::Corners(border)[0]));
    });
    return chains;
  }

 private:
  // Takes short lines with a free end out of the map, so that they do not part the lines that they branch from.
  void Prune(double shortest) {
    std::vector<Border> pruned, line;
    grid_.ForEachBorder([&](const Border& first) {
      for (const Corner& start : BorderGrid::Corners(first)) {
        if (EndAt(start) != LineEnd::kFree) continue;
        line.clear();
        Corner corner = start;
        for (Border border = first; double(line.size()) < shortest;) {
          line.push_back(border);
          corner = BorderGrid::OtherEnd(border, corner);
          if (Degree(corner) != 2) break;
          const Border last = border;
          grid_.ForEachAt(corner, [&](const Border& one) {
            if (!(one == last)) border = one;
          });
        }
        if (double(line.size()) < shortest) pruned.insert(pruned.end(), line.begin(), line.end());
      }
    });
    for (const Border& border : pruned) At(border) = 0;
  }

  std::uint8_t& At(const Border& border) { return grid_.At(border); }

  int Degree(const Corner& corner) {
    int count = 0;
    grid_.ForEachAt(corner, [&](const Border&) { ++count; });
    return count;
  }

  // Of a line that ends in the corner.
  LineEnd EndAt(const Corner& corner) {
    if (Degree(corner) != 1) return LineEnd::kJunction;
    const bool is_at_edge = corner.x == 0 || corner.y == 0 || corner.x == width_ || corner.y == height_;
    return is_at_edge ? LineEnd::kPictureEdge : LineEnd::kFree;
  }

  LineChain Walk(Border border, Corner corner) {
    LineChain chain;
    const Corner start = corner;
    chain.first = {corner.x, corner.y};
    chain.begin = EndAt(corner);
    if (chain.begin == LineEnd::kJunction) chain.begin_contour = ContourAt(corner, border, chain.begins_in_contour);
    for (;;) {
      At(border) |= kTaken;
      corner = BorderGrid::OtherEnd(border, corner);
      chain.points.push_back(PointOf(border));
      Border next{-1, 0, false};
      if (Degree(corner) == 2) {
        grid_.ForEachAt(corner, [&](const Border& one) {
          if (!(At(one) & kTaken)) next = one;
        });
      }
      if (next.x < 0) break;
      border = next;
    }
    chain.last = {corner.x, corner.y};
    chain.closed = corner == start && Degree(start) == 2;
    chain.end = EndAt(corner);
    if (chain.end == LineEnd::kJunction) chain.end_contour = ContourAt(corner, border, chain.ends_in_contour);
    return chain;
  }

  LineClass LineOf(const Border& border) { return static_cast<LineClass>((At(border) & ~kTaken) - 1); }

  static bool HasSide(LineClass line) {
    return line == LineClass::kSilhouette || line == LineClass::kObject || line == LineClass::kOcclusion;
  }

  // Whether the pixel to the right of a border, or below it, is the owner.
  bool IsSecond(const Border& border) const { return owner_.IsSecond(grid_.First(border), grid_.Second(border)); }

  // The contour that passes a junction: two borders that belong to one surface, which lies between them. `end`: the
  // last border of a line there; `is_of_it`: whether it is one of the two.
  std::optional<PassingContour> ContourAt(const Corner& corner, const Border& end, bool& is_of_it) {
    const auto [x, y] = corner;
    // Clockwise from the top. 1: the owner is the next pixel clockwise, -1: the one before, 0: no border with a side.
    const std::array<Border, 4> around = {Border{x - 1, y - 1, true}, Border{x, y - 1, false}, Border{x - 1, y, true},
                                          Border{x - 1, y - 1, false}};
    std::array<int, 4> owners{};
    grid_.ForEachAt(corner, [&](const Border& one) {
      const auto k = std::size_t(std::find(around.begin(), around.end(), one) - around.begin());
      if (HasSide(LineOf(one))) owners[k] = IsSecond(one) == (k < 2) ? 1 : -1;
    });
    for (std::size_t k = 0; k < 4; ++k) {
      if (owners[k] != 1) continue;
      std::size_t next = (k + 1) % 4;
      while (owners[next] == 0) next = (next + 1) % 4;
      if (owners[next] != -1) continue;
      is_of_it = end == around[k] || end == around[next];
      const LinePoint point = PointOf(around[k]);
      const glm::vec2 sum = point.to_owner + PointOf(around[next]).to_owner;
      const float length = std::sqrt(sum.x * sum.x + sum.y * sum.y);
      return PassingContour{length > 0.0f ? sum / length : point.to_owner, point.owner, point.line};
    }
    return std::nullopt;
  }

  LinePoint PointOf(const Border& border) {
    const auto [x, y, is_right] = border;
    const std::size_t p = grid_.First(border), q = grid_.Second(border);
    const bool q_owns = IsSecond(border);
    const glm::vec2 across = is_right ? glm::vec2(1, 0) : glm::vec2(0, 1);  // from p to q
    const LineClass line = LineOf(border);
    const glm::vec2 at = is_right ? glm::vec2(x + 1, y + 0.5f) : glm::vec2(x + 0.5f, y + 1);
    const glm::vec2 to_owner = q_owns ? across : -across;
    const std::size_t owner = q_owns ? q : p;
    float shift = 0.0f;
    if (line == LineClass::kSilhouette) {
      shift = Uncovered(q_owns ? (is_right ? x + 1 : x) : x, q_owns ? (is_right ? y : y + 1) : y, to_owner);
    } else if (line == LineClass::kShadow) {
      const float from = shadow_[p], to = shadow_[q];
      shift = (std::clamp((0.5f - from) / (to - from), 0.0f, 1.0f) - 0.5f) * (q_owns ? 1.0f : -1.0f);
    }
    return {at, to_owner, static_cast<std::uint32_t>(owner), line, HasSide(line), owner_.Meet(p, q), shift};
  }

  // How far behind its border a silhouette runs: what is not covered of the pixels from (x, y) inwards. A line at less
  // than 45 degrees from the border crosses up to three; beyond them, or where the coverage falls again, counting ends.
  float Uncovered(int x, int y, glm::vec2 inwards) const {
    float sum = 0.0f, last = 0.0f;
    for (int k = 0; k < 4; ++k) {
      if (x < 0 || y < 0 || x >= width_ || y >= height_) break;
      const float coverage = std::min(coverage_[std::size_t(y) * std::size_t(width_) + std::size_t(x)], 1.0f);
      if (coverage < last) break;
      sum += 1.0f - coverage;
      if (coverage >= 1.0f) break;
      last = coverage;
      x += static_cast<int>(inwards.x), y += static_cast<int>(inwards.y);
    }
    return sum;
  }

  BorderGrid grid_;
  int width_, height_;
  BorderOwner owner_;
  std::span<const float> coverage_, shadow_;
};

// A Gaussian of sigma 4 borders.
constexpr int kReach = 12;
const std::array<float, kReach + 1>& Weights() {
  // exp(-i² / 32), normalised, as literals: a libm's may differ.
  static constexpr std::array<double, kReach + 1> kExp = {1.0,
                                                          0.9692332344763441,
                                                          0.8824969025845955,
                                                          0.7548396019890073,
                                                          0.6065306597126334,
                                                          0.45783336177161427,
                                                          0.32465246735834974,
                                                          0.2162651668298873,
                                                          0.1353352832366127,
                                                          0.07955950871822769,
                                                          0.04393693362340742,
                                                          0.022794180883612344,
                                                          0.011108996538242306};
  static const std::array<float, kReach + 1> weights = [] {
    double sum = kExp[0];
    for (int i = 1; i <= kReach; ++i) sum += 2.0 * kExp[std::size_t(i)];
    std::array<float, kReach + 1> normal{};
    for (int i = 0; i <= kReach; ++i) normal[std::size_t(i)] = static_cast<float>(kExp[std::size_t(i)] / sum);
    return normal;
  }();
  return weights;
}

// `values` with the chain's continuation on both sides: round it, or turned about its ends.
template <class T>
std::vector<T> Padded(const std::vector<T>& values, bool closed, const T& first, const T& last) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  std::vector<T> padded(std::size_t(count) + 2 * kReach);
  for (std::ptrdiff_t i = -kReach; i < count + kReach; ++i) {
    T& out = padded[std::size_t(i + kReach)];
    if (closed) {
      out = values[std::size_t(((i % count) + count) % count)];
    } else if (i < 0) {
      out = first + first - values[std::size_t(std::min(-1 - i, count - 1))];
    } else if (i >= count) {
      out = last + last - values[std::size_t(std::max<std::ptrdiff_t>(0, 2 * count - 1 - i))];
    } else {
      out = values[std::size_t(i)];
    }
  }
  return padded;
}

template <class T>
std::vector<T> Blurred(const std::vector<T>& values, bool closed, const T& first, const T& last) {
  const std::vector<T> padded = Padded(values, closed, first, last);
  const auto& weights = Weights();
  std::vector<T> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    T sum = padded[i + kReach] * weights[0];
    for (std::size_t k = 1; k <= kReach; ++k) sum += (padded[i + kReach - k] + padded[i + kReach + k]) * weights[k];
    out[i] = sum;
  }
  return out;
}

// Twice the blurred curve less the twice blurred one: steps of pixels vanish, bends keep their size.
void Smooth(float give, LineChain& chain) {
  std::vector<glm::vec2> given;
  for (const LinePoint& point : chain.points) given.push_back(point.at);
  // Where the line crosses a border rather than runs along it, the shift says little, and the neighbours say more.
  const std::vector<glm::vec2> rough = Blurred(given, chain.closed, chain.first, chain.last);
  std::vector<float> crossing(given.size());  // 0 … 1
  for (std::size_t i = 0; i < given.size(); ++i) {
    const LinePoint& point = chain.points[i];
    const glm::vec2 along = rough[std::min(i + 1, given.size() - 1)] - rough[i > 0 ? i - 1 : 0];
    const float whole = along.x * along.x + along.y * along.y;
    const float across = along.x * point.to_owner.x + along.y * point.to_owner.y;
    if (whole > 0.0f) crossing[i] = std::clamp((across * across / whole - 0.8f) / 0.15f, 0.0f, 1.0f);
    given[i] += point.to_owner * point.shift;
  }
  const std::vector<glm::vec2> shifted = given;
  for (std::size_t i = 1; i + 1 < given.size(); ++i) {
    if (crossing[i] > 0.0f) given[i] += (0.5f * (shifted[i - 1] + shifted[i + 1]) - shifted[i]) * crossing[i];
  }
  const std::vector<glm::vec2> once = Blurred(given, chain.closed, chain.first, chain.last);
  const std::vector<glm::vec2> twice = Blurred(once, chain.closed, chain.first, chain.last);
  for (std::size_t i = 0; i < given.size(); ++i) {
    LinePoint& point = chain.points[i];
    const glm::vec2 moved = once[i] + once[i] - twice[i] - given[i];
    const float across = moved.x * point.to_owner.x + moved.y * point.to_owner.y;
    const float most = std::clamp(across, -give, give);
    point.at = given[i] + moved + point.to_owner * (most - across);
  }
}

}  // namespace

std::vector<LineChain> TraceLines(BorderMap& borders, const GuideSet& guides, std::span<const float> shadow,
                                  double shortest, float give, bool settles_owners) {
  std::vector<LineChain> chains = Tracer(borders, guides, shadow).Trace(shortest);
  tbb::parallel_for(std::size_t(0), chains.size(), [&](std::size_t i) {
    if (settles_owners) SettleOwners(guides, chains[i]);
    Smooth(give, chains[i]);
  });
  return chains;
}

void SmoothAlong(const LineChain& chain, std::vector<float>& values) {
  values = Blurred(values, chain.closed, values.front(), values.back());
}

}  // namespace scumble::internal
