// A range of frames: which to make, which to keep, which failed.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/progress.h"
#include "core/image/status.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/frame_range.h"
#include "pipeline/frame_report.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"

namespace scumble {

struct Sequence {
  std::vector<int> frames;  // never empty
  FrameName output;
  bool resume = false;
};

// The sequence that was asked for; nothing where it is one picture. `frame` is that of a single picture. A usage error
// where several frames would have one name, or the requests exclude each other.
Expected<std::optional<Sequence>> PlanSequence(const SequenceRequest& options, std::optional<int> frame,
                                               const std::string& output);

// The name of one picture: a place for the frame's number is filled. A usage error where there is such a place and no
// number.
Expected<std::string> NameOfOne(const std::string& name, std::optional<int> frame);

// The names of all frames' files; of one picture, whose place is filled, it is the name itself.
Expected<std::vector<std::string>> NamesOf(const std::string& name, const std::optional<Sequence>& sequence);

// Likewise of files of layers, one for each frame. A usage error where they do not end in .ora, or frames share one.
// None where `name` is empty.
Expected<std::vector<std::string>> LayerNamesOf(const std::string& name, const std::optional<Sequence>& sequence);

struct SequenceWork {
  // Ok where the frame's output is there, whole, and what would be made.
  std::function<Status(int frame, const std::string& output)> check;
  // Called once, with the frames that are left to make, unless there are none. An error ends the sequence; `failed_at`
  // is to be set to the frame whose fault it is, if it is one's.
  std::function<Status(std::span<const int> frames, const Progress& progress, std::optional<int>& failed_at)> begin;
  // Makes the frame, all but its file.
  std::function<Expected<FrameWrite>(int frame, const std::string& output, const Progress& progress)> make;
};

// Called for each frame when it is done, on the calling thread; any of them may be null.
struct SequenceListener {
  std::function<void(int frame, const std::string& output, const FrameReport& report)> made;
  std::function<void(int frame, const std::string& output)> kept;
  std::function<void(int frame, const std::string& output, const std::string& reason)> failed;
};

struct SequenceTotals {
  bool resumed = false;  // frames could be kept
  std::size_t made = 0, kept = 0;
  std::vector<int> failed;
  std::string first_reason;  // why the first of them failed
  double total_ms = 0;
  std::optional<Error> ended_by;  // before its last frame

  std::size_t frames() const { return made + kept + failed.size(); }
};

// Makes the frames one after the other. With `resume` those that `check` accepts are left as they are. A frame whose
// input is missing or broken (kInput) does not stop the others: the totals name all of them. Any other error would come
// again in every frame, and ends the sequence: the totals tell of the frames until then and of that one, where others
// were made or kept, or `begin` failed at it. If that one is kept, the first that was to be made is named instead.
// A frame is encoded and written by another thread while the next one is made: two frames are in memory, never three,
// and where one cannot be written, the next has been made in vain. With one thread, or where no other can be started,
// it is written before the next one is begun. The reports and their order are the same.
Expected<SequenceTotals> RunSequence(const Sequence& sequence, const SequenceWork& work,
                                     const SequenceListener& listener, const RunContext& context,
                                     const Progress& progress);

// Ok, or the error that ended the sequence, or the kInput error of one in which frames failed.
Status StatusOf(const SequenceTotals& totals);

}  // namespace scumble
