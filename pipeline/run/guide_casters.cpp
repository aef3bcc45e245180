#include "pipeline/run/guide_casters.h"

#include <fmt/format.h>

namespace scumble {

void GuideCasters::Add(int frame, const std::map<std::string, std::string>& attributes) {
  const auto value_of = [&](const char* name) {
    const auto found = attributes.find(name);
    return found == attributes.end() ? std::string() : found->second;
  };
  const Caster caster{frame, value_of("scumble:isa"), value_of("scumble:embree")};
  if (caster.isa.empty() || warned_) return;
  if (!first_) {
    first_ = caster;
    return;
  }
  const bool other_embree = !caster.embree.empty() && !first_->embree.empty() && caster.embree != first_->embree;
  if (caster.isa == first_->isa && !other_embree) return;
  warned_ = true;
  const auto name = [&](const Caster& one) {
    return other_embree ? fmt::format("Embree {} on {}", one.embree, one.isa) : one.isa;
  };
  context_.Warn(fmt::format(
      "frame {}: its guides were cast by {}, those of frame {} by {}; the last bits of guides may differ: {}", frame,
      name(caster), first_->frame, name(*first_),
      other_embree ? "cast all of them on machines with one version of Embree" : "cast all of them with one --isa"));
}

}  // namespace scumble
