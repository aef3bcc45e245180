#include "pipeline/tradeoff/peak_process.h"

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

#include "pipeline/finish_set.h"
#include "pipeline/scene/blender_process.h"
#include "pipeline/scene_guides.h"

namespace scumble {

namespace {

// What the process prints, with its number behind.
constexpr std::string_view kPeakLine = "{\"peak_bytes\": ";

}  // namespace

std::vector<std::pair<std::string, std::string>> FinishArguments(const TradeSetup& setup) {
  std::vector<std::pair<std::string, std::string>> given;
  for (const std::string& finish : setup.style.finishes) given.emplace_back("--finish", finish);
  if (setup.style.finish_measures) {
    given.emplace_back("--finish-measures", MeasuresText(*setup.style.finish_measures));
  }
  return given;
}

std::vector<std::pair<std::string, std::string>> SceneArguments(const TradeSetup& setup) {
  const SceneRequest& scene = setup.scene;
  std::vector<std::pair<std::string, std::string>> given;
  const SceneRequest usual;
  const auto add = [&](const char* option, const std::string& value, const std::string& usual_value) {
    if (value != usual_value) given.emplace_back(option, value);
  };
  add("--camera", scene.camera, usual.camera);
  if (scene.view) given.emplace_back("--view", ViewToText(*scene.view));
  if (scene.light) given.emplace_back("--light", LightToText(*scene.light));
  if (scene.auto_smooth_degrees) given.emplace_back("--auto-smooth", fmt::format("{}", *scene.auto_smooth_degrees));
  add("--aa", std::to_string(scene.aa), std::to_string(usual.aa));
  if (scene.normal_frame == NormalFrame::kEye) given.emplace_back("--normal-frame", "eye");
  add("--isa", scene.isa, usual.isa);
  add("--blender", scene.blender.program, usual.blender.program);
  add("--scene", scene.blender.scene, usual.blender.scene);
  add("--view-layer", scene.blender.view_layer, usual.blender.view_layer);
  if (setup.frame) given.emplace_back("--frame", std::to_string(*setup.frame));
  if (scene.fps) given.emplace_back("--fps", FrameRateToText(*scene.fps));
  add("--animation", scene.animation, usual.animation);
  if (setup.exposure) given.emplace_back("--exposure", fmt::format("{}", *setup.exposure));
  return given;
}

std::vector<std::string> TradeArguments(const TradeSetup& setup, const RunContext& context) {
  std::vector<std::string> words = {"tradeoff"};
  const auto add = [&](const std::string& option, const std::string& value) {
    words.push_back(option), words.push_back(value);
  };
  const std::string& scene = setup.scene.scene;
  words.push_back(scene.starts_with("-") ? "./" + scene : scene);
  add("--style", setup.style.style);
  for (const auto& [option, value] : FinishArguments(setup)) add(option, value);
  for (const StyleOverride& set : setup.style.sets) add("--set", ToText(set));
  add("--size", SizeToText(setup.scene.size));
  for (const auto& [option, value] : SceneArguments(setup)) words.push_back(option + "=" + value);
  if (setup.scene.samples_given) add("--samples", std::to_string(setup.scene.samples));
  if (setup.scene.max_bounces != SceneRequest().max_bounces)
    add("--max-bounces", std::to_string(setup.scene.max_bounces));
  if (setup.scene.seed != 0) add("--seed", std::to_string(setup.scene.seed));
  if (!setup.only.empty()) add("--only", setup.only);
  if (setup.repeats != TradeSetup().repeats) add("--repeat", std::to_string(setup.repeats));
  if (setup.quick) words.push_back("--quick");
  if (setup.scene.raw_normals) words.push_back("--raw-normals");
  if (!setup.memory) words.push_back("--no-memory");
  if (context.threads != 0) add("--threads", std::to_string(context.threads));
  if (context.max_memory > 0) add("--max-memory", std::to_string(context.max_memory));
  return words;
}

Expected<std::size_t> AskForPeak(const TradeSetup& setup, const std::string& variant, const RunContext& context) {
  const ScratchFolder scratch(context);
  if (scratch.path().empty()) return std::size_t(0);
  std::vector<std::string> words = {context.program.string()};
  for (std::string& word : TradeArguments(setup, context)) words.push_back(std::move(word));
  words.push_back("--peak-of=" + variant);
  words.push_back("--quiet");
  const std::filesystem::path log = scratch.path() / "log";
  const Expected<ProgramEnd> end = RunProgram(words, log, context);
  if (!end && end.error().kind == ErrorKind::kCancelled) return end.error();
  if (!end || end->code != 0) return std::size_t(0);
  for (const std::string& line : LinesOf(log)) {
    std::size_t bytes = 0;
    if (line.starts_with(kPeakLine) && std::sscanf(line.c_str() + kPeakLine.size(), "%zu", &bytes) == 1) return bytes;
  }
  return std::size_t(0);
}

}  // namespace scumble
