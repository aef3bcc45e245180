// The calls about exemplars and style files: reading, checking, painting over, saving.
#include <fmt/format.h>

#include "apps/studio/session/encode.h"
#include "apps/studio/session/exemplar_paint.h"
#include "apps/studio/session/session_state.h"
#include "apps/studio/session/style_files.h"
#include "core/io/atomic_file.h"
#include "core/io/picture_file.h"
#include "core/style/finish_chain.h"
#include "pipeline/check_style.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr int kUnreadable = 422, kRefused = 403;

nlohmann::json ToJson(const PaintTarget& target) {
  return {{"ok", true},
          {"stamp", target.stamp},
          {"file", target.file.filename().string()},
          {"width", target.width},
          {"height", target.height},
          {"layer", target.layer}};
}

}  // namespace

Expected<ExemplarFile> Session::State::ExemplarOf(const HttpRequest& request, bool of_first_style) {
  SCUMBLE_ASSIGN(const int index, QueryNumber(request, "exemplar", 0));
  int style = 0;
  if (!of_first_style) {
    SCUMBLE_ASSIGN(style, QueryNumber(request, "style", 0));
  }
  const std::vector<StyleEntry> styles = StylesOf(Now());
  if (style < 0 || std::size_t(style) >= styles.size()) return UsageError("style: there is none of this number");
  SCUMBLE_ASSIGN(const std::shared_ptr<const StyleFacts> of, FactsOf(styles[std::size_t(style)]));
  if (index < 0 || std::size_t(index) >= of->exemplars.size()) {
    return UsageError("exemplar: the style has none of this number");
  }
  return of->exemplars[std::size_t(index)];
}

HttpResponse Session::State::ExemplarPicture(const HttpRequest& request) {
  const Expected<ExemplarFile> exemplar = ExemplarOf(request, false);
  if (!exemplar) return ErrorAnswer(exemplar.error(), 404);
  const Expected<std::vector<std::byte>> bytes = ReadWholeFile(exemplar->file);
  if (!bytes) return ErrorAnswer(bytes.error(), kUnreadable);
  HttpResponse answer{200, "image/png", {reinterpret_cast<const char*>(bytes->data()), bytes->size()}, {}};
  const std::string etag = EtagOf(answer.body);
  answer.headers.emplace_back("ETag", etag);
  if (request.if_none_match == etag) return {304, "", "", answer.headers};
  if (answer.body.starts_with("\x89PNG\r\n")) return answer;  // the browser decodes it as well as we do
  const Expected<Picture> picture = ReadPicture(exemplar->file);
  if (!picture) return ErrorAnswer(picture.error(), kUnreadable);
  Expected<std::string> png = EncodeFrame(*picture, FrameFormat::kPng, false);
  if (!png) return ErrorAnswer(png.error());
  answer.body = std::move(*png);
  return answer;
}

HttpResponse Session::State::Check(const HttpRequest& request) {
  const Moment moment = Now();
  const std::vector<StyleEntry> styles = StylesOf(moment);
  const Expected<int> index = QueryNumber(request, "style", 0);
  if (!index) return ErrorAnswer(index.error());
  if (*index < 0 || std::size_t(*index) >= styles.size()) {
    return ErrorAnswer(UsageError("style: there is none of this number"), 404);
  }
  StyleRequest style;
  style.style = styles[std::size_t(*index)].given;
  if (*index == 0) {
    style.sets = JobOf(moment.state, KnownCatalogue(), options.scene, true).style.sets;
  }
  std::string key = fmt::format("{} {}", moment.generation, style.style);
  for (const StyleOverride& set : style.sets) key += "\n" + set.text;
  {
    const std::lock_guard lock(mutex);
    const auto found = checks.find(key);
    if (found != checks.end()) return {200, "application/json", found->second, {}};
  }
  const Expected<CheckedStyle> checked = CheckStyle(style, context.WithoutNotes());
  if (!checked) return ErrorAnswer(checked.error(), kUnreadable);
  nlohmann::json warnings = nlohmann::json::array();
  for (const FoundFault& found : checked->faults) {
    warnings.push_back({{"image", fs::path(found.image).filename().string()},
                        {"code", found.fault.code},
                        {"is_mistake", found.fault.weight == PaintFault::Weight::kMistake},
                        {"what", found.fault.what},
                        {"fix", found.fault.remedy}});
  }
  HttpResponse answer = JsonAnswer({{"warnings", warnings}});
  const std::lock_guard lock(mutex);
  constexpr std::size_t kMostChecks = 32;
  if (checks.size() >= kMostChecks) checks.clear();
  checks[key] = answer.body;
  return answer;
}

void Session::State::NoteSave(const std::string& style, const Moment& from,
                              const Expected<std::shared_ptr<const StyleFacts>>& of) {
  constexpr std::size_t kMostSaves = 20;
  StudioState file = from.state;  // with the file's values as its keys
  file.keys.clear();
  bool had_frames = false;
  for (const auto& [key, value] : from.state.keys) {
    if (!of) break;
    if (const auto found = (*of)->values.find(key); found != (*of)->values.end()) file.keys.insert(*found);
    for (const StyleTrack& track : (*of)->tracks) had_frames = had_frames || track.name == key;
  }
  const std::uint64_t number = saves.empty() ? 1 : saves.back()["number"].get<std::uint64_t>() + 1;
  saves.push_back({{"number", number},
                   {"style", style},
                   {"from", from.state.style},
                   {"keys", ToJson(from.state)["keys"]},
                   {"before", ToJson(file)["keys"]},
                   {"had_frames", had_frames}});
  if (saves.size() > kMostSaves) saves.erase(saves.begin());
}

nlohmann::json Session::State::Saves() {
  const std::lock_guard lock(mutex);
  return saves;
}

HttpResponse Session::State::Save(const HttpRequest&) {
  const std::lock_guard one(saving);
  const Moment moment = Now();
  const Catalogue known = KnownCatalogue();
  const StyleEntry* const style = known.FindStyle(moment.state.style);
  if (!style) return ErrorAnswer(InputError("there is no style yet: choose one"), kUnreadable);
  const auto of = FactsOf(*style);
  if (of) {
    for (const StyleTrack& track : (*of)->tracks) {
      if (!moment.state.keys.count(track.name)) continue;
      return ErrorAnswer(
          UsageError(fmt::format("{} gives {} a value for each of several frames, {}, which a save would "
                                 "replace: save the style as a new one, or reset this key first",
                                 style->toml().string(), track.name, ToText(track))),
          kRefused);
    }
  }
  const Status saved = SaveStyle(*style, moment.state.keys);
  if (!saved) return ErrorAnswer(saved.error(), saved.error().kind == ErrorKind::kUsage ? kRefused : kUnreadable);
  Change(
      [&] {
        ++generation;
        NoteSave(style->id, moment, of);
        // What was changed while the file was written stays changed.
        for (const auto& [key, value] : moment.state.keys) {
          const auto now = state.keys.find(key);
          if (now != state.keys.end() && now->second == value) state.keys.erase(now);
        }
      },
      "saved");
  return JsonAnswer({{"saved", style->toml().string()}, {"saves", Saves()}});
}

HttpResponse Session::State::SaveAs(const HttpRequest& request) {
  const Expected<nlohmann::json> body = BodyOf(request);
  if (!body) return ErrorAnswer(body.error());
  const nlohmann::json name = body->value("name", nlohmann::json());
  if (!name.is_string()) return ErrorAnswer(UsageError("name: expected a text"));
  const std::lock_guard one(saving);
  const Moment moment = Now();
  const Catalogue known = KnownCatalogue();
  const StyleEntry* const style = known.FindStyle(moment.state.style);
  if (!style) return ErrorAnswer(InputError("there is no style yet: choose one"), kUnreadable);
  const auto of = FactsOf(*style);
  std::error_code failed;
  const fs::path folder = options.save_to.empty() ? fs::current_path(failed) : options.save_to;
  const Expected<fs::path> made = SaveStyleAs(*style, moment.state.keys, folder, name.get<std::string>());
  if (!made) return ErrorAnswer(made.error(), made.error().kind == ErrorKind::kInput ? kUnreadable : 400);
  Change(
      [&] {
        state.style = catalogue.AddStyle(made->string(), *made, false);
        NoteSave(state.style, moment, of);
        state.keys.clear();
      },
      "saved");
  return JsonAnswer({{"saved", made->string()}, {"saves", Saves()}});
}

HttpResponse Session::State::Paintable(const HttpRequest& request) {
  const auto no = [](const std::string& why) { return JsonAnswer({{"ok", false}, {"why", why}}); };
  const Expected<ExemplarFile> exemplar = ExemplarOf(request, true);
  if (!exemplar) return no(exemplar.error().message);
  const Catalogue known = KnownCatalogue();
  const StyleEntry* const style = known.FindStyle(Now().state.style);
  if (!style || style->bundled) return no("a bundled style is not painted over: save it as a new one first");
  const Expected<PaintTarget> target = FindPaintTarget(exemplar->file);
  return target ? JsonAnswer(ToJson(*target)) : no(target.error().message);
}

HttpResponse Session::State::Paint(const HttpRequest& request) {
  const Expected<ExemplarFile> exemplar = ExemplarOf(request, true);
  if (!exemplar) return ErrorAnswer(exemplar.error(), 404);
  const Catalogue known = KnownCatalogue();
  const StyleEntry* const style = known.FindStyle(Now().state.style);
  if (!style || style->bundled) {
    return ErrorAnswer(UsageError("a bundled style is not painted over: save it as a new one first"), kRefused);
  }
  const auto stamp = request.query.find("stamp");
  if (stamp == request.query.end()) return ErrorAnswer(UsageError("stamp: it is missing"));
  {
    const std::lock_guard one(saving);
    const Status put = PutStrokes(exemplar->file, stamp->second, std::as_bytes(std::span(request.body)));
    if (!put) return ErrorAnswer(put.error(), put.error().kind == ErrorKind::kUsage ? kRefused : kUnreadable);
  }
  return Paintable(request);
}

}  // namespace scumble
