#include "guidegen/load/gltf/parse.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <set>
#include <span>
#include <string_view>

#include "guidegen/load/loader_util.h"

namespace scumble {
namespace {

constexpr const char* kRemedyForOldGltf =
    "; expected glTF 2.0: convert it, for example with gltf-pipeline, or export it again";

// tinygltf walks and frees extras by recursion; real files nest a dozen levels.
constexpr int kMaxJsonDepth = 200;
// Bytes of files that several buffers name. Exporters write one file for each buffer: tinygltf requires a buffer to be
// as long as its file, so further buffers would only hold equal bytes.
constexpr std::uintmax_t kMaxBytesAgain = std::uintmax_t(1) << 26;
constexpr std::size_t kGlbHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;

std::uint32_t ReadU32(std::span<const unsigned char> bytes, std::size_t at) {
  return std::uint32_t(bytes[at]) | std::uint32_t(bytes[at + 1]) << 8 | std::uint32_t(bytes[at + 2]) << 16 |
         std::uint32_t(bytes[at + 3]) << 24;
}

bool IsGlb(std::span<const unsigned char> bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

// The place of a .glb's JSON. Every chunk must lie inside the file: tinygltf reads up to eight bytes beyond one that
// does not.
Expected<std::span<const unsigned char>> GlbJson(const std::string& file, std::span<const unsigned char> bytes) {
  const auto bad = [&](const std::string& reason) {
    return InputError(file + " is not a whole .glb file: " + reason + "; copy or export it again");
  };
  if (bytes.size() < kGlbHeaderBytes + kChunkHeaderBytes) {
    return bad("it has only " + std::to_string(bytes.size()) + " bytes");
  }
  if (ReadU32(bytes, 4) != 2) {
    return InputError(file + " is binary glTF " + std::to_string(ReadU32(bytes, 4)) + kRemedyForOldGltf);
  }
  const std::size_t length = ReadU32(bytes, 8);
  if (length > bytes.size()) {
    return bad("its header speaks of " + std::to_string(length) + " bytes, there are " + std::to_string(bytes.size()));
  }
  std::span<const unsigned char> json;
  for (std::size_t at = kGlbHeaderBytes; at < length;) {
    if (length - at < kChunkHeaderBytes) return bad("its last chunk is cut off");
    const std::size_t chunk = ReadU32(bytes, at);
    const std::uint32_t type = ReadU32(bytes, at + 4);
    at += kChunkHeaderBytes;
    if (chunk > length - at) return bad("a chunk of " + std::to_string(chunk) + " bytes does not fit in it");
    if (json.empty() && type == kJsonChunk) json = bytes.subspan(at, chunk);
    at += chunk;
  }
  if (json.empty()) return bad("it has no JSON chunk");
  return json;
}

// Top-level lists whose elements tinygltf makes far larger than their text, which may be `{}`: 2 KB for a material,
// half a KB for a node. A file's limit of a million instances needs fewer. Accessors and buffer views cannot be written
// so shortly, and there are several for each mesh.
struct ListLimit {
  std::string_view list;
  std::size_t most;
};
constexpr std::size_t kMostElements = 100'000;
constexpr ListLimit kListLimits[] = {
    {"nodes", 2'000'000},      {"meshes", 2'000'000},        {"materials", kMostElements}, {"textures", kMostElements},
    {"images", kMostElements}, {"samplers", kMostElements},  {"scenes", kMostElements},    {"cameras", kMostElements},
    {"skins", kMostElements},  {"animations", kMostElements}};
constexpr std::string_view kLists[] = {"accessors", "animations", "buffers", "bufferViews", "cameras",
                                       "images",    "materials",  "meshes",  "nodes",       "samplers",
                                       "scenes",    "skins",      "textures"};
// tinygltf takes 150 bytes for each value inside extras and extensions, whose text may have 2. A million nodes with ten
// of Blender's custom properties each have 10 million.
constexpr std::uint64_t kMaxFreeValues = 16'000'000;

// Names of required extensions that an error can list.
constexpr std::size_t kMostNamed = 16;

// Extensions that a file may require: those read here, at least in part, and those that change only shading outside the
// guides.
bool IsKnownExtension(std::string_view name) {
  constexpr std::string_view kKnown[] = {"KHR_lights_punctual", "KHR_texture_transform",   "KHR_mesh_quantization",
                                         "EXT_texture_webp",    "EXT_mesh_gpu_instancing", "KHR_node_visibility"};
  return std::find(std::begin(kKnown), std::end(kKnown), name) != std::end(kKnown) ||
         name.rfind("KHR_materials_", 0) == 0;
}

// The result of a cheap scan of the JSON before it is parsed.
struct JsonOutline {
  std::string version;                        // the asset's, where it is a text
  std::string keyed_list;                     // a list of glTF 2.0 that is written as an object, as in glTF 1.0
  std::vector<std::string> unknown_required;  // extensions that the file requires and that are not read here
  int depth = 0;                              // of the deepest brackets
  int buffers_without_uri = 0;    // or with an empty one or one that is no text, which tinygltf treats as none
  std::string_view long_list;     // a top-level list that exceeds its limit; empty: none
  std::size_t elements = 0;       // its number of elements
  std::size_t most = 0;           // and its limit
  std::uint64_t free_values = 0;  // inside extras and extensions, as often as tinygltf copies them
};

// Keys are compared as they are written. A key with an escape may be any key, so it counts as the worst case: no
// exporter writes such keys.
class Outliner {
 public:
  JsonOutline Read(std::string_view json) {
    for (std::size_t i = 0; i < json.size(); ++i) {
      const char c = json[i];
      if (c == '"') {
        const std::size_t begin = i + 1;
        for (++i; i < json.size() && json[i] != '"'; ++i) i += json[i] == '\\';
        text_ = json.substr(begin, i - begin);
        escaped_ = text_.find('\\') != text_.npos;
        if (depth_ == 3 && at_uri_) has_uri_ = !text_.empty();
        if (depth_ == 2 && list_ == "extensionsRequired") TakeRequired();
        if (depth_ == 2 && at_version_) outline_.version = text_;
      } else if (c == ':') {
        TakeKey();
      } else if (c == ',') {
        TakeComma();
      } else if (c == '{' || c == '[') {
        Open(c);
      } else if (c == '}' || c == ']') {
        Close();
      }
    }
    return outline_;
  }

 private:
  bool MayBe(std::string_view key) const { return escaped_ || text_ == key; }

  void TakeKey() {
    if (free_depth_ == 0) at_free_ = MayBe("extras") || MayBe("extensions");
    if (depth_ == 1) {
      list_ = text_;
      list_escaped_ = escaped_;
      in_buffers_ = MayBe("buffers");
      in_animations_ = MayBe("animations");
    } else if (depth_ == 2) {
      at_version_ = list_ == "asset" && text_ == "version";
    } else if (depth_ == 3 && in_buffers_) {
      at_uri_ = text_ == "uri";
      if (MayBe("uri")) has_uri_ = false;
    } else if (depth_ == 3 && in_animations_) {
      at_samplers_ = MayBe("samplers");
      at_copied_ = MayBe("extensions");
    }
  }

  void TakeRequired() {
    std::vector<std::string>& names = outline_.unknown_required;
    if (!escaped_ && !IsKnownExtension(text_) && names.size() < kMostNamed) names.emplace_back(text_);
  }

  void TakeComma() {
    elements_ += depth_ == 2;
    samplers_ += depth_ == 4 && at_samplers_;
    CountFreeValue();
    if (depth_ == 2) at_version_ = false;
    if (depth_ == 3) at_uri_ = false;
    at_free_ = false;
  }

  void Open(char bracket) {
    outline_.depth = std::max(outline_.depth, ++depth_);
    if (depth_ == 2) elements_ = 1;
    if (depth_ == 2 && bracket == '{' && std::find(std::begin(kLists), std::end(kLists), list_) != std::end(kLists)) {
      outline_.keyed_list = list_;
    }
    if (depth_ == 3) {
      at_uri_ = has_uri_ = at_samplers_ = at_copied_ = false;
      samplers_ = copied_values_ = 0;
    }
    if (at_free_) free_depth_ = depth_;
    at_free_ = false;
    CountFreeValue();
  }

  void Close() {
    if (depth_ == 2) {
      CheckElements();
      at_version_ = false;
    }
    if (depth_ == 3) {
      outline_.buffers_without_uri += in_buffers_ && !has_uri_;
      // tinygltf gives each of an animation's samplers a copy of the animation's extensions.
      outline_.free_values += samplers_ * copied_values_;
    }
    if (depth_ == free_depth_) free_depth_ = 0;
    at_free_ = false;
    --depth_;
  }

  void CountFreeValue() {
    if (free_depth_ == 0) return;
    ++outline_.free_values;
    copied_values_ += at_copied_;
  }

  void CheckElements() {
    for (const ListLimit& limit : kListLimits) {
      const std::size_t most = list_escaped_ ? kMostElements : limit.most;
      if ((!list_escaped_ && list_ != limit.list) || elements_ <= most) continue;
      outline_.long_list = list_;
      outline_.elements = elements_;
      outline_.most = most;
    }
  }

  JsonOutline outline_;
  int depth_ = 0;
  std::string_view text_;  // the last string
  bool escaped_ = false;   // whether it has an escape
  std::string_view list_;  // key of the top level
  bool list_escaped_ = false;
  std::size_t elements_ = 0;
  bool at_version_ = false;  // the next text at depth 2 is the asset's version
  bool in_buffers_ = false, at_uri_ = false, has_uri_ = false;
  bool at_free_ = false;  // the next value is that of extras or extensions
  int free_depth_ = 0;    // the depth of its brackets; 0 outside
  bool in_animations_ = false, at_samplers_ = false, at_copied_ = false;
  std::uint64_t samplers_ = 0;       // of one animation, less one
  std::uint64_t copied_values_ = 0;  // inside its extensions
};

// glTF 1.0 has no required extensions and nothing that tinygltf 2 reads.
Status CheckMajorVersion(const std::string& file, const JsonOutline& outline) {
  const bool is_old = outline.version.starts_with("1.") || outline.version.starts_with("0.");
  const bool is_keyed = !outline.keyed_list.empty() && !outline.version.starts_with("2.");
  if (!is_old && !is_keyed) return Ok();
  std::string found = " is glTF " + (is_old ? Excerpt(outline.version, 40) : "1.0");
  if (is_keyed) found += ", whose " + outline.keyed_list + " have names instead of numbers";
  return InputError(file + found + kRemedyForOldGltf);
}

bool KeepEncoded(tinygltf::Image* image, int, std::string* error, std::string*, int, int, const unsigned char* bytes,
                 int size, void*) {
  image->as_is = true;
  // Embedded pictures come with an unchecked pointer; they are read later, from their buffer view.
  if (image->bufferView >= 0) return true;
  if (size < 0) {
    if (error) *error += "a picture has more than two gigabytes";
    return false;
  }
  image->image.assign(bytes, bytes + size);
  return true;
}

// Files and folders that tinygltf may read.
struct Surroundings {
  std::string folder;  // the scene's
  const FileListener* on_file = nullptr;
  bool keep_pictures = false;    // pictures are there, too
  bool hidden_pictures = false;  // some were requested, and hidden
  std::set<std::filesystem::path> read = {};
  std::uintmax_t bytes_again = 0;  // of files that are read more than once
};

bool HasPictureEnding(const std::string& name) {
  std::string ending = std::filesystem::path(name).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg" || ending == ".webp";
}

// tinygltf also searches the current folder; only files beside the scene (or below or above it) belong to it. It treats
// a missing picture as optional.
bool BesideScene(const std::string& name, void* base) {
  Surroundings& surroundings = *static_cast<Surroundings*>(base);
  if (name.rfind(surroundings.folder, 0) != 0) return false;
  (*surroundings.on_file)(name);
  if (!surroundings.keep_pictures && HasPictureEnding(name)) {
    surroundings.hidden_pictures = true;
    return false;
  }
  std::error_code error;
  return std::filesystem::is_regular_file(name, error) && !error;
}

// Any number of buffers may name one file, and tinygltf keeps its bytes for each.
bool MayBeRead(const std::string& name, Surroundings& surroundings) {
  std::error_code failed;
  const std::filesystem::path file = std::filesystem::canonical(name, failed);
  if (failed || surroundings.read.insert(file).second) return true;
  const std::uintmax_t size = std::filesystem::file_size(file, failed);
  if (failed || size > kMaxBytesAgain - surroundings.bytes_again) return false;
  surroundings.bytes_again += size;
  return true;
}

bool ReadForTinygltf(std::vector<unsigned char>* out, std::string* error, const std::string& name, void* base) {
  if (!MayBeRead(name, *static_cast<Surroundings*>(base))) {
    if (error) {
      *error += "several buffers name this file, and reading files again comes to more than " +
                std::to_string(kMaxBytesAgain) + " bytes; expected one buffer for each file";
    }
    return false;
  }
  const Expected<std::vector<std::byte>> bytes = ReadRegularFile(name);
  if (!bytes) {
    if (error) *error += bytes.error().message;
    return false;
  }
  const std::span<const unsigned char> chars = AsChars(bytes.value());
  out->assign(chars.begin(), chars.end());
  return true;
}

bool NeverWrite(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }

bool SizeForTinygltf(std::size_t* size, std::string* error, const std::string& name, void*) {
  std::error_code failed;
  *size = std::filesystem::file_size(name, failed);
  if (failed && error) *error += failed.message();
  return !failed;
}

// tinygltf 2.9 also wants files' sizes, and refuses more than 2 GB unless it is told another limit.
template <class Loader, class Callbacks>
void SetFileCallbacks(Loader& loader, Surroundings& surroundings, Callbacks callbacks) {
  callbacks.FileExists = &BesideScene;
  callbacks.ExpandFilePath = [](const std::string& name, void*) { return name; };
  callbacks.ReadWholeFile = &ReadForTinygltf;
  callbacks.WriteWholeFile = &NeverWrite;
  callbacks.user_data = &surroundings;
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
    callbacks.GetFileSizeInBytes = &SizeForTinygltf;
    loader.SetMaxExternalFileSize(std::numeric_limits<std::size_t>::max());
  }
  loader.SetFsCallbacks(callbacks);
}

// Takes all occurrences away, of which there may be as many as the file likes; whether there were any.
bool Remove(const std::string& part, std::string& text) {
  std::string kept;
  std::size_t from = 0;
  for (std::size_t at; (at = text.find(part, from)) != std::string::npos; from = at + part.size()) {
    kept.append(text, from, at - from);
  }
  kept.append(text, from);
  const bool found = kept.size() < text.size();
  text = std::move(kept);
  return found;
}

// tinygltf's message about an accepted file becomes a warning, except where tinygltf is stricter than glTF.
void WarnOfComplaints(std::string complaints, const tinygltf::Model& model, WarningCounter& warnings) {
  // The materials' own warnings name textures without an index.
  for (const std::string harmless :
       {"JSON Chunk end does not aligned to a 4-byte boundary.", "'inverseBindMatrices' property is missing in Skin.\n",
        "'index' property is missing in TextureInfo.\n", "'index' property is missing in NormalTextureInfo.\n"}) {
    Remove(harmless, complaints);
  }
  const std::vector<std::string>& used = model.extensionsUsed;
  if (std::find(used.begin(), used.end(), "KHR_animation_pointer") != used.end()) {
    const std::string no_node = "'node' property is missing.\n`node` field is missing in animation.channels.target\n";
    if (Remove(no_node, complaints)) {
      warnings.Add("animation of visibility and other properties is left out", "KHR_animation_pointer");
    }
  }
  if (!complaints.empty()) warnings.Add("some of the file is not valid glTF and is left out", Excerpt(complaints));
}

std::string FolderOf(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.parent_path();
  return folder.empty() ? "." : folder.string();
}

Status RunTinygltf(const std::string& file, Surroundings& surroundings, std::span<const unsigned char> bytes,
                   tinygltf::Model& model, WarningCounter& counter) {
  const std::string& folder = surroundings.folder;
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(&KeepEncoded, nullptr);
  SetFileCallbacks(loader, surroundings, tinygltf::FsCallbacks());
  std::string errors, warnings;
  bool ok = false;
  const unsigned size = static_cast<unsigned>(bytes.size());
  try {
    if (IsGlb(bytes)) {
      ok = loader.LoadBinaryFromMemory(&model, &errors, &warnings, bytes.data(), size, folder);
    } else {
      ok = loader.LoadASCIIFromString(&model, &errors, &warnings, reinterpret_cast<const char*>(bytes.data()), size,
                                      folder);
    }
  } catch (const std::bad_alloc&) {
    return MemoryError(file + " asks for more memory than there is: simplify the scene");
  } catch (const std::exception& e) {
    ok = false;
    errors = e.what();
  }
  if (ok) {
    WarnOfComplaints(errors, model, counter);
    return Ok();
  }
  if (errors.empty()) errors = warnings.empty() ? "no reason given" : warnings;
  return InputError(file + " cannot be read as glTF 2.0: " + Excerpt(errors, 300) +
                    "; export it again, or check it with a glTF validator");
}

}  // namespace

Status CheckRequiredExtensions(const std::string& file, std::span<const std::string> required) {
  std::string names;
  std::size_t unknown = 0;
  bool packed = false, basis = false;
  for (const std::string& name : required) {
    if (IsKnownExtension(name) || ++unknown > kMostNamed) continue;
    names += (names.empty() ? "" : ", ") + Excerpt(name, 80);
    packed = packed || name == "KHR_draco_mesh_compression" || name.find("meshopt") != name.npos;
    basis = basis || name == "KHR_texture_basisu";
  }
  if (unknown == 0) return Ok();
  std::string fix = ": export it without";
  if (packed) fix = ": export it again with the compression of meshes (Draco, meshopt) switched off";
  if (basis) fix += packed ? ", and with textures as PNG or JPEG" : ", with textures as PNG or JPEG";
  return InputError(file + " requires " + names + (unknown > kMostNamed ? ", …" : "") + ", which cannot be read" + fix);
}

Status ParseGltf(const std::filesystem::path& path, const FileListener& on_file, tinygltf::Model& model,
                 WarningCounter& warnings) {
  const std::string file = path.string();
  SCUMBLE_ASSIGN(const std::vector<std::byte> whole, ReadRegularFile(path));
  std::span<const unsigned char> bytes = AsChars(whole);
  if (bytes.size() > std::numeric_limits<unsigned>::max()) {
    return InputError(file +
                      " has more than four gigabytes, glTF's limit for one file: move its buffers to .bin files");
  }
  if (bytes.size() >= 3 && bytes[0] == 0xEF && bytes[1] == 0xBB && bytes[2] == 0xBF) bytes = bytes.subspan(3);
  if (bytes.empty()) return InputError(file + " is empty; expected a glTF 2.0 scene");
  std::span<const unsigned char> json = bytes;
  if (IsGlb(bytes)) {
    SCUMBLE_ASSIGN(json, GlbJson(file, bytes));
  } else {
    SCUMBLE_RETURN_IF_ERROR(CheckTextEncoding(file, whole));
  }
  const JsonOutline outline = Outliner().Read({reinterpret_cast<const char*>(json.data()), json.size()});
  SCUMBLE_RETURN_IF_ERROR(CheckMajorVersion(file, outline));
  // Early, because whatever else such a file seems to lack (data of buffers, say) may be in the extension's own form.
  SCUMBLE_RETURN_IF_ERROR(CheckRequiredExtensions(file, outline.unknown_required));
  if (outline.depth > kMaxJsonDepth) {
    return InputError(file + " nests its JSON more than " + std::to_string(kMaxJsonDepth) +
                      " levels deep; no scene needs that");
  }
  if (!outline.long_list.empty()) {
    return InputError(file + " has " + std::to_string(outline.elements) + " elements in '" +
                      Excerpt(std::string(outline.long_list), 80) + "'; expected at most " +
                      std::to_string(outline.most) + ": export it in parts, or without those that nothing uses");
  }
  if (outline.free_values > kMaxFreeValues) {
    return InputError(file + " has at least " + std::to_string(outline.free_values) +
                      " values in extras and extensions; expected at most " + std::to_string(kMaxFreeValues) +
                      ": export it without custom properties");
  }
  // Each of them would be a copy of the binary chunk. glTF allows that to the first buffer alone. Where meshopt packs
  // the meshes, other buffers stand for the unpacked data.
  if (IsGlb(bytes) && outline.buffers_without_uri > 1) {
    return InputError(file + " has " + std::to_string(outline.buffers_without_uri) +
                      " buffers without a uri; expected one, the file's own binary chunk: export it again, with " +
                      "compression of meshes (meshopt) switched off");
  }
  Surroundings surroundings{FolderOf(path), &on_file};
  Status parsed = RunTinygltf(file, surroundings, bytes, model, warnings);
  if (!parsed && surroundings.hidden_pictures) {  // a buffer may have a picture's name
    surroundings = {surroundings.folder, &on_file, true};
    model = tinygltf::Model();
    parsed = RunTinygltf(file, surroundings, bytes, model, warnings);
  }
  for (const tinygltf::Image& image : model.images) {
    if (image.image.empty() && !image.uri.empty()) on_file(PictureFile(path, image.uri));
  }
  return parsed;
}

// The escapes %20 to %FF stand for bytes; a name with another % keeps it.
std::filesystem::path PictureFile(const std::filesystem::path& scene, const std::string& uri) {
  const auto digit = [&](std::size_t at) -> int {
    if (at >= uri.size()) return -1;
    const char c = uri[at];
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0) {
      name += static_cast<char>(digit(i + 1) * 16 + digit(i + 2));
      i += 2;
    } else {
      name += uri[i];
    }
  }
  return FolderOf(scene) + "/" + name;  // also if the name begins with a slash: no file outside is meant
}

}  // namespace scumble
