// The arguments of the command line, one a line: parsed as the program parses them; no command is run. Every value also
// goes to each parser of option values, and all of them are the lines of an @FILE of --assign.
#include <CLI/CLI.hpp>
#include <algorithm>

#include "apps/cli/app/help_format.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/verbs.h"
#include "core/io/picture_file.h"
#include "core/style/kit/print_page.h"
#include "pipeline/frame_range.h"
#include "pipeline/sequence.h"
#include "pipeline/style/assignments.h"
#include "pipeline/style_set.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

struct Program {
  CLI::App app{"Scumble: paint a sphere, stylise a scene.", "scumble"};
  Globals globals;
  Action chosen;
  Program() {
    app.require_subcommand(1);
    AddVerbs(app, globals, chosen);
  }
};

// A style of one small exemplar, as the target of --set.
const std::string& SmallStyle() {
  static const std::string folder = [] {
    Picture white(4, 4);
    std::fill(white.rgba.begin(), white.rgba.end(), std::uint16_t{65535});
    SCUMBLE_CHECK(WritePicture(Folder() / "lit.png", white).ok());
    constexpr std::string_view kText = "[[exemplar]]\nimage = \"lit.png\"\n";
    InFile("style.toml", {reinterpret_cast<const std::uint8_t*>(kText.data()), kText.size()});
    return Folder().string();
  }();
  return folder;
}

void ReadValue(const std::string& text) {
  CheckRefusal(ParseSize(text), 1000 + text.size());
  CheckRefusal(ParseNumbers(text, 1, 4, "--numbers"), 1000 + text.size());
  CheckRefusal(ParseFrameRate(text), 1000 + text.size());
  CheckRefusal(ParseExposure(text), 1000 + text.size());
  CheckRefusal(ParsePaperSize(text), 1000 + text.size());
  CheckRefusal(ParseLengthMm(text), 1000 + text.size());
  if (!text.starts_with('@')) CheckRefusal(ReadAssignments({text}), 1000 + 2 * text.size());
  const auto frames = ParseFrames(text);
  CheckRefusal(frames, 1000 + 2 * text.size());
  if (frames) SCUMBLE_CHECK(*ParseFrames(FramesToText(*frames)) == *frames);
  const auto name = FrameName::Parse(text);
  CheckRefusal(name, 1000 + 2 * text.size());
  if (name) SCUMBLE_CHECK(!name->At(-5).empty() || text.empty());
  StyleRequest style;
  style.style = SmallStyle();
  const std::size_t most = 3000 + 3 * text.size() + 3 * SmallStyle().size();
  const auto sets = ParseStyleOverrides({text, SmallStyle() + ":" + text});
  CheckRefusal(sets, most);
  if (sets) style.sets = *sets, CheckRefusal(OpenStyles(style, RunContext()), most);
  static_cast<void>(NamePattern(text.substr(text.size() / 2)).Fits(text.substr(0, text.size() / 2)));
}

void FuzzOptions(Bytes input) {
  if (input.size() > 4096) return;
  static Program program;  // to make one takes a thousand times as long as to parse a line
  std::vector<std::string> arguments;
  std::string_view text = AsText(input);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    arguments.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  for (const std::string& argument : arguments) ReadValue(argument);
  // An argument could name any file of the system; this one is ours.
  CheckRefusal(ReadAssignments({"@" + InFile("sheet.txt", input).string()}), 2000 + 2 * input.size());
  try {
    program.app.parse(ArgumentsLastFirst(std::move(arguments)));
  } catch (const CLI::Success&) {
  } catch (const CLI::ParseError& error) {
    SCUMBLE_CHECK(!ExplainUsage(program.app, error).empty());
  }
}

}  // namespace
SCUMBLE_FUZZ_TARGET(options, FuzzOptions)
}  // namespace scumble::fuzz
