#include "io/oiio.h"

#include "image/guides.h"
#include "io/atomic_file.h"
#include "io/library.h"

namespace scumble {

void SetIoThreads(int threads) {
  OIIO::attribute("threads", threads);
  OIIO::attribute("exr_threads", threads == 1 ? -1 : threads);  // OpenEXR's own pool; -1 means no pool at all
}

namespace internal {
namespace {

OIIO::ImageSpec StraightAlpha() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  return config;
}

// The first line: what follows repeats it from layer to layer.
std::string LibraryReason(std::string reason) {
  reason = reason.substr(0, reason.find('\n'));
  while (!reason.empty() && (reason.back() == '\n' || reason.back() == ' ')) reason.pop_back();
  return reason.empty() ? "the picture library gives no reason" : reason;
}

}  // namespace

Expected<std::unique_ptr<OIIO::ImageInput>> OpenInput(const std::filesystem::path& path) {
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (status.type() == std::filesystem::file_type::none) {
    return InputError("cannot read " + path.string() + ": " + failed.message());
  }
  if (!std::filesystem::exists(status)) return InputError("cannot read " + path.string() + ": there is no such file");
  if (std::filesystem::is_directory(status)) return InputError("cannot read " + path.string() + ": it is a folder");
  // A pipe would be waited for without end, and the readers seek.
  if (!std::filesystem::is_regular_file(status))
    return InputError("cannot read " + path.string() + ": it is no regular file");
  if (std::filesystem::file_size(path, failed) == 0) {
    return InputError("cannot read " + path.string() + ": the file is empty");
  }
  const OIIO::ImageSpec config = StraightAlpha();
  auto input = OIIO::ImageInput::open(path.string(), &config);
  if (!input) return InputError("cannot read " + path.string() + ": " + LibraryReason(OIIO::geterror()));
  return input;
}

Expected<std::unique_ptr<OIIO::ImageInput>> OpenInput(OIIO::Filesystem::IOMemReader& proxy, const std::string& name) {
  // The readers look for the proxy in the configuration, and forget one that is only passed as an argument.
  OIIO::ImageSpec config = StraightAlpha();
  void* pointer = &proxy;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &pointer);
  auto input = OIIO::ImageInput::open(name, &config, &proxy);
  if (!input) return InputError("cannot read " + name + ": " + LibraryReason(OIIO::geterror()));
  return input;
}

Error ReadFailure(OIIO::ImageInput& input, const std::string& name) {
  const std::string reason = input.geterror();
  return InputError("cannot read " + name + ": " +
                    (reason.empty() ? "the pixel data is damaged" : LibraryReason(reason)));
}

Expected<std::vector<std::byte>> Encode(const std::string& name, const OIIO::ImageSpec& spec,
                                        const std::function<bool(OIIO::ImageOutput&)>& write_pixels) {
  // The JPEG writer ends the whole process when it is asked to open an empty picture.
  if (spec.width < 1 || spec.height < 1) return OutputError("cannot write " + name + ": the picture is empty");
  auto output = OIIO::ImageOutput::create(name);
  if (!output) {
    return OutputError("cannot write " + name + ": " + LibraryReason(OIIO::geterror()) +
                       "; name it .png, .exr, .tif or .jpg");
  }
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput proxy(encoded);
  if (!output->supports("ioproxy") || !output->set_ioproxy(&proxy)) {
    return OutputError("cannot write " + name + ": the format " + output->format_name() +
                       " cannot be written safely; name it .png, .exr, .tif or .jpg");
  }
  OIIO::ImageSpec timeless = spec;
  timeless.attribute("DateTime", "");  // the library would write the hour, and the same picture would differ by it
  if (!output->open(name, timeless) || !write_pixels(*output) || !output->close()) {
    return OutputError("cannot write " + name + ": " + LibraryReason(output->geterror()));
  }
  const auto bytes = std::as_bytes(std::span(encoded));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Status EncodeAndWrite(const std::filesystem::path& path, const OIIO::ImageSpec& spec,
                      const std::function<bool(OIIO::ImageOutput&)>& write_pixels) {
  SCUMBLE_ASSIGN(const std::vector<std::byte> encoded, Encode(path.string(), spec, write_pixels));
  return WriteFileAtomically(path, encoded);
}

Status CheckSize(const OIIO::ImageSpec& spec, const std::string& name) {
  constexpr std::int64_t kMaxPixels = std::int64_t(1) << 28;  // 16384²
  const bool fits = spec.width >= 1 && spec.height >= 1 && spec.width <= kMaxImageSide &&
                    spec.height <= kMaxImageSide && std::int64_t(spec.width) * spec.height <= kMaxPixels;
  if (fits && spec.depth <= 1) return Ok();
  return InputError(name + " is " + std::to_string(spec.width) + "×" + std::to_string(spec.height) + "×" +
                    std::to_string(spec.depth) + ": expected one flat picture of at least 1×1 and at most " +
                    std::to_string(kMaxPixels) + " pixels, " + std::to_string(kMaxImageSide) + " a side");
}

}  // namespace internal
}  // namespace scumble
