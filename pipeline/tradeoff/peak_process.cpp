#include "pipeline/tradeoff/peak_process.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/scene/blender_process.h"

namespace scumble {

std::vector<std::pair<std::string, std::string>> SceneArguments(const TradeSetup& setup) {
  const SceneOptions& scene = setup.scene;
  std::vector<std::pair<std::string, std::string>> given;
  const SceneOptions usual;
  const auto add = [&](const char* option, const std::string& value, const std::string& usual_value) {
    if (value != usual_value) given.emplace_back(option, value);
  };
  add("--camera", scene.camera, usual.camera);
  add("--view", scene.view, usual.view);
  add("--aa", std::to_string(scene.aa), std::to_string(usual.aa));
  add("--normal-frame", scene.normal_frame, usual.normal_frame);
  add("--isa", scene.isa, usual.isa);
  add("--blender", scene.blender.program, usual.blender.program);
  if (setup.frame) given.emplace_back("--frame", std::to_string(*setup.frame));
  add("--fps", scene.fps, usual.fps);
  add("--animation", scene.animation, usual.animation);
  add("--exposure", setup.exposure, TradeSetup().exposure);
  return given;
}

std::vector<std::string> TradeArguments(const TradeSetup& setup, const Globals& globals) {
  std::vector<std::string> words = {"tradeoff"};
  const auto add = [&](const std::string& option, const std::string& value) {
    words.push_back(option), words.push_back(value);
  };
  const std::string& scene = setup.scene.scene;
  words.push_back(scene.starts_with("-") ? "./" + scene : scene);
  add("--style", setup.style.style);
  for (const std::string& set : setup.style.sets) add("--set", set);
  add("--size", setup.scene.size);
  for (const auto& [option, value] : SceneArguments(setup)) words.push_back(option + "=" + value);
  if (setup.scene.samples != SceneOptions().samples) add("--samples", std::to_string(setup.scene.samples));
  if (setup.scene.max_bounces != SceneOptions().max_bounces)
    add("--max-bounces", std::to_string(setup.scene.max_bounces));
  if (setup.scene.seed != 0) add("--seed", std::to_string(setup.scene.seed));
  if (!setup.only.empty()) add("--only", setup.only);
  if (setup.repeats != TradeSetup().repeats) add("--repeat", std::to_string(setup.repeats));
  if (setup.quick) words.push_back("--quick");
  if (!setup.memory) words.push_back("--no-memory");
  if (globals.threads != 0) add("--threads", std::to_string(globals.threads));
  if (globals.max_memory > 0) add("--max-memory", std::to_string(globals.max_memory));
  return words;
}

Expected<std::size_t> AskForPeak(const TradeSetup& setup, const std::string& way, const Globals& globals) {
  const ScratchFolder scratch;
  if (scratch.path().empty()) return std::size_t(0);
  std::error_code failed;
  std::vector<std::string> words = {std::filesystem::read_symlink("/proc/self/exe", failed).string()};
  if (failed) return std::size_t(0);
  for (std::string& word : TradeArguments(setup, globals)) words.push_back(std::move(word));
  words.push_back("--peak-of=" + way);
  words.push_back("--quiet");
  const std::filesystem::path log = scratch.path() / "log";
  const Expected<ProgramEnd> end = RunProgram(words, log);
  SCUMBLE_RETURN_IF_ERROR(CheckNotSignalled(setup.scene.scene));
  if (!end || end->code != 0) return std::size_t(0);
  for (const std::string& line : LinesOf(log)) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_object() && json.contains("peak_bytes")) return json["peak_bytes"].get<std::size_t>();
  }
  return std::size_t(0);
}

}  // namespace scumble
