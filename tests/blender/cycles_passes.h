// Data passes that Cycles rendered, and the comparison of our guides with them.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/image/guides.h"

namespace scumble {

// Blender's axes in glTF's world.
inline glm::dvec3 YUp(const glm::dvec3& v) { return {v.x, v.z, -v.y}; }

// Cycles' passes, turned into our conventions as far as the format goes: depth, and world-space vectors, +Y up.
struct CyclesPasses {
  int width = 0, height = 0;
  std::vector<float> depth, index;
  std::vector<glm::dvec3> normal, position;
};

inline CyclesPasses ReadCycles(const std::filesystem::path& file) {
  CyclesPasses passes;
  auto input = OIIO::ImageInput::open(file.string());
  if (!input) return ADD_FAILURE() << file << " was not rendered", passes;
  const OIIO::ImageSpec spec = input->spec();
  std::vector<float> pixels(std::size_t(spec.width) * spec.height * spec.nchannels);
  EXPECT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data()));
  const auto channel = [&](const std::string& name) {
    const int found = spec.channelindex("ViewLayer." + name);
    EXPECT_GE(found, 0) << name;
    return std::size_t(std::max(found, 0));
  };
  const std::size_t normal[] = {channel("Normal.X"), channel("Normal.Y"), channel("Normal.Z")};
  const std::size_t position[] = {channel("Position.X"), channel("Position.Y"), channel("Position.Z")};
  const std::size_t depth = channel("Depth.Z"), index = channel("IndexOB.X");
  passes.width = spec.width, passes.height = spec.height;
  for (std::size_t at = 0; at < pixels.size(); at += std::size_t(spec.nchannels)) {
    const float* pixel = &pixels[at];
    passes.depth.push_back(pixel[depth]);
    passes.index.push_back(pixel[index]);
    passes.normal.push_back(YUp({pixel[normal[0]], pixel[normal[1]], pixel[normal[2]]}));
    passes.position.push_back(YUp({pixel[position[0]], pixel[position[1]], pixel[position[2]]}));
  }
  return passes;
}

// The value below which this share of the values lies.
inline double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Pixels whose neighbourhood of two pixels shows one object alone.
inline std::vector<std::size_t> Eroded(const GuideSet& guides) {
  std::vector<std::size_t> inside;
  const auto id = guides.Plane(Layer::kObject);
  for (int y = 2; y + 2 < guides.height(); ++y) {
    for (int x = 2; x + 2 < guides.width(); ++x) {
      const float here = id[guides.Index(x, y)];
      bool same = here != 0.0f;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) same = same && id[guides.Index(x + dx, y + dy)] == here;
      }
      if (same) inside.push_back(guides.Index(x, y));
    }
  }
  return inside;
}

}  // namespace scumble
