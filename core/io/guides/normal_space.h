// Whether normals and depths of a file are of one view.
#pragma once

#include <string>

#include "core/image/guides.h"
#include "scumble/status.h"

namespace scumble::internal {

// By how many degrees the direction in which depth grows is turned from the one in which normals point, in the picture.
// It is the mean over pixels that are not seen from the front. Under any camera, perspective or orthographic, both are
// one way where normals are in view space and face the eye; 0 to a few degrees as surfaces are smoothed or bumpy. -1
// where too few pixels tell. The guides hold normals and depths.
double NormalsAgainstDepth(const GuideSet& guides);

// The share of pixels whose normal has z below 0, in [0, 1], among those where z must be above 0 under any camera.
// Those are known by their depth, or without depth by z itself, where its size is near 1. 0 where too few pixels tell.
// The guides hold coverage and normals.
double ShareTurnedAway(const GuideSet& guides);

// kInput if nearly all normals point away from the eye, or if they clearly do not fit the depth. Renderers often write
// normals in world space or in a left-handed one, and these would paint another picture unnoticed. What lacks a layer
// that tells is not looked at.
Status CheckNormalSpace(const GuideSet& guides, const std::string& name);

}  // namespace scumble::internal
