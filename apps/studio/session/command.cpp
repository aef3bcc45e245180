#include <fmt/format.h>

#include "apps/studio/session/state.h"
#include "pipeline/scene_guides.h"
#include "pipeline/shell_quote.h"

namespace scumble {
namespace {

// An option that differs from what the command line takes without it.
class CommandLine {
 public:
  explicit CommandLine(std::string start) : text_(std::move(start)) {}
  void Word(const std::string& word) { text_ += " " + Quoted(word); }
  void Option(const std::string& name, const std::string& value) { text_ += " " + name + " " + Quoted(value); }
  template <class T>
  void Changed(const std::string& name, const T& value, const T& usual) {
    if (value != usual) Option(name, fmt::format("{}", value));
  }
  void Flag(const std::string& name, bool is_set) {
    if (is_set) text_ += " " + name;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void AddScene(const SceneRequest& scene, CommandLine& line) {
  const SceneRequest usual;
  line.Option("--size", SizeToText(scene.size));
  if (scene.view) line.Option("--view", ViewToText(*scene.view));
  line.Changed("--camera", scene.camera, usual.camera);
  if (scene.light) line.Option("--light", LightToText(*scene.light));
  line.Changed("--aa", scene.aa, usual.aa);
  if (scene.normal_frame != usual.normal_frame) line.Option("--normal-frame", "eye");
  line.Flag("--raw-normals", scene.raw_normals);
  line.Changed("--isa", scene.isa, usual.isa);
  line.Flag("--half", scene.half);
  if (scene.auto_smooth_degrees) line.Option("--auto-smooth", fmt::format("{}", *scene.auto_smooth_degrees));
  line.Changed("--animation", scene.animation, usual.animation);
  line.Changed("--blender", scene.blender.program, usual.blender.program);
  line.Changed("--scene", scene.blender.scene, usual.blender.scene);
  line.Changed("--view-layer", scene.blender.view_layer, usual.blender.view_layer);
  if (scene.samples_given) line.Option("--samples", fmt::format("{}", scene.samples));
  line.Changed("--max-bounces", scene.max_bounces, usual.max_bounces);
}

}  // namespace

std::string CommandOf(const PictureJob& job, const std::vector<std::string>& chosen) {
  CommandLine line("scumble stylize");
  line.Word(job.scene.scene);
  line.Option("--style", job.style.style);
  for (const std::string& word : chosen) line.Word(word);  // a later --set of the style's keys wins over it
  for (const StyleOverride& set : job.style.sets) line.Option("--set", ToText(set));
  for (const std::string& assigned : job.style.assigned) line.Option("--assign", assigned);
  for (const std::string& finish : job.style.finishes) line.Option("--finish", finish);
  AddScene(job.scene, line);
  if (job.picture.frame) line.Option("--frame", fmt::format("{}", *job.picture.frame));
  if (job.picture.fps) line.Option("--fps", FrameRateToText(*job.picture.fps));
  line.Changed("--seed", job.picture.seed, PictureRequest().seed);
  if (job.budget.quality) line.Option("--quality", QualityNames()[std::size_t(*job.budget.quality)]);
  line.Option("-o", "picture.png");
  return line.text();
}

}  // namespace scumble
