#include "apps/studio/http/event_hub.h"

namespace scumble {
namespace {

constexpr std::size_t kKeptEvents = 64;

}  // namespace

void EventHub::Publish(const std::string& name, const std::string& data) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    events_.push_back({++last_, name, data});
    if (events_.size() > kKeptEvents) events_.pop_front();
  }
  changed_.notify_all();
}

std::optional<ServerEvent> EventHub::After(std::uint64_t last, std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, wait, [&] { return closed_ || last_ > last; });
  for (const ServerEvent& event : events_) {
    if (event.id > last) return event;
  }
  return std::nullopt;
}

std::uint64_t EventHub::last_id() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

void EventHub::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool EventHub::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

}  // namespace scumble
