// scumble styles.
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "apps/cli/app/command.h"
#include "apps/cli/app/json_text.h"
#include "apps/cli/app/options.h"
#include "apps/cli/verbs/styles_check.h"
#include "apps/cli/verbs/styles_tune.h"
#include "apps/studio/style_keys_json.h"
#include "core/style/style_file.h"
#include "core/style/style_keys.h"
#include "pipeline/style_locations.h"
#include "pipeline/tune_style.h"

namespace scumble {
namespace {

// A key that [[exemplar]] has.
struct StyleKeyLine {
  const char *key, *default_value, *help, *kind;
};

// What the list says of a style, whose pictures are not kept.
struct ListedStyle {
  std::filesystem::path folder;
  int size = 0;  // pixels of the first painting's longer side
  std::string licence;
  std::optional<Error> error;
};

std::vector<ListedStyle> ReadStyles(const Globals& globals) {
  std::vector<ListedStyle> listed;
  for (const auto& root : StyleFolders(globals)) {
    for (const auto& folder : FindStyles(root)) listed.push_back({folder, 0, {}, {}});
  }
  tbb::task_arena arena(globals.threads > 0 ? globals.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, listed.size(), [&](std::size_t i) {
      const Expected<Style> style = LoadStyle(listed[i].folder);
      if (!style) {
        listed[i].error = style.error();
        return;
      }
      const Picture& picture = style->exemplars.front().picture;
      listed[i].size = std::max(picture.width, picture.height), listed[i].licence = style->licence;
    });
  });
  return listed;
}

Expected<ExitCode> ListStyles(const Globals& globals) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::string text;
  ExitCode code = ExitCode::kOk;
  for (const auto& [folder, size, licence, error] : ReadStyles(globals)) {
    const std::string name = folder.filename().string();
    if (error) {  // one broken style does not hide the others
      globals.Warn("style " + name + " is left out: " + error->message);
      code = ExitCodeFor(error->kind);
      continue;
    }
    json.push_back({{"name", name}, {"folder", folder.string()}, {"size", size}, {"licence", licence}});
    std::error_code failed;
    if (const auto thumbnail = folder / "thumbnail.png"; std::filesystem::exists(thumbnail, failed)) {
      json.back()["thumbnail"] = thumbnail.string();
    }
    text += fmt::format("{:<16} {:>5}²  {:<10} {}\n", name, size, licence, folder.string());
  }
  Print(globals.json ? JsonText(json) : text.empty() ? "no bundled styles found\n" : text);
  return code;
}

Expected<ExitCode> ListKeys(const Globals& globals) {
  nlohmann::ordered_json json = StyleKeysJson();
  std::string text;
  for (const StyleKey& key : StyleKeys()) {
    text += fmt::format("{:<26} {:<12} {}\n", key.name, key.default_value, key.help);
  }
  const StyleKeyLine of_exemplars[] = {
      {"exemplar.image", "", "picture of the painted sphere, required; in style.toml only", "file"},
      {"exemplar.guides", "\"\"",
       "guides of what is painted; empty: a sphere that fills the square or lies in it; in style.toml only", "file"},
      {"exemplar.luminance", "",
       "of its light; left out: measured; --set exemplar.1.luminance=0.8 sets the first one's", "number"},
      {"exemplar.fills", "false",
       "the sphere fills the square, whatever its paint looks like: none is looked for in it", "flag"}};
  for (const auto& [key, default_value, help, kind] : of_exemplars) {
    json.push_back({{"name", key},
                    {"default", nlohmann::ordered_json::parse(*default_value ? default_value : "null")},
                    {"help", help},
                    {"kind", kind},
                    {"group", "Exemplar"},
                    {"needs_preparing", true}});
    text += fmt::format("{:<26} {:<12} {}\n", key, default_value, help);
  }
  Print(globals.json ? JsonText(json) : text);
  return ExitCode::kOk;
}

}  // namespace

void AddStylesVerb(CLI::App& app, Globals& globals, Action& chosen) {
  CLI::App* sub =
      app.add_subcommand("styles", "list the bundled styles; check or tune one; list the keys of style.toml");
  auto keys = std::make_shared<bool>(false);
  auto checked = std::make_shared<StylesCheck>();
  sub->add_flag("--keys", *keys, "list every key of style.toml with its default");
  CLI::App* check = sub->add_subcommand(
      "check", "read styles as a transfer would and say what is wrong with their paint, where, and how to fix it");
  check
      ->add_option("style", checked->styles,
                   "style folders, style.toml files, pictures of painted spheres, or bundled styles' names")
      ->type_name("STYLE")
      ->required();
  check->add_flag("--strict", checked->strict, "exit code 1 where a style has a mistake; remarks do not count");
  auto tuned = std::make_shared<StylesTune>();
  CLI::App* tune = sub->add_subcommand(
      "tune", "propose keys by which a style's paint looks more like its exemplar's, and what each costs");
  tune->footer(
      "threshold and hybrid are varied together, then variety and blend_radius. The measure is not the eye: look "
      "at\n"
      "the contact sheet of -o in full size before you take one. Takes a minute or two on four scenes.\n");
  tune->add_option("style", tuned->style.request.style, "a style's folder, style.toml, or a bundled style's name")
      ->type_name("STYLE")
      ->required();
  tune->add_option("--scene", tuned->scenes, "a scene to tune on, as often as you like; left out: the sample scenes")
      ->type_name("FILE")
      ->check(RefuseEmpty);
  tune->add_option("--size", tuned->size, "of the pictures")->type_name("WxH")->capture_default_str();
  tune->add_option("--set", tuned->style.sets, "a key that stays as given: transfer.variety=0")->type_name("KEY=VALUE");
  tune->add_option("--seed", tuned->seed, "another random seed")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  tune->add_option("-o,--output", tuned->folder, "folder for a contact sheet, tune.html")
      ->type_name("FOLDER")
      ->check(RefuseEmpty);
  tune->add_option("--write", tuned->write,
                   "put the keys of the N-th proposal, and those of --set, into the style's style.toml")
      ->type_name("N")
      ->check(CLI::Range(1, static_cast<int>(kMostProposals)));
  AddGlobalOptions(*sub, globals);
  AddGlobalOptions(*check, globals);
  AddGlobalOptions(*tune, globals);
  sub->callback([=, &globals, &chosen] {
    chosen = [=, &globals]() -> Expected<ExitCode> {
      if (!checked->styles.empty()) return CheckStyles(*checked, globals);
      if (!tuned->style.request.style.empty()) return RunStylesTune(*tuned, globals);
      return *keys ? ListKeys(globals) : ListStyles(globals);
    };
  });
}

}  // namespace scumble
