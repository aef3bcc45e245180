#include "core/io/exr/scanline_exr.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOpaqueAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <list>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>

#include "core/image/guides.h"
#include "core/io/exr/exr_integrity.h"
#include "core/io/exr/half_float.h"
#include "core/io/format_dispatch.h"

namespace scumble::internal {
namespace {

// A file in memory.
class MemoryOutput : public Imf::OStream {
 public:
  // Reserves the size of an incompressible file: a growing file would be in memory twice while it is copied.
  MemoryOutput(const std::string& name, std::size_t room) : Imf::OStream(name.c_str()) { bytes_.reserve(room); }

  void write(const char bytes[], int count) override {
    const std::size_t end = at_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + at_, bytes, static_cast<std::size_t>(count));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = static_cast<std::size_t>(at); }

  std::vector<std::byte> Take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
};

// The bytes of an attribute, for the library to copy.
class BlobInput : public Imf::IStream {
 public:
  explicit BlobInput(const ExrBlob& blob) : Imf::IStream("attribute"), bytes_(blob.bytes) {}

  bool read(char to[], int count) override {
    std::memcpy(to, bytes_.data() + at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = static_cast<std::size_t>(at); }

 private:
  const std::vector<std::byte>& bytes_;
  std::size_t at_ = 0;
};

// Sets OpenEXR's threads, which OpenImageIO shares and sets in the same manner. With one thread there is none beside
// the caller's.
void SetThreads() {
  static std::mutex mutex;
  static int last = -1;
  const std::lock_guard lock(mutex);
  const int threads = IoThreads() == 0 ? static_cast<int>(std::thread::hardware_concurrency()) : IoThreads();
  if (threads == last) return;
  last = threads;
  try {
    // One thread first: if the system refuses it, the library's pool is still unused and may be left alone.
    Imf::setGlobalThreadCount(threads == 1 ? 0 : 1);
    if (threads > 1) Imf::setGlobalThreadCount(threads);
  } catch (const std::system_error&) {
    // The pool accepts work without a thread and drops it: the file has no pixels, and no error is reported.
    throw;
  }
}

Imf::Compression CompressionOf(const std::string& name) {
  if (name == "none") return Imf::NO_COMPRESSION;
  if (name == "rle") return Imf::RLE_COMPRESSION;
  if (name == "zips") return Imf::ZIPS_COMPRESSION;
  return name == "piz" ? Imf::PIZ_COMPRESSION : Imf::ZIP_COMPRESSION;
}

// The file's size if nothing packs.
std::size_t RoomFor(const ExrImage& image) {
  constexpr std::size_t kHeader = 1 << 16, kOfRow = 32;  // their offsets and sizes
  std::size_t room = kHeader + kOfRow * static_cast<std::size_t>(image.height);
  for (const ExrChannel& channel : image.channels) room += channel.values.size() * (channel.half ? 2 : 4);
  for (const auto& [name, blob] : image.blobs) room += blob.bytes.size();
  return room;
}

Imf::Header HeaderOf(const ExrImage& image) {
  Imf::Header header(image.width, image.height);
  header.insert("capDate", Imf::StringAttribute());  // no date, so that the same picture is the same file at any hour
  header.compression() = CompressionOf(image.compression);
  for (const auto& [name, value] : image.texts) header.insert(name, Imf::StringAttribute(value));
  for (const auto& [name, matrix] : image.matrices) {
    Imath::M44f rounded;
    for (int i = 0; i < 16; ++i) rounded[i / 4][i % 4] = static_cast<float>(matrix[i / 4][i % 4]);
    header.insert(name, Imf::M44fAttribute(rounded));
  }
  for (const auto& [name, blob] : image.blobs) {
    Imf::OpaqueAttribute attribute(blob.type.c_str());
    BlobInput input(blob);
    attribute.readValueFrom(input, static_cast<int>(blob.bytes.size()), 0);
    header.insert(name, attribute);
  }
  for (const ExrChannel& channel : image.channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.half ? Imf::HALF : Imf::FLOAT));
  }
  return header;
}

// Empty if the file is not plain.
std::optional<ExrHeader> PlainHeader(const Imf::Header& header) {
  const Imath::Box2i window = header.dataWindow();
  if (window != header.displayWindow() || header.hasTileDescription()) return std::nullopt;
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE) return std::nullopt;
  // In 64 bits, because a damaged header may hold any numbers.
  const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1;
  const std::int64_t height = std::int64_t(window.max.y) - window.min.y + 1;
  const bool fits = width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide;
  if (!fits || width * height > kMaxPicturePixels) return std::nullopt;
  ExrHeader plain{static_cast<int>(width), static_cast<int>(height), {}, {}, {}};
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const Imf::Channel& found = channel.channel();
    if (found.type == Imf::UINT || found.xSampling != 1 || found.ySampling != 1) return std::nullopt;
    plain.channels[channel.name()] = found.type == Imf::HALF;
  }
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    if (const auto* const blob = dynamic_cast<const Imf::OpaqueAttribute*>(&attribute.attribute())) {
      const std::byte* const bytes = reinterpret_cast<const std::byte*>(static_cast<const char*>(blob->data()));
      plain.blobs[attribute.name()] = {blob->typeName(), {bytes, bytes + blob->dataSize()}};
      continue;
    }
    const auto* const text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
    const std::string value =
        text ? text->value().c_str() : "";  // up to a NUL; empty texts are left out, as the module does
    if (!value.empty()) plain.texts[attribute.name()] = value;
  }
  return plain;
}

// A frame buffer over rows of that many values. The library only reads them here.
template <class T>
Imf::Slice SliceOf(Imf::PixelType type, const T* values, std::size_t width) {
  return Imf::Slice(type, reinterpret_cast<char*>(const_cast<T*>(values)), sizeof(T), sizeof(T) * width);
}

}  // namespace

Expected<std::vector<std::byte>> EncodeExr(const std::string& name, const ExrImage& image) {
  if (image.width < 1 || image.height < 1 || image.channels.empty()) {
    return OutputError("cannot write " + name + ": the picture is empty");
  }
  SetThreads();
  try {
    MemoryOutput bytes(name, RoomFor(image));
    std::size_t first_chunk = 0;
    {
      Imf::OutputFile file(bytes, HeaderOf(image));
      first_chunk = bytes.tellp();
      Imf::FrameBuffer buffer;
      std::list<std::vector<Imath::half>> rounded;
      const std::size_t width = static_cast<std::size_t>(image.width);
      for (const ExrChannel& channel : image.channels) {
        if (channel.half) {
          auto& halves = rounded.emplace_back(channel.values.size());
          std::transform(channel.values.begin(), channel.values.end(), halves.begin(), ToHalf);
          buffer.insert(channel.name, SliceOf(Imf::HALF, halves.data(), width));
        } else {
          buffer.insert(channel.name, SliceOf(Imf::FLOAT, channel.values.data(), width));
        }
      }
      file.setFrameBuffer(buffer);
      file.writePixels(image.height);
    }
    // The library reports no error for rows that its threads had no memory for. Their offsets, before the first chunk,
    // are 0.
    std::vector<std::byte> encoded = bytes.Take();
    const std::size_t rows = image.compression == "zip" ? 16 : image.compression == "piz" ? 32 : 1;
    const std::size_t chunks = (static_cast<std::size_t>(image.height) + rows - 1) / rows;
    for (std::size_t i = 1; i <= chunks; ++i) {
      std::uint64_t place = 0;
      std::memcpy(&place, encoded.data() + first_chunk - i * sizeof place, sizeof place);
      if (place == 0) throw std::bad_alloc();
    }
    return encoded;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    return OutputError("cannot write " + name + ": " + failure.what());
  }
}

std::optional<ExrHeader> ReadPlainExr(const std::filesystem::path& path,
                                      const std::function<std::optional<PlaneFor>(const ExrHeader&)>& look) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return std::nullopt;  // reading a pipe would wait without end
  if (!CheckExrIntegrity(path)) return std::nullopt;
  SetThreads();
  try {
    Imf::MultiPartInputFile file(path.c_str());
    if (file.parts() != 1) return std::nullopt;
    const std::optional<ExrHeader> header = PlainHeader(file.header(0));
    const std::optional<PlaneFor> plane_for = header ? look(*header) : std::nullopt;
    if (!plane_for) return std::nullopt;
    const Imath::Box2i window = file.header(0).dataWindow();
    Imf::FrameBuffer buffer;
    for (const auto& [name, half] : header->channels) {
      const std::span<float> plane = (*plane_for)(name);
      if (plane.empty()) continue;
      buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.data(), window, sizeof(float),
                                           sizeof(float) * static_cast<std::size_t>(header->width)));
    }
    if (buffer.begin() != buffer.end()) {
      Imf::InputPart part(file, 0);
      part.setFrameBuffer(buffer);
      part.readPixels(window.min.y, window.max.y);
    }
    return header;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace scumble::internal
