#include "io/formats.h"

#include <dlfcn.h>

#include <atomic>
#include <string>

#include "io/channel_file.h"
#include "io/library.h"

namespace scumble {
namespace {

std::atomic<int> io_threads{0};

constexpr const char* kFile = "libscumble_formats.so";

Expected<const Formats*> Load() {
  // Found by the program's own run path: beside it in a build, in ../lib/scumble where it is installed. What the
  // module's libraries define stays out of everybody else's way.
  void* const module = ::dlopen(kFile, RTLD_LAZY | RTLD_LOCAL);
  const char* const reason = module ? nullptr : ::dlerror();
  const void* const found = module ? ::dlsym(module, "scumble_formats_" SCUMBLE_MODULE_VERSION) : nullptr;
  if (found) return static_cast<const Formats*>(found);
  return UnavailableError(std::string(kFile) + ", which reads and writes EXR, JPEG and TIFF, " +
                          (module ? "is of another version than scumble" : "cannot be loaded") +
                          (reason ? " (" + std::string(reason) + ")" : "") + ": build or install scumble again, with all of its files");
}

}  // namespace

Expected<const Formats*> LoadFormats() {
  static const Expected<const Formats*> kFormats = [] {
    const Expected<const Formats*> loaded = Load();
    if (loaded) (*loaded)->set_threads(io_threads);
    return loaded;
  }();
  return kFormats;
}

void SetIoThreads(int threads) { io_threads = threads; }

int internal::IoThreads() { return io_threads; }

Expected<ChannelImage> ReadChannels(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  return formats->read_channels(path);
}

Expected<GuideSet> ReadGuides(const std::filesystem::path& path, const GuideReadOptions& options) {
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  return formats->read_guides(path, options);
}

Expected<GuideFileInfo> InspectGuides(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  return formats->inspect_guides(path);
}

Status WriteGuides(const std::filesystem::path& path, const GuideSet& guides, const GuideWriteOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckGuideTarget(path, options));
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  return formats->write_guides(path, guides, options);
}

}  // namespace scumble
