#include "guidegen/load/obj/obj_parse.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <map>
#include <new>
#include <set>
#include <span>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace scumble {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t'; }
bool EndsLine(char c) { return c == '\n' || c == '\r'; }

// Corners such as `6/7/`, whose last index is left out with its slash kept, are read as `6/7`.
void DropEmptyIndices(std::string::iterator begin, std::string::iterator end) {
  bool at_end = true;
  for (auto c = end; c != begin;) {
    --c;
    if (*c == '/' && at_end) *c = ' ';
    at_end = IsBlank(*c);
  }
}

// The corners of each face, of which it takes three at least; empty if none has more than 255.
class CornerCounter {
 public:
  void Add(std::string::const_iterator begin, std::string::const_iterator end) {
    std::uint32_t corners = 0;
    bool in_word = false;
    for (auto c = begin; c != end; ++c) {
      corners += !IsBlank(*c) && !in_word;
      in_word = !IsBlank(*c);
    }
    if (corners < 3) return;
    most_ = std::max(most_, corners);
    counts_.push_back(corners);
  }
  std::vector<std::uint32_t> Take() { return most_ > 255 ? std::move(counts_) : std::vector<std::uint32_t>(); }
  std::size_t faces() const { return counts_.size(); }

 private:
  std::vector<std::uint32_t> counts_;
  std::uint32_t most_ = 0;
};

// The path of a file that a scene or a library names, which is beside it.
std::filesystem::path Beside(const std::filesystem::path& file, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return file.parent_path() / name;
}

// Textures are named relative to their library; many exporters mean the scene.
std::string FindTexture(const std::filesystem::path& scene, const std::filesystem::path& library,
                        const std::string& name, const FileListener& on_file) {
  if (name.empty()) return name;
  const std::filesystem::path near = Beside(library, name), other = Beside(scene, name);
  std::error_code ignored;
  const bool looks_further = near != other && !std::filesystem::exists(near, ignored);
  on_file(near);
  if (looks_further) on_file(other);
  const bool is_other = looks_further && exists(other, ignored);
  return (is_other ? other : near).string();
}

// Those that are not read, too: they are the scene's all the same.
std::vector<std::string*> TextureNames(tinyobj::material_t& of) {
  return {&of.ambient_texname,   &of.diffuse_texname,      &of.specular_texname, &of.specular_highlight_texname,
          &of.bump_texname,      &of.displacement_texname, &of.alpha_texname,    &of.reflection_texname,
          &of.roughness_texname, &of.metallic_texname,     &of.sheen_texname,    &of.emissive_texname,
          &of.normal_texname};
}

// tinyobjloader ends names at blanks. In names of materials and libraries blanks are this until they have been read.
constexpr char kBlankInName = '\x1f';

std::string WithBlanks(std::string name) {
  std::replace(name.begin(), name.end(), kBlankInName, ' ');
  return name;
}
std::string WithoutBlanks(std::string name) {
  while (!name.empty() && IsBlank(name.back())) name.pop_back();
  std::replace(name.begin(), name.end(), ' ', kBlankInName);
  return name;
}

// Joins the words of the name behind `key`, which the line begins with. Returns the name; empty for other lines.
std::string JoinName(std::string::iterator begin, std::string::iterator end, std::string_view key) {
  if (std::string_view(begin, end).substr(0, key.size()) != key) return {};
  const auto behind = begin + static_cast<std::ptrdiff_t>(key.size());
  if (behind == end || !IsBlank(*behind)) return {};
  const auto name = std::find_if_not(behind, end, IsBlank);
  auto last = end;
  while (last != name && IsBlank(*(last - 1))) --last;
  std::replace(name, last, ' ', kBlankInName);
  return WithBlanks({name, last});
}

// A line that ends with a backslash goes on in the next one; comments do not. Lines keep their numbers: what was joined
// is followed by as many empty ones.
void JoinLines(std::string& text) {
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin, joined = 0;
    for (;; ++end) {
      end = std::min(text.find('\n', end), text.size());
      std::size_t last = end;
      if (last > begin && text[last - 1] == '\r') --last;
      const bool goes_on = last > begin && text[last - 1] == '\\' && end < text.size();
      if (!goes_on || text[text.find_first_not_of(" \t", begin)] == '#') break;
      std::fill(text.begin() + std::ptrdiff_t(last) - 1, text.begin() + std::ptrdiff_t(end), ' ');
      ++joined;
    }
    if (joined > 0) {
      const auto first = text.begin() + std::ptrdiff_t(begin), behind = text.begin() + std::ptrdiff_t(end);
      std::fill(std::remove(first, behind, '\n'), behind, '\n');
    }
    begin = end + 1;
  }
}

// The end of the decimal number at `at`; null where there is none.
const char* SkipNumber(const char* at, const char* end) {
  const auto skip_sign = [&] { at += at != end && (*at == '-' || *at == '+'); };
  const auto skip_digits = [&] {
    const char* const first = at;
    while (at != end && *at >= '0' && *at <= '9') ++at;
    return at - first;
  };
  skip_sign();
  auto digits = skip_digits();
  if (at != end && *at == '.') ++at, digits += skip_digits();
  if (digits == 0) return nullptr;
  if (at == end || (*at | 0x20) != 'e') return at;
  ++at;
  skip_sign();
  return skip_digits() > 0 ? at : nullptr;
}

// NaN and infinities, "-nan(ind)" and "-1.#IND" included.
bool IsNotFinite(std::string_view word) {
  if (!word.empty() && (word.front() == '+' || word.front() == '-')) word.remove_prefix(1);
  const auto begins_with = [&](std::string_view with) {
    return word.size() >= with.size() &&
           std::equal(with.begin(), with.end(), word.begin(), [](char a, char b) { return a == b || a == (b | 0x20); });
  };
  return begins_with("nan") || begins_with("inf") || begins_with("1.#");
}

// Lines of one kind whose words are numbers.
struct NumberLine {
  std::string_view key;
  int numbers = 0;               // how many are read at most
  bool may_be_infinite = false;  // or NaN, which is taken for none
  bool has_others = false;       // instead of numbers: a curve, another space, a halo
};

// Exporters write NaN as the normal of a face without area.
constexpr NumberLine kObjNumbers[] = {{"v", 6}, {"vn", 3, true}, {"vt", 2, true}};
constexpr NumberLine kMtlNumbers[] = {{"Kd", 3, false, true}, {"Ks", 3, false, true}, {"Ke", 3, false, true},
                                      {"Ns", 1, true},        {"d", 1, false, true},  {"Tr", 1, false, true}};
constexpr std::string_view kOthers[] = {"spectral", "xyz", "-halo"};

// The first of the numbers from `at` to `end` that is none; empty where all are. tinyobjloader would take it for 0.
std::string_view FirstNoNumber(const char* at, const char* end, const NumberLine& line) {
  for (int i = 0; i < line.numbers; ++i) {
    at = std::find_if_not(at, end, IsBlank);
    if (at == end || *at == '#') return {};
    const char* const begin = at;
    at = SkipNumber(begin, end);
    if (at && (at == end || IsBlank(*at))) continue;
    at = std::find_if(begin, end, IsBlank);
    const std::string_view word(begin, std::size_t(at - begin));
    if (line.has_others && i == 0 && std::ranges::find(kOthers, word) != std::end(kOthers)) return {};
    if (!line.may_be_infinite || !IsNotFinite(word)) return word;
  }
  return {};
}

// Ok, or a kInput error that tells the first line of `text` with what is no number.
Status CheckNumbers(const std::string& file, std::string_view text, std::span<const NumberLine> lines) {
  const char* const last = text.data() + text.size();
  for (const char* at = text.data(); at != last;) {
    const char* const end = std::find_if(at, last, EndsLine);
    const char* const begin = std::find_if_not(at, end, IsBlank);
    at = end == last ? end : end + 1;
    const std::string_view line(begin, std::size_t(end - begin));
    for (const NumberLine& one : lines) {
      const std::size_t size = one.key.size();
      if (line.size() <= size || !IsBlank(line[size]) || line.substr(0, size) != one.key) continue;
      const std::string_view word = FirstNoNumber(begin + size, end, one);
      if (word.empty()) continue;
      std::size_t number = 1;
      for (const char* c = text.data(); c != begin; ++c) number += *c == '\n' || (*c == '\r' && c[1] != '\n');
      return InputError(file + ", line " + std::to_string(number) + ", is '" + Excerpt(std::string(line), 80) +
                        "', where '" + Excerpt(std::string(word), 40) +
                        "' is no finite number; expected digits with a decimal point, such as 1.5: export it again");
    }
  }
  return Ok();
}

// Turns lines into comments that tinyobjloader would store but no code here reads; line numbers stay. A subdivision tag
// of 20 bytes becomes 360 KB, and again in each shape. The lines and points of an object are copied at each change of
// material; the first index of each kind shows that they exist. Returns whether smoothing groups are mentioned, `s off`
// included, which tinyobjloader does not tell from silence. `used` gets the names of materials that faces ask for.
// tinyobjloader would take the backslashes of a library's path for something else.
bool PrepareText(std::string& text, CornerCounter& faces, std::vector<ObjSection>& sections,
                 std::set<std::string>& used) {
  bool has_smoothing = false;
  bool has_lines = false, has_points = false;  // in this object or group
  int objects = 0;
  for (auto begin = text.begin(); begin != text.end();) {
    const auto end = std::find_if(begin, text.end(), EndsLine);
    const auto what = std::find_if_not(begin, end, IsBlank);
    begin = end == text.end() ? end : end + 1;
    if (!JoinName(what, end, "mtllib").empty()) std::replace(what, end, '\\', '/');
    if (std::string name = JoinName(what, end, "usemtl"); !name.empty()) used.insert(std::move(name));
    if (what == end || what + 1 == end || !IsBlank(what[1])) continue;
    if (*what == 'f') {
      DropEmptyIndices(what, end);
      faces.Add(what + 1, end);
    }
    if (*what == 'o' || *what == 'g') {
      has_lines = has_points = false;
      objects += *what == 'o';
      sections.push_back({faces.faces(), objects, *what == 'g'});
    }
    has_smoothing |= *what == 's';
    if (*what == 't') *what = '#';
    if (*what != 'l' && *what != 'p') continue;
    bool& is_told = *what == 'l' ? has_lines : has_points;
    const auto index = std::find_if_not(what + 1, end, IsBlank);
    if (is_told || index == end) {
      *what = '#';
    } else {
      std::fill(std::find_if(index, end, IsBlank), end, ' ');
      is_told = true;
    }
  }
  return has_smoothing;
}

// The words of a line, at most two.
std::array<std::string, 2> FirstWords(const std::string& text, std::size_t begin, std::size_t end) {
  std::istringstream line(text.substr(begin, std::min<std::size_t>(end - begin, 256)));
  std::array<std::string, 2> words;
  line >> words[0] >> words[1];
  return words;
}

// MeshLab means opacity by `Tr`, which is transparency, and writes `Tr 1` for all that it draws. Read to the letter,
// nothing of the model would be seen. Such lines become comments; where `d` stands beside them it counts anyway.
void DropWholeTransparency(std::string& library, WarningCounter& warnings) {
  std::string material;
  bool is_dropped = false, has_dissolve = false;
  const auto tell = [&] {
    if (is_dropped && !has_dissolve) {
      warnings.Add("'Tr 1' is taken for opaque, as MeshLab means it; 'd 0' makes a material invisible",
                   "material '" + Excerpt(material, 80) + "'");
    }
    is_dropped = has_dissolve = false;
  };
  for (std::size_t begin = 0; begin < library.size();) {
    const std::size_t end = std::min(library.find_first_of("\r\n", begin), library.size());
    const auto [key, value] = FirstWords(library, begin, end);
    if (key == "newmtl") tell(), material = value;
    has_dissolve |= key == "d";
    if (key == "Tr" && std::strtod(value.c_str(), nullptr) >= 1.0) {
      library[library.find('T', begin)] = '#';
      is_dropped = true;
    }
    begin = end + 1;
  }
  tell();
}

// Reads material libraries from regular files only, each file once, and names missing ones. A line may name one whose
// name has blanks, or several.
class LibraryReader : public tinyobj::MaterialReader {
 public:
  LibraryReader(const std::filesystem::path& scene, const FileListener& on_file, WarningCounter& warnings)
      : scene_(scene), on_file_(on_file), warnings_(warnings) {}

  bool operator()(const std::string& names, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* indices, std::string* warning, std::string* error) override {
    const Target target{materials, indices, warning, error};
    const std::string whole = WithBlanks(names);
    if (Read(whole, target)) return true;
    std::vector<std::string> missing;
    bool found = false;
    std::istringstream words(whole);
    for (std::string word; words >> word;) {
      if (word != whole && Read(word, target)) {
        found = true;
      } else {
        missing.push_back(word);
      }
    }
    if (!found) missing = {whole};
    for (const std::string& name : missing) {
      warnings_.Add("a material library is missing, its objects are matt and light grey", Excerpt(name));
    }
    return found;
  }

  bool has_read() const { return !read_.empty(); }
  // Of the first library that cannot be used at all.
  const Status& fault() const { return fault_; }

 private:
  struct Target {
    std::vector<tinyobj::material_t>* materials;
    std::map<std::string, int>* indices;
    std::string *warning, *error;
  };

  // False: there is no such file. Of one that cannot be used, `fault_` tells.
  bool Read(const std::string& name, const Target& target) {
    const std::filesystem::path path = Beside(scene_, name);
    on_file_(path);
    std::error_code missing;
    const std::filesystem::path library = std::filesystem::canonical(path, missing);
    if (!missing && read_.count(library) > 0) return true;
    const auto bytes = ReadRegularFile(path);
    if (!bytes) return false;
    if (!missing) read_.insert(library);
    if (const Status readable = CheckTextEncoding(path.string(), *bytes); !readable) {
      if (fault_) fault_ = readable;
      return true;
    }
    std::string text = AsTextWithoutMark(*bytes);
    if (const Status numbers = CheckNumbers(path.string(), text, kMtlNumbers); !numbers) {
      if (fault_) fault_ = numbers;
      return true;
    }
    DropWholeTransparency(text, warnings_);
    std::istringstream stream(std::move(text));
    const std::size_t first = target.materials->size();
    tinyobj::LoadMtl(target.indices, target.materials, &stream, target.warning, target.error);
    for (std::size_t i = first; i < target.materials->size(); ++i) {
      tinyobj::material_t& material = (*target.materials)[i];
      for (std::string* texture : TextureNames(material)) *texture = FindTexture(scene_, path, *texture, on_file_);
    }
    const std::map<std::string, int> by_name = *target.indices;
    for (const auto& [material, index] : by_name) target.indices->insert({WithoutBlanks(material), index});
    return true;
  }

  const std::filesystem::path& scene_;
  const FileListener& on_file_;
  WarningCounter& warnings_;
  Status fault_ = Ok();
  std::set<std::filesystem::path> read_;
};

// What tinyobjloader says of a line that it cannot read ends with "line 16.)" or "Line 16)"; the line itself says more.
std::string WhyUnreadable(const std::string& error, const std::string& text) {
  const std::string said = Excerpt(error.empty() ? "no reason given" : error, 300);
  const std::size_t at = error.rfind("ine ");
  if (at == std::string::npos || error.find("`f' line") == std::string::npos) return said;
  const long number = std::strtol(error.c_str() + at + 4, nullptr, 10);
  if (number < 1) return said;
  std::istringstream lines(text);
  std::string line;
  for (long i = 0; i < number; ++i) {
    if (!std::getline(lines, line)) return said;
  }
  return "line " + std::to_string(number) + " is '" + Excerpt(line, 80) +
         "', a face whose corners are no indices: they count from 1, or back from -1; export it again";
}

// Exporters that have no material for some faces say so by these names.
bool IsNoMaterial(const std::string& name) { return name == "None" || name == "(null)"; }

void WarnOfUnknown(const std::set<std::string>& used, const std::vector<tinyobj::material_t>& materials,
                   WarningCounter& warnings) {
  std::set<std::string> known;
  for (const tinyobj::material_t& material : materials) known.insert(WithBlanks(WithoutBlanks(material.name)));
  for (const std::string& name : used) {
    if (known.count(name) == 0 && !IsNoMaterial(name)) {
      warnings.Add("a material is in no library, its faces are matt and light grey", "'" + Excerpt(name, 80) + "'");
    }
  }
}

}  // namespace

Status ParseObj(const std::filesystem::path& path, const FileListener& on_file, WarningCounter& warnings,
                ObjContents& contents) {
  const std::string file = path.string();
  SCUMBLE_ASSIGN(const std::vector<std::byte> bytes, ReadRegularFile(path));
  if (bytes.empty()) return InputError(file + " is empty; expected a Wavefront OBJ scene");
  SCUMBLE_RETURN_IF_ERROR(CheckTextEncoding(file, bytes));
  std::string text = AsTextWithoutMark(bytes);
  CornerCounter faces;
  std::set<std::string> used;
  JoinLines(text);
  SCUMBLE_RETURN_IF_ERROR(CheckNumbers(file, text, kObjNumbers));
  contents.has_smoothing = PrepareText(text, faces, contents.sections, used);
  contents.corner_counts = faces.Take();
  std::istringstream stream(std::move(text));
  LibraryReader library(path, on_file, warnings);
  std::string warning, error;
  bool ok = false;
  try {
    // Polygons are cut here and not by tinyobjloader, which reads the corners' positions before checking their
    // indices.
    ok = tinyobj::LoadObj(&contents.attributes, &contents.shapes, &contents.materials, &warning, &error, &stream,
                          &library,
                          /*triangulate=*/false, /*default_vcols_fallback=*/false);
  } catch (const std::bad_alloc&) {
    return MemoryError(file + " asks for more memory than there is: simplify the scene");
  } catch (const std::exception& e) {
    error = e.what();
  }
  SCUMBLE_RETURN_IF_ERROR(library.fault());
  if (ok) {
    if (library.has_read()) WarnOfUnknown(used, contents.materials, warnings);
    return Ok();
  }
  return InputError(file + " is not a valid OBJ file: " + WhyUnreadable(error, stream.str()));
}

}  // namespace scumble
