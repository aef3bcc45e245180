#include "apps/studio/http/connection.h"

#include <exception>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "apps/studio/http/event_stream.h"
#include "apps/studio/http/message.h"
#include "apps/studio/http/target.h"

namespace scumble {
namespace {

using Clock = ClientSocket::Clock;
using Stage = RequestReader::Stage;

constexpr const char *kEvents = "/api/events", *kCalls = "/api/", *kFiles = "/web/";

HttpResponse FileAnswer(const Site& site, const std::string& name, const std::string& if_none_match) {
  auto file = site.files.Find(name);
  if (!file) return ErrorAnswer(404, "usage", "the page has no such file");
  HttpResponse answer{200, file->content_type, std::move(file->body), {{"ETag", file->etag}}};
  if (if_none_match == file->etag) answer.status = 304;
  return answer;
}

// A page that was opened from another one, as from the file that the browser is started on, gets no cookie with
// SameSite=Strict while it is only sent on: it goes on from a page of ours.
HttpResponse FirstVisitAnswer(const RequestHead& head, const SafetyRules& rules) {
  HttpResponse answer{303, "text/html; charset=utf-8", "", {{"Set-Cookie", SetCookieText(rules)}}};
  if (head.sec_fetch_site == "cross-site" || head.sec_fetch_site == "same-site") {
    answer.status = 200;
    answer.body = "<!doctype html><title>Scumble</title><meta http-equiv=\"refresh\" content=\"0;url=/\">";
  } else {
    answer.headers.emplace_back("Location", "/");
  }
  return answer;
}

HttpResponse CallAnswer(const Site& site, const HttpRequest& request) {
  try {
    return site.handler(request);
  } catch (const std::bad_alloc&) {
    return ErrorAnswer(500, "memory", "the machine gives no more memory");
  } catch (const std::exception& error) {
    return ErrorAnswer(500, "internal", error.what());
  }
}

class Connection {
 public:
  Connection(ClientSocket& socket, const Site& site) : socket_(socket), site_(site) {}

  void Serve() {
    while (ReadHead() && AnswerOne()) reader_.Next();
  }

 private:
  // False: there is no further request.
  bool ReadHead() {
    Clock::time_point deadline = Clock::now() + site_.times.idle;
    bool is_begun = reader_.has_bytes();
    if (is_begun) deadline = Clock::now() + site_.times.header;
    while (reader_.stage() == Stage::kHead) {
      std::string bytes;
      const auto result = socket_.Read(bytes, deadline);
      if (result == ClientSocket::Result::kTimedOut && is_begun) return Refuse({408, "the request took too long"});
      if (result != ClientSocket::Result::kOk) return false;
      if (!is_begun) deadline = Clock::now() + site_.times.header;
      is_begun = true;
      reader_.Feed(bytes);
    }
    return reader_.stage() != Stage::kFailed || Refuse(reader_.failure());
  }

  bool ReadBody(const RequestTarget& target) {
    const Clock::time_point deadline = Clock::now() + site_.times.body;
    reader_.ReadBody(BodyLimit(target));
    if (reader_.stage() == Stage::kBody && reader_.head().expects_continue &&
        !socket_.Send({"HTTP/1.1 100 Continue\r\n\r\n"}, site_.times.stall)) {
      return false;
    }
    while (reader_.stage() == Stage::kBody) {
      std::string bytes;
      const auto result = socket_.Read(bytes, deadline);
      if (result == ClientSocket::Result::kTimedOut) return Refuse({408, "the request took too long"});
      if (result != ClientSocket::Result::kOk) return false;
      reader_.Feed(bytes);
    }
    return reader_.stage() != Stage::kFailed || Refuse(reader_.failure());
  }

  // False: the connection ends.
  bool AnswerOne() {
    const RequestHead head = reader_.head();
    const Expected<RequestTarget> target = ParseTarget(head.target);
    if (const auto refusal = CheckRequest(head, target, site_.rules)) {
      if (head.has_body || !head.keep_alive) return Refuse(*refusal);
      reader_.ReadBody(0);
      return Send(RefusalAnswer(*refusal), head);
    }
    if (!ReadBody(*target)) return false;
    if (IsFirstVisit(head, *target, site_.rules)) {
      if (site_.on_first_visit) site_.on_first_visit();
      return Send(FirstVisitAnswer(head, site_.rules), head);
    }
    if (target->path == kEvents) return SendEvents(head);
    return Send(AnswerTo(head, *target), head);
  }

  HttpResponse AnswerTo(const RequestHead& head, const RequestTarget& target) {
    if (target.path == "/") return FileAnswer(site_, "index.html", head.if_none_match);
    if (target.path.starts_with(kFiles)) return FileAnswer(site_, target.path.substr(5), head.if_none_match);
    if (!target.path.starts_with(kCalls)) return ErrorAnswer(404, "usage", "there is nothing at this address");
    HttpRequest request;
    request.method = head.method == "HEAD" ? "GET" : head.method;
    request.path = target.path;
    request.query = target.query;
    request.content_type = PlainContentType(head.content_type);
    request.if_none_match = head.if_none_match;
    request.body = reader_.TakeBody();
    return CallAnswer(site_, request);
  }

  bool SendEvents(const RequestHead& head) {
    if (head.method != "GET" && head.method != "HEAD") {
      return Send(ErrorAnswer(405, "usage", "events are only read: expected GET"), head);
    }
    const std::uint64_t last = FirstEventOf(head.last_event_id, *site_.events);
    HttpResponse answer;
    answer.content_type = "text/event-stream";
    if (!socket_.Send({HeadText(answer, std::nullopt, false)}, site_.times.stall)) return false;
    if (head.method == "GET") StreamEvents(socket_, *site_.events, last, site_.times.silence, site_.times.stall);
    return false;
  }

  // People see a refused page, programs a refused call.
  HttpResponse RefusalAnswer(const Refusal& refusal) const {
    if (reader_.head().target.starts_with(kCalls)) return ErrorAnswer(refusal.status, "usage", refusal.message);
    return {refusal.status, "text/plain; charset=utf-8", "Scumble: " + refusal.message + "\n", {}};
  }

  // Answers and ends the connection, whose further bytes are not read as a request.
  bool Refuse(const Refusal& refusal) {
    const HttpResponse answer = RefusalAnswer(refusal);
    const std::string_view body = reader_.head().method == "HEAD" ? std::string_view() : answer.body;
    if (socket_.Send({HeadText(answer, answer.body.size(), false), body}, site_.times.stall)) {
      socket_.Drain(site_.times.drain);
    }
    return false;
  }

  bool Send(const HttpResponse& answer, const RequestHead& head) {
    const bool has_none = answer.status == 304 || answer.status == 204;
    const auto length = has_none ? std::nullopt : std::optional<std::uint64_t>(answer.body.size());
    const std::string_view body = has_none || head.method == "HEAD" ? std::string_view() : answer.body;
    return socket_.Send({HeadText(answer, length, head.keep_alive), body}, site_.times.stall) && head.keep_alive;
  }

  ClientSocket& socket_;
  const Site& site_;
  RequestReader reader_;
};

}  // namespace

void ServeConnection(ClientSocket& socket, const Site& site) { Connection(socket, site).Serve(); }

}  // namespace scumble
