// JSON as it is printed.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace scumble {

// Names of files and objects may hold any bytes; JSON may not, so what is not UTF-8 becomes U+FFFD.
template <class Json>
std::string JsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace scumble
