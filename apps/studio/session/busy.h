// The event `busy`: what takes long, and how far it is.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "apps/studio/http/event_hub.h"
#include "pipeline/run_context.h"

namespace scumble {

// For RunContext::on_progress. Works that take longer than `patience` are told five times a second at most; null is
// told when the last copy of one's Progress is gone. `events` must outlive it.
std::function<Progress(const std::string&)> BusyReports(
    EventHub& events, std::chrono::milliseconds patience = std::chrono::milliseconds(500));

}  // namespace scumble
