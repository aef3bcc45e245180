#include "pipeline/variant/trial_painter.h"

#include "core/image/stopwatch.h"
#include "core/io/picture_file.h"
#include "core/style/style_keyframes.h"
#include "pipeline/finish_set.h"
#include "pipeline/frame/frame_painter.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/variant/quality_ladder.h"
#include "transfer/upsample_guides.h"

namespace scumble {

Status TrialPainter::Prepare(const Variant& variant, const GuideSet& guides, int upsample) {
  if (prepared_for_ == variant.name) return Ok();
  variant_ = styles_;
  SCUMBLE_RETURN_IF_ERROR(ApplyVariant(variant, variant_));
  prepared_.clear();
  for (Style& style : variant_.styles) {
    SCUMBLE_RETURN_IF_ERROR(SetStyleFrame(style, frame_.value_or(0)));
    SCUMBLE_ASSIGN(PreparedStyle one, PrepareStyle(style, guides.height() * upsample, context_));
    prepared_.push_back(std::move(one));
  }
  SCUMBLE_RETURN_IF_ERROR(SetFinishFrame(variant_.finish, frame_.value_or(0)));
  for (Style& style : variant_.styles) style.exemplars.clear(), style.paper = {};  // what is large, and prepared
  exposure_ = ExposureOf(picture_.exposure, prepared_, guides, context_.threads);
  prepared_for_ = variant.name;
  return Ok();
}

Expected<const Picture*> TrialPainter::Over(const GuideSet& guides) {
  if (over_file_.empty()) return static_cast<const Picture*>(nullptr);
  if (!over_) {
    SCUMBLE_ASSIGN(over_, ReadUnderneath(over_file_, picture_.over_view_layer));
  }
  const bool fits = over_->width == guides.width() && over_->height == guides.height();
  return fits ? &*over_ : nullptr;
}

Expected<double> TrialPainter::Paint(const Variant& variant, const GuideSet& given) {
  const int guide_factor = picture_.GuideFactor() * GuideFactorOf(variant);
  const int picture_factor = picture_.PictureFactor() * PictureFactorOf(variant);
  SCUMBLE_RETURN_IF_ERROR(Prepare(variant, given, guide_factor));
  Stopwatch watch;
  std::optional<GuideSet> larger;
  if (guide_factor > 1) {
    SCUMBLE_ASSIGN(larger, UpsampleGuides(given, guide_factor, context_.threads));
  }
  double ms = watch.Lap();
  const GuideSet& guides = larger ? *larger : given;
  const bool needs_map = styles_.NeedsMap(guides, name_);
  StyleMap map;
  if (needs_map) {
    SCUMBLE_ASSIGN(map, MapStyles(styles_, guides, name_));
  }
  SCUMBLE_ASSIGN(const Picture* const over, Over(guides));
  FrameSettings settings{picture_.seed, frame_.value_or(0),   RateOf(picture_.fps, guides), exposure_,
                         over,          picture_.KeepsField()};
  FrameFinish finish;
  finish.steps = FinishStepsOf(variant_, guides, needs_map ? &map : nullptr, over != nullptr, [](const auto&) {});
  if (!finish.steps.empty()) {
    if (!measures_) measures_ = MeasuresOf(AllPasses(styles_), styles_.options.finish_measures, given);
    finish.measures = *measures_, finish.reference_height = variant_.first().transfer.reference_height;
    if (larger) finish.small_guides = &given;
    settings.finish = &finish;
  }
  TransferScratch scratch;
  Picture picture;
  watch.Lap();
  SCUMBLE_RETURN_IF_ERROR(
      PaintFrame(prepared_, needs_map ? &map : nullptr, guides, settings, context_, {}, scratch, picture));
  if (picture_factor > 1) picture = UpscalePicture(picture, picture_factor, context_.threads);
  return ms + watch.Lap();
}

}  // namespace scumble
