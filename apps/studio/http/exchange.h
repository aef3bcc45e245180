// One request and its answer, without sockets: what the server hands to the session, and what tests call directly.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace scumble {

struct HttpRequest {
  std::string method;                        // "GET", "PATCH", "POST"
  std::string path;                          // decoded, without the query: "/api/state"
  std::map<std::string, std::string> query;  // decoded
  std::string content_type;                  // without parameters, in small letters
  std::string if_none_match;                 // as sent; empty: not sent
  std::string body;
};

struct HttpResponse {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  // besides those that every answer has
};

// Called from several threads at once.
using HttpHandler = std::function<HttpResponse(const HttpRequest&)>;

}  // namespace scumble
