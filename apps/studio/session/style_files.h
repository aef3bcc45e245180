// Saving: changed keys into a style.toml, and a style as a new one. The only files that the studio writes, with the
// paint of exemplar_paint.h.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "apps/studio/session/catalogue.h"
#include "core/image/status.h"
#include "core/style/style_keys.h"

namespace scumble {

// The text of the style's file with these keys: only their lines change. A bare picture's has an [[exemplar]] for it.
Expected<std::string> StyleText(const StyleEntry& style, const std::map<std::string, KeyValue>& keys);

// Writes it, whole or not at all. kUsage where the style is not ours to write, kOutput where the disk refuses.
Status SaveStyle(const StyleEntry& style, const std::map<std::string, KeyValue>& keys);

// Makes the folder `folder`/`name` with the style's files and these keys; returns it. It appears whole or not at all.
// kUsage for a name that is none, or that is taken.
Expected<std::filesystem::path> SaveStyleAs(const StyleEntry& style, const std::map<std::string, KeyValue>& keys,
                                            const std::filesystem::path& folder, const std::string& name);

}  // namespace scumble
