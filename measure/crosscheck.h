// Our guides against a reference renderer's of the same view: figures, limits, a verdict.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/io/cycles_light.h"
#include "scumble/picture.h"

namespace scumble {

// One figure and its limit.
struct CrosscheckFigure {
  std::string layer;  // "normal"
  std::string name;   // "99% within"
  std::string unit;   // "degrees"
  double value = 0;
  double limit = 0;                           // built in
  double error = 0;                           // standard error of the value; 0 where no sampling is involved
  double floor = 0;                           // the least limit that makes sense in a baseline
  std::string note = {};                      // "no such light"
  std::optional<double> baseline_limit = {};  // from a file; can tighten and never loosen
  // If true, the figure must be proved to be within the limit. If false, it must not be proved to be beyond it.
  bool must_prove = true;

  double LimitInForce() const;
  bool TightenedByBaseline() const { return baseline_limit && *baseline_limit < limit; }
  // Beyond the limit by more than twice the error. NaN breaks every limit.
  bool broken() const { return !(value - 2.0 * error <= LimitInForce()); }
  // Within the limit even with twice the error added.
  bool Proved() const { return value + 2.0 * error <= LimitInForce(); }
  bool kept() const { return must_prove ? Proved() : !broken(); }
  // Kept for want of a proof: its noise is too large to judge it.
  bool Unjudged() const { return kept() && !Proved(); }
  // Neither: more samples would decide.
  bool TooNoisy() const { return !kept() && !broken(); }
};

// A layer side by side, for people.
struct CrosscheckPictures {
  std::string layer;
  Picture reference;
  Picture ours;
  Picture difference;
  std::string look;        // how both are shown, in words; empty for plain display
  std::string full_scale;  // the meaning of the difference's colours, in words
  // The colours of the difference from the least to the most, for CSS, and the labels at evenly spaced places below
  // them.
  std::vector<std::string> scale_colors = {};
  std::vector<std::string> scale_labels = {};
};

// The pixelwise difference between ours and the reference, at several sample counts.
struct CrosscheckNoise {
  std::string layer;
  std::vector<int> samples;     // ascending
  std::vector<double> nrmse;    // root mean square difference over the reference's mean, by count; both sides' noise
  std::optional<double> slope;  // of log NRMSE against log samples, least squares: −1/2 for independent samples
  bool free_of_noise = false;   // NRMSE below 1e-3 at the largest count: no slope
  bool no_such_light = false;   // zero in both
  // The largest difference of a channel at the largest count.
  double worst = 0;
  int worst_x = 0;
  int worst_y = 0;
  double worst_reference = 0;
  double worst_ours = 0;
};

// The set-up of the renders: two reports are comparable only if these agree.
struct CrosscheckSetup {
  int width = 0;
  int height = 0;
  int samples = 0;  // of a pixel in the light layers; 0: data layers alone were compared
  int max_bounces = 0;
  std::string camera;              // empty: the scene's first
  std::optional<int> frame;        // of a .blend; empty: the one that it was saved at
  std::string blender_scene = {};  // of a .blend; empty: the one that was open when it was saved
  std::string view_layer = {};     // of a .blend; empty: the first one that is rendered
  bool operator==(const CrosscheckSetup&) const = default;
};

// Fewer pixels prove nothing.
inline constexpr std::size_t kLeastCompared = 100;

enum class CrosscheckOutcome {
  kAgrees,
  kNotProved,  // only noisy figures prevent a verdict
  kDiffers,
  kNotCompared,  // a side could not be made
};

struct CrosscheckReport {
  std::string scene;
  std::string failure = {};  // the reason why it could not be compared; then all other fields but the set-up are empty
  CrosscheckSetup setup;
  std::size_t covered = 0;    // pixels that both sides cover
  std::size_t compared = 0;   // of these, inside the eroded masks
  std::string too_thin = {};  // objects of which no pixel is compared, for people
  bool glossy = false;        // the reference shows a specular surface
  std::vector<CrosscheckFigure> figures;
  std::vector<CrosscheckNoise> noise;
  std::vector<CrosscheckPictures> pictures;
  std::vector<std::string> skipped;      // layers that one side lacks: they fail the verdict
  std::vector<std::string> problems;     // other reasons for failure, one sentence each
  std::vector<std::string> unsupported;  // features that one side or both lack, one sentence each
  std::vector<std::string> warnings;     // deliberate differences from the authored scene
  std::string scumble_version = {};      // of this program
  std::string blender_version = {};      // of the reference; empty where it is not known
  // Why the baseline does not apply to this scene; empty where it does or there is none.
  std::string baseline_mismatch = {};
  bool KeepsBuiltInLimits() const;  // the verdict without any baseline
  CrosscheckOutcome Outcome() const;
  bool passed() const { return Outcome() == CrosscheckOutcome::kAgrees; }
};

struct CrosscheckOptions {
  int erode_pixels = 2;  // only pixels whose neighbourhood shows one object in both are compared
  bool make_pictures = true;
  // By pixel: 1 where albedo is not compared, because the reference's surface only emits. Empty: nowhere.
  std::vector<std::uint8_t> without_albedo = {};
};

// Compares coverage over the whole picture, and normal, depth, position, object ids and albedo inside the object masks
// eroded by `erode_pixels`. Limits: normals 99% within 0.01° and 99.9% within 0.1°; depth and position 99.9% within
// 1e-5 relative; coverage equal but for 0.02% of the pixels; ids equal; albedo 0.002 in the mean. Both sets must hold
// A, normal, depth and object; sizes must agree.
Expected<CrosscheckReport> Crosscheck(const std::string& scene, const GuideSet& reference, const GuideSet& ours,
                                      const CrosscheckOptions& options = {});

// Light paths of both sides at one sample count.
struct CrosscheckLight {
  int samples = 0;
  CyclesLight reference;
  GuideSet ours;  // lpe.* layers
};

// Adds the light layers to the report of the data layers `reference` and `ours`, whose masks they share. `light` is in
// ascending order of samples; figures and pictures are those of the last. Each layer has two figures:
//   - "mean difference": Σ|mean ours − mean reference| / Σ mean reference over the three channels, in percent. Its
//     error is the sum of the channels' standard errors, so it holds for any correlation of the channels' noise.
//     Limits: LDE 0.5%, LSE 2%, the others 1.5% where nothing is glossy and 2% else.
//   - "8x8 tiles": the root mean square difference of the means of tiles of 8 × 8 pixels over the mean, in percent,
//     less the noise's part: light in the wrong place. Limit 5%; it does not apply to layers whose noise hides more.
// Noise is separated from real differences by the change of each pixel's difference from one sample count to the last;
// with a single count by its spread. `indirect` is full − LDE − LSE where the surface itself does not shine. Zero in
// both is "no such light"; zero in one alone breaks. Every value of ours must be finite and not negative. A layer that
// either side lacks is skipped, and fails the verdict. Errors: sizes differ.
Status CrosscheckLightLayers(const GuideSet& reference, const GuideSet& ours, const std::vector<CrosscheckLight>& light,
                             const CrosscheckOptions& options, CrosscheckReport& report);

// A table for a terminal, the verdict last.
std::string CrosscheckToText(const CrosscheckReport& report);
// NaN and infinities are the texts "nan", "inf" and "-inf".
std::string CrosscheckToJson(const std::vector<CrosscheckReport>& reports);

// "agrees", "not proved", "differs", "could not be compared".
const char* OutcomeName(CrosscheckOutcome outcome);
// The verdict's own line, and the reasons for a failure, one sentence each.
std::string CrosscheckVerdict(const CrosscheckReport& report);
std::vector<std::string> WhyCrosscheckFails(const CrosscheckReport& report);

}  // namespace scumble
