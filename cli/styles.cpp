// scumble styles.
#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/json_text.h"
#include "cli/options.h"
#include "style/style_file.h"
#include "style/style_keys.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

Expected<ExitCode> ListStyles(const Globals& globals) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::string text;
  ExitCode code = ExitCode::kOk;
  for (const auto& root : StyleRoots()) {
    for (const auto& folder : FindStyles(root)) {
      const Expected<Style> style = LoadStyle(folder);
      if (!style) {  // one broken style does not hide the others
        Warn("style " + folder.filename().string() + " is left out: " + style.error().message);
        code = ExitCodeFor(style.error().kind);
        continue;
      }
      const int size = style->exemplars.front().picture.width;
      json.push_back({{"name", folder.filename().string()},
                      {"folder", folder.string()},
                      {"size", size},
                      {"licence", style->licence}});
      text +=
          fmt::format("{:<16} {:>5}²  {:<10} {}\n", folder.filename().string(), size, style->licence, folder.string());
    }
  }
  Print(globals.json ? JsonText(json) : text.empty() ? "no bundled styles found\n" : text);
  return code;
}

Expected<ExitCode> ListKeys(const Globals& globals) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::string text;
  for (const StyleKey& key : StyleKeys()) {
    const std::string help = key.help + (key.built_in ? "" : " (not built in yet: only the default is accepted)");
    json.push_back({{"key", key.name}, {"default", key.default_value}, {"help", help}});
    text += fmt::format("{:<26} {:<12} {}\n", key.name, key.default_value, help);
  }
  text += fmt::format("{:<26} {:<12} {}\n", "exemplar.image", "", "picture of the painted sphere, required");
  text +=
      fmt::format("{:<26} {:<12} {}\n", "exemplar.guides", "\"\"", "the sphere's guides; empty: it fills the square");
  Print(globals.json ? JsonText(json) : text);
  return ExitCode::kOk;
}

// Loads and prepares the style as a transfer would, and looks for what a painter overlooks.
Expected<ExitCode> CheckStyle(const std::string& path, const Globals& globals) {
  SCUMBLE_ASSIGN(const Style style, OpenStyle({path, {}, {}}));
  SCUMBLE_ASSIGN(const PreparedStyle prepared, Prepare(style, 1080));
  const PreparedExemplar& exemplar = *prepared.exemplar;
  std::size_t usable = 0, transparent = 0;
  std::uint16_t darkest = 65535, brightest = 0;
  for (int y = 0; y < exemplar.size(); ++y) {
    for (int x = 0; x < exemplar.size(); ++x) {
      if (!exemplar.Usable(x, y)) continue;
      const std::uint16_t* texel = exemplar.picture().At(x, y);
      ++usable;
      transparent += texel[3] < 65535;
      darkest = std::min(darkest, texel[1]), brightest = std::max(brightest, texel[1]);
    }
  }
  const double hole_percent = 100.0 * static_cast<double>(transparent) / static_cast<double>(usable);
  const double range_percent = 100.0 * (brightest - darkest) / 65535.0;
  if (transparent > 0) {
    Warn(fmt::format(
        "{}: {:.2f}% of the sphere is transparent and will be so in pictures; fill the holes if that is not wanted",
        path, hole_percent));
  }
  if (range_percent < 25.0) {
    Warn(fmt::format(
        "{}: light and dark differ by {:.0f}% only, shapes will look flat; paint lights lighter and shades darker",
        path, range_percent));
  }
  if (globals.json) {
    Print(JsonText(nlohmann::ordered_json{{"name", style.name},
                                          {"size", style.exemplars.front().picture.width},
                                          {"transparent_percent", hole_percent},
                                          {"range_percent", range_percent}}));
  } else {
    Print(fmt::format("{}: {}² pixels, tonal range {:.0f}%, transparent {:.2f}%: usable\n", style.name,
                      style.exemplars.front().picture.width, range_percent, hole_percent));
  }
  return ExitCode::kOk;
}

}  // namespace

void AddStylesVerb(CLI::App& app, Globals& globals, Action& chosen) {
  CLI::App* sub = app.add_subcommand("styles", "list the bundled styles; check one; list the keys of style.toml");
  auto keys = std::make_shared<bool>(false);
  auto checked = std::make_shared<std::string>();
  sub->add_flag("--keys", *keys, "list every key of style.toml with its default");
  CLI::App* check = sub->add_subcommand("check", "read a style as a transfer would and say what is wrong with it");
  check
      ->add_option("style", *checked,
                   "style folder, style.toml, picture of a painted sphere, or a bundled style's name")
      ->type_name("STYLE")
      ->required();
  AddGlobalOptions(*sub, globals);
  AddGlobalOptions(*check, globals);
  sub->callback([=, &globals, &chosen] {
    chosen = [=, &globals]() -> Expected<ExitCode> {
      if (!checked->empty()) return CheckStyle(*checked, globals);
      return *keys ? ListKeys(globals) : ListStyles(globals);
    };
  });
}

}  // namespace scumble
