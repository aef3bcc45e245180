#include "apps/studio/studio.h"

#include <malloc.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include "apps/studio/http/server.h"
#include "apps/studio/http/token.h"
#include "apps/studio/open_browser.h"
#include "apps/studio/session/session.h"

namespace scumble {

Status RunStudio(const StudioOptions& options, const RunContext& context) {
  EventHub events;
  SCUMBLE_ASSIGN(const std::unique_ptr<Session> session, Session::Open(options, context, events));
  std::unique_ptr<OpenedBrowser> browser;
  std::atomic<bool> was_visited = false;
  ServerOptions server_options;
  server_options.port = options.port, server_options.token = MakeToken(), server_options.web = options.web;
  server_options.on_first_visit = [&] { was_visited = true; };
  std::atomic<unsigned> calls = 0, running = 0;
  const auto handle = [&](const HttpRequest& request) {
    ++calls;
    ++running;
    HttpResponse answer = session->Handle(request);
    --running;
    return answer;
  };
  SCUMBLE_ASSIGN(const std::unique_ptr<HttpServer> server, HttpServer::Start(server_options, handle, events));
  if (options.on_ready) options.on_ready(server->address());
  if (options.open_browser) browser = OpenedBrowser::Start(server->address(), context);
  constexpr int kLooksOfRest = 20;  // a second
  unsigned seen = 0;
  for (int looks = 0; !options.is_stopped(); ++looks) {
    if (browser && was_visited) browser.reset();  // it has found the page
    if (const unsigned now = calls; now != seen || running > 0) seen = now, looks = 0;
    // At rest, memory that pictures no longer use is given back to the system.
    if (looks == kLooksOfRest) ::malloc_trim(0);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  events.Publish("bye", "{}");
  session->Stop();
  server->Stop();
  return Ok();
}

}  // namespace scumble
