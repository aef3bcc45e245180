#include "core/io/picture/tiff_writer.h"

#include <tiffio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

#include "core/image/check.h"
#include "core/io/parallel.h"

namespace scumble::internal {
namespace {

// Small enough for threads to share, large enough to pack well.
constexpr std::size_t kStripBytes = std::size_t(1) << 18;

// The layout of rows in the file.
struct StripLayout {
  const Picture& picture;
  const TiffOptions& options;
  std::size_t channels = options.grey ? 1 : 4;
  std::size_t samples = std::size_t(picture.width) * channels;
  std::size_t row_bytes = samples * (options.bits == 16 ? 2 : 1);
  int strip_rows =
      static_cast<int>(std::clamp<std::size_t>(kStripBytes / row_bytes, 1, static_cast<std::size_t>(picture.height)));
  int strips = (picture.height + strip_rows - 1) / strip_rows;

  int begin(int strip) const { return strip * strip_rows; }
  int end(int strip) const { return std::min(picture.height, begin(strip + 1)); }
};

// Each sample less the one before it of its channel, modulo the type's range (TIFF's predictor 2).
template <class T>
void FillDifferences(const T* row, std::size_t samples, std::size_t channels, T* out) {
  std::copy_n(row, channels, out);
  for (std::size_t i = channels; i < samples; ++i) out[i] = static_cast<T>(row[i] - row[i - channels]);
}

// Row y as the file has it: differences, the lower byte first. `row` and `out` are room for a row.
void FillRow(const StripLayout& layout, int y, std::uint16_t* row, std::uint16_t* differences, std::uint8_t* out) {
  const std::uint16_t* const in = layout.picture.At(0, y);
  const std::size_t step = layout.options.grey ? 4 : 1;
  if (layout.options.bits == 16) {
    for (std::size_t i = 0; i < layout.samples; ++i) row[i] = in[i * step];
    FillDifferences(row, layout.samples, layout.channels, differences);
    for (std::size_t i = 0; i < layout.samples; ++i) {
      out[2 * i] = static_cast<std::uint8_t>(differences[i] & 0xff);
      out[2 * i + 1] = static_cast<std::uint8_t>(differences[i] >> 8);
    }
  } else {
    // v/257 to the nearest, which compilers turn into vectors.
    for (std::size_t i = 0; i < layout.samples; ++i) {
      row[i] = static_cast<std::uint16_t>((in[i * step] * 255u + 32895u) >> 16);
    }
    FillDifferences(row, layout.samples, layout.channels, differences);
    for (std::size_t i = 0; i < layout.samples; ++i) out[i] = static_cast<std::uint8_t>(differences[i] & 0xff);
  }
}

std::vector<std::byte> DeflatedStrip(const StripLayout& layout, int strip) {
  const int begin = layout.begin(strip), end = layout.end(strip);
  std::vector<std::uint8_t> rows(layout.row_bytes * static_cast<std::size_t>(end - begin));
  std::vector<std::uint16_t> row(layout.samples), differences(layout.samples);
  std::uint8_t* out = rows.data();
  for (int y = begin; y < end; ++y, out += layout.row_bytes) FillRow(layout, y, row.data(), differences.data(), out);
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::vector<std::byte> packed(size);
  constexpr int kLevel = 6;
  const int done =
      compress2(reinterpret_cast<Bytef*>(packed.data()), &size, rows.data(), static_cast<uLong>(rows.size()), kLevel);
  if (done == Z_MEM_ERROR) throw std::bad_alloc();
  SCUMBLE_CHECK(done == Z_OK);
  packed.resize(size);
  packed.shrink_to_fit();  // all strips are kept until the last is done
  return packed;
}

// The file that libtiff writes, in memory, with the first error. No exception may pass through libtiff.
struct MemoryFile {
  std::vector<std::byte> bytes;
  std::size_t at = 0;
  bool is_out_of_memory = false;
  std::array<char, 256> error{};
};
MemoryFile& File(thandle_t handle) { return *static_cast<MemoryFile*>(handle); }

tmsize_t ReadFrom(thandle_t handle, void* out, tmsize_t size) {
  MemoryFile& file = File(handle);
  const std::size_t left = file.bytes.size() - std::min(file.at, file.bytes.size());
  const std::size_t count = std::min(left, static_cast<std::size_t>(size));
  if (count > 0) std::memcpy(out, file.bytes.data() + file.at, count);
  file.at += count;
  return static_cast<tmsize_t>(count);
}
tmsize_t WriteTo(thandle_t handle, void* in, tmsize_t size) {
  MemoryFile& file = File(handle);
  const std::size_t count = static_cast<std::size_t>(size);
  try {
    if (file.at + count > file.bytes.size()) file.bytes.resize(file.at + count);
  } catch (const std::bad_alloc&) {
    file.is_out_of_memory = true;
    return 0;
  }
  if (count > 0) std::memcpy(file.bytes.data() + file.at, in, count);
  file.at += count;
  return size;
}
toff_t SeekIn(thandle_t handle, toff_t offset, int whence) {
  MemoryFile& file = File(handle);
  const toff_t from = whence == SEEK_CUR ? file.at : whence == SEEK_END ? file.bytes.size() : 0;
  file.at = static_cast<std::size_t>(from + offset);
  return file.at;
}
int CloseNothing(thandle_t) { return 0; }
toff_t SizeOf(thandle_t handle) { return File(handle).bytes.size(); }

// Kept here, because libtiff would print it.
int KeepError(TIFF*, void* file, const char*, const char* format, va_list arguments) {
  std::array<char, 256>& error = File(file).error;
  if (error[0] == '\0') std::vsnprintf(error.data(), error.size(), format, arguments);
  return 1;
}

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

// Classic TIFF counts bytes with 32 bits; a larger file becomes a BigTIFF.
Tiff OpenTiff(MemoryFile& file, const std::string& name, std::size_t size) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 TIFFOpenOptionsFree);
  if (!options) throw std::bad_alloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), KeepError, &file);
  const char* const little_endian = size < std::numeric_limits<std::uint32_t>::max() ? "wl" : "wl8";
  return {TIFFClientOpenExt(name.c_str(), little_endian, &file, ReadFrom, WriteTo, SeekIn, CloseNothing, SizeOf,
                            nullptr, nullptr, options.get()),
          TIFFClose};
}

bool SetFields(TIFF* tiff, const StripLayout& layout) {
  const auto set = [&](std::uint32_t tag, auto value) { return TIFFSetField(tiff, tag, value) == 1; };
  constexpr std::uint16_t kStraight[] = {EXTRASAMPLE_UNASSALPHA};
  const bool grey = layout.options.grey;
  const double dpi = layout.options.dpi;
  return set(TIFFTAG_IMAGEWIDTH, layout.picture.width) && set(TIFFTAG_IMAGELENGTH, layout.picture.height) &&
         set(TIFFTAG_BITSPERSAMPLE, layout.options.bits) && set(TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE) &&
         set(TIFFTAG_PHOTOMETRIC, grey ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB) &&
         set(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) &&
         set(TIFFTAG_SAMPLESPERPIXEL, static_cast<int>(layout.channels)) &&
         set(TIFFTAG_ROWSPERSTRIP, layout.strip_rows) && set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
         set(TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL) && set(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT) &&
         (grey || TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, kStraight) == 1) &&
         (layout.options.dpi <= 0 || (set(TIFFTAG_XRESOLUTION, dpi) && set(TIFFTAG_YRESOLUTION, dpi) &&
                                      set(TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH)));
}

bool WriteStrips(TIFF* tiff, std::vector<std::vector<std::byte>>& strips) {
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const auto size = static_cast<tmsize_t>(strips[i].size());
    if (TIFFWriteRawStrip(tiff, static_cast<std::uint32_t>(i), strips[i].data(), size) != size) return false;
    strips[i] = {};
  }
  return TIFFWriteDirectory(tiff) == 1;
}

}  // namespace

Expected<std::vector<std::byte>> EncodeTiff(const std::string& name, const Picture& picture,
                                            const TiffOptions& options) {
  SCUMBLE_CHECK(picture.width > 0 && picture.height > 0 && (options.bits == 8 || options.bits == 16));
  const StripLayout layout{picture, options};
  std::vector<std::vector<std::byte>> strips(static_cast<std::size_t>(layout.strips));
  ForEachIndex(layout.strips, options.threads,
               [&](int strip) { strips[static_cast<std::size_t>(strip)] = DeflatedStrip(layout, strip); });
  MemoryFile file;
  constexpr std::size_t kDirectory = 1024, kEntry = 16;  // each strip's offset and size take 8 bytes
  std::size_t size = kDirectory + kEntry * strips.size();
  for (const auto& strip : strips) size += strip.size();
  file.bytes.reserve(size);
  bool written = false;
  if (const Tiff tiff = OpenTiff(file, name, size)) {
    written = SetFields(tiff.get(), layout) && WriteStrips(tiff.get(), strips);
  }
  if (file.is_out_of_memory) throw std::bad_alloc();
  if (written) return std::move(file.bytes);
  return OutputError("cannot write " + name + ": " + (file.error[0] ? file.error.data() : "libtiff gives no reason"));
}

}  // namespace scumble::internal
