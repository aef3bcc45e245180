// The styles, one file each: every mark is a libmypaint stroke planned on the sphere.
#pragma once

#include "exemplars/paint/studio.h"
#include "image/picture.h"
#include "image/status.h"

namespace scumble::paint {

// Same studio, same picture. The sphere fills the square; what lies outside it is continued paint or paper.
using Painter = Expected<Picture>(const Studio& studio);

Painter PaintCharcoal;
Painter PaintChiaroscuro;
Painter PaintGraphite;
Painter PaintInk;
Painter PaintOil;
Painter PaintPleinAir;
Painter PaintSanguine;
Painter PaintWatercolour;

// What goes behind a picture in the style: the bare paper, or for oil a quiet ground, as a tile (see TileFor).
Painter CharcoalPaper;
Painter ChiaroscuroPaper;
Painter GraphitePaper;
Painter InkPaper;
Painter OilGround;
Painter PleinAirGround;
Painter SanguinePaper;
Painter WatercolourPaper;

struct StyleEntry {
  const char* name;
  Painter* paint;
  Painter* paper;
  int lights = 1;  // how many of kLights it is painted for, from the first
};
inline constexpr StyleEntry kStyles[] = {
    {"charcoal", PaintCharcoal, CharcoalPaper},
    {"chiaroscuro", PaintChiaroscuro, ChiaroscuroPaper, 3},
    {"graphite", PaintGraphite, GraphitePaper},
    {"ink", PaintInk, InkPaper, 3},
    {"oil", PaintOil, OilGround},
    {"plein-air", PaintPleinAir, PleinAirGround, 3},
    {"sanguine", PaintSanguine, SanguinePaper},
    {"watercolour", PaintWatercolour, WatercolourPaper},
};

// Each light's painting is a file of its own.
struct LightEntry {
  const char* file;
  Light light;
};
inline constexpr LightEntry kLights[] = {
    {"lit.png", Light::kKey},
    {"half.png", Light::kGrazing},
    {"shade.png", Light::kSky},
    {"deep.png", Light::kCrevice},
};

}  // namespace scumble::paint
