// What the passes of a finish do, one by one: a file of layers for painting programs, and the picture of one pass.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/progress.h"
#include "core/image/status.h"
#include "finish/finish.h"
#include "scumble/picture.h"

namespace scumble {

// What --show takes before a pass's name.
inline constexpr const char* kShowFinish = "finish:";

struct LayersWanted {
  std::string alone;  // the name of a pass, whose picture is wanted; empty: none is
  bool all = false;   // all layers are wanted
};

// Ok, or a kUsage error: there is no pass of that name, or no pass at all. The message names those that there are.
Status CheckLayersWanted(const LayersWanted& wanted, const std::vector<FinishPass>& passes);

struct FinishedLayers {
  std::optional<Picture> alone;     // passes of one name lie over one another, but for those that paint anew
  std::vector<FinishLayer> layers;  // from the lowest
};

// Applies the steps of all stages, and makes the layers that are wanted. `names`: of FinishLayerOptions the names and
// put_ground.
Expected<FinishedLayers> FinishWithLayers(std::span<const FinishStep> steps, const FinishFrame& frame,
                                          const LayersWanted& wanted, const FinishLayerOptions& names, int threads,
                                          const Progress& progress, Picture& picture);

// An OpenRaster file of the layers. Takes them. `settings`: those of the picture, for CheckWholeLayers.
Status WriteLayers(const std::string& path, std::vector<FinishLayer> layers, const Picture& merged,
                   const std::string& settings);

// Ok where a whole file of layers of that size and these settings is there; 0: of any size.
Status CheckWholeLayers(const std::string& path, int width, int height, const std::string& settings);

}  // namespace scumble
