// The answer to GET /api/events: events as text/event-stream, until the page leaves or the hub is closed.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "apps/studio/http/client_socket.h"
#include "apps/studio/http/event_hub.h"

namespace scumble {

// Where a stream goes on: behind the event that Last-Event-ID names, or with what happens from now on.
std::uint64_t FirstEventOf(const std::string& last_event_id, const EventHub& hub);

// One event in the form of the stream.
std::string EventText(const ServerEvent& event);

// Sends every event behind `last`, and a comment after each `silence` without one, so that a page that has gone is
// noticed. `stall` is ClientSocket::Send's.
void StreamEvents(ClientSocket& socket, EventHub& hub, std::uint64_t last, std::chrono::milliseconds silence,
                  std::chrono::milliseconds stall);

}  // namespace scumble
