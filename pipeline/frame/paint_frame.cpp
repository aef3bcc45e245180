#include "pipeline/frame/paint_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "pipeline/file_cache.h"
#include "apps/cli/app/run_report.h"
#include "apps/cli/app/json_text.h"
#include "pipeline/frame/explain_frame.h"
#include "apps/cli/app/timing.h"
#include "core/io/file/atomic_file.h"
#include "core/io/format_dispatch.h"
#include "core/io/picture_file.h"
#include "measure/mosaic/coherence.h"
#include "core/style/style_keyframes.h"
#include "transfer/transfer.h"
#include "transfer/upsample_guides.h"

namespace scumble {
namespace {

// One step's time over several runs.
struct Spread {
  double median = 0, least = 0, most = 0;
};

Spread SpreadOf(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const std::size_t half = samples.size() / 2;
  const double median = samples.size() % 2 ? samples[half] : 0.5 * (samples[half - 1] + samples[half]);
  return {median, samples.front(), samples.back()};
}

using Steps = std::vector<std::pair<std::string, Spread>>;

CoherenceReport CoherenceOf(const SourceField& field) {
  std::vector<std::uint8_t> covered(field.level.size());
  std::transform(field.level.begin(), field.level.end(), covered.begin(),
                 [](std::int8_t level) { return level != SourceField::kNoSource; });
  return MeasureCoherence({field.width, field.height, field.x, field.y, covered, field.exemplar});
}

std::string StepsToText(const Steps& steps, int repeat) {
  std::string text;
  double total = 0;
  for (const auto& [name, spread] : steps) {
    total += spread.median;
    text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", name, spread.median);
    if (repeat > 1 && spread.most > spread.least) text += fmt::format(" ({:.1f}–{:.1f})", spread.least, spread.most);
  }
  return text + fmt::format(", total {:.1f} ms", total);
}

nlohmann::ordered_json ToJson(const std::string& given, const Style& style, const PreparedStyle& prepared) {
  const PreparedExemplar& exemplar = *prepared.exemplar;
  nlohmann::ordered_json json{{"style", given},
                              {"name", style.name},
                              {"exemplars", exemplar.count()},
                              {"exemplar_width", exemplar.width()},
                              {"exemplar_height", exemplar.height()},
                              {"levels", prepared.levels},
                              {"blend_radius", prepared.blend_radius}};
  if (prepared.illumination.active()) json["luminances"] = prepared.illumination.luminances();
  return json;
}

void AddStep(const Steps::value_type& step, nlohmann::ordered_json& json) {
  const auto& [name, spread] = step;
  json["ms"][name] = {{"median", spread.median}, {"min", spread.least}, {"max", spread.most}};
}

// What stands outside `styles` about a style is the default one's.
nlohmann::ordered_json ToJson(const StyleSet& styles, const std::vector<PreparedStyle>& prepared,
                              const SourceField& field, double exposure, const PictureOptions& options,
                              const std::vector<PlanItem>& plan, const Steps& steps) {
  nlohmann::ordered_json json;
  json["output"] = options.output;
  json["style"] = styles.first().name;
  json["width"] = field.width;
  json["height"] = field.height;
  json["upsample"] = options.upsample;
  const PreparedExemplar& exemplar = *prepared.front().exemplar;
  json["exemplar_size"] = exemplar.size();  // the longer side
  json["exemplar_width"] = exemplar.width();
  json["exemplar_height"] = exemplar.height();
  json["levels"] = prepared.front().levels;
  json["blend_radius"] = prepared.front().blend_radius;
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    json["styles"].push_back(ToJson(styles.given[i], styles.styles[i], prepared[i]));
  }
  const CoherenceReport coherence = CoherenceOf(field);
  json["covered_pixels"] = coherence.covered;
  json["coherence"] = coherence.share;
  json["chunks"] = coherence.chunks;
  json["mean_chunk_area"] = coherence.mean_chunk_area;
  json["seed"] = options.seed;
  const bool lit = std::any_of(prepared.begin(), prepared.end(),
                               [](const PreparedStyle& style) {
                                 return style.illumination.active() || (style.space && style.space->has_radiance());
                               });
  if (lit) json["exposure"] = exposure;
  json["version"] = SCUMBLE_VERSION;
  json["repeat"] = options.repeat;
  if (!plan.empty()) json["plan"] = PlanToJson(plan);
  for (const auto& step : steps) AddStep(step, json);
  return json;
}

// A picture that is made and not written yet, and what is to be told of it.
struct Made {
  std::string output;
  PictureWriteOptions write;
  Picture picture;
  Steps steps;
  int repeat = 1;
  FrameReport report;  // all but the step of writing
};

Expected<FrameReport> WriteMade(Made& made) {
  Stopwatch watch;
  const std::uint64_t before = BytesWrittenByThisThread();
  SCUMBLE_RETURN_IF_ERROR(WritePicture(made.output, made.picture, made.write));
  const double ms = made.report.write_ms = watch.Lap();
  made.steps.emplace_back("write", Spread{ms, ms, ms});
  if (!made.report.json.empty()) {
    AddStep(made.steps.back(), made.report.json);
    made.report.json["work"]["bytes_written"] = BytesWrittenByThisThread() - before;
  }
  made.report.text += fmt::format("{}  {}\n", made.output, StepsToText(made.steps, made.repeat));
  return std::move(made.report);
}

// The picture underneath, if one is asked for.
Expected<const Picture*> OverFor(const PictureOptions& options, const GuideSet& guides, const std::string& guides_name,
                                 TransferMemory& memory) {
  if (options.over.empty()) return static_cast<const Picture*>(nullptr);
  SCUMBLE_RETURN_IF_ERROR(ReadOver(options.over, memory));
  const Picture& over = *memory.over;
  if (over.width != guides.width() || over.height != guides.height()) {
    return InputError(fmt::format("--over {} is {}×{}, {} {} {}×{}: render both at one size", options.over, over.width,
                                  over.height, guides_name, options.upsample > 1 ? "upsampled is" : "is",
                                  guides.width(), guides.height()));
  }
  return &over;
}

bool IsCatcher(const StyleSet& styles) {
  return std::any_of(styles.assigned.begin(), styles.assigned.end(),
                     [](const StyleSet::Assigned& one) { return one.style == StyleMap::kCatch; }) ||
         std::any_of(styles.wanted.begin(), styles.wanted.end(),
                     [](const auto& wish) { return wish.second == StyleMap::kCatch; });
}

// Of what was asked for and changes nothing, once in a run.
void WarnOfIdleOptions(const StyleSet& styles, const PictureOptions& options, TransferMemory& memory) {
  if (memory.warned) return;
  memory.warned = true;
  const bool lit = std::any_of(styles.styles.begin(), styles.styles.end(),
                               LooksAtLight);
  if (options.exposure != "auto" && !lit) {
    Warn("--exposure " + options.exposure + " changes nothing: style " + styles.first().name +
         " has one exemplar and no weight for light, so it does not look at it");
  }
  if (options.fast_io && !IsExr(options.output)) {
    Warn("--fast-io changes nothing: " + options.output + " is no .exr; --png-level 1 makes PNG quick to write");
  }
  const auto shadowed = std::find_if(styles.styles.begin(), styles.styles.end(), [](const Style& style) {
    return style.transfer.shadow != ShadowMode::kNone;
  });
  if (shadowed != styles.styles.end() && !IsCatcher(styles)) {
    Warn("transfer.shadow of style " + shadowed->name +
         " changes nothing, and its layer costs time: no object catches shadows; give --assign 'Ground=catcher', or leave it "
         "out");
  }
}

// A frame of another size than those before is rarely meant.
void WarnOfOtherSize(const GuideSet& guides, const std::string& name, TransferMemory& memory) {
  if (memory.width == 0) memory.width = guides.width(), memory.height = guides.height();
  if (memory.warned_of_size || (memory.width == guides.width() && memory.height == guides.height())) return;
  memory.warned_of_size = true;
  Warn(fmt::format("{} is {}×{}, the frames before it are {}×{}: its picture has another size than theirs", name,
                   guides.width(), guides.height(), memory.width, memory.height));
}

}  // namespace

Status ReadOver(const std::string& file, TransferMemory& memory) {
  if (memory.over && memory.over_file == file) return Ok();
  memory.over.reset();
  SCUMBLE_ASSIGN(memory.over, ReadPicture(file));
  memory.over_file = file;
  return Ok();
}

PictureSettings SettingsOf(const PictureOptions& options, std::optional<FrameRate> fps, std::optional<double> exposure,
                           std::optional<int> samples) {
  return {options.seed, !options.over.empty(), options.show,   options.upsample, fps,
          exposure,     options.exposure == "auto", samples};
}

std::optional<int> SamplesTold(const std::map<std::string, std::string>& attributes) {
  const auto told = attributes.find(kSettingsKey);
  if (told == attributes.end()) return std::nullopt;
  const std::string name = "; samples ";
  const std::size_t at = told->second.find(name);
  if (at == std::string::npos) return std::nullopt;
  const char* const begin = told->second.data() + at + name.size();
  int samples = 0;  // guides may come from anywhere
  const auto [end, failure] = std::from_chars(begin, told->second.data() + told->second.size(), samples);
  return failure == std::errc() ? std::optional(samples) : std::nullopt;
}

Expected<FrameRate> RateFor(const PictureOptions& options, const GuideSet& guides) {
  if (!options.fps.empty()) return ParseFps(options.fps);
  const auto told = guides.attributes.find("scumble:fps");
  if (told != guides.attributes.end()) {
    if (const auto rate = ParseFps(told->second)) return *rate;  // guides may come from anywhere
  }
  return ParseFps(kUsualFps);
}

void AddPictureOptions(CLI::App& verb, PictureOptions& options, bool needed) {
  auto* output = verb.add_option("-o,--output", options.output,
                                 std::string("picture to write: .png, .tif, .exr or .jpg") +
                                     (needed ? "" : "; required unless --explain is given"));
  output->type_name("FILE");
  if (needed) output->required();
  verb.add_option("--over", options.over, "picture to composite over, of the same size")->type_name("FILE");
  verb.add_option("--bits", options.bits,
                  "bits a channel: 8 or 16 for .png and .tif; .exr takes 16, half floats, or 32, floats")
      ->type_name("N")
      ->check(CLI::IsMember({8, 16, 32}))
      ->capture_default_str();
  verb.add_option("--png-level", options.png_level, "PNG compression, 0 fast to 9 small")
      ->type_name("N")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  AddFastIoOption(verb, options.fast_io);
  verb.add_option("--frame", options.frame,
                  "frame number, for transfer.jitter_fps, for keys of the style that change over time, and of a scene "
                  "that moves; left out: 0, of a .blend the frame that it was saved at, of glTF the nodes as they stand")
      ->type_name("N");
  AddFpsOption(verb, options.fps,
               "frames a second, as 24 or 24000/1001, for transfer.jitter_fps, and of a glTF animation: frame N is at "
               "N / RATE s; left out: of a .blend its own, otherwise 24");
  verb.add_option("--exposure", options.exposure,
                  "stops by which the scene's light is brightened for styles of several exemplars or with weights for "
                  "light; auto fits it to the brightest exemplar and prints the stops that repeat it")
      ->type_name("auto|STOPS")
      ->capture_default_str();
  verb.add_option("--seed", options.seed,
                  "another seed, another pattern: where chunks begin, what paint flat surfaces, shadows and edges take, "
                  "and the noise of a scene's soft lights; the same seed, the same bytes")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  verb.add_option("--show", options.show,
                  "write a picture that explains the result instead of it: where the paint comes from, the chunks and "
                  "their borders, their size, the guide error, which exemplar, which style")
      ->type_name("WHAT")
      ->check(CLI::IsMember(ExplanationNames()));
  verb.add_option("--upsample", options.upsample,
                  "the picture is N times as wide and high as the guides: they are quicker to make, and the paint has its "
                  "full size")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxUpsampling))
      ->capture_default_str();
  verb.add_option("--repeat", options.repeat, "times to run the transfer, to report the median time and its spread")
      ->type_name("N")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
}

Expected<std::optional<double>> ParseExposure(const std::string& text) {
  if (text == "auto") return std::optional<double>();
  double stops = 0.0;
  const auto [parsed, failure] = std::from_chars(text.data(), text.data() + text.size(), stops);
  if (failure != std::errc() || parsed != text.data() + text.size() || !(std::fabs(stops) <= 64.0)) {
    return UsageError("--exposure " + text + ": expected auto, or stops from -64 to 64");
  }
  return std::optional(stops);
}

// Stops for the scene's luminance; 0 where no style looks at it.
Expected<double> ExposureFor(const std::vector<PreparedStyle>& prepared, const GuideSet& guides,
                             const PictureOptions& options, const Globals& globals) {
  SCUMBLE_ASSIGN(const std::optional<double> given, ParseExposure(options.exposure));
  if (given) return *given;
  const std::optional<double> stops = MeasureExposure(prepared, guides, globals.threads);
  if (!stops) return 0.0;
  Say(globals, fmt::format("exposure: {:.2f} stops; --exposure {:.2f} repeats it", *stops, *stops));
  return *stops;
}

Expected<PreparedStyle> PrepareOne(const Style& style, int height, int threads) {
  FileCache cache = UserCache();
  PrepareOptions options;
  options.cache = &cache;
  options.threads = threads;
  SCUMBLE_ASSIGN(PreparedStyle prepared, Prepare(style, height, options));
  if (style.transfer.edge == EdgeMode::kExemplar && prepared.rims.empty()) {
    Warn("style " + style.name + ": transfer.edge is \"exemplar\", but the exemplar has no painted edge, because its paint does "
         "not end near the rim on bare paper; outlines stay exact. Leave paper free in the corners, or set it to \"exact\"");
  }
  return prepared;
}

namespace {

// What a transfer reads from the settings themselves, frame by frame: when nothing else changes, exemplars stay prepared.
bool IsReadEachFrame(const std::string& key) {
  static const std::set<std::string> kKeys = {"transfer.threshold", "transfer.threshold_metric", "transfer.jitter",
                                              "transfer.jitter_fps", "transfer.coherent", "transfer.variety", "transfer.crease",
                                              "transfer.depth_tolerance", "transfer.match_step"};
  return kKeys.count(key) > 0;
}

}  // namespace

Status PrepareFrame(StyleSet& styles, const GuideSet& guides, const PictureOptions& options, const Globals& globals,
                    TransferMemory& memory) {
  const int height = guides.height() * options.upsample;
  const bool all = memory.prepared.empty() || memory.prepared.front().output_height != height;
  for (std::size_t i = 0; i < styles.styles.size(); ++i) {
    SCUMBLE_ASSIGN(const auto changed, SetStyleFrame(styles.styles[i], options.frame.value_or(0)));
    if (all || changed.empty() || i >= memory.prepared.size()) continue;
    if (std::all_of(changed.begin(), changed.end(), IsReadEachFrame)) {
      memory.prepared[i].settings = styles.styles[i].transfer;
      memory.prepared[i].required = RequiredLayers(styles.styles[i]);
      continue;
    }
    SCUMBLE_ASSIGN(memory.prepared[i], PrepareOne(styles.styles[i], height, globals.threads));
  }
  if (all) memory.prepared.clear();
  // All of them, or those that the scene has asked for since.
  for (std::size_t i = memory.prepared.size(); i < styles.styles.size(); ++i) {
    SCUMBLE_ASSIGN(PreparedStyle one, PrepareOne(styles.styles[i], height, globals.threads));
    for (const auto& [image, what, mend] : EqualLights(styles.styles[i], one)) Warn(image + " " + what + ": " + mend);
    memory.prepared.push_back(std::move(one));
  }
  if (!memory.exposure) {
    SCUMBLE_ASSIGN(memory.exposure, ExposureFor(memory.prepared, guides, options, globals));
  }
  return Ok();
}

std::vector<EqualLight> EqualLights(const Style& style, const PreparedStyle& prepared) {
  std::vector<EqualLight> equal;
  const auto luminances = prepared.illumination.luminances();
  for (std::size_t later = 1; later < luminances.size(); ++later) {
    const auto first = std::find(luminances.begin(), luminances.begin() + std::ptrdiff_t(later), luminances[later]);
    const auto index = static_cast<std::size_t>(first - luminances.begin());
    if (index == later) continue;
    equal.push_back({style.exemplars[later].name,
                     fmt::format("has the luminance {:.4g} as {} has, which stands first and is taken, so it never shows",
                                 luminances[later], style.exemplars[index].name),
                     "give each [[exemplar]] its own"});
  }
  return equal;
}

std::string LightInWords(const Exemplar& exemplar, double rim) {
  const bool by_guides = exemplar.guides && exemplar.guides->Has(Layer::kLuminance);
  const char* const source = exemplar.luminance ? "given"
                             : by_guides        ? "measured from its guides"
                                                : "measured from its paint";
  return fmt::format("luminance {:.4g}, {}", LuminanceOf(exemplar, rim), source);
}

bool KeepsField(const PictureOptions& options, const Globals& globals) {
  return globals.json || FindExplanation(options.show);
}

bool MeasuresExposure(const StyleSet& styles, const PictureOptions& options) {
  return options.exposure == "auto" && std::any_of(styles.styles.begin(), styles.styles.end(), LooksAtLight);
}

Expected<ExitCode> RunTransfer(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                               const PictureOptions& options, const Globals& globals, const Progress& progress) {
  TransferMemory memory;
  SCUMBLE_ASSIGN(const FrameWrite write, TransferFrame(styles, guides, source, options, globals, progress, memory));
  SCUMBLE_ASSIGN(FrameReport report, write());
  EndStage(globals, "write");
  report.json.update(SayHowAssigned(styles));
  report.json["memory"]["peak_bytes"] = PeakMemory();
  report.json.update(options.chosen);
  if (globals.timing) {
    report.json["timing"] = globals.timing->ToJson();
    report.text += globals.timing->ToText();
  }
  Print(globals.json ? JsonText(report.json) : report.text);
  return ExitCode::kOk;
}

Expected<FrameWrite> TransferFrame(StyleSet& styles, const GuideSet& given, const GuideSource& source,
                                    const PictureOptions& options, const Globals& globals, const Progress& progress,
                                    TransferMemory& memory) {
  SCUMBLE_ASSIGN(const FrameRate fps, RateFor(options, given));
  StepTimes times = source.times;
  Stopwatch watch;
  WarnOfOtherSize(given, source.name, memory);
  std::optional<GuideSet> larger;
  if (options.upsample > 1) {
    SCUMBLE_ASSIGN(larger, UpsampleGuides(given, options.upsample, globals.threads));
    times.emplace_back("upsample", watch.Lap());
  }
  const GuideSet& guides = larger ? *larger : given;
  SCUMBLE_ASSIGN(const Picture* const over, OverFor(options, guides, source.name, memory));
  if (over) times.emplace_back("over", watch.Lap());
  SCUMBLE_RETURN_IF_ERROR(PrepareFrame(styles, given, options, globals, memory));
  WarnOfIdleOptions(styles, options, memory);
  const std::vector<PreparedStyle>& prepared = memory.prepared;
  std::vector<const PreparedStyle*> pointers;
  for (const PreparedStyle& one : prepared) pointers.push_back(&one);
  StyleMap map;
  const bool needs_map = styles.NeedsMap(guides);
  if (needs_map) {
    SCUMBLE_ASSIGN(map, MapStyles(styles, guides, source.name));
  }
  times.emplace_back("prepare", watch.Lap());
  EndStage(globals, "prepare");

  TransferOptions transfer;
  transfer.seed = options.seed;
  transfer.frame = options.frame.value_or(0);
  transfer.fps_numerator = fps.numerator, transfer.fps_denominator = fps.denominator;
  transfer.exposure = *memory.exposure;
  transfer.threads = globals.threads;
  transfer.over = over;
  transfer.keep_field = KeepsField(options, globals);
  TransferScratch& scratch = memory.scratch;
  Picture picture;
  std::vector<double> match, vote, compose;
  for (int run = 0; run < options.repeat; ++run) {
    if (progress) {
      transfer.progress = [&, run](double share) { return progress((run + share) / options.repeat); };
    }
    SCUMBLE_RETURN_IF_ERROR(needs_map ? Transfer(pointers, map, guides, transfer, scratch, picture)
                                      : Transfer(prepared.front(), guides, transfer, scratch, picture));
    match.push_back(scratch.times.match_ms);
    vote.push_back(scratch.times.vote_ms);
    compose.push_back(scratch.times.compose_ms);
  }
  if (const auto what = FindExplanation(options.show)) {
    picture = Show(*what, {prepared, map, guides, scratch.field, transfer.exposure, picture});
  }
  const auto sum = [](const std::vector<double>& ms) { return std::accumulate(ms.begin(), ms.end(), 0.0); };
  EndStage(globals, "transfer", {{"match", sum(match)}, {"vote", sum(vote)}, {"compose", sum(compose)}});
  Made made;
  made.output = options.output, made.repeat = options.repeat;
  made.write = {options.bits, options.png_level};
  made.write.fast = options.fast_io;
  made.write.settings = SettingsText(styles, SettingsOf(options, fps, transfer.exposure, SamplesTold(given.attributes)), memory.hashes);
  for (const auto& [name, ms] : times) made.steps.emplace_back(name, Spread{ms, ms, ms});
  made.steps.emplace_back("match", SpreadOf(match));
  made.steps.emplace_back("vote", SpreadOf(vote));
  made.steps.emplace_back("compose", SpreadOf(compose));
  if (globals.json) {  // measuring coherence takes its time
    made.report.json = ToJson(styles, prepared, scratch.field, transfer.exposure, options, source.plan, made.steps);
    if (source.cost) CostToJson(*source.cost, made.report.json);
  }
  if (globals.json) made.report.json["memory"] = MemoryToJson(source.memory);
  if (!source.plan.empty()) made.report.text = PlanToText(source.plan) + MemoryToText(source.memory);
  if (!source.plan.empty() && source.cost) made.report.text += CostToText(*source.cost);
  made.picture = std::move(picture);
  return FrameWrite([shared = std::make_shared<Made>(std::move(made))] { return WriteMade(*shared); });
}

}  // namespace scumble
