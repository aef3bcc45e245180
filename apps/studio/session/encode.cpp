#include "apps/studio/session/encode.h"

#include <turbojpeg.h>

#include <memory>

#include "core/io/picture_file.h"
#include "core/io/png_writer.h"

namespace scumble {
namespace {

std::string TextOfBytes(const void* bytes, std::size_t count) { return {static_cast<const char*>(bytes), count}; }

Expected<std::string> EncodeJpeg(const Picture& picture, bool draft) {
  std::vector<std::uint8_t> rgb = In8Bits(picture);
  for (std::size_t i = 0; i < rgb.size(); i += 4) {
    const int alpha = rgb[i + 3];
    if (alpha == 255) continue;
    for (int c = 0; c < 3; ++c) rgb[i + c] = std::uint8_t((rgb[i + c] * alpha + 255 * (255 - alpha) + 127) / 255);
  }
  const std::unique_ptr<void, int (*)(tjhandle)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* bytes = nullptr;
  unsigned long count = 0;
  const bool failed =
      !encoder || tjCompress2(encoder.get(), rgb.data(), picture.width, 0, picture.height, TJPF_RGBX, &bytes, &count,
                              draft ? TJSAMP_420 : TJSAMP_444, draft ? 90 : 92, TJFLAG_FASTDCT) != 0;
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(bytes, tjFree);
  if (failed) return MemoryError("the picture cannot be packed as JPEG: " + std::string(tjGetErrorStr()));
  return TextOfBytes(bytes, count);
}

}  // namespace

std::optional<FrameFormat> FindFrameFormat(const std::string& name) {
  if (name == "jpeg") return FrameFormat::kJpeg;
  if (name == "rgba") return FrameFormat::kRgba;
  if (name == "png") return FrameFormat::kPng;
  return std::nullopt;
}

std::string ContentTypeOf(FrameFormat format) {
  switch (format) {
    case FrameFormat::kJpeg:
      return "image/jpeg";
    case FrameFormat::kRgba:
      return "application/octet-stream";
    case FrameFormat::kPng:
      return "image/png";
  }
  return {};
}

Expected<std::string> EncodeFrame(const Picture& picture, FrameFormat format, bool draft) {
  if (format == FrameFormat::kJpeg) return EncodeJpeg(picture, draft);
  if (format == FrameFormat::kRgba) {
    const std::vector<std::uint8_t> bytes = In8Bits(picture);
    return TextOfBytes(bytes.data(), bytes.size());
  }
  internal::PngOptions options;
  options.level = 1;
  const std::vector<std::byte> bytes = internal::WritePng(picture, options);
  return TextOfBytes(bytes.data(), bytes.size());
}

}  // namespace scumble
