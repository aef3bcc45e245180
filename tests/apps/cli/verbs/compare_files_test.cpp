// scumble compare of files whose channels have other names: by view layer, and as guides.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/cli_harness.h"
#include "tests/support/guide_files.h"

namespace scumble {
namespace {

class CliCompareFiles : public CliTest {
 protected:
  // The guides of a sphere, with the channels of each view layer; those of "Far" are a metre farther away.
  void WriteLayers(const std::string& file, const std::vector<std::string>& view_layers) {
    const GuideSet guides = Ball(24);
    WriteViewLayers(At(file), guides, view_layers,
                    [](const std::string& view_layer, Layer layer, std::vector<float>& plane) {
                      if (layer != Layer::kDepth || view_layer != "Far") return;
                      for (float& depth : plane) depth += 1.0f;
                    });
    WriteGuideFile("ours.exr", guides);
  }
};

TEST_F(CliCompareFiles, OneViewLayerIsComparedByItsMeaning) {
  WriteLayers("layers.exr", {"Near"});
  const CommandResult found = RunOk({"compare", "ours.exr", "layers.exr"});
  EXPECT_NE(found.err.find("compared as guides: A, normal, depth"), std::string::npos) << found.err;
  EXPECT_NE(found.out.find("normal"), std::string::npos) << found.out;
}

TEST_F(CliCompareFiles, TheViewLayerIsChosen) {
  WriteLayers("layers.exr", {"Near", "Far"});
  RunOk({"compare", "ours.exr", "layers.exr", "--view-layer", "Near"});
  const CommandResult far = Run({"compare", "ours.exr", "layers.exr", "--view-layer", "Far", "--json"});
  EXPECT_EQ(far.code, 1) << far.err;
  const nlohmann::json report = far.Json();
  for (const auto& layer : report["layers"]) {
    EXPECT_EQ(layer["stats"]["different"] != 0, layer["name"] == "depth") << layer;
  }
  RunOk({"compare", "ours.exr", "layers.exr", "--view-layer", "Far", "--layer", "normal"});
  RunOk({"compare", "layers.exr", "layers.exr", "--view-layer", "Far"});
}

TEST_F(CliCompareFiles, GreyIsAllThreeColours) {
  const OIIO::ImageSpec spec(2, 1, 1, OIIO::TypeDesc::FLOAT);
  const auto tone = [](std::size_t i) { return i == 0 ? 0.25f : 0.5f; };
  const auto same = [&](std::size_t, std::size_t i) { return tone(i); };
  WriteExr(At("grey.exr"), spec, {"Y"}, same);
  WriteExr(At("same.exr"), spec, {"R", "G", "B"}, same);
  WriteExr(At("other.exr"), spec, {"R", "G", "B"},
           [&](std::size_t c, std::size_t i) { return tone(i) + (c == 0 ? 0.25f : 0.0f); });
  RunOk({"compare", "grey.exr", "same.exr"});
  EXPECT_EQ(Run({"compare", "other.exr", "grey.exr"}).code, 1);
}

TEST_F(CliCompareFiles, WhatCannotBeChosenIsRefused) {
  WriteLayers("layers.exr", {"Near", "Far"});
  ExpectError({"compare", "ours.exr", "layers.exr"}, 3, {"layers.exr", "'Far', 'Near'", "--view-layer"});
  ExpectError({"compare", "ours.exr", "layers.exr", "--view-layer", "Middle"}, 3, {"'Middle'", "'Far', 'Near'"});
  ExpectError({"compare", "ours.exr", "ours.exr", "--view-layer", "Near"}, 2, {"--view-layer", "leave it out"});
  ExpectError({"compare", "ours.exr", "layers.exr", "--view-layer", "Near", "--flip"}, 2, {"--view-layer", "--flip"});
}

}  // namespace
}  // namespace scumble
