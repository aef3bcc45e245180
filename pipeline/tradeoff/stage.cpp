#include "pipeline/tradeoff/stage.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

#include "core/image/stopwatch.h"
#include "core/style/finish_keys.h"
#include "core/style/style_keyframes.h"
#include "pipeline/finish_set.h"
#include "pipeline/frame/frame_painter.h"
#include "pipeline/shell_quote.h"
#include "pipeline/style_set.h"
#include "pipeline/tradeoff/peak_process.h"
#include "pipeline/variant/quality_ladder.h"
#include "transfer/upsample_guides.h"

namespace scumble {
namespace {

StyleOverride NoPaper() { return MakeOverride("transfer.paper", std::string()); }

Expected<Style> OpenStyleWith(const TradeSetup& setup, const std::vector<StyleOverride>& settings,
                              const RunContext& context) {
  StyleRequest one = setup.style;
  one.scene_styles = false;
  one.sets.insert(one.sets.end(), settings.begin(), settings.end());
  SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(one, context));
  Style style = std::move(styles.styles.front());
  SCUMBLE_RETURN_IF_ERROR(SetStyleFrame(style, setup.frame.value_or(0)));
  // The run's passes join the style's. Keys over time go by names, which both may have; at this frame all are set.
  std::erase_if(style.tracks, [](const StyleTrack& track) { return track.name.starts_with(kFinishKeys); });
  SCUMBLE_RETURN_IF_ERROR(SetFinishFrame(styles.finish, setup.frame.value_or(0)));
  style.finish.insert(style.finish.end(), styles.finish.passes.begin(), styles.finish.passes.end());
  return style;
}

std::uint64_t SeedOf(const TradeSetup& setup, const Variant& variant) {
  return setup.scene.seed + std::uint64_t(variant.more_seed);
}

// What --quality names, where it is not the style itself.
Status AddQualities(const TradeSetup& setup, const RunContext& context, TradeStage& stage) {
  StyleRequest options = setup.style;
  options.scene_styles = false;
  SCUMBLE_ASSIGN(const StyleSet styles, OpenStyles(options, context));
  const int samples = stage.chance && !setup.scene.samples_given ? setup.scene.samples : 0;
  const std::pair<const char*, Quality> kNamed[] = {{"preview", Quality::kPreview}, {"draft", Quality::kDraft}};
  for (const auto& [name, quality] : kNamed) {
    Variant variant =
        VariantOf(quality, styles, {.casts = true, .width = stage.width, .height = stage.height, .samples = samples});
    if (variant.settings.empty() && variant.guide_scale == 1.0 && variant.samples == 0) continue;
    variant.axis = "quality", variant.value = name, variant.name = std::string("quality ") + name;
    stage.grid.variants.push_back(std::move(variant));
  }
  return Ok();
}

}  // namespace

Expected<Style> StyleOnPaper(const TradeSetup& setup, const Variant& variant, const RunContext& context) {
  return OpenStyleWith(setup, variant.settings, context);
}

Expected<Style> StyleOfVariant(const TradeSetup& setup, const Variant& variant, const RunContext& context) {
  std::vector<StyleOverride> settings = variant.settings;
  settings.push_back(NoPaper());
  return OpenStyleWith(setup, settings, context);
}

Expected<TradeStage> OpenTradeStage(const TradeSetup& setup, const RunContext& context) {
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(setup.scene));
  TradeStage stage;
  SCUMBLE_ASSIGN(stage.style, OpenStyleWith(setup, {}, context));
  if (!stage.style.unpainted.empty()) {
    return UsageError(setup.style.style + ": tradeoff measures paint, and method " + stage.style.unpainted +
                      " has none: take a style with a painting");
  }
  stage.has_paper = stage.style.paper.color || stage.style.paper.picture;
  stage.style.paper = {};
  const Size& size = setup.scene.size;
  stage.width = size.width, stage.height = size.height;
  const auto layers = [&](const SceneStyleRequests& of_scene) -> Expected<LayerSet> {
    stage.asks_for_styles = !of_scene.objects.empty() || !of_scene.materials.empty();
    return LayersOverTime(stage.style);
  };
  SCUMBLE_ASSIGN(stage.scene, OpenSceneAt(setup.frame, setup.scene, layers, context));
  stage.chance = NeedSamples(stage.scene.scene, stage.scene.layers, setup.scene);
  stage.grid = MakeTradeGrid(stage.style, {size.width, size.height, setup.quick, stage.chance, GivenSamples(setup)});
  SCUMBLE_RETURN_IF_ERROR(AddQualities(setup, context, stage));
  return stage;
}

RepeatOptions RepeatVariant(const TradeSetup& setup, const TradeStage& stage, const Variant& variant) {
  if (variant.precision != GuidePrecision::kFloat)
    return {"", "stylize has its guides as floats, but for colours with --half"};
  if (variant.guide_scale > 1.0) {
    return {"", fmt::format("stylize with --size {}x{}, then each 2 x 2 pixels averaged", 2 * stage.width,
                            2 * stage.height)};
  }
  if (variant.table_resolution != LookUpTable::kResolution) {
    return {"", fmt::format("tables of stylize have {} cells a side", LookUpTable::kResolution)};
  }
  std::string text = "--style " + Quoted(setup.style.style);
  const auto add = [&](const std::string& option, const std::string& value) {
    text += " " + option + " " + Quoted(value);
  };
  for (const auto& [option, value] : FinishArguments(setup)) add(option, value);
  for (const StyleOverride& set : setup.style.sets) add("--set", ToText(set));
  for (const StyleOverride& set : variant.settings) add("--set", set.text);
  if (stage.has_paper) add("--set", NoPaper().text);
  add("--size", fmt::format("{}x{}", stage.width, stage.height));
  for (const auto& [option, value] : SceneArguments(setup)) add(option, value);
  if (UpsampleOf(variant) > 1) add("--upsample", std::to_string(UpsampleOf(variant)));
  if (variant.upscale) text += " --upscale";
  const int samples = variant.samples > 0 ? variant.samples : GivenSamples(setup);
  if (stage.chance && samples > 0) add("--samples", std::to_string(samples));
  if (setup.scene.max_bounces != SceneRequest().max_bounces) {
    add("--max-bounces", std::to_string(setup.scene.max_bounces));
  }
  if (setup.scene.raw_normals) text += " --raw-normals";
  if (!variant.robust) text += " --no-robust";
  if (stage.asks_for_styles) text += " --no-scene-styles";
  if (const std::uint64_t seed = SeedOf(setup, variant); seed != 0) add("--seed", std::to_string(seed));
  return {text, ""};
}

Expected<VariantPainter> VariantPainter::Prepare(const TradeSetup& setup, const Variant& variant, const Style& style,
                                                 std::shared_ptr<const VariantGuides> guides,
                                                 const RunContext& context) {
  VariantPainter painter;
  painter.guides_ = std::move(guides);
  PrepareOptions prepare;
  prepare.table_resolution = variant.table_resolution;
  prepare.cache = nullptr;  // what a table costs would not be seen where it is kept
  prepare.threads = context.threads;
  prepare.is_cancelled = context.is_cancelled;
  Stopwatch watch;
  SCUMBLE_ASSIGN(painter.prepared_, scumble::Prepare(style, painter.guides_->guides.height(), prepare));
  painter.prepare_ms_ = watch.Lap();
  painter.settings_ = {
      SeedOf(setup, variant),
      setup.frame.value_or(0),
      RateOf(setup.scene.fps, painter.guides_->guides),
      ExposureOf(setup.exposure, {&painter.prepared_, 1}, painter.guides_->ForExposure(), context.threads),
      nullptr,
      false};
  const GuideSet& seen = painter.guides_->guides;
  painter.finish_.steps = FinishStepsOf(style.finish, {seen.width(), seen.height()}, &seen, [](const auto&) {});
  painter.finish_.measures = MeasuresOf(style.finish, setup.style.finish_measures, painter.guides_->ForExposure());
  painter.finish_.reference_height = style.transfer.reference_height;
  if (painter.guides_->given.pixel_count() > 0) painter.finish_.small_guides = &painter.guides_->given;
  painter.context_ = context;
  painter.super_ = SupersampleOf(variant), painter.upscale_ = PictureFactorOf(variant);
  return painter;
}

Expected<double> VariantPainter::Paint(bool keep_field) {
  settings_.keep_field = keep_field, settings_.finish = is_finished() ? &finish_ : nullptr;
  scratch_ = TransferScratch(), picture_ = Picture();  // what the run before leaves would be a sequence's
  Stopwatch watch;
  SCUMBLE_RETURN_IF_ERROR(
      PaintFrame({&prepared_, 1}, nullptr, guides_->guides, settings_, context_, {}, scratch_, picture_));
  if (upscale_ > 1) picture_ = UpscalePicture(picture_, upscale_, context_.threads);
  if (super_ > 1) small_ = Averaged(picture_, super_);
  return watch.Lap();
}

Expected<Picture> VariantPainter::PaintBare() {
  PreparedStyle untinted = prepared_;
  untinted.settings.colorize = 0.0;
  FrameSettings settings = settings_;
  settings.keep_field = false, settings.finish = nullptr;
  TransferScratch scratch;
  Picture picture;
  SCUMBLE_RETURN_IF_ERROR(
      PaintFrame({&untinted, 1}, nullptr, guides_->guides, settings, context_, {}, scratch, picture));
  if (upscale_ > 1) return UpscalePicture(picture, upscale_, context_.threads);
  return super_ > 1 ? Averaged(picture, super_) : picture;
}

Picture Averaged(const Picture& picture, int factor) {
  Picture small(picture.width / factor, picture.height / factor);
  const std::uint64_t count = std::uint64_t(factor) * std::uint64_t(factor);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      std::uint64_t alpha = 0;
      std::array<std::uint64_t, 3> color{};
      for (int v = 0; v < factor; ++v) {
        for (int u = 0; u < factor; ++u) {
          const std::uint16_t* from = picture.At(factor * x + u, factor * y + v);
          for (std::size_t c = 0; c < 3; ++c) color[c] += std::uint64_t(from[c]) * from[3];
          alpha += from[3];
        }
      }
      std::uint16_t* to = small.At(x, y);
      for (std::size_t c = 0; c < 3 && alpha > 0; ++c)
        to[c] = static_cast<std::uint16_t>((color[c] + alpha / 2) / alpha);
      to[3] = static_cast<std::uint16_t>((alpha + count / 2) / count);
    }
  }
  return small;
}

}  // namespace scumble
