// Guides for tests of files: every layer, and EXR files as other programs write them.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/hash.h"
#include "core/io/guide_file.h"

namespace scumble {

inline const std::vector<std::string> kNormalAndA = {"A", "normal.X", "normal.Y", "normal.Z"};

inline GuideReadOptions OnlyNormals(const std::string& view_layer = "") {
  GuideReadOptions options;
  options.required = {Layer::kCoverage, Layer::kNormal};
  options.view_layer = view_layer;
  return options;
}

inline LayerSet EveryLayer() {
  LayerSet all;
  for (const LayerInfo& info : AllLayers()) all.Add(info.layer);
  return all;
}

inline GuideReadOptions Everything() {
  GuideReadOptions options;
  options.required = EveryLayer();
  return options;
}

// All layers with values that no two pixels share, some background in between.
inline GuideSet RandomGuides(int width, int height) {
  GuideSet guides(width, height);
  for (const LayerInfo& info : AllLayers()) {
    guides.Add(info.layer);
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto plane = guides.Plane(info.layer, c);
      for (std::size_t i = 0; i < plane.size(); ++i) {
        plane[i] = 10.0f * UnitFloat(Hash(static_cast<int>(info.layer), c, i)) - (info.is_color ? 0.0f : 5.0f);
      }
    }
  }
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const bool covered = i % 5 != 3;
    guides.Plane(Layer::kCoverage)[i] = covered ? 0.5f + 0.5f * UnitFloat(Hash(i)) : 0.0f;
    guides.Plane(Layer::kDepth)[i] = covered ? 0.1f + UnitFloat(Hash(i, 1)) : std::numeric_limits<float>::infinity();
    guides.Plane(Layer::kObject)[i] = covered ? static_cast<float>(Hash(i, 2) >> 40) : 0.0f;
    guides.Plane(Layer::kMaterial)[i] = covered ? static_cast<float>(Hash(i, 3) >> 40) : 0.0f;
    for (const Layer layer : {Layer::kPosition, Layer::kUv}) {
      for (int c = 0; c < ChannelCount(layer) && !covered; ++c) guides.Plane(layer, c)[i] = BackgroundValue(layer);
    }
    const glm::vec3 n = covered ? glm::normalize(guides.Vec3(Layer::kNormal, i)) : glm::vec3(0.0f);
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = n[c];
  }
  return guides;
}

inline void ExpectSameBits(const GuideSet& found, const GuideSet& expected) {
  ASSERT_EQ(found.width(), expected.width());
  ASSERT_EQ(found.height(), expected.height());
  ASSERT_EQ(found.layers().ToString(), expected.layers().ToString());
  for (const LayerInfo& info : AllLayers()) {
    if (!expected.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto a = found.Plane(info.layer, c), b = expected.Plane(info.layer, c);
      EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0) << info.channels[c];
    }
  }
}

// A float EXR whose channel c of pixel i holds value(c, i), as any other program might write it.
inline void WriteExr(const std::filesystem::path& path, OIIO::ImageSpec spec, const std::vector<std::string>& channels,
                     const std::function<float(std::size_t c, std::size_t i)>& value) {
  spec.nchannels = static_cast<int>(channels.size());
  spec.channelnames = channels;
  spec.set_format(OIIO::TypeDesc::FLOAT);
  spec.alpha_channel = -1;
  std::vector<float> pixels(channels.size() * spec.width * spec.height);
  for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = value(k % channels.size(), k / channels.size());
  auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output);
  ASSERT_TRUE(output->open(path.string(), spec)) << output->geterror();
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) << output->geterror();
  ASSERT_TRUE(output->close());
}

// An EXR of guides with all of their channels for each view layer, "Front.normal.X". `change` may alter a plane.
inline void WriteViewLayers(
    const std::filesystem::path& path, const GuideSet& guides, const std::vector<std::string>& view_layers,
    const std::function<void(const std::string& view_layer, Layer layer, std::vector<float>& plane)>& change = {}) {
  std::vector<std::string> names;
  std::vector<std::vector<float>> planes;
  for (const std::string& view_layer : view_layers) {
    for (const LayerInfo& info : AllLayers()) {
      if (!guides.Has(info.layer)) continue;
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        const auto plane = guides.Plane(info.layer, c);
        names.push_back(view_layer + "." + std::string(info.channels[std::size_t(c)]));
        planes.emplace_back(plane.begin(), plane.end());
        if (change) change(view_layer, info.layer, planes.back());
      }
    }
  }
  WriteExr(path, OIIO::ImageSpec(guides.width(), guides.height(), 1, OIIO::TypeDesc::FLOAT), names,
           [&](std::size_t c, std::size_t i) { return planes[c][i]; });
}

}  // namespace scumble
