// One variant of `scumble tradeoff`, ready to paint.
#pragma once

#include <memory>
#include <string>

#include "pipeline/frame/frame_painter.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/tradeoff.h"
#include "pipeline/tradeoff/grid.h"
#include "pipeline/variant/variant_guides.h"
#include "transfer/transfer.h"

namespace scumble {

// Samples of a pixel of light; 0: not given, so that pixels choose.
inline int GivenSamples(const TradeSetup& setup) { return setup.scene.samples_given ? setup.scene.samples : 0; }

// The scene and the grid around the style, both opened once.
struct TradeStage {
  StaticScene scene;
  Style style;  // as it is, but for its paper
  bool has_paper = false;
  bool asks_for_styles = false;  // the scene asks for other styles
  bool chance = false;
  int width = 0, height = 0;
  TradeGrid grid;
};
Expected<TradeStage> OpenTradeStage(const TradeSetup& setup, const RunContext& context);

// The style with what the variant changes of it, without paper.
Expected<Style> StyleOfVariant(const TradeSetup& setup, const Variant& variant, const RunContext& context);

// The options of stylize that make the variant's picture again; or none, and why.
struct RepeatOptions {
  std::string options;
  std::string note;
};
RepeatOptions RepeatVariant(const TradeSetup& setup, const TradeStage& stage, const Variant& variant);

// The picture of a variant, painted as often as asked for. Not for several threads at once.
class VariantPainter {
 public:
  // `guides` are those of this variant, and are kept.
  static Expected<VariantPainter> Prepare(const TradeSetup& setup, const Variant& variant, const Style& style,
                                          std::shared_ptr<const VariantGuides> guides, const RunContext& context);

  // Returns the milliseconds of wall clock that the transfer and its finishing effects took, into new memory, as the
  // first picture of a run of stylize is painted. Nothing that a sequence keeps from frame to frame is used.
  Expected<double> Paint(bool keep_field = false);

  bool is_finished() const { return !finish_.steps.empty(); }
  // Whether the picture shows anything but paint: base colours of the scene, or finishing effects, which no exemplar
  // has. PaintBare paints without them. Only for measures of the paint.
  bool is_bare() const { return !(prepared_.settings.colorize > 0.0) && !is_finished(); }
  Expected<Picture> PaintBare();

  const Picture& picture() const { return super_ > 1 ? small_ : picture_; }
  const SourceField* field() const {
    return super_ > 1 || upscale_ > 1 ? nullptr : &scratch_.field;
  }  // after keep_field
  const PreparedStyle& prepared() const { return prepared_; }
  const VariantGuides& guides() const { return *guides_; }
  double exposure() const { return settings_.exposure; }
  double prepare_ms() const { return prepare_ms_; }

 private:
  VariantPainter() = default;

  std::shared_ptr<const VariantGuides> guides_;
  PreparedStyle prepared_;
  FrameSettings settings_;
  FrameFinish finish_;
  RunContext context_;
  TransferScratch scratch_;
  double prepare_ms_ = 0.0;
  int super_ = 1, upscale_ = 1;
  Picture picture_, small_;
};

// Blocks of factor × factor pixels averaged: colours weigh by their alpha, in their encoding, to the nearest.
Picture Averaged(const Picture& picture, int factor);

}  // namespace scumble
