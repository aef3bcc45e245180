#include "transfer/exemplar/usable_rows.h"

namespace scumble::internal {
namespace {

// A row of a disc, which is symmetric: texels from the first usable one, which is found by halving.
UsableRows::Span DiscRow(const PreparedExemplar& exemplar, int y) {
  const int size = exemplar.width(), middle = size / 2;
  if (!exemplar.Usable(middle, y)) return {0, 0};
  int outside = -1, inside = middle;
  while (inside - outside > 1) {
    const int x = (outside + inside) / 2;
    (exemplar.Usable(x, y) ? inside : outside) = x;
  }
  return {inside, size - inside};
}

}  // namespace

UsableRows::UsableRows(const PreparedExemplar& exemplar) : is_sphere_(exemplar.is_sphere()) {
  first_.reserve(std::size_t(exemplar.height()) + 1);
  for (int y = 0; y < exemplar.height(); ++y) {
    first_.push_back(static_cast<std::uint32_t>(spans_.size()));
    if (exemplar.is_sphere()) {
      const Span span = DiscRow(exemplar, y);
      if (span.begin < span.end) spans_.push_back(span);
      continue;
    }
    for (int x = 0; x < exemplar.width();) {
      const int begin = x;
      while (x < exemplar.width() && exemplar.Usable(x, y)) ++x;
      if (begin < x)
        spans_.push_back({begin, x});
      else
        ++x;
    }
  }
  first_.push_back(static_cast<std::uint32_t>(spans_.size()));
}

}  // namespace scumble::internal
