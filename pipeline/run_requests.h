// Whole runs: `transfer`, `stylize` and `guidegen`, for one frame or a range.
//
// A run opens styles and scene, checks that no output takes the place of an input, estimates its memory, chooses a step
// of the quality ladder if that was asked for, paints, and writes. Errors leave older files as they are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/io/guide_file.h"
#include "pipeline/budget_choice.h"
#include "pipeline/frame_report.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/sequence.h"

namespace scumble {

// Guides and styles to pictures.
struct TransferRequest {
  std::string guides;       // .exr; a place for the frame's number, ####, for a range
  std::string view_layer;   // of a multilayer file; empty: the only one
  std::string light_layer;  // of a Blender render, the view layer with its passes of light; empty: `view_layer`
  std::string camera;       // the .camera file of a Blender render; empty: found from its Position pass
  StyleRequest style;
  PictureRequest picture;
  BudgetRequest budget;
  SequenceRequest sequence;
};

// A scene and styles to pictures. picture.seed, picture.fps and picture.frame count for the scene too.
struct StylizeRequest {
  SceneRequest scene;
  StyleRequest style;
  PictureRequest picture;
  BudgetRequest budget;
  SequenceRequest sequence;
  bool explain = false;  // report the plan; without an output it is all that is done
};

struct RunReport {
  std::optional<FrameReport> frame;        // of a single picture, or of a single set of guides
  std::optional<SequenceTotals> sequence;  // of a range; each frame went to the listener
  std::optional<BudgetChoice> choice;
  std::vector<std::string> warnings;  // each text once
  // Of a plan alone:
  std::vector<PlanItem> plan;
  MemoryNeed memory;
  StepTimes plan_times;        // of the steps that led to it
  bool plan_is_timed = false;  // stages are reported, too
};

// A scene to guide files.
struct GuidegenRequest {
  SceneRequest scene;                 // blender.frame is the frame of any moving scene
  std::optional<StyleRequest> style;  // adds the layers that it reads
  LayerSet layers;                    // on top of AlwaysWritten()
  GuideWriteOptions write;
  std::string output;  // empty: the plan alone
  SequenceRequest sequence;
  bool explain = false;  // report the plan
};

Expected<RunReport> RunTransfer(TransferRequest request, const SequenceListener& listener, const RunContext& context);
Expected<RunReport> RunStylize(StylizeRequest request, const SequenceListener& listener, const RunContext& context);
Expected<RunReport> RunGuidegen(GuidegenRequest request, const SequenceListener& listener, const RunContext& context);

}  // namespace scumble
