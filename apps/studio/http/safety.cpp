#include "apps/studio/http/safety.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "apps/studio/http/token.h"

namespace scumble {
namespace {

constexpr std::string_view kPaint = "/api/paint";

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
  return text;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool IsRead(const RequestHead& head) { return head.method == "GET" || head.method == "HEAD"; }

}  // namespace

std::optional<Refusal> CheckHost(const RequestHead& head, int port) {
  const std::string host = LowerCase(head.host), ending = ":" + std::to_string(port);
  if (host == "127.0.0.1" + ending || host == "localhost" + ending) return std::nullopt;
  return Refusal{403, "the request is for another host: open the address that scumble studio printed"};
}

std::optional<Refusal> CheckMethod(const RequestHead& head, const RequestTarget& target) {
  if (IsRead(head)) {
    if (head.has_body) return Refusal{400, "a request that only reads has no body"};
    return std::nullopt;
  }
  const bool changes = head.method == "PATCH" || head.method == "POST";
  if (changes && target.path.starts_with("/api/")) return std::nullopt;
  return Refusal{405, "the method is not for this address: expected GET, or PATCH and POST of calls under /api/"};
}

std::optional<Refusal> CheckOrigin(const RequestHead& head, const RequestTarget& target) {
  if (IsRead(head) && target.path == "/") return std::nullopt;
  const bool from_us = head.sec_fetch_site.empty() || head.sec_fetch_site == "same-origin";
  const bool typed_in = IsRead(head) && head.sec_fetch_site == "none";
  if (!from_us && !typed_in) return Refusal{403, "the request comes from another page than the studio's"};
  if (head.origin && *head.origin != "http://" + head.host) {
    return Refusal{403, "the request comes from another origin than the studio's page"};
  }
  return std::nullopt;
}

std::optional<Refusal> CheckChange(const RequestHead& head, const RequestTarget& target) {
  if (IsRead(head)) return std::nullopt;
  if (head.x_scumble != "1") return Refusal{403, "the header X-Scumble: 1 is missing, which every change needs"};
  const std::string_view expected = target.path == kPaint ? "image/png" : "application/json";
  if (head.has_body && PlainContentType(head.content_type) != expected) {
    return Refusal{415, "the body is of another kind: expected " + std::string(expected)};
  }
  return std::nullopt;
}

std::optional<Refusal> CheckCookie(const RequestHead& head, const SafetyRules& rules) {
  const std::string name = CookieName(rules.port);
  for (std::string_view rest = head.cookie; !rest.empty();) {
    const std::string_view pair = rest.substr(0, rest.find(';'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (equals == pair.npos || Trimmed(pair.substr(0, equals)) != name) continue;
    if (EqualInConstantTime(Trimmed(pair.substr(equals + 1)), rules.token)) return std::nullopt;
  }
  return Refusal{401,
                 "this browser is not known, or the studio was started again: open the address that scumble "
                 "studio printed, with its token"};
}

bool IsFirstVisit(const RequestHead& head, const RequestTarget& target, const SafetyRules& rules) {
  const auto token = target.query.find("token");
  return IsRead(head) && target.path == "/" && token != target.query.end() &&
         EqualInConstantTime(token->second, rules.token);
}

std::optional<Refusal> CheckRequest(const RequestHead& head, const Expected<RequestTarget>& target,
                                    const SafetyRules& rules) {
  if (auto refusal = CheckHost(head, rules.port)) return refusal;
  if (head.is_ambiguous) return Refusal{400, "the request's header is ambiguous"};
  if (!target) return Refusal{400, target.error().message};
  if (auto refusal = CheckMethod(head, *target)) return refusal;
  if (auto refusal = CheckOrigin(head, *target)) return refusal;
  if (auto refusal = CheckChange(head, *target)) return refusal;
  if (IsFirstVisit(head, *target, rules)) return std::nullopt;
  return CheckCookie(head, rules);
}

std::string CookieName(int port) { return "scumble_" + std::to_string(port); }

std::string SetCookieText(const SafetyRules& rules) {
  return CookieName(rules.port) + "=" + rules.token + "; HttpOnly; SameSite=Strict; Path=/";
}

std::string PlainContentType(const std::string& text) {
  return LowerCase(std::string(Trimmed(std::string_view(text).substr(0, text.find(';')))));
}

std::uint64_t BodyLimit(const RequestTarget& target) { return target.path == kPaint ? 64u << 20 : 64u << 10; }

}  // namespace scumble
