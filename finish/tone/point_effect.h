// Effects that treat every pixel by itself, in Oklab.
#pragma once

#include <cstddef>
#include <functional>

#include "core/filter/oklab_rows.h"
#include "finish/finish.h"

namespace scumble::internal {

// Changes `count` colours in place, those of the pixels from `first` on. Called from several threads.
using PointEffect = std::function<void(std::size_t first, std::size_t count, OklabBlock& block)>;

// Each keeps references to the frame and its guides, which must hold the pass's layers.
PointEffect MakeToon(const ToonPass& pass, const FinishFrame& frame);
PointEffect MakeRender(const RenderPass& pass, const FinishFrame& frame);
PointEffect MakeTones(const TonesPass& pass);
PointEffect MakeShadows(const ShadowsPass& pass, const FinishFrame& frame);
PointEffect MakeDepth(const DepthPass& pass, const FinishFrame& frame);
PointEffect MakeGrade(const GradePass& pass);
PointEffect MakeFill(const FillPass& pass);

// A colour as (L, a, b).
struct LabColor {
  float lightness, a, b;
};
LabColor ToOklab(const Rgb16& color);

}  // namespace scumble::internal
