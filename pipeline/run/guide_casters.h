// Warns where guides of one run were cast by different instruction sets or versions of Embree, as on a farm of
// different machines: the last bits of their values may differ, and with them which chunk a pixel takes.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "pipeline/run_context.h"

namespace scumble {

class GuideCasters {
 public:
  explicit GuideCasters(const RunContext& context) : context_(context) {}

  // The attributes of a frame's guides. The first frame that differs from the first one added is warned of, no other.
  // Guides of other renderers count for nothing; those of older versions, which did not record Embree's, by their
  // instruction set alone.
  void Add(int frame, const std::map<std::string, std::string>& attributes);

 private:
  struct Caster {
    int frame;
    std::string isa, embree;
  };

  const RunContext& context_;
  std::optional<Caster> first_;
  bool warned_ = false;
};

}  // namespace scumble
