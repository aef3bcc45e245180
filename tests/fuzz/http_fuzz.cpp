// Requests to the studio's server: the bytes of a connection. Whole or one by one, they are the same requests, and only
// those of our page pass.
#include <algorithm>
#include <vector>

#include "apps/studio/http/message.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

const SafetyRules kRules{4321, "0123456789abcdef"};

// What was read of a request, as one text.
std::string Described(const RequestHead& head, const std::string& body) {
  return head.method + '\0' + head.target + '\0' + head.host + '\0' + head.origin.value_or("none") + '\0' +
         head.cookie + '\0' + head.content_type + '\0' + head.x_scumble + '\0' + body;
}

// A request that passes is one of our page.
void CheckThatIsOurs(const RequestHead& head, const RequestTarget& target) {
  SCUMBLE_CHECK(head.host.size() == 14);  // 127.0.0.1:4321, localhost:4321
  const bool has_token = head.cookie.find("scumble_4321=") != head.cookie.npos;
  SCUMBLE_CHECK((has_token && head.cookie.find(kRules.token) != head.cookie.npos) ||
                target.query.at("token") == kRules.token);
  SCUMBLE_CHECK(target.path.starts_with('/') && target.path.find("..") == target.path.npos);
  SCUMBLE_CHECK(target.path.find('\0') == target.path.npos);
  if (head.method == "GET" || head.method == "HEAD") return;
  SCUMBLE_CHECK((head.method == "POST" || head.method == "PATCH") && target.path.starts_with("/api/"));
  SCUMBLE_CHECK(head.x_scumble == "1" && (!head.origin || *head.origin == "http://" + head.host));
}

// As a connection does: the requests that passed, up to the first that ends the connection.
std::vector<std::string> ReadAll(Bytes input, std::size_t piece) {
  std::vector<std::string> requests;
  RequestReader reader;
  for (std::size_t at = 0; at < input.size(); at += piece) {
    reader.Feed(AsText(input.subspan(at, std::min(piece, input.size() - at))));
    for (bool goes_on = true; goes_on;) {
      if (reader.stage() == RequestReader::Stage::kHeadDone) {
        const auto target = ParseTarget(reader.head().target);
        CheckRefusal(target);
        const auto refusal = CheckRequest(reader.head(), target, kRules);
        SCUMBLE_CHECK(!refusal || (refusal->status >= 400 && !refusal->message.empty()));
        if (refusal) return requests.push_back(std::to_string(refusal->status)), requests;
        CheckThatIsOurs(reader.head(), *target);
        reader.ReadBody(BodyLimit(*target));
      }
      goes_on = reader.stage() == RequestReader::Stage::kDone;
      if (!goes_on) continue;
      const std::string body = reader.TakeBody();
      SCUMBLE_CHECK_LE(body.size(), std::size_t(64) << 20);
      requests.push_back(Described(reader.head(), body));
      if (!reader.head().keep_alive) return requests;
      reader.Next();
      goes_on = reader.stage() == RequestReader::Stage::kHeadDone;
    }
    if (reader.stage() == RequestReader::Stage::kFailed) {
      SCUMBLE_CHECK(reader.failure().status >= 400 && !reader.failure().message.empty());
      return requests;
    }
  }
  return requests;
}

void FuzzHttp(Bytes input) {
  const std::vector<std::string> whole = ReadAll(input, std::max<std::size_t>(input.size(), 1));
  SCUMBLE_CHECK(whole == ReadAll(input, 1));
  // A field of an answer stays one field, whatever is in it.
  HttpResponse answer;
  answer.content_type = answer.body = AsText(input);
  answer.headers.emplace_back("X-Any", AsText(input));
  const std::string head = HeadText(answer, answer.body.size(), true);
  SCUMBLE_CHECK(head.find("\r\n\r\n") == head.size() - 4);
  SCUMBLE_CHECK_LE(std::count(head.begin(), head.end(), '\n'), 12);
  SCUMBLE_CHECK(!ErrorAnswer(400, "usage", AsText(input)).body.empty());
}

}  // namespace
SCUMBLE_FUZZ_TARGET(http, FuzzHttp)
}  // namespace scumble::fuzz
