// Which requests are answered. Any web page can make a browser send requests to this machine, and other users of the
// machine can send their own: only the page that this program opened is served.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/studio/http/target.h"

namespace scumble {

// A request without its body. Header fields are as they were sent, empty where they were not.
struct RequestHead {
  std::string method;
  std::string target;
  std::string host;
  std::optional<std::string> origin;
  std::string sec_fetch_site;
  std::string cookie;
  std::string content_type;
  std::string x_scumble;
  std::string if_none_match;
  std::string last_event_id;
  bool has_body = false;
  bool expects_continue = false;
  bool keep_alive = false;
  bool is_ambiguous = false;  // one of these fields was sent twice, or the body is encoded as none of ours is
};

struct SafetyRules {
  int port = 0;
  std::string token;
};

// What is answered instead: a status of HTTP, and a sentence.
struct Refusal {
  int status = 403;
  std::string message;
};

// First of all: Host is 127.0.0.1:PORT or localhost:PORT. A page of another name that leads here (DNS rebinding) has
// its own.
std::optional<Refusal> CheckHost(const RequestHead& head, int port);
// GET and HEAD anywhere, PATCH and POST of calls.
std::optional<Refusal> CheckMethod(const RequestHead& head, const RequestTarget& target);
// The page itself may be reached from anywhere. All else is asked for by it alone, as Sec-Fetch-Site and Origin say.
std::optional<Refusal> CheckOrigin(const RequestHead& head, const RequestTarget& target);
// Changes have the header X-Scumble and a content type that no form can send.
std::optional<Refusal> CheckChange(const RequestHead& head, const RequestTarget& target);
// The cookie has the token.
std::optional<Refusal> CheckCookie(const RequestHead& head, const SafetyRules& rules);

// Whether this is the first visit, "/?token=T" with the right token: it needs no cookie and gets one.
bool IsFirstVisit(const RequestHead& head, const RequestTarget& target, const SafetyRules& rules);

// All of these in this order; nothing where the request may be answered.
std::optional<Refusal> CheckRequest(const RequestHead& head, const Expected<RequestTarget>& target,
                                    const SafetyRules& rules);

// The cookie's name has the port: a browser sends the cookies of all ports of a host.
std::string CookieName(int port);
std::string SetCookieText(const SafetyRules& rules);

// In small letters, without parameters.
std::string PlainContentType(const std::string& text);

// Bytes of a body.
std::uint64_t BodyLimit(const RequestTarget& target);

}  // namespace scumble
