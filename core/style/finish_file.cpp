#include "core/style/finish_file.h"

#include <algorithm>
#include <system_error>

#include "core/io/file/atomic_file.h"
#include "core/style/color_ramp.h"
#include "core/style/finish_keys.h"
#include "core/style/finish_mask_keys.h"
#include "core/style/finish_names.h"
#include "core/style/finish_tables.h"

namespace scumble {
namespace {

constexpr std::size_t kMaxPresetBytes = 1 << 20;

// Files that a pass names stand beside the file that names them.
void ResolveFiles(const std::filesystem::path& folder, FinishPass& pass) {
  // Without an ending it is the name of bundled strokes.
  if (auto* const hatch = std::get_if<HatchPass>(&pass.effect); hatch && hatch->strokes.find('.') != std::string::npos)
    hatch->strokes = (folder / hatch->strokes).string();
  if (auto* const toon = std::get_if<ToonPass>(&pass.effect); toon && !toon->ramp.empty() && !IsRampText(toon->ramp))
    toon->ramp = (folder / toon->ramp).string();
  auto* const palette = std::get_if<PalettePass>(&pass.effect);
  if (!palette) return;
  for (std::string* const source : {&palette->like, &palette->from}) {
    if (IsPaletteFile(*source)) *source = (folder / *source).string();
  }
}

Expected<FinishPass> ReadPass(const toml::table& table, const std::string& file,
                              std::vector<internal::FinishFrames>& frames) {
  const auto* effect = table.get("effect");
  const auto* name_of_effect = effect ? effect->as_string() : nullptr;
  if (!name_of_effect) {
    return InputError(internal::Where(file, table) + ": [[finish]] has no effect; add effect = \"outline\"");
  }
  Expected<FinishPass> made = MakeFinishPass(name_of_effect->get());
  if (!made) return InputError(internal::Where(file, *effect) + ": " + made.error().message);
  FinishPass pass = *std::move(made);
  std::vector<internal::FinishFrames> of_pass;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (name == "effect") continue;
    const auto value = internal::ValueOf(node);
    Status done = Ok();
    if (name == "objects" || name == "materials") {
      done = internal::ReadNames(node, name == "objects" ? pass.objects : pass.materials);
    } else if (name == "name") {
      const auto* text = value ? std::get_if<std::string>(&*value) : nullptr;
      if (!text || text->empty() || text->find_first_of(".=: ") != std::string::npos)
        done = UsageError("expected a text without dots, colons, blanks or =");
      else
        pass.name = *text;
    } else if (const auto* pairs = node.as_array(); pairs && FindFinishKey(pass, name)) {
      of_pass.push_back({name, pairs});
    } else if (!value) {
      done = FindFinishKey(pass, name) ? UsageError("expected a plain value") : SetFinishKey(pass, name, std::string());
    } else if (const auto* shape = std::get_if<std::string>(&*value); shape && name == kMaskKey) {
      done = SetMaskShape(*shape, std::filesystem::path(file).parent_path(), pass.mask);
    } else {
      done = SetFinishKey(pass, name, *value);
    }
    if (!done) return InputError(internal::Where(file, node) + ": finish." + name + ": " + done.error().message);
  }
  ResolveFiles(std::filesystem::path(file).parent_path(), pass);
  for (internal::FinishFrames& one : of_pass) {
    one.key = kFinishKeys + pass.name + "." + one.key;
    frames.push_back(std::move(one));
  }
  return pass;
}

}  // namespace

Expected<std::vector<FinishPass>> internal::ReadFinishTables(const toml::node& node, const std::string& file,
                                                             std::vector<FinishFrames>& frames) {
  std::vector<FinishPass> passes;
  const auto* array = node.as_array();
  if (!array) return InputError(Where(file, node) + ": write [[finish]] with two brackets");
  for (const auto& item : *array) {
    const auto* table = item.as_table();
    if (!table) return InputError(Where(file, item) + ": write [[finish]] with two brackets");
    SCUMBLE_ASSIGN(FinishPass pass, ReadPass(*table, file, frames));
    passes.push_back(std::move(pass));
  }
  for (const FinishFrames& one : frames) {
    const auto is_it = [&](const FinishPass& pass) { return one.key.rfind(kFinishKeys + pass.name + ".", 0) == 0; };
    if (std::count_if(passes.begin(), passes.end(), is_it) > 1) {
      return InputError(Where(file, *one.pairs) + ": " + one.key +
                        " changes over time, and two passes have that name: give each a name of its own");
    }
  }
  return passes;
}

namespace {

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

bool IsOfFinish(const std::string& set) { return set.rfind(kFinishKeys, 0) == 0 || set.rfind(kDialKeys, 0) == 0; }

Expected<std::size_t> OverrideFinish(std::span<FinishPass> passes, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return UsageError("--set " + text + ": expected KEY=VALUE");
  const std::string value_text = text.substr(equals + 1);
  const auto parsed = internal::ParseSetValue(value_text);
  const auto value = parsed && parsed->size() == 1 ? internal::ValueOf(*parsed->get("value")) : std::nullopt;
  const std::string key = text.substr(0, equals);
  if (key.rfind(kDialKeys, 0) == 0) {
    const Status turned = TurnFinishDial(passes, key, value ? *value : KeyValue(value_text));
    return turned ? Expected<std::size_t>(passes.size()) : UsageError("--set " + text + ": " + turned.error().message);
  }
  Expected<std::size_t> count = SetFinishKeys(passes, key, value ? *value : KeyValue(value_text));
  if (!count) return UsageError("--set " + text + ": " + count.error().message);
  return count;
}

Error NoSuchFinish(const std::string& text, std::span<const FinishPass> passes, const std::string& style) {
  std::string names;
  for (const FinishPass& pass : passes) names += (names.empty() ? "" : ", ") + pass.name;
  return UsageError("--set " + (style.empty() ? "" : style + ":") + text + ": no finish " +
                    (style.empty() ? "" : "of that style ") + "has that name; " +
                    (!names.empty()  ? "there are " + names
                     : style.empty() ? "there is none, give --finish or [[finish]] of style.toml"
                                     : "there is none in its style.toml; those of --finish go without a style's name"));
}

}  // namespace scumble
