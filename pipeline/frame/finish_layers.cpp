#include "pipeline/finish_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/io/atomic_file.h"
#include "core/io/existing_output.h"
#include "core/io/open_raster.h"
#include "core/io/picture_file.h"
#include "core/style/nearest_name.h"

namespace scumble {
namespace {

// As ApplyFinish of both stages.
Status FinishAll(std::span<const FinishStep> steps, const FinishFrame& frame, const FinishLayerOptions& names,
                 int threads, const Progress& progress, Picture& picture) {
  SCUMBLE_RETURN_IF_ERROR(ApplyFinish(steps, FinishPass::Stage::kPaint, frame, threads, progress, picture));
  if (names.put_ground) SCUMBLE_RETURN_IF_ERROR(names.put_ground(picture));
  return ApplyFinish(steps, FinishPass::Stage::kSheet, frame, threads, {}, picture);
}

// Layers of one name as one picture.
Picture OneOf(std::vector<FinishLayer> layers, int width, int height) {
  Picture alone(width, height);
  for (FinishLayer& layer : layers) {
    if (!layer.is_ink) {
      alone = std::move(layer.picture);
    } else {
      PutOver(alone, layer.picture);
    }
  }
  return alone;
}

}  // namespace

Status CheckLayersWanted(const LayersWanted& wanted, const std::vector<FinishPass>& passes) {
  if (wanted.all && passes.empty()) {
    return UsageError(
        "--layers-out: the picture has no finishing effects whose layers it could hold: give --finish, or [[finish]] "
        "in the style");
  }
  if (wanted.alone.empty()) return Ok();
  std::vector<std::string> names;
  for (const FinishPass& pass : passes) {
    if (pass.name == wanted.alone) return Ok();
    if (std::find(names.begin(), names.end(), pass.name) == names.end()) names.push_back(pass.name);
  }
  const std::string option = fmt::format("--show {}{}: ", kShowFinish, wanted.alone);
  if (names.empty()) return UsageError(option + "there is no finish: give --finish, or [[finish]] in the style");
  const std::string meant = NearestName(wanted.alone, names);
  return UsageError(fmt::format("{}no finish has that name; there are {}{}", option, fmt::join(names, ", "),
                                meant.empty() ? "" : "; did you mean " + meant + "?"));
}

Expected<FinishedLayers> FinishWithLayers(std::span<const FinishStep> steps, const FinishFrame& frame,
                                          const LayersWanted& wanted, const FinishLayerOptions& names, int threads,
                                          const Progress& progress, Picture& picture) {
  FinishedLayers made;
  FinishLayerOptions options = names;
  if (!wanted.alone.empty()) {
    options.only = wanted.alone, options.bits = 16;
    Picture copy = picture;
    SCUMBLE_ASSIGN(std::vector<FinishLayer> layers, FinishInLayers(steps, frame, options, threads, {}, copy));
    made.alone = OneOf(std::move(layers), picture.width, picture.height);
  }
  if (!wanted.all) {
    SCUMBLE_RETURN_IF_ERROR(FinishAll(steps, frame, names, threads, progress, picture));
    return made;
  }
  options.only.clear(), options.bits = 8;
  SCUMBLE_ASSIGN(made.layers, FinishInLayers(steps, frame, options, threads, progress, picture));
  return made;
}

Status WriteLayers(const std::string& path, std::vector<FinishLayer> layers, const Picture& merged,
                   const std::string& settings) {
  std::vector<RasterLayer> raster;
  for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
    RasterLayer one;
    SCUMBLE_ASSIGN(one.png, EncodePng(std::exchange(layer->picture, {})));
    one.name = layer->name, one.visible = layer->visible, one.atop = layer->atop;
    raster.push_back(std::move(one));
  }
  SCUMBLE_ASSIGN(const auto bytes, EncodeOpenRaster(raster, merged, 0, path, settings));
  return WriteFileAtomically(path, std::span<const std::byte>(bytes));
}

Status CheckWholeLayers(const std::string& path, int width, int height, const std::string& settings) {
  SCUMBLE_ASSIGN(const std::string stored, ReadLayerSettings(path));
  SCUMBLE_RETURN_IF_ERROR(CheckSameSettings(path, stored, settings));
  SCUMBLE_ASSIGN(const Picture merged, ReadMergedLayers(path));
  if (width == 0 || (merged.width == width && merged.height == height)) return Ok();
  return InputError(fmt::format("{} is {}×{}, expected {}×{}", path, merged.width, merged.height, width, height));
}

}  // namespace scumble
