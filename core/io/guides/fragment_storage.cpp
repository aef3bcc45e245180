#include "core/io/guides/fragment_storage.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/io/exr/half_float.h"

namespace scumble::internal {
namespace {

constexpr std::uint32_t kVersion = 1;
constexpr const char* kCells = "cells";  // whole numbers; may be missing

void Put(std::uint32_t number, std::vector<std::byte>& bytes) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(std::byte(number >> shift & 0xff));
}

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::optional<std::uint32_t> Number() {
    if (bytes_.size() < 4) return std::nullopt;
    std::uint32_t number = 0;
    for (std::size_t i = 4; i-- > 0;) number = number << 8 | std::to_integer<std::uint32_t>(bytes_[i]);
    bytes_ = bytes_.subspan(4);
    return number;
  }
  std::optional<std::string> Name() {
    const auto end = std::find(bytes_.begin(), bytes_.end(), std::byte{0});
    if (end == bytes_.end()) return std::nullopt;
    std::string name;
    for (auto at = bytes_.begin(); at != end; ++at) name += char(*at);
    bytes_ = bytes_.subspan(name.size() + 1);
    return name;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
};

struct FragmentHeader {
  std::size_t count = 0;
  std::vector<std::string> channels;
};

// Reads everything before the fragments' pixels and compares the size of the rest with what the header says.
Expected<FragmentHeader> ReadFragmentHeader(Reader& reader, int width, int height, const std::string& name) {
  const auto refuse = [&](const std::string& what) {
    return InputError(name + ": its attribute " + kFragmentAttribute + " " + what + kRemedyForFragments);
  };
  const std::string cut = "ends in its header, so the file is damaged";
  const auto version = reader.Number(), found_width = reader.Number(), found_height = reader.Number(),
             count = reader.Number(), channels = reader.Number();
  if (!channels) return refuse(cut);
  if (*version != kVersion) {
    return refuse("has version " + std::to_string(*version) + ", and this program reads version " +
                  std::to_string(kVersion));
  }
  if (*found_width != std::uint32_t(width) || *found_height != std::uint32_t(height)) {
    return refuse("is of a picture of " + std::to_string(*found_width) + "×" + std::to_string(*found_height) +
                  " pixels, the file is " + std::to_string(width) + "×" + std::to_string(height));
  }
  FragmentHeader header{*count, {}};
  for (std::uint32_t i = 0; i < *channels; ++i) {
    auto channel = reader.Name();
    if (!channel) return refuse(cut);
    header.channels.push_back(*std::move(channel));
  }
  // A name takes a byte at least, so this is far from the largest number.
  const std::uint64_t bytes_of_one = 4 * (1 + std::uint64_t(*channels));
  if (reader.left() / bytes_of_one != header.count || reader.left() % bytes_of_one != 0) {
    return refuse("names " + std::to_string(header.count) + " fragments of " + std::to_string(bytes_of_one) +
                  " bytes and has " + std::to_string(reader.left()) + " bytes for them, so the file is damaged");
  }
  return header;
}

// The guides' layer and component of a name.
std::optional<std::pair<Layer, int>> ChannelOf(const std::string& name, const GuideSet& guides) {
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      if (guides.Has(info.layer) && info.channels[std::size_t(c)] == name) return std::pair(info.layer, c);
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::byte> EncodeFragments(const GuideSet& guides, bool half) {
  const Fragments& fragments = *guides.fragments;
  std::vector<std::byte> bytes, names;
  std::uint32_t channels = 0;
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    for (const char* name : info.channels) {
      for (const char* c = name; *c != 0; ++c) names.push_back(std::byte(*c));
      names.push_back(std::byte{0}), ++channels;
    }
  }
  if (!fragments.cells.empty()) {
    for (const char* c = kCells; *c != 0; ++c) names.push_back(std::byte(*c));
    names.push_back(std::byte{0}), ++channels;
  }
  bytes.reserve(20 + names.size() + 4 * fragments.count() * (1 + channels));
  for (const std::size_t number : {std::size_t(kVersion), std::size_t(guides.width()), std::size_t(guides.height()),
                                   fragments.count(), std::size_t(channels)}) {
    Put(std::uint32_t(number), bytes);
  }
  bytes.insert(bytes.end(), names.begin(), names.end());
  for (const std::uint32_t pixel : fragments.pixel) Put(pixel, bytes);
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (const float value : fragments.values.Plane(info.layer, c)) {
        const float stored = half && info.is_color ? static_cast<float>(ToHalf(value)) : value;
        Put(std::bit_cast<std::uint32_t>(stored), bytes);
      }
    }
  }
  for (const std::uint16_t cells : fragments.cells) Put(std::bit_cast<std::uint32_t>(float(cells)), bytes);
  return bytes;
}

Expected<std::size_t> CountFragments(std::span<const std::byte> bytes, int width, int height, const std::string& name) {
  Reader reader(bytes);
  SCUMBLE_ASSIGN(const FragmentHeader header, ReadFragmentHeader(reader, width, height, name));
  return header.count;
}

Expected<std::shared_ptr<const Fragments>> DecodeFragments(std::span<const std::byte> bytes, const GuideSet& guides,
                                                           const std::string& name) {
  Reader reader(bytes);
  SCUMBLE_ASSIGN(const FragmentHeader header, ReadFragmentHeader(reader, guides.width(), guides.height(), name));
  if (header.count == 0) return std::shared_ptr<const Fragments>();
  auto fragments = std::make_shared<Fragments>();
  for (std::size_t i = 0; i < header.count; ++i) fragments->pixel.push_back(*reader.Number());
  fragments->values = GuideSet(int(header.count), 1);
  std::set<std::pair<Layer, int>> missing;
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    fragments->values.Add(info.layer);
    for (int c = 0; c < ChannelCount(info.layer); ++c) missing.emplace(info.layer, c);
  }
  for (const std::string& channel_name : header.channels) {
    const auto channel = ChannelOf(channel_name, guides);
    if (channel) missing.erase(*channel);
    const bool is_cells = channel_name == kCells;
    if (is_cells) fragments->cells.resize(header.count);
    for (std::size_t i = 0; i < header.count; ++i) {
      const float value = std::bit_cast<float>(*reader.Number());
      if (channel) fragments->values.Plane(channel->first, channel->second)[i] = value;
      if (!is_cells) continue;
      if (!(value >= 0.0f && value <= Fragments::kAllCells)) {
        return InputError(name + ": its attribute " + kFragmentAttribute + " has a value of " + std::to_string(value) +
                          " in " + kCells + ", expected 0 to 65535" + kRemedyForFragments);
      }
      fragments->cells[i] = std::uint16_t(value);
    }
  }
  if (!missing.empty()) {
    const auto& [layer, component] = *missing.begin();
    return InputError(name + ": its attribute " + kFragmentAttribute + " has no channel " +
                      Info(layer).channels[std::size_t(component)] + ", which the file has" + kRemedyForFragments);
  }
  SCUMBLE_RETURN_IF_ERROR(fragments->Validate(guides, name));
  return std::shared_ptr<const Fragments>(std::move(fragments));
}

}  // namespace scumble::internal
