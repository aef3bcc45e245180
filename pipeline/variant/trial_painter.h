// Painting a frame by one variant after another: how long each takes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"
#include "pipeline/variant/variant.h"
#include "transfer/transfer.h"

namespace scumble {

class TrialPainter {
 public:
  // All are borrowed. `styles` as the user has them, without any variant. `frame`: whose guides are painted, for
  // what changes over time. `name`: of the guides' file or scene. `over`: the file of the picture underneath; empty:
  // none.
  TrialPainter(StyleSet& styles, const PictureRequest& picture, std::optional<int> frame, const std::string& name,
               const std::string& over, const RunContext& context)
      : styles_(styles), picture_(picture), frame_(frame), name_(name), over_file_(over), context_(context) {}

  // Upsamples the guides or scales up the picture, if the variant or the request asks for it, and paints into new
  // memory, with its finishing effects, as the first picture of a run is painted. Returns the milliseconds of wall
  // clock that all of it took. Preparing the style and reading the picture underneath are not counted. One of another
  // size is left out; the run will refuse it.
  Expected<double> Paint(const Variant& variant, const GuideSet& guides);

 private:
  Status Prepare(const Variant& variant, const GuideSet& guides, int upsample);
  Expected<const Picture*> Over(const GuideSet& guides);

  StyleSet& styles_;
  const PictureRequest& picture_;
  const std::optional<int> frame_;
  const std::string& name_;
  const std::string& over_file_;
  const RunContext& context_;
  std::string prepared_for_;  // that variant's name
  std::vector<PreparedStyle> prepared_;
  StyleSet variant_;  // the styles with the variant's settings, at the frame, without pictures
  std::optional<FinishMeasures> measures_;
  double exposure_ = 0.0;
  std::optional<Picture> over_;
};

}  // namespace scumble
