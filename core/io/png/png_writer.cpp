#include "core/io/png_writer.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <new>
#include <span>
#include <string_view>

#include "core/image/check.h"
#include "core/io/parallel.h"
#include "core/io/png/png_filter.h"
#include "core/io/png/png_integrity.h"

namespace scumble::internal {
namespace {

constexpr std::size_t kBandBytes = std::size_t(1)
                                   << 18;              // small enough for threads to share, large enough to pack well
constexpr std::size_t kWindow = std::size_t(1) << 15;  // deflate's window

void Append(std::vector<std::byte>& out, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::byte>(number >> shift & 0xff));
}
void Append(std::vector<std::byte>& out, std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

const Bytef* Zlib(const std::byte* bytes) { return reinterpret_cast<const Bytef*>(bytes); }

// Ends a chunk that began at `start` with four bytes for its length: fills in the length and the sum.
void EndChunk(std::vector<std::byte>& out, std::size_t start) {
  const std::size_t length = out.size() - start - 8;
  for (int i = 0; i < 4; ++i) out[start + std::size_t(i)] = static_cast<std::byte>(length >> (24 - 8 * i) & 0xff);
  Append(out, static_cast<std::uint32_t>(crc32_z(0, Zlib(out.data() + start + 4), length + 4)));
}
std::size_t BeginChunk(std::vector<std::byte>& out, std::string_view type) {
  const std::size_t start = out.size();
  Append(out, 0u);
  Append(out, type);
  return start;
}

// Everything before the pixels. The colour space is stored three times, as the specification advises: not every reader
// supports sRGB.
std::vector<std::byte> Head(const Picture& picture, const PngOptions& options) {
  std::vector<std::byte> out;
  for (const unsigned char c : kPngSignature) out.push_back(static_cast<std::byte>(c));
  const auto byte = [&](int value) { out.push_back(static_cast<std::byte>(value)); };

  std::size_t chunk = BeginChunk(out, "IHDR");
  Append(out, static_cast<std::uint32_t>(picture.width));
  Append(out, static_cast<std::uint32_t>(picture.height));
  constexpr int kGrey = 0, kRgba = 6;
  for (const int value : {options.bits, options.grey ? kGrey : kRgba, 0, 0, 0}) byte(value);
  EndChunk(out, chunk);

  chunk = BeginChunk(out, "gAMA");
  Append(out, 45455u);
  EndChunk(out, chunk);
  chunk = BeginChunk(out, "sRGB");
  byte(3);  // absolute colorimetric
  EndChunk(out, chunk);
  chunk = BeginChunk(out, "cHRM");
  for (const std::uint32_t value : {31270u, 32900u, 64000u, 33000u, 30000u, 60000u, 15000u, 6000u}) Append(out, value);
  EndChunk(out, chunk);
  if (options.dpi > 0) {
    chunk = BeginChunk(out, "pHYs");
    const auto per_metre = static_cast<std::uint32_t>(static_cast<float>(options.dpi) * (100.0f / 2.54f));
    Append(out, per_metre);
    Append(out, per_metre);
    byte(1);
    EndChunk(out, chunk);
  }
  if (!options.settings.empty()) {
    chunk = BeginChunk(out, "tEXt");
    Append(out, "scumble:settings");
    byte(0);
    Append(out, options.settings);
    EndChunk(out, chunk);
  }
  return out;
}

// The layout of rows in the file.
struct Layout {
  const Picture& picture;
  const PngOptions& options;
  std::size_t samples = std::size_t(picture.width) * (options.grey ? 1 : 4);
  std::size_t row_bytes = 1 + samples * (options.bits == 16 ? 2 : 1);  // with the filter's number
  std::size_t pixel_bytes = (row_bytes - 1) / std::size_t(picture.width);
  int band_rows = static_cast<int>(std::max<std::size_t>(1, kBandBytes / row_bytes));
  int look_back = static_cast<int>((kWindow + row_bytes - 1) / row_bytes);  // rows, band_rows at most
  int bands = (picture.height + band_rows - 1) / band_rows;

  int begin(int band) const { return band * band_rows; }
  int end(int band) const { return std::min(picture.height, begin(band + 1)); }
};

// A row's samples, the higher byte first. v/257 to the nearest is (255·v + 32895) >> 16, which compilers turn into
// vectors.
void FillSamples(const Layout& layout, int y, std::uint8_t* out) {
  const std::uint16_t* const in = layout.picture.At(0, y);
  const std::size_t step = layout.options.grey ? 4 : 1;
  if (layout.options.bits == 16) {
    for (std::size_t i = 0; i < layout.samples; ++i) {
      const std::uint16_t value = in[i * step];
      out[2 * i] = static_cast<std::uint8_t>(value >> 8), out[2 * i + 1] = static_cast<std::uint8_t>(value & 0xff);
    }
  } else {
    for (std::size_t i = 0; i < layout.samples; ++i)
      out[i] = static_cast<std::uint8_t>((in[i * step] * 255u + 32895u) >> 16);
  }
}

// Rows [begin, end) in the file's form.
std::vector<std::byte> Rows(const Layout& layout, int begin, int end, std::uint8_t filter) {
  const std::size_t bytes = layout.row_bytes - 1;
  std::vector<std::byte> rows(layout.row_bytes * std::size_t(end - begin));
  auto* out = reinterpret_cast<std::uint8_t*>(rows.data());
  std::vector<std::uint8_t> row(bytes), above(bytes);
  if (filter != kNoFilter && begin > 0) FillSamples(layout, begin - 1, above.data());
  for (int y = begin; y < end; ++y, out += layout.row_bytes) {
    *out = filter;
    if (filter == kNoFilter) {
      FillSamples(layout, y, out + 1);
      continue;
    }
    FillSamples(layout, y, row.data());
    FilterPaeth(row.data(), above.data(), bytes, layout.pixel_bytes, out + 1);
    row.swap(above);
  }
  return rows;
}

struct Band {
  std::vector<std::byte> chunk;  // an IDAT
  uLong adler = 1;               // of the rows
  std::size_t bytes = 0;         // bytes of the rows
};

// zlib's state, freed on every exit.
struct Stream : z_stream {
  explicit Stream(int level) : z_stream{} {
    constexpr int kRawWindowBits = -15, kMemory = 8;
    if (deflateInit2(this, level, Z_DEFLATED, kRawWindowBits, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~Stream() { deflateEnd(this); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
};

// Deflates to `out`: a stream without header, to which another may be appended unless `last`.
void Deflate(std::span<const std::byte> dictionary, std::span<const std::byte> rows, int level, bool last,
             std::vector<std::byte>& out) {
  Stream stream(level);
  if (!dictionary.empty()) deflateSetDictionary(&stream, Zlib(dictionary.data()), static_cast<uInt>(dictionary.size()));
  const std::size_t before = out.size();
  const std::size_t flush = 64 + rows.size() / 1000;  // room for the block that ends it
  out.resize(before + deflateBound(&stream, static_cast<uLong>(rows.size())) + flush);
  stream.next_in = const_cast<Bytef*>(Zlib(rows.data()));
  stream.avail_in = static_cast<uInt>(rows.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
  stream.avail_out = static_cast<uInt>(out.size() - before);
  const int done = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
  SCUMBLE_CHECK(done == (last ? Z_STREAM_END : Z_OK) && stream.avail_in == 0 && stream.avail_out > 0);
  out.resize(before + stream.total_out);
}

// The filter that packs a sample of the band best. Paint copied in chunks repeats exactly, and any filter destroys the
// repetition; smooth pictures gain by one.
std::uint8_t ChooseFilter(const Layout& layout, int band) {
  if (layout.options.level == 0) return kNoFilter;
  const int begin = layout.begin(band), end = std::min(layout.end(band), begin + 2 * layout.look_back);
  const auto size = [&](std::uint8_t filter) {
    std::vector<std::byte> packed;
    constexpr int kFast = 1;
    Deflate({}, Rows(layout, begin, end, filter), kFast, true, packed);
    return packed.size();
  };
  return size(kPaeth) < size(kNoFilter) ? kPaeth : kNoFilter;
}

// zlib's two bytes: deflate with its whole window, the effort, and a check sum that makes both divisible by 31.
std::array<std::byte, 2> StreamHead(int level) {
  const int effort = level < 2 ? 0 : level < 6 ? 1 : level == 6 ? 2 : 3;
  const int head = 0x7800 | effort << 6;
  const int checked = head + (31 - head % 31) % 31;
  return {static_cast<std::byte>(checked >> 8), static_cast<std::byte>(checked & 0xff)};
}

}  // namespace

std::vector<std::byte> WritePng(const Picture& picture, const PngOptions& options) {
  SCUMBLE_CHECK(picture.width > 0 && picture.height > 0);
  const Layout layout{picture, options};
  // Neighbouring bands are alike, and a sample costs a quarter of a band.
  constexpr int kAlike = 4;
  std::vector<std::uint8_t> filters(std::size_t((layout.bands + kAlike - 1) / kAlike));
  ForEachIndex(static_cast<int>(filters.size()), options.threads,
               [&](int i) { filters[std::size_t(i)] = ChooseFilter(layout, i * kAlike); });
  const auto filter_of = [&](int band) { return filters[std::size_t(band / kAlike)]; };
  std::vector<Band> bands(std::size_t(layout.bands));
  ForEachIndex(layout.bands, options.threads, [&](int b) {
    const int begin = layout.begin(b), end = layout.end(b);
    const std::vector<std::byte> rows = Rows(layout, begin, end, filter_of(b));
    std::vector<std::byte> before;
    if (b > 0) before = Rows(layout, std::max(0, begin - layout.look_back), begin, filter_of(b - 1));
    const std::span<const std::byte> dictionary(before);
    Band& band = bands[std::size_t(b)];
    const std::size_t start = BeginChunk(band.chunk, "IDAT");
    if (b == 0) {
      for (const std::byte byte : StreamHead(options.level)) band.chunk.push_back(byte);
    }
    Deflate(dictionary.last(std::min(dictionary.size(), kWindow)), rows, options.level, end == picture.height,
            band.chunk);
    band.adler = adler32_z(1, Zlib(rows.data()), rows.size());
    band.bytes = rows.size();
    if (end < picture.height) EndChunk(band.chunk, start);  // the last chunk still lacks the sum of all
  });
  uLong adler = bands.front().adler;
  for (std::size_t b = 1; b < bands.size(); ++b) {
    adler = adler32_combine(adler, bands[b].adler, static_cast<z_off_t>(bands[b].bytes));
  }
  Append(bands.back().chunk, static_cast<std::uint32_t>(adler));
  EndChunk(bands.back().chunk, 0);

  std::vector<std::byte> out = Head(picture, options);
  std::size_t size = out.size() + 12;
  for (const Band& band : bands) size += band.chunk.size();
  out.reserve(size);
  for (const Band& band : bands) out.insert(out.end(), band.chunk.begin(), band.chunk.end());
  EndChunk(out, BeginChunk(out, "IEND"));
  return out;
}

}  // namespace scumble::internal
