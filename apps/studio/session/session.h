// The studio without its sockets: the state, the files that are watched, the pictures, and every call of api.md under
// /api/ but the events.
#pragma once

#include <memory>

#include "apps/studio/http/event_hub.h"
#include "apps/studio/http/exchange.h"
#include "apps/studio/studio.h"

namespace scumble {

class Session {
 public:
  // `events` must outlive it. kInput for a scene or a style that is not there.
  static Expected<std::unique_ptr<Session>> Open(const StudioOptions& options, const RunContext& context,
                                                 EventHub& events);
  ~Session();  // stops
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Answers one call. From any thread.
  HttpResponse Handle(const HttpRequest& request);

  // Cancels what is painted; calls after it answer 409.
  void Stop();

 private:
  struct State;
  explicit Session(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace scumble
