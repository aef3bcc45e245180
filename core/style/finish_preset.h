// Presets: files with the tables [[finish]] of several effects that make a look.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/style/finish_chain.h"

namespace scumble {

struct FinishPreset : FinishChain {
  std::string name;  // the file's, without .toml
  std::string help;  // one line
};

// Reads a preset: `help`, and [[finish]] as in style.toml, key frames included.
Expected<FinishPreset> LoadFinishPreset(const std::filesystem::path& file);

// The presets in a folder, by name.
std::vector<std::filesystem::path> FindFinishPresets(const std::filesystem::path& folder);

}  // namespace scumble
