// After "Adobe Photoshop File Formats Specification", 2019: numbers have their highest byte first.
#include "core/io/oiio/flat_psd.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>

#include "core/io/picture/format_detection.h"

namespace scumble::internal {
namespace {

using OIIO::Filesystem::IOProxy;
using Size = std::uint64_t;

constexpr Size kHeaderBytes = 26;
constexpr Size kPaletteBytes = 768;
constexpr Size kMostChannels = 56;

enum Mode { kBitmap = 0, kGrey = 1, kIndexed = 2, kRgb = 3 };
constexpr Size kColorsOfModes[] = {1, 1, 1, 3, 4};  // the last is CMYK

// Some bytes, followed by a file from an offset on.
class SplicedFile : public IOProxy {
 public:
  SplicedFile(std::string start, IOProxy& file, Size from)
      : IOProxy("", Read), start_(std::move(start)), file_(file), from_(from) {}
  const char* proxytype() const override { return "spliced"; }
  std::size_t size() const override { return start_.size() + (file_.size() - from_); }
  std::size_t read(void* bytes, std::size_t count) override {
    const std::size_t done = pread(bytes, count, m_pos);
    m_pos += static_cast<std::int64_t>(done);
    return done;
  }
  std::size_t pread(void* bytes, std::size_t count, std::int64_t offset) override {
    if (offset < 0 || Size(offset) >= size()) return 0;
    const Size at = Size(offset);
    count = std::min(count, size() - at);
    const std::size_t done = at < start_.size() ? start_.copy(static_cast<char*>(bytes), count, at) : 0;
    if (done == count) return count;
    const Size behind = from_ + (at + done - start_.size());
    return done + file_.pread(static_cast<char*>(bytes) + done, count - done, static_cast<std::int64_t>(behind));
  }

 private:
  std::string start_;
  IOProxy& file_;
  Size from_;
};

// Up to `count` bytes from an offset, as many as the file has.
std::string BytesAt(IOProxy& file, Size at, Size count) {
  if (at >= file.size()) return {};
  std::string bytes(std::min<Size>(count, file.size() - at), '\0');
  bytes.resize(file.pread(bytes.data(), bytes.size(), static_cast<std::int64_t>(at)));
  return bytes;
}

Size NumberIn(const std::string& bytes, std::size_t at, std::size_t count) {
  Size number = 0;
  for (std::size_t i = at; i < at + count; ++i) number = number << 8 | static_cast<unsigned char>(bytes[i]);
  return number;
}

// 0 where the file ends before it.
Size NumberAt(IOProxy& file, Size at, Size count) {
  const std::string bytes = BytesAt(file, at, count);
  return bytes.size() == count ? NumberIn(bytes, 0, count) : 0;
}

std::string AsBytes(Size number, Size count) {
  std::string bytes(count, '\0');
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<char>(number >> (8 * (count - 1 - i)));
  return bytes;
}

std::string WithLength(const std::string& bytes, Size digits) { return AsBytes(bytes.size(), digits) + bytes; }

struct Header {
  explicit Header(IOProxy& file)
      : is_large(NumberAt(file, 4, 2) == 2),
        channels(NumberAt(file, 12, 2)),
        height(NumberAt(file, 14, 4)),
        width(NumberAt(file, 18, 4)),
        depth(NumberAt(file, 22, 2)),
        mode(NumberAt(file, 24, 2)) {}
  Size Colors() const { return mode < std::size(kColorsOfModes) ? kColorsOfModes[mode] : 1; }
  Size LengthDigits() const { return is_large ? 8 : 4; }     // of the layers
  Size RowLengthDigits() const { return is_large ? 4 : 2; }  // of a packed row

  bool is_large;  // PSB
  Size channels, height, width, depth, mode;
};

// OpenImageIO reads as many channels as the colours need and as many bits as their kind has, whether the file has them
// or not.
Status CheckHeader(const Header& header, const std::string& name) {
  SCUMBLE_RETURN_IF_ERROR(
      CheckSize(OIIO::ImageSpec(static_cast<int>(header.width), static_cast<int>(header.height), 1), name));
  const bool depth_fits = header.mode == kBitmap    ? header.depth == 1
                          : header.mode == kIndexed ? header.depth == 8
                                                    : header.depth > 1;
  if (depth_fits && header.channels >= header.Colors() && header.channels <= kMostChannels) return Ok();
  return InputError("cannot read " + name + ": its " + std::to_string(header.channels) + " channels of " +
                    std::to_string(header.depth) + " bits do not fit its colours, of mode " +
                    std::to_string(header.mode) + "; it may be damaged: save it again, or as a PNG");
}

// Whether all rows of the flattened picture, which begins at `at`, are in the file.
Status CheckRows(IOProxy& file, const Header& header, Size at, const std::string& name) {
  const Size rows = header.channels * header.height, packing = NumberAt(file, at, 2), left = file.size() - at - 2;
  if (packing > 1) return Ok();  // the library reads none of these
  if (packing == 0) {
    return rows * ((header.width * header.depth + 7) / 8) <= left ? Ok() : DeclaredSizeError(name, file.size());
  }
  // Packed rows are preceded by their lengths.
  const Size digits = header.RowLengthDigits();
  const std::string lengths = BytesAt(file, at + 2, rows * digits);
  if (lengths.size() < rows * digits) return DeclaredSizeError(name, file.size());
  Size needed = lengths.size();
  for (Size row = 0; row < rows; ++row) needed += NumberIn(lengths, row * digits, digits);
  return needed <= left ? Ok() : DeclaredSizeError(name, file.size());
}

// A resource of so many bytes.
std::string Resource(Size id, const std::string& bytes) {
  return "8BIM" + AsBytes(id, 2) + AsBytes(0, 2) + WithLength(bytes, 4);
}

// Keeps three resources: the resolution, the colour profile and an indexed picture's transparent colour. Without the
// last OpenImageIO 2.4 reports alpha but writes none. A colour that no pixel has makes it write 1.
std::string KeptResources(IOProxy& file, const Header& header, Size at, Size end) {
  constexpr Size kResolution = 1005, kProfile = 1039, kTransparent = 1047, kNoColor = 256;
  std::string resolution, profile, transparent = Resource(kTransparent, AsBytes(kNoColor, 2));
  while (at + 12 <= end) {
    const Size id = NumberAt(file, at + 4, 2), name_bytes = NumberAt(file, at + 6, 1);
    const Size data = at + 6 + (name_bytes + 2) / 2 * 2 + 4, length = NumberAt(file, data - 4, 4);
    if (data + length > end) break;
    if (id == kResolution && length >= 16) resolution = Resource(id, BytesAt(file, data, 16));
    if (id == kProfile) profile = Resource(id, BytesAt(file, data, length) + std::string(length % 2, '\0'));
    if (id == kTransparent && length >= 2) transparent = Resource(id, BytesAt(file, data, 2));
    at = data + length + length % 2;
  }
  return resolution + profile + (header.mode == kIndexed ? transparent : "");
}

// Whether the channel after the colours is the flattened picture's alpha: then the number of layers is negative.
bool HasAlpha(IOProxy& file, const Header& header, Size layers, Size length) {
  const Size digits = header.LengthDigits();
  if (header.mode != kGrey && header.mode != kRgb) return false;
  if (header.channels <= header.Colors() || length < digits + 2 || NumberAt(file, layers, digits) == 0) return false;
  return NumberAt(file, layers + digits, 2) >= 0x8000;
}

// A layer section that declares alpha: -1 layers, empty, without channels, mask and name.
std::string LayersWithAlpha(Size digits) {
  const std::string extra(4 + 4 + 4, '\0'), rectangle_and_channels(4 * 4 + 2, '\0'), blend = "8BIMnorm", flags(4, '\0');
  const std::string layers = AsBytes(0xffff, 2) + rectangle_and_channels + blend + flags + WithLength(extra, 4);
  return WithLength(WithLength(layers, digits), digits);
}

}  // namespace

Expected<std::unique_ptr<IOProxy>> FlatPsd(IOProxy& file, const std::string& name) {
  const Header header(file);
  SCUMBLE_RETURN_IF_ERROR(CheckHeader(header, name));
  const Size digits = header.LengthDigits();
  const Size palette = kHeaderBytes + 4, palette_bytes = NumberAt(file, palette - 4, 4);
  const Size resources = palette + palette_bytes + 4, resource_bytes = NumberAt(file, resources - 4, 4);
  const Size layers = resources + resource_bytes + digits, layer_bytes = NumberAt(file, layers - digits, digits);
  const Size pixels = layers + layer_bytes;
  if (layer_bytes > file.size() || pixels + 2 > file.size()) return DeclaredSizeError(name, file.size());
  SCUMBLE_RETURN_IF_ERROR(CheckRows(file, header, pixels, name));
  const bool indexed = header.mode == kIndexed;
  const std::string start =
      BytesAt(file, 0, kHeaderBytes) +
      WithLength(indexed ? BytesAt(file, palette, std::min(palette_bytes, kPaletteBytes)) : "", 4) +
      WithLength(KeptResources(file, header, resources, resources + resource_bytes), 4) +
      (HasAlpha(file, header, layers, layer_bytes) ? LayersWithAlpha(digits) : AsBytes(0, digits));
  return std::unique_ptr<IOProxy>(std::make_unique<SplicedFile>(start, file, pixels));
}

}  // namespace scumble::internal
