// The styles, one file each: every mark is a libmypaint stroke planned on the sphere.
#pragma once

#include <cstdint>
#include <filesystem>

#include "image/picture.h"
#include "image/status.h"

namespace scumble::paint {

struct Studio {
  std::filesystem::path brushes;  // the folder that holds tanda/, deevad/, classic/
  int size = 1024;
  std::uint64_t seed = 1;
};

// Same studio, same picture. The sphere fills the square; what lies outside it is continued paint or paper.
Expected<Picture> PaintCharcoal(const Studio& studio);
Expected<Picture> PaintGraphite(const Studio& studio);
Expected<Picture> PaintOil(const Studio& studio);
Expected<Picture> PaintWatercolour(const Studio& studio);

// What goes behind a picture in the style: the bare paper, or for oil a quiet ground, as a tile (see TileFor).
Expected<Picture> CharcoalPaper(const Studio& studio);
Expected<Picture> GraphitePaper(const Studio& studio);
Expected<Picture> OilGround(const Studio& studio);
Expected<Picture> WatercolourPaper(const Studio& studio);

struct StyleEntry {
  const char* name;
  Expected<Picture> (*paint)(const Studio& studio);
  Expected<Picture> (*paper)(const Studio& studio);
};
inline constexpr StyleEntry kStyles[] = {
    {"charcoal", PaintCharcoal, CharcoalPaper},
    {"graphite", PaintGraphite, GraphitePaper},
    {"oil", PaintOil, OilGround},
    {"watercolour", PaintWatercolour, WatercolourPaper},
};

}  // namespace scumble::paint
