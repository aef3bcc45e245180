// A frame's report as text and as JSON, one for a picture or a range of frames.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/app/command.h"
#include "pipeline/frame_report.h"
#include "pipeline/run_requests.h"
#include "pipeline/sequence.h"

namespace scumble {

std::string FrameToText(const FrameReport& report);
nlohmann::ordered_json FrameToJson(const FrameReport& report);

// Prints each frame of a sequence when it is done; under --json the frames are collected for one object.
class SequencePrinter {
 public:
  explicit SequencePrinter(const Globals& globals);
  ~SequencePrinter();

  // Valid while this lives.
  SequenceListener Listener();

 private:
  friend Expected<ExitCode> PrintRun(const RunReport& report, const Globals& globals, SequencePrinter& printer);

  const Globals& globals_;
  std::unique_ptr<nlohmann::ordered_json> entries_;
};

// Prints the report of a run: the picture's, or the totals of a sequence, or a plan alone. Returns the error of frames
// that failed.
Expected<ExitCode> PrintRun(const RunReport& report, const Globals& globals, SequencePrinter& printer);

}  // namespace scumble
