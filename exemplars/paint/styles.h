// The styles, one file each: every mark is a libmypaint stroke planned on the sphere.
#pragma once

#include "core/image/status.h"
#include "exemplars/paint/studio.h"
#include "scumble/picture.h"

namespace scumble::paint {

// Equal studios give equal pictures. The sphere fills the square; outside it paint or paper continues.
using Painter = Expected<Picture>(const Studio& studio);

Painter PaintCharcoal;
Painter PaintChiaroscuro;
Painter PaintColouredPencil;
Painter PaintGouache;
Painter PaintGraphite;
Painter PaintInk;
Painter PaintOil;
Painter PaintPastel;
Painter PaintPleinAir;
Painter PaintPointillism;
Painter PaintSanguine;
Painter PaintSceneInk;
Painter PaintSceneOil;
Painter PaintScenePastel;
Painter PaintSumiE;
Painter PaintTintedOil;
Painter PaintTintedPencil;
Painter PaintTintedWash;
Painter PaintWatercolour;
Painter PaintWoodcut;

// The background of a picture in the style: the bare paper, or for oil a quiet ground, as a tile (see TileFor).
Painter CharcoalPaper;
Painter ChiaroscuroPaper;
Painter ColouredPencilPaper;
Painter GouacheGround;
Painter GraphitePaper;
Painter InkPaper;
Painter OilGround;
Painter PastelPaper;
Painter PleinAirGround;
Painter PointillismGround;
Painter SanguinePaper;
Painter SceneInkPaper;
Painter SceneOilGround;
Painter ScenePastelPaper;
Painter SumiEPaper;
Painter TintedOilGround;
Painter TintedPencilPaper;
Painter TintedWashPaper;
Painter WatercolourPaper;
Painter WoodcutPaper;

struct StyleEntry {
  const char* name;
  Painter* paint;
  Painter* paper;
  int lights = 1;      // number of kLights that it is painted for, from the first
  bool scene = false;  // paints the sphere on its floor (scene.h), not the sphere that fills the picture
};
inline constexpr StyleEntry kStyles[] = {
    {"charcoal", PaintCharcoal, CharcoalPaper},
    {"chiaroscuro", PaintChiaroscuro, ChiaroscuroPaper, 3},
    {"coloured-pencil", PaintColouredPencil, ColouredPencilPaper},
    {"gouache", PaintGouache, GouacheGround, 4},
    {"graphite", PaintGraphite, GraphitePaper},
    {"ink", PaintInk, InkPaper, 3},
    {"oil", PaintOil, OilGround},
    {"pastel", PaintPastel, PastelPaper, 3},
    {"plein-air", PaintPleinAir, PleinAirGround, 3},
    {"pointillism", PaintPointillism, PointillismGround},
    {"sanguine", PaintSanguine, SanguinePaper},
    {"scene-ink", PaintSceneInk, SceneInkPaper, 1, true},
    {"scene-oil", PaintSceneOil, SceneOilGround, 1, true},
    {"scene-pastel", PaintScenePastel, ScenePastelPaper, 1, true},
    {"sumi-e", PaintSumiE, SumiEPaper},
    {"tinted-oil", PaintTintedOil, TintedOilGround},
    {"tinted-pencil", PaintTintedPencil, TintedPencilPaper},
    {"tinted-wash", PaintTintedWash, TintedWashPaper},
    {"watercolour", PaintWatercolour, WatercolourPaper},
    {"woodcut", PaintWoodcut, WoodcutPaper},
};

// Each light's exemplar is a separate file.
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
