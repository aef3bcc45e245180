// The styles, one file each: every mark is a libmypaint stroke planned on the sphere.
#pragma once

#include <cstdint>
#include <filesystem>

#include "exemplars/paint/sphere.h"
#include "image/picture.h"
#include "image/status.h"

namespace scumble::paint {

struct Studio {
  std::filesystem::path brushes;  // the folder that holds tanda/, deevad/, classic/
  int size = 1024;
  std::uint64_t seed = 1;
  Light light = Light::kKey;  // heeded by the styles that are painted for several
};

// Same studio, same picture. The sphere fills the square; what lies outside it is continued paint or paper.
Expected<Picture> PaintCharcoal(const Studio& studio);
Expected<Picture> PaintChiaroscuro(const Studio& studio);
Expected<Picture> PaintGraphite(const Studio& studio);
Expected<Picture> PaintOil(const Studio& studio);
Expected<Picture> PaintPleinAir(const Studio& studio);
Expected<Picture> PaintWatercolour(const Studio& studio);

// What goes behind a picture in the style: the bare paper, or for oil a quiet ground, as a tile (see TileFor).
Expected<Picture> CharcoalPaper(const Studio& studio);
Expected<Picture> ChiaroscuroPaper(const Studio& studio);
Expected<Picture> GraphitePaper(const Studio& studio);
Expected<Picture> OilGround(const Studio& studio);
Expected<Picture> PleinAirGround(const Studio& studio);
Expected<Picture> WatercolourPaper(const Studio& studio);

struct StyleEntry {
  const char* name;
  Expected<Picture> (*paint)(const Studio& studio);
  Expected<Picture> (*paper)(const Studio& studio);
  bool three_lights = false;  // half.png and shade.png beside lit.png
};
inline constexpr StyleEntry kStyles[] = {
    {"charcoal", PaintCharcoal, CharcoalPaper},         {"chiaroscuro", PaintChiaroscuro, ChiaroscuroPaper, true},
    {"graphite", PaintGraphite, GraphitePaper},         {"oil", PaintOil, OilGround},
    {"plein-air", PaintPleinAir, PleinAirGround, true}, {"watercolour", PaintWatercolour, WatercolourPaper},
};

}  // namespace scumble::paint
