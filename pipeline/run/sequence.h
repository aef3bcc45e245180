// A range of frames: what to make, what to keep, what is missing, and how the whole is reported.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/app/command.h"
#include "pipeline/frame_range.h"
#include "apps/cli/app/progress_bar.h"
#include "core/image/progress.h"
#include "core/image/status.h"

namespace scumble {

struct SequenceOptions {
  std::string frames;  // as ParseFrames takes them; empty: one picture, no sequence
  bool resume = false;
};
void AddSequenceOptions(CLI::App& verb, SequenceOptions& options);

inline constexpr const char* kUsualFps = "24";

// Frames a second as a fraction, in thousandths above and below: "24", "23.976" or "24000/1001".
struct FrameRate {
  std::int64_t numerator = 24;
  std::int64_t denominator = 1;
};
void AddFpsOption(CLI::App& verb, std::string& fps, const std::string& help);
Expected<FrameRate> ParseFps(const std::string& text);

// When a frame is seen: frame / rate in seconds, rounded to float, because that is how files keep the times of their
// keys. A pose that jumps at a frame's key has jumped in that frame.
double SecondsAt(int frame, const FrameRate& rate);

// What one frame's work has to tell.
struct FrameReport {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::string text;  // one line or more, each ended
  double write_ms = 0;  // of that, encoding and writing
};

// A frame that is made, and has still to be encoded and written: does that once, on any thread, and needs nothing that the
// next frame changes.
using FrameWrite = std::function<Expected<FrameReport>()>;

struct Sequence {
  std::vector<int> frames;  // never empty
  FrameName output;
  bool resume = false;
};

// The sequence that was asked for; nothing where it is one picture. `frame` is --frame's. A usage error where several
// frames would have one name, or the options exclude each other.
Expected<std::optional<Sequence>> PlanSequence(const SequenceOptions& options, std::optional<int> frame,
                                               const std::string& output);

// The name of one picture: a place for the frame's number is filled. A usage error where there is such a place and no
// number.
Expected<std::string> NameOfOne(const std::string& name, std::optional<int> frame);

struct SequenceWork {
  // Ok where the frame's output is there, whole, and what would be made.
  std::function<Status(int frame, const std::string& output)> check;
  // Called once, with the frames that are left to make, unless there are none. An error ends the sequence.
  std::function<Status(std::span<const int> frames, const Progress& progress)> begin;
  // Makes the frame, all but its file.
  std::function<Expected<FrameWrite>(int frame, const std::string& output, const Progress& progress)> make;
  // Called once when all is done; what --json tells of the whole. May be null.
  std::function<nlohmann::ordered_json()> end = nullptr;
};

// Makes the frames one after the other and prints a line for each and one for all; under --json one object with an
// array `frames`. With `resume` those that `check` accepts are left as they are. A frame whose input is missing or
// broken (kInput) does not stop the others: the error at the end names all of them. Any other error would come again
// in every frame, and ends the sequence. A frame is encoded and written by another thread while the next one is made: so two
// frames are in memory, never three, and where one cannot be written, the next has been made in vain. Where there is one thread
// alone, or no other to be had, it is written before the next one is begun. What is told of them, and in which order, is the same.
Expected<ExitCode> RunSequence(const Sequence& sequence, const SequenceWork& work, ProgressBar& bar,
                               const Globals& globals);

// The names of all frames' files; of one picture, whose place is filled, it is the name itself.
Expected<std::vector<std::string>> NamesOf(const std::string& name, const std::optional<Sequence>& sequence);

// The part [from, to] of a progress.
Progress Within(const Progress& progress, double from, double to);

}  // namespace scumble
