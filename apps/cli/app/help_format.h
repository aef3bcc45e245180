// How the help of the command line looks, and what is said about arguments that cannot be understood.
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

// One sentence about what is wrong with the arguments, and where the right ones are listed. The parser reports a
// missing option before an unknown one; the unknown one is what the user mistyped, so it is named first here.
std::string ExplainUsage(const CLI::App& app, const CLI::ParseError& error);

}  // namespace scumble
