// What a run warned of, for its report.
#pragma once

#include <functional>

#include "pipeline/run_requests.h"

namespace scumble {

// The report of `run`, with the text of each warning that went through the context it got, each once, in their order.
Expected<RunReport> KeepWarnings(const RunContext& context,
                                 const std::function<Expected<RunReport>(const RunContext& context)>& run);

}  // namespace scumble
