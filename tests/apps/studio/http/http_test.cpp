// The server over real sockets: clients that are slow, rude, many or gone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "apps/studio/http/event_stream.h"
#include "apps/studio/http/message.h"
#include "tests/apps/studio/http/raw_client.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

ServerOptions Impatient() {
  ServerOptions options = TestServer::Options();
  options.times = {150ms, 300ms, 300ms, 300ms, 50ms, 100ms};
  return options;
}

std::string Chunked(const std::string& body, std::size_t piece) {
  std::string text;
  for (std::size_t at = 0; at < body.size(); at += piece) {
    const std::string part = body.substr(at, piece);
    char size[20];
    std::snprintf(size, sizeof(size), "%zx\r\n", part.size());
    text += size + part + "\r\n";
  }
  return text + "0\r\n\r\n";
}

TEST(StudioServer, AnswersOneRequestAfterTheOther) {
  const TestServer test;
  RawClient client(test.server->port());
  for (int i = 0; i < 3; ++i) {
    client.Send(test.Request("GET /api/a%20b?x=1"));
    EXPECT_THAT(client.Answer(), EndsWith("\r\n\r\nGET /api/a b "));
  }
  client.Send(test.Change("PATCH /api/state", "{}") + test.Request("GET /api/two"));  // at once
  EXPECT_THAT(client.Answer(), EndsWith("PATCH /api/state {}"));
  EXPECT_THAT(client.Answer(), EndsWith("GET /api/two "));
  client.Send(test.Request("GET /api/last", "Connection: close\r\n"));
  EXPECT_THAT(client.ReadTo(""), HasSubstr("Connection: close"));
  EXPECT_TRUE(client.ended());
}

TEST(StudioServer, HeadIsGetWithoutABody) {
  const TestServer test;
  RawClient client(test.server->port());
  client.Send(test.Request("HEAD /api/state") + test.Request("GET /api/state"));
  const std::string head = client.ReadTo("\r\n\r\n");
  EXPECT_EQ(StatusOf(head), "200");
  EXPECT_THAT(head, HasSubstr("Content-Length: 15"));
  EXPECT_THAT(client.Answer(), EndsWith("GET /api/state "));
}

TEST(StudioServer, BytesMayComeOneByOne) {
  const TestServer test;
  RawClient client(test.server->port());
  for (const char byte : test.Change("POST /api/save", "{\"a\": 1}")) ASSERT_TRUE(client.Send(std::string(1, byte)));
  EXPECT_THAT(client.Answer(), EndsWith("POST /api/save {\"a\": 1}"));
}

TEST(StudioServer, ChunkedBodiesAreRead) {
  const TestServer test;
  const std::string fields = "X-Scumble: 1\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n";
  const std::string fits(64 << 10, ' ');
  EXPECT_THAT(test.Ask(test.Request("POST /api/save", fields) + Chunked(fits, 1000)), EndsWith("save " + fits));
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/save", fields) + Chunked(fits + " ", 1000))), "413");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/save", fields) + "zz\r\n")), "400");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/save", fields) + "1;" + std::string(100000, 'x'))), "400");
  const std::string gzip = "X-Scumble: 1\r\nContent-Type: application/json\r\nTransfer-Encoding: gzip\r\n";
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/save", gzip) + "x")), "400");
}

TEST(StudioServer, BodiesHaveALimit) {
  const TestServer test;
  EXPECT_EQ(StatusOf(test.Ask(test.Change("POST /api/save", std::string(64 << 10, ' ')))), "200");
  const std::string refused = test.Ask(test.Change("POST /api/save", std::string((64 << 10) + 1, ' ')));
  EXPECT_EQ(StatusOf(refused), "413");
  EXPECT_THAT(refused, HasSubstr("at most 64 kB"));
  const std::string png = "X-Scumble: 1\r\nContent-Type: image/png\r\nContent-Length: ";
  const std::string paint(3 << 20, 'p');
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/paint", png + std::to_string(paint.size()) + "\r\n") + paint)),
            "200");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/paint", png + "67108865\r\n"))), "413");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("POST /api/paint", png + "99999999999999999999\r\n"))), "400");
}

TEST(StudioServer, ExpectIsAnsweredBeforeTheBody) {
  const TestServer test;
  RawClient client(test.server->port());
  client.Send(test.Request("POST /api/save",
                           "X-Scumble: 1\r\nContent-Type: application/json\r\nContent-Length: 2\r\n"
                           "Expect: 100-continue\r\n"));
  EXPECT_EQ(client.ReadTo("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  client.Send("{}");
  EXPECT_THAT(client.Answer(), EndsWith("save {}"));
}

TEST(StudioServer, HeadersHaveALimit) {
  const TestServer test;
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /api/a", "X-Long: " + std::string(14 << 10, 'x') + "\r\n"))), "200");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /api/a", "X-Long: " + std::string(20 << 10, 'x') + "\r\n"))), "431");
  EXPECT_EQ(StatusOf(test.Ask(std::string(40 << 10, 'x'))), "431");
}

TEST(StudioServer, NonsenseIsRefused) {
  const TestServer test;
  for (const std::string& text : {std::string("\x16\x03\x01\x02\x00\x01\x00 TLS\r\n\r\n"), std::string("GET\r\n\r\n"),
                                  std::string("GET / HTTP/2.0\r\n\r\n"), std::string("GET / HTTP/1.1\nHost: a\n\n"),
                                  test.Request("POST /api/a", "Content-Length: 1\r\nTransfer-Encoding: chunked\r\n"),
                                  test.Request("POST /api/a", "Content-Length: 1\r\nContent-Length: 2\r\n")}) {
    EXPECT_EQ(StatusOf(test.Ask(text)), "400") << text;
  }
}

TEST(StudioServer, SlowClientsAreLeft) {
  const TestServer test(TestServer::Echo, Impatient());
  RawClient header(test.server->port()), body(test.server->port()), idle(test.server->port());
  header.Send("GET /api/state HT");
  body.Send(test.Request("POST /api/save", "X-Scumble: 1\r\nContent-Type: application/json\r\nContent-Length: 9\r\n") +
            "{");
  EXPECT_EQ(StatusOf(header.ReadTo("")), "408");
  EXPECT_EQ(StatusOf(body.ReadTo("")), "408");
  EXPECT_EQ(idle.ReadTo(""), "");
  EXPECT_TRUE(idle.ended());
}

TEST(StudioServer, DripsDoNotProlongAHeader) {
  const TestServer test(TestServer::Echo, Impatient());
  RawClient client(test.server->port());
  const auto start = std::chrono::steady_clock::now();
  client.Send("GET /api/state HTTP/1.1\r\n");
  while (client.Send("X: y\r\n") && std::chrono::steady_clock::now() - start < 5s) std::this_thread::sleep_for(20ms);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 3s);
}

TEST(StudioServer, ClientsThatTakeNothingAreLeft) {
  std::atomic<int> calls = 0;
  const TestServer test(
      [&](const HttpRequest&) {
        return ++calls, HttpResponse{200, "image/jpeg", std::string(64 << 20, 'j'), {}};
      },
      Impatient());
  RawClient client(test.server->port());
  client.Send(test.Request("GET /api/frame"));
  std::this_thread::sleep_for(700ms);
  EXPECT_EQ(calls, 1);
  EXPECT_LT(client.ReadTo("").size(), std::size_t(64) << 20);
}

TEST(StudioServer, AClientMayLeaveWhileTheHandlerRuns) {
  std::atomic<int> running = 0;
  std::atomic<bool> go_on = false;
  const TestServer test([&](const HttpRequest&) {
    ++running;
    while (!go_on) std::this_thread::sleep_for(1ms);
    return HttpResponse{200, "image/jpeg", std::string(8 << 20, 'j'), {}};
  });
  for (int i = 0; i < 5; ++i) {
    RawClient client(test.server->port());
    client.Send(test.Request("GET /api/frame"));
    while (running <= i) std::this_thread::sleep_for(1ms);
  }
  go_on = true;
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /web/none"))), "404");
}

TEST(StudioServer, ConnectionsHaveALimit) {
  const TestServer test;
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 100; ++i) {
    clients.push_back(std::make_unique<RawClient>(test.server->port()));
    clients.back()->Send(test.Request("GET /api/state"));
  }
  int served = 0, refused = 0;
  for (const auto& client : clients) {
    const std::string status = StatusOf(client->Answer());
    served += status == "200";
    refused += status == "503";
  }
  EXPECT_EQ(served, 64);
  EXPECT_EQ(refused, 36);
  clients.clear();
  // When they have gone there is room again.
  std::string status;
  for (int i = 0; i < 200 && status != "200"; ++i) {
    std::this_thread::sleep_for(10ms);
    status = StatusOf(test.Ask(test.Request("GET /api/state")));
  }
  EXPECT_EQ(status, "200");
}

TEST(StudioServer, StopsWhileClientsWait) {
  std::atomic<bool> is_stopping = false;
  std::atomic<int> running = 0;
  TestServer test([&](const HttpRequest& request) {
    ++running;
    while (!is_stopping) std::this_thread::sleep_for(1ms);
    return TestServer::Echo(request);
  });
  RawClient idle(test.server->port()), header(test.server->port()), events(test.server->port()),
      call(test.server->port());
  header.Send("GET /api/sta");
  events.Send(test.Request("GET /api/events"));
  events.ReadTo("retry: 1000\n\n");
  call.Send(test.Request("GET /api/frame"));
  while (running == 0) std::this_thread::sleep_for(1ms);
  const auto start = std::chrono::steady_clock::now();
  test.hub.Publish("bye", "{}");
  is_stopping = true;
  test.server->Stop();
  EXPECT_LT(std::chrono::steady_clock::now() - start, 2s);
  EXPECT_EQ(events.ReadTo(""), "id: 1\nevent: bye\ndata: {}\n\n");
  EXPECT_EQ(StatusOf(call.Answer()), "200");
  test.server->Stop();  // again
}

TEST(StudioServer, EventsGoOnWhereAStreamEnded) {
  TestServer test;
  test.hub.Publish("state", "{\"revision\": 1}");
  {
    RawClient first(test.server->port());
    first.Send(test.Request("GET /api/events"));
    const std::string head = first.ReadTo("retry: 1000\n\n");
    EXPECT_THAT(head, HasSubstr("Content-Type: text/event-stream"));
    EXPECT_THAT(head, HasSubstr("Cache-Control: no-store"));
    test.hub.Publish("state", "{\"revision\": 2}");
    EXPECT_EQ(first.ReadTo("\n\n"), "id: 2\nevent: state\ndata: {\"revision\": 2}\n\n");
  }
  test.hub.Publish("problem", "null");
  test.hub.Publish("busy", "{}");
  RawClient again(test.server->port());
  again.Send(test.Request("GET /api/events", "Last-Event-ID: 2\r\n"));
  again.ReadTo("retry: 1000\n\n");
  EXPECT_EQ(again.ReadTo("\n\n"), "id: 3\nevent: problem\ndata: null\n\n");
  EXPECT_EQ(again.ReadTo("\n\n"), "id: 4\nevent: busy\ndata: {}\n\n");
  EXPECT_EQ(FirstEventOf("99", test.hub), 4u);  // of an earlier run
  EXPECT_EQ(FirstEventOf("-1", test.hub), 4u);
  EXPECT_EQ(FirstEventOf("3", test.hub), 3u);
}

TEST(StudioServer, QuietStreamsHaveComments) {
  const TestServer test(TestServer::Echo, Impatient());
  RawClient client(test.server->port());
  client.Send(test.Request("GET /api/events"));
  client.ReadTo("retry: 1000\n\n");
  EXPECT_EQ(client.ReadTo("\n\n"), ": \n\n");
}

TEST(StudioEvents, TheHubKeepsTheLast64) {
  EventHub hub;
  for (int i = 0; i < 100; ++i) hub.Publish("state", std::to_string(i));
  EXPECT_EQ(hub.After(0, 0ms)->id, 37u);
  EXPECT_EQ(hub.After(99, 0ms)->data, "99");
  EXPECT_FALSE(hub.After(100, 1ms));
  hub.Close();
  hub.Publish("state", "late");
  EXPECT_EQ(hub.last_id(), 100u);
  EXPECT_EQ(hub.After(99, 0ms)->id, 100u);
  EXPECT_FALSE(hub.After(100, 10s));
}

TEST(StudioServer, HandlersMayFail) {
  const TestServer test([](const HttpRequest& request) -> HttpResponse {
    if (request.path == "/api/memory") throw std::bad_alloc();
    throw std::runtime_error("broken \xff");
  });
  EXPECT_THAT(test.Ask(test.Request("GET /api/memory")), HasSubstr("\"kind\":\"memory\""));
  const std::string answer = test.Ask(test.Request("GET /api/other"));
  EXPECT_EQ(StatusOf(answer), "500");
  EXPECT_THAT(answer, HasSubstr("\"kind\":\"internal\",\"message\":\"broken \uFFFD\""));
}

TEST(StudioServer, FieldsOfAnswersStayOnTheirLine) {
  const TestServer test([](const HttpRequest&) {
    return HttpResponse{200, "text/plain", "", {{"X-Name", "a\r\nSet-Cookie: b=c"}, {"ETag", "\"1\""}}};
  });
  const std::string answer = test.Ask(test.Request("GET /api/name"));
  EXPECT_THAT(answer, HasSubstr("X-Name: a__Set-Cookie: b=c\r\n"));
  EXPECT_THAT(answer, HasSubstr("Cache-Control: no-cache\r\n"));
}

TEST(StudioServer, ServesThePage) {
  const TestServer test;
  const std::string page = test.Ask(test.Request("GET /"));
  EXPECT_EQ(StatusOf(page), "200");
  EXPECT_THAT(page, HasSubstr("Content-Type: text/html; charset=utf-8"));
  EXPECT_THAT(page, HasSubstr("Cache-Control: no-cache"));
  EXPECT_THAT(page, HasSubstr("<!doctype html>"));
  const std::size_t at = page.find("ETag: ");
  ASSERT_NE(at, page.npos);
  const std::string tag = page.substr(at + 6, page.find("\r\n", at) - at - 6);
  const std::string same = test.Ask(test.Request("GET /", "If-None-Match: " + tag + "\r\n"));
  EXPECT_EQ(StatusOf(same), "304");
  EXPECT_THAT(same, EndsWith("\r\n\r\n"));
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /web/index.html"))), "200");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /web/"))), "404");
  EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /favicon.ico"))), "404");
}

TEST(StudioServer, ServesAFolderWhileThePageIsWorkedOn) {
  const fs::path folder = fs::path(testing::TempDir()) / "studio_web";
  fs::remove_all(folder);
  fs::create_directories(folder / "parts");
  ServerOptions options = TestServer::Options();
  options.web = folder;
  EventHub hub;
  EXPECT_THAT(HttpServer::Start(options, TestServer::Echo, hub).error().message, HasSubstr("has no index.html"));
  std::ofstream(folder / "index.html") << "one";
  std::ofstream(folder / "parts" / "a.js") << "a";
  std::ofstream(folder / "secret.txt") << "s";
  fs::create_symlink("/etc/passwd", folder / "link.js");
  {
    const TestServer test(TestServer::Echo, options);
    EXPECT_THAT(test.Ask(test.Request("GET /")), EndsWith("\r\n\r\none"));
    std::ofstream(folder / "index.html") << "two";
    EXPECT_THAT(test.Ask(test.Request("GET /")), EndsWith("\r\n\r\ntwo"));
    EXPECT_THAT(test.Ask(test.Request("GET /web/parts/a.js")), HasSubstr("text/javascript"));
    fs::remove(folder / "parts" / "a.js");
    fs::create_symlink("/etc/passwd", folder / "parts" / "a.js");
    for (const char* name : {"secret.txt", "link.js", "parts/a.js", "parts", "late.js"}) {
      EXPECT_EQ(StatusOf(test.Ask(test.Request("GET /web/" + std::string(name)))), "404") << name;
    }
  }
  fs::remove_all(folder);
}

TEST(StudioServer, APortThatIsTakenIsNamed) {
  const TestServer test;
  ServerOptions options = TestServer::Options();
  options.port = test.server->port();
  EventHub hub;
  const auto second = HttpServer::Start(options, TestServer::Echo, hub);
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().kind, ErrorKind::kUsage);
  EXPECT_EQ(second.error().message, "port " + std::to_string(options.port) +
                                        " of 127.0.0.1 is in use by another program: name another with --port, or "
                                        "leave it out for a free one");
}

TEST(StudioServer, APortIsFreeAgainAtOnce) {
  ServerOptions options = TestServer::Options();
  {
    const TestServer test;
    options.port = test.server->port();
    RawClient client(options.port);
    client.Send(test.Request("GET /api/state", "Connection: close\r\n"));
    client.ReadTo("");
  }
  const TestServer again(TestServer::Echo, options);
  EXPECT_EQ(StatusOf(again.Ask(again.Request("GET /api/state"))), "200");
}

TEST(StudioServer, OnlyTheLoopbackIsBound) {
  const TestServer test;
  std::ifstream table("/proc/net/tcp");
  char wanted[16];
  std::snprintf(wanted, sizeof(wanted), "%08X:%04X", htonl(INADDR_LOOPBACK), test.server->port());
  int bound = 0, elsewhere = 0;
  const std::string port = std::string(wanted).substr(8) + " ";
  for (std::string line; std::getline(table, line);) {
    if (line.find(port) == line.npos || line.find(" 0A ") == line.npos) continue;
    ++(line.find(wanted) != line.npos ? bound : elsewhere);
  }
  EXPECT_EQ(bound, 1);
  EXPECT_EQ(elsewhere, 0);
}

}  // namespace
}  // namespace scumble
