#include "apps/cli/verbs/styles_tune.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <system_error>

#include "apps/cli/app/json_text.h"
#include "apps/cli/app/made_folders.h"
#include "apps/cli/app/options.h"
#include "core/io/atomic_file.h"
#include "core/io/picture_file.h"
#include "core/style/style_edit.h"
#include "core/style/style_keys.h"
#include "measure/html_page.h"
#include "pipeline/style_locations.h"
#include "pipeline/tune_style.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 4> kSampleScenes = {"suzanne", "stilllife", "toys", "snail"};
constexpr const char* kPage = "tune.html";

// The sample scenes lie beside the bundled styles.
Expected<std::vector<std::string>> SampleScenes(const RunContext& context) {
  for (const fs::path& styles : StyleFolders(context)) {
    std::vector<std::string> scenes;
    for (const char* const name : kSampleScenes) {
      const fs::path scene = styles.parent_path() / "scenes" / (std::string(name) + ".glb");
      std::error_code failed;
      if (fs::exists(scene, failed)) scenes.push_back(scene.string());
    }
    if (!scenes.empty()) return scenes;
  }
  return InputError("the sample scenes are not where the bundled styles are: name scenes of your own with --scene");
}

std::string OptionsOf(const TunedStyle& style) {
  std::string text;
  for (const StyleOverride& setting : style.settings) text += (text.empty() ? "--set " : " --set ") + setting.text;
  return text;
}

std::string NameOf(std::size_t place) { return place == 0 ? "as it is" : fmt::format("{}", place); }

// The style as it is, then the proposals.
std::vector<const TunedStyle*> AllOf(const TuneReport& report) {
  std::vector<const TunedStyle*> all{&report.own};
  for (const TunedStyle& one : report.proposals) all.push_back(&one);
  return all;
}

std::string TextOf(const TuneReport& report) {
  std::string text = fmt::format("{} on {}; {} variants were painted\n\n{:<9} {:>8} {:>6}  keys\n", report.style,
                                 fmt::join(report.scenes, ", "), report.tried, "", "texture", "time");
  const std::vector<const TunedStyle*> all = AllOf(report);
  for (std::size_t i = 0; i < all.size(); ++i) {
    text += fmt::format("{:<9} {:>8.3f} {:>6.2f}  {}\n", NameOf(i), all[i]->texture, all[i]->time, OptionsOf(*all[i]));
  }
  text += fmt::format(
      "\ntexture: how far the paint looks from the exemplar's, of the style as it is; other seeds differ by {:.3f}.\n"
      "time: of the transfer and its finishing effects, likewise.\n",
      report.chance);
  if (report.proposals.empty()) text += "Nothing that was tried is nearer to the exemplar by more than that.\n";
  return text;
}

Expected<std::string> PageOf(const TuneReport& report) {
  constexpr const char* kStyle =
      ".sheet { display: grid; gap: .6rem; } .sheet img { width: 100%; display: block; } .sheet code { font-size: 85%; "
      "}";
  std::string html = internal::PageHead(report.style + ", tuned", kStyle);
  html += fmt::format(
      "<h1>{}, tuned</h1>\n<p>{} variants were painted; other random seeds differ by {:.3f}. Look at whole "
      "pictures before you choose: open one in a tab of its own.</p>\n",
      internal::EscapeHtml(report.style), report.tried, report.chance);
  html += fmt::format("<div class=\"sheet\" style=\"grid-template-columns: repeat({}, 1fr)\">\n", report.scenes.size());
  const std::vector<const TunedStyle*> all = AllOf(report);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string options = internal::EscapeHtml(OptionsOf(*all[i]));
    html += fmt::format("<p style=\"grid-column: 1 / -1\"><b>{}</b>: texture {:.3f}, time {:.2f}{}</p>\n",
                        i == 0 ? "The style as it is" : NameOf(i), all[i]->texture, all[i]->time,
                        options.empty() ? "" : " <code>" + options + "</code>");
    for (std::size_t s = 0; s < all[i]->pictures.size(); ++s) {
      SCUMBLE_ASSIGN(const std::vector<std::byte> png, EncodePng(all[i]->pictures[s]));
      html += fmt::format("<img alt=\"{}\" src=\"{}\">\n", internal::EscapeHtml(report.scenes[s] + ", " + NameOf(i)),
                          internal::PngAddress(png));
    }
  }
  return html + "</div>\n</body></html>\n";
}

nlohmann::ordered_json JsonOf(const TuneReport& report) {
  nlohmann::ordered_json json{{"style", report.style},
                              {"scenes", report.scenes},
                              {"tried", report.tried},
                              {"chance", report.chance},
                              {"proposals", nlohmann::ordered_json::array()}};
  for (const TunedStyle& one : report.proposals) {
    std::vector<std::string> settings;
    for (const StyleOverride& setting : one.settings) settings.push_back(setting.text);
    json["proposals"].push_back({{"settings", settings}, {"texture", one.texture}, {"time", one.time}});
  }
  return json;
}

// The file to write to, which is not that of a bundled style.
Expected<fs::path> StyleFileOf(const StyleRequest& style, const RunContext& context) {
  SCUMBLE_ASSIGN(const fs::path found, FindStyle(style.style, context));
  std::error_code failed;
  if (IsBundledStyle(found, context)) {
    return UsageError(style.style + " is a bundled style, which --write would change for everybody: copy " +
                      found.string() + " and tune the copy");
  }
  const fs::path file = fs::is_directory(found, failed) ? found / "style.toml" : found;
  if (file.extension() != ".toml" || !fs::exists(file, failed)) {
    return InputError(style.style + " has no style.toml to write to: `scumble sphere` makes a folder with one");
  }
  return file;
}

// Whether a key given by --set can be written to style.toml.
Status CheckCanBeWritten(const StyleOverride& set) {
  const StyleKey* const key = set.style.empty() ? FindStyleKey(set.key) : nullptr;
  const std::string value = key ? set.text.substr(set.key.size() + 1) : "";
  const bool is_quoted = value.starts_with('"') || value.starts_with('\'');
  // The file is found from another folder there.
  const bool is_file = key && key->kind == KeyKind::kFile && !value.empty() && !value.starts_with('#') && !is_quoted;
  if (key && !is_file) return Ok();
  return UsageError("--set " + ToText(set) +
                    ": --write cannot put that into style.toml; write it there yourself and leave it out here");
}

// The text of a style.toml with the keys that were given, with which the proposals were made, and with `more`.
Expected<std::string> NewText(const fs::path& file, std::vector<StyleOverride> sets,
                              const std::vector<StyleOverride>& more) {
  for (const StyleOverride& set : sets) SCUMBLE_RETURN_IF_ERROR(CheckCanBeWritten(set));
  sets.insert(sets.end(), more.begin(), more.end());
  SCUMBLE_ASSIGN(const std::vector<std::byte> bytes, ReadWholeFile(file));
  return WithSettings(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), sets, file.string());
}

Status Write(const std::vector<StyleOverride>& sets, const TunedStyle& chosen, const fs::path& file,
             const Globals& globals) {
  SCUMBLE_ASSIGN(const std::string text, NewText(file, sets, chosen.settings));
  SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(file, text));
  std::vector<std::string> written;
  for (const auto* list : {&sets, &chosen.settings}) {
    for (const StyleOverride& one : *list) written.push_back(one.key + "=" + TomlText(std::get<KeyValue>(one.value)));
  }
  globals.Note(fmt::format("{}: {}", file.string(), fmt::join(written, ", ")));
  return Ok();
}

// Before minutes of work.
Status CheckTargets(const StylesTune& tune, const std::vector<StyleOverride>& sets, const fs::path& style_file) {
  if (!style_file.empty()) {
    SCUMBLE_RETURN_IF_ERROR(NewText(style_file, sets, {}));
    // Whether the keys of proposals can be written there; values do not matter.
    std::vector<StyleOverride> tuned;
    for (const char* key : {"transfer.threshold", "transfer.hybrid", "transfer.variety", "transfer.blend_radius"})
      tuned.push_back(MakeOverride(key, std::int64_t(0)));
    if (!NewText(style_file, {}, tuned)) {
      return InputError(style_file.string() +
                        ": --write cannot put keys into [transfer] as it is written there; write [transfer] and each "
                        "of its keys on a line of its own");
    }
    SCUMBLE_RETURN_IF_ERROR(CheckWritable(style_file));
  }
  if (tune.folder.empty()) return Ok();
  const MadeFolders folders(tune.folder);  // removed again, because minutes of work may be interrupted
  std::error_code failed;
  if (!fs::is_directory(tune.folder, failed)) {
    return OutputError(fmt::format("-o {}: it is no folder, and none can be made{}; name another", tune.folder,
                                   folders.error() ? ": " + folders.error().message() : ""));
  }
  return CheckWritable(fs::path(tune.folder) / kPage);
}

}  // namespace

Expected<ExitCode> RunStylesTune(const StylesTune& tune, const Globals& globals) {
  TuneRequest request{{}, tune.scenes, {}, tune.seed};
  SCUMBLE_ASSIGN(request.style, ToRequest(tune.style));
  request.style.scene_styles = false;
  SCUMBLE_ASSIGN(request.size, ParseSize(tune.size));
  if (request.scenes.empty()) {
    SCUMBLE_ASSIGN(request.scenes, SampleScenes(globals));
  }
  fs::path style_file;
  if (tune.write > 0) {
    SCUMBLE_ASSIGN(style_file, StyleFileOf(request.style, globals));
  }
  SCUMBLE_RETURN_IF_ERROR(CheckTargets(tune, request.style.sets, style_file));
  SCUMBLE_ASSIGN(const TuneReport report, TuneStyle(request, globals));
  Print(globals.json ? JsonText(JsonOf(report)) : TextOf(report));
  if (!tune.folder.empty()) {
    SCUMBLE_ASSIGN(const std::string page, PageOf(report));
    const MadeFolders folders(tune.folder);
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(fs::path(tune.folder) / kPage, page));
    globals.Note((fs::path(tune.folder) / kPage).string() + ": the pictures side by side");
  }
  if (tune.write == 0) return ExitCode::kOk;
  if (static_cast<std::size_t>(tune.write) > report.proposals.size()) {
    return UsageError(
        fmt::format("--write {}: there are {} proposals, nothing was written", tune.write, report.proposals.size()));
  }
  const TunedStyle& chosen = report.proposals[static_cast<std::size_t>(tune.write) - 1];
  SCUMBLE_RETURN_IF_ERROR(Write(request.style.sets, chosen, style_file, globals));
  return ExitCode::kOk;
}

}  // namespace scumble
