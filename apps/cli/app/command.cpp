#include "apps/cli/app/command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include "apps/cli/app/program_guard.h"
#include "apps/cli/app/progress_bar.h"

namespace scumble {

ExitCode ExitCodeFor(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return ExitCode::kUsage;
    case ErrorKind::kInput:
      return ExitCode::kInput;
    case ErrorKind::kOutput:
      return ExitCode::kOutput;
    case ErrorKind::kUnavailable:
      return ExitCode::kNotBuiltIn;
    case ErrorKind::kCancelled:
    case ErrorKind::kMemory:
      return ExitCode::kInternal;
  }
  return ExitCode::kInternal;
}

namespace {

namespace fs = std::filesystem;

// $XDG_CACHE_HOME/scumble, or ~/.cache/scumble; empty if neither is known. Relative paths in XDG_CACHE_HOME are
// ignored, as its specification says.
fs::path CacheFolder() {
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && fs::path(folder).is_absolute()) {
    return fs::path(folder) / "scumble";
  }
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "scumble";
  return {};
}

// Beside the build, and where `install` puts the program's files.
std::vector<fs::path> DataRoots(const fs::path& program) {
  if (program.empty()) return {};
  const fs::path above = program.parent_path().parent_path();
  return {above, above / "share" / "scumble"};
}

}  // namespace

void ConnectToTerminal(Globals& globals) {
  std::error_code failed;
  globals.program = fs::read_symlink("/proc/self/exe", failed);
  globals.cache_folder = CacheFolder();
  globals.data_roots = DataRoots(globals.program);
  for (char** variable = environ; *variable; ++variable) globals.environment.emplace_back(*variable);
  globals.temporary_folder = fs::temp_directory_path(failed);
  GuardPrograms(globals);
  globals.on_message = [&globals](const Message& message) {
    if (message.kind == Message::Kind::kNote && globals.quiet) return;
    ClearProgress();
    const char* const before = message.kind == Message::Kind::kWarning ? "scumble: warning: " : "";
    std::fprintf(stderr, "%s%s\n", before, OneLine(message.text).c_str());
  };
  globals.on_progress = [&globals](const std::string& label) { return ShowProgress(label, globals.quiet); };
}

std::string OneLine(const std::string& text) {
  std::string line;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto byte = static_cast<unsigned char>(c);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (byte == 0xc2 && next >= 0x80 && next < 0xa0) {  // U+0080 to U+009F in UTF-8
      line += fmt::format("\\u{:04x}", next);
      ++i;
    } else if (byte >= 0x20 && byte != 0x7f) {
      line += c;
    } else if (c == '\n' || c == '\r' || c == '\t') {
      line += c == '\n' ? "\\n" : c == '\r' ? "\\r" : "\\t";
    } else {
      line += fmt::format("\\x{:02x}", byte);
    }
  }
  return line;
}

void Print(const std::string& text) {
  ClearProgress();
  std::fputs(text.c_str(), stdout);
}

}  // namespace scumble
