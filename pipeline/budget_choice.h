// --quality and --budget-ms: which step of the quality ladder (pipeline/variant/quality_ladder.h) the pictures are
// painted by. One is chosen before the first picture and holds for all of them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"
#include "pipeline/variant/quality_ladder.h"

namespace scumble {

struct BudgetRequest {
  std::optional<Quality> quality;  // a named step; empty: none
  double budget_ms = 0;            // 0: none
  bool recalibrate = false;        // measure again
  bool guides_are_fixed = false;   // the user gave their size

  bool chooses() const { return quality || budget_ms > 0; }
};

// "draft", "preview", "final", in this order; and back.
std::vector<std::string> QualityNames();
std::optional<Quality> FindQuality(const std::string& name);

// What was chosen, for the report.
struct BudgetChoice {
  std::optional<std::string> quality;  // the name of the step, if one was asked for
  // Otherwise, of a budget:
  double budget_ms = 0;
  std::string picked;
  double predicted_ms = 0;
  bool fits = false;
  int measured_runs = 0;
  std::vector<std::string> options;  // of the command line, that repeat it: "--upsample", "4", …
};

// Chooses, puts the choice into `styles` and `picture`, and notes it; empty where nothing is to be chosen. Of the
// guides only size and coverage count. `frame` is theirs; none: 0. `over`: the picture underneath theirs; empty: none.
Expected<std::optional<BudgetChoice>> ChooseForGuides(const BudgetRequest& options, const GuideSet& guides,
                                                      std::optional<int> frame, const std::string& name,
                                                      const std::string& over, StyleSet& styles,
                                                      PictureRequest& picture, const RunContext& context);

// As ChooseForGuides where the guides are cast, too, and may be smaller than the picture; scene.size is that of the
// picture, or of its guides where they are fixed. The samples that were chosen are put into scene.samples. `frame` is
// that of the scene; none: at rest. Where times are not known, the scene is read for measuring them.
Expected<std::optional<BudgetChoice>> ChooseForScene(const BudgetRequest& options, SceneRequest& scene,
                                                     std::optional<int> frame, const std::string& over,
                                                     StyleSet& styles, PictureRequest& picture,
                                                     const RunContext& context);

}  // namespace scumble
