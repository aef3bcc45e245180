// The JSON with which a page changes what it shows. Refused as a whole or taken as a whole; what was taken is told in
// the same words, and its command line is one that the program takes.
#include <CLI/CLI.hpp>

#include "apps/cli/app/help_format.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/verbs.h"
#include "apps/studio/session/session_state.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

const Catalogue& SmallCatalogue() {
  static const Catalogue catalogue = [] {
    Catalogue all;
    all.AddScene("/none/suzanne's house.glb", false);
    all.AddScene("/none/toys.blend", true);
    for (const char* name : {"oil", "ink"}) all.AddStyle(name, std::string("/none/") + name, true);
    return all;
  }();
  return catalogue;
}

// The words of a line that pipeline/shell_quote.h has quoted, as a shell takes it.
std::vector<std::string> WordsOf(const std::string& line) {
  std::vector<std::string> words = {""};
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\'') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && line[i] == '\\') {
      SCUMBLE_CHECK(++i < line.size());
      words.back() += line[i];
    } else if (!is_quoted && line[i] == ' ') {
      words.emplace_back();
    } else {
      words.back() += line[i];
    }
  }
  SCUMBLE_CHECK(!is_quoted);
  return words;
}

void CheckCommand(const StudioState& state) {
  const std::string line = CommandOf(JobOf(state, SmallCatalogue(), SceneRequest(), false));
  SCUMBLE_CHECK(line.find('\0') == line.npos);
  const std::vector<std::string> words = WordsOf(line);
  SCUMBLE_CHECK(words.front() == "scumble");
  CLI::App app("Scumble", "scumble");
  Globals globals;
  Action chosen;
  app.require_subcommand(1);
  AddVerbs(app, globals, chosen);
  std::vector<std::string> reversed(words.rbegin(), words.rend() - 1);  // as CLI11 takes them
  try {
    app.parse(reversed);
  } catch (const CLI::Error& error) {
    scumble::internal::FailCheck(__FILE__, __LINE__, error.what());
  }
}

// All that a PATCH can set.
nlohmann::json SettingsOf(const StudioState& state) {
  nlohmann::json settings = ToJson(state);
  if (state.budget_ms > 0) {
    settings.erase("quality");
  } else {
    settings.erase("budget_ms");
  }
  return settings;
}

void FuzzState(Bytes input) {
  HttpRequest request;
  request.body = AsText(input);
  const Expected<nlohmann::json> body = BodyOf(request);
  CheckRefusal(body);
  if (!body) return;
  StudioState before;
  before.scene = SmallCatalogue().scenes.front().id, before.style = "oil";
  const Expected<StudioState> after = Patched(before, *body, SmallCatalogue());
  CheckRefusal(after, 2000 + 3 * input.size());
  if (!after) return;
  SCUMBLE_CHECK(SmallCatalogue().FindScene(after->scene) && SmallCatalogue().FindStyle(after->style));
  const nlohmann::json told = ToJson(*after);
  const Expected<StudioState> again = Patched(before, SettingsOf(*after), SmallCatalogue());
  SCUMBLE_CHECK(again.ok());
  SCUMBLE_CHECK(ToJson(*again) == told);
  CheckCommand(*after);
}

}  // namespace
SCUMBLE_FUZZ_TARGET(state, FuzzState)
}  // namespace scumble::fuzz
