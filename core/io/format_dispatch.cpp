#include "core/io/format_dispatch.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/io/atomic_file.h"
#include "core/io/channel_file.h"
#include "core/io/guides/normal_space.h"
#include "core/io/guides/own_guides.h"
#include "core/io/library.h"
#include "core/io/png/png_integrity.h"
#include "core/io/png/png_reader.h"
#include "core/io/readable_file.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

std::atomic<int> io_threads{0};
std::atomic<bool> is_loaded{false};

std::mutex more_folders_mutex;
std::vector<fs::path> more_folders;

constexpr const char* kFile = "libscumble_formats.so";

// Beside the program, as in a build, or the place of installation. Only files of these full names are loaded: a bare
// name would be searched for along the environment's paths or in the working folder.
std::vector<fs::path> Folders() {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return {};
  const fs::path folder = program.parent_path();
  std::vector<fs::path> folders = {folder, (folder / "../lib/scumble").lexically_normal()};
  const std::lock_guard lock(more_folders_mutex);
  folders.insert(folders.end(), more_folders.begin(), more_folders.end());
  return folders;
}

Error Unusable(const std::string& module, const std::string& what) {
  return UnavailableError(module + ", which reads EXR, JPEG and TIFF and writes JPEG, " + what +
                          ": build or install scumble again, with all of its files");
}

// The loader's message when the system refuses it memory.
bool IsForWantOfMemory(std::string_view reason) {
  constexpr std::string_view kWords[] = {"failed to map segment", "cannot map zero-fill pages", "annot allocate memory",
                                         "cannot create", "cannot change memory protections"};
  return std::any_of(std::begin(kWords), std::end(kWords),
                     [&](std::string_view words) { return reason.find(words) != std::string_view::npos; });
}

// Address space, not memory: more than the 655 MB that the module and its libraries take with Debian's OpenImageIO.
constexpr std::size_t kModuleAddresses = std::size_t(768) << 20;

// Whether that many bytes of address space are available, under a limit such as ulimit's.
bool HasAddresses(std::size_t bytes) {
  void* const start = ::mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (start == MAP_FAILED) return false;
  ::munmap(start, bytes);
  return true;
}

Expected<const Formats*> LoadFrom(const fs::path& path) {
  // The libraries' initialisers crash or hang if memory ends among them, so the space is checked before.
  if (!HasAddresses(kModuleAddresses)) throw std::bad_alloc();
  // Symbols of the module's libraries stay private to it.
  void* const module = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (!module) {
    const char* const reason = ::dlerror();
    if (reason && IsForWantOfMemory(reason)) throw std::bad_alloc();
    return Unusable(path.string(), "cannot be loaded (" + std::string(reason ? reason : "no reason is given") + ")");
  }
  const auto* const found = static_cast<const Formats*>(::dlsym(module, "scumble_formats_" SCUMBLE_MODULE_VERSION));
  if (found && found->layout == kFormatsLayout) return found;
  ::dlclose(module);
  return Unusable(path.string(), "is of another version than scumble");
}

Expected<const Formats*> Load() {
  std::string searched;
  for (const fs::path& folder : Folders()) {
    std::error_code failed;
    if (fs::exists(folder / kFile, failed)) return LoadFrom(folder / kFile);
    searched += (searched.empty() ? "" : " or ") + folder.string();
  }
  return Unusable(kFile,
                  searched.empty() ? "cannot be looked for: /proc/self/exe is not readable" : "is not in " + searched);
}

}  // namespace

Expected<const Formats*> LoadFormats(const std::string& file) {
  try {
    static std::mutex mutex;
    static const Formats* formats = nullptr;  // a failure is not kept: SetModuleFolder may come later
    const std::lock_guard lock(mutex);
    if (!formats) {
      SCUMBLE_ASSIGN(formats, Load());
      formats->set_threads(io_threads);
      is_loaded = true;
    }
    return formats;
  } catch (const std::bad_alloc&) {
    return MemoryError(
        "out of memory for " + file + ": the library that reads and writes its format takes " +
        std::to_string(kModuleAddresses >> 20) +
        " MB of addresses, whatever the picture's size; allow so much more (ulimit -v), or use a plain PNG, " +
        "or the EXR files that scumble itself writes, wherever a picture or guides are read or written");
  }
}

Expected<const Formats*> LoadFormatsToRead(const std::filesystem::path& path) {
  SCUMBLE_RETURN_IF_ERROR(internal::CheckReadable(path));
  return LoadFormats(path.string());
}

void SetModuleFolder(const fs::path& folder) {
  const std::lock_guard lock(more_folders_mutex);
  const fs::path normal = folder.lexically_normal();
  if (std::find(more_folders.begin(), more_folders.end(), normal) == more_folders.end()) more_folders.push_back(normal);
}

void SetIoThreads(int threads) { io_threads = threads; }

bool IsLibraryLoaded() { return is_loaded; }

int internal::IoThreads() { return io_threads; }

Expected<ChannelImage> ReadChannels(const std::filesystem::path& path) {
  if (internal::IsPngFile(path)) {
    SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path));
    if (internal::CheckPngIntegrity(bytes, path.string())) {
      if (auto plain = internal::ReadPlainPngChannels(bytes, path.string())) return *std::move(plain);
    }
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormatsToRead(path));
  return formats->read_channels(path);
}

Expected<GuideSet> ReadGuides(const std::filesystem::path& path, const GuideReadOptions& options) {
  auto guides = internal::ReadPlainGuides(path, options);
  if (!guides) {
    SCUMBLE_ASSIGN(const Formats* const formats, LoadFormatsToRead(path));
    guides = formats->read_guides(path, options);
  }
  // Guides of ours, and of Blender's renders, have a camera.
  if (*guides && !(*guides)->camera) SCUMBLE_RETURN_IF_ERROR(internal::CheckNormalSpace(**guides, path.string()));
  return *std::move(guides);
}

Expected<GuideFileInfo> InspectGuides(const std::filesystem::path& path) {
  if (auto plain = internal::InspectPlainGuides(path)) return *std::move(plain);
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormatsToRead(path));
  return formats->inspect_guides(path);
}

}  // namespace scumble
