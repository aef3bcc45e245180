// The memory that a variant takes, measured in a process of its own: in one that has made other pictures before, memory
// is already there.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/tradeoff.h"

namespace scumble {

// Options that say when, whence, how and in how bright a light the scene is seen, with their values; only those that
// are not the usual ones.
std::vector<std::pair<std::string, std::string>> SceneArguments(const TradeSetup& setup);

// Options of finishing effects, with their values.
std::vector<std::pair<std::string, std::string>> FinishArguments(const TradeSetup& setup);

// The command's arguments that set this up, behind the program's name. No option of output is among them.
std::vector<std::string> TradeArguments(const TradeSetup& setup, const RunContext& context);

// Runs RunContext::program, which must be set, for one variant. 0 where that fails: memory is not worth an error.
// kCancelled where the context is cancelled.
Expected<std::size_t> AskForPeak(const TradeSetup& setup, const std::string& variant, const RunContext& context);

}  // namespace scumble
