// `scumble studio`: a page on this machine that shows a scene in the paint of a style, and paints it anew whenever a
// file is saved or a control moves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"

namespace scumble {

struct StudioOptions {
  SceneRequest scene;               // without a file: the bundled scenes to choose from
  std::vector<std::string> styles;  // the first is shown; empty: the bundled ones to choose from
  std::uint64_t seed = 0;
  int port = 0;  // 0: a free one
  bool open_browser = true;
  std::filesystem::path save_to;  // new styles are saved here; empty: the current folder
  std::filesystem::path web;      // page's files are read from here instead of the program; empty: the program's own
  std::function<void(const std::string& address)> on_ready;  // called once the page can be opened
  std::function<bool()> is_stopped;                          // asked several times a second; true ends the studio
};

// Serves until it is stopped. Errors: kUsage for a port that is taken, kInput for a scene or a style that is not there.
Status RunStudio(const StudioOptions& options, const RunContext& context);

}  // namespace scumble
