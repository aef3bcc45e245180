#include "pipeline/budget_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

#include "core/image/hash.h"
#include "core/image/stopwatch.h"
#include "core/style/style_keyframes.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/machine/file_cache.h"
#include "pipeline/machine/machine.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/scene/needed_textures.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/stage_clock.h"
#include "pipeline/variant/calibration.h"
#include "pipeline/variant/quality_ladder.h"
#include "pipeline/variant/trial_painter.h"
#include "pipeline/variant/variant_guides.h"

namespace scumble {
namespace {

// About as many samples of luminance and shadow as pixels choose, at most, in the mean of a picture.
constexpr int kChosenSamples = 16;

// Milliseconds that one frame takes by a variant of the ladder.
using PaintVariant = std::function<Expected<double>(const Variant& variant)>;

FileCache TimesCache(const RunContext& context) {
  return FileCache(context.cache_folder.empty() ? std::filesystem::path() : context.cache_folder / "times");
}

std::string WordsOf(const Variant& variant) {
  const std::string options = OptionsOf(variant);
  return options.empty() ? "the style as it is" : options;
}

std::vector<std::string> OptionsListOf(const Variant& variant) {
  std::vector<std::string> options;
  const auto add = [&](const char* option, const std::string& value) {
    options.push_back(option), options.push_back(value);
  };
  if (UpsampleOf(variant) > 1) add("--upsample", std::to_string(UpsampleOf(variant)));
  if (variant.upscale) options.emplace_back("--upscale");
  if (variant.samples > 0) add("--samples", std::to_string(variant.samples));
  for (const StyleOverride& setting : variant.settings) add("--set", setting.text);
  return options;
}

Status Take(const Variant& variant, StyleSet& styles, PictureRequest& picture) {
  picture.upsample *= UpsampleOf(variant);
  picture.upscale = picture.upscale || variant.upscale;
  return ApplyVariant(variant, styles);
}

Variant NamedVariant(Quality quality, const LadderFrame& frame, const StyleSet& styles, const RunContext& context,
                     BudgetChoice& choice) {
  const Variant variant = VariantOf(quality, styles, frame);
  const bool as_it_is = OptionsOf(variant).empty();
  choice.quality = QualityNames()[std::size_t(quality)];
  choice.options = OptionsListOf(variant);
  context.Note(
      fmt::format("quality {}: {}{}", *choice.quality, WordsOf(variant), as_it_is ? "" : ", which repeats it"));
  return variant;
}

Expected<Variant> VariantWithin(const BudgetRequest& options, const LadderFrame& frame,
                                const std::string& circumstances, const StyleSet& styles, const RunContext& context,
                                const PaintVariant& paint, BudgetChoice& choice) {
  const std::vector<Variant> variants = QualityLadder(styles, frame);
  FileCache cache = TimesCache(context);
  Calibration calibration{circumstances, {}, &cache, options.recalibrate};
  for (const Variant& variant : variants) {
    if (!variant.upscale) calibration.cold = calibration.variants.size();  // which touches a whole picture's memory
    calibration.variants.push_back(variant.name);
  }
  Progress progress = context.StartProgress("calibration");
  // Each variant once; the one that is taken nine times; one twice more for a cold start.
  const double usual_runs = static_cast<double>(variants.size()) + kCalibrationRuns + 2.0;
  int runs = 0;
  const auto begin_run = [&]() -> Status {
    SCUMBLE_RETURN_IF_ERROR(context.CheckNotCancelled());
    const double done = std::min(0.99, runs++ / usual_runs);
    return progress && !progress(done) ? Status(CancelledError()) : Ok();
  };
  const MeasureVariant measure = [&](std::size_t place) -> Expected<double> {
    if (runs == 0)
      context.Note(fmt::format("--budget-ms: measuring up to {} variants on this machine", variants.size()));
    SCUMBLE_RETURN_IF_ERROR(begin_run());
    return paint(variants[place]);
  };
  SCUMBLE_ASSIGN(const PickedVariant picked, PickVariant(calibration, options.budget_ms, measure));
  progress = nullptr;
  context.EndStage("calibration");
  const Variant& variant = variants[picked.variant];
  context.Note(fmt::format("budget {:g} ms: at most {:.0f} ms, 19 times of 20, with {}{}", options.budget_ms,
                           std::ceil(picked.predicted_ms), WordsOf(variant),
                           OptionsOf(variant).empty() ? "" : ", which repeats it"));
  if (!picked.fits) {
    context.Warn(fmt::format(
        "--budget-ms {:g}: nothing fits; one of the quickest variants is taken, which needs about {:.0f} ms{}",
        options.budget_ms, std::ceil(picked.predicted_ms),
        picked.measured == 0 ? " by times of an earlier run; --recalibrate measures them again" : ""));
  }
  choice.budget_ms = options.budget_ms;
  choice.picked = variant.name;
  choice.predicted_ms = picked.predicted_ms;
  choice.fits = picked.fits;
  choice.measured_runs = picked.measured;
  choice.options = OptionsListOf(variant);
  return variant;
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

// What times depend on, of guides in a file and of a scene alike, as text. A frame counts only by what the styles say
// of it: all frames of a scene are taken to be alike.
std::string CommonCircumstances(StyleSet& styles, const PictureRequest& picture, const RunContext& context) {
  ExemplarHashes hashes;
  const std::size_t all = styles.styles.size();
  const std::uint64_t tracks = HashOfTracks(styles);
  PictureSettings settings = SettingsOf(picture, {}, {}, "", "");
  settings.measured.reset();  // stops that were measured before take as long as those that are measured now
  return fmt::format(
      "{}; {}{}{}{}{}", MachineName(context.threads), SettingsText(styles, settings, hashes),
      all > styles.chosen ? fmt::format("; with the scene's {:016x}", HashOfStyles(styles, all, hashes)) : "",
      styles.options.scene_styles ? "" : "; without the scene's styles",
      tracks != 0 ? fmt::format("; over time {:016x}", tracks) : "", picture.KeepsField() ? "; keeps the field" : "");
}

// Of what is in files, whose names end in zeros. What cannot be read counts for nothing; the run that needs it reports
// it.
std::uint64_t HashOfFiles(std::string_view names) {
  std::uint64_t hash = 0;
  std::vector<char> piece(std::size_t(1) << 20);
  for (; !names.empty(); names.remove_prefix(names.find('\0') + 1)) {
    std::ifstream stream(std::string(names.substr(0, names.find('\0'))), std::ios::binary);
    while (stream.read(piece.data(), std::streamsize(piece.size())) || stream.gcount() > 0) {
      hash = Hash(hash, HashBytes(std::span<const char>(piece).first(std::size_t(stream.gcount()))));
    }
  }
  return hash;
}

std::string KeyOf(const std::string& question) { return fmt::format("answer-{:016x}", HashText(question)); }

// An answer that takes reading the scene; it is kept beside the times. With `anew` the kept one does not count.
Expected<bool> KeptAnswer(const std::string& question, bool anew, const RunContext& context,
                          const std::function<Expected<bool>()>& find) {
  FileCache cache = TimesCache(context);
  const auto bytes = anew ? std::nullopt : cache.Load(KeyOf(question));
  if (bytes && bytes->size() == 1) return bytes->front() != std::byte(0);
  SCUMBLE_ASSIGN(const bool answer, find());
  const std::byte byte{static_cast<unsigned char>(answer)};
  cache.Store(KeyOf(question), std::span(&byte, 1));
  return answer;
}

// What is opened when the first variant is measured: the frame as the run will have it.
Expected<StaticScene> OpenToMeasure(const SceneRequest& options, std::optional<int> frame, StyleSet& styles,
                                    const RunContext& context) {
  const LayersFor layers = [&](const SceneStyleRequests& of_scene) {
    return RequiredLayers(styles, of_scene, options.scene);
  };
  SCUMBLE_ASSIGN(StaticScene opened, OpenSceneAt(frame, options, layers, context, false));
  MemoryNeed need;
  AddProgram(context.threads, need);
  AddScene(opened.scene, CountNeededPixels(opened.scene, options, opened.layers), need);
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, context, "make the scene or its textures smaller"));
  // Which is reading, and counts as little as that of the scene.
  SCUMBLE_RETURN_IF_ERROR(DecodeNeededTextures(opened.scene, options, opened.layers, context));
  return opened;
}

void TakeSamples(const Variant& variant, SceneRequest& scene) {
  if (variant.samples > 0) scene.samples = variant.samples, scene.samples_given = true;
}

// Casts and paints a frame of a scene by any variant. The scene is opened for the first one. All that is given outlives
// it.
class SceneTrials {
 public:
  SceneTrials(const SceneRequest& scene, std::optional<int> frame, const std::string& over, StyleSet& styles,
              const PictureRequest& picture, const RunContext& context)
      : request_(scene),
        frame_(frame),
        styles_(styles),
        silent_(context.WithoutNotes()),
        files_key_(KeyOf("files of " + std::filesystem::absolute(scene.scene).string())),
        painter_(styles, picture, frame, scene.scene, over, context) {}

  using Needs = bool(const Scene&, const LayerSet&, const SceneRequest&);
  Expected<bool> Asks(Needs* needs) {
    SCUMBLE_RETURN_IF_ERROR(Open());
    return needs(opened_->scene, opened_->layers, request_);
  }

  // Of all files that the scene consists of. They are known when it has been opened; their names are kept beside the
  // times. Where one of them changes, what is kept is not found again, and the scene is opened.
  Expected<std::uint64_t> FilesHash() {
    const auto kept = TimesCache(silent_).Load(files_key_);
    if (kept) return HashOfFiles({reinterpret_cast<const char*>(kept->data()), kept->size()});
    SCUMBLE_RETURN_IF_ERROR(Open());
    return HashOfFiles(files_);
  }

  // Milliseconds of casting and painting.
  Expected<double> Paint(const Variant& variant) {
    double casting_ms = 0.0;
    SCUMBLE_ASSIGN(const GuideSet guides, Cast(variant, casting_ms));
    SCUMBLE_ASSIGN(const double painting_ms, painter_.Paint(variant, guides));
    return casting_ms + painting_ms;
  }

 private:
  Status Open() {
    if (opened_) return Ok();
    SceneRequest request = request_;
    request.on_file = [&](const std::filesystem::path& file) {
      files_ += std::filesystem::absolute(file).string() + '\0';
      if (request_.on_file) request_.on_file(file);
    };
    SCUMBLE_ASSIGN(opened_, OpenToMeasure(request, frame_, styles_, silent_));
    TimesCache(silent_).Store(files_key_, std::as_bytes(std::span(files_)));
    return Ok();
  }

  Expected<GuideSet> Cast(const Variant& variant, double& casting_ms) {
    SCUMBLE_RETURN_IF_ERROR(Open());
    SceneRequest small = request_;
    small.size = {request_.size.width / UpsampleOf(variant), request_.size.height / UpsampleOf(variant)};
    TakeSamples(variant, small);
    Stopwatch watch;
    SCUMBLE_ASSIGN(SceneGuides made,
                   CastScene({opened_->scene, opened_->view.camera}, small, opened_->layers, silent_, {}));
    casting_ms = watch.Lap();
    return std::move(made.guides);
  }

  const SceneRequest& request_;
  std::optional<int> frame_;
  StyleSet& styles_;
  RunContext silent_;
  const std::string files_key_;
  std::string files_;  // names of what `opened_` consists of, each with a zero behind it
  std::optional<StaticScene> opened_;
  TrialPainter painter_;
};

}  // namespace

std::vector<std::string> QualityNames() { return {"draft", "preview", "final"}; }

std::optional<Quality> FindQuality(const std::string& name) {
  const std::vector<std::string> names = QualityNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Quality>(found - names.begin());
}

Expected<std::optional<BudgetChoice>> ChooseForGuides(const BudgetRequest& options, const GuideSet& guides,
                                                      std::optional<int> frame, const std::string& name,
                                                      const std::string& over, StyleSet& styles,
                                                      PictureRequest& picture, const RunContext& context) {
  if (!options.chooses()) return std::optional<BudgetChoice>();
  BudgetChoice choice;
  const LadderFrame ladder{false, guides.width(), guides.height(), true};
  if (options.quality) {
    SCUMBLE_RETURN_IF_ERROR(Take(NamedVariant(*options.quality, ladder, styles, context, choice), styles, picture));
    return std::optional(std::move(choice));
  }
  for (Style& style : styles.styles) SCUMBLE_RETURN_IF_ERROR(SetStyleFrame(style, frame.value_or(0)));
  const auto coverage = guides.Plane(Layer::kCoverage);
  const auto covered = std::count_if(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; });
  // Frames of one shot are alike: how much is covered counts in 64ths.
  const std::string circumstances =
      fmt::format("transfer; {}x{}; covered {:.0f}/64; layers {}; {}", guides.width(), guides.height(),
                  64.0 * double(covered) / double(std::max<std::size_t>(1, guides.pixel_count())),
                  guides.layers().ToString(), CommonCircumstances(styles, picture, context));
  TrialPainter trial(styles, picture, frame, name, over, context);
  SCUMBLE_ASSIGN(const Variant variant, VariantWithin(
                                            options, ladder, circumstances, styles, context,
                                            [&](const Variant& one) { return trial.Paint(one, guides); }, choice));
  SCUMBLE_RETURN_IF_ERROR(Take(variant, styles, picture));
  return std::optional(std::move(choice));
}

Expected<std::optional<BudgetChoice>> ChooseForScene(const BudgetRequest& options, SceneRequest& scene,
                                                     std::optional<int> frame, const std::string& over,
                                                     StyleSet& styles, PictureRequest& picture,
                                                     const RunContext& context) {
  if (!options.chooses()) return std::optional<BudgetChoice>();
  BudgetChoice choice;
  // Named points do not look at the scene: where its light takes no samples, fewer make no difference.
  const bool may_have_fewer =
      !scene.samples_given && std::any_of(styles.styles.begin(), styles.styles.end(), AsksForLight);
  LadderFrame ladder{true,
                     scene.size.width,
                     scene.size.height,
                     options.guides_are_fixed,
                     may_have_fewer ? scene.samples : 0,
                     !picture.over.empty() || !over.empty() || picture.IsOfPaintedSize()};
  const auto take = [&](const Variant& variant) {
    TakeSamples(variant, scene);
    return Take(variant, styles, picture);
  };
  if (options.quality) {
    SCUMBLE_RETURN_IF_ERROR(take(NamedVariant(*options.quality, ladder, styles, context, choice)));
    return std::optional(std::move(choice));
  }
  SceneTrials trials(scene, frame, over, styles, picture, context);
  SCUMBLE_ASSIGN(const std::uint64_t files, trials.FilesHash());
  const std::string circumstances =
      fmt::format("stylize; scene {:016x}; {}; {}; isa {}; half {}; {}", files, SizeToText(scene.size),
                  GuideSettings(scene), scene.isa, scene.half, CommonCircumstances(styles, picture, context));
  if (ladder.samples > 0) {
    const auto kept = [&](const char* question, SceneTrials::Needs* needs) {
      return KeptAnswer(question + circumstances, options.recalibrate, context, [&] { return trials.Asks(needs); });
    };
    SCUMBLE_ASSIGN(const bool needed, kept("samples; ", NeedSamples));
    SCUMBLE_ASSIGN(const bool paths, kept("paths; ", NeedPathSamples));
    // Pixels that choose their samples take fewer than a step of many for each.
    ladder.samples = !needed ? 0 : paths ? ladder.samples : std::min(ladder.samples, kChosenSamples);
  }
  SCUMBLE_ASSIGN(const Variant variant, VariantWithin(
                                            options, ladder, circumstances, styles, context,
                                            [&](const Variant& one) { return trials.Paint(one); }, choice));
  SCUMBLE_RETURN_IF_ERROR(take(variant));
  return std::optional(std::move(choice));
}

}  // namespace scumble
