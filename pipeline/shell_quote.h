// Words of a command line that is printed to be used again.
#pragma once

#include <string>

namespace scumble {

// As a shell takes it for one word.
std::string Quoted(const std::string& word);

}  // namespace scumble
