// The library of Scumble: paint a sphere, stylise a scene. stylizer.h is where to begin.
//
// Conventions. Row 0 of a picture is the top row; pixel (x, y) covers [x, x + 1) × [y, y + 1). Angles are degrees.
// Pictures are 16-bit sRGB with straight alpha. Guides are float: view space is right-handed, +X right, +Y up, +Z
// towards the viewer; world space is glTF's, in metres. Errors are values (status.h); nothing prints, exits or reads
// the environment. One thread at a time may call an object, except that any may call Cancel; different objects are
// independent. Same input and seed: same bytes, whatever the number of threads.
#pragma once

#include "scumble/guides.h"
#include "scumble/layers.h"
#include "scumble/picture.h"
#include "scumble/progress.h"
#include "scumble/scene.h"
#include "scumble/status.h"
#include "scumble/style.h"
#include "scumble/stylizer.h"
