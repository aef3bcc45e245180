#include "pipeline/style_locations.h"

#include <system_error>
#include <vector>

#include "core/style/nearest_name.h"
#include "core/style/style_file.h"
#include "core/style/style_keys.h"

namespace scumble {

namespace fs = std::filesystem;

namespace {

std::string DataRootsText(const RunContext& context) {
  std::string text;
  for (const fs::path& root : context.data_roots) text += (text.empty() ? "" : " and ") + root.string();
  return text.empty() ? "any folder, since none is named" : text;
}

}  // namespace

std::vector<fs::path> StyleFolders(const RunContext& context) { return context.DataFolders("exemplars"); }

Expected<Style> OpenStyle(const StyleRequest& request, const RunContext& context) {
  SCUMBLE_ASSIGN(const fs::path found, FindStyle(request.style, context));
  return LoadStyle(found, request.sets);
}

bool IsBundledStyle(const std::filesystem::path& path, const RunContext& context) {
  for (const std::filesystem::path& root : StyleFolders(context)) {
    for (const std::filesystem::path& style : FindStyles(root)) {
      std::error_code failed;
      if (std::filesystem::equivalent(style, path, failed) ||
          std::filesystem::equivalent(style, path.parent_path(), failed))
        return true;
    }
  }
  return false;
}

Expected<fs::path> FindStyle(const std::string& name, const RunContext& context, const fs::path& base) {
  std::error_code failed;
  if (fs::exists(base / name, failed)) return base / name;
  if (IsUnpainted(name)) return fs::path(name);
  std::string bundled;
  std::vector<std::string> names{"toon", "render"};
  for (const fs::path& root : StyleFolders(context)) {
    for (const fs::path& style : FindStyles(root)) {
      if (style.filename() == name) return style;
      bundled += (bundled.empty() ? "" : ", ") + style.filename().string();
      names.push_back(style.filename().string());
    }
  }
  const std::string meant = NearestName(name, names);
  const std::string where = base.empty() || fs::path(name).is_absolute() ? "" : " in " + base.string();
  return InputError("there is no style '" + name + "'" + where + ": expected a file, a folder, or " +
                    (bundled.empty()
                         ? "a bundled style, of which there are none in " + DataRootsText(context)
                         : "one of the bundled styles " + bundled + ", or toon or render, which need no painting") +
                    (meant.empty() ? "" : "; did you mean " + meant + "?"));
}

}  // namespace scumble
