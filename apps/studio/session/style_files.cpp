#include "apps/studio/session/style_files.h"

#include <system_error>

#include "core/io/atomic_file.h"
#include "core/style/style_edit.h"
#include "core/style/style_file.h"
#include "pipeline/finish_files.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

std::vector<StyleOverride> SettingsOf(const std::map<std::string, KeyValue>& keys) {
  std::vector<StyleOverride> settings;
  for (const auto& [key, value] : keys) settings.push_back(MakeExactOverride(key, value));
  return settings;
}

Status CheckName(const std::string& name) {
  constexpr std::size_t kMostLetters = 64;
  const bool is_plain =
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 _-") == std::string::npos;
  if (!name.empty() && name.size() <= kMostLetters && is_plain && name.front() != ' ' && name.front() != '-' &&
      name.back() != ' ') {
    return Ok();
  }
  return UsageError(
      "a style's name has 1 to 64 letters A to Z, digits, spaces, _ and -, and begins with a letter, a "
      "digit or _: give another name");
}

// The files that values of transfer.paper name, below `folder`.
void AddPaper(const KeyValue& value, const fs::path& folder, std::vector<fs::path>& files) {
  const auto* text = std::get_if<std::string>(&value);
  if (text && !text->empty() && text->front() != '#') files.push_back(folder / *text);
}

// The files that the style reads with these keys, at one frame or another.
Expected<std::vector<fs::path>> FilesOf(const StyleEntry& style, const std::map<std::string, KeyValue>& keys) {
  constexpr const char* kPaper = "transfer.paper";
  SCUMBLE_ASSIGN(Style read, LoadStyle(style.path));
  SCUMBLE_ASSIGN(const auto values, StyleValues(style.path));
  std::vector<fs::path> files;
  const fs::path folder = style.toml().parent_path();
  AddPaper(values.at(kPaper), folder, files);
  if (const auto given = keys.find(kPaper); given != keys.end()) AddPaper(given->second, folder, files);
  for (const StyleTrack& track : read.tracks) {
    if (track.name != kPaper) continue;
    for (const StyleTrack::Key& key : track.keys) AddPaper(key.value, track.folder, files);
  }
  for (const auto& names : {scumble::FilesOf(read.finish), MaskFilesOf(read.finish)}) {
    files.insert(files.end(), names.begin(), names.end());
  }
  if (!read.unpainted.empty()) {
    // A method without a painting leaves out those that the file names.
    auto painted = LoadStyle(style.path, {MakeOverride("transfer.method", std::string("litsphere"))});
    read.exemplars = painted ? std::move(painted->exemplars) : std::vector<Exemplar>();
  }
  for (const Exemplar& one : read.exemplars) {
    files.push_back(one.name);
    if (!one.guides_file.empty()) files.push_back(one.guides_file);
  }
  return files;
}

Status CopyStyle(const StyleEntry& style, const std::map<std::string, KeyValue>& keys, const fs::path& to) {
  std::error_code failed;
  const fs::path toml = style.toml(), from = fs::absolute(toml.empty() ? style.path : toml).parent_path();
  SCUMBLE_ASSIGN(const std::vector<fs::path> files, FilesOf(style, keys));
  for (const fs::path& file : files) {
    const fs::path place = fs::absolute(file).lexically_normal().lexically_relative(from.lexically_normal());
    if (place.empty() || *place.begin() == "..") {
      return UsageError(file.string() + " lies outside of " + from.string() +
                        ", the style's folder: move it there, and the style can be saved as a new one");
    }
    fs::create_directories((to / place).parent_path(), failed);
    fs::copy_file(file, to / place, fs::copy_options::skip_existing, failed);
    if (!failed) fs::permissions(to / place, fs::perms::owner_write, fs::perm_options::add, failed);
    if (failed) {
      return OutputError("cannot copy " + file.string() + " to " + to.string() + ": " + failed.message());
    }
  }
  return Ok();
}

}  // namespace

Expected<std::string> StyleText(const StyleEntry& style, const std::map<std::string, KeyValue>& keys) {
  const fs::path file = style.toml();
  std::string text;
  if (file.empty()) {
    const std::string name = style.path.filename().string();
    std::error_code failed;
    const bool is_method = IsUnpainted(name) && !fs::exists(style.path, failed);
    text = (is_method ? "[transfer]\nmethod = " : "[[exemplar]]\nimage = ") + TomlText(KeyValue(name)) + "\n";
  } else {
    SCUMBLE_ASSIGN(const std::vector<std::byte> bytes, ReadWholeFile(file, kMaxStyleBytes));
    text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return WithSettings(std::move(text), SettingsOf(keys), file.empty() ? style.path.string() : file.string());
}

Status SaveStyle(const StyleEntry& style, const std::map<std::string, KeyValue>& keys) {
  if (style.bundled) return UsageError(style.id + " is a bundled style: save it as a new style");
  SCUMBLE_ASSIGN(const std::string text, StyleText(style, keys));
  if (!style.IsWritable()) {
    return UsageError((style.toml().empty() ? style.path : style.toml()).string() +
                      " cannot be written: save it as a new style");
  }
  return WriteFileAtomically(style.toml(), text);
}

Expected<fs::path> SaveStyleAs(const StyleEntry& style, const std::map<std::string, KeyValue>& keys,
                               const fs::path& folder, const std::string& name) {
  SCUMBLE_RETURN_IF_ERROR(CheckName(name));
  std::error_code failed;
  const fs::path wanted = folder / name;
  if (fs::exists(fs::symlink_status(wanted, failed))) {
    return UsageError(wanted.string() + " is there already: give another name");
  }
  std::map<std::string, KeyValue> named = keys;
  named["name"] = name;
  SCUMBLE_ASSIGN(const std::string text, StyleText(style, named));
  const fs::path unfinished = folder / ("." + name + ".unfinished");
  fs::remove_all(unfinished, failed);
  fs::create_directories(unfinished, failed);
  if (failed) return OutputError("cannot make the folder " + unfinished.string() + ": " + failed.message());
  Status done = CopyStyle(style, keys, unfinished);
  if (done) done = WriteFileAtomically(unfinished / "style.toml", text);
  if (done) {
    fs::rename(unfinished, wanted, failed);
    if (failed) done = OutputError("cannot make the folder " + wanted.string() + ": " + failed.message());
  }
  if (done) return wanted;
  fs::remove_all(unfinished, failed);
  return done.error();
}

}  // namespace scumble
