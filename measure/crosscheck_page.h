// The cross-check as one self-contained HTML page.
#pragma once

#include <string>
#include <vector>

#include "core/image/status.h"
#include "measure/crosscheck.h"

namespace scumble {

// The run's data for the page.
struct CrosscheckRun {
  std::string reference;      // "Cycles, Blender 3.4.1"
  std::string command;        // how to repeat it
  std::string baseline = {};  // the file that tightened limits; empty: none
};

// A table of all scenes at the top. For each scene: failures, deliberate differences from the authored scene, figures
// and limits, noise against samples, and for each layer both pictures and their difference. Pictures are embedded as
// PNG; the page loads nothing from elsewhere. The page follows the reader's choice of dark or light.
Expected<std::string> CrosscheckToHtml(const std::vector<CrosscheckReport>& reports, const CrosscheckRun& run);

}  // namespace scumble
