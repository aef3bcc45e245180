// The header of a PLY file, and the values behind it. Nothing is interpreted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> list_count;  // set for lists: the type of their length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  // that comments name, as MeshLab and photogrammetry do
  std::size_t body = 0;               // first byte after the header
};

// Steps through the values of the body.
class PlyValues {
 public:
  PlyValues(std::span<const unsigned char> bytes, PlyFormat format) : bytes_(bytes), format_(format) {}

  std::size_t remaining() const { return bytes_.size() - at_; }

  // The smallest size of a value of this type.
  std::size_t LeastBytes(PlyType type) const;

  // False: there is no value, or it is no number.
  bool Next(PlyType type, double& value) {
    return format_ == PlyFormat::kAscii ? NextWord(value) : NextBinary(type, value);
  }

 private:
  bool NextWord(double& value);
  bool NextBinary(PlyType type, double& value);

  std::span<const unsigned char> bytes_;
  PlyFormat format_;
  std::size_t at_ = 0;
};

// A kInput error: the file is not a valid PLY file, for this reason.
Error PlyError(const std::string& file, const std::string& reason);

// Fills `header`. `bytes` are the whole file.
Status ParsePlyHeader(const std::string& file, std::span<const unsigned char> bytes, PlyHeader& header);

}  // namespace scumble
