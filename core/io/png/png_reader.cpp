#include "core/io/png/png_reader.h"

#include <png.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/io/color_profile.h"
#include "core/io/picture_rules.h"

namespace scumble::internal {
namespace {

struct Source {
  std::span<const std::byte> left;
};

void Take(png_structp png, png_bytep out, std::size_t count) {
  Source& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (count > source.left.size()) png_error(png, "too short");
  std::memcpy(out, source.left.data(), count);
  source.left = source.left.subspan(count);
}
[[noreturn]] void Fail(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void Ignore(png_structp, png_const_charp) {}

// Allocates a row, a text or a profile. libpng trusts a chunk's length, and its own limit only makes it warn.
png_voidp Allocate(png_structp png, png_alloc_size_t bytes) {
  constexpr png_alloc_size_t kMost = png_alloc_size_t(1) << 24;
  if (bytes > kMost) png_error(png, "too large");
  return std::malloc(bytes);
}
void Free(png_structp, png_voidp memory) { std::free(memory); }

// Whether a text has no influence on colours or orientation. The picture library would apply such a text.
bool IsHarmless(const png_text& text) {
  std::string key = text.key ? text.key : "";
  for (char& c : key) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (key == "oiio:colorspace") return text.text && std::strcmp(text.text, "sRGB") == 0;
  return key != "orientation" && !key.starts_with("oiio:") && !key.starts_with("xml:") &&
         !key.starts_with("raw profile") && !key.starts_with("exif:");
}

// OpenImageIO from 2.5 on writes such a chunk into every picture: a header, and a list of no entries.
bool IsEmptyExif(const png_byte* exif, png_uint_32 size) {
  constexpr png_uint_32 kSize = 14;
  return size == kSize && (std::memcmp(exif, "MM\0*\0\0\0\x08\0\0\0\0\0\0", kSize) == 0 ||
                           std::memcmp(exif, "II*\0\x08\0\0\0\0\0\0\0\0\0", kSize) == 0);
}

bool IsPlain(png_structp png, png_infop info) {
  constexpr double kNearlyLinear = 0.2;
  double gamma = 0;
  if (png_get_gAMA(png, info, &gamma) != 0 && std::fabs(gamma - 1.0) < kNearlyLinear) return false;
  png_bytep exif = nullptr;
  png_uint_32 exif_size = 0;
  if (png_get_eXIf_1(png, info, &exif_size, &exif) != 0 && !IsEmptyExif(exif, exif_size)) return false;
  if (png_get_x_offset_pixels(png, info) != 0 || png_get_y_offset_pixels(png, info) != 0) return false;
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(png, info, &texts, &count);
  return std::all_of(texts, texts + count, IsHarmless);
}

bool IsOfASizeThatWeTake(std::int64_t width, std::int64_t height) {
  return width <= kMaxImageSide && height <= kMaxImageSide && width * height <= kMaxPicturePixels;
}

// libpng leaves by longjmp, which skips destructors. So resources live outside of these two functions.
struct Reading {
  png_structp png = nullptr;
  png_infop info = nullptr;
  int channels = 0, bits = 0;
  std::vector<std::byte> profile;  // ICC
  ~Reading() { png_destroy_read_struct(&png, &info, nullptr); }
};

// Reads the header and sets the form of the rows: 8 or 16 bits, 1 to 4 channels. Of a PNG that is not plain, it reads
// the profile and fails.
bool ReadHead(Reading& reading, Picture& picture) {
  if (setjmp(png_jmpbuf(reading.png)) != 0) return false;
  png_structp png = reading.png;
  png_infop info = reading.info;
  png_read_info(png, info);
  png_charp name = nullptr;
  int packing = 0;
  png_bytep profile = nullptr;
  png_uint_32 profile_bytes = 0;
  if (png_get_iCCP(png, info, &name, &packing, &profile, &profile_bytes) != 0) {
    const auto bytes = std::as_bytes(std::span(profile, profile_bytes));
    reading.profile.assign(bytes.begin(), bytes.end());
  }
  const std::int64_t width = png_get_image_width(png, info), height = png_get_image_height(png, info);
  if (!IsPlain(png, info) || !IsOfASizeThatWeTake(width, height)) return false;
  picture.width = static_cast<int>(width), picture.height = static_cast<int>(height);
  png_set_expand(png);  // palettes to colours, one to four bits to eight, a transparent colour to alpha
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  reading.channels = png_get_channels(png, info), reading.bits = png_get_bit_depth(png, info);
  return reading.bits == 8 || reading.bits == 16;
}

bool ReadRows(const Reading& reading, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reading.png)) != 0) return false;
  png_read_image(reading.png, rows);
  return true;
}

// All of them, row by row.
bool ReadSamples(const Reading& reading, const Picture& size, std::vector<png_byte>& samples) {
  const std::size_t row_bytes = std::size_t(size.width) * std::size_t(reading.channels * reading.bits / 8);
  samples.resize(row_bytes * std::size_t(size.height));
  std::vector<png_bytep> rows(std::size_t(size.height));
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = samples.data() + row_bytes * y;
  return ReadRows(reading, rows.data());
}

// The places of a pixel's four values among those of the file; -1: opaque.
struct Order {
  int r, g, b, a;
};
constexpr Order kOrders[] = {{0, 0, 0, -1}, {0, 0, 0, 1}, {0, 1, 2, -1}, {0, 1, 2, 3}};

template <class Sample>
void Spread(const std::vector<png_byte>& samples, int channels, const Sample& sample, Picture& picture) {
  const Order order = kOrders[channels - 1];
  const std::size_t step = static_cast<std::size_t>(channels);
  for (std::size_t i = 0, at = 0; i < picture.rgba.size(); i += 4, at += step) {
    std::uint16_t* const out = picture.rgba.data() + i;
    out[0] = sample(samples, at + std::size_t(order.r));
    out[1] = sample(samples, at + std::size_t(order.g));
    out[2] = sample(samples, at + std::size_t(order.b));
    out[3] = order.a < 0 ? std::uint16_t(65535) : sample(samples, at + std::size_t(order.a));
  }
}

std::uint16_t From8(const std::vector<png_byte>& samples, std::size_t i) {
  return static_cast<std::uint16_t>(samples[i] * 257u);
}
std::uint16_t From16(const std::vector<png_byte>& samples, std::size_t i) {
  return static_cast<std::uint16_t>(samples[2 * i] << 8 | samples[2 * i + 1]);
}

bool Begin(Source& source, Reading& reading, Picture& picture) {
  reading.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, nullptr, Fail, Ignore, nullptr, Allocate, Free);
  if (!reading.png) return false;
  reading.info = png_create_info_struct(reading.png);
  if (!reading.info) return false;
  png_set_read_fn(reading.png, &source, Take);
  return ReadHead(reading, picture);
}

}  // namespace

std::optional<Picture> ReadPlainPng(std::span<const std::byte> bytes, Profiles profiles, PictureLosses* losses) {
  Source source{bytes};
  Reading reading;
  Picture picture;
  std::vector<png_byte> samples;
  if (!Begin(source, reading, picture) || !ReadSamples(reading, picture, samples)) return std::nullopt;
  picture.rgba.resize(std::size_t(4) * std::size_t(picture.width) * std::size_t(picture.height));
  if (reading.bits == 8)
    Spread(samples, reading.channels, From8, picture);
  else
    Spread(samples, reading.channels, From16, picture);
  if (!reading.profile.empty() && profiles == Profiles::kApply) {
    const int change = ConvertToSrgb(reading.profile, picture);
    if (losses) losses->profile_change = change;
  }
  return picture;
}

std::optional<ChannelImage> ReadPlainPngChannels(std::span<const std::byte> bytes, const std::string& name) {
  Source source{bytes};
  Reading reading;
  Picture size;
  std::vector<png_byte> samples;
  if (!Begin(source, reading, size) || !ReadSamples(reading, size, samples)) return std::nullopt;
  ChannelImage image;
  image.name = name, image.width = size.width, image.height = size.height;
  const std::size_t channels = static_cast<std::size_t>(reading.channels);
  for (std::size_t c = 0; c < channels; ++c) {
    image.names.emplace_back(1, (channels < 3 ? "YA" : "RGBA")[c]);
    auto& plane = image.planes.emplace_back(image.pixel_count());
    for (std::size_t i = 0; i < plane.size(); ++i) {
      const std::size_t at = i * channels + c;
      plane[i] = reading.bits == 8 ? static_cast<float>(samples[at]) * (1.0f / 255.0f)
                                   : static_cast<float>(From16(samples, at)) * (1.0f / 65535.0f);
    }
  }
  return image;
}

std::optional<PictureHeader> PlainPngHeader(std::span<const std::byte> bytes) {
  Source source{bytes};
  Reading reading;
  Picture size;
  if (!Begin(source, reading, size)) return std::nullopt;
  PictureHeader header{size.width, size.height, reading.bits, 0};
  png_uint_32 across = 0, down = 0;
  int unit = PNG_RESOLUTION_UNKNOWN;
  if (png_get_pHYs(reading.png, reading.info, &across, &down, &unit) != 0 && unit == PNG_RESOLUTION_METER)
    header.dpi = TrueDpi(static_cast<float>(across) * 0.0254f);
  return header;
}

std::optional<StoredPicture> InspectPlainPng(std::span<const std::byte> bytes) {
  Source source{bytes};
  Reading reading;
  Picture picture;
  if (!Begin(source, reading, picture)) return std::nullopt;
  StoredPicture stored{picture.width, picture.height, reading.channels, reading.bits, {}};
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(reading.png, reading.info, &texts, &count);
  for (const png_text& text : std::span(texts, static_cast<std::size_t>(count))) {
    if (text.key && text.text && std::strcmp(text.key, kSettingsKey) == 0) stored.settings = text.text;
  }
  return stored;
}

std::vector<std::byte> PngProfile(std::span<const std::byte> bytes) {
  Source source{bytes};
  Reading reading;
  Picture size;
  static_cast<void>(Begin(source, reading, size));
  return std::move(reading.profile);
}

}  // namespace scumble::internal
