#include "pipeline/run/kept_warnings.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace scumble {

Expected<RunReport> KeepWarnings(const RunContext& context,
                                 const std::function<Expected<RunReport>(const RunContext& context)>& run) {
  std::vector<std::string> texts;
  RunContext kept = context;
  kept.on_message = [&](const Message& message) {
    const bool is_new = std::find(texts.begin(), texts.end(), message.text) == texts.end();
    if (message.kind == Message::Kind::kWarning && is_new) texts.push_back(message.text);
    if (context.on_message) context.on_message(message);
  };
  Expected<RunReport> report = run(kept);
  if (report) report->warnings = std::move(texts);
  return report;
}

}  // namespace scumble
