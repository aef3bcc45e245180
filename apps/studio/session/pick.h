// What stands at a pixel, from which pixel of which exemplar it came, and what else came from there.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/workspace.h"
#include "scumble/picture.h"

namespace scumble {

// The object of api.md. The frame was painted with PictureRequest::keep_field. x and y are pixels of the picture;
// outside of it, and where nothing is painted, `covered` is false.
nlohmann::json PickAt(const PaintedFrame& frame, int x, int y);

// White where pixels belong to the chunk of this pixel, transparent elsewhere; all transparent where there is none. A
// chunk is a set of 4-connected pixels of one style and exemplar that were copied with one offset.
Picture ChunkMask(const PaintedFrame& frame, int x, int y);

// White where the source lies within `radius` pixels of (x, y) in the exemplar's file.
Picture FedMask(const PaintedFrame& frame, int style, int exemplar, double x, double y, double radius);

}  // namespace scumble
