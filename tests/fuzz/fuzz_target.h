// Targets for arbitrary inputs. A target is a function of any bytes: it must return; memory errors, undefined
// behaviour, exceptions that come out of it and broken contracts (SCUMBLE_CHECK) are faults. Each stands in a file of
// its own, tests/fuzz/NAME_fuzz.cpp. With libFuzzer (SCUMBLE_FUZZ) each file is a program; without, all of them are in
// one table, which tests/fuzz/fuzz_regression_test.cpp runs over seeds, crashes and mutations.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/check.h"
#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/io/library.h"

namespace scumble::fuzz {

using Bytes = std::span<const std::uint8_t>;

struct Target {
  std::string name;
  void (*run)(Bytes input);
};

// In the order in which the linker met them.
inline std::vector<Target>& Targets() {
  static std::vector<Target> targets;
  return targets;
}

inline std::string_view AsText(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// A folder of this process for what the loaders read from disk; gone when the process ends in peace.
inline const std::filesystem::path& Folder() {
  struct Owner {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("scumble_fuzz_" + std::to_string(::getpid()));
    Owner() { std::filesystem::create_directories(path); }
    ~Owner() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Owner owner;
  return owner.path;
}

// Writes a file of that name into the folder; returns its path.
inline std::filesystem::path InFile(const std::string& name, Bytes bytes) {
  const std::filesystem::path path = Folder() / name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

// Every refusal must have a message, no longer than a screen.
template <class T>
void CheckRefusal(const Expected<T>& result, std::size_t longest = 4000) {
  if (result) return;
  SCUMBLE_CHECK(!result.error().message.empty());
  SCUMBLE_CHECK_LT(result.error().message.size(), longest);
}

// The most pixels that a target has time for: if a header declares more, only the header is inspected.
constexpr std::int64_t kMostPixels = 1 << 20;

}  // namespace scumble::fuzz

#ifdef SCUMBLE_LIBFUZZER
// Exceptions are left to libFuzzer, which reports them as crashes.
#define SCUMBLE_FUZZ_TARGET(name, body)                                                      \
  extern "C" int LLVMFuzzerInitialize(int*, char***) { return scumble::SetIoThreads(1), 0; } \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {        \
    body(scumble::fuzz::Bytes(data, size));                                                  \
    return 0;                                                                                \
  }
#else
#define SCUMBLE_FUZZ_TARGET(name, body) \
  static const bool kIsListed_##name = (scumble::fuzz::Targets().push_back({#name, &body}), true);
#endif
