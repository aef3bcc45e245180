// Where look-up tables are kept between runs. This library knows no folders: the program says where.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace scumble {

class TableCache {
 public:
  virtual ~TableCache() = default;
  // What was stored under the key, a word of hexadecimal digits; nothing where there is none or it is damaged.
  virtual std::optional<std::vector<std::byte>> Load(const std::string& key) = 0;
  // A store that fails is the cache's own affair: the next run does the work again.
  virtual void Store(const std::string& key, std::span<const std::byte> bytes) = 0;
};

}  // namespace scumble
