#include "guidegen/load/obj_parse.h"

#include <algorithm>
#include <exception>
#include <map>
#include <new>
#include <set>
#include <sstream>
#include <system_error>

namespace scumble {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

// Turns lines into comments that tinyobjloader would store but no code here reads; line numbers stay. A subdivision tag
// of 20 bytes becomes 360 KB, and again in each shape. The lines and points of an object are copied at each change of
// material; the first index of each kind shows that they exist. Returns whether smoothing groups are mentioned, `s off`
// included, which tinyobjloader does not tell from silence.
bool BlankUnused(std::string& text) {
  bool has_smoothing = false;
  const auto ends_line = [](char c) { return c == '\n' || c == '\r'; };
  bool has_lines = false, has_points = false;  // in this object or group
  for (auto begin = text.begin(); begin != text.end();) {
    const auto end = std::find_if(begin, text.end(), ends_line);
    const auto what = std::find_if_not(begin, end, IsBlank);
    begin = end == text.end() ? end : end + 1;
    if (what == end || what + 1 == end || !IsBlank(what[1])) continue;
    if (*what == 'o' || *what == 'g') has_lines = has_points = false;
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

// Reads material libraries from regular files only, each file once, and names missing ones.
class LibraryReader : public tinyobj::MaterialReader {
 public:
  LibraryReader(const std::filesystem::path& scene, WarningCounter& warnings) : scene_(scene), warnings_(warnings) {}

  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* indices, std::string* warning, std::string* error) override {
    const std::filesystem::path path = BesideScene(scene_, name);
    std::error_code missing;
    const std::filesystem::path library = std::filesystem::canonical(path, missing);
    if (!missing && read_.count(library) > 0) return true;
    const auto bytes = ReadRegularFile(path);
    if (!bytes) {
      warnings_.Add("a material library is missing, its objects are matt and light grey", Excerpt(name));
      return false;
    }
    if (!missing) read_.insert(library);
    if (const Status readable = CheckTextEncoding(path.string(), *bytes); !readable) {
      if (fault_) fault_ = readable;
      return false;
    }
    std::istringstream stream(AsTextWithoutMark(*bytes));
    tinyobj::LoadMtl(indices, materials, &stream, warning, error);
    return true;
  }

  // Of the first library that cannot be used at all.
  const Status& fault() const { return fault_; }

 private:
  const std::filesystem::path& scene_;
  WarningCounter& warnings_;
  Status fault_ = Ok();
  std::set<std::filesystem::path> read_;
};

}  // namespace

std::filesystem::path BesideScene(const std::filesystem::path& scene, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return scene.parent_path() / name;
}

Status ParseObj(const std::filesystem::path& path, WarningCounter& warnings, ObjContents& contents) {
  const std::string file = path.string();
  SCUMBLE_ASSIGN(const std::vector<std::byte> bytes, ReadRegularFile(path));
  if (bytes.empty()) return InputError(file + " is empty; expected a Wavefront OBJ scene");
  SCUMBLE_RETURN_IF_ERROR(CheckTextEncoding(file, bytes));
  std::string text = AsTextWithoutMark(bytes);
  contents.has_smoothing = BlankUnused(text);
  std::istringstream stream(std::move(text));
  LibraryReader library(path, warnings);
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
  if (ok) return Ok();
  return InputError(file + " is not a valid OBJ file: " + Excerpt(error.empty() ? "no reason given" : error, 300));
}

}  // namespace scumble
