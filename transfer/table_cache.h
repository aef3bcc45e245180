// Storage of look-up tables between runs. This library uses no folders: the program provides them.
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
  // The bytes stored under the key, a word of hexadecimal digits; empty where there are none or they are damaged.
  virtual std::optional<std::vector<std::byte>> Load(const std::string& key) = 0;
  // A failed store is no error: the next run does the work again.
  virtual void Store(const std::string& key, std::span<const std::byte> bytes) = 0;
};

}  // namespace scumble
