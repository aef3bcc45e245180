#include "guidegen/load/ply_parse.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <sstream>
#include <string_view>

#include "guidegen/load/loader_util.h"

namespace scumble {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64}};

std::size_t Bytes(PlyType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<int>(type)];
}

std::optional<PlyType> FindType(const std::string& name) {
  for (const TypeName& known : kTypeNames) {
    if (known.name == name) return known.type;
  }
  return std::nullopt;
}

template <class T>
double Convert(const unsigned char* raw) {
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return static_cast<double>(value);
}

class HeaderParser {
 public:
  HeaderParser(const std::string& file, PlyHeader& header) : file_(file), header_(header) {}

  Status Parse(std::span<const unsigned char> bytes) {
    std::size_t at = 0;
    bool has_format = false;
    // Rhinoceros ends lines by a carriage return alone; binary values may begin with any byte after it.
    constexpr std::size_t kMagic = 3;
    const bool returns_alone = bytes.size() > kMagic + 1 && bytes[kMagic] == '\r' && bytes[kMagic + 1] != '\n';
    const unsigned char end_of_line = returns_alone ? '\r' : '\n';
    for (int line_number = 1; at < bytes.size(); ++line_number) {
      const auto end = std::find(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), end_of_line);
      std::string line(bytes.begin() + static_cast<std::ptrdiff_t>(at), end);
      at += line.size() + (end == bytes.end() ? 0 : 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line_number == 1) {
        if (line != "ply") return Bad("it does not begin with the line 'ply'");
        continue;
      }
      if (line == "end_header") {
        header_.body = at;
        return has_format ? Ok() : Status(Bad("its header names no format"));
      }
      std::istringstream words(line);
      std::string keyword;
      words >> keyword;
      if (keyword == "format") has_format = true;
      SCUMBLE_RETURN_IF_ERROR(ParseLine(keyword, words, line));
    }
    return Bad("its header has no end; the file was cut short");
  }

 private:
  Error Bad(const std::string& reason) const { return PlyError(file_, reason); }

  void ParseComment(std::istringstream& words) {
    std::string keyword, name;
    if (words >> keyword && keyword == "TextureFile" && std::getline(words >> std::ws, name)) {
      header_.textures.push_back(name.substr(0, name.find_last_not_of(" \t\r") + 1));
    }
  }

  Status ParseLine(const std::string& keyword, std::istringstream& words, const std::string& line) {
    if (keyword == "format") {
      std::string format;
      words >> format;
      if (format == "binary_little_endian") {
        header_.format = PlyFormat::kLittleEndian;
      } else if (format == "binary_big_endian") {
        header_.format = PlyFormat::kBigEndian;
      } else if (format != "ascii") {
        return Bad("its format is '" + Excerpt(format, 40) + "'; expected ascii or binary_little_endian");
      }
    } else if (keyword == "element") {
      PlyElement element;
      if (!(words >> element.name >> element.count)) return Bad("the header line '" + Excerpt(line, 80) + "'");
      // A second list of vertices might have different properties, and faces do not say which list they index.
      const auto is_twin = [&](const PlyElement& other) { return other.name == element.name; };
      if (element.name == "vertex" && std::any_of(header_.elements.begin(), header_.elements.end(), is_twin)) {
        return Bad("its header has a second 'element vertex'; expected one, join them into it");
      }
      header_.elements.push_back(element);
    } else if (keyword == "comment") {
      ParseComment(words);
    } else if (keyword == "property") {
      PlyProperty property;
      std::string type, count_type;
      words >> type;
      if (type == "list") {
        words >> count_type >> type;
        property.list_count = FindType(count_type);
        if (!property.list_count || *property.list_count >= PlyType::kFloat32) {
          return Bad("the header line '" + Excerpt(line, 80) + "'");
        }
      }
      const std::optional<PlyType> known = FindType(type);
      if (!known || !(words >> property.name) || header_.elements.empty()) {
        return Bad("the header line '" + Excerpt(line, 80) + "'");
      }
      property.type = *known;
      header_.elements.back().properties.push_back(property);
    }
    return Ok();
  }

  const std::string& file_;
  PlyHeader& header_;
};

}  // namespace

std::size_t PlyValues::LeastBytes(PlyType type) const { return format_ == PlyFormat::kAscii ? 2 : Bytes(type); }

bool PlyValues::NextWord(double& value) {
  const auto is_space = [](unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
  std::size_t end = at_;
  while (end < bytes_.size() && !is_space(bytes_[end])) ++end;
  if (end > at_ && bytes_[at_] == '+') ++at_;
  const char* first = reinterpret_cast<const char*>(bytes_.data()) + at_;
  const char* last = reinterpret_cast<const char*>(bytes_.data()) + end;
  const auto result = std::from_chars(first, last, value);
  at_ = end;
  return result.ec == std::errc() && result.ptr == last;
}

bool PlyValues::NextBinary(PlyType type, double& value) {
  const std::size_t size = Bytes(type);
  if (size > remaining()) return false;
  unsigned char raw[8] = {};
  std::memcpy(raw, bytes_.data() + at_, size);
  at_ += size;
  const bool file_is_little = format_ == PlyFormat::kLittleEndian;
  if (file_is_little != (std::endian::native == std::endian::little)) std::reverse(raw, raw + size);
  switch (type) {
    case PlyType::kInt8:
      value = Convert<std::int8_t>(raw);
      break;
    case PlyType::kUint8:
      value = Convert<std::uint8_t>(raw);
      break;
    case PlyType::kInt16:
      value = Convert<std::int16_t>(raw);
      break;
    case PlyType::kUint16:
      value = Convert<std::uint16_t>(raw);
      break;
    case PlyType::kInt32:
      value = Convert<std::int32_t>(raw);
      break;
    case PlyType::kUint32:
      value = Convert<std::uint32_t>(raw);
      break;
    case PlyType::kFloat32:
      value = Convert<float>(raw);
      break;
    case PlyType::kFloat64:
      value = Convert<double>(raw);
      break;
  }
  return true;
}

Error PlyError(const std::string& file, const std::string& reason) {
  return InputError(file + " is not a valid PLY file: " + reason);
}

Status ParsePlyHeader(const std::string& file, std::span<const unsigned char> bytes, PlyHeader& header) {
  return HeaderParser(file, header).Parse(bytes);
}

}  // namespace scumble
