// Every line of the safety table: what is refused, with which status, and by a server as well as by the rules alone.
#include "apps/studio/http/safety.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/studio/http/target.h"
#include "tests/apps/studio/http/raw_client.h"

namespace scumble {
namespace {

using testing::HasSubstr;
using testing::Not;

const SafetyRules kRules{4321, kTestToken};

RequestHead Head(const std::string& method = "GET") {
  RequestHead head;
  head.method = method;
  head.host = "127.0.0.1:4321";
  head.cookie = "a=b; scumble_4321=" + std::string(kTestToken);
  if (method != "GET") {
    head.origin = "http://127.0.0.1:4321";
    head.sec_fetch_site = "same-origin";
    head.x_scumble = "1";
    head.has_body = true;
    head.content_type = "application/json; charset=utf-8";
  }
  return head;
}

int StatusIn(const RequestHead& head, const std::string& target = "/api/state") {
  const auto refusal = CheckRequest(head, ParseTarget(target), kRules);
  EXPECT_TRUE(!refusal || !refusal->message.empty());
  return refusal ? refusal->status : 200;
}

TEST(StudioSafety, ThePageIsServed) {
  EXPECT_EQ(StatusIn(Head()), 200);
  EXPECT_EQ(StatusIn(Head("HEAD")), 400);  // with a body
  EXPECT_EQ(StatusIn(Head("PATCH")), 200);
  EXPECT_EQ(StatusIn(Head("POST"), "/api/save"), 200);
}

TEST(StudioSafety, HostIsOurs) {
  for (const char* host : {"", "evil.example", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:43210", "localhost.:4321",
                           "127.0.0.1.evil.example:4321", "[::1]:4321", "0.0.0.0:4321", "127.0.0.1:4321 x"}) {
    RequestHead head = Head();
    head.host = host;
    EXPECT_EQ(StatusIn(head), 403) << host;
    EXPECT_EQ(StatusIn(head, "/?token=" + std::string(kTestToken)), 403) << host;
  }
  RequestHead head = Head();
  head.host = "LocalHost:4321";
  EXPECT_EQ(StatusIn(head), 200);
}

TEST(StudioSafety, CookieHasTheToken) {
  for (const std::string& cookie :
       {std::string(), std::string("scumble_4321="), std::string("scumble_4321"),
        "scumble_4322=" + std::string(kTestToken), std::string("scumble_4321=0"),
        "scumble_4321=" + std::string(64, '0'), "xscumble_4321=" + std::string(kTestToken)}) {
    RequestHead head = Head();
    head.cookie = cookie;
    EXPECT_EQ(StatusIn(head), 401) << cookie;
    EXPECT_EQ(StatusIn(head, "/"), 401) << cookie;
    EXPECT_EQ(StatusIn(head, "/?token=" + std::string(64, '0')), 401) << cookie;
    EXPECT_EQ(StatusIn(head, "/api/state?token=" + std::string(kTestToken)), 401) << cookie;
    EXPECT_EQ(StatusIn(head, "/?token=" + std::string(kTestToken)), 200) << cookie;
  }
  RequestHead twice = Head();  // an old one beside the right one
  twice.cookie = "scumble_4321=old;scumble_4321=" + std::string(kTestToken);
  EXPECT_EQ(StatusIn(twice), 200);
}

TEST(StudioSafety, ChangesComeFromOurPage) {
  for (const std::string method : {"PATCH", "POST"}) {
    RequestHead head = Head(method);
    head.x_scumble = "";
    EXPECT_EQ(StatusIn(head), 403);
    head = Head(method);
    for (const char* origin : {"null", "", "http://evil.example", "https://127.0.0.1:4321", "http://localhost:4321"}) {
      head.origin = origin;
      EXPECT_EQ(StatusIn(head), 403) << origin;
    }
    head = Head(method);
    for (const char* site : {"cross-site", "same-site", "none", "other"}) {
      head.sec_fetch_site = site;
      EXPECT_EQ(StatusIn(head), 403) << site;
    }
    head = Head(method);
    for (const char* type :
         {"", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "image/png"}) {
      head.content_type = type;
      EXPECT_EQ(StatusIn(head), 415) << type;
    }
    EXPECT_EQ(StatusIn(head, "/api/paint"), 200);  // PNG
    head.has_body = false;
    head.content_type = "";
    EXPECT_EQ(StatusIn(head), 200);
  }
}

TEST(StudioSafety, OtherPagesReadNothing) {
  for (const char* site : {"cross-site", "same-site"}) {
    RequestHead head = Head();
    head.sec_fetch_site = site;
    EXPECT_EQ(StatusIn(head), 403) << site;
    EXPECT_EQ(StatusIn(head, "/web/page.js"), 403) << site;
    EXPECT_EQ(StatusIn(head, "/"), 200) << site;  // a link, with the cookie
  }
  RequestHead head = Head();
  head.sec_fetch_site = "none";  // typed in
  EXPECT_EQ(StatusIn(head), 200);
  head.origin = "http://evil.example";
  EXPECT_EQ(StatusIn(head), 403);
}

TEST(StudioSafety, OtherMethodsAreRefused) {
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "get", "BREW"}) {
    EXPECT_EQ(StatusIn(Head(method)), 405) << method;
  }
  EXPECT_EQ(StatusIn(Head("POST"), "/"), 405);
  EXPECT_EQ(StatusIn(Head("PATCH"), "/web/page.js"), 405);
}

TEST(StudioSafety, FieldsStandOnce) {
  RequestHead head = Head();
  head.is_ambiguous = true;
  EXPECT_EQ(StatusIn(head), 400);
}

TEST(StudioServer, RefusesBeforeTheHandlerSeesARequest) {
  int calls = 0;
  const TestServer test([&](const HttpRequest& request) { return ++calls, TestServer::Echo(request); });
  const std::string get = "GET /api/state HTTP/1.1\r\n", host = "Host: " + test.host() + "\r\n", end = "\r\n";
  EXPECT_EQ(StatusOf(test.Ask(get + "Host: evil.example\r\n" + test.cookie() + end)), "403");
  EXPECT_EQ(StatusOf(test.Ask(get + test.cookie() + end)), "403");
  EXPECT_EQ(StatusOf(test.Ask(get + host + host + test.cookie() + end)), "403");
  EXPECT_EQ(StatusOf(test.Ask(get + host + end)), "401");
  EXPECT_EQ(StatusOf(test.Ask(get + host + "Cookie: scumble_1=" + kTestToken + "\r\n\r\n")), "401");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/save"))), "403");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/save", "X-Scumble: 1\r\nOrigin: null\r\n"))), "403");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/save", "X-Scumble: 1\r\nX-Scumble: 1\r\n"))), "400");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /web/../server.cpp"))), "400");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /web/%2e%2e/server.cpp"))), "400");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("OPTIONS /api/state", "Origin: http://evil.example\r\n"))), "405");
  EXPECT_EQ(calls, 0);
  const std::string refused = test.Ask(test.Request("OPTIONS /api/state"));
  EXPECT_THAT(refused, HasSubstr("{\"error\":{\"kind\":\"usage\",\"message\":\""));
  EXPECT_THAT(refused, Not(HasSubstr("Access-Control")));
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /api/state"))), "200");
  EXPECT_EQ(calls, 1);
}

TEST(StudioServer, EveryAnswerHasTheSafeFields) {
  const TestServer test;
  for (const std::string& request : {test.Request("GET /"), test.Request("GET /api/state"), test.Request("GET /none"),
                                     std::string("GET / HTTP/1.1\r\n\r\n"), std::string("nonsense\r\n\r\n"),
                                     test.Request("GET /?token=" + std::string(kTestToken))}) {
    const std::string answer = test.Ask(request);
    EXPECT_THAT(answer, HasSubstr("\r\nContent-Security-Policy: default-src 'none'; script-src 'self'; "
                                  "style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
                                  "frame-ancestors 'none'; base-uri 'none'; form-action 'none'\r\n"));
    for (const char* field : {"X-Content-Type-Options: nosniff", "Referrer-Policy: no-referrer", "Cache-Control: no-",
                              "Cross-Origin-Opener-Policy: same-origin", "Cross-Origin-Resource-Policy: same-origin"}) {
      EXPECT_THAT(answer, HasSubstr(field)) << request;
    }
  }
}

TEST(StudioServer, TheAddressSetsTheCookie) {
  int visits = 0;
  ServerOptions options = TestServer::Options();
  options.on_first_visit = [&] { ++visits; };
  const TestServer test(TestServer::Echo, options);
  EXPECT_EQ(test.server->address(), "http://" + test.host() + "/?token=" + kTestToken);
  const std::string request = "GET /?token=" + std::string(kTestToken) + " HTTP/1.1\r\nHost: " + test.host() + "\r\n";
  const std::string answer = test.Ask(request + "\r\n");
  EXPECT_EQ(StatusOf(answer), "303");
  EXPECT_THAT(answer, HasSubstr("\r\nLocation: /\r\n"));
  const std::string cookie =
      "\r\nSet-" + test.cookie().substr(0, test.cookie().size() - 2) + "; HttpOnly; SameSite=Strict; Path=/\r\n";
  EXPECT_THAT(answer, HasSubstr(cookie));
  // From the file that the browser is started on.
  const std::string from_file = test.Ask(request + "Sec-Fetch-Site: cross-site\r\n\r\n");
  EXPECT_EQ(StatusOf(from_file), "200");
  EXPECT_THAT(from_file, HasSubstr(cookie));
  EXPECT_THAT(from_file, HasSubstr("http-equiv=\"refresh\" content=\"0;url=/\""));
  EXPECT_EQ(visits, 2);
}

}  // namespace
}  // namespace scumble
