// The studio's HTTP server: a thread for each connection, on 127.0.0.1 alone. It knows pages, events and what is safe;
// what the calls do is the handler's.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "apps/studio/http/event_hub.h"
#include "apps/studio/http/exchange.h"
#include "core/image/status.h"

namespace scumble {

// How long is waited for a client.
struct ServerTimes {
  std::chrono::milliseconds header{10000};   // from a request's first byte to its header's last
  std::chrono::milliseconds body{30000};     // for all of it
  std::chrono::milliseconds idle{60000};     // for a further request
  std::chrono::milliseconds stall{30000};    // while it takes nothing of an answer
  std::chrono::milliseconds drain{1000};     // after a refusal, for what it still sends
  std::chrono::milliseconds silence{15000};  // between two lines of an event stream
};

struct ServerOptions {
  int port = 0;               // 0: a free one
  std::string token;          // as MakeToken makes it
  std::filesystem::path web;  // the page's files are read from here; empty: the program's own
  // Called each time that the address with the token is opened, from any thread: the browser has found the page.
  std::function<void()> on_first_visit;
  ServerTimes times;
};

// Every answer passes the rules of safety.h first: the handler sees only requests of our page, to paths under /api/,
// /api/events excepted, whose events are those of the hub. Of HEAD it sees a GET. An exception that comes out of it is
// answered by 500. At most 64 connections are served at once; a further one gets 503.
class HttpServer {
 public:
  // `events` must outlive the server. kUsage where the port is taken or may not be used; kInput where `web` has no
  // page.
  static Expected<std::unique_ptr<HttpServer>> Start(const ServerOptions& options, HttpHandler handler,
                                                     EventHub& events);
  ~HttpServer();  // stops
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  std::string address() const;  // "http://127.0.0.1:PORT/?token=…"

  // Closes the hub and ends all connections: events that were published before are sent, waiting ends at once, and a
  // handler that runs is waited for. Whoever calls this cancels what handlers do.
  void Stop();

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace scumble
