// What `scumble tradeoff` takes at its peak, before any of it is taken. docs/memory.md explains estimates.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/image/layers.h"
#include "core/image/style.h"
#include "pipeline/memory_limit.h"
#include "pipeline/run_context.h"
#include "pipeline/tradeoff/stage.h"

namespace scumble {

class TradeMemory {
 public:
  // All are borrowed.
  TradeMemory(const TradeSetup& setup, const TradeStage& stage, const RunContext& context)
      : setup_(setup), stage_(stage), context_(context) {}

  // Adds what there is whichever variants are at work: the style and what all are measured against, one more picture,
  // made without the scene's colours, and the pictures of so many variants, as files and in the page. `need` has the
  // program, the scene and the guides that last already.
  void AddReport(std::size_t variants, MemoryNeed& need) const;

  // Adds a variant that is at work, and the energy of its picture. `own_guides`: no other one at work shares them.
  void AddVariant(const Variant& variant, const Style& style, const LayerSet& layers, bool own_guides,
                  MemoryNeed& need) const;

 private:
  std::uint64_t Pixels() const { return std::uint64_t(stage_.width) * std::uint64_t(stage_.height); }
  std::uint64_t Places() const;

  const TradeSetup& setup_;
  const TradeStage& stage_;
  const RunContext& context_;
};

}  // namespace scumble
