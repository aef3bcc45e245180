// One connection: reads its requests, asks for their answers, and sends them.
#pragma once

#include <functional>

#include "apps/studio/http/client_socket.h"
#include "apps/studio/http/event_hub.h"
#include "apps/studio/http/exchange.h"
#include "apps/studio/http/safety.h"
#include "apps/studio/http/server.h"
#include "apps/studio/http/web_files.h"

namespace scumble {

// What all connections of a server share.
struct Site {
  SafetyRules rules;
  WebFiles files;
  HttpHandler handler;
  EventHub* events = nullptr;
  ServerTimes times;
  std::function<void()> on_first_visit;
};

// Returns when the client has gone, has taken too long, or the server stops.
void ServeConnection(ClientSocket& socket, const Site& site);

}  // namespace scumble
