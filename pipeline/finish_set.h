// The finishing effects of one picture: those of its styles, and those that a run adds.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/style/finish_preset.h"
#include "finish/finish.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"
#include "transfer/style_map.h"

namespace scumble {

// Instead of a name: the styles' own effects are left out.
inline constexpr const char* kNoFinish = "none";

// The bundled presets, by name.
Expected<std::vector<FinishPreset>> FinishPresets(const RunContext& context);

// The passes of these names, in their order: of an effect with its defaults, a bundled preset, or a preset's file.
// kNoFinish adds nothing. A kInput error lists what there is.
Expected<FinishChain> OpenFinish(const std::vector<std::string>& names, const RunContext& context);

// Applies "finish.NAME.KEY=VALUE" to the passes; an error where none has that name.
Status SetFinish(const std::vector<StyleOverride>& sets, FinishChain& chain);

// What was given, or is measured on these guides where a pass looks at it.
FinishMeasures MeasuresOf(std::span<const FinishPass> passes, const std::optional<FinishMeasures>& given,
                          const GuideSet& guides);

// All passes of the styles and of the run as they are now, without their pixels.
std::vector<FinishPass> AllPasses(const StyleSet& styles);

// Whether any of the passes looks at measures, in one frame or another.
bool EverLooksAtMeasures(const FinishChain& chain);
bool EverLooksAtMeasures(const StyleSet& styles);

// What is told of the passes in a frame: a note of what is left out, a warning of names that fit nothing.
struct FinishRemark {
  Message message;
  bool is_of_frame = false;  // another frame may be without it
};
using TellFinish = std::function<void(const FinishRemark&)>;

// Passes on the remarks of a run: those of its first frame, and of one frame or another where they are first made.
class FinishRemarks {
 public:
  // `frame`: none of a single picture. `place`: the file that they are about, or empty.
  void Tell(const FinishRemark& remark, std::optional<int> frame, const std::string& place, const RunContext& context);
  void EndFrame() { is_first_ = false; }

  // At the end of a sequence: what held in several frames, with their numbers, is warned of.
  void WarnOfFrames(const RunContext& context) const;

 private:
  bool is_first_ = true;
  std::map<std::string, std::set<int>> frames_;
};

// The colours that the palettes of a run change where they have no `from`: measured on its first picture and kept.
class PaletteColors {
 public:
  // Of one pass, to be filled in by the painting. `key` sets its `from`. `nth`: among passes with that key, from 0.
  std::optional<ColorSpread>* Of(const std::string& key, int nth) { return &palettes_[{key, nth}].colors; }

  // Notes what repeats those that were measured since the last call. `frame`: of a sequence.
  void TellNew(std::optional<int> frame, const RunContext& context);

 private:
  struct One {
    std::optional<ColorSpread> colors;
    bool is_told = false;
  };
  std::map<std::pair<std::string, int>, One> palettes_;
};

// Whether colours of a palette are measured in one frame or another.
bool MeasuresColors(std::span<const FinishPass> passes);

// The passes of these styles and of the run, in their order, each with the pixels that it is for: a style's passes are
// for its own pixels and lengths, the run's for all that shows: not for shadow catchers, nor for objects that are left
// as they are where nothing is `over`; `objects`, `materials` and masks limit both. `map`: null where one style paints
// all. The styles must be at the picture's frame. Without perspective no line gets thinner with distance, unless --set
// asks for it, which CheckFinish refuses. `colors`: keeps what palettes measure; null: each picture is measured.
std::vector<FinishStep> FinishStepsOf(const StyleSet& styles, const GuideSet& guides, const StyleMap* map, bool over,
                                      const TellFinish& tell, PaletteColors* colors = nullptr);

// One chain of passes without styles, likewise, for a picture of that size. `guides`: null where no pass reads any.
std::vector<FinishStep> FinishStepsOf(const std::vector<FinishPass>& passes, const Size& size, const GuideSet* guides,
                                      const TellFinish& tell, PaletteColors* colors = nullptr);

// MeasureFinish of the layers in `read`, and a note of what repeats it; a warning where the guides show no surface.
// Guides may hold other layers, which earlier requests needed: a run of its own would not have them. `frame`: of a
// sequence.
FinishMeasures MeasureAndTell(const GuideSet& guides, const LayerSet& read, std::optional<int> frame,
                              const RunContext& context);

// Chooses the frame of a sequence that depths and light are measured on: the first that shows enough, else the one that
// shows most.
struct FrameToMeasure {
  std::optional<int> best;  // so far
  double share = 0.0;       // that it shows

  // Whether it need not look on. To be called once for each frame, in order.
  bool IsEnough(int frame, const GuideSet& guides);
};

// The error of a frame that cannot be read, and might be the one to measure: without it, others would be painted
// otherwise than with it. `option`: what gives what was to be measured; empty where the error would come all the same.
Error CannotMeasure(const Error& error, int frame, const std::string& option);

// Whether a guide file cannot be read, not even for the layers that it has. Reads them.
bool IsBroken(const std::string& guides);

// The warning of a sequence in which no frame shows a surface. `options`: those that give what was to be measured.
std::string NothingToMeasure(const std::vector<int>& frames, const std::string& options);

// "2.1,4,11,0.8,1": near, middle, far, bright, full, as --finish-measures takes them.
std::string MeasuresText(const FinishMeasures& measures);

}  // namespace scumble
