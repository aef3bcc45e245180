// The calls that answer with pictures of the scene, and what is said of their pixels.
#include <fmt/format.h>

#include <filesystem>

#include "apps/studio/session/encode.h"
#include "apps/studio/session/pick.h"
#include "apps/studio/session/session_state.h"
#include "apps/studio/session/style_files.h"
#include "core/filter/resample.h"
#include "core/image/hash.h"
#include "core/image/stopwatch.h"
#include "core/io/atomic_file.h"
#include "core/io/picture_file.h"
#include "pipeline/blender_scene.h"
#include "pipeline/file_stamp.h"
#include "pipeline/scene_guides.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr int kCannotPaint = 422;

// As the header Server-Timing has it: names are tokens, times milliseconds.
std::string TimingOf(const PaintedFrame& frame, double encode_ms) {
  std::string text;
  for (const StepSpread& step : std::get<PictureReport>(frame.report.made).steps) {
    std::string name;
    for (const char c : step.name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    text += fmt::format("{};dur={:.2f}, ", name, step.median);
  }
  return text + fmt::format("encode;dur={:.2f}", encode_ms);
}

HttpResponse PngAnswer(const Picture& picture) {
  Expected<std::string> bytes = EncodeFrame(picture, FrameFormat::kPng, false);
  if (!bytes) return ErrorAnswer(bytes.error());
  return {200, "image/png", std::move(*bytes), {}};
}

// A folder of its own for one file, removed with it.
struct TemporaryPlace {
  explicit TemporaryPlace(const fs::path& root) {
    std::string pattern = (root / "scumble-XXXXXX").string();
    if (::mkdtemp(pattern.data())) folder = pattern;
  }
  ~TemporaryPlace() {
    std::error_code failed;
    if (!folder.empty()) fs::remove_all(folder, failed);
  }
  fs::path folder;
};

std::string ContentTypeOfPicture(const std::string& format) {
  if (format == "png") return "image/png";
  if (format == "jpg") return "image/jpeg";
  if (format == "tif") return "image/tiff";
  return "image/x-exr";
}

// At most 320 × 180, in its own proportions.
Picture SmallPicture(const Picture& picture) {
  const double shrunk = std::min({1.0, 320.0 / picture.width, 180.0 / picture.height});
  return Resample(picture, std::max(1, int(picture.width * shrunk + 0.5)),
                  std::max(1, int(picture.height * shrunk + 0.5)));
}

Expected<Picture> DrawThumbnail(const SceneEntry& scene, const StyleEntry& style, const RunContext& context) {
  SceneRequest request;
  request.scene = scene.file, request.size = {320, 180};
  request.samples = 4, request.samples_given = true;
  StyleRequest paint;
  paint.style = style.given;
  Workspace workspace(context.WithoutNotes());
  SCUMBLE_ASSIGN(PaintedFrame frame, workspace.Paint(request, paint, {}));
  return std::move(frame.picture);
}

}  // namespace

HttpResponse Session::State::Frame(const Moment& moment, const HttpRequest& request, const std::string& quality,
                                   const std::string& format_name, const std::string& show_name, Lane& lane) {
  const bool draft = quality == "draft";
  if (!draft && quality != "final") return ErrorAnswer(UsageError("quality: expected draft or final"));
  const std::optional<FrameFormat> format = FindFrameFormat(format_name);
  if (!format) return ErrorAnswer(UsageError("format: expected jpeg, rgba or png"));
  std::optional<Explanation> show;
  if (!show_name.empty() && show_name != "picture") {
    show = FindExplanation(show_name);
    if (!show) return ErrorAnswer(UsageError(fmt::format("show: expected {}", fmt::join(ExplanationNames(), ", "))));
  }
  if (moment.state.scene.empty()) return ErrorAnswer(InputError("there is no scene yet: choose one"), kCannotPaint);
  if (moment.state.style.empty()) return ErrorAnswer(InputError("there is no style yet: choose one"), kCannotPaint);
  PictureJob job = JobAt(moment, show);
  if (draft) {
    if (&lane == &drafts) finals.CancelUnless(job.state);
    job.budget.quality = Quality::kDraft, job.budget.budget_ms = 0;
    job.picture.leave_small = *format == FrameFormat::kJpeg;  // browsers scale it as they draw it
    job.key += job.picture.leave_small ? " small draft" : " draft";
  }
  const std::string etag = EtagOf(run_id + " " + job.key + format_name);
  const std::vector<std::pair<std::string, std::string>> known = {
      {"ETag", etag}, {"X-Scumble-Revision", std::to_string(moment.revision)}};
  if (request.if_none_match == etag) return {304, "", "", known};
  const auto tab = request.query.find("tab");
  const Expected<Lane::Painted> painted = LaneOf(lane, job).Paint(job, tab == request.query.end() ? "" : tab->second);
  // A file that is being written is no mistake: the page asks again.
  if (!painted && painted.error().kind == ErrorKind::kInput && watch->SeesChanges()) {
    return ErrorAnswer(CancelledError(), kCannotPaint);
  }
  if (!painted) return ErrorAnswer(painted.error(), kCannotPaint);
  Stopwatch clock;
  Expected<std::string> bytes = EncodeFrame((*painted)->picture, *format, draft);
  if (!bytes) return ErrorAnswer(bytes.error(), kCannotPaint);
  HttpResponse answer{200, ContentTypeOf(*format), std::move(*bytes), known};
  answer.headers.emplace_back("X-Scumble-Size",
                              fmt::format("{}x{}", (*painted)->picture.width, (*painted)->picture.height));
  answer.headers.emplace_back("Server-Timing", TimingOf(**painted, clock.Lap()));
  return answer;
}

HttpResponse Session::State::GetFrame(const HttpRequest& request) {
  const auto text = [&](const char* name, const char* otherwise) {
    const auto found = request.query.find(name);
    return found == request.query.end() ? std::string(otherwise) : found->second;
  };
  const std::string quality = text("quality", "final");
  const auto begun = std::chrono::system_clock::now();
  const Moment moment = Now();
  HttpResponse answer =
      Frame(moment, request, quality, text("format", "jpeg"), text("show", ""), quality == "draft" ? drafts : finals);
  if (quality == "draft") return answer;
  if (answer.status == 200) SetProblem(std::nullopt);
  if (answer.status == 200 || answer.status == kCannotPaint) WatchFilesOf(moment, begun, answer.status == 200);
  return answer;
}

HttpResponse Session::State::PostFrame(const HttpRequest& request) {
  const Expected<nlohmann::json> body = BodyOf(request);
  if (!body) return ErrorAnswer(body.error());
  const auto text = [&](const char* name, const char* otherwise) -> std::string {
    return body->contains(name) && (*body)[name].is_string() ? (*body)[name].get<std::string>() : otherwise;
  };
  Moment moment = Now();
  const nlohmann::json changes = body->contains("changes") ? (*body)["changes"] : nlohmann::json::object();
  const Expected<StudioState> changed = Patched(moment.state, changes, KnownCatalogue());
  if (!changed) return ErrorAnswer(changed.error(), changed.error().kind == ErrorKind::kInput ? 404 : 400);
  const Moment main = moment;
  const auto begun = std::chrono::system_clock::now();
  moment.state = *changed;
  HttpResponse answer =
      Frame(moment, request, text("quality", "final"), text("format", "jpeg"), text("show", ""), others);
  if (answer.status != 200 || main.state.scene.empty() || main.state.style.empty()) return answer;
  const std::vector<StyleEntry> styles = ChosenStyles(moment.state);
  {
    const std::lock_guard lock(mutex);
    constexpr std::size_t kMostCompared = 4;
    for (const StyleEntry& style : styles) {
      std::erase_if(compared, [&](const StyleEntry& one) { return one.id == style.id; });
      compared.push_back(style);
    }
    if (compared.size() > kMostCompared) compared.erase(compared.begin(), compared.end() - kMostCompared);
  }
  WatchFilesOf(main, begun, true);
  return answer;
}

Expected<Lane::Painted> Session::State::PaintedWithField() {
  PictureJob job = JobAt(Now(), std::nullopt);
  if (job.scene.scene.empty() || job.style.style.empty()) return InputError("there is no picture yet");
  job.picture.keep_field = true;
  job.key += " field";
  return LaneOf(others, job).Paint(job);
}

HttpResponse Session::State::Pick(const HttpRequest& request) {
  const Expected<int> x = QueryNumber(request, "x", {}), y = QueryNumber(request, "y", {});
  if (!x) return ErrorAnswer(x.error());
  if (!y) return ErrorAnswer(y.error());
  const Moment of = Now();
  const Expected<Lane::Painted> painted = PaintedWithField();
  if (!painted) return ErrorAnswer(painted.error(), kCannotPaint);
  nlohmann::json pick = PickAt(**painted, *x, *y);
  if (pick.contains("style")) {
    const std::vector<StyleEntry> styles = StylesOf(of);
    const std::size_t index = pick["style"];
    pick["style_id"] = index < styles.size() ? styles[index].id : "";
  }
  return JsonAnswer(pick);
}

HttpResponse Session::State::Chunk(const HttpRequest& request) {
  const Expected<int> x = QueryNumber(request, "x", {}), y = QueryNumber(request, "y", {});
  if (!x) return ErrorAnswer(x.error());
  if (!y) return ErrorAnswer(y.error());
  const Expected<Lane::Painted> painted = PaintedWithField();
  if (!painted) return ErrorAnswer(painted.error(), kCannotPaint);
  return PngAnswer(ChunkMask(**painted, *x, *y));
}

HttpResponse Session::State::Fed(const HttpRequest& request) {
  int values[5] = {};
  int i = 0;
  for (const char* name : {"x", "y", "style", "exemplar", "radius"}) {
    const Expected<int> value = QueryNumber(request, name, i < 2 ? std::nullopt : std::optional(i == 4 ? 8 : 0));
    if (!value) return ErrorAnswer(value.error());
    values[i++] = *value;
  }
  const Expected<Lane::Painted> painted = PaintedWithField();
  if (!painted) return ErrorAnswer(painted.error(), kCannotPaint);
  return PngAnswer(FedMask(**painted, values[2], values[3], values[0], values[1], values[4]));
}

HttpResponse Session::State::ExportPicture(const std::string& format) {
  if (format != "png" && format != "exr" && format != "tif" && format != "jpg") {
    return ErrorAnswer(UsageError("format: expected png, exr, tif or jpg"));
  }
  const Moment moment = Now();
  if (moment.state.scene.empty() || moment.state.style.empty()) {
    return ErrorAnswer(InputError("there is no picture yet: choose a scene and a style"), kCannotPaint);
  }
  const PictureJob job = JobAt(moment, std::nullopt);
  const Expected<Lane::Painted> painted = LaneOf(finals, job).Paint(job);
  if (!painted) return ErrorAnswer(painted.error(), kCannotPaint);
  const TemporaryPlace place(context.temporary_folder);
  if (place.folder.empty()) {
    return ErrorAnswer(
        OutputError("cannot make a folder in " + context.temporary_folder.string() + " for the picture"));
  }
  const fs::path file = place.folder / ("picture." + format);
  const Status written = WritePicture(file, (*painted)->picture, (*painted)->write);
  if (!written) return ErrorAnswer(written.error());
  const Expected<std::vector<std::byte>> bytes = ReadWholeFile(file);
  if (!bytes) return ErrorAnswer(bytes.error());
  return {200,
          ContentTypeOfPicture(format),
          {reinterpret_cast<const char*>(bytes->data()), bytes->size()},
          {{"Content-Disposition", "attachment; filename=\"picture." + format + "\""}}};
}

HttpResponse Session::State::Thumbnail(const HttpRequest& request) {
  const Catalogue known = KnownCatalogue();
  const auto scene_id = request.query.find("scene"), style_id = request.query.find("style");
  const SceneEntry* const scene = scene_id == request.query.end() ? nullptr : known.FindScene(scene_id->second);
  const StyleEntry* const style = style_id == request.query.end() ? nullptr : known.FindStyle(style_id->second);
  if (!scene && !style) return ErrorAnswer(InputError("there is no scene or style of this name"), 404);
  std::string key = scene ? "scene " + scene->id : "style " + style->id;
  // A style's own thumbnail, or its first painting, for which the style is read, or a scene in a style that has none.
  bool is_unpainted = false;
  std::error_code failed;
  fs::path file = style && !style->toml().empty() ? style->toml().parent_path() / "thumbnail.png" : fs::path();
  if (style && !fs::exists(file, failed)) {
    const Expected<std::shared_ptr<const StyleFacts>> read = FactsOf(*style);
    is_unpainted = read && (*read)->exemplars.empty();
    file = read && !is_unpainted ? fs::path((*read)->exemplars.front().file) : style->toml();
  }
  if (style) key += StampOf(file.string());
  {
    const std::lock_guard lock(mutex);
    const auto found = thumbnails.find(key);
    if (found != thumbnails.end()) return {200, "image/png", found->second, {{"ETag", EtagOf(found->second)}}};
  }
  Expected<Picture> picture = InputError("there is no thumbnail");
  if (is_unpainted) {
    const SceneEntry* shown = known.FindScene("suzanne");
    if (!shown && !known.scenes.empty()) shown = &known.scenes.front();
    if (shown && !IsBlenderScene(shown->file)) picture = DrawThumbnail(*shown, *style, context);
  } else if (style) {
    if (!file.empty()) picture = ReadPicture(file);
  } else if (!IsBlenderScene(scene->file)) {
    const StyleEntry* paint = known.FindStyle("oil");
    if (!paint && !known.styles.empty()) paint = &known.styles.front();
    if (paint) picture = DrawThumbnail(*scene, *paint, context);
  }
  if (!picture) return ErrorAnswer(picture.error(), 404);
  HttpResponse answer = PngAnswer(SmallPicture(*picture));
  const std::lock_guard lock(mutex);
  if (answer.status == 200) thumbnails[key] = answer.body;
  return answer;
}

HttpResponse Session::State::Export(const HttpRequest& request) {
  const Expected<nlohmann::json> body = BodyOf(request);
  if (!body) return ErrorAnswer(body.error());
  const std::string what = body->value("what", nlohmann::json()).is_string() ? (*body)["what"].get<std::string>() : "";
  if (what == "picture") {
    const nlohmann::json format = body->value("format", nlohmann::json("png"));
    return ExportPicture(format.is_string() ? format.get<std::string>() : "");
  }
  const Moment moment = Now();
  if (what == "command") {
    const PictureJob job = JobAt(moment, std::nullopt, StylesOf(moment).size() < 2);
    // A budget's choice depends on this machine's moment: the command repeats what was chosen.
    std::vector<std::string> chosen;
    if (job.budget.budget_ms > 0) {
      const Expected<Lane::Painted> painted = LaneOf(finals, job).Paint(job);
      if (!painted) return ErrorAnswer(painted.error(), kCannotPaint);
      if ((*painted)->choice) chosen = (*painted)->choice->options;
    }
    return JsonAnswer({{"command", CommandOf(job, chosen)}});
  }
  if (what != "style") return ErrorAnswer(UsageError("what: expected picture, style or command"));
  const Catalogue known = KnownCatalogue();
  const StyleEntry* const style = known.FindStyle(moment.state.style);
  if (!style) return ErrorAnswer(InputError("there is no style yet: choose one"), kCannotPaint);
  Expected<std::string> text = StyleText(*style, moment.state.keys);
  if (!text) return ErrorAnswer(text.error(), kCannotPaint);
  return {200,
          "text/plain; charset=utf-8",
          std::move(*text),
          {{"Content-Disposition", "attachment; filename=\"style.toml\""}}};
}

}  // namespace scumble
