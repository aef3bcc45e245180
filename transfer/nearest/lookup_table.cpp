#include "transfer/lookup_table.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/image/check.h"

namespace scumble {

glm::vec3 DirectionAt(double px, double py) {
  double squared = px * px + py * py;
  if (squared > 1.0) {
    const double length = std::sqrt(squared);
    px /= length, py /= length, squared = 1.0;
  }
  const double scale = std::sqrt(2.0 - squared);
  return {static_cast<float>(px * scale), static_cast<float>(py * scale), static_cast<float>(1.0 - squared)};
}

LookUpTable::LookUpTable(const PointTree& normals, std::span<const Source> sources, int resolution)
    : LookUpTable(resolution) {
  SCUMBLE_CHECK_LE(1, resolution);
  tbb::parallel_for(0, resolution, [&](int j) {
    std::uint32_t place = 0;
    for (int i = 0; i < resolution; ++i) {
      const glm::vec3 direction = DirectionAt((2.0 * i + 1.0) / resolution - 1.0, 1.0 - (2.0 * j + 1.0) / resolution);
      const float query[3] = {direction.x, direction.y, direction.z};
      const Source& source = sources[normals.Nearest(query, place)];
      cells_[std::size_t(j) * resolution + i] = {static_cast<std::uint16_t>(source.x),
                                                 static_cast<std::uint16_t>(source.y)};
    }
  });
}

double LookUpTable::Quantisation(int resolution) { return 4.0 * std::sqrt(2.0) / resolution; }

std::vector<std::byte> LookUpTable::ToBytes() const {
  std::vector<std::byte> bytes;
  bytes.reserve(4 * cells_.size());
  for (const Cell& cell : cells_) {
    for (const int value : {cell.x, cell.y}) {
      bytes.push_back(static_cast<std::byte>(value & 0xff));
      bytes.push_back(static_cast<std::byte>(value >> 8));
    }
  }
  return bytes;
}

std::optional<LookUpTable> LookUpTable::FromBytes(std::span<const std::byte> bytes, int resolution) {
  LookUpTable table(resolution);
  if (bytes.size() != 4 * table.cells_.size()) return std::nullopt;
  const auto value = [&](std::size_t at) {
    return std::to_integer<int>(bytes[at]) | std::to_integer<int>(bytes[at + 1]) << 8;
  };
  for (std::size_t i = 0; i < table.cells_.size(); ++i) {
    table.cells_[i] = {static_cast<std::uint16_t>(value(4 * i)), static_cast<std::uint16_t>(value(4 * i + 2))};
  }
  return table;
}

}  // namespace scumble
