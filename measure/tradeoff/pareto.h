// The Pareto front: settings that no other setting beats in both time and error.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace scumble {

// Both in any unit, less is better.
struct TradePoint {
  double time = 0.0;
  double error = 0.0;
};

// The places in `points` of the Pareto front, by rising time. One point beats another if it is worse in neither and
// better in one. Points that are equal in both do not beat each other: all are on the front if one is, in the order
// given. So the errors along the front fall strictly from each time to the next longer one. A point with a NaN was not
// measured: it is never on the front and beats no point. Infinities are numbers like others. O(n log n).
//
// `chance` (0 or more): errors that differ by no more are taken for equal. So a slower point is on the front only if
// its error is less than those of all quicker points on it, by more than `chance`.
std::vector<std::size_t> ParetoFront(std::span<const TradePoint> points, double chance = 0.0);

}  // namespace scumble
