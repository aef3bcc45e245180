// What `scumble styles check` finds in one style.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/image/style.h"
#include "measure/paint_faults.h"
#include "measure/paint_traits.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "transfer/ambiguity.h"
#include "transfer/transfer.h"

namespace scumble {

struct FoundFault {
  std::string image;  // the exemplar's name
  PaintFault fault;   // what is wrong, and how to fix it
};

struct CheckedStyle {
  Style style;
  // The rest stays empty for a style without a painting (Style::unpainted).
  PreparedStyle prepared;
  std::vector<PaintTraits> traits;  // by exemplar
  AmbiguityReport directions;
  std::optional<SpaceAmbiguity> space;
  std::vector<FoundFault> faults;

  std::size_t Count(PaintFault::Weight weight) const;
};

// Loads and prepares the style as a transfer would, and finds the mistakes that painters overlook.
Expected<CheckedStyle> CheckStyle(const StyleRequest& request, const RunContext& context);

}  // namespace scumble
