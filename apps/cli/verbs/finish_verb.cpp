// scumble finish.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/cli/app/command.h"
#include "apps/cli/app/frame_report.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/picture_options.h"
#include "core/style/finish_keys.h"
#include "pipeline/finish_set.h"
#include "pipeline/frame_rate.h"
#include "pipeline/run_finish.h"

namespace scumble {
namespace {

struct FinishVerb {
  FinishRequest request;
  SequenceOptions sequence;
  bool list = false;
  std::vector<std::string> sets;
  std::string show, fps;
};

std::string EffectsToText(const std::vector<FinishPreset>& presets) {
  std::string text = "presets\n";
  for (const FinishPreset& preset : presets) text += fmt::format("  {:<16} {}\n", preset.name, preset.help);
  text += "effects\n";
  for (const FinishEffect& effect : FinishEffects()) text += fmt::format("  {:<16} {}\n", effect.name, effect.help);
  return text + "keys of every effect, and with `scumble finish --list --finish NAME` of one\n";
}

std::string KeysToText(std::span<const FinishKey> keys) {
  std::string text;
  for (const FinishKey& key : keys)
    text += fmt::format("  {:<16} {:<12} {}\n", key.name, key.default_value,
                        key.help + (key.choices.empty() ? "" : fmt::format(": {}", fmt::join(key.choices, ", "))));
  return text;
}

// What a preset sets, as TOML would.
std::string PresetToText(const FinishPreset& preset) {
  std::string text = preset.help + "\n";
  for (std::size_t i = 0; i < preset.passes.size(); ++i) {
    text += fmt::format("  {:<16} {}", preset.passes[i].name, FinishText(preset.passes[i]));
    for (const FinishChain::Track& track : preset.tracks) {
      if (track.pass == i) text += fmt::format("; {}={}", track.keys.name, ToText(track.keys));
    }
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json KeysToJson(std::span<const FinishKey> keys) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const FinishKey& key : keys) {
    json.push_back({{"name", key.name}, {"default", key.default_value}, {"help", key.help}});
    if (!key.choices.empty()) json.back()["choices"] = key.choices;
    if (key.most > key.least) json.back()["least"] = key.least, json.back()["most"] = key.most;
  }
  return json;
}

std::string ToJson(const std::vector<FinishPreset>& presets) {
  nlohmann::ordered_json json;
  json["presets"] = nlohmann::ordered_json::array();
  for (const FinishPreset& preset : presets) {
    json["presets"].push_back({{"name", preset.name}, {"help", preset.help}});
    for (const FinishPass& pass : preset.passes)
      json["presets"].back()["passes"].push_back({{"name", pass.name}, {"effect", EffectOf(pass).name}});
  }
  json["effects"] = nlohmann::ordered_json::array();
  for (const FinishEffect& effect : FinishEffects())
    json["effects"].push_back({{"name", effect.name}, {"help", effect.help}, {"keys", KeysToJson(effect.keys)}});
  json["common_keys"] = KeysToJson(CommonFinishKeys());
  return json.dump(2) + "\n";
}

Expected<ExitCode> ListFinish(const FinishVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(const std::vector<FinishPreset> presets, FinishPresets(globals));
  if (globals.json) return Print(ToJson(presets)), ExitCode::kOk;
  if (verb.request.finishes.empty()) {
    Print(EffectsToText(presets) + KeysToText(CommonFinishKeys()));
    return ExitCode::kOk;
  }
  for (const std::string& name : verb.request.finishes) {
    if (const FinishEffect* effect = FindFinishEffect(name)) {
      Print(fmt::format("{}: {}\n", name, effect->help) + KeysToText(effect->keys));
      continue;
    }
    const auto preset = std::find_if(presets.begin(), presets.end(), [&](const auto& one) { return one.name == name; });
    if (preset == presets.end()) {
      SCUMBLE_RETURN_IF_ERROR(OpenFinish({name}, globals));  // says what there is
      SCUMBLE_ASSIGN(const FinishPreset file, LoadFinishPreset(name));
      Print(fmt::format("{}: {}", name, PresetToText(file)));
    } else {
      Print(fmt::format("{}: {}", name, PresetToText(*preset)));
    }
  }
  return ExitCode::kOk;
}

Expected<ExitCode> RunFinishVerb(const FinishVerb& verb, const Globals& globals) {
  if (verb.list) return ListFinish(verb, globals);
  if (verb.request.picture.empty()) return UsageError("scumble finish: name a picture, or give --list");
  if (verb.request.finishes.empty()) {
    return UsageError("scumble finish: --finish NAME is required; `scumble finish --list` names what there is");
  }
  if (verb.request.output.empty()) return UsageError("scumble finish: -o FILE is required");
  FinishRequest request = verb.request;
  for (const std::string& text : verb.sets) {
    SCUMBLE_ASSIGN(StyleOverride set, ParseOverride(text));
    request.sets.push_back(std::move(set));
  }
  request.show_finish = ShownFinish(verb.show);
  if (!verb.fps.empty()) {
    SCUMBLE_ASSIGN(request.fps, ParseFrameRate(verb.fps));
  }
  SCUMBLE_ASSIGN(request.sequence, ToRequest(verb.sequence));
  SequencePrinter printer(globals);
  SCUMBLE_ASSIGN(const RunReport report, RunFinish(std::move(request), printer.Listener(), globals));
  return PrintRun(report, globals, printer);
}

}  // namespace

void AddFinishVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<FinishVerb>();
  FinishRequest& request = verb->request;
  CLI::App* sub = app.add_subcommand("finish", "picture + guides -> picture: outlines, shade, tones, depth; --list");
  sub->add_option("picture", request.picture, "a picture of any renderer")->type_name("PICTURE");
  sub->add_option("guides", request.guides, "its guides, of the same size: .exr; for effects that read none left out")
      ->type_name("GUIDES");
  AddFinishOptions(*sub, request.finishes, request.measures);
  sub->add_option("--set", verb->sets, "change a key of an effect, as finish.outline.width=4; repeatable")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub->add_flag("--list", verb->list, "list presets, effects and their keys; with --finish NAME, those of one");
  sub->add_option("-o,--output", request.output, "picture to write: .png, .tif, .exr or .jpg")->type_name("FILE");
  AddShowOptions(*sub, verb->show, request.layers_out, false);
  sub->add_option("--view-layer", request.view_layer, "which view layer of a multilayer file")->type_name("NAME");
  sub->add_option("--light-layer", request.light_layer,
                  "the view layer of a Blender render whose passes of light are taken; left out: that of all else")
      ->type_name("NAME");
  sub->add_option("--camera", request.camera,
                  "the .camera file of a Blender render; left out: found from its Position pass")
      ->type_name("FILE");
  sub->add_option("--reference-height", request.reference_height,
                  "lengths are pixels at this height of the picture; 0: plain pixels")
      ->type_name("N")
      ->check(CLI::Range(0, 32768))
      ->capture_default_str();
  sub->add_option("--bits", request.bits,
                  "bits a channel: 8 or 16 for .png and .tif; .exr takes 16, half floats, or 32, floats")
      ->type_name("N")
      ->check(CLI::IsMember({8, 16, 32}))
      ->capture_default_str();
  sub->add_option("--png-level", request.png_level, "PNG compression, 0 fast to 9 small")
      ->type_name("N")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  AddFastIoOption(*sub, request.fast_io);
  sub->add_option("--frame", request.frame,
                  "the number for #### in the names, for keys that change over time, and for jitter_fps")
      ->type_name("N");
  AddFpsOption(*sub, verb->fps,
               "frames a second, as 24 or 24000/1001, for jitter_fps; left out: the guides' own, or 24");
  sub->add_option("--seed", request.seed, "another seed, another wobble; the same seed, the same bytes")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  AddSequenceOptions(*sub, verb->sequence);
  AddTimingOption(*sub, globals);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunFinishVerb(*verb, globals); }; });
}

}  // namespace scumble
