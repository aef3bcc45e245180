#include "measure/tradeoff/pareto.h"

#include <algorithm>
#include <cmath>

namespace scumble {

std::vector<std::size_t> ParetoFront(std::span<const TradePoint> points, double chance) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isnan(points[i].time) && !std::isnan(points[i].error)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].time != points[b].time ? points[a].time < points[b].time : points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    const bool is_equal =
        !front.empty() && points[front.back()].time == points[i].time && points[front.back()].error == points[i].error;
    if (front.empty() || is_equal || points[i].error < points[front.back()].error - chance) front.push_back(i);
  }
  return front;
}

}  // namespace scumble
