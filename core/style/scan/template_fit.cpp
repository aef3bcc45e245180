#include "core/style/scan/template_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/style/scan/homography.h"

namespace scumble {
namespace {

constexpr std::size_t kLeastMarks = 4;
// A lens is fitted from this many marks on, and must remove this share of the error: one more parameter always removes
// a little.
constexpr std::size_t kLeastMarksForLens = 6;
constexpr double kLensMustMend = 0.15;
// The largest distance of a mark from where the map has it, in sides of a mark: first while only two marks are known,
// and at last.
constexpr double kFarAtFirst = 0.6, kFarAtLast = 0.35;

// Template coordinates around the sphere's middle, where the perspective's last element is surely not 0.
glm::dvec2 Centred(glm::dvec2 p) { return p - 0.5; }

struct Pair {
  glm::dvec2 printed, seen;
  std::size_t mark;  // which of the marks it belongs to
};

std::vector<Pair> PairsOf(std::span<const FoundMark> marks) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    for (int c = 0; c < 4; ++c) pairs.push_back({PrintedCorner(marks[i].id, c), marks[i].corners[std::size_t(c)], i});
  }
  return pairs;
}

std::optional<glm::dmat3> Perspective(std::span<const Pair> pairs) {
  std::vector<glm::dvec2> from, to;
  for (const Pair& pair : pairs) from.push_back(Centred(pair.printed)), to.push_back(pair.seen);
  auto map = FitHomography(from, to);
  if (map) *map = *map * glm::dmat3(1, 0, 0, 0, 1, 0, -0.5, -0.5, 1);
  return map;
}

double Distance(const TemplateMap& map, const Pair& pair) {
  return glm::length(map.ToPicture(pair.printed) - pair.seen);
}

// The map as numbers around the template's middle: eight of the perspective, one of the lens.
constexpr int kNumbers = 9;
using Numbers = std::array<double, kNumbers>;

TemplateMap MapOf(const Numbers& n, TemplateMap map) {
  const glm::dmat3 around(n[0], n[3], n[6], n[1], n[4], n[7], n[2], n[5], 1.0);
  map.perspective = around * glm::dmat3(1, 0, 0, 0, 1, 0, -0.5, -0.5, 1);
  map.bend = n[8];
  return map;
}

Numbers NumbersOf(const TemplateMap& map) {
  const glm::dmat3 moved = map.perspective * glm::dmat3(1, 0, 0, 0, 1, 0, 0.5, 0.5, 1);
  const glm::dmat3 m = moved / moved[2][2];
  return {m[0][0], m[1][0], m[2][0], m[0][1], m[1][1], m[2][1], m[0][2], m[1][2], map.bend};
}

// The cost to minimise: squares that flatten (Geman and McClure), so that one corner under paint has little weight.
double Cost(const TemplateMap& map, std::span<const Pair> pairs, double scale, std::vector<double>* weights) {
  double cost = 0;
  if (weights) weights->clear();
  for (const Pair& pair : pairs) {
    const double d = Distance(map, pair) / scale, one = 1 + d * d;
    cost += d * d / one;
    if (weights) weights->push_back(1 / (one * one));
  }
  return cost;
}

// The derivatives of the points' places with respect to the map's numbers.
class Slopes {
 public:
  Slopes(const TemplateMap& map, int numbers) : map_(map), numbers_(numbers) {
    const Numbers at = NumbersOf(map);
    for (int n = 0; n < numbers; ++n) {
      Numbers next = at;
      next[n] += Step(n);
      stepped_[n] = MapOf(next, map);
    }
  }
  std::array<glm::dvec2, kNumbers> At(glm::dvec2 printed) const {
    const glm::dvec2 here = map_.ToPicture(printed);
    std::array<glm::dvec2, kNumbers> slopes{};
    for (int n = 0; n < numbers_; ++n) slopes[n] = (stepped_[n].ToPicture(printed) - here) / Step(n);
    return slopes;
  }

 private:
  static double Step(int number) { return number < 6 ? 1e-3 : 1e-6; }  // pixels, or shares

  TemplateMap map_;
  int numbers_;
  std::array<TemplateMap, kNumbers> stepped_;
};

// The least-squares equations a · x = b. Each number has its own unit, so that pixels beside shares do not look like a
// singular matrix.
struct Equations {
  std::array<double, kNumbers * kNumbers> a{};
  std::array<double, kNumbers> b{}, unit{};
};

Equations EquationsOf(const TemplateMap& map, std::span<const Pair> pairs, int numbers,
                      std::span<const double> weights) {
  Equations e;
  const Slopes slopes(map, numbers);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const glm::dvec2 off = pairs[i].seen - map.ToPicture(pairs[i].printed);
    const auto slope = slopes.At(pairs[i].printed);
    for (int r = 0; r < numbers; ++r) {
      for (int c = 0; c < numbers; ++c) e.a[r * numbers + c] += weights[i] * glm::dot(slope[r], slope[c]);
      e.b[r] += weights[i] * glm::dot(slope[r], off);
    }
  }
  for (int n = 0; n < numbers; ++n) e.unit[n] = e.a[n * numbers + n] > 0 ? 1 / std::sqrt(e.a[n * numbers + n]) : 1.0;
  for (int r = 0; r < numbers; ++r) {
    for (int c = 0; c < numbers; ++c) e.a[r * numbers + c] *= e.unit[r] * e.unit[c];
    e.b[r] *= e.unit[r];
  }
  return e;
}

// Levenberg and Marquardt's steps. `numbers`: 8 for the perspective alone, 9 with the lens.
void Improve(TemplateMap& map, std::span<const Pair> pairs, int numbers, double scale) {
  double damping = 1e-3;
  std::vector<double> weights;
  for (int round = 0; round < 40 && damping < 1e6; ++round) {
    const double cost = Cost(map, pairs, scale, &weights);
    Equations e = EquationsOf(map, pairs, numbers, weights);
    for (int n = 0; n < numbers; ++n) e.a[n * numbers + n] += damping;
    if (!SolveLinear(e.a.data(), e.b.data(), numbers)) return;
    Numbers next = NumbersOf(map);
    for (int n = 0; n < numbers; ++n) next[n] += e.unit[n] * e.b[n];
    const TemplateMap tried = MapOf(next, map);
    const double now = Cost(tried, pairs, scale, nullptr);
    if (!(now < cost)) {
      damping *= 8;
      continue;
    }
    map = tried, damping = std::max(1e-9, damping / 8);
    if (cost - now < 1e-12 * cost) return;
  }
}

// Where four marks on one side leave the other side undetermined, holding one out does not show it. So the spread of
// the residuals at the corners is carried over to the sphere's outline (the covariance of least squares): its largest
// standard deviation, in pixels. The errors of a mark's corners are correlated, so the variance counts double.
double SpreadOnSphere(const TemplateMap& map, std::span<const Pair> pairs, int numbers) {
  constexpr double kTogether = 2.0, kLeastSpread = 0.02;
  double squares = 0;
  for (const Pair& pair : pairs) squares += std::pow(Distance(map, pair), 2);
  const double spread = std::max(kLeastSpread, std::sqrt(squares / double(2 * pairs.size() - std::size_t(numbers))));
  const Equations e = EquationsOf(map, pairs, numbers, std::vector<double>(pairs.size(), 1.0));
  const Slopes slopes(map, numbers);
  double most = 0;
  for (int k = 0; k < 32; ++k) {
    const double angle = k * std::acos(-1.0) / 16;
    const auto slope = slopes.At(glm::dvec2(0.5) + 0.5 * glm::dvec2(std::cos(angle), std::sin(angle)));
    double variance = 0;
    for (int axis = 0; axis < 2; ++axis) {
      auto a = e.a;
      std::array<double, kNumbers> x{};
      for (int n = 0; n < numbers; ++n) x[n] = slope[n][axis] * e.unit[n];
      const auto g = x;
      if (!SolveLinear(a.data(), x.data(), numbers)) return map.SpherePixels();
      for (int n = 0; n < numbers; ++n) variance += g[n] * x[n];
    }
    most = std::max(most, std::sqrt(variance));
  }
  return kTogether * spread * most;
}

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void FitRobustly(TemplateMap& map, std::span<const Pair> pairs, int numbers) {
  for (int round = 0; round < 3; ++round) {
    std::vector<double> distances;
    for (const Pair& pair : pairs) distances.push_back(Distance(map, pair));
    // A corner counts half at three times the usual distance.
    const double scale = std::max(0.02, 3.0 * 1.4826 * MedianOf(distances));
    Improve(map, pairs, numbers, scale);
  }
}

// Fits all pairs, then each mark's from the others.
TemplateFit Measure(TemplateMap map, std::span<const FoundMark> marks, bool lens) {
  const std::vector<Pair> pairs = PairsOf(marks);
  const int numbers = lens ? 9 : 8;
  FitRobustly(map, pairs, numbers);
  TemplateFit fit{map, {marks.begin(), marks.end()}};
  const double sphere = map.SpherePixels();
  double left = 0, held_out = 0;
  for (const Pair& pair : pairs) left += std::pow(Distance(map, pair), 2);
  for (std::size_t m = 0; m < marks.size(); ++m) {
    std::vector<Pair> others, own;
    for (const Pair& pair : pairs) (pair.mark == m ? own : others).push_back(pair);
    TemplateMap without = map;
    FitRobustly(without, others, numbers);
    double off = 0;
    for (const Pair& pair : own) off += std::pow(Distance(without, pair), 2);
    held_out += off;
    const double share = std::sqrt(off / double(own.size())) / sphere;
    if (share > fit.worst) fit.worst = share, fit.worst_id = marks[m].id;
  }
  fit.at_marks = std::sqrt(left / double(pairs.size())) / sphere;
  fit.held_out = std::sqrt(held_out / double(pairs.size())) / sphere;
  fit.on_sphere = SpreadOnSphere(map, pairs, numbers) / sphere;
  return fit;
}

// Marks that lie close to where the map has them, the closest of each id.
std::vector<FoundMark> Agreeing(const TemplateMap& map, std::span<const FoundMark> marks, double far) {
  std::vector<FoundMark> chosen;
  std::array<double, kFiducialCount> best;
  best.fill(far);
  std::array<const FoundMark*, kFiducialCount> which{};
  for (const FoundMark& mark : marks) {
    double off = 0, side = 0;
    for (int c = 0; c < 4; ++c) {
      const glm::dvec2 here = map.ToPicture(PrintedCorner(mark.id, c));
      off = std::max(off, glm::length(here - mark.corners[std::size_t(c)]));
      side += glm::length(map.ToPicture(PrintedCorner(mark.id, (c + 1) % 4)) - here) / 4;
    }
    // A second mark of one id must be nearer to replace the first; marks much smaller or larger than expected do not
    // count.
    if (!(off < best[std::size_t(mark.id)] * side)) continue;
    best[std::size_t(mark.id)] = off / side, which[std::size_t(mark.id)] = &mark;
  }
  for (const FoundMark* mark : which) {
    if (mark) chosen.push_back(*mark);
  }
  return chosen;
}

bool IsMirrored(const TemplateMap& map) {
  const glm::dvec2 o = map.ToPicture({0.5, 0.5}), x = map.ToPicture({0.51, 0.5}) - o,
                   y = map.ToPicture({0.5, 0.51}) - o;
  return x.x * y.y - x.y * y.x < 0;
}

}  // namespace

glm::dvec2 TemplateMap::ToPicture(glm::dvec2 on_template) const {
  const glm::dvec2 straight = Project(perspective, on_template), from_middle = (straight - middle) / half_diagonal;
  return middle + (straight - middle) * (1.0 + bend * glm::dot(from_middle, from_middle));
}

double TemplateMap::SpherePixels() const {
  return (glm::length(ToPicture({1, 0.5}) - ToPicture({0, 0.5})) +
          glm::length(ToPicture({0.5, 1}) - ToPicture({0.5, 0}))) /
         2;
}

double TemplateMap::Turn() const {
  const glm::dvec2 x = ToPicture({0.51, 0.5}) - ToPicture({0.49, 0.5});
  return glm::degrees(std::atan2(x.y, x.x));
}

glm::dvec2 PrintedCorner(int id, int corner) {
  const Fiducial& mark = Fiducials()[std::size_t(id)];
  const bool right = corner == 1 || corner == 2, low = corner >= 2;
  return {mark.left + (right ? kFiducialSide : 0), mark.top + (low ? kFiducialSide : 0)};
}

std::optional<TemplateFit> FitTemplate(std::span<const FoundMark> marks, int width, int height) {
  if (marks.size() > kMostMarks) return std::nullopt;
  // Every pair of marks proposes a map. All are tried, so that the result is deterministic.
  std::vector<FoundMark> best;
  TemplateMap start, best_map;
  start.middle = glm::dvec2(width, height) / 2.0;
  start.half_diagonal = glm::length(start.middle);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    for (std::size_t j = i + 1; j < marks.size(); ++j) {
      if (marks[i].id == marks[j].id) continue;
      const std::array two{marks[i], marks[j]};
      const auto proposed = Perspective(PairsOf(two));
      if (!proposed) continue;
      start.perspective = *proposed;
      if (IsMirrored(start)) continue;
      std::vector<FoundMark> agreeing = Agreeing(start, marks, kFarAtFirst);
      if (agreeing.size() > best.size()) best = std::move(agreeing), best_map = start;
    }
  }
  for (int round = 0; round < 2 && best.size() >= kLeastMarks; ++round) {
    if (const auto all = Perspective(PairsOf(best))) best_map.perspective = *all;
    best = Agreeing(best_map, marks, kFarAtLast);
  }
  if (best.size() < kLeastMarks || IsMirrored(best_map)) return std::nullopt;
  TemplateFit plain = Measure(best_map, best, false);
  if (best.size() < kLeastMarksForLens) return plain;
  TemplateFit bent = Measure(plain.map, best, true);
  return bent.held_out < (1 - kLensMustMend) * plain.held_out ? bent : plain;
}

}  // namespace scumble
