#include "core/style/finish_preset.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "core/io/atomic_file.h"
#include "core/style/finish/finish_tables.h"
#include "core/style/finish_keys.h"

namespace scumble {
namespace {

constexpr std::size_t kMaxPresetBytes = 1 << 20;

Status ReadChain(const toml::node& node, const std::filesystem::path& path, FinishChain& chain) {
  std::vector<internal::FinishFrames> frames;
  SCUMBLE_ASSIGN(chain.passes, internal::ReadFinishTables(node, path.string(), frames));
  for (const internal::FinishFrames& one : frames) {
    const std::string where = internal::Where(path.string(), *one.pairs) + ": ";
    auto keys = internal::FramesOf(*one.pairs);
    if (!keys || keys->empty()) {
      return InputError(where + one.key +
                        ": expected a plain value, or frames with their values as [[1, 0.1], [24, 0.3]]");
    }
    StyleTrack track;
    track.name = one.key, track.keys = *std::move(keys), track.folder = path.parent_path();
    const auto is_it = [&](const FinishPass& pass) { return one.key.rfind(kFinishKeys + pass.name + ".", 0) == 0; };
    const auto pass = std::find_if(chain.passes.begin(), chain.passes.end(), is_it);
    const auto done = AddFinishTrack(chain, std::size_t(pass - chain.passes.begin()), std::move(track));
    if (!done) return InputError(where + done.error().message);
  }
  return Ok();
}

}  // namespace

Expected<FinishPreset> LoadFinishPreset(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxPresetBytes));
  const std::string file = path.string();
  SCUMBLE_ASSIGN(const toml::table root,
                 internal::ParseToml({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file));
  FinishPreset preset;
  preset.name = path.stem().string();
  for (const auto& [key, node] : root) {
    if (key.str() == "finish") {
      SCUMBLE_RETURN_IF_ERROR(ReadChain(node, path, preset));
    } else if (const auto* text = node.as_string(); text && key.str() == "help") {
      preset.help = text->get();
    } else {
      return InputError(internal::Where(file, node) + ": unknown key " + std::string(key.str()) +
                        "; a preset has help, a text, and [[finish]]");
    }
  }
  if (preset.passes.empty()) {
    return InputError(file + " has no [[finish]]; add [[finish]] and effect = \"outline\" under it");
  }
  return preset;
}

std::vector<std::filesystem::path> FindFinishPresets(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace scumble
