// JSON for printing.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace scumble {

// Names of files and objects may hold any bytes; JSON may not, so bytes outside UTF-8 become U+FFFD.
template <class Json>
std::string JsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace scumble
