// What a painter may lay over or under the painting to see how the sphere is turned and lit: lines and flat tones, each
// a picture of the whole template's size, transparent where it shows nothing. Lines are drawn from the sphere's
// formula, so that they are as sharp at any size.
#pragma once

#include "core/style/kit/sphere_template.h"
#include "scumble/picture.h"

namespace scumble {

// The circle in which the sphere ends: paint must reach past it.
Picture DrawEdgeLine(int size);

// Where the light falls: the terminator, where light turns into shade, thick and blue; lines of equal light, at a
// quarter, half and three quarters of the full, thin and orange; a ring around the highlight, red, where a polished
// ball would mirror the lamp. What is behind the sphere is not drawn.
Picture DrawLightLines(int size, double azimuth, double elevation);

// Latitudes and longitudes, every 15 degrees, of a globe whose pole leans 25 degrees towards the viewer: lines to lay
// strokes along, or across.
Picture DrawContourLines(int size);

// The lit sphere in five flat tones, from deep shade to highlight, each as wide a range of what the eye sees.
Picture DrawFiveTones(const KitLight& light);

// The normals as colours: red to the right, green up, blue towards the viewer, -1 to 1 as 0 to full.
Picture DrawNormalColors(const KitLight& light);

}  // namespace scumble
