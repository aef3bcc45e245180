#include "pipeline/run/picture_sequence.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/io/existing_output.h"
#include "core/io/picture_file.h"
#include "core/style/style_keyframes.h"
#include "finish/finish.h"
#include "pipeline/finish_files.h"
#include "pipeline/finish_set.h"

namespace scumble {
namespace {

constexpr const char* kColorsOption = "--set finish.NAME.from of a palette";  // gives the colours that are measured

// The request of one frame of a sequence: its own names, its own number.
Expected<PictureRequest> RequestAt(const PictureRequest& request, int frame, const std::string& output) {
  PictureRequest one = request;
  one.frame = frame, one.output = output;
  SCUMBLE_ASSIGN(const FrameName over, FrameName::Parse(request.over));
  one.over = over.At(frame);
  SCUMBLE_ASSIGN(const FrameName layers, FrameName::Parse(request.layers_out));
  one.layers_out = layers.At(frame);
  return one;
}

bool MeasuresFinish(const StyleSet& styles) { return !styles.options.finish_measures && EverLooksAtMeasures(styles); }

bool MeasuresColors(const StyleSet& styles) { return MeasuresColors(AllPasses(styles)); }

}  // namespace

Status PictureSequence::Begin(const Sequence& sequence, const Size& size, const GuidesAhead& ahead,
                              const Progress& progress, std::optional<int>& failed_at) {
  SCUMBLE_RETURN_IF_ERROR(ReadOverOfAll(size));
  if (!MustLookAhead(sequence)) return Ok();
  const auto is_exposed = [&] { return MeasuresExposure(styles_, request_); };  // a scene's styles come with its guides
  const auto measure = [&](int frame, const FrameGuides& found) -> Status {
    const GuideSet& guides = *found.guides;
    SCUMBLE_ASSIGN(const PictureRequest one, RequestAt(request_, frame, request_.output));
    SCUMBLE_RETURN_IF_ERROR(PrepareFrame(styles_, guides, one, context_, state_));
    MeasureFinishOf(styles_, guides, frame, context_, state_);
    if (MeasuresColors(styles_)) {  // of what is painted: the picture itself is made when its turn comes
      const auto painted = PaintInMemory(styles_, guides, found.source, one, context_, progress, state_);
      if (!painted) return CannotMeasure(painted.error(), frame, kColorsOption);  // as a picture of --over
    }
    if (!is_exposed()) return Ok();
    context_.Warn(
        fmt::format("the exposure of all frames was measured on frame {}: where a sequence is cut into several runs, "
                    "give each --exposure {:.2f}",
                    frame, *state_.exposure));
    return Ok();
  };
  FrameToMeasure choice;
  for (const int frame : sequence.frames) {
    failed_at = frame;
    const Expected<FrameGuides> found = ahead.at(frame, progress);
    if (!found) {
      if (found.error().kind != ErrorKind::kInput) return found.error();
      const bool is_own = ahead.is_own(frame);
      return CannotMeasure(found.error(), frame, is_own ? OptionsThatGive(is_exposed(), "--exposure STOPS") : "");
    }
    if (choice.IsEnough(frame, *found->guides)) return measure(frame, *found);
  }
  if (choice.best) {
    failed_at = choice.best;
    SCUMBLE_ASSIGN(const FrameGuides found, ahead.at(*choice.best, progress));
    return measure(*choice.best, found);
  }
  failed_at.reset();
  if (is_exposed()) state_.exposure = 0.0;
  if (MeasuresFinish(styles_)) state_.finish_measures.emplace();
  context_.Warn(NothingToMeasure(sequence.frames, OptionsThatGive(is_exposed(), "--exposure")));
  return Ok();
}

std::string PictureSequence::OptionsThatGive(bool is_exposed, const std::string& exposure) const {
  std::vector<std::string> options;
  if (is_exposed) options.push_back(exposure);
  if (MeasuresFinish(styles_)) options.push_back("--finish-measures");
  if (MeasuresColors(styles_)) options.push_back(kColorsOption);
  return fmt::format("{}", fmt::join(options, " and "));
}

Status PictureSequence::ReadOverOfAll(const Size& size) {
  SCUMBLE_ASSIGN(const FrameName over, FrameName::Parse(request_.over));
  if (request_.over.empty() || over.has_place()) return Ok();
  SCUMBLE_RETURN_IF_ERROR(ReadOver(request_, state_));
  if (size.width == 0 || (state_.over->width == size.width && state_.over->height == size.height)) return Ok();
  return InputError(fmt::format("--over {} is {}×{}, the frames are {}×{}: render both at one size", request_.over,
                                state_.over->width, state_.over->height, size.width, size.height));
}

Status PictureSequence::Check(int frame, const std::string& output, int width, int height, std::optional<FrameRate> fps,
                              const std::string& samples, const std::string& guides) {
  for (Style& style : styles_.styles) SCUMBLE_RETURN_IF_ERROR(SetStyleFrame(style, frame));
  SCUMBLE_RETURN_IF_ERROR(SetFinishFrame(styles_.finish, frame));
  const std::optional<double> exposure = request_.exposure;
  PictureShape shape{width, height, PictureChannels(output), PictureBits(output, {request_.bits}), {}};
  PictureSettings settings = SettingsOf(request_, fps, exposure, samples, guides);
  if (exposure) settings.measured.reset();  // stops that were measured may be given to go on with
  // What was measured may be given to go on with.
  const std::optional<FinishMeasures>& given = styles_.options.finish_measures;
  if (given) settings.finish_measures = MeasuresText(*given);
  if (!given) settings.finish_measured = true;
  shape.settings = SettingsText(styles_, settings, state_.hashes);
  SCUMBLE_RETURN_IF_ERROR(CheckWholePicture(output, shape));
  if (request_.layers_out.empty()) return Ok();
  SCUMBLE_ASSIGN(const FrameName layers, FrameName::Parse(request_.layers_out));
  return CheckWholeLayers(layers.At(frame), width, height, shape.settings);
}

bool PictureSequence::MustLookAhead(const Sequence& sequence) const {
  return sequence.frames.size() > 1 &&
         (MeasuresExposure(styles_, request_) || MeasuresFinish(styles_) || MeasuresColors(styles_));
}

Expected<FrameWrite> PictureSequence::Make(int frame, const std::string& output, const GuidesAt& guides_at,
                                           double guides_share, const Progress& progress) {
  SCUMBLE_ASSIGN(const PictureRequest one, RequestAt(request_, frame, output));
  SCUMBLE_ASSIGN(const FrameGuides found, guides_at(frame, Within(progress, 0.0, guides_share)));
  return PaintPicture(styles_, *found.guides, found.source, one, context_, Within(progress, guides_share, 1.0), state_);
}

Expected<RunReport> PictureSequence::Run(const Sequence& sequence, const SequenceWork& work,
                                         const SequenceListener& listener, const Progress& progress) {
  RunReport report;
  SCUMBLE_ASSIGN(report.sequence, RunSequence(sequence, work, listener, context_, progress));
  WarnOfIdleAssignments(styles_);
  state_.finish_remarks.WarnOfFrames(context_);
  return report;
}

Expected<RunReport> RunOnePicture(StyleSet& styles, const GuideSet& guides, const GuideSource& source,
                                  const PictureRequest& request, const RunContext& context, const Progress& progress) {
  PictureState state;
  SCUMBLE_ASSIGN(const FrameWrite write, PaintPicture(styles, guides, source, request, context, progress, state));
  RunReport report;
  SCUMBLE_ASSIGN(report.frame, write());
  context.EndStage("write");
  WarnOfIdleAssignments(styles);
  return report;
}

PictureWork WorkOf(const StyleSet& styles, const PictureRequest& picture, const Size& guides, const LayerSet& layers,
                   std::size_t fragments, bool is_sequence, const RunContext& context) {
  const bool has_map = styles.styles.size() > 1 || !styles.assigned.empty();
  return {styles.styles,        has_map,         guides,    layers,        is_sequence,
          picture.KeepsField(), context.threads, fragments, &styles.finish};
}

Status CheckFiles(RunInputs& files, const PictureRequest& picture, const std::optional<Sequence>& sequence,
                  const StyleSet& styles) {
  SCUMBLE_ASSIGN(const auto overs, NamesOf(picture.over, sequence));
  for (const std::string& over : overs) files.Reads("the picture of --over", over);
  for (const std::string& file : FilesOf(AllPasses(styles))) files.Reads("a file of a finish", file);
  for (const std::string& file : MaskFilesOf(AllPasses(styles))) files.Reads("the mask of a finishing effect", file);
  files.ReadsStyles(styles);
  const bool resumes = sequence && sequence->resume;
  SCUMBLE_ASSIGN(const auto outputs, NamesOf(picture.output, sequence));
  SCUMBLE_RETURN_IF_ERROR(files.CheckOutputs(outputs, "-o", resumes));
  SCUMBLE_ASSIGN(const auto layers, LayerNamesOf(picture.layers_out, sequence));
  return files.CheckOutputs(layers, "--layers-out", resumes);
}

FilesCheck CheckOfSceneStyles(RunInputs& files, const PictureRequest& picture, const std::optional<Sequence>& sequence,
                              const StyleSet& styles) {
  return [&]() -> Status {
    if (!files.IsChecked(&styles)) SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, picture, sequence, styles));
    return CheckLayersWanted({picture.show_finish, !picture.layers_out.empty()}, AllPasses(styles));
  };
}

Expected<std::string> OverOnTrial(const PictureRequest& picture, const std::optional<Sequence>& sequence) {
  SCUMBLE_ASSIGN(const FrameName name, FrameName::Parse(picture.over));
  if (sequence) return name.At(sequence->frames.front());
  return name.must_have_frame() ? std::string() : picture.over;
}

Status NameOne(PictureRequest& picture) {
  SCUMBLE_ASSIGN(picture.output, NameOfOne(picture.output, picture.frame));
  SCUMBLE_ASSIGN(picture.over, NameOfOne(picture.over, picture.frame));
  SCUMBLE_ASSIGN(picture.layers_out, NameOfOne(picture.layers_out, picture.frame));
  return Ok();
}

}  // namespace scumble
