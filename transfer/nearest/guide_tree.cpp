#include "transfer/nearest/guide_tree.h"

#include <cstring>
#include <limits>

#include "core/image/check.h"
#include "core/image/hash.h"
#include "transfer/nearest/box_tree.h"

namespace scumble {
namespace {

// Keeps the first of equal points, in order; returns their indices.
std::vector<std::uint32_t> RemoveRepeats(std::vector<float>& coordinates, std::size_t dimensions) {
  const std::size_t count = coordinates.size() / dimensions;
  for (float& value : coordinates) value += 0.0f;  // -0 and +0 are the same place
  std::size_t slots = 16;
  while (slots < 2 * count) slots *= 2;
  constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> table(slots, kFree);  // open addressing, of indices into the kept points
  std::vector<std::uint32_t> first;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float* point = coordinates.data() + i * dimensions;
    std::uint64_t hash = 0;
    for (std::size_t d = 0; d < dimensions; ++d) {
      std::uint32_t bits;
      std::memcpy(&bits, point + d, sizeof bits);
      hash = Mix64(hash ^ bits);
    }
    std::size_t slot = hash & (slots - 1);
    const auto same = [&](std::uint32_t other) {
      return std::memcmp(coordinates.data() + other * dimensions, point, dimensions * sizeof(float)) == 0;
    };
    while (table[slot] != kFree && !same(table[slot])) slot = (slot + 1) & (slots - 1);
    if (table[slot] != kFree) continue;
    table[slot] = static_cast<std::uint32_t>(kept);
    std::memmove(coordinates.data() + kept * dimensions, point, dimensions * sizeof(float));
    first.push_back(static_cast<std::uint32_t>(i));
    ++kept;
  }
  coordinates.resize(kept * dimensions);
  coordinates.shrink_to_fit();
  return first;
}

}  // namespace

PointTree::PointTree(int dimensions, std::vector<float> coordinates) : dimensions_(dimensions) {
  SCUMBLE_CHECK_LE(1, dimensions);
  const auto size = static_cast<std::size_t>(dimensions);
  SCUMBLE_CHECK(!coordinates.empty() && coordinates.size() % size == 0);
  SCUMBLE_CHECK_LT(coordinates.size() / size, std::size_t(1) << 31);
  first_ = RemoveRepeats(coordinates, size);
  tree_ = std::make_unique<internal::BoxTree>(dimensions, coordinates);
}

PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;

std::uint32_t PointTree::Nearest(std::span<const float> query) const {
  std::uint32_t place = 0;
  return Nearest(query, place);
}

std::uint32_t PointTree::Nearest(std::span<const float> query, std::uint32_t& place) const {
  SCUMBLE_DCHECK(query.size() == std::size_t(dimensions_));
  return first_[tree_->Nearest(query.data(), place)];
}

std::uint32_t PointTree::Nearest(std::span<const float> query, std::uint32_t& place, double error) const {
  if (!(error > 0.0)) return Nearest(query, place);
  SCUMBLE_DCHECK(query.size() == std::size_t(dimensions_));
  return first_[tree_->ApproximateNearest(query.data(), error)];
}

}  // namespace scumble
