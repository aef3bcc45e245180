#include "apps/studio/http/message.h"

#include <algorithm>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/string_body.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace scumble {

namespace http = boost::beast::http;

struct RequestReader::Parser : http::request_parser<http::string_body> {};

RequestReader::RequestReader() { Next(); }
RequestReader::~RequestReader() = default;

RequestReader::Stage RequestReader::Next() {
  parser_ = std::make_unique<Parser>();
  parser_->header_limit(static_cast<std::uint32_t>(kMostHeaderBytes));
  parser_->body_limit(boost::none);  // depends on the header
  head_ = RequestHead();
  stage_ = Stage::kHead;
  return Advance();
}

RequestReader::Stage RequestReader::Feed(std::string_view bytes) {
  bytes_ += bytes;
  return Advance();
}

void RequestReader::Fail(int status, std::string message) {
  failure_ = {status, std::move(message)};
  stage_ = Stage::kFailed;
}

RequestReader::Stage RequestReader::Advance() {
  // A body comes in pieces, whose ends the parser does not always see at once.
  while (!bytes_.empty() && (stage_ == Stage::kHead || stage_ == Stage::kBody)) {
    boost::beast::error_code error;
    const std::size_t read = parser_->put(boost::asio::buffer(bytes_), error);
    bytes_.erase(0, read);
    if (error == http::error::need_more) {
      // The parser limits headers, but not the lines between the parts of a body.
      if (bytes_.size() > 2 * kMostHeaderBytes) Fail(400, "the body is malformed");
      break;
    }
    if (error == http::error::header_limit) {
      Fail(431, "the request's header is too large: at most 16 kB");
    } else if (error == http::error::body_limit) {
      Fail(413, "the request's body is too large");
    } else if (error) {
      Fail(400, "the request is malformed: " + error.message());
    } else if (stage_ == Stage::kHead && parser_->is_header_done()) {
      KeepHead();
      stage_ = Stage::kHeadDone;
    } else if (parser_->is_done()) {
      stage_ = Stage::kDone;
    } else if (read == 0) {
      break;
    }
  }
  return stage_;
}

void RequestReader::KeepHead() {
  const auto& request = parser_->get();
  const auto single = [&](auto name) {
    head_.is_ambiguous |= request.count(name) > 1;
    return std::string(request[name]);
  };
  head_.method = std::string(request.method_string());
  head_.target = std::string(request.target());
  head_.host = request.count(http::field::host) == 1 ? std::string(request[http::field::host]) : "";
  if (request.count(http::field::origin) > 0) head_.origin = single(http::field::origin);
  head_.sec_fetch_site = single("Sec-Fetch-Site");
  head_.cookie = single(http::field::cookie);
  head_.content_type = single(http::field::content_type);
  head_.x_scumble = single("X-Scumble");
  head_.if_none_match = single(http::field::if_none_match);
  head_.last_event_id = single("Last-Event-ID");
  head_.has_body = parser_->chunked() || parser_->content_length().value_or(0) > 0;
  head_.expects_continue = boost::beast::iequals(single(http::field::expect), "100-continue");
  head_.keep_alive = parser_->keep_alive();
  const std::string encoding = single(http::field::transfer_encoding);
  head_.is_ambiguous |= !encoding.empty() && !boost::beast::iequals(encoding, "chunked");
}

RequestReader::Stage RequestReader::ReadBody(std::uint64_t most_bytes) {
  if (parser_->is_done()) return stage_ = Stage::kDone;
  if (!parser_->chunked() && parser_->content_length().value_or(0) > most_bytes) {
    Fail(413, "the request's body is too large: at most " + std::to_string(most_bytes >> 10) + " kB");
    return stage_;
  }
  parser_->body_limit(most_bytes);
  parser_->eager(true);
  stage_ = Stage::kBody;
  return Advance();
}

std::string RequestReader::TakeBody() { return std::move(parser_->get().body()); }

namespace {

constexpr std::pair<const char*, const char*> kFieldsOfAll[] = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
     "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"}};

// Values may hold names of files: no line of the header ends inside one.
std::string OnOneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '_');
  return text;
}

}  // namespace

std::string HeadText(const HttpResponse& response, std::optional<std::uint64_t> length, bool keep_alive) {
  http::response<http::empty_body> head;
  head.result(static_cast<unsigned>(response.status));
  for (const auto& [name, value] : kFieldsOfAll) head.set(name, value);
  if (!response.content_type.empty()) head.set(http::field::content_type, OnOneLine(response.content_type));
  for (const auto& [name, value] : response.headers) head.insert(name, OnOneLine(value));
  // What has a tag may be kept, and is asked for again before it is shown.
  const bool may_be_kept = head.count(http::field::etag) > 0;
  head.set(http::field::cache_control, may_be_kept ? "no-cache" : "no-store");
  if (length) head.content_length(*length);
  head.keep_alive(keep_alive);
  http::response_serializer<http::empty_body> serializer(head);
  std::string text;
  boost::beast::error_code error;
  while (!serializer.is_done() && !error) {
    serializer.next(error, [&](boost::beast::error_code&, const auto& buffers) {
      text += boost::beast::buffers_to_string(buffers);
      serializer.consume(boost::asio::buffer_size(buffers));
    });
  }
  return text;
}

HttpResponse ErrorAnswer(int status, std::string_view kind, std::string_view message) {
  const nlohmann::json body = {{"error", {{"kind", kind}, {"message", message}}}};
  return {status, "application/json", body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), {}};
}

}  // namespace scumble
