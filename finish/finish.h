// Finishing effects over a painted or rendered picture: the manual of this library.
//
//   MeasureFinish(guides)               what a sequence measures once
//   ApplyToGuides(steps, frame, …)      applies the passes that change guides, before the paint is matched
//   ApplyFinish(steps, stage, frame, …) applies the passes of one stage, in order, in place
//   FinishInLayers(steps, frame, …)     applies all stages, and gives what each pass does as a layer of its own
//
// A pass (core/image/finish_pass.h) looks at guides and changes the picture. Neighbouring passes that treat each pixel
// by itself (tone/) run as one loop in Oklab. Filters (area/) look at the pixels around. Lines (outline/) are traced
// along the borders of the guides and stroked.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/fragments.h"
#include "core/image/guides.h"
#include "core/image/progress.h"
#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

// What passes take from the first picture of a sequence that shows a surface, where a key is 0. Of the covered pixels.
struct FinishMeasures {
  double near = 0.0, middle = 0.0, far = 0.0;  // the 2nd, 50th and 98th percentile of depth, metres
  double bright = 1.0;                         // the 90th percentile of luminance; 1 without light
  double full = 1.0;                           // that of the luminance of lpe.full

  bool operator==(const FinishMeasures&) const = default;
};

// Whether any of the passes looks at them.
bool LooksAtMeasures(std::span<const FinishPass> passes);

// The share of pixels with any coverage. Without one there is nothing to measure. An object that slides into view
// begins with a few pixels, so a sequence is measured on the first frame that has kEnoughToMeasure.
double CoveredShare(const GuideSet& guides);
inline constexpr double kEnoughToMeasure = 0.005;

// Of layers that the guides lack, and of nothing covered, the values stay as they are above.
FinishMeasures MeasureFinish(const GuideSet& guides);

// A measure as it is printed, to six digits, so that a run that is given what another has printed gives the same bytes.
double AsPrinted(double value);

// The mean and covariance of a picture's colours in Oklab, weighted by alpha: of all, or of the pixels of `only` that
// are not 0. 0 where there are none. The same on any number of threads.
ColorSpread MeasureColors(const Picture& picture, std::span<const std::uint8_t> only = {});

// A threshold texture from the greys of a square picture that repeats, strokes along its rows; what is transparent is
// laid on white. Of pixels of equal grey each has the mean of their ranks. Smaller levels are means of four, ranked
// anew. kInput where the picture is no square of 16 pixels or more, or has one grey all over.
Expected<HatchTexture> MakeHatchTexture(const Picture& picture);

struct FinishStep {
  FinishPass pass;
  std::vector<std::uint8_t> only;         // by pixel: 0 is left as it is; empty: none is
  int reference_height = -1;              // of the pass's lengths; 0: they are pixels; -1: the frame's scale counts
  std::vector<std::uint16_t> share = {};  // by pixel: a factor of the strength, 65535 for 1; empty: 1 everywhere
  // Of a palette without `from`: the colours that it changes, AsPrinted, which it measures and puts here if there are
  // none yet. Null: it measures each picture. It must outlive the step.
  std::optional<ColorSpread>* colors = nullptr;
};

struct FinishFrame {
  const GuideSet* guides = nullptr;  // the picture's size; null where no pass reads any
  FinishMeasures measures;
  double scale = 1.0;      // pixels of the picture for one of the reference height
  std::uint64_t seed = 0;  // of all that is left to chance
  // Frame and rate, for jitter_fps; see JitterStep.
  std::int64_t frame = 0, fps_numerator = 24, fps_denominator = 1;
  std::uint64_t steady_seed = 0;  // within a step: `seed` as it was, which jitter_fps does not change
  // Where `guides` were upsampled: what they were made of, a whole number of times smaller, with their layers. Strokes
  // are traced on these, which have no blocks.
  const GuideSet* small_guides = nullptr;
  // Of the picture as it is given, by fragment of the guides; null: not known. Effects that treat each pixel by itself
  // then change each surface of a pixel by its own paint, else by the pixel's.
  const FragmentColors* colors = nullptr;
  // Of the picture as it is given, pixels rising. Effects that treat each pixel by itself change a stroke by the guides
  // of its owner, and the rest of its pixel by that pixel's. What is named, masked or of a style is chosen likewise.
  std::span<const EdgeStroke> strokes = {};
  // Pixels of `guides` from one sample to the next.
  int Apart() const { return small_guides ? guides->width() / small_guides->width() : 1; }
};

// kInput where a pass is to show a ramp of colours, and has none.
Status CheckRamp(const FinishPass& pass);

// kInput, in a message that names the pass, in these cases. The guides lack a layer that a step reads. A width is to
// follow the depth of an orthographic view, which has no sizes. Near is not before far. A palette has no example, or a
// ramp no colours.
Status CheckFinish(std::span<const FinishStep> steps, const GuideSet* guides, const FinishMeasures& measures = {});

// Whether any of the steps is of the stage kGuides.
bool ChangesGuides(std::span<const FinishStep> steps);

// Applies the steps of the stage kGuides, in order, each to the layer that it names, as if that were the picture. What
// follows sees the changed guides. Light is a grey in which the brightest tenth is white; what is brighter keeps its
// ratio to that. Fragments keep their values. `frame.guides` is not looked at. As ApplyFinish otherwise.
Status ApplyToGuides(std::span<const FinishStep> steps, const FinishFrame& frame, int threads, const Progress& progress,
                     GuideSet& guides);

// Applies the steps of that stage to a picture with straight alpha. Pixels of alpha 0 stay so, but where lines run. A
// step of strength 0 changes nothing. The bytes depend on the arguments alone, not on threads (0: all) or machine.
// kInput where layers are missing; kCancelled. O(pixels) for each step, of filters times their radius.
Status ApplyFinish(std::span<const FinishStep> steps, FinishPass::Stage stage, const FinishFrame& frame, int threads,
                   const Progress& progress, Picture& picture);

// A layer of a finished picture, as painting programs have them.
struct FinishLayer {
  std::string name;     // the pass's
  Picture picture;      // straight alpha; of ink, transparent but for it; of other passes, the picture after them
  bool is_ink = false;  // false: the whole picture
  bool visible = true;  // false: a layer above shows instead of it
  bool atop = false;    // Porter and Duff's "atop" instead of "over": it leaves the alpha of what is below
};

struct FinishLayerOptions {
  std::string ground = "paper", paint = "paint";  // names of the lowest layers
  int bits = 8;                                   // of the file, 8 or 16: layers have values of so many
  // Puts what lies behind the paint behind it, between the stages kPaint and kSheet. Null: nothing lies there.
  std::function<Status(Picture&)> put_ground = {};
  std::string only = {};  // the layers of passes of this name alone, and no others; empty: all layers
};

// Does ApplyFinish of kPaint, put_ground and ApplyFinish of kSheet, to the same bytes. Returns the layers from the
// lowest up: the ground unless there is none, the paint, and each pass of any strength. The visible ones, put over one
// another, are the picture to a step of `bits`, as colours show. Outlines, edges in ink and hatching are layers of ink.
// A pass that paints anew hides what is below it, but for the ground. Over a ground of partial alpha there may be no
// colours that lead to the picture. Then a layer, of ink too, is the picture with its ground and hides all below it.
// With `only`: of ink, as it lies on the exact picture; the passes before it have no layers; of a pass of kGuides, the
// paint. Errors as of ApplyFinish. O(pixels) for each layer, besides the steps. Steps that ApplyFinish joins are
// repeated for each of their layers.
Expected<std::vector<FinishLayer>> FinishInLayers(std::span<const FinishStep> steps, const FinishFrame& frame,
                                                  const FinishLayerOptions& options, int threads,
                                                  const Progress& progress, Picture& picture);

}  // namespace scumble
