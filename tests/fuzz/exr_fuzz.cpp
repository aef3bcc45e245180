// EXR files of any program: guides with parts, view layers, Blender's passes and Cryptomattes, by the module of
// formats. The plain reader must give the same result.
#include <cstring>

#include "core/io/channel_file.h"
#include "core/io/format_dispatch.h"
#include "core/io/guides/own_guides.h"
#include "tests/fuzz/guide_checks.h"

namespace scumble::fuzz {
namespace {

void CheckSame(const GuideSet& a, const GuideSet& b) {
  SCUMBLE_CHECK_EQ(a.layers().ToString(), b.layers().ToString());
  for (const LayerInfo& info : AllLayers()) {
    if (!a.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto one = a.Plane(info.layer, c), other = b.Plane(info.layer, c);
      SCUMBLE_CHECK(std::memcmp(one.data(), other.data(), one.size_bytes()) == 0);
    }
  }
  SCUMBLE_CHECK(a.attributes == b.attributes && a.object_names == b.object_names);
}

void FuzzExr(Bytes input) {
  const auto path = InFile("any.exr", input);
  const auto formats = LoadFormats("a test");
  SCUMBLE_CHECK(formats.ok());
  const auto info = (*formats)->inspect_guides(path);
  CheckRefusal(info, 100000);  // lists what there is
  if (!info || std::int64_t(info->width) * info->height > kMostPixels) return;
  GuideReadOptions options = WhateverThereIs();
  for (const auto& [view_layer, layers] : info->layers) options.view_layer = view_layer;
  const auto guides = (*formats)->read_guides(path, options);
  CheckRefusal(guides, 100000);
  if (guides) CheckGuides(*guides, *info);
  const auto plain = internal::ReadPlainGuides(path, options);
  if (guides && plain && *plain) CheckSame(**plain, *guides);
  CheckRefusal(ReadChannels(path), 100000);
}

}  // namespace
SCUMBLE_FUZZ_TARGET(exr, FuzzExr)
}  // namespace scumble::fuzz
