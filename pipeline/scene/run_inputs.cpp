#include "pipeline/scene/run_inputs.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>

#include "core/io/file/atomic_file.h"

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

// Four hexadecimal digits at a place of the text; nothing where there are none.
std::optional<unsigned> Hex4(std::string_view text, std::size_t at) {
  if (at + 4 > text.size()) return std::nullopt;
  unsigned value = 0;
  const auto [end, failure] = std::from_chars(text.data() + at, text.data() + at + 4, value, 16);
  return failure == std::errc() && end == text.data() + at + 4 ? std::optional(value) : std::nullopt;
}

void AppendUtf8(unsigned code, std::string& text) {
  const auto add = [&](unsigned byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return add(code);
  if (code < 0x800) return add(0xc0 | code >> 6), add(0x80 | (code & 0x3f));
  if (code < 0x10000) return add(0xe0 | code >> 12), add(0x80 | (code >> 6 & 0x3f)), add(0x80 | (code & 0x3f));
  add(0xf0 | code >> 18), add(0x80 | (code >> 12 & 0x3f)), add(0x80 | (code >> 6 & 0x3f)), add(0x80 | (code & 0x3f));
}

// The text between the quotes of a JSON string (RFC 8259, section 7), as "gr\u00fcn.png"; nothing where it is none.
std::optional<std::string> UnescapeJson(std::string_view text) {
  constexpr std::string_view kEscapes = "\"\\/bfnrt", kMeanings = "\"\\/\b\f\n\r\t";
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (static_cast<unsigned char>(text[i]) < 0x20) return std::nullopt;
    if (text[i] != '\\') {
      result += text[i];
      continue;
    }
    if (++i >= text.size()) return std::nullopt;
    if (const std::size_t known = kEscapes.find(text[i]); known != std::string_view::npos) {
      result += kMeanings[known];
      continue;
    }
    if (text[i] != 'u') return std::nullopt;
    auto code = Hex4(text, i + 1);
    if (!code) return std::nullopt;
    i += 4;
    if (*code >= 0xd800 && *code < 0xe000) {  // one of a surrogate pair
      const bool paired = *code < 0xdc00 && text.substr(std::min(i + 1, text.size()), 2) == "\\u";
      const auto low = paired ? Hex4(text, i + 3) : std::nullopt;
      if (!low || *low < 0xdc00 || *low >= 0xe000) return std::nullopt;
      code = 0x10000 + ((*code - 0xd800) << 10) + (*low - 0xdc00);
      i += 6;
    }
    AppendUtf8(*code, result);
  }
  return result;
}

// Its beginning, where files are named; of a .glb the description, which comes first. Files of /proc, which say that
// they are empty, name none.
std::string StartOf(const fs::path& path) {
  constexpr std::uintmax_t kMost = std::uintmax_t(16) << 20;
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  if (failed) return {};
  std::ifstream stream(path, std::ios::binary);
  constexpr std::size_t kLengthAt = 12, kBegin = 20;
  std::array<char, kBegin> head{};
  std::uintmax_t length = size;
  if (stream.read(head.data(), kBegin) && std::string_view(head.data(), 4) == "glTF") {
    length = 0;
    for (std::size_t i = 4; i-- > 0;) length = length << 8 | static_cast<unsigned char>(head[kLengthAt + i]);
  } else {
    stream.clear();
    stream.seekg(0);
  }
  std::string text(static_cast<std::size_t>(std::min({length, size, kMost})), '\0');
  stream.read(text.data(), std::streamsize(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

std::string Ending(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

constexpr const char* kBlanks = " \t";

// Of a name, and of a line of names: of a line of 100 KB, all ends together would come to gigabytes.
constexpr int kMostWords = 64;

// Calls use(name) with what may be a file at the end of a line: "c.png", "b c.png", "a b c.png" of "map_Kd a b c.png".
template <class Use>
void ForEachNameAtEnd(std::string_view line, const Use& use) {
  line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
  std::size_t space = line.find_last_of(kBlanks);
  for (int words = 0; words < kMostWords && space != std::string_view::npos; ++words) {
    if (line.size() - space > kLongestName) return;
    use(std::string(line.substr(space + 1)));
    space = space == 0 ? std::string_view::npos : line.find_last_of(kBlanks, space - 1);
  }
}

// Calls use(name) with what may be a library in "mtllib a.mtl b.mtl": either of the two, or one whose name has a blank.
template <class Use>
void ForEachLibrary(const std::string& line, const Use& use) {
  ForEachNameAtEnd(line, use);
  std::istringstream words(line);
  std::string word;
  words >> word;
  for (int count = 0; count < kMostWords && words >> word; ++count) {
    if (word.size() <= kLongestName) use(word);
  }
}

// "a%20b.png" as glTF writes the name "a b.png".
std::string WithoutPercents(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool coded = text[i] == '%' && i + 2 < text.size() &&
                       std::isxdigit(static_cast<unsigned char>(text[i + 1])) &&
                       std::isxdigit(static_cast<unsigned char>(text[i + 2]));
    plain += coded ? static_cast<char>(std::strtol(text.substr(i + 1, 2).c_str(), nullptr, 16)) : text[i];
    if (coded) i += 2;
  }
  return plain;
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

void RunInputs::ReadsScene(const std::string& scene) {
  const std::string what = "a file of the scene " + scene, folder = fs::path(scene).parent_path().string();
  Reads("the scene", scene);
  if (Ending(scene) == ".gltf" || Ending(scene) == ".glb") ReadsUris(what, scene, folder);
  if (Ending(scene) != ".obj") return;
  // "mtllib a.mtl b.mtl" there and "map_Kd -s 1 1 1 a.png" in that file. A library that is named twice is looked into
  // once.
  std::set<Identity> libraries;
  std::istringstream lines(StartOf(scene));
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("mtllib", 0) != 0) continue;
    ForEachLibrary(line, [&](const std::string& name) {
      const std::string library = (fs::path(folder) / name).string();
      const auto identity = IdentityOf(library);
      if (!identity || !libraries.insert(*identity).second) return;
      Reads(what, library);
      std::istringstream entries(StartOf(library));
      for (std::string entry; std::getline(entries, entry);) {
        ForEachNameAtEnd(entry,
                         [&](const std::string& picture) { Reads(what, (fs::path(folder) / picture).string()); });
      }
    });
  }
}

std::vector<std::string> RunInputs::Inputs() const {
  std::vector<std::string> paths;
  for (const auto& [identity, input] : inputs_) paths.push_back(input.path);
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Of all that a .gltf has in quotes only what stands behind "uri" names a file: a scene of 100,000 nodes has as many
// names.
void RunInputs::ReadsUris(const std::string& what, const std::string& file, const std::string& folder) {
  constexpr std::string_view kKey = "\"uri\"", kBlank = " \t\r\n";
  const std::string text = StartOf(file);
  for (std::size_t key = text.find(kKey); key != std::string::npos; key = text.find(kKey, key + 1)) {
    const std::size_t colon = text.find_first_not_of(kBlank, key + kKey.size());
    if (colon == std::string::npos || text[colon] != ':') continue;
    const std::size_t begin = text.find_first_not_of(kBlank, colon + 1);
    if (begin == std::string::npos || text[begin] != '"') continue;
    std::size_t end = begin + 1;
    while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
    if (end >= text.size() || end - begin > kLongestName) continue;
    const auto name = UnescapeJson(std::string_view(text).substr(begin + 1, end - begin - 1));
    if (!name) continue;
    for (const std::string& spelling : {*name, WithoutPercents(*name)}) {
      Reads(what, (fs::path(folder) / spelling).string());
    }
  }
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
  for (const std::string& set : styles.options.sets) {
    std::string value = set.substr(std::min(set.find('=') + 1, set.size()));
    std::erase_if(value, [](char c) { return c == '"' || c == '\''; });
    Reads("--set " + set, value);
  }
}

Status RunInputs::CheckOutputs(std::span<const std::string> outputs, const std::string& option) const {
  for (const std::string& output : outputs) {
    const auto identity = IdentityOf(output);
    const auto found = identity ? inputs_.find(*identity) : inputs_.end();
    if (found == inputs_.end()) continue;
    const Input& input = found->second;
    const std::string also = input.path == output ? "" : ", by the name " + input.path;
    return UsageError(option + " " + output + " would overwrite " + input.what + also + ": give another name");
  }
  std::error_code failed;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const bool look = i == 0 || fs::is_symlink(outputs[i], failed) || fs::is_directory(outputs[i], failed);
    if (look) SCUMBLE_RETURN_IF_ERROR(CheckWritable(outputs[i]));
  }
  return Ok();
}

}  // namespace scumble
