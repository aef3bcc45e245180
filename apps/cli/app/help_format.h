// The form of the command line's help, and the messages about wrong arguments.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace scumble {

// Options as "--size WIDTHxHEIGHT = 1280x720", without the parser's own types and validators, wrapped to 120 columns.
class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat();
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

// One sentence about the wrong argument, and where the right ones are listed. The parser reports a missing option
// before an unknown one. The unknown one is the user's typing error, so it comes first here.
std::string ExplainUsage(const CLI::App& app, const CLI::ParseError& error);

}  // namespace scumble
