// Painting a frame by one way after another to see how long it takes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/style_set.h"
#include "cli/transfer_run.h"
#include "cli/ways.h"
#include "image/guides.h"
#include "image/status.h"
#include "transfer/transfer.h"

namespace scumble {

class PaintTrial {
 public:
  // All are borrowed. `styles` as the user has them, without any way. `name`: of the guides' file or scene. `over`: the
  // file of the picture underneath; empty: none.
  PaintTrial(StyleSet& styles, const PictureOptions& picture, const std::string& name, const std::string& over,
             const Globals& globals)
      : styles_(styles), picture_(picture), name_(name), over_file_(over), globals_(globals) {}

  // Upsamples the guides, if the way or the picture's options say so, and paints with memory that is new, as the first
  // picture of a run is. What is underneath is read once and not counted; one of another size is left out, the run will
  // refuse it. Returns the milliseconds of wall clock that both took; preparing the style is not counted.
  Expected<double> Paint(const Way& way, const GuideSet& guides);

 private:
  Status Prepare(const Way& way, const GuideSet& guides, int upsample);
  Expected<const Picture*> Over(const GuideSet& guides);

  StyleSet& styles_;
  const PictureOptions& picture_;
  const std::string& name_;
  const std::string& over_file_;
  const Globals& globals_;
  std::string prepared_for_;  // that way's name
  std::vector<PreparedStyle> prepared_;
  double exposure_ = 0.0;
  std::optional<Picture> over_;
};

}  // namespace scumble
