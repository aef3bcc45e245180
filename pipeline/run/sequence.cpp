#include "pipeline/run/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <system_error>

#include "apps/cli/app/json_text.h"
#include "pipeline/memory/memory_limit.h"
#include "apps/cli/app/timing.h"
#include "core/image/stopwatch.h"

namespace scumble {

void AddSequenceOptions(CLI::App& verb, SequenceOptions& options) {
  verb.add_option("--frames", options.frames,
                  "several frames: 1-24; 3,5-10; 12-24x2, every second; 10-1, backwards; -5--1. #### or %04d in the "
                  "names of files stands for the frame's number")
      ->type_name("RANGE");
  verb.add_flag("--resume", options.resume,
                "with --frames: keep frames whose output is there, whole, and made with these settings; all others are made again");
}

Expected<std::optional<Sequence>> PlanSequence(const SequenceOptions& options, std::optional<int> frame,
                                               const std::string& output) {
  if (options.frames.empty()) {
    if (options.resume) return UsageError("--resume goes with --frames: say which frames are wanted");
    return std::optional<Sequence>();
  }
  if (frame) return UsageError("--frame and --frames exclude each other: leave one out");
  Sequence sequence;
  sequence.resume = options.resume;
  SCUMBLE_ASSIGN(sequence.frames, ParseFrames(options.frames));
  SCUMBLE_ASSIGN(sequence.output, FrameName::Parse(output));
  if (sequence.frames.size() > 1 && !sequence.output.has_place() && !output.empty()) {
    const std::size_t dot = output.rfind('.');
    return UsageError(fmt::format(
        "-o {} is one file for {} frames: write #### where the frame's number goes, as in "
        "{}.####{}",
        output, sequence.frames.size(), output.substr(0, dot), dot == std::string::npos ? "" : output.substr(dot)));
  }
  return std::optional(std::move(sequence));
}

namespace {

std::string RefuseEmptyRate(const std::string& text) { return text.empty() ? "it is empty: give a rate, or leave it out" : ""; }

}  // namespace

void AddFpsOption(CLI::App& verb, std::string& fps, const std::string& help) {
  verb.add_option("--fps", fps, help)->type_name("RATE")->check(RefuseEmptyRate);
}

Expected<FrameRate> ParseFps(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto number = [](const std::string& part) {
    double value = 0;
    const auto [end, failure] = std::from_chars(part.data(), part.data() + part.size(), value);
    return failure == std::errc() && end == part.data() + part.size() ? value : 0.0;
  };
  const double above = number(text.substr(0, slash));
  const double below = slash == std::string::npos ? 1.0 : number(text.substr(slash + 1));
  if (!(above > 0.0 && above <= 1e5 && below >= 1.0 && below <= 1e5)) {
    return UsageError("--fps " + text + ": expected frames a second, as 24, 23.976 or 24000/1001");
  }
  return FrameRate{static_cast<std::int64_t>(above * 1000.0 + 0.5), static_cast<std::int64_t>(below * 1000.0 + 0.5)};
}

double SecondsAt(int frame, const FrameRate& rate) {
  const double seconds = static_cast<double>(frame * rate.denominator) / static_cast<double>(rate.numerator);
  return static_cast<double>(static_cast<float>(seconds));
}

Expected<std::vector<std::string>> NamesOf(const std::string& name, const std::optional<Sequence>& sequence) {
  if (!sequence) return std::vector<std::string>{name};
  SCUMBLE_ASSIGN(const FrameName parsed, FrameName::Parse(name));
  if (!parsed.has_place()) return std::vector<std::string>{name};
  std::vector<std::string> names;
  for (const int frame : sequence->frames) names.push_back(parsed.At(frame));
  return names;
}

Expected<std::string> NameOfOne(const std::string& name, std::optional<int> frame) {
  SCUMBLE_ASSIGN(const FrameName parsed, FrameName::Parse(name));
  if (frame) return parsed.At(*frame);
  if (parsed.must_have_frame()) {
    return UsageError(name + " has a place for a frame's number: say which with --frames 1-24, or --frame 7 for one");
  }
  return name;
}

Progress Within(const Progress& progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](double share) { return progress(from + (to - from) * share); };
}

namespace {

// A reason without the frame's number, as names of files have it.
std::string WithoutNumber(const std::string& reason, int frame) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::string text;
  for (std::size_t i = 0; i < reason.size();) {
    std::size_t end = i;
    while (end < reason.size() && is_digit(reason[end])) ++end;
    int number = 0;
    const auto [stop, failure] = std::from_chars(reason.data() + i, reason.data() + end, number);
    const bool is_frame = failure == std::errc() && number == std::abs(frame);
    const std::size_t next = std::max(end, i + 1);
    text += is_frame ? "#" : reason.substr(i, next - i);
    i = next;
  }
  return text;
}

// Whether an output can be kept; says why one that is there cannot. An error where it cannot be known.
Expected<bool> CanKeep(const Sequence& sequence, const SequenceWork& work, int frame, const Globals& globals) {
  const std::string output = sequence.output.At(frame);
  const Status whole = work.check(frame, output);
  if (!whole && whole.error().kind != ErrorKind::kInput) return whole.error();
  std::error_code failed;
  if (!whole && std::filesystem::exists(output, failed)) Say(globals, whole.error().message + ": made again");
  return whole.ok();
}

// What became of the frames so far.
class Tally {
 public:
  Tally(const Sequence& sequence, ProgressBar& bar, const Globals& globals)
      : sequence_(sequence), bar_(bar), globals_(globals) {}

  void Made(int frame, FrameReport report) {
    nlohmann::ordered_json json = Entry(frame, "made");
    json.update(report.json);
    Add(std::move(json), report.text);
    ++made_;
  }
  void Kept(int frame) {
    Add(Entry(frame, "kept"), sequence_.output.At(frame) + "  kept\n");
    ++kept_;
  }
  // The error that ends the sequence, unless the other frames may go better.
  Status Fail(int frame, const Error& error) {
    if (error.kind != ErrorKind::kInput) return Error{error.kind, fmt::format("frame {}: {}", frame, error.message)};
    Failed(frame, error.message);
    return Ok();
  }
  void Failed(int frame, const std::string& reason) {
    nlohmann::ordered_json json = Entry(frame, "failed");
    json["error"] = reason;
    Add(std::move(json), "");
    // One reason for many frames, as when Blender crashed or all guides lack a layer, is said once.
    const std::string kind = WithoutNumber(reason, frame);
    if (failed_.empty() || kind != last_kind_) Warn(fmt::format("frame {}: {}", frame, reason));
    if (failed_.empty()) first_reason_ = reason;
    last_kind_ = kind;
    failed_.push_back(frame);
  }

  void PrintTotals(double total_ms, const nlohmann::ordered_json& more) {
    bar_.Clear();
    const std::size_t all = sequence_.frames.size();
    if (globals_.json) {
      nlohmann::ordered_json json{{"frames", std::move(entries_)},
                                  {"made", made_},
                                  {"kept", kept_},
                                  {"failed", failed_.size()},
                                  {"total_ms", total_ms},
                                  {"memory", {{"peak_bytes", PeakMemory()}}}};
      json.update(more);
      if (globals_.timing) json["timing"] = globals_.timing->ToJson();
      Print(JsonText(json));
      return;
    }
    std::string text = fmt::format("{} frame{}: {} made", all, all == 1 ? "" : "s", made_);
    if (sequence_.resume) text += fmt::format(", {} kept", kept_);
    if (!failed_.empty()) text += fmt::format(", {} not made", failed_.size());
    Print(text + fmt::format("; {:.1f} s\n", total_ms / 1000.0));
    if (globals_.timing) Print(globals_.timing->ToText());
  }

  Expected<ExitCode> Result() const {
    if (failed_.empty()) return ExitCode::kOk;
    return InputError(fmt::format("{} of {} frames were not made: {}; the first: {}", failed_.size(),
                                  sequence_.frames.size(), FramesToText(failed_), first_reason_));
  }

 private:
  nlohmann::ordered_json Entry(int frame, const char* state) const {
    return {{"frame", frame}, {"state", state}, {"output", sequence_.output.At(frame)}};
  }
  void Add(nlohmann::ordered_json json, const std::string& text) {
    bar_.Clear();
    if (globals_.json) {
      entries_.push_back(std::move(json));
    } else {
      Print(text);
      std::fflush(stdout);  // a farm's log shows how far it came; what goes wrong here is found when the program ends
    }
  }

  const Sequence& sequence_;
  ProgressBar& bar_;
  const Globals& globals_;
  nlohmann::ordered_json entries_ = nlohmann::ordered_json::array();
  std::vector<int> failed_;
  std::string first_reason_, last_kind_;
  int made_ = 0, kept_ = 0;
};

// The frame that is written while the next one is made; at once, where there is one thread alone or no other to be had.
class FramesBeingWritten {
 public:
  FramesBeingWritten(Tally& tally, const Globals& globals) : tally_(tally), globals_(globals) {}

  Status Begin(int frame, const FrameWrite& write) {
    frame_ = frame;
    if (globals_.threads != 1) {
      try {
        report_ = std::async(std::launch::async, write);
        return Ok();
      } catch (const std::system_error&) {
        // The limit of processes is reached, or memory's.
      }
    }
    Expected<FrameReport> report = write();
    EndStage(globals_, "write");
    return Tell(std::move(report));
  }

  // Waits for it, if there is one, and tells of it.
  Status Finish() {
    if (!report_.valid()) return Ok();
    Expected<FrameReport> report = report_.get();
    EndStage(globals_, "waiting");
    if (globals_.timing && report) globals_.timing->Add("write", report->write_ms);
    return Tell(std::move(report));
  }

 private:
  Status Tell(Expected<FrameReport> report) {
    if (!report) return tally_.Fail(frame_, report.error());
    tally_.Made(frame_, *std::move(report));
    return Ok();
  }

  Tally& tally_;
  const Globals& globals_;
  int frame_ = 0;
  std::future<Expected<FrameReport>> report_;  // waits at its end, so that no thread outlives what it uses
};

}  // namespace

Expected<ExitCode> RunSequence(const Sequence& sequence, const SequenceWork& work, ProgressBar& bar,
                               const Globals& globals) {
  Stopwatch watch;
  Tally tally(sequence, bar, globals);
  std::vector<int> frames;
  for (const int frame : sequence.frames) {
    bool keep = false;
    if (sequence.resume) {
      SCUMBLE_ASSIGN(keep, CanKeep(sequence, work, frame, globals));
    }
    if (keep) {
      tally.Kept(frame);
    } else {
      frames.push_back(frame);
    }
  }
  FramesBeingWritten writing(tally, globals);
  const double steps = static_cast<double>(frames.size() + 1);
  if (!frames.empty()) SCUMBLE_RETURN_IF_ERROR(work.begin(frames, bar.Part(0.0, 1.0 / steps)));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double done = static_cast<double>(i + 1);
    Expected<FrameWrite> made =
        work.make(frames[i], sequence.output.At(frames[i]), bar.Part(done / steps, (done + 1.0) / steps));
    SCUMBLE_RETURN_IF_ERROR(writing.Finish());  // what there is to tell of a frame comes before the next one's
    if (made) {
      SCUMBLE_RETURN_IF_ERROR(writing.Begin(frames[i], *made));
    } else {
      SCUMBLE_RETURN_IF_ERROR(tally.Fail(frames[i], made.error()));
    }
  }
  SCUMBLE_RETURN_IF_ERROR(writing.Finish());
  const nlohmann::ordered_json more = work.end ? work.end() : nlohmann::ordered_json::object();
  tally.PrintTotals(watch.Lap(), more);
  return tally.Result();
}

}  // namespace scumble
