#include "cli/budget_trial.h"

#include "cli/cache.h"
#include "cli/quality_ladder.h"
#include "cli/show.h"
#include "image/stopwatch.h"
#include "io/picture_file.h"
#include "transfer/upsample_guides.h"

namespace scumble {

Status PaintTrial::Prepare(const Way& way, const GuideSet& guides, int upsample) {
  if (prepared_for_ == way.name) return Ok();
  StyleSet styles = styles_;
  SCUMBLE_RETURN_IF_ERROR(ApplyWay(way, styles));
  FileCache cache = UserCache();
  PrepareOptions options;
  options.cache = &cache, options.threads = globals_.threads;
  prepared_.clear();
  for (const Style& style : styles.styles) {
    SCUMBLE_ASSIGN(PreparedStyle one, scumble::Prepare(style, guides.height() * upsample, options));
    prepared_.push_back(std::move(one));
  }
  SCUMBLE_ASSIGN(const std::optional<double> given, ParseExposure(picture_.exposure));
  exposure_ = given ? *given : MeasureExposure(prepared_, guides, globals_.threads).value_or(0.0);
  prepared_for_ = way.name;
  return Ok();
}

Expected<const Picture*> PaintTrial::Over(const GuideSet& guides) {
  if (over_file_.empty()) return static_cast<const Picture*>(nullptr);
  if (!over_) {
    SCUMBLE_ASSIGN(over_, ReadPicture(over_file_));
  }
  const bool fits = over_->width == guides.width() && over_->height == guides.height();
  return fits ? &*over_ : nullptr;
}

Expected<double> PaintTrial::Paint(const Way& way, const GuideSet& given) {
  const int upsample = picture_.upsample * UpsampleOf(way);
  SCUMBLE_RETURN_IF_ERROR(Prepare(way, given, upsample));
  Stopwatch watch;
  std::optional<GuideSet> larger;
  if (upsample > 1) {
    SCUMBLE_ASSIGN(larger, UpsampleGuides(given, upsample, globals_.threads));
  }
  double ms = watch.Lap();
  const GuideSet& guides = larger ? *larger : given;
  std::vector<const PreparedStyle*> pointers;
  for (const PreparedStyle& one : prepared_) pointers.push_back(&one);
  const bool needs_map = styles_.NeedsMap(guides);
  StyleMap map;
  if (needs_map) {
    SCUMBLE_ASSIGN(map, MapStyles(styles_, guides, name_));
  }
  TransferOptions options;
  options.seed = picture_.seed, options.exposure = exposure_, options.threads = globals_.threads;
  options.frame = picture_.frame.value_or(0);
  SCUMBLE_ASSIGN(options.over, Over(guides));
  options.keep_field = KeepsField(picture_, globals_);
  TransferScratch scratch;
  Picture picture;
  watch.Lap();
  SCUMBLE_RETURN_IF_ERROR(needs_map ? Transfer(pointers, map, guides, options, scratch, picture)
                                    : Transfer(prepared_.front(), guides, options, scratch, picture));
  return ms + watch.Lap();
}

}  // namespace scumble
