// What a session holds, for the files that make it up: session.cpp (state, files), routes.cpp (calls), frame_calls.cpp
// (pictures), style_calls.cpp (exemplars, saving).
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/studio/session/catalogue.h"
#include "apps/studio/session/lane.h"
#include "apps/studio/session/session.h"
#include "apps/studio/session/state.h"
#include "apps/studio/session/watch.h"

namespace scumble {

// The state at one moment.
struct Moment {
  StudioState state;
  std::uint64_t revision = 0;
  std::uint64_t generation = 0;
};

// One painted sphere of a style, as the page lists it.
struct ExemplarFile {
  std::string file;
  int width = 0, height = 0;
  std::optional<double> luminance;  // that the style gives
};

// What is read of a style without preparing it; kept while its style.toml stays.
struct StyleFacts {
  std::string stamp;  // of the style.toml and the exemplars
  std::map<std::string, KeyValue> values;
  std::vector<StyleTrack> tracks;  // of the keys that change over time
  std::vector<ExemplarFile> exemplars;
};

struct Session::State {
  State(const StudioOptions& given, const RunContext& run, EventHub& hub);

  const StudioOptions options;
  const RunContext context;
  EventHub& events;
  // Of this run: the same settings may be another picture in another one.
  const std::string run_id;
  nlohmann::json first;  // what it began with; set before others see the session
  std::atomic<bool> stopped = false;

  std::mutex mutex;  // of what follows
  Catalogue catalogue;
  StudioState state;
  std::uint64_t revision = 1;
  std::uint64_t generation = 1;  // raised when a file has changed
  std::optional<Error> problem;
  std::string watched;               // what the files that are watched belong to
  std::vector<StyleEntry> compared;  // styles of the last pictures that were asked for beside the main one
  std::map<std::string, std::shared_ptr<const StyleFacts>> facts;  // by style id
  std::map<std::string, SceneDescription> descriptions;            // by what they depend on
  std::map<std::string, SceneDescription> last_descriptions;       // by scene file, the newest of each
  std::map<std::string, std::optional<int>> first_frames;          // by scene file and its stamp
  std::vector<std::string> scene_warnings;                         // of the scene that was painted last
  std::map<std::string, std::string> thumbnails;                   // by kind and id
  std::map<std::string, std::string> checks;                       // JSON, by the style's settings and generation
  nlohmann::json saves = nlohmann::json::array();                  // the newest of this run, as api.md has them

  std::mutex saving;  // one file is written at a time
  Lane finals, drafts, others;
  std::unique_ptr<FileWatch> watch;  // its thread uses all of the above

  Moment Now();
  Catalogue KnownCatalogue();
  PictureJob JobAt(Moment moment, std::optional<Explanation> show, bool is_alone = false);
  // The frame that is shown: of a glTF scene that moves the first one, where none is chosen. A .blend is shown at the
  // frame that it was saved at.
  std::optional<int> FrameOf(const Moment& moment, Lane& lane);
  // A .blend is exported for each workspace: it has one.
  Lane& LaneOf(Lane& wanted, const PictureJob& job);
  Expected<SceneDescription> Describe(const Moment& moment);
  // Of a scene that cannot be read at this moment, as it was when it could; none where it never could.
  std::optional<SceneDescription> LastDescription(const StudioState& of);
  Expected<std::shared_ptr<const StyleFacts>> FactsOf(const StyleEntry& style);
  // The styles of a picture in the order of their indices, each once: the first one, those of assignments, and those
  // that the scene asks for. ChosenStyles leaves these out and reads no scene.
  std::vector<StyleEntry> ChosenStyles(const StudioState& of);
  std::vector<StyleEntry> StylesOf(const Moment& moment);
  nlohmann::json StateJson();

  // Replaces the state; `why` is for the page.
  void Change(const std::function<void()>& change, const std::string& why);
  void Tell(const std::string& why);
  // Of a picture whose painting began then. Where it could not be painted, a file that appears may be what is missing.
  void WatchFilesOf(const Moment& moment, std::chrono::system_clock::time_point begun, bool is_painted);
  void FilesHaveChanged();
  void SetProblem(std::optional<Error> now);
  void SetWarnings(std::vector<std::string> now);

  HttpResponse Frame(const Moment& moment, const HttpRequest& request, const std::string& quality,
                     const std::string& format, const std::string& show, Lane& lane);
  HttpResponse GetFrame(const HttpRequest& request);
  HttpResponse PostFrame(const HttpRequest& request);
  HttpResponse Pick(const HttpRequest& request);
  HttpResponse Chunk(const HttpRequest& request);
  HttpResponse Fed(const HttpRequest& request);
  HttpResponse Export(const HttpRequest& request);
  HttpResponse ExportPicture(const std::string& format);
  HttpResponse Thumbnail(const HttpRequest& request);
  Expected<Lane::Painted> PaintedWithField();

  HttpResponse PatchState(const HttpRequest& request);
  HttpResponse ExemplarPicture(const HttpRequest& request);
  HttpResponse Check(const HttpRequest& request);
  HttpResponse Save(const HttpRequest& request);
  HttpResponse SaveAs(const HttpRequest& request);
  // Keys are written into the file of `style`. `from` is the style until then, and `of` what its file said. Call it in
  // Change.
  void NoteSave(const std::string& style, const Moment& from, const Expected<std::shared_ptr<const StyleFacts>>& of);
  nlohmann::json Saves();
  HttpResponse Paintable(const HttpRequest& request);
  HttpResponse Paint(const HttpRequest& request);
  Expected<ExemplarFile> ExemplarOf(const HttpRequest& request, bool of_first_style);
};

// An answer of JSON, and the answer to an error: the status follows from its kind, `otherwise` for kUsage and kInput.
HttpResponse JsonAnswer(const nlohmann::json& body);
HttpResponse ErrorAnswer(const Error& error, int otherwise = 400);
nlohmann::json ToJson(const Error& error);
// A whole number of the query. kUsage where it is none.
Expected<int> QueryNumber(const HttpRequest& request, const std::string& name, std::optional<int> otherwise);
// The body. kUsage where it is no JSON object.
Expected<nlohmann::json> BodyOf(const HttpRequest& request);
// "1234abcd" in quotes, of a text.
std::string EtagOf(const std::string& text);

}  // namespace scumble
