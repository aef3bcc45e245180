#include "core/style/finish/finish_tables.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

#include "core/style/color_ramp.h"
#include "core/style/finish/finish_mask_keys.h"
#include "core/style/finish_keys.h"

namespace scumble {
namespace {

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
      auto names = internal::NamesOf(node);
      if (names)
        (name == "objects" ? pass.objects : pass.materials) = *std::move(names);
      else
        done = UsageError(internal::kNamesExpected);
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

}  // namespace scumble
