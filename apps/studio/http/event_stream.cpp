#include "apps/studio/http/event_stream.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

namespace scumble {

std::uint64_t FirstEventOf(const std::string& last_event_id, const EventHub& hub) {
  const std::uint64_t newest = hub.last_id();
  std::uint64_t last = 0;
  const char* const end = last_event_id.data() + last_event_id.size();
  const auto [read, failure] = std::from_chars(last_event_id.data(), end, last);
  // A number beyond ours is that of an earlier run.
  return failure == std::errc() && read == end && last <= newest ? last : newest;
}

std::string EventText(const ServerEvent& event) {
  return "id: " + std::to_string(event.id) + "\nevent: " + event.name + "\ndata: " + event.data + "\n\n";
}

void StreamEvents(ClientSocket& socket, EventHub& hub, std::uint64_t last, std::chrono::milliseconds silence,
                  std::chrono::milliseconds stall) {
  constexpr std::chrono::milliseconds kLook(250);  // how often a page that has gone is looked for
  if (!socket.Send({"retry: 1000\n\n"}, stall)) return;
  auto sent = ClientSocket::Clock::now();
  for (;;) {
    const std::optional<ServerEvent> event = hub.After(last, std::min(kLook, silence));
    const auto now = ClientSocket::Clock::now();
    if (event) {
      last = event->id;
      if (!socket.Send({EventText(*event)}, stall)) return;
    } else if (hub.closed() || socket.HasGone()) {
      return;
    } else if (now - sent >= silence) {
      if (!socket.Send({": \n\n"}, stall)) return;
    } else {
      continue;
    }
    sent = now;
  }
}

}  // namespace scumble
