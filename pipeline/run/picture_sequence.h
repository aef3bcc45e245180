// A sequence of pictures whose guides come from files or from a scene, and the checks that both kinds of run share.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/run_inputs.h"
#include "pipeline/run_requests.h"
#include "pipeline/sequence.h"
#include "pipeline/style_set.h"

namespace scumble {

// Where the frames of a sequence get their guides from.
struct FrameGuides {
  const GuideSet* guides = nullptr;  // valid until the next call
  GuideSource source;
};
using GuidesAt = std::function<Expected<FrameGuides>(int frame, const Progress& progress)>;

// The guides that a sequence looks at before it paints.
struct GuidesAhead {
  GuidesAt at;
  // Whether an error of `at` is the frame's own: its file is missing or broken.
  std::function<bool(int frame)> is_own;
};

// The styles, the request and the state of a sequence of pictures. Styles, request and context are borrowed.
class PictureSequence {
 public:
  PictureSequence(StyleSet& styles, const PictureRequest& request, const RunContext& context)
      : styles_(styles), request_(request), context_(context) {}

  // Exposure and finishing effects are measured on the first frame of the range that shows a surface, even where it is
  // kept: a sequence that is resumed goes on as it began. `ahead` is asked for frames of the range in their order,
  // until one shows some. One picture underneath all frames must be there, and have the size of the first that is
  // known. `failed_at`: see SequenceWork::begin.
  Status Begin(const Sequence& sequence, const Size& size, const GuidesAhead& ahead, const Progress& progress,
               std::optional<int>& failed_at);
  Status ReadOverOfAll(const Size& size);

  // Whether a picture that is there is one that Make would make, as far as can be told without its guides. `samples`:
  // of its guides' light, where that is known; `guides`: their GuidesText, likewise.
  Status Check(int frame, const std::string& output, int width, int height, std::optional<FrameRate> fps,
               const std::string& samples, const std::string& guides);
  bool MustLookAhead(const Sequence& sequence) const;

  Expected<FrameWrite> Make(int frame, const std::string& output, const GuidesAt& guides_at, double guides_share,
                            const Progress& progress);

  // RunSequence of this work, whose functions call those above; and what is warned of when all frames are made.
  Expected<RunReport> Run(const Sequence& sequence, const SequenceWork& work, const SequenceListener& listener,
                          const Progress& progress);

 private:
  // Instead of what must be measured.
  std::string OptionsThatGive(bool is_exposed, const std::string& exposure) const;

  StyleSet& styles_;
  const PictureRequest& request_;
  const RunContext& context_;
  PictureState state_;
};

// One picture: painted, written and reported.
Expected<RunReport> RunOnePicture(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                                  const PictureRequest& request, const RunContext& context, const Progress& progress);

// The memory that painting a frame needs besides its guides, which have so many fragments.
PictureWork WorkOf(const StyleSet& styles, const PictureRequest& picture, const Size& guides, const LayerSet& layers,
                   std::size_t fragments, bool is_sequence, const RunContext& context);

// Registers the inputs of styles and picture, and checks the outputs against all inputs.
Status CheckFiles(RunInputs& files, const PictureRequest& picture, const std::optional<Sequence>& sequence,
                  const StyleSet& styles);

// CheckFiles once more, where the scene has named files since, or scene or guides have asked for styles; and
// whether there are the passes whose layers are wanted. All are borrowed.
using FilesCheck = std::function<Status()>;
FilesCheck CheckOfSceneStyles(RunInputs& files, const PictureRequest& picture, const std::optional<Sequence>& sequence,
                              const StyleSet& styles);

// The picture underneath that trials of a budget paint over: a sequence's first. A plan alone may leave open which
// frame it is of, and then nothing is underneath.
Expected<std::string> OverOnTrial(const PictureRequest& picture, const std::optional<Sequence>& sequence);

// Fills places for a frame's number in the names of a single picture.
Status NameOne(PictureRequest& picture);

}  // namespace scumble
