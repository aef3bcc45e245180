// The artist's kit: a lit sphere to paint over, and what turns the painting into a style.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "image/guides.h"
#include "image/picture.h"
#include "image/status.h"

namespace scumble {

// One lighting condition: the sphere's guides with the luminance layer of that light.
struct KitLight {
  double azimuth = 0;    // degrees, from +Z towards +X
  double elevation = 0;  // degrees
  GuideSet guides;       // N × N, the sphere fills it; needs luminance
  std::string name = {};  // of its painting, "shade" for shade.png; empty: lit, and lit-2, lit-3 … for further ones
};

// Pixels of margin around the sphere's square in the template of an N × N kit.
int TemplateMargin(int size);

// The margin that is recorded in the attributes of a sphere's guides; nothing if they are not from WriteSphereKit.
std::optional<int> SphereMargin(const GuideSet& guides);

// The picture to paint over: white paper, the lit sphere filling the inner square, and registration marks in the
// corners of the margin, outside that square.
Picture DrawTemplate(const KitLight& light);

// Whether a picture still shows the template's four crosses on light paper, margin included. Templates of spheres smaller
// than 63 pixels are not recognised.
bool LooksLikeTemplate(const Picture& picture);

// Writes into `folder`, for lights without names, template.png and guides.exr, for further ones template-2.png and guides-2.exr
// and so on; for lights with names shade-template.png and shade-guides.exr; a style.toml that lists them all, and HOWTO.txt.
// A style.toml that is there already may be the artist's: lights with names that it does not list are added at its end,
// otherwise it is kept. Paintings (lit.png, shade.png) are never written. A template that is not as it was drawn may be one,
// and guides of another size belong to one: either is an error, as is a fifth light in style.toml, and nothing is
// written. Returns the files written.
Expected<std::vector<std::filesystem::path>> WriteSphereKit(const std::filesystem::path& folder,
                                                            std::vector<KitLight> lights);

}  // namespace scumble
