// scumble tradeoff: the cost and the error of every variant of a stylised scene.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "apps/cli/app/command.h"
#include "apps/cli/app/json_text.h"
#include "apps/cli/app/made_folders.h"
#include "apps/cli/app/options.h"
#include "core/io/atomic_file.h"
#include "core/io/pending_temporaries.h"
#include "measure/tradeoff_report.h"
#include "pipeline/memory_limit.h"
#include "pipeline/run_inputs.h"
#include "pipeline/sequence.h"
#include "pipeline/style_set.h"
#include "pipeline/tradeoff.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

struct TradeoffVerb {
  TradeSetup setup;
  SceneOptions scene;             // becomes setup.scene
  StyleOptions style;             // becomes setup.style
  std::string exposure = "auto";  // becomes setup.exposure
  std::string folder;
  std::string peak_of;  // a variant's name: its memory alone, for the process that AskForPeak starts
};

constexpr const char *kPictures = "pictures", *kJson = "tradeoff.json", *kTradeoffPage = "report.html";

// Of a folder that is there; once more before writing, when it is known what the scene consists of.
Status CheckTargets(const std::string& folder, RunInputs& files) {
  const fs::path pictures = fs::path(folder) / kPictures;
  std::error_code failed;
  for (const char* name : {kTradeoffPage, "tradeoff.csv", kJson, "chart.svg"}) {
    SCUMBLE_RETURN_IF_ERROR(files.CheckOutput((fs::path(folder) / name).string()));
  }
  // The pictures' names are not known yet: so no picture in the folder may be an input file.
  for (const fs::directory_entry& entry : fs::directory_iterator(pictures, failed)) {
    if (entry.path().extension() == ".png") SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(entry.path().string()));
  }
  return files.CheckOutput((pictures / "00.png").string());
}

// Checked before minutes of work: whether the folder exists and is writable, and no input file is overwritten.
Status CheckFolder(const TradeoffVerb& verb, const std::error_code& making, RunInputs& files, const Globals& globals) {
  const fs::path pictures = fs::path(verb.folder) / kPictures;
  std::error_code failed;
  if (!fs::is_directory(fs::status(pictures, failed))) {
    return OutputError(
        fmt::format("-o {}: it is no folder with a folder {} in it, and none can be made{}; name another", verb.folder,
                    kPictures, making ? ": " + making.message() : ""));
  }
  StyleRequest style = verb.setup.style;
  style.scene_styles = false;
  SCUMBLE_ASSIGN(const StyleSet styles, OpenStyles(style, globals));
  files.ReadsStyles(styles);
  return CheckTargets(verb.folder, files);
}

// Pictures that an earlier report in the folder lists and this one does not; no other files.
std::vector<fs::path> OldPictures(const std::string& folder, const TradeReport& report) {
  std::vector<fs::path> old;
  const auto bytes = ReadWholeFile(fs::path(folder) / kJson);
  if (!bytes) return old;
  const auto* const text = reinterpret_cast<const char*>(bytes->data());
  const auto json = nlohmann::json::parse(text, text + bytes->size(), nullptr, false);
  if (!json.is_object() || !json.contains("variants") || !json["variants"].is_array()) return old;
  std::set<std::string> names;
  for (std::size_t i = 0; i < report.variants.size(); ++i) names.insert(TradePictureName(report, i));
  for (const auto& variant : json["variants"]) {
    if (!variant.is_object() || !variant.contains("picture") || !variant["picture"].is_string()) continue;
    const fs::path name = variant["picture"].get<std::string>();
    if (name.extension() == ".png" && name == name.filename() && !names.contains(name.string())) {
      old.push_back(fs::path(folder) / kPictures / name);
    }
  }
  return old;
}

// Whether the page's folder has room for a report of that many bytes, its largest file of `largest`: allocates and
// frees them at once. Some file systems report a full disk only when the file is flushed or closed.
Status CheckRoom(const fs::path& page, std::size_t bytes, std::size_t largest) {
  const internal::PendingTemporary taken(page);
  int failure = errno;
  const int file = taken.descriptor();
  if (file >= 0) {
    failure = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
    if (failure == EFBIG) failure = ::posix_fallocate(file, 0, static_cast<off_t>(largest));  // a limit of each file
    if (::fsync(file) != 0 && failure == 0) failure = errno;
    if (::close(file) != 0 && failure == 0) failure = errno;
    if (failure != ENOSPC && failure != EDQUOT && failure != EFBIG) return Ok();
  }
  const std::string remedy = file < 0 ? "name another folder" : "make room, or name another folder";
  return OutputError(fmt::format("cannot write {}: {}; the report takes {:.1f} MB: {}", page.string(),
                                 std::strerror(failure), 1e-6 * static_cast<double>(bytes), remedy));
}

// Removes a file, following links as the writing does. A missing file, a device or a pipe is skipped.
Status Remove(const fs::path& file) {
  std::error_code failed;
  const fs::path target = fs::canonical(file, failed);
  if (failed || !fs::is_regular_file(target, failed)) return Ok();
  fs::remove(target, failed);
  return failed ? Status(OutputError("cannot write " + file.string() + ": " + failed.message())) : Ok();
}

// Everything is encoded first and has room, so that a full disk leaves an older report unchanged. Then the older report
// is removed, its page first, because other variants' pictures reuse its names. The new page is written last. So if
// there is a page, all of its files exist, whenever a run ends.
Status WriteFolder(const std::string& folder, const TradeReport& report) {
  const fs::path place(folder);
  const std::array<std::pair<const char*, std::string>, 4> texts = {{{"tradeoff.csv", TradeCsv(report)},
                                                                     {kJson, TradeJson(report)},
                                                                     {"chart.svg", TradeChart(report)},
                                                                     {kTradeoffPage, TradeHtml(report)}}};
  constexpr std::size_t kBlock = 4096;  // a file's size beside its bytes: the rest of its last block
  std::size_t bytes = 0, largest = 0;
  const auto add = [&](std::size_t size) { bytes += size + kBlock, largest = std::max(largest, size); };
  for (const auto& [name, text] : texts) add(text.size());
  for (const TradeMeasure& variant : report.variants) add(variant.picture_png.size());
  SCUMBLE_RETURN_IF_ERROR(CheckRoom(place / kTradeoffPage, bytes, largest));

  const std::vector<fs::path> old = OldPictures(folder, report);
  SCUMBLE_RETURN_IF_ERROR(Remove(place / kTradeoffPage));
  std::error_code ignored;
  for (const fs::path& picture : old) fs::remove(picture, ignored);
  for (const auto& [name, text] : texts) SCUMBLE_RETURN_IF_ERROR(Remove(place / name));

  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const fs::path file = place / kPictures / TradePictureName(report, i);
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(file, std::as_bytes(std::span(report.variants[i].picture_png))));
  }
  for (const auto& [name, text] : texts) SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(place / name, text));
  return Ok();
}

Expected<ExitCode> RunTradeoffVerb(TradeoffVerb verb, const Globals& globals) {
  const std::uint64_t seed = verb.setup.scene.seed;
  SCUMBLE_ASSIGN(verb.setup.scene, ToRequest(verb.scene));
  verb.setup.scene.seed = seed;
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(verb.setup.scene));
  SCUMBLE_ASSIGN(verb.setup.style, ToRequest(verb.style));
  SCUMBLE_ASSIGN(verb.setup.exposure, ParseExposure(verb.exposure));
  verb.setup.writes = !verb.folder.empty();
  if (!verb.peak_of.empty()) {
    SCUMBLE_ASSIGN(const std::size_t bytes, PeakOfVariant(verb.setup, verb.peak_of, globals));
    Print(fmt::format("{{\"peak_bytes\": {}}}\n", bytes));
    return ExitCode::kOk;
  }
  RunInputs files;
  verb.setup.scene.on_file = files.ReadsScene(verb.setup.scene.scene);
  if (!verb.folder.empty()) {
    const MadeFolders folders(fs::path(verb.folder) /
                              kPictures);  // removed again, because minutes of work may be interrupted
    SCUMBLE_RETURN_IF_ERROR(CheckFolder(verb, folders.error(), files, globals));
  }
  SCUMBLE_ASSIGN(const TradeReport report, MeasureTradeoff(verb.setup, globals));
  Status written = Ok();
  if (!verb.folder.empty()) {
    const MadeFolders folders(fs::path(verb.folder) / kPictures);
    written = CheckTargets(verb.folder, files);
    if (written) written = WriteFolder(verb.folder, report);
  }
  Print(globals.json ? TradeJson(report)
                     : TradeTable(report));  // always printed: minutes of work are not lost if writing fails
  SCUMBLE_RETURN_IF_ERROR(written);
  if (!verb.folder.empty()) {
    globals.Note((fs::path(verb.folder) / "report.html").string() + ": the report, with a chart and all pictures");
  }
  return ExitCode::kOk;
}

}  // namespace

void AddTradeoffVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<TradeoffVerb>();
  CLI::App* sub = app.add_subcommand(
      "tradeoff",
      "what every variant of a style costs on this machine, and how far off it is: a table, a chart, all pictures");
  sub->footer(
      "Each variant changes one thing of the style, or a few. `texture` ranks, the less the better: how far the\n"
      "paint's look is from that of the exemplar where the surface is turned alike. Times are of the guides (with\n"
      "the acceleration structure) and of the transfer, after a run to warm up of which nothing is kept that a\n"
      "sequence would keep: they are those of a single picture. Loading, preparing the style and writing are not in\n"
      "them, and a run of more than 5 s is not repeated. Memory is the peak of a process that makes the one picture,\n"
      "and is not measured of a .blend, which would be exported for each variant. Everything is measured without\n"
      "paper, and in the one style, whatever the scene says; colorized styles are measured before the scene's\n"
      "colours are on them, and finished ones before their effects, which pictures and times are with.\n");
  AddViewOptions(*sub, verb->scene);
  sub->add_option(
         "--frame", verb->setup.frame,
         "the scene and the style at this frame of theirs; left out: as they stand, of a .blend the frame that it was "
         "saved at")
      ->type_name("N");
  AddFpsOption(
      *sub, verb->scene.fps,
      "frames a second, with --frame: of a glTF animation frame N is at N / RATE s; left out: of a .blend its own, "
      "otherwise 24");
  AddAnimationOption(*sub, verb->scene);
  sub->add_option(
         "--exposure", verb->exposure,
         "stops by which the scene's light is brightened, as stylize has it; auto fits it to this frame, a sequence to "
         "its first")
      ->type_name("auto|STOPS")
      ->capture_default_str();
  AddCastOptions(*sub, verb->scene);
  AddSampleOptions(*sub, verb->scene);
  AddOneStyleOptions(*sub, verb->style, true);
  AddFinishOptions(*sub, verb->style.request.finishes, verb->style.request.finish_measures);
  sub->add_option(
         "--only", verb->setup.only,
         "these axes alone, as levels,nearest, or variants by name, * stands for any text: 'levels*'; the style itself "
         "is "
         "measured in any case. A name that is no axis of this style and scene lists those that are, of precision, "
         "samples, "
         "resolution, robust, nearest, method, levels, threshold, blend_radius and more")
      ->type_name("AXIS,…")
      ->check(RefuseEmpty);
  sub->add_flag("--quick", verb->setup.quick, "the small grid: a dozen variants or two");
  sub->add_option("--repeat", verb->setup.repeats, "times to run each, for the median and its spread")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--seed", verb->setup.scene.seed,
                  "another seed, another pattern and other noise; the same seed, the same errors")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  sub->add_flag("!--no-memory", verb->setup.memory, "do not measure memory, which takes a process for each variant");
  sub->add_option("-o,--output", verb->folder,
                  "folder to write to: report.html, chart.svg, tradeoff.csv, tradeoff.json, pictures/*.png; left out: "
                  "the table alone")
      ->type_name("FOLDER")
      ->check(RefuseEmpty);
  sub->add_option("--peak-of", verb->peak_of)->group("");
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunTradeoffVerb(*verb, globals); }; });
}

}  // namespace scumble
