#include "bench/performance/frames.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <optional>

#include "bench/or_stop.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"

namespace scumble::bench {
namespace {

const std::string kSource = SCUMBLE_SOURCE_DIR;
// With this value the pixels of the hills settle on the seven levels about as those of the authors' golem do at 1024².
constexpr float kRoughness = 1.2f;
constexpr float kUnit = 1080.0f;  // pixels of the formula's unit of length

std::size_t Covered(const GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  return static_cast<std::size_t>(std::count_if(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; }));
}

GuideSet Mirrored(const GuideSet& guides) {
  GuideSet mirrored = guides;
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto plane = mirrored.Plane(info.layer, c);
      for (int y = 0; y < guides.height(); ++y) {
        const auto row = plane.subspan(guides.Index(0, y), static_cast<std::size_t>(guides.width()));
        std::reverse(row.begin(), row.end());
        if (info.layer == Layer::kNormal && c == 0) std::for_each(row.begin(), row.end(), [](float& x) { x = -x; });
      }
    }
  }
  return mirrored;
}

Frame MakeFrame(const std::string& name, GuideSet guides) {
  const std::string size = std::to_string(guides.width()) + "×" + std::to_string(guides.height());
  const std::size_t covered = Covered(guides);
  return {name + " " + size, std::move(guides), {}, covered};
}

struct View {
  Scene scene;
  Camera camera;
};

View Load(const std::string& name, double aspect) {
  Scene scene = OrStop(LoadScene(kSource + "/scenes/" + name + ".glb"));
  Camera camera = OrStop(PrepareView(scene, "", std::nullopt, aspect, true)).camera;
  return {std::move(scene), std::move(camera)};
}

GuideSet Render(const View& view, int width, int height, const LayerSet& layers, int samples) {
  GuidegenOptions options;
  options.width = width, options.height = height, options.layers = layers, options.samples = samples;
  return OrStop(RenderGuides(view.scene, view.camera, options)).guides;
}

// The camera turned to the middle of an object's bounding box.
Camera LookingAt(const View& view, const std::string& object) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Instance& instance : view.scene.instances) {
    if (instance.object != object) continue;
    for (const glm::vec3& position : view.scene.meshes[std::size_t(instance.mesh)].positions) {
      const glm::dvec3 p(instance.world_from_object * glm::dvec4(glm::dvec3(position), 1.0));
      low = glm::min(low, p), high = glm::max(high, p);
    }
  }
  Camera camera = view.camera;
  const glm::dvec3 eye(camera.world_from_camera[3]);
  camera.world_from_camera = glm::inverse(glm::lookAt(eye, 0.5 * (low + high), glm::dvec3(0.0, 1.0, 0.0)));
  return camera;
}

// The widest angle of view for which `fits` holds, to a thousandth of the angle; it holds for narrow ones.
void Widen(View& view, int width, int height, const std::function<bool(const GuideSet&)>& fits, double narrow,
           double wide) {
  while (wide > 1.001 * narrow) {
    view.camera.yfov_degrees = std::sqrt(narrow * wide);
    (fits(Render(view, width, height, {}, 1)) ? narrow : wide) = view.camera.yfov_degrees;
  }
  view.camera.yfov_degrees = narrow;
}

}  // namespace

Frame WithMirrorImage(Frame frame) {
  frame.mirrored = Mirrored(frame.guides);
  return frame;
}

Frame SceneFrame(const std::string& scene, int width, int height, const LayerSet& layers, int samples) {
  return WithMirrorImage(MakeFrame(scene, Render(Load(scene, double(width) / height), width, height, layers, samples)));
}

Frame CloseUp(int width, int height, const LayerSet& layers) {
  View view = Load("suzanne", double(width) / height);
  view.camera = LookingAt(view, "Suzanne");
  Widen(
      view, 192, 108, [](const GuideSet& guides) { return Covered(guides) == guides.pixel_count(); }, 1.0, 60.0);
  view.camera.yfov_degrees *= 0.97;  // more pixels of the object fit
  Frame frame = MakeFrame("close-up", Render(view, width, height, layers, 1));
  if (frame.covered != frame.guides.pixel_count()) {
    OrStop(Expected<int>(InputError("the close-up leaves pixels uncovered: has scenes/suzanne.glb changed?")));
  }
  return WithMirrorImage(std::move(frame));
}

Frame EighthFrame(int width, int height) {
  View view = Load("suzanne", double(width) / height);
  view.camera = LookingAt(view, "Suzanne");
  // The wider the view, the smaller the scene in it: from all of the picture to an eighth.
  Widen(
      view, 384, 216, [](const GuideSet& guides) { return 8 * Covered(guides) >= guides.pixel_count(); }, 5.0, 150.0);
  return WithMirrorImage(MakeFrame("far away", Render(view, width, height, {}, 1)));
}

Frame HillsFrame(int width, int height, bool all_layers) {
  GuideSet guides(width, height);
  for (const LayerInfo& info : AllLayers()) {
    const bool needed = info.layer == Layer::kCoverage || info.layer == Layer::kNormal;
    if (needed || (all_layers && AlwaysWritten().Has(info.layer))) guides.Add(info.layer);
  }
  tbb::parallel_for(0, height, [&](int y) {
    const float v = (static_cast<float>(y) + 0.5f) / kUnit;
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / kUnit;
      // Rough in some places and smooth in others, like real surfaces.
      const float rough = 0.5f + 0.5f * std::sin(9.3f * u + 5.1f * v) * std::cos(6.9f * v - 3.3f * u);
      const float fine = kRoughness * rough * rough * rough;
      const float slope_x = 0.9f * std::sin(11.0f * u + 3.0f * v) + 0.5f * std::sin(31.0f * u - 17.0f * v) +
                            fine * (std::sin(97.0f * u + 61.0f * v) + 0.7f * std::sin(211.0f * u - 149.0f * v));
      const float slope_y = 0.9f * std::cos(9.0f * v - 2.0f * u) + 0.5f * std::cos(29.0f * v + 13.0f * u) +
                            fine * (std::cos(89.0f * v - 71.0f * u) + 0.7f * std::cos(197.0f * v + 167.0f * u));
      const float scale = 1.0f / std::sqrt(slope_x * slope_x + slope_y * slope_y + 1.0f);
      const std::size_t i = guides.Index(x, y);
      guides.Plane(Layer::kCoverage)[i] = 1.0f;
      guides.Plane(Layer::kNormal, 0)[i] = slope_x * scale;
      guides.Plane(Layer::kNormal, 1)[i] = slope_y * scale;
      guides.Plane(Layer::kNormal, 2)[i] = scale;
      if (!all_layers) continue;
      guides.Plane(Layer::kDepth)[i] = 10.0f + 0.1f * (slope_x + slope_y);
      guides.Plane(Layer::kObject)[i] = 1.0f;
    }
  });
  return MakeFrame("hills", std::move(guides));
}

namespace {

Style Bundled(const std::string& name) {
  Style style = OrStop(LoadStyle(kSource + "/exemplars/" + name));
  style.exemplars.erase(style.exemplars.begin() + 1, style.exemplars.end());
  style.exemplars.front().luminance.reset();
  style.paper = {};
  style.tracks.clear();
  style.transfer = {};
  style.transfer.edge_aware = false;
  style.transfer.reference_height = 0;
  return style;
}

}  // namespace

Style PlainStyle() {
  Style style = Bundled("oil");
  for (std::size_t i = 3; i < style.exemplars.front().picture.rgba.size(); i += 4) {
    style.exemplars.front().picture.rgba[i] = 65535;
  }
  return style;
}

std::vector<Style> TenStyles() {
  std::vector<Style> styles;
  for (const char* name : {"oil", "charcoal", "coloured-pencil", "gouache", "graphite", "ink", "pastel", "pointillism",
                           "watercolour", "woodcut"}) {
    styles.push_back(Bundled(name));
  }
  return styles;
}

}  // namespace scumble::bench
