// Presets: files with the tables [[finish]] of several effects that make a look.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/image/finish_pass.h"
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

// Whether a --set is one of OverrideFinish, here and in finish_chain.h.
bool IsOfFinish(const std::string& set);

// "finish.NAME.KEY=VALUE": sets the key in every pass of that name; returns how many there are. "dial.NAME=VALUE" turns
// a dial of all passes, and returns how many they are. Values are TOML's; quotes may be left off. Mistakes are kUsage.
Expected<std::size_t> OverrideFinish(std::span<FinishPass> passes, const std::string& text);

// The error where OverrideFinish sets nothing: which names there are.
// `style`: that the text named before a colon.
Error NoSuchFinish(const std::string& text, std::span<const FinishPass> passes, const std::string& style = {});

}  // namespace scumble
