// Scenes and readings for the tests of light paths.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {

inline const LayerSet kAllPaths = {Layer::kLpeFull, Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLpeLDDE, Layer::kLpeLD12E};

inline Material Painted(Bsdf bsdf, float color, float roughness = 0.5f) {
  Material material;
  material.name = "paint";
  material.bsdf = bsdf;
  material.base_color = glm::vec4(color, color, color, 1.0f);
  material.roughness = roughness;
  return material;
}

// A floor in the plane z = 0, `side` × 2 m wide, that faces the camera.
inline Scene Floor(const Material& material, double side = 1.0) {
  Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(side, side, 1.0)));
  scene.materials[0] = material;
  return scene;
}

inline int AddMaterial(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return int(scene.materials.size()) - 1;
}

// A light at `height` above the floor that shines down on it.
inline Light Above(LightType type, double height, double intensity) {
  Light light = PointLight({0, 0, height}, intensity);
  light.type = type;
  return light;
}

inline GuidegenOptions Paths(int side, LayerSet layers, int samples = 64) {
  GuidegenOptions options = Sized(side, side, layers);
  options.samples = samples;
  return options;
}

// One pixel at the floor's origin.
inline Camera Spot() { return LookingAt({0, -0.02, 5}, {0, 0, 0}, 1e-4); }
inline Camera SlantedSpot() { return LookingAt({0, -3, 3}, {0, 0, 0}, 1e-4); }

inline double Center(const GuidegenResult& result, Layer layer) { return result.guides.Plane(layer, 1)[0]; }

inline double Mean(const GuidegenResult& result, Layer layer) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    if (result.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
    sum += result.guides.Plane(layer, 1)[i];
    count += 1.0;
  }
  return sum / count;
}

inline void ExpectFinite(const GuidegenResult& result) {
  for (const LayerInfo& info : AllLayers()) {
    if (!result.guides.Has(info.layer) || !info.is_color) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (const float value : result.guides.Plane(info.layer, c)) {
        ASSERT_TRUE(std::isfinite(value) && value >= 0.0f) << info.name << " " << value;
      }
    }
  }
}

}  // namespace scumble::testing
