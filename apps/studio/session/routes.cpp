// Which function answers which call.
#include <fmt/format.h>

#include <charconv>

#include "apps/studio/session/session_state.h"
#include "apps/studio/style_keys_json.h"
#include "core/image/hash.h"

namespace scumble {
namespace {

std::string KindName(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return "usage";
    case ErrorKind::kInput:
      return "input";
    case ErrorKind::kOutput:
      return "output";
    case ErrorKind::kUnavailable:
      return "unavailable";
    case ErrorKind::kCancelled:
      return "cancelled";
    case ErrorKind::kMemory:
      return "memory";
  }
  return "input";
}

}  // namespace

nlohmann::json ToJson(const Error& error) { return {{"kind", KindName(error.kind)}, {"message", error.message}}; }

HttpResponse JsonAnswer(const nlohmann::json& body) {
  // Names of a scene may be no UTF-8.
  return {200, "application/json", body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), {}};
}

HttpResponse ErrorAnswer(const Error& error, int otherwise) {
  HttpResponse answer = JsonAnswer({{"error", ToJson(error)}});
  answer.status = error.kind == ErrorKind::kCancelled ? 409 : error.kind == ErrorKind::kOutput ? 507 : otherwise;
  return answer;
}

Expected<int> QueryNumber(const HttpRequest& request, const std::string& name, std::optional<int> otherwise) {
  const auto found = request.query.find(name);
  if (found == request.query.end() && otherwise) return *otherwise;
  int number = 0;
  const std::string text = found == request.query.end() ? "" : found->second;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc() || end != text.data() + text.size()) return UsageError(name + ": expected a whole number");
  return number;
}

Expected<nlohmann::json> BodyOf(const HttpRequest& request) {
  nlohmann::json body = nlohmann::json::parse(request.body, nullptr, false);
  if (!body.is_object()) return UsageError("expected a JSON object");
  return body;
}

std::string EtagOf(const std::string& text) { return fmt::format("\"{:016x}\"", HashText(text)); }

HttpResponse Session::Handle(const HttpRequest& request) {
  using S = State;
  using Call = HttpResponse (S::*)(const HttpRequest&);
  struct Route {
    const char* method;
    const char* path;
    Call call;
  };
  static constexpr Route kRoutes[] = {
      {"PATCH", "/api/state", &S::PatchState},
      {"GET", "/api/frame", &S::GetFrame},
      {"POST", "/api/frame", &S::PostFrame},
      {"GET", "/api/pick", &S::Pick},
      {"GET", "/api/chunk", &S::Chunk},
      {"GET", "/api/fed", &S::Fed},
      {"GET", "/api/exemplar", &S::ExemplarPicture},
      {"GET", "/api/check", &S::Check},
      {"GET", "/api/thumbnail", &S::Thumbnail},
      {"POST", "/api/export", &S::Export},
      {"POST", "/api/save", &S::Save},
      {"POST", "/api/save-as", &S::SaveAs},
      {"GET", "/api/paintable", &S::Paintable},
      {"POST", "/api/paint", &S::Paint},
  };
  if (state_->stopped) return ErrorAnswer(CancelledError());
  if (request.method == "GET" && request.path == "/api/state") return JsonAnswer(state_->StateJson());
  if (request.method == "GET" && request.path == "/api/keys") return JsonAnswer({{"keys", StyleKeysJson()}});
  for (const Route& route : kRoutes) {
    if (request.method == route.method && request.path == route.path) return (state_.get()->*route.call)(request);
  }
  return ErrorAnswer(UsageError("there is no call " + request.method + " " + request.path), 404);
}

}  // namespace scumble
