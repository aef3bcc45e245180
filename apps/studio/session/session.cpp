#include "apps/studio/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "apps/studio/session/busy.h"
#include "apps/studio/session/session_state.h"
#include "core/image/hash.h"
#include "core/io/picture_file.h"
#include "core/style/finish_chain.h"
#include "core/style/style_file.h"
#include "core/style/style_keyframes.h"
#include "pipeline/blender_scene.h"
#include "pipeline/file_stamp.h"
#include "pipeline/style_locations.h"

namespace scumble {
namespace {

using Clock = std::chrono::steady_clock;

RunContext ContextOf(const RunContext& context, EventHub& events) {
  RunContext ours = context;
  ours.on_message = nullptr;  // notes repeat with every picture
  ours.clock = nullptr;
  ours.on_progress = BusyReports(events);
  return ours;
}

// The description as it is from an orbit that says where it is.
Expected<SceneDescription> Seen(Expected<SceneDescription> described, const StudioState& state) {
  if (described && state.view && state.view->distance > 0.0) described->eye = *state.view;
  return described;
}

// The style's own file, and pictures beside it: those of a style that cannot be read are not known otherwise. Where one
// may be missing, the folders too.
void AddFilesAround(const StyleEntry& style, bool with_folders, std::vector<std::string>& files) {
  constexpr std::size_t kMostFiles = 64;
  std::error_code failed;
  const std::filesystem::path toml = style.toml();
  files.push_back((toml.empty() ? style.path : toml).string());
  const std::filesystem::path& there = toml.empty() ? style.path : toml;
  const std::filesystem::path folder = there.has_parent_path() ? there.parent_path() : std::filesystem::path(".");
  if (with_folders) files.push_back(folder.string());
  if (toml.empty()) return;
  std::size_t count = 0;
  std::filesystem::directory_iterator at(folder, failed);
  for (; !failed && at != std::filesystem::directory_iterator(); at.increment(failed)) {
    const std::filesystem::directory_entry& entry = *at;
    std::error_code none;
    if (with_folders && entry.is_directory(none) && ++count <= kMostFiles) files.push_back(entry.path().string());
    const bool is_picture =
        HasEnding(entry.path().string(), {".png", ".ora", ".kra", ".psd", ".exr", ".tif", ".tiff", ".jpg", ".jpeg"});
    if (is_picture && ++count <= kMostFiles) files.push_back(entry.path().string());
  }
}

Expected<std::shared_ptr<const StyleFacts>> ReadFacts(const StyleEntry& style) {
  StyleFacts facts;
  SCUMBLE_ASSIGN(facts.values, StyleValues(style.path));
  SCUMBLE_ASSIGN(Style read, LoadStyle(style.path));
  if (!read.unpainted.empty()) read.exemplars.clear();  // a made-up one
  facts.tracks = std::move(read.tracks);
  for (const Exemplar& one : read.exemplars) {
    const int width = one.cut ? one.cut->file_width : one.picture.width + 2 * one.margin;
    const int height = one.cut ? one.cut->file_height : one.picture.height + 2 * one.margin;
    facts.exemplars.push_back({one.name, width, height, one.luminance});
  }
  return std::make_shared<const StyleFacts>(std::move(facts));
}

// What the style's file says of each key at a frame, and those that change over time as their text.
void AddFileKeys(const StyleFacts& of, int frame, nlohmann::json& json) {
  const auto in_json = [](const KeyValue& value) {
    return std::visit([](const auto& held) { return nlohmann::json(held); }, value);
  };
  for (const StyleKey& key : StyleKeys()) {
    const auto value = of.values.find(key.name);
    if (value != of.values.end()) json["file_keys"][key.name] = in_json(value->second);
  }
  for (const StyleTrack& track : of.tracks) {
    if (!of.values.count(track.name)) continue;  // of a finishing pass
    json["file_keys"][track.name] = in_json(ValueAt(track, frame));
    json["key_frames"][track.name] = ToText(track);
  }
}

std::string HashOf(const StudioState& state) { return fmt::format("{:016x}", HashText(ToJson(state).dump())); }

}  // namespace

Session::State::State(const StudioOptions& given, const RunContext& run, EventHub& hub)
    : options(given),
      context(ContextOf(run, hub)),
      events(hub),
      run_id(fmt::format("{}", std::chrono::system_clock::now().time_since_epoch().count())),
      finals(context),
      drafts(context),
      others(context),
      watch(std::make_unique<FileWatch>([this](const std::vector<std::string>&) { FilesHaveChanged(); })) {}

Moment Session::State::Now() {
  const std::lock_guard lock(mutex);
  return {state, revision, generation};
}

Catalogue Session::State::KnownCatalogue() {
  const std::lock_guard lock(mutex);
  return catalogue;
}

PictureJob Session::State::JobAt(Moment moment, std::optional<Explanation> show, bool is_alone) {
  moment.state.frame = FrameOf(moment, drafts);
  PictureJob job = JobOf(moment.state, KnownCatalogue(), options.scene, is_alone);
  job.key = job.state += fmt::format(" generation {}", moment.generation);
  if (show) job.key += fmt::format(" show {}", int(*show));
  job.picture.show = show;
  return job;
}

Lane& Session::State::LaneOf(Lane& wanted, const PictureJob& job) {
  return IsBlenderScene(job.scene.scene) ? finals : wanted;
}

std::optional<int> Session::State::FrameOf(const Moment& moment, Lane& lane) {
  const Catalogue known = KnownCatalogue();
  const SceneEntry* const scene = known.FindScene(moment.state.scene);
  if (moment.state.frame || !scene || IsBlenderScene(scene->file)) return moment.state.frame;
  const std::string key = scene->file + "\n" + StampOf(scene->file);
  {
    const std::lock_guard lock(mutex);
    const auto found = first_frames.find(key);
    if (found != first_frames.end()) return found->second;
  }
  SceneRequest request = options.scene;
  request.scene = scene->file, request.camera.clear(), request.view.reset();
  const Expected<SceneDescription> described = lane.Describe(request, std::nullopt);
  if (!described) return std::nullopt;  // the picture's error says why
  const std::optional<int> start = described->animation ? std::optional(described->animation->first) : std::nullopt;
  const std::lock_guard lock(mutex);
  constexpr std::size_t kMostFrames = 64;
  if (first_frames.size() >= kMostFrames) first_frames.clear();
  return first_frames[key] = start;
}

std::optional<SceneDescription> Session::State::LastDescription(const StudioState& of) {
  const std::lock_guard lock(mutex);
  const SceneEntry* const scene = catalogue.FindScene(of.scene);
  const auto known = scene ? last_descriptions.find(scene->file) : last_descriptions.end();
  return known != last_descriptions.end() ? std::optional(known->second) : std::nullopt;
}

Expected<SceneDescription> Session::State::Describe(const Moment& moment) {
  PictureJob job = JobAt(moment, std::nullopt);
  // An orbit that says where it is needs no scene to tell; posing it here would only keep the next picture waiting.
  const bool is_known = job.scene.view && job.scene.view->distance > 0.0;
  if (is_known) job.scene.view.reset(), job.scene.camera.clear(), job.picture.frame.reset();
  const std::string key = fmt::format("{} {} {} {} {} {}", job.scene.scene, job.scene.camera, moment.generation,
                                      job.picture.frame.value_or(-1), SizeToText(job.scene.size),
                                      job.scene.view ? ToJson(*job.scene.view).dump() : "");
  {
    const std::lock_guard lock(mutex);
    const auto known = descriptions.find(key);
    if (known != descriptions.end()) return Seen(known->second, moment.state);
  }
  const Expected<SceneDescription> described = LaneOf(drafts, job).Describe(job.scene, job.picture.frame);
  if (!described) return described;
  const std::lock_guard lock(mutex);
  constexpr std::size_t kMostDescriptions = 64;
  if (descriptions.size() >= kMostDescriptions) descriptions.clear();
  descriptions.emplace(key, *described);
  last_descriptions[job.scene.scene] = *described;
  return Seen(described, moment.state);
}

Expected<std::shared_ptr<const StyleFacts>> Session::State::FactsOf(const StyleEntry& style) {
  const auto stamp_of = [&](const StyleFacts& of) {
    std::string stamp = StampOf((style.toml().empty() ? style.path : style.toml()).string());
    for (const ExemplarFile& one : of.exemplars) stamp += " " + StampOf(one.file);
    return stamp;
  };
  {
    const std::lock_guard lock(mutex);
    const auto known = facts.find(style.id);
    if (known != facts.end() && known->second->stamp == stamp_of(*known->second)) return known->second;
  }
  const auto begun = std::chrono::system_clock::now();
  SCUMBLE_ASSIGN(const std::shared_ptr<const StyleFacts> read, ReadFacts(style));
  StyleFacts stamped = *read;
  stamped.stamp = stamp_of(stamped);
  bool is_whole = !HasChangedSince((style.toml().empty() ? style.path : style.toml()).string(), begun);
  for (const ExemplarFile& one : stamped.exemplars) is_whole = is_whole && !HasChangedSince(one.file, begun);
  if (!is_whole) stamped.stamp.clear();  // they are read again
  auto kept = std::make_shared<const StyleFacts>(std::move(stamped));
  const std::lock_guard lock(mutex);
  facts[style.id] = kept;
  return kept;
}

std::vector<StyleEntry> Session::State::ChosenStyles(const StudioState& of) {
  const Catalogue known = KnownCatalogue();
  std::vector<StyleEntry> styles;
  const auto add = [&](const std::string& id) {
    const StyleEntry* const entry = known.FindStyle(id);
    const bool is_there = std::any_of(styles.begin(), styles.end(), [&](auto& style) { return style.id == id; });
    if (entry && !is_there) styles.push_back(*entry);
  };
  add(of.style);
  for (const StudioAssignment& one : of.assignments) add(one.style);
  return styles;
}

std::vector<StyleEntry> Session::State::StylesOf(const Moment& moment) {
  std::vector<StyleEntry> styles = ChosenStyles(moment.state);
  if (moment.state.scene.empty()) return styles;
  const Expected<SceneDescription> now = Describe(moment);
  const std::optional<SceneDescription> described = now ? std::optional(*now) : LastDescription(moment.state);
  if (!described) return styles;
  std::vector<NamePattern> patterns;
  for (const StudioAssignment& one : moment.state.assignments) patterns.emplace_back(one.name);
  const std::lock_guard lock(mutex);
  const SceneEntry* const scene = catalogue.FindScene(moment.state.scene);
  for (const std::string& name : StylesAskedFor(described->style_requests, patterns)) {
    const auto path = FindStyle(name, context, std::filesystem::path(scene->file).parent_path());
    if (!path) continue;  // the picture's error says so
    const std::string id = catalogue.AddStyle(path->string(), *path, IsBundledStyle(*path, context));
    const bool is_there = std::any_of(styles.begin(), styles.end(), [&](auto& style) { return style.id == id; });
    if (!is_there) styles.push_back(*catalogue.FindStyle(id));
  }
  return styles;
}

nlohmann::json Session::State::StateJson() {
  Moment moment = Now();
  const std::string hash = HashOf(moment.state);
  moment.state.frame = FrameOf(moment, drafts);
  nlohmann::json json = ToJson(moment.state);
  json["revision"] = moment.revision;
  json["run"] = run_id, json["first"] = first, json["as_started"] = first["options"].get<std::string>() == hash;
  const std::vector<StyleEntry> styles = StylesOf(moment);  // first: the scene's come into the catalogue
  const Catalogue known = KnownCatalogue();
  json["scenes"] = json["styles"] = json["finishes"] = json["exemplars"] = nlohmann::json::array();
  for (const SceneEntry& scene : known.scenes) {
    json["scenes"].push_back({{"id", scene.id}, {"name", scene.id}, {"bundled", scene.bundled}});
  }
  for (const StyleEntry& style : known.styles) {
    json["styles"].push_back({{"id", style.id},
                              {"name", style.id},
                              {"bundled", style.bundled},
                              {"writable", style.IsWritable()},
                              {"save_as", true}});
  }
  for (const FinishEntry& finish : known.finishes)
    json["finishes"].push_back({{"name", finish.name}, {"help", finish.help}});
  std::optional<Error> found;
  int index = 0;
  json["file_keys"] = json["key_frames"] = nlohmann::json::object();
  for (const StyleEntry& style : styles) {
    const auto of = FactsOf(style);
    if (!of) found = of.error();
    for (std::size_t i = 0; of && i < (*of)->exemplars.size(); ++i) {
      const ExemplarFile& one = (*of)->exemplars[i];
      json["exemplars"].push_back({{"index", i},
                                   {"style", index},
                                   {"style_id", style.id},
                                   {"file", std::filesystem::path(one.file).filename().string()},
                                   {"width", one.width},
                                   {"height", one.height},
                                   {"luminance", one.luminance ? nlohmann::json(*one.luminance) : nullptr}});
    }
    if (index == 0 && of) AddFileKeys(**of, moment.state.frame.value_or(0), json);
    ++index;
  }
  SceneDescription scene;
  if (!moment.state.scene.empty()) {
    const Expected<SceneDescription> described = Describe(moment);
    scene = described ? *described : LastDescription(moment.state).value_or(scene);
    if (!described && described.error().kind != ErrorKind::kCancelled) found = described.error();
  }
  json["cameras"] = scene.cameras, json["objects"] = scene.objects, json["materials"] = scene.materials;
  json["lights"] = scene.lights, json["eye"] = ToJson(scene.eye);
  json["animation"] = nullptr;
  if (scene.animation) {
    const FrameSpan& span = *scene.animation;
    json["animation"] = {{"first", span.first},
                         {"last", span.last},
                         {"fps", span.fps},
                         {"saved", span.saved ? nlohmann::json(*span.saved) : nullptr}};
  }
  const std::lock_guard lock(mutex);
  json["warnings"] = scene_warnings;
  json["saves"] = saves;
  if (problem) found = problem;
  json["problem"] = found ? ToJson(*found) : nlohmann::json();
  return json;
}

HttpResponse Session::State::PatchState(const HttpRequest& request) {
  const Expected<nlohmann::json> body = BodyOf(request);
  if (!body) return ErrorAnswer(body.error());
  {
    const std::lock_guard lock(mutex);
    Expected<StudioState> next = Patched(state, *body, catalogue);
    if (!next) return ErrorAnswer(next.error(), next.error().kind == ErrorKind::kInput ? 404 : 400);
    // Files of what was not shown were not watched.
    const auto styles_of = [](const StudioState& of) { return ToJson(of)["assignments"]; };
    if (next->scene != state.scene || next->style != state.style || styles_of(*next) != styles_of(state)) ++generation;
    state = std::move(*next);
    ++revision;
  }
  Tell("patch");
  return JsonAnswer(StateJson());
}

void Session::State::Change(const std::function<void()>& change, const std::string& why) {
  {
    const std::lock_guard lock(mutex);
    change();
    ++revision;
  }
  Tell(why);
}

void Session::State::Tell(const std::string& why) {
  events.Publish("state", nlohmann::json{{"revision", Now().revision}, {"why", why}}.dump());
}

// After a picture: what it was made of.
void Session::State::WatchFilesOf(const Moment& moment, std::chrono::system_clock::time_point begun, bool is_painted) {
  const PictureJob job = JobAt(moment, std::nullopt);
  std::string belongs = fmt::format("{}\n{}\n{}\n{} {}", job.scene.scene, job.style.style,
                                    fmt::join(job.style.assigned, "\n"), moment.generation, is_painted);
  std::vector<StyleEntry> styles = ChosenStyles(moment.state);
  {
    const std::lock_guard lock(mutex);
    for (const StyleEntry& style : compared) belongs += "\n" + style.id, styles.push_back(style);
    if (watched == belongs) return;
    watched = belongs;
  }
  Lane& lane = LaneOf(finals, job);
  const Expected<SceneDescription> described = lane.Describe(job.scene, job.picture.frame);
  std::vector<std::string> files = lane.SceneFiles();
  files.push_back(job.scene.scene);
  if (described) {
    files.insert(files.end(), described->style_files.begin(), described->style_files.end());
    SetWarnings(described->warnings);
  }
  // The names in a folder count only where a file may be missing.
  std::erase_if(files, [](const std::string& file) {
    std::error_code failed;
    return std::filesystem::is_directory(file, failed);
  });
  for (const StyleEntry& style : styles) AddFilesAround(style, !is_painted, files);
  watch->Watch(files, begun);
}

void Session::State::SetProblem(std::optional<Error> now) {
  nlohmann::json text;
  {
    const std::lock_guard lock(mutex);
    if (!problem && !now) return;
    problem = now;
    if (now) text = ToJson(*now);
  }
  events.Publish("problem", text.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void Session::State::SetWarnings(std::vector<std::string> now) {
  {
    const std::lock_guard lock(mutex);
    if (scene_warnings == now) return;
    scene_warnings = now;
  }
  events.Publish("warnings", nlohmann::json(now).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

// The picture is painted before the page is told: it finds it ready. A file that cannot be read may be half written: it
// is tried for two seconds before the page is told of that.
void Session::State::FilesHaveChanged() {
  const auto deadline = Clock::now() + std::chrono::seconds(2);
  while (!stopped) {
    const auto begun = std::chrono::system_clock::now();
    Moment moment;
    {
      const std::lock_guard lock(mutex);
      ++generation;
      moment = {state, revision, generation};
    }
    if (moment.state.scene.empty() || moment.state.style.empty()) return;
    moment.state.frame = FrameOf(moment, finals);  // which reads the scene for the picture, too
    const PictureJob job = JobAt(moment, std::nullopt);
    const Expected<Lane::Painted> painted = LaneOf(finals, job).Paint(job);
    if (painted || painted.error().kind == ErrorKind::kCancelled) {
      if (painted) SetProblem(std::nullopt);
      Change([] {}, "files");
      if (painted) WatchFilesOf(moment, begun, true);
      return;
    }
    if (watch->SeesChanges()) return;  // it is called again
    if (Clock::now() > deadline) {
      WatchFilesOf(moment, begun, false);
      return SetProblem(painted.error());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

Session::Session(std::unique_ptr<State> state) : state_(std::move(state)) {}

Session::~Session() {
  Stop();
  state_->watch->Stop();  // its thread uses the watch, too
}

void Session::Stop() {
  state_->stopped = true;
  state_->finals.Stop(), state_->drafts.Stop(), state_->others.Stop();
}

Expected<std::unique_ptr<Session>> Session::Open(const StudioOptions& options, const RunContext& context,
                                                 EventHub& events) {
  SCUMBLE_ASSIGN(Catalogue catalogue, MakeCatalogue(options.scene.scene, options.styles, context));
  auto state = std::make_unique<State>(options, context, events);
  StudioState& first = state->state;
  // Something to look at from the start: Suzanne in oil, where nothing is named.
  const auto choose = [](const auto& entries, const char* wanted, bool is_named) -> std::string {
    if (entries.empty()) return "";
    for (const auto& entry : entries) {
      if (!is_named && entry.id == wanted) return entry.id;
    }
    return entries.front().id;
  };
  first.scene = choose(catalogue.scenes, "suzanne", !options.scene.scene.empty());
  first.style = choose(catalogue.styles, "oil", !options.styles.empty());
  first.camera = options.scene.camera, first.view = options.scene.view, first.light = options.scene.light;
  first.size = options.scene.size, first.seed = options.seed, first.frame = options.scene.blender.frame;
  state->first = {{"scene", first.scene}, {"style", first.style}};
  state->first["options"] = HashOf(first);
  state->catalogue = std::move(catalogue);
  return std::unique_ptr<Session>(new Session(std::move(state)));
}

}  // namespace scumble
