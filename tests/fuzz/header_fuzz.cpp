// The texts in a guide file's header: Cryptomatte's manifests, names, matrices, and the names of channels; and the
// texts beside a render, which --camera names.
#include <algorithm>
#include <map>

#include "core/io/blender_camera.h"
#include "core/io/guides/cryptomatte.h"
#include "core/io/guides/guide_header.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

void FuzzHeader(Bytes input) {
  const std::string text(AsText(input));
  const auto manifest = ReadManifest(text, "any.exr");
  CheckRefusal(manifest);
  if (manifest) {
    std::vector<std::vector<float>> ranks(4, std::vector<float>(input.size()));
    std::transform(input.begin(), input.end(), ranks[0].begin(), [](std::uint8_t v) { return static_cast<float>(v); });
    ranks[1].assign(input.size(), 1.0f);
    std::vector<float> ids(input.size());
    std::map<std::uint32_t, std::string> names;
    CheckRefusal(NameMattes(ranks, *manifest, "any.exr", ids, names));
  }
  // Names survive being written and read.
  const auto names = internal::NamesFromText(text);
  SCUMBLE_CHECK(internal::NamesFromText(internal::NamesToText(names)) == names);
  static_cast<void>(internal::MatrixFromText(text));
  // All other texts are refused at their first line, and writing a file takes as long as all other checks together.
  if (text.find("FromView") != text.npos) CheckRefusal(ReadBlenderCamera(InFile("any.camera", input)));
  const auto matte = ParseMatteChannel(text);
  SCUMBLE_CHECK(!matte || (matte->index >= 0 && matte->index < 128));
  const auto channel = ParseChannelName(text);
  SCUMBLE_CHECK(!channel || (channel->component >= 0 && channel->component < ChannelCount(channel->layer)));
  CheckRefusal(ParseLayers(text), 10000 + text.size());
}

}  // namespace
SCUMBLE_FUZZ_TARGET(header, FuzzHeader)
}  // namespace scumble::fuzz
