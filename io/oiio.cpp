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

std::string LibraryReason(std::string reason) {
  while (!reason.empty() && (reason.back() == '\n' || reason.back() == ' ')) reason.pop_back();
  return reason.empty() ? "the picture library gives no reason" : reason;
}

}  // namespace

Expected<std::unique_ptr<OIIO::ImageInput>> OpenInput(const std::filesystem::path& path) {
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (!std::filesystem::exists(status)) return InputError("cannot read " + path.string() + ": there is no such file");
  if (std::filesystem::is_directory(status)) return InputError("cannot read " + path.string() + ": it is a folder");
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, failed) == 0) {
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

Status EncodeAndWrite(const std::filesystem::path& path, const OIIO::ImageSpec& spec,
                      const std::function<bool(OIIO::ImageOutput&)>& write_pixels) {
  auto output = OIIO::ImageOutput::create(path.string());
  if (!output) {
    return OutputError("cannot write " + path.string() + ": " + LibraryReason(OIIO::geterror()) +
                       "; name it .png, .exr, .tif or .jpg");
  }
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput proxy(encoded);
  if (!output->supports("ioproxy") || !output->set_ioproxy(&proxy)) {
    return OutputError("cannot write " + path.string() + ": the format " + output->format_name() +
                       " cannot be written safely; name it .png, .exr, .tif or .jpg");
  }
  if (!output->open(path.string(), spec) || !write_pixels(*output) || !output->close()) {
    return OutputError("cannot write " + path.string() + ": " + LibraryReason(output->geterror()));
  }
  return WriteFileAtomically(path, std::as_bytes(std::span(encoded)));
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
