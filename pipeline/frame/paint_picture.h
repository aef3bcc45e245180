// Guides and styles in, a picture file and its report out: what `transfer` and `stylize` have in common.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/progress.h"
#include "core/io/picture_file.h"
#include "pipeline/finish_set.h"
#include "pipeline/frame/frame_painter.h"
#include "pipeline/frame/provenance.h"
#include "pipeline/frame_report.h"
#include "pipeline/prepare_frame.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"
#include "transfer/transfer.h"

namespace scumble {

// Settings that --resume compares, of styles that are at the picture's frame. Rate, exposure, the samples of the
// guides' light and the guides' GuidesText where they are known already.
PictureSettings SettingsOf(const PictureRequest& request, std::optional<FrameRate> fps, std::optional<double> exposure,
                           const std::string& samples, const std::string& guides);

// The value of the attribute kSamplesKey; empty where guides do not have it.
std::string SamplesAsked(const std::map<std::string, std::string>& attributes);

// Where the guides come from.
struct GuideSource {
  std::string name;                    // the file, for messages
  StepTimes times;                     // of the steps that led to them
  std::vector<PlanItem> plan;          // reported unless it is empty
  std::optional<SceneCost> cost = {};  // of casting them, where they were cast
  MemoryNeed memory = {};              // of the whole run
  std::string chosen = {};             // of the layers in their file, for GuidesText
};

// The picture underneath: that of the view layer where it has one of that name, else the only one.
Expected<Picture> ReadUnderneath(const std::string& file, const std::string& view_layer);

// Reads PictureRequest::over, unless `state` has it already.
Status ReadOver(const PictureRequest& request, PictureState& state);

// A frame that is made, and has still to be encoded and written: does that once, on any thread, and needs nothing that
// the next frame changes.
using FrameWrite = std::function<Expected<FrameReport>()>;

// An exemplar of a source field.
struct FieldExemplar {
  std::string file;
  int left = 0, top = 0;      // of the part that is used, in the file's pixels
  int width = 0, height = 0;  // of that part
};

// A style of a source field. Position x of the field is at left + (x + 0.5) · FieldExemplar::width / width in the file;
// likewise y.
struct FieldStyle {
  std::string given;          // by the user or the scene
  std::string name;           // its own
  int width = 0, height = 0;  // of its exemplars as they are resized: the field's positions are pixels of these
  std::vector<FieldExemplar> exemplars;
};

// Where a picture's paint comes from. The field has the picture's size, but for a picture that is scaled up.
struct KeptField {
  std::shared_ptr<const SourceField> field;
  std::shared_ptr<const StyleMap> styles;  // null where one style paints all
  std::vector<FieldStyle> field_styles;    // by StyleMap::style
};

// The layers of a picture, and the picture itself where the request shows something else instead.
struct PaintedLayers {
  std::vector<FinishLayer> layers;
  std::optional<Picture> merged;
};

// A picture in memory, how its file is to be written, and its report without the step of writing.
struct PaintedPicture {
  Picture picture;
  PictureWriteOptions write;
  FrameReport report;
  KeptField kept;        // only with PictureRequest::keep_field
  PaintedLayers layers;  // only with PictureRequest::layers_out
};

// Prepares, transfers `repeat` times and makes the picture, or the explanation that was asked for.
Expected<PaintedPicture> PaintInMemory(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                                       const PictureRequest& request, const RunContext& context,
                                       const Progress& progress, PictureState& state);

// Writes the picture and, unless `layers_out` is empty, its layers; the report gets the step "write".
FrameWrite WriteOf(PaintedPicture painted, const std::string& output, const std::string& layers_out);

// As PaintInMemory; the returned function writes the picture to request.output and reports.
Expected<FrameWrite> PaintPicture(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                                  const PictureRequest& request, const RunContext& context, const Progress& progress,
                                  PictureState& state);

}  // namespace scumble
