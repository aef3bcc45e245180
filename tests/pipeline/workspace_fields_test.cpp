// Every field of a request: a workspace that has painted another request paints what a fresh one paints.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/workspace.h"
#include "tests/pipeline/workspace_fixtures.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

struct Request {
  SceneRequest scene;
  StyleRequest style;
  PictureRequest picture;
};

struct Change {
  const char* field;
  std::function<void(Request&)> make;
  bool shows = true;  // in the picture
};

// A style that looks at light, a finish that looks at depths, and a moving scene.
Request Base(const TemporaryFolder& folder) {
  Request base;
  base.scene.scene = kSource + "/scenes/toys.glb";
  base.scene.size = {48, 28};
  base.scene.samples = 2, base.scene.samples_given = true;
  base.style = StyleOf((folder / "style").string());
  base.style.finishes = {"storybook"};
  base.picture.over = (folder / "over.exr").string(), base.picture.over_view_layer = "Front";
  base.picture.frame = 3;
  return base;
}

// Two small exemplars, of light and of shade.
void WriteStyle(const fs::path& folder) {
  fs::create_directory(folder);
  std::ofstream(folder / "style.toml") << "[transfer]\nreference_height = 0\n[[exemplar]]\nimage = \"lit.png\"\n"
                                          "luminance = 0.8\nfills = true\n[[exemplar]]\nimage = \"shade.png\"\n"
                                          "luminance = 0.2\nfills = true\n";
  Picture paint(64, 64);
  for (const char* name : {"lit.png", "shade.png"}) {
    for (std::size_t i = 0; i < paint.rgba.size(); ++i)
      paint.rgba[i] =
          i % 4 == 3 ? 65535 : std::uint16_t((name[0] == 'l' ? 40000 : 5000) + (i * 2654435761u >> 12) % 20000);
    ASSERT_TRUE(WritePicture(folder / name, paint));
  }
}

// A render of two view layers in parts of their own.
void WriteOver(const std::string& file) {
  std::vector<OIIO::ImageSpec> specs;
  for (const std::string name : {"Front", "Back"}) {
    OIIO::ImageSpec spec(48, 28, 4, OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (const char* channel : {"R", "G", "B", "A"}) spec.channelnames.push_back(name + ".Combined." + channel);
    spec.attribute("oiio:subimagename", name);
    specs.push_back(spec);
  }
  const auto output = OIIO::ImageOutput::create(file);
  ASSERT_TRUE(output && output->open(file, 2, specs.data()));
  for (int part = 0; part < 2; ++part) {
    ASSERT_TRUE(part == 0 || output->open(file, specs[1], OIIO::ImageOutput::AppendSubimage));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(48 * 28 * 4, part ? 0.2f : 1.0f).data()));
  }
  ASSERT_TRUE(output->close());
}

// The names of all fields: one that is new does not compile until it stands here, and below.
void NameFields(const Request& request) {
  [[maybe_unused]] const auto& [scene, size, camera, view, aa, normal_frame, raw_normals, isa, robust, half, blender,
                                auto_smooth, animation, on_file, scene_fps, samples, samples_given, max_bounces, noise,
                                time_budget, scene_seed, more_memory, key_light, light] = request.scene;
  [[maybe_unused]] const auto& [style, sets, assigned, scene_styles, finishes, finish_measures, reading] =
      request.style;
  [[maybe_unused]] const auto& [output, over, over_view_layer, bits, png_level, fast_io, frame, fps, exposure, seed,
                                repeat, upsample, upscale, leave_small, show, show_finish, layers_out, measure_chunks,
                                keep_field] = request.picture;
}

// But for callbacks, Blender's settings, a budget of time, whose picture no run repeats, and what Paint takes from the
// picture: the scene's seed and rate.
std::vector<Change> Changes(const std::string& other_over) {
  return {
      {"scene", [](Request& r) { r.scene.scene = kSource + "/scenes/suzanne.glb", r.picture.frame.reset(); }},
      {"size",
       [](Request& r) {
         r.scene.size = {64, 36}, r.picture.over.clear();
       }},
      {"camera", [](Request& r) { r.scene.camera = "Camera"; }, false},
      {"view",
       [](Request& r) {
         r.scene.view = ViewAngles{70.0, 10.0};
       }},
      {"aa", [](Request& r) { r.scene.aa = 2; }},
      {"normal_frame", [](Request& r) { r.scene.normal_frame = NormalFrame::kEye; }},
      {"raw_normals", [](Request& r) { r.scene.raw_normals = true; }},
      {"isa", [](Request& r) { r.scene.isa = "sse2"; }, false},
      {"robust", [](Request& r) { r.scene.robust = false; }, false},
      {"half", [](Request& r) { r.scene.half = true; }},
      {"auto_smooth", [](Request& r) { r.scene.auto_smooth_degrees = 30.0; }, false},
      {"animation", [](Request& r) { r.scene.animation = "*"; }, false},
      {"samples", [](Request& r) { r.scene.samples = 7; }, false},
      {"samples_given", [](Request& r) { r.scene.samples_given = false; }, false},
      {"max_bounces",
       [](Request& r) { r.scene.max_bounces = 1, r.style.sets = *ParseStyleOverrides({"finish.shadows.full=0.2"}); }},
      {"noise", [](Request& r) { r.scene.noise = 0.5; }, false},
      {"key_light", [](Request& r) { r.scene.key_light = false; }, false},
      {"light",
       [](Request& r) {
         r.scene.light = LightAngles{60.0, 10.0};
       }},
      {"style", [](Request& r) { r.style.style = "pastel"; }},
      {"sets", [](Request& r) { r.style.sets = *ParseStyleOverrides({"transfer.threshold=0.5"}); }},
      {"assigned", [](Request& r) { r.style.assigned = {"*=oil"}; }},
      {"scene_styles", [](Request& r) { r.style.scene_styles = false; }, false},
      {"finishes", [](Request& r) { r.style.finishes = {"noir"}; }},
      {"finish_measures",
       [](Request& r) {
         r.style.finish_measures = {1.0, 2.0, 3.0, 0.2, 0.3};
       }},
      {"over", [&](Request& r) { r.picture.over = other_over, r.style.assigned = {"*=rendered"}; }},
      {"over_view_layer", [](Request& r) { r.picture.over_view_layer = "Back"; }},
      {"bits", [](Request& r) { r.picture.bits = 16; }, false},
      {"png_level", [](Request& r) { r.picture.png_level = 1; }, false},
      {"frame", [](Request& r) { r.picture.frame = 9; }},
      {"fps",
       [](Request& r) {
         r.picture.fps = FrameRate{6, 1};
       }},
      {"exposure", [](Request& r) { r.picture.exposure = 2.0; }},
      {"seed", [](Request& r) { r.picture.seed = 9; }},
      {"repeat", [](Request& r) { r.picture.repeat = 2; }, false},
      {"upsample", [](Request& r) { r.picture.upsample = 2; }},
      {"upscale", [](Request& r) { r.picture.upsample = 2, r.picture.upscale = true, r.picture.over.clear(); }},
      {"leave_small",
       [](Request& r) {
         r.picture.upsample = 2, r.picture.upscale = r.picture.leave_small = true, r.picture.over.clear();
       }},
      {"show", [](Request& r) { r.picture.show = Explanation::kChunks; }},
      {"show_finish", [](Request& r) { r.picture.show_finish = "ink"; }},
      {"measure_chunks", [](Request& r) { r.picture.measure_chunks = true; }, false},
      {"keep_field", [](Request& r) { r.picture.keep_field = true; }, false},
  };
}

TEST(Workspace, EveryChangedFieldCounts) {
  const TemporaryFolder folder;
  const std::string other = (folder / "other.png").string();
  ASSERT_NO_FATAL_FAILURE(WriteOver((folder / "over.exr").string()));
  ASSERT_NO_FATAL_FAILURE(WriteStyle(folder / "style"));
  ASSERT_TRUE(WritePicture(other, Picture(48, 28)));
  const Request base = Base(folder);
  NameFields(base);
  Workspace workspace(Context());
  const auto paint = [](Workspace& with, const Request& request) {
    auto painted = with.Paint(request.scene, request.style, request.picture);
    EXPECT_TRUE(painted.ok()) << painted.error().message;
    return painted ? std::pair(painted->picture.rgba, painted->write.settings)
                   : decltype(std::pair(painted->picture.rgba, painted->write.settings))();
  };
  const auto before = paint(workspace, base);
  for (const Change& change : Changes(other)) {
    SCOPED_TRACE(change.field);
    Request changed = base;
    change.make(changed);
    Workspace fresh(Context());
    const auto wanted = paint(fresh, changed), kept = paint(workspace, changed);
    EXPECT_TRUE(kept.first == wanted.first) << "another picture";
    EXPECT_EQ(kept.second, wanted.second);
    EXPECT_EQ(wanted.first != before.first, change.shows);
    EXPECT_TRUE(paint(workspace, base) == before) << "and back";
  }
}

}  // namespace
}  // namespace scumble
