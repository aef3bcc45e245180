// Server-sent events: what happens on the server, to every page that listens.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace scumble {

struct ServerEvent {
  std::uint64_t id = 0;  // 1, 2, …
  std::string name;      // "state"
  std::string data;      // JSON on one line
};

// Safe from any thread. Keeps the last 64 events for pages that come back (Last-Event-ID).
class EventHub {
 public:
  void Publish(const std::string& name, const std::string& data);
  // The event after `last`, waiting for it for so long at most; empty: none came, or the hub is closed.
  std::optional<ServerEvent> After(std::uint64_t last, std::chrono::milliseconds wait);
  std::uint64_t last_id() const;
  void Close();  // ends all waiting
  bool closed() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ServerEvent> events_;
  std::uint64_t last_ = 0;
  bool closed_ = false;
};

}  // namespace scumble
