#include "pipeline/run_inputs.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include "core/io/atomic_file.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

using Identity = std::pair<unsigned long, unsigned long>;

// Of the file that the name leads to, links followed; nothing where there is no plain file.
std::optional<Identity> IdentityOf(const std::string& path) {
  struct stat file;
  if (::stat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return std::nullopt;
  return Identity{file.st_dev, file.st_ino};
}

// No system takes longer names.
constexpr std::size_t kLongestName = 4096;

// Of a text file, where it names files. Those of /proc, which say that they are empty, name none.
std::string StartOf(const fs::path& path) {
  constexpr std::uintmax_t kMost = std::uintmax_t(16) << 20;
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  if (failed) return {};
  std::ifstream stream(path, std::ios::binary);
  std::string text(static_cast<std::size_t>(std::min(size, kMost)), '\0');
  stream.read(text.data(), std::streamsize(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

}  // namespace

void RunInputs::Reads(const std::string& what, const std::string& path) {
  if (const auto identity = IdentityOf(path)) inputs_.try_emplace(*identity, Input{what, path});
}

void RunInputs::ReadsQuoted(const std::string& what, const std::string& file, const std::string& folder) {
  const std::string text = StartOf(file);
  for (std::size_t begin = text.find_first_of("\"'"); begin != std::string::npos;) {
    const std::size_t end = text.find(text[begin], begin + 1);
    if (end == std::string::npos) return;
    if (end - begin <= kLongestName) Reads(what, (fs::path(folder) / text.substr(begin + 1, end - begin - 1)).string());
    // A quotation mark alone, as in a comment, must not hide the names after it.
    const std::size_t line = text.find('\n', begin);
    begin = text.find_first_of("\"'", (line < end ? line : end) + 1);
  }
}

FileListener RunInputs::ReadsScene(const std::string& scene) {
  Reads("the scene", scene);
  return [this, what = "a file of the scene " + scene](const fs::path& file) { Reads(what, file.string()); };
}

std::vector<std::string> RunInputs::Inputs() const {
  std::vector<std::string> paths;
  for (const auto& [identity, input] : inputs_) paths.push_back(input.path);
  std::sort(paths.begin(), paths.end());
  return paths;
}

void RunInputs::ReadsStyles(const StyleSet& styles) {
  styles_ = styles.opened.size();
  std::error_code failed;
  for (const auto& [path, place] : styles.opened) {
    const Style& style = styles.styles[place];
    const std::string what = "a file of the style " + style.name;
    for (const Exemplar& exemplar : style.exemplars) Reads(what, exemplar.name);
    fs::path file = path;
    if (fs::is_directory(file, failed)) file /= "style.toml";
    if (file.extension() != ".toml") file = file.parent_path() / "style.toml";  // which a picture may stand for
    if (!IdentityOf(file.string())) continue;
    Reads(what, file.string());
    ReadsQuoted(what, file.string(), file.parent_path().string());
  }
  for (const StyleOverride& set : styles.options.sets) {
    const auto reads = [&](const KeyValue& value) {
      if (const auto* file = std::get_if<std::string>(&value)) Reads("--set " + ToText(set), *file);
    };
    if (const auto* frames = std::get_if<StyleOverride::Frames>(&set.value)) {
      for (const StyleTrack::Key& key : *frames) reads(key.value);
    } else {
      reads(std::get<KeyValue>(set.value));
    }
  }
}

Status RunInputs::CheckOutputs(std::span<const std::string> outputs, const std::string& option, bool resumes) {
  const std::size_t read = inputs_.size();
  checked_ = kNever;  // until all of them have passed
  for (const std::string& output : outputs) {
    const auto identity = IdentityOf(output);
    const auto found = identity ? inputs_.find(*identity) : inputs_.end();
    if (found == inputs_.end()) continue;
    const Input& input = found->second;
    const bool is_named_so = fs::path(input.path).lexically_normal() == fs::path(output);
    const std::string also = is_named_so ? "" : ", by the name " + input.path;
    return UsageError(option + " " + output + " would overwrite " + input.what + also + ": give another name");
  }
  bool knows_folder = false;
  for (const std::string& output : outputs) {
    if (resumes && IdentityOf(output)) continue;  // RunSequence checks those that it does not keep
    if (!knows_folder || MayRefuseWriting(output)) SCUMBLE_RETURN_IF_ERROR(CheckWritable(output));
    knows_folder = true;
  }
  checked_ = read;
  return Ok();
}

}  // namespace scumble
