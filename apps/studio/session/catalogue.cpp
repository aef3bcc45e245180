#include "apps/studio/session/catalogue.h"

#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/style/finish_keys.h"
#include "core/style/style_file.h"
#include "pipeline/finish_set.h"
#include "pipeline/scene_guides.h"
#include "pipeline/style_locations.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// `name` in UTF-8, or with a number where an entry has that id.
template <class Entry>
std::string UniqueId(const std::vector<Entry>& entries, const std::string& name) {
  using nlohmann::json;
  const std::string wanted = json::parse(json(name).dump(-1, ' ', false, json::error_handler_t::replace));
  std::string id = wanted;
  const auto is_taken = [&] {
    return std::any_of(entries.begin(), entries.end(), [&](auto& e) { return e.id == id; });
  };
  for (int number = 2; is_taken(); ++number) id = wanted + " " + std::to_string(number);
  return id;
}

template <class Entry>
const Entry* EntryOf(const std::vector<Entry>& entries, const std::string& id) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.id == id; });
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

fs::path StyleEntry::toml() const {
  std::error_code failed;
  if (fs::is_directory(path, failed)) return path / "style.toml";
  if (path.extension() == ".toml") return path;
  return {};
}

bool StyleEntry::IsWritable() const {
  const fs::path file = toml();
  return !bundled && !file.empty() && ::access(file.c_str(), W_OK) == 0 &&
         ::access((file.has_parent_path() ? file.parent_path() : fs::path(".")).c_str(), W_OK) == 0;
}

const SceneEntry* Catalogue::FindScene(const std::string& id) const { return EntryOf(scenes, id); }
const StyleEntry* Catalogue::FindStyle(const std::string& id) const { return EntryOf(styles, id); }

std::string Catalogue::AddScene(const std::string& file, bool bundled) {
  for (const SceneEntry& entry : scenes) {
    std::error_code failed;
    if (entry.file == file || fs::equivalent(entry.file, file, failed)) return entry.id;
  }
  scenes.push_back({UniqueId(scenes, fs::path(file).stem().string()), file, bundled});
  return scenes.back().id;
}

std::string Catalogue::AddStyle(const std::string& given, const fs::path& path, bool bundled) {
  for (const StyleEntry& entry : styles) {
    std::error_code failed;
    if (entry.path == path || fs::equivalent(entry.path, path, failed)) return entry.id;
  }
  fs::path named = path.filename() == "style.toml" ? fs::absolute(path).parent_path() : path;
  if (!named.has_filename()) named = named.parent_path();  // a folder with a slash at its end
  std::error_code failed;
  const std::string wanted = (fs::is_directory(named, failed) ? named.filename() : named.stem()).string();
  styles.push_back({UniqueId(styles, wanted), given, path, bundled});
  return styles.back().id;
}

Expected<Catalogue> MakeCatalogue(const std::string& scene, const std::vector<std::string>& styles,
                                  const RunContext& context) {
  Catalogue all;
  if (!scene.empty()) {
    if (!IsScene(scene)) {
      return InputError(scene + " is no scene: expected a .glb, .gltf, .obj, .ply or .blend file");
    }
    std::error_code failed;
    if (!fs::exists(scene, failed)) return InputError("cannot open " + scene + ": there is no such file");
    all.AddScene(scene, false);
  }
  std::vector<fs::path> bundled;
  for (const fs::path& root : StyleFolders(context)) {
    for (const fs::path& style : FindStyles(root)) bundled.push_back(style);
  }
  for (const std::string& given : styles) {
    SCUMBLE_ASSIGN(const fs::path path, scumble::FindStyle(given, context));
    all.AddStyle(given, path, IsBundledStyle(path, context));
  }
  for (const fs::path& style : bundled) all.AddStyle(style.filename().string(), style, true);
  std::vector<fs::path> files;
  for (const fs::path& folder : context.DataFolders("scenes")) {
    std::error_code failed;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
      if (entry.path().extension() == ".glb") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) all.AddScene(file.string(), true);
  SCUMBLE_ASSIGN(const std::vector<FinishPreset> presets, FinishPresets(context));
  for (const FinishPreset& preset : presets) all.finishes.push_back({preset.name, preset.help});
  for (const FinishEffect& effect : FinishEffects()) all.finishes.push_back({effect.name, effect.help});
  return all;
}

}  // namespace scumble
