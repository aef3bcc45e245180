#include "pipeline/variant/trial_painter.h"

#include <limits>
#include <memory>

#include "core/image/check.h"
#include "core/image/stopwatch.h"
#include "core/io/picture_file.h"
#include "core/style/style_keyframes.h"
#include "pipeline/frame/frame_painter.h"
#include "pipeline/memory/memory_limit.h"
#include "pipeline/variant/quality_ladder.h"
#include "pipeline/variant/variant_error.h"
#include "transfer/upsample_guides.h"

namespace scumble {

namespace {

std::size_t PixelsOf(const PreparedStyle& style) {
  const PreparedExemplar& exemplar = *style.exemplar;
  return std::size_t(exemplar.width()) * std::size_t(exemplar.height()) * std::size_t(exemplar.count());
}

// What the energy takes beside all that this process has: 250 bytes for each place (measure/energy/energy.h), and the
// planes that it is made of.
bool HasMemoryFor(std::size_t places, const RunContext& context) {
  constexpr std::uint64_t kEachPlace = 250 + 100;
  const MemoryLimit limit = LimitFor(context);
  return limit.bytes == 0 || ResidentMemory() + kEachPlace * places <= limit.bytes;
}

}  // namespace

// `bare`: without paper, and without the scene's colours, which no exemplar has.
Status TrialPainter::Prepare(const Variant& variant, const GuideSet& guides, int upsample, bool bare) {
  const std::string wanted = variant.name + (bare ? ", bare" : "");
  if (prepared_for_ == wanted) return Ok();
  StyleSet styles = styles_;
  SCUMBLE_RETURN_IF_ERROR(ApplyVariant(variant, styles));
  prepared_.clear();
  for (Style& style : styles.styles) {
    SCUMBLE_RETURN_IF_ERROR(SetStyleFrame(style, frame_.value_or(0)));
    if (bare) style.paper = {}, style.transfer.colorize = 0.0;
    SCUMBLE_ASSIGN(PreparedStyle one, PrepareStyle(style, guides.height() * upsample, context_));
    prepared_.push_back(std::move(one));
  }
  exposure_ = ExposureOf(picture_.exposure, prepared_, guides, context_.threads);
  prepared_for_ = wanted;
  return Ok();
}

Expected<const Picture*> TrialPainter::Over(const GuideSet& guides) {
  if (over_file_.empty()) return static_cast<const Picture*>(nullptr);
  if (!over_) {
    SCUMBLE_ASSIGN(over_, ReadPicture(over_file_));
  }
  const bool fits = over_->width == guides.width() && over_->height == guides.height();
  return fits ? &*over_ : nullptr;
}

Status TrialPainter::Transfer(const GuideSet& guides, bool bare, TransferScratch& scratch, Picture& picture,
                              double& ms) {
  const bool needs_map = styles_.NeedsMap(guides, name_);
  StyleMap map;
  if (needs_map) {
    SCUMBLE_ASSIGN(map, MapStyles(styles_, guides, name_));
  }
  FrameSettings settings{picture_.seed, frame_.value_or(0),           RateOf(picture_.fps, guides), exposure_,
                         nullptr,       bare || picture_.KeepsField()};
  if (!bare) {
    SCUMBLE_ASSIGN(settings.over, Over(guides));
  }
  Stopwatch watch;
  SCUMBLE_RETURN_IF_ERROR(
      PaintFrame(prepared_, needs_map ? &map : nullptr, guides, settings, context_, {}, scratch, picture));
  ms += watch.Lap();
  return Ok();
}

Expected<double> TrialPainter::Paint(const Variant& variant, const GuideSet& given) {
  const int upsample = picture_.upsample * UpsampleOf(variant);
  SCUMBLE_RETURN_IF_ERROR(Prepare(variant, given, upsample, false));
  Stopwatch watch;
  std::optional<GuideSet> larger;
  if (upsample > 1) {
    SCUMBLE_ASSIGN(larger, UpsampleGuides(given, upsample, context_.threads));
  }
  double ms = watch.Lap();
  TransferScratch scratch;
  Picture picture;
  SCUMBLE_RETURN_IF_ERROR(Transfer(larger ? *larger : given, false, scratch, picture, ms));
  return ms;
}

Expected<double> TrialPainter::MeasureError(const Variant& variant, const GuideSet& given) {
  SCUMBLE_CHECK_EQ(UpsampleOf(variant), 1);
  constexpr double kNotKnown = std::numeric_limits<double>::infinity();
  if (styles_.styles.size() > 1 || styles_.NeedsMap(given, name_)) return kNotKnown;
  const int upsample = picture_.upsample;
  std::optional<GuideSet> larger;
  if (upsample > 1) {
    SCUMBLE_ASSIGN(larger, UpsampleGuides(given, upsample, context_.threads));
  }
  const GuideSet& guides = larger ? *larger : given;
  SCUMBLE_RETURN_IF_ERROR(Prepare(Variant(), given, upsample, true));
  const PreparedStyle exact = prepared_.front();
  if (!HasMemoryFor(guides.pixel_count() + PixelsOf(exact), context_)) return kNotKnown;
  const double exposure = exposure_;
  SCUMBLE_RETURN_IF_ERROR(Prepare(variant, given, upsample, true));
  TransferScratch scratch;
  Picture picture;
  double ms = 0.0;
  SCUMBLE_RETURN_IF_ERROR(Transfer(guides, true, scratch, picture, ms));
  // The guides are the caller's and outlive it.
  const TradeReference reference(std::shared_ptr<const GuideSet>(std::shared_ptr<void>(), &guides), exact, exposure,
                                 context_.threads);
  EnergyOptions options;
  options.samples = kErrorPatches;
  TradeMeasure measure;
  // Guides that are no numbers can be painted by, but not be measured.
  if (!reference.MeasurePaint(picture, &scratch.field, options, measure).ok()) return kNotKnown;
  return measure.both.mean;
}

}  // namespace scumble
