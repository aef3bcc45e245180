// --quality and --budget-ms of `transfer` and `stylize`: which rung of the ladder (pipeline/variant/quality_ladder.h) the pictures
// are painted by. One is chosen before the first picture and holds for all of them.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "apps/cli/app/command.h"
#include "apps/cli/app/options.h"
#include "pipeline/style/style_set.h"
#include "pipeline/frame/paint_frame.h"
#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

struct BudgetOptions {
  std::string quality;   // empty: none
  double budget_ms = 0;  // 0: none
  bool recalibrate = false;
  bool guides_are_fixed = false;  // --upsample was given

  bool chooses() const { return !quality.empty() || budget_ms > 0; }
};
// `casts`: the verb makes its guides itself. To be called after AddPictureOptions.
void AddBudgetOptions(CLI::App& verb, BudgetOptions& options, bool casts);

// Reads which options were given; a usage error where they exclude each other. To be called before anything is read.
Status CheckBudgetOptions(const CLI::App& verb, BudgetOptions& options);

// Chooses and puts what was chosen into `styles` and `picture`; says so on stderr, and in picture.chosen for JSON.
// Nothing changes where nothing is to be chosen. Of the guides only size and coverage count for times; what they
// show, for which of two ways is nearer. `frame` is theirs; none: 0. `over`: the picture underneath theirs; empty: none.
Status ChooseForGuides(const BudgetOptions& options, const GuideSet& guides, std::optional<int> frame,
                       const std::string& name, const std::string& over, StyleSet& styles, PictureOptions& picture, const Globals& globals);

// The same where the guides are cast, too, and may be smaller than the picture; scene.size is that of the picture, or
// of its guides where --upsample was given. The samples that were chosen are put into scene.samples. `frame` is that of
// the scene; none: at rest. Where times are not known, the scene is read for measuring them.
Status ChooseForScene(const BudgetOptions& options, SceneOptions& scene, std::optional<int> frame,
                      const std::string& over, StyleSet& styles, PictureOptions& picture, const Globals& globals);

}  // namespace scumble
