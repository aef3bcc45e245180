// Pictures that a painter may lay over or under the painting to see how the sphere is turned and lit: lines and flat
// steps of light. Each has the whole template's size and is transparent where it shows nothing. Lines are drawn from
// the sphere's formula, so that they are equally sharp at any size.
#pragma once

#include "core/style/sphere_template.h"
#include "scumble/picture.h"

namespace scumble {

// The circle in which the sphere ends: paint must reach past it.
Picture DrawEdgeLine(int size);

// The light on the sphere. The terminator, between light and shade, is thick and blue. Lines of equal light, at a
// quarter, half and three quarters of the full, are thin and orange. A red ring marks the highlight, where a polished
// sphere would mirror the light. Nothing behind the sphere is drawn.
Picture DrawLightLines(int size, double azimuth, double elevation);

// Latitudes and longitudes, every 15 degrees, of a globe whose pole leans 25 degrees towards the viewer: lines to lay
// strokes along, or across.
Picture DrawContourLines(int size);

// The lit sphere in five flat steps, from deep shade to highlight, of equal width in lightness.
Picture DrawFiveTones(const KitLight& light);

// The normals as colours: red to the right, green up, blue towards the viewer, -1 to 1 as 0 to full.
Picture DrawNormalColors(const KitLight& light);

}  // namespace scumble
