// What can be asked of the pipeline: typed values with defaults. Applications parse text into them once
// (apps/cli/app/options.h does for the command line); nothing below reads a number out of text again.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "core/image/layers.h"
#include "core/image/status.h"
#include "core/style/style_file.h"
#include "core/style/style_override.h"
#include "finish/finish.h"
#include "guidegen/file_listener.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "measure/explain.h"
#include "pipeline/frame_rate.h"

namespace scumble {

class MemoryNeed;

// Pixels.
struct Size {
  int width = 0;
  int height = 0;

  bool operator==(const Size&) const = default;
};

// "1920x1080".
std::string SizeToText(const Size& size);

// Ok, or a kUsage error where a picture of this size cannot be made; `text` is what the user wrote.
Status CheckSize(const Size& size, const std::string& text);

// The guides' size for a picture of this size that is painted upsampled: both sides must be multiples of `upsample`,
// which is 1 … kMaxUpsampling. A kUsage error says which size would do.
Expected<Size> GuideSizeFor(const Size& size, int upsample);

// Whether a path has one of these endings (".exr"), in letters of either case.
bool HasEnding(const std::string& path, std::initializer_list<const char*> endings);

// How Blender is run for .blend scenes.
struct BlenderRequest {
  std::string program;       // a path, or a name looked up in PATH; empty: "blender"
  std::optional<int> frame;  // empty: the one that the file was saved at
  bool wants_start = false;  // BlenderAnimation::start in any case
  std::string scene;         // by name; empty: the one that was open when the file was saved
  std::string view_layer;    // by name; empty: the first one that is rendered
};

// Everything that turns a scene into guides.
struct SceneRequest {
  std::string scene;  // .glb .gltf .obj .ply .blend
  Size size{1280, 720};
  std::string camera;              // a name; empty: the scene's first
  std::optional<ViewAngles> view;  // instead of a camera
  int aa = 1;                      // N × N subsamples of the coverage, 1 … 16
  NormalFrame normal_frame = NormalFrame::kCamera;
  bool raw_normals = false;  // as GuidegenOptions::raw_normals
  std::string isa;           // as GuidegenOptions::isa
  bool robust = true;
  bool half = false;                          // colour layers as half floats
  BlenderRequest blender;                     // for .blend scenes
  std::optional<double> auto_smooth_degrees;  // of normals that the file lacks, as LoadOptions has it
  std::string animation;                      // of a glTF file with several, as AnimationOptions has it
  FileListener on_file = nullptr;             // what a .blend names is told when it has been exported; null: nobody
  std::optional<FrameRate> fps;               // empty: a .blend's own, otherwise FrameRate()
  // Light-path layers, as in GuidegenOptions.
  int samples = GuidegenOptions().samples;
  // Given samples are those of every pixel, and the most that noise or a time budget may take. Where they are not
  // given, luminance and shadow take as many as show, `samples` at most (kUnseenLightError).
  bool samples_given = false;
  int max_bounces = GuidegenOptions().max_bounces;
  double noise = 0.0;
  double time_budget_seconds = 0.0;
  std::uint64_t seed = 0;
  // Adds the memory that the run needs besides the guides, before any is allocated; null: none.
  std::function<void(const Size& size, const LayerSet& layers, MemoryNeed& need)> more_memory;
  bool key_light = true;             // let one shine where the file has no light and a layer needs some
  std::optional<LightAngles> light;  // one sun instead of the scene's lights and world; surfaces still glow
};

// A style and what a run changes of it.
struct StyleRequest {
  std::string style;                       // a folder, a style.toml, a picture of a sphere, or a bundled style's name
  std::vector<StyleOverride> sets;         // the later wins
  std::vector<std::string> assigned;       // "NAME=STYLE", or "@FILE" of such lines
  bool scene_styles = true;                // follow the property scumble_style of objects and materials
  std::vector<std::string> finishes = {};  // effects and presets after the styles' own; "none" drops those
  std::optional<FinishMeasures> finish_measures = {};  // instead of those of the first picture
  StyleReading reading = {};                           // as LoadStyle takes it
};

// What becomes of the paint: a picture file.
struct PictureRequest {
  std::string output;                // .png .tif .exr .jpg
  std::string over;                  // a picture underneath, of the same size; empty: none
  std::string over_view_layer = {};  // where `over` is a render of several
  int bits = 8;
  int png_level = 6;
  bool fast_io = false;
  std::optional<int> frame;
  std::optional<FrameRate> fps;    // empty: that of the guides, or FrameRate()
  std::optional<double> exposure;  // stops; empty: measured
  std::uint64_t seed = 0;
  int repeat = 1;                   // times to run the transfer, for the spread of its times
  int upsample = 1;                 // the picture is so many times as wide and high as the guides
  bool upscale = false;             // with upsample: it is painted at their size and scaled up; without `over`
  bool leave_small = false;         // with upscale: it is not scaled up, for who shows it larger himself
  std::optional<Explanation> show;  // this explanation instead of the picture
  std::string show_finish = {};     // what the finishing pass of this name does, instead of the picture; empty: none
  std::string layers_out = {};      // an .ora with the layers of the finish, besides the picture; empty: none
  bool measure_chunks = false;      // report coherence and chunks, for which the source field is kept
  bool keep_field = false;          // the source field is given away with the picture

  // Whether the source field outlives the transfer, which takes more time.
  bool KeepsField() const { return measure_chunks || keep_field || show.has_value(); }
  // Whether something else takes the place of the picture.
  bool IsShowing() const { return show.has_value() || !show_finish.empty(); }
  // Whether what is asked for has the size that is painted.
  bool IsOfPaintedSize() const { return IsShowing() || !layers_out.empty(); }
  // How many times the guides are upsampled, and the painted picture is scaled up.
  int GuideFactor() const { return upscale ? 1 : upsample; }
  int PictureFactor() const { return upscale && !leave_small ? upsample : 1; }
};

// That the options of a request fit together.
Status CheckPictureRequest(const PictureRequest& request);

// A range of frames.
struct SequenceRequest {
  std::vector<int> frames;  // empty: one picture, no sequence
  bool resume = false;
};

}  // namespace scumble
