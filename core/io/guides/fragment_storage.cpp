#include "core/io/guides/fragment_storage.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <string>

#include "core/io/exr/half_float.h"

namespace scumble::internal {
namespace {

constexpr std::uint32_t kVersion = 1;

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

struct Header {
  std::uint32_t width, height, count, channels;
};

std::optional<Header> ReadHeader(Reader& reader) {
  const auto version = reader.Number(), width = reader.Number(), height = reader.Number(), count = reader.Number(),
             channels = reader.Number();
  if (!channels || *version != kVersion) return std::nullopt;
  return Header{*width, *height, *count, *channels};
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
  return bytes;
}

std::size_t CountFragments(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  const std::optional<Header> header = ReadHeader(reader);
  return header ? header->count : 0;
}

std::shared_ptr<const Fragments> DecodeFragments(std::span<const std::byte> bytes, const GuideSet& guides) {
  Reader reader(bytes);
  const std::optional<Header> header = ReadHeader(reader);
  if (!header || int(header->width) != guides.width() || int(header->height) != guides.height()) return nullptr;
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < header->channels; ++i) {
    const auto name = reader.Name();
    if (!name) return nullptr;
    names.push_back(*name);
  }
  const std::uint64_t wanted = std::uint64_t(4) * header->count * (1 + std::uint64_t(header->channels));
  if (header->count == 0 || header->count > std::uint32_t(1) << 30 || reader.left() != wanted) return nullptr;
  auto fragments = std::make_shared<Fragments>();
  for (std::uint32_t i = 0; i < header->count; ++i) fragments->pixel.push_back(*reader.Number());
  fragments->values = GuideSet(int(header->count), 1);
  for (const LayerInfo& info : AllLayers()) {
    if (guides.Has(info.layer)) fragments->values.Add(info.layer);
  }
  std::size_t found = 0;
  for (const std::string& name : names) {
    const auto channel = ChannelOf(name, guides);
    found += channel ? 1 : 0;
    for (std::uint32_t i = 0; i < header->count; ++i) {
      const float value = std::bit_cast<float>(*reader.Number());
      if (channel) fragments->values.Plane(channel->first, channel->second)[i] = value;
    }
  }
  std::size_t expected = 0;
  for (const LayerInfo& info : AllLayers())
    expected += guides.Has(info.layer) ? std::size_t(ChannelCount(info.layer)) : 0;
  if (found != expected || !fragments->Validate(guides, "")) return nullptr;
  return fragments;
}

}  // namespace scumble::internal
