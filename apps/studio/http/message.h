// Requests and answers as the bytes of HTTP/1.1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/studio/http/exchange.h"
#include "apps/studio/http/safety.h"

namespace scumble {

// Reads the requests of one connection, one after the other, from bytes in pieces of any length. A header has at most
// kMostHeaderBytes.
class RequestReader {
 public:
  static constexpr std::size_t kMostHeaderBytes = 16 << 10;

  enum class Stage {
    kHead,      // more bytes are needed for the header
    kHeadDone,  // head() is there: ReadBody goes on
    kBody,      // more bytes are needed for the body
    kDone,      // TakeBody() has it, Next() goes on
    kFailed,    // failure() says why; nothing more can be read
  };

  RequestReader();
  ~RequestReader();

  // Adds bytes and reads as far as they go.
  Stage Feed(std::string_view bytes);
  Stage stage() const { return stage_; }
  bool has_bytes() const { return !bytes_.empty(); }  // that were not read yet

  const RequestHead& head() const { return head_; }  // from kHeadDone on
  Stage ReadBody(std::uint64_t most_bytes);
  std::string TakeBody();
  Stage Next();
  const Refusal& failure() const { return failure_; }

 private:
  struct Parser;

  Stage Advance();
  void Fail(int status, std::string message);
  void KeepHead();

  std::unique_ptr<Parser> parser_;
  std::string bytes_;
  Stage stage_ = Stage::kHead;
  RequestHead head_;
  Refusal failure_;
};

// The header of an answer, with the fields that every answer has. `length` is that of the body; empty: the body lasts
// until the connection ends.
std::string HeadText(const HttpResponse& response, std::optional<std::uint64_t> length, bool keep_alive);

// An error as the calls answer it. `kind` is one of api.md's.
HttpResponse ErrorAnswer(int status, std::string_view kind, std::string_view message);

}  // namespace scumble
