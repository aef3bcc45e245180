#include "pipeline/quality/budget_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <span>
#include <utility>

#include "pipeline/variant/trial_painter.h"
#include "pipeline/file_cache.h"
#include "pipeline/quality/calibration.h"
#include "pipeline/machine.h"
#include "pipeline/memory/memory_estimate.h"
#include "pipeline/scene/needed_textures.h"
#include "pipeline/frame/provenance.h"
#include "apps/cli/app/progress_bar.h"
#include "pipeline/variant/quality_ladder.h"
#include "pipeline/run/run_inputs.h"
#include "pipeline/scene/scene_sequence.h"
#include "apps/cli/app/timing.h"
#include "pipeline/variant/variant_guides.h"
#include "core/image/hash.h"
#include "core/style/style_keyframes.h"

namespace scumble {
namespace {

const std::vector<std::string> kQualities = {"draft", "preview", "final"};

Quality QualityOf(const std::string& name) {
  if (name == "draft") return Quality::kDraft;
  return name == "preview" ? Quality::kPreview : Quality::kFinal;
}

// One frame by the way at a place of the ladder.
using PaintWay = std::function<Expected<double>(const Way& way)>;
struct Trials {
  PaintWay paint;  // milliseconds
  PaintWay judge;  // how far off the picture is: PaintTrial::Judge
};

FileCache TimesCache() { return FileCache(CacheFolder() ? *CacheFolder() / "times" : std::filesystem::path()); }

std::string WordsOf(const Way& way) {
  const std::string options = OptionsOf(way);
  return options.empty() ? "the style as it is" : options;
}

nlohmann::ordered_json OptionsJson(const Way& way) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  if (UpsampleOf(way) > 1) json.insert(json.end(), {"--upsample", std::to_string(UpsampleOf(way))});
  if (way.samples > 0) json.insert(json.end(), {"--samples", std::to_string(way.samples)});
  for (const std::string& setting : way.settings) json.insert(json.end(), {"--set", setting});
  return json;
}

Status Take(const Way& way, StyleSet& styles, PictureOptions& picture) {
  picture.upsample *= UpsampleOf(way);
  return ApplyWay(way, styles);
}

Way NamedWay(const BudgetOptions& options, const LadderFrame& frame, const StyleSet& styles, PictureOptions& picture,
             const Globals& globals) {
  const Way way = WayOf(QualityOf(options.quality), styles, frame);
  const bool as_it_is = OptionsOf(way).empty();
  Say(globals, fmt::format("quality {}: {}{}", options.quality, WordsOf(way), as_it_is ? "" : ", which repeats it"));
  picture.chosen["quality"] = {{"name", options.quality}, {"options", OptionsJson(way)}};
  return way;
}

Expected<Way> WayWithin(const BudgetOptions& options, const LadderFrame& frame, const std::string& circumstances,
                        const std::string& judged, const StyleSet& styles, PictureOptions& picture, const Globals& globals,
                        const Trials& trials) {
  const std::vector<Way> ways = QualityLadder(styles, frame);
  FileCache cache = TimesCache();
  Calibration calibration{circumstances, {}, &cache, options.recalibrate};
  for (const Way& way : ways) calibration.ways.push_back(way.name);
  calibration.judged = judged;
  const bool one_style = styles.styles.size() == 1 && styles.assigned.empty();  // of several no error is known
  for (std::size_t i = 0; one_style && i < ways.size(); ++i) {
    for (std::size_t j = i + 1; j < ways.size(); ++j) {
      if (AreRivals(ways[i], ways[j])) calibration.rivals[i] = j;
    }
  }
  ProgressBar bar("calibration", globals.quiet);
  const Progress progress = bar.Part(0.0, 1.0);
  // Each way once, the one that is taken nine times (its rival, if it has one, too), the last twice more for a cold start; and
  // two judgements.
  const double usual_runs = static_cast<double>(ways.size()) + kCalibrationRuns + 2.0 + 2.0;
  int runs = 0;
  const MeasureWay measure = [&](std::size_t place) {
    if (runs == 0) Say(globals, fmt::format("--budget-ms: measuring up to {} ways on this machine, once", ways.size()));
    const double done = std::min(0.99, runs++ / usual_runs);
    if (progress) progress(done);
    return trials.paint(ways[place]);
  };
  bool judges = false;
  const JudgeWay judge = [&](std::size_t place) {
    if (!std::exchange(judges, true)) {
      Say(globals, "--budget-ms: two ways fit whose order differs by style; which is nearer is measured here, once");
    }
    const double done = std::min(0.99, runs++ / usual_runs);
    if (progress) progress(done);
    return trials.judge(ways[place]);
  };
  SCUMBLE_ASSIGN(const PickedWay picked, PickWay(calibration, options.budget_ms, measure, judge));
  bar.Clear();
  EndStage(globals, "calibration");
  const Way& way = ways[picked.way];
  Say(globals,
      fmt::format("budget {:g} ms: at most {:.0f} ms, nine times of ten, with {}{}", options.budget_ms, std::ceil(picked.predicted_ms),
                  WordsOf(way), OptionsOf(way).empty() ? "" : ", which repeats it"));
  if (!picked.fits) {
    Warn(fmt::format("--budget-ms {:g}: nothing fits; the quickest way is taken, which needs about {:.0f} ms",
                     options.budget_ms, std::ceil(picked.predicted_ms)));
  }
  picture.chosen["budget"] = {{"ms", options.budget_ms},
                              {"picked", way.name},
                              {"predicted_ms", picked.predicted_ms},
                              {"fits", picked.fits},
                              {"measured_runs", picked.measured},
                              {"options", OptionsJson(way)}};
  for (const auto& [place, off] : picked.compared) {
    if (std::isfinite(off)) picture.chosen["budget"]["compared"][ways[place].name] = off;
  }
  return way;
}

// Of keys that change over time; 0 where none does.
std::uint64_t HashOfTracks(const StyleSet& styles) {
  std::uint64_t hash = 0;
  for (const Style& style : styles.styles) {
    for (const StyleTrack& track : style.tracks) {
      std::string text = track.name;
      for (const StyleTrack::Key& key : track.keys) {
        std::visit([&](const auto& value) { text += fmt::format("; {} {}", key.frame, value); }, key.value);
      }
      hash = Hash(hash, HashText(text), HashText(style.name));
    }
  }
  return hash;
}

// What times depend on in either verb, as text. Frames count by what the styles say of them alone: all frames of a scene are
// to look alike.
std::string CommonCircumstances(StyleSet& styles, const PictureOptions& picture, const Globals& globals) {
  ExemplarHashes hashes;
  const std::size_t all = styles.styles.size();
  const std::uint64_t tracks = HashOfTracks(styles);
  PictureSettings settings = SettingsOf(picture, {}, {}, {});
  settings.measured.reset();  // stops that were measured before take as long as those that are measured now
  return fmt::format("{}; {}{}{}{}{}", MachineName(globals.threads),
                     SettingsText(styles, settings, hashes),
                     all > styles.chosen ? fmt::format("; with the scene's {:016x}", HashOfStyles(styles, all, hashes)) : "",
                     styles.options.scene_styles ? "" : "; without the scene's styles",
                     tracks != 0 ? fmt::format("; over time {:016x}", tracks) : "",
                     KeepsField(picture, globals) ? "; keeps the field" : "");
}

// Of the scene's file and of those that it names. What cannot be read counts for nothing: who needs it says so.
std::uint64_t HashOfFiles(const std::string& scene) {
  RunFiles files;
  files.ReadsScene(scene);
  std::uint64_t hash = 0;
  std::vector<char> piece(std::size_t(1) << 20);
  for (const std::string& path : files.Inputs()) {
    std::ifstream stream(path, std::ios::binary);
    while (stream.read(piece.data(), std::streamsize(piece.size())) || stream.gcount() > 0) {
      hash = Hash(hash, HashBytes(std::span<const char>(piece).first(std::size_t(stream.gcount()))));
    }
  }
  return hash;
}

// Kept beside the times, as it takes reading the scene to know, and as little true as they are of what no circumstance tells:
// `anew` does not look there.
Expected<bool> KeptAnswer(const std::string& question, bool anew, const std::function<Expected<bool>()>& find) {
  FileCache cache = TimesCache();
  const auto bytes = anew ? std::nullopt : cache.Load(question);
  if (bytes && bytes->size() == 1) return bytes->front() != std::byte(0);
  SCUMBLE_ASSIGN(const bool answer, find());
  const std::byte byte{static_cast<unsigned char>(answer)};
  cache.Store(question, std::span(&byte, 1));
  return answer;
}

// What is opened when the first way is measured: the frame as the run will have it.
Expected<SceneAtRest> OpenToMeasure(const SceneOptions& options, std::optional<int> frame, StyleSet& styles,
                                    const Globals& globals) {
  const LayersFor layers = [&](const StyleWishes& wishes) { return RequiredLayers(styles, wishes, options.scene); };
  SCUMBLE_ASSIGN(SceneAtRest opened, OpenSceneAt(frame, options, layers, globals, false));
  MemoryNeed need;
  AddProgram(globals.threads, need);
  AddScene(opened.scene, CountNeededPixels(opened.scene, options, opened.layers), need);
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, globals, "make the scene or its textures smaller"));
  // Which is reading, and counts as little as that of the scene.
  SCUMBLE_RETURN_IF_ERROR(DecodeNeededTextures(opened.scene, options, opened.layers));
  return opened;
}

// What a picture of guides shows, which their size and coverage do not tell: their normals and light.
std::string PictureText(const GuideSet& guides, const PictureOptions& picture) {
  std::uint64_t hash = 0;
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kLuminance}) {
    if (!guides.Has(layer)) continue;
    const auto plane = guides.Plane(layer);
    hash = Hash(hash, HashText({reinterpret_cast<const char*>(plane.data()), plane.size_bytes()}));
  }
  return fmt::format("guides {:016x}, exposure {}", hash, picture.exposure);
}

}  // namespace

void AddBudgetOptions(CLI::App& verb, BudgetOptions& options, bool casts) {
  const std::string smaller = casts ? "smaller guides, fewer samples, " : "";
  const std::string wins = std::string("--set") + (casts ? ", --upsample and --samples" : " and --upsample") + " win over it";
  verb.add_option("--quality", options.quality,
                  "final: the style as it is; preview and draft take less time where there is much to take, by " + smaller +
                      "simpler ways to find the paint; what is taken is printed as options that repeat it. " + wins)
      ->type_name("NAME")
      ->check(CLI::IsMember(kQualities));
  verb.add_option(
          "--budget-ms", options.budget_ms,
          std::string("milliseconds that ") + (casts ? "the guides and the transfer" : "the transfer") +
              " of one picture may take, without start-up, reading, preparing the style and writing: of a dozen "
              "ways, ordered by what they cost in accuracy, the first that fits is taken, by times that are measured once on this "
              "machine and kept in the user's cache folder; one way for all frames; the options that repeat it are printed. " + wins)
      ->type_name("N")
      ->check(RefuseNoAmount("milliseconds, as 40"));
  verb.add_flag("--recalibrate", options.recalibrate, "with --budget-ms: measure anew");
}

Status CheckBudgetOptions(const CLI::App& verb, BudgetOptions& options) {
  options.guides_are_fixed = verb.count("--upsample") > 0;
  if (!options.quality.empty() && options.budget_ms > 0) {
    return UsageError("--quality " + options.quality + " and --budget-ms exclude each other: give one of them");
  }
  if (options.recalibrate && !(options.budget_ms > 0)) {
    return UsageError("--recalibrate is for --budget-ms: give both, or leave it out");
  }
  return Ok();
}

Status ChooseForGuides(const BudgetOptions& options, const GuideSet& guides, std::optional<int> frame,
                       const std::string& name, const std::string& over, StyleSet& styles, PictureOptions& picture, const Globals& globals) {
  if (!options.chooses()) return Ok();
  const LadderFrame ladder{false, guides.width(), guides.height(), true};
  if (!options.quality.empty()) return Take(NamedWay(options, ladder, styles, picture, globals), styles, picture);
  for (Style& style : styles.styles) SCUMBLE_RETURN_IF_ERROR(SetStyleFrame(style, frame.value_or(0)));
  const auto coverage = guides.Plane(Layer::kCoverage);
  const auto covered = std::count_if(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; });
  // Frames of one shot are alike: how much is covered counts in 64ths.
  const std::string circumstances =
      fmt::format("transfer; {}x{}; covered {:.0f}/64; layers {}; {}", guides.width(), guides.height(),
                  64.0 * double(covered) / double(std::max<std::size_t>(1, guides.pixel_count())),
                  guides.layers().ToString(), CommonCircumstances(styles, picture, globals));
  PaintTrial trial(styles, picture, frame, name, over, globals);
  SCUMBLE_ASSIGN(const Way way, WayWithin(options, ladder, circumstances, PictureText(guides, picture), styles, picture, globals,
                                          {[&](const Way& one) { return trial.Paint(one, guides); },
                                           [&](const Way& one) { return trial.Judge(one, guides); }}));
  return Take(way, styles, picture);
}

Status ChooseForScene(const BudgetOptions& options, SceneOptions& scene, std::optional<int> frame,
                      const std::string& over, StyleSet& styles, PictureOptions& picture, const Globals& globals) {
  if (!options.chooses()) return Ok();
  SCUMBLE_ASSIGN(const Size size, ParseSize(scene.size));
  // Named points do not look at the scene: where its light takes no samples, fewer make no difference.
  const bool may_have_fewer =
      !scene.samples_given && std::any_of(styles.styles.begin(), styles.styles.end(), AsksForLight);
  LadderFrame ladder{true, size.width, size.height, options.guides_are_fixed, may_have_fewer ? scene.samples : 0};
  const auto take = [&](const Way& way) {
    if (way.samples > 0) scene.samples = way.samples;
    return Take(way, styles, picture);
  };
  if (!options.quality.empty()) return take(NamedWay(options, ladder, styles, picture, globals));
  const std::string circumstances =
      fmt::format("stylize; scene {:016x}; {}; {}; isa {}; half {}; {}",
                  HashOfFiles(scene.scene), scene.size,
                  GuideSettings(scene), scene.isa, scene.half, CommonCircumstances(styles, picture, globals));
  Globals silent = globals;
  silent.quiet = true, silent.timing = nullptr;
  std::optional<SceneAtRest> opened;
  PaintTrial trial(styles, picture, frame, scene.scene, over, globals);
  const auto open = [&]() -> Status {
    if (opened) return Ok();
    SCUMBLE_ASSIGN(opened, OpenToMeasure(scene, frame, styles, silent));
    return Ok();
  };
  const auto needs_samples = [&]() -> Expected<bool> {
    SCUMBLE_RETURN_IF_ERROR(open());
    return NeedSamples(opened->scene, opened->layers, scene);
  };
  if (ladder.samples > 0) {
    SCUMBLE_ASSIGN(const bool needed, KeptAnswer("samples; " + circumstances, options.recalibrate, needs_samples));
    if (!needed) ladder.samples = 0;
  }
  double casting_ms = 0.0;
  const auto cast = [&](const Way& way) -> Expected<GuideSet> {
    SCUMBLE_RETURN_IF_ERROR(open());
    SceneOptions small = scene;
    small.size = fmt::format("{}x{}", size.width / UpsampleOf(way), size.height / UpsampleOf(way));
    if (way.samples > 0) small.samples = way.samples;
    Stopwatch watch;
    SCUMBLE_ASSIGN(SceneGuides made,
                   CastScene(opened->scene, opened->view.camera, nullptr, small, opened->layers, silent, {}, false));
    casting_ms = watch.Lap();
    return std::move(made.guides);
  };
  const PaintWay paint = [&](const Way& way) -> Expected<double> {
    SCUMBLE_ASSIGN(const GuideSet guides, cast(way));
    SCUMBLE_ASSIGN(const double painting, trial.Paint(way, guides));
    return casting_ms + painting;
  };
  const PaintWay judge = [&](const Way& way) -> Expected<double> {
    SCUMBLE_ASSIGN(const GuideSet guides, cast(way));
    return trial.Judge(way, guides);
  };
  SCUMBLE_ASSIGN(const Way way, WayWithin(options, ladder, circumstances, "exposure " + picture.exposure, styles, picture, globals,
                                          {paint, judge}));
  return take(way);
}

}  // namespace scumble
