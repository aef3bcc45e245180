#include "pipeline/sequence.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <system_error>

#include "core/image/stopwatch.h"
#include "core/io/atomic_file.h"
#include "pipeline/stage_clock.h"

namespace scumble {

Expected<std::optional<Sequence>> PlanSequence(const SequenceRequest& options, std::optional<int> frame,
                                               const std::string& output) {
  if (options.frames.empty()) {
    if (options.resume) return UsageError("--resume goes with --frames: say which frames are wanted");
    return std::optional<Sequence>();
  }
  if (frame) return UsageError("--frame and --frames exclude each other: leave one out");
  Sequence sequence;
  sequence.resume = options.resume;
  sequence.frames = options.frames;
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

Expected<std::vector<std::string>> NamesOf(const std::string& name, const std::optional<Sequence>& sequence) {
  if (!sequence) return std::vector<std::string>{name};
  SCUMBLE_ASSIGN(const FrameName parsed, FrameName::Parse(name));
  if (!parsed.has_place()) return std::vector<std::string>{name};
  std::vector<std::string> names;
  for (const int frame : sequence->frames) names.push_back(parsed.At(frame));
  return names;
}

Expected<std::vector<std::string>> LayerNamesOf(const std::string& name, const std::optional<Sequence>& sequence) {
  if (name.empty()) return std::vector<std::string>();
  if (!HasEnding(name, {".ora"})) {
    return UsageError("--layers-out " + name + ": expected a name that ends in .ora, an OpenRaster file");
  }
  SCUMBLE_ASSIGN(const FrameName parsed, FrameName::Parse(name));
  if (sequence && sequence->frames.size() > 1 && !parsed.has_place()) {
    return UsageError(
        fmt::format("--layers-out {} is one file for {} frames: write #### where the frame's number goes, as in "
                    "{}.####.ora",
                    name, sequence->frames.size(), name.substr(0, name.rfind('.'))));
  }
  return NamesOf(name, sequence);
}

Expected<std::string> NameOfOne(const std::string& name, std::optional<int> frame) {
  SCUMBLE_ASSIGN(const FrameName parsed, FrameName::Parse(name));
  if (frame) return parsed.At(*frame);
  if (parsed.must_have_frame()) {
    return UsageError(name + " has a place for a frame's number: say which with --frames 1-24, or --frame 7 for one");
  }
  return name;
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

// Whether an output can be kept. Notes why one that is there cannot. An error where it cannot be known.
Expected<bool> CanKeep(const Sequence& sequence, const SequenceWork& work, int frame, const RunContext& context) {
  const std::string output = sequence.output.At(frame);
  const Status whole = work.check(frame, output);
  if (!whole && whole.error().kind != ErrorKind::kInput) return whole.error();
  std::error_code failed;
  if (!whole && std::filesystem::exists(output, failed)) context.Note(whole.error().message + ": made again");
  return whole.ok();
}

// Counts what became of the frames, and passes it on to the listener.
class FrameCounters {
 public:
  FrameCounters(const Sequence& sequence, const SequenceListener& listener, const RunContext& context)
      : sequence_(sequence), listener_(listener), context_(context) {}

  void Made(int frame, const FrameReport& report) {
    ++totals_.made;
    if (listener_.made) listener_.made(frame, sequence_.output.At(frame), report);
  }
  void Kept(int frame) {
    ++totals_.kept;
    if (listener_.kept) listener_.kept(frame, sequence_.output.At(frame));
  }
  bool HasAny() const { return totals_.made + totals_.kept > 0 || !totals_.failed.empty(); }
  // The error that ends the sequence, unless the other frames may go better.
  Status Fail(int frame, const Error& error) {
    if (error.kind == ErrorKind::kInput) {
      Failed(frame, error.message);
      return Ok();
    }
    if (HasAny()) EndAt(frame, error);
    return Error{error.kind, fmt::format("frame {}: {}", frame, error.message)};
  }
  // The frame at which the sequence ends; what is cancelled fails nowhere.
  void EndAt(int frame, const Error& error) {
    if (error.kind == ErrorKind::kCancelled) return;
    if (listener_.failed) listener_.failed(frame, sequence_.output.At(frame), error.message);
    totals_.failed.push_back(frame);
  }
  SequenceTotals Totals(double total_ms) {
    totals_.total_ms = total_ms, totals_.resumed = sequence_.resume;
    return std::move(totals_);
  }

 private:
  void Failed(int frame, const std::string& reason) {
    if (listener_.failed) listener_.failed(frame, sequence_.output.At(frame), reason);
    // One reason for many frames, as when Blender crashed or all guides lack a layer, is warned of once.
    const std::string kind = WithoutNumber(reason, frame);
    if (totals_.failed.empty() || kind != last_kind_) context_.Warn(fmt::format("frame {}: {}", frame, reason));
    if (totals_.failed.empty()) totals_.first_reason = reason;
    last_kind_ = kind;
    totals_.failed.push_back(frame);
  }

  const Sequence& sequence_;
  const SequenceListener& listener_;
  const RunContext& context_;
  SequenceTotals totals_;
  std::string last_kind_;
};

// The frame that is written while the next one is made; at once, where there is one thread alone or no other to be had.
class FramesBeingWritten {
 public:
  FramesBeingWritten(FrameCounters& counters, const RunContext& context) : counters_(counters), context_(context) {}

  Status Begin(int frame, const FrameWrite& write) {
    frame_ = frame;
    if (context_.threads != 1) {
      try {
        report_ = std::async(std::launch::async, write);
        return Ok();
      } catch (const std::system_error&) {
        // The limit of processes is reached, or memory's.
      }
    }
    Expected<FrameReport> report = write();
    context_.EndStage("write");
    return Report(std::move(report));
  }

  // Waits for it, if there is one, and reports it.
  Status Finish() {
    if (!report_.valid()) return Ok();
    Expected<FrameReport> report = report_.get();
    context_.EndStage("waiting");
    if (context_.clock && report) context_.clock->Add("write", report->write_ms);
    return Report(std::move(report));
  }

 private:
  Status Report(Expected<FrameReport> report) {
    if (!report) return counters_.Fail(frame_, report.error());
    counters_.Made(frame_, *report);
    return Ok();
  }

  FrameCounters& counters_;
  const RunContext& context_;
  int frame_ = 0;
  std::future<Expected<FrameReport>> report_;  // waits at its end, so that no thread outlives what it uses
};

Status MakeFrames(std::span<const int> frames, const Sequence& sequence, const SequenceWork& work,
                  FrameCounters& counters, const RunContext& context, const Progress& progress) {
  FramesBeingWritten writing(counters, context);
  const double steps = static_cast<double>(frames.size() + 1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double done = static_cast<double>(i + 1);
    Expected<FrameWrite> made =
        work.make(frames[i], sequence.output.At(frames[i]), Within(progress, done / steps, (done + 1.0) / steps));
    SCUMBLE_RETURN_IF_ERROR(writing.Finish());  // the report of a frame comes before the next one's
    if (made) {
      SCUMBLE_RETURN_IF_ERROR(writing.Begin(frames[i], *made));
    } else {
      SCUMBLE_RETURN_IF_ERROR(counters.Fail(frames[i], made.error()));
    }
  }
  return writing.Finish();
}

}  // namespace

Expected<SequenceTotals> RunSequence(const Sequence& sequence, const SequenceWork& work,
                                     const SequenceListener& listener, const RunContext& context,
                                     const Progress& progress) {
  Stopwatch watch;
  FrameCounters counters(sequence, listener, context);
  const auto run = [&]() -> Status {
    std::vector<int> frames;
    for (const int frame : sequence.frames) {
      bool keep = false;
      if (sequence.resume) {
        SCUMBLE_ASSIGN(keep, CanKeep(sequence, work, frame, context));
      }
      if (keep) {
        counters.Kept(frame);
        continue;
      }
      const std::string output = sequence.output.At(frame);
      // Outputs that might be kept were not checked; one stands for their folder.
      const bool is_first = sequence.resume && frames.empty();
      if (is_first || MayRefuseWriting(output)) SCUMBLE_RETURN_IF_ERROR(CheckWritable(output));
      frames.push_back(frame);
    }
    if (frames.empty()) return Ok();
    const double beginning = 1.0 / static_cast<double>(frames.size() + 1);
    std::optional<int> failed_at;
    const Status begun = work.begin(frames, Within(progress, 0.0, beginning), failed_at);
    if (!begun && failed_at && begun.error().kind == ErrorKind::kInput) {
      // A frame that is kept has its place in the report: the first that is to be made stands for it.
      const bool is_left = std::find(frames.begin(), frames.end(), *failed_at) != frames.end();
      counters.EndAt(is_left ? *failed_at : frames.front(), begun.error());
    }
    SCUMBLE_RETURN_IF_ERROR(begun);
    return MakeFrames(frames, sequence, work, counters, context, progress);
  };
  const Status made = run();
  if (!made && !counters.HasAny()) return made.error();
  SequenceTotals totals = counters.Totals(watch.Lap());
  if (!made) totals.ended_by = made.error();
  return totals;
}

Status StatusOf(const SequenceTotals& totals) {
  if (totals.ended_by) return *totals.ended_by;
  if (totals.failed.empty()) return Ok();
  return InputError(fmt::format("{} of {} frames were not made: {}; the first: {}", totals.failed.size(),
                                totals.frames(), FramesToText(totals.failed), totals.first_reason));
}

}  // namespace scumble
