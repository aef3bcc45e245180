// The files of finishing effects: examples of palettes, strokes of hatching, ramps of toon, masks.
#pragma once

#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/status.h"
#include "core/image/style.h"
#include "pipeline/run_context.h"

namespace scumble {

// Reads what passes name: measures the colours that palettes go by, of files, of colours, and of the style's painting,
// the part of it on the sphere; makes the strokes of hatching and the ramps of toon. `style`: null where nothing is
// painted; palettes that ask for a painting then get none, and CheckFinish refuses them. kInput where a file cannot be
// read or a colour is none.
Status ReadFinishFiles(const Style* style, const RunContext& context, std::vector<FinishPass>& passes);

// The files that the passes name: of palettes, strokes and ramps, and of masks.
std::vector<std::string> FilesOf(const std::vector<FinishPass>& passes);
std::vector<std::string> MaskFilesOf(const std::vector<FinishPass>& passes);

}  // namespace scumble
