// Hatching as threshold textures: which strokes come first, which later.
#pragma once

#include <string>

#include "core/image/status.h"
#include "exemplars/paint/studio.h"
#include "scumble/picture.h"

namespace scumble::paint {

// The tools, and the names of their files.
inline constexpr const char* kHatchTools[] = {"pencil", "pen", "charcoal"};

// A tile of strokes along its rows, laid one after the other, each where it is emptiest. A pixel's grey is the share of
// ink on the whole tile at the moment when the pixel got half of its ink, made even: so many pixels have each grey.
// Where a tone asks for a share of ink, all pixels of lower grey have it (Webb, Praun, Finkelstein, Hoppe, "Fine tone
// control in hardware hatching", 2002), and darker tones keep the strokes of lighter ones. kInput where the brush
// cannot be read.
Expected<Picture> PaintHatching(const Studio& studio, const std::string& tool);

}  // namespace scumble::paint
