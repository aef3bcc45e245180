// Painting a frame by one variant after another to see how long it takes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style/style_set.h"
#include "pipeline/variant/variant.h"
#include "transfer/transfer.h"

namespace scumble {

class TrialPainter {
 public:
  // All are borrowed. `styles` as the user has them, without any way. `frame`: whose guides are painted, for what
  // changes over time. `name`: of the guides' file or scene. `over`: the file of the picture underneath; empty: none.
  TrialPainter(StyleSet& styles, const PictureRequest& picture, std::optional<int> frame, const std::string& name,
               const std::string& over, const RunContext& context)
      : styles_(styles), picture_(picture), frame_(frame), name_(name), over_file_(over), context_(context) {}

  // Upsamples the guides, if the variant or the picture's options say so, and paints with memory that is new, as the
  // first picture of a run is. What is underneath is read once and not counted; one of another size is left out, the
  // run will refuse it. Returns the milliseconds of wall clock that both took; preparing the style is not counted.
  Expected<double> Paint(const Variant& variant, const GuideSet& guides);

  // How far the picture of a variant that leaves the guides' size alone is from what the painting shows under these
  // guides, and what of the painting it misses: `both` of measure/energy/energy.h, at kErrorPatches patches, the same
  // ones for each variant. Without paper, what is underneath, and the scene's colours. 0 where nothing is covered;
  // infinity where several styles paint, memory for it is not there or guides are no numbers. Errors as of Paint.
  Expected<double> MeasureError(const Variant& variant, const GuideSet& guides);

  // So few that a judgement takes a second or two. Contenders that are closer than that can tell are as good as each
  // other.
  static constexpr std::size_t kErrorPatches = 1024;

 private:
  Status Prepare(const Variant& variant, const GuideSet& guides, int upsample, bool bare);
  // Adds its time to `ms`. `bare`: without what is underneath, and with a field.
  Status Transfer(const GuideSet& guides, bool bare, TransferScratch& scratch, Picture& picture, double& ms);
  Expected<const Picture*> Over(const GuideSet& guides);

  StyleSet& styles_;
  const PictureRequest& picture_;
  const std::optional<int> frame_;
  const std::string& name_;
  const std::string& over_file_;
  const RunContext& context_;
  std::string prepared_for_;  // that variant's name, and what else
  std::vector<PreparedStyle> prepared_;
  double exposure_ = 0.0;
  std::optional<Picture> over_;
};

}  // namespace scumble
