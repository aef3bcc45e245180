#include "apps/studio/session/busy.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

namespace scumble {
namespace {

using Clock = std::chrono::steady_clock;

class BusyReport {
 public:
  BusyReport(EventHub& events, std::string label, Clock::time_point next)
      : events_(events), label_(std::move(label)), next_(next) {}
  ~BusyReport() {
    if (is_told_) events_.Publish("busy", "null");
  }
  BusyReport(const BusyReport&) = delete;
  BusyReport& operator=(const BusyReport&) = delete;

  void Tell(double share) {
    if (Clock::now() < next_) return;
    next_ = Clock::now() + std::chrono::milliseconds(200), is_told_ = true;
    events_.Publish("busy", nlohmann::json{{"label", label_}, {"share", share}}.dump());
  }

 private:
  EventHub& events_;
  const std::string label_;
  Clock::time_point next_;
  bool is_told_ = false;
};

}  // namespace

std::function<Progress(const std::string&)> BusyReports(EventHub& events, std::chrono::milliseconds patience) {
  return [&events, patience](const std::string& label) -> Progress {
    return [report = std::make_shared<BusyReport>(events, label, Clock::now() + patience)](double share) {
      report->Tell(share);
      return true;
    };
  };
}

}  // namespace scumble
