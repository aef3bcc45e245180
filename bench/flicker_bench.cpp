// The flicker of sequences whose seeds are new in every frame, frozen to the screen, or on the surface, beside the Lit
// Sphere: prints the table of docs/sequences.md. Arguments: names of bundled styles; --save FOLDER writes the frames,
// too.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "measure/flicker.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr int kFrames = 13, kWidth = 640, kHeight = 540;
constexpr double kDegree = 3.14159265358979323846 / 180.0;
const glm::dvec3 kUp(0.0, 1.0, 0.0);

struct View {
  Scene scene;
  Camera camera;
};

struct Motion {
  std::string name;
  std::string scene;
  std::function<void(double frame, View& view)> move;
};

// Around the vertical line through the framing camera's target, the scene's middle at about its height.
void TurnObjects(Scene& scene, double degrees) {
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), degrees * kDegree, kUp);
  for (Instance& instance : scene.instances) instance.world_from_object = turn * instance.world_from_object;
}

std::vector<Motion> Motions() {
  const auto shift = [](double x, double y, double z) { return glm::translate(glm::dmat4(1.0), glm::dvec3(x, y, z)); };
  return {
      {"a head passes by", "suzanne",
       [=](double frame, View& view) {
         for (Instance& instance : view.scene.instances) {
           instance.world_from_object = shift(0.017 * frame - 0.1, 0.004 * frame, 0.0) * instance.world_from_object;
         }
       }},
      {"a snail turns by 1° a frame", "snail", [](double frame, View& view) { TurnObjects(view.scene, frame); }},
      {"the camera goes round by 0.5° a frame", "stilllife",
       [](double frame, View& view) {
         const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.5 * frame * kDegree, kUp);
         view.camera.world_from_camera = turn * view.camera.world_from_camera;
       }},
      {"the camera comes 2 % nearer a frame", "stilllife",
       [=](double frame, View& view) {
         const glm::dvec3 eye(view.camera.world_from_camera[3]);
         view.camera.world_from_camera *= shift(0.0, 0.0, -0.02 * frame * glm::length(eye));
       }},
  };
}

View ViewAt(const Motion& motion, const View& rest, double frame) {
  View view = rest;
  motion.move(frame, view);
  return view;
}

Expected<std::vector<GuideSet>> GuidesOf(const Motion& motion) {
  SCUMBLE_ASSIGN(Scene scene, LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/" + motion.scene + ".glb"));
  SCUMBLE_ASSIGN(const PreparedView prepared, PrepareView(scene, "", {}, double(kWidth) / kHeight, false));
  const View rest{std::move(scene), prepared.camera};
  GuidegenOptions options;
  options.width = kWidth, options.height = kHeight, options.aa = 2;
  options.layers = {Layer::kPref, Layer::kMotion};
  std::vector<GuideSet> guides;
  for (int frame = 0; frame < kFrames; ++frame) {
    const View now = ViewAt(motion, rest, frame), next = ViewAt(motion, rest, frame + 1);
    SCUMBLE_ASSIGN(GuidegenResult result,
                   RenderGuides(now.scene, now.camera, NextFrame{next.scene, next.camera}, options));
    guides.push_back(std::move(result.guides));
  }
  return guides;
}

struct Variant {
  std::string name;
  std::function<void(TransferSettings&)> set;
};

std::vector<Variant> Variants() {
  return {
      {"jittered", [](TransferSettings& settings) { settings.jitter_fps = -1.0; }},
      {"frozen", [](TransferSettings&) {}},
      {"coherent", [](TransferSettings& settings) { settings.coherent = true; }},
      {"litsphere", [](TransferSettings& settings) { settings.method = Method::kLitSphere; }},
  };
}

struct Figures {
  double flicker = 0, floor = 0, match_ms = 0;
};

Expected<Figures> Measure(Style style, const Variant& way, const std::vector<GuideSet>& guides,
                          const std::string& save) {
  way.set(style.transfer);
  SCUMBLE_ASSIGN(const PreparedStyle prepared, Prepare(style, kHeight));
  TransferScratch scratch;
  Figures figures;
  Picture last, picture;
  std::vector<double> times;
  for (int frame = 0; frame < kFrames; ++frame) {
    TransferOptions options;
    options.frame = frame;
    const std::size_t f = std::size_t(frame);
    SCUMBLE_RETURN_IF_ERROR(Transfer(prepared, guides[f], options, scratch, picture));
    times.push_back(scratch.times.match_ms);
    if (!save.empty()) {
      char number[16];
      std::snprintf(number, sizeof number, "-%02d.png", frame);
      SCUMBLE_RETURN_IF_ERROR(WritePicture(save + number, picture));
    }
    if (frame > 0) {
      SCUMBLE_ASSIGN(const FlickerReport report, MeasureFlicker(last, picture, guides[f - 1], &guides[f]));
      figures.flicker += report.mean / (kFrames - 1), figures.floor += report.floor / (kFrames - 1);
    }
    std::swap(last, picture);
  }
  std::sort(times.begin(), times.end());
  figures.match_ms = times[times.size() / 2];
  return figures;
}

Status Run(const std::vector<std::string>& styles, const std::string& folder) {
  std::printf("| motion | style | way | flicker | floor | match, ms |\n|---|---|---|---|---|---|\n");
  for (const Motion& motion : Motions()) {
    SCUMBLE_ASSIGN(const std::vector<GuideSet> guides, GuidesOf(motion));
    for (const std::string& name : styles) {
      SCUMBLE_ASSIGN(const Style style, LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name, {}));
      for (const Variant& way : Variants()) {
        const std::string save = folder.empty() ? "" : folder + "/" + motion.scene + "-" + name + "-" + way.name;
        SCUMBLE_ASSIGN(const Figures figures, Measure(style, way, guides, save));
        std::printf("| %s | %s | %s | %.1f | %.1f | %.1f |\n", motion.name.c_str(), name.c_str(), way.name.c_str(),
                    figures.flicker, figures.floor, figures.match_ms);
        std::fflush(stdout);
      }
    }
  }
  return Ok();
}

}  // namespace
}  // namespace scumble

int main(int count, char** arguments) {
  std::vector<std::string> styles;
  std::string folder;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--save" && i + 1 < count) {
      folder = arguments[++i];
    } else {
      styles.push_back(argument);
    }
  }
  if (styles.empty()) styles = {"charcoal", "graphite", "oil", "watercolour"};
  const scumble::Status done = scumble::Run(styles, folder);
  if (!done) return std::fprintf(stderr, "%s\n", done.error().message.c_str()), 1;
  return 0;
}
