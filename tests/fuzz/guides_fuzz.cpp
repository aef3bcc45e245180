// Guides in plain EXR files, as OpenEXR alone reads them.
#include "core/io/guides/own_guides.h"
#include "tests/fuzz/guide_checks.h"

namespace scumble::fuzz {
namespace {

void FuzzGuides(Bytes input) {
  const auto path = InFile("guides.exr", input);
  const auto info = internal::InspectPlainGuides(path);
  if (info) CheckRefusal(*info);
  if (!info || !*info || std::int64_t((*info)->width) * (*info)->height > kMostPixels) return;
  const auto guides = internal::ReadPlainGuides(path, WhateverThereIs());
  if (!guides) return;
  CheckRefusal(*guides);
  if (*guides) CheckGuides(**guides, **info);
}

}  // namespace
SCUMBLE_FUZZ_TARGET(guides, FuzzGuides)
}  // namespace scumble::fuzz
