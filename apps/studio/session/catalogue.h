// The scenes and styles that the page may choose from, by id: no call takes a path.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/run_context.h"

namespace scumble {

struct SceneEntry {
  std::string id;    // the file's name without its ending; made unique
  std::string file;  // as the command line takes it
  bool bundled = false;
};

struct StyleEntry {
  std::string id;
  std::string given;           // as the command line takes it: a path, or a bundled style's name
  std::filesystem::path path;  // where it is
  bool bundled = false;

  // The style.toml; empty: a bare picture.
  std::filesystem::path toml() const;
  // Whether Save may change the style.toml: ours to write, and not a bundled one.
  bool IsWritable() const;
};

// A preset of finishing effects, or one effect, as --finish names it.
struct FinishEntry {
  std::string name, help;
};

struct Catalogue {
  std::vector<SceneEntry> scenes;
  std::vector<StyleEntry> styles;
  std::vector<FinishEntry> finishes;  // presets first

  const SceneEntry* FindScene(const std::string& id) const;
  const StyleEntry* FindStyle(const std::string& id) const;
  // Adds it, unless its path is there; returns its id.
  std::string AddScene(const std::string& file, bool bundled);
  std::string AddStyle(const std::string& given, const std::filesystem::path& path, bool bundled);
};

// The named scene and styles first, then the bundled ones. `scene` may be empty. kInput where something named is not
// there.
Expected<Catalogue> MakeCatalogue(const std::string& scene, const std::vector<std::string>& styles,
                                  const RunContext& context);

}  // namespace scumble
