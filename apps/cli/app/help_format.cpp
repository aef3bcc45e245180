#include "apps/cli/app/help_format.h"

#include <charconv>
#include <cmath>
#include <string>
#include <system_error>
#include <vector>

namespace scumble {
namespace {

constexpr std::size_t kNameColumns = 30;
constexpr std::size_t kTextColumns = 90;

std::string Wrapped(const std::string& text) {
  std::string wrapped;
  std::size_t column = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::size_t length = end - begin;
    if (column > 0 && column + 1 + length > kTextColumns) wrapped += '\n', column = 0;
    if (column > 0) wrapped += ' ', ++column;
    wrapped.append(text, begin, length);
    column += length;
    begin = end + 1;
  }
  return wrapped;
}

const CLI::App& Innermost(const CLI::App& app) {
  const CLI::App* innermost = &app;
  for (auto chosen = innermost->get_subcommands(); !chosen.empty(); chosen = innermost->get_subcommands()) {
    innermost = chosen.front();
  }
  return *innermost;
}

std::string CommandName(const CLI::App& verb) {
  const CLI::App* parent = verb.get_parent();
  return parent ? CommandName(*parent) + " " + verb.get_name() : verb.get_name();
}

std::string VerbNames(const CLI::App& app) {
  std::string names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    names += (names.empty() ? "" : ", ") + verb->get_name();
  }
  return names;
}

std::string ExplainUnknown(const CLI::App& app, const std::string& word) {
  const CLI::App& verb = Innermost(app);
  const bool is_option = word.size() > 1 && word.front() == '-';
  if (&verb == &app) {
    if (is_option) return "unknown option " + word + ": options follow the command, which is one of " + VerbNames(app);
    return "unknown command '" + word + "': expected one of " + VerbNames(app);
  }
  const bool before_verb = !app.remaining().empty() && app.remaining().front() == word;
  if (is_option && before_verb) {
    return "unknown option " + word + " before the command: options follow it, as in " + CommandName(verb) + " " + word;
  }
  if (is_option) return CommandName(verb) + " has no option " + word;
  return CommandName(verb) + " does not take the argument '" + word + "'";
}

// A number that is not whole.
bool IsFraction(const std::string& text) {
  double number = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  return failure == std::errc() && end == text.data() + text.size() && number != std::floor(number);
}

std::string Explain(const CLI::App& app, const CLI::ParseError& error) {
  if (const std::vector<std::string> unknown = app.remaining(true); !unknown.empty()) {
    return ExplainUnknown(app, unknown.front());
  }
  const CLI::App& verb = Innermost(app);
  if (&verb == &app) return "no command given: expected one of " + VerbNames(app);
  std::string reason = error.what();
  // Every option that is converted is a number.
  const std::string unreadable = "Could not convert: ";
  if (reason.rfind(unreadable, 0) == 0) {
    const std::string given = reason.substr(unreadable.size());
    reason =
        (IsFraction(given.substr(given.rfind(' ') + 1)) ? "expected a whole number: " : "expected a number: ") + given;
  }
  return CommandName(verb) + ": " + reason;
}

}  // namespace

HelpFormat::HelpFormat() {
  column_width(kNameColumns);
  label("SUBCOMMAND", "COMMAND");
  label("Positionals", "Arguments");
}

std::string HelpFormat::make_option_name(const CLI::Option* option, bool is_positional) const {
  const std::string name = CLI::Formatter::make_option_name(option, is_positional);
  return name.substr(0, name.find('{'));  // the value that a flag sets
}

std::string HelpFormat::make_option_opts(const CLI::Option* option) const {
  std::string text;
  if (option->get_type_size() != 0) {
    const std::string type = option->get_type_name();  // the check of its values follows a colon
    text = " " + type.substr(0, type.find(':', type.starts_with('[') ? type.find(']') : 0));
    if (!option->get_default_str().empty()) text += " = " + option->get_default_str();
  }
  return text;
}

std::string HelpFormat::make_option_desc(const CLI::Option* option) const {
  return Wrapped(option->get_description() + (option->get_required() ? " (required)" : ""));
}

std::string ExplainUsage(const CLI::App& app, const CLI::ParseError& error) {
  return Explain(app, error) + "\n" + CommandName(Innermost(app)) + " --help lists what there is";
}

}  // namespace scumble
