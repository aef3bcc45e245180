#include "core/io/oiio/oiio.h"

#include <cctype>
#include <cstdint>
#include <limits>
#include <system_error>

#include "core/image/guides.h"
#include "core/io/atomic_file.h"
#include "core/io/exr/exr_integrity.h"
#include "core/io/format_dispatch.h"
#include "core/io/oiio/flat_psd.h"
#include "core/io/picture/format_detection.h"
#include "core/io/png/png_integrity.h"
#include "core/io/readable_file.h"

namespace scumble {

void formats::SetThreads(int threads) {
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

// The readers take the proxy from the configuration, and drop one that is only passed as an argument.
OIIO::ImageSpec StraightAlphaFrom(OIIO::Filesystem::IOProxy* proxy) {
  OIIO::ImageSpec config = StraightAlpha();
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  return config;
}

// Keeps the first line: the others repeat it for each layer. Removes the file's name, with which our message begins.
std::string LibraryReason(std::string reason, const std::string& name) {
  reason = reason.substr(0, reason.find('\n'));
  for (const std::string& mention : {" from image file \"" + name + "\"", " \"" + name + "\""}) {
    const std::size_t at = reason.find(mention);
    if (at != std::string::npos) reason.erase(at, mention.size());
  }
  while (!reason.empty() && (reason.back() == '\n' || reason.back() == ' ')) reason.pop_back();
  return reason.empty() ? "the picture library gives no reason" : reason;
}

bool LooksLikeScene(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* scene : {".glb", ".gltf", ".obj", ".ply", ".blend"}) {
    if (ending == scene) return true;
  }
  return false;
}

Status CheckIfPng(const std::filesystem::path& path) {
  if (!IsPngFile(path)) return Ok();
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path));
  return CheckPngIntegrity(bytes, path.string());
}

Error OpenFailure(const std::string& reason, const std::string& name) {
  return InputError("cannot read " + name + ": " + LibraryReason(reason, name));
}

// Checked before memory is allocated for pixels that so short a file cannot hold.
Status CheckDeclaredSize(const OIIO::ImageSpec& spec, const std::string& reader, std::uint64_t bytes,
                         const std::string& name) {
  const std::uint64_t most = MostSamplesInAByte(reader);
  if (most == 0 || spec.width < 1 || spec.height < 1 || spec.nchannels < 1) return Ok();
  const auto samples =
      static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height);  // of 31 bits each
  if (samples / most <= bytes / static_cast<std::uint64_t>(spec.nchannels)) return Ok();
  return InputError("cannot read " + name + ": it promises " + std::to_string(spec.width) + "×" +
                    std::to_string(spec.height) + " pixels of " + std::to_string(spec.nchannels) +
                    " channels, and its " + std::to_string(bytes) +
                    " bytes cannot hold them; it may be cut short or damaged");
}

// The TIFF library's own way from L*a*b* to RGB gives greys a yellow cast.
Status CheckColorModel(const OIIO::ImageSpec& spec, const std::string& name) {
  constexpr int kLab = 8;
  if (spec.get_int_attribute("tiff:PhotometricInterpretation") != kLab) return Ok();
  return InputError("cannot read " + name + ": its colours are L*a*b*, which is not read; save it in RGB");
}

// Opens a file of that many bytes with one reader only.
Expected<std::shared_ptr<OIIO::ImageInput>> OpenBy(const std::string& reader, const std::string& name,
                                                   std::uint64_t bytes, const OIIO::ImageSpec& config) {
  std::shared_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(reader);
  if (!input) return OpenFailure(OIIO::geterror(), name);
  // If the library was built without this reader, it would try any other.
  if (input->format_name() != reader)
    return OpenFailure("OpenImageIO was built without its reader \"" + reader + "\"", name);
  OIIO::ImageSpec spec;
  bool open = false;
  SCUMBLE_RETURN_IF_ERROR(WithoutExceptions(name, [&] { open = input->open(name, spec, config); }));
  if (!open) return OpenFailure(input->geterror(), name);
  SCUMBLE_RETURN_IF_ERROR(CheckDeclaredSize(spec, reader, bytes, name));
  SCUMBLE_RETURN_IF_ERROR(CheckColorModel(spec, name));
  return input;
}

// A PSD, the part of it that is read, and its reader, which is destroyed first.
struct PsdInput {
  std::unique_ptr<OIIO::Filesystem::IOProxy> file, flat;
  std::shared_ptr<OIIO::ImageInput> input;
};

Expected<std::shared_ptr<OIIO::ImageInput>> OpenPsd(std::unique_ptr<OIIO::Filesystem::IOProxy> file,
                                                    const std::string& name) {
  const auto psd = std::make_shared<PsdInput>();
  psd->file = std::move(file);
  SCUMBLE_ASSIGN(psd->flat, FlatPsd(*psd->file, name));
  SCUMBLE_ASSIGN(psd->input, OpenBy("psd", name, psd->file->size(), StraightAlphaFrom(psd->flat.get())));
  return std::shared_ptr<OIIO::ImageInput>(psd, psd->input.get());
}

}  // namespace

Expected<std::shared_ptr<OIIO::ImageInput>> OpenInput(const std::filesystem::path& path) {
  SCUMBLE_RETURN_IF_ERROR(CheckReadable(path));
  if (LooksLikeScene(path)) {
    return InputError("cannot read " + path.string() + ": it is a scene, and a picture or guides are expected here; " +
                      "scumble stylize and scumble guidegen take scenes");
  }
  if (auto whole = CheckIfPng(path); !whole) return whole.error();
  if (auto kept = CheckExrIntegrity(path); !kept) return kept.error();
  SCUMBLE_ASSIGN(const std::vector<std::byte> start, ReadStart(path));
  SCUMBLE_ASSIGN(const std::string reader, ReaderFor(start, path));
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  const std::uint64_t bytes = unknown ? std::numeric_limits<std::uint64_t>::max() : size;
  SCUMBLE_RETURN_IF_ERROR(CheckStart(reader, start, path.string()));
  if (reader == "psd") {
    return OpenPsd(std::make_unique<OIIO::Filesystem::IOFile>(path.string(), OIIO::Filesystem::IOProxy::Read),
                   path.string());
  }
  return OpenBy(reader, path.string(), bytes, StraightAlpha());
}

Expected<std::shared_ptr<OIIO::ImageInput>> OpenInput(OIIO::Filesystem::IOMemReader& proxy, const std::string& name) {
  const auto bytes = std::as_bytes(std::span(proxy.buffer().data(), proxy.buffer().size()));
  if (IsPng(bytes)) SCUMBLE_RETURN_IF_ERROR(CheckPngIntegrity(bytes, name));
  SCUMBLE_RETURN_IF_ERROR(CheckExrIntegrity(bytes, name));
  SCUMBLE_ASSIGN(const std::string reader, ReaderFor(bytes, name));
  SCUMBLE_RETURN_IF_ERROR(CheckStart(reader, bytes, name));
  if (reader == "psd") return OpenPsd(std::make_unique<OIIO::Filesystem::IOMemReader>(proxy.buffer()), name);
  return OpenBy(reader, name, bytes.size(), StraightAlphaFrom(&proxy));
}

Error ReadFailure(OIIO::ImageInput& input, const std::string& name) {
  const std::string reason = input.geterror();
  return InputError("cannot read " + name + ": " +
                    (reason.empty() ? "the pixel data is damaged" : LibraryReason(reason, name)));
}

Expected<std::vector<std::byte>> Encode(const std::string& name, const OIIO::ImageSpec& spec,
                                        const std::function<bool(OIIO::ImageOutput&)>& write_pixels) {
  // The JPEG writer ends the whole process when it is asked to open an empty picture.
  if (spec.width < 1 || spec.height < 1) return OutputError("cannot write " + name + ": the picture is empty");
  auto output = OIIO::ImageOutput::create(name);
  if (!output) {
    return OutputError("cannot write " + name + ": " + LibraryReason(OIIO::geterror(), name) +
                       "; name it .png, .exr, .tif or .jpg");
  }
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput proxy(encoded);
  if (!output->supports("ioproxy") || !output->set_ioproxy(&proxy)) {
    return OutputError("cannot write " + name + ": the format " + output->format_name() +
                       " cannot be written safely; name it .png, .exr, .tif or .jpg");
  }
  OIIO::ImageSpec timeless = spec;
  timeless.attribute("DateTime", "");  // the library would write the time, and equal pictures would differ
  if (!output->open(name, timeless) || !write_pixels(*output) || !output->close()) {
    return OutputError("cannot write " + name + ": " + LibraryReason(output->geterror(), name));
  }
  const auto bytes = std::as_bytes(std::span(encoded));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Status CheckSize(const OIIO::ImageSpec& spec, const std::string& name) {
  const bool fits = spec.width >= 1 && spec.height >= 1 && spec.width <= kMaxImageSide &&
                    spec.height <= kMaxImageSide && std::int64_t(spec.width) * spec.height <= kMaxPicturePixels;
  if (fits && spec.depth <= 1) return Ok();
  return InputError(name + " is " + std::to_string(spec.width) + "×" + std::to_string(spec.height) + "×" +
                    std::to_string(spec.depth) + ": expected one flat picture of at least 1×1 and at most " +
                    std::to_string(kMaxPicturePixels) + " pixels, " + std::to_string(kMaxImageSide) + " a side");
}

}  // namespace internal
}  // namespace scumble
