#include "pipeline/tradeoff.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/io/picture_file.h"
#include "core/style/style_keyframes.h"
#include "pipeline/blender_scene.h"
#include "pipeline/machine/machine.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/memory_limit.h"
#include "pipeline/shell_quote.h"
#include "pipeline/tradeoff/memory.h"
#include "pipeline/tradeoff/peak_process.h"
#include "pipeline/tradeoff/stage.h"
#include "pipeline/variant/variant_error.h"
#include "transfer/upsample_guides.h"

namespace scumble {
namespace {

// Variants that are timed in turn: prepared styles take memory.
constexpr std::size_t kTogether = 8;

// Linear between the values around, as spreadsheets have it.
Quartiles QuartilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const double next = values[std::min(below + 1, values.size() - 1)];
    return values[below] + (place - static_cast<double>(below)) * (next - values[below]);
  };
  return {at(0.5), at(0.25), at(0.75)};
}

// Runs of guides and transfers, the first with the first; where there are fewer of one kind they come again.
Quartiles TotalOf(const std::vector<double>& guides, const std::vector<double>& transfers) {
  std::vector<double> sums;
  if (guides.empty() || transfers.empty()) return {};
  for (std::size_t i = 0; i < std::max(guides.size(), transfers.size()); ++i) {
    sums.push_back(guides[i % guides.size()] + transfers[i % transfers.size()]);
  }
  return QuartilesOf(std::move(sums));
}

// The memory of a variant that takes longer is not measured.
constexpr double kMostForMemoryMs = 60000.0;

void AddNote(TradeMeasure& measure, const std::string& note) {
  measure.note += (measure.note.empty() ? "" : "; ") + note;
}

class Trade {
 public:
  Trade(const TradeSetup& setup, const RunContext& context)
      : setup_(setup),
        context_(context),
        silent_(context.WithoutNotes()),
        progress_(context.StartProgress("tradeoff")) {
    asks_for_memory_ = setup.memory && !IsBlenderScene(setup.scene.scene);
  }

  Expected<TradeReport> Measure() {
    if (asks_for_memory_ && context_.program.empty()) {
      return UnavailableError(
          "memory is measured by running the program scumble again, and it is not known where that is: name it in "
          "RunContext::program, or leave memory out (--no-memory)");
    }
    SCUMBLE_ASSIGN(stage_, OpenTradeStage(setup_, context_));
    SCUMBLE_ASSIGN(std::vector<Variant> variants, ChosenVariants());
    if (setup_.exposure && !LooksAtLight(stage_.style)) {
      context_.Warn(fmt::format("--exposure {}", *setup_.exposure) + " changes nothing: style " + stage_.style.name +
                    " has one exemplar and no weight for light, so it does not look at it");
    }
    report_.left_out = stage_.grid.left_out;
    SCUMBLE_RETURN_IF_ERROR(LeaveOutWhatIsTooLarge(variants));
    if (setup_.memory && !asks_for_memory_) {
      report_.left_out.push_back(
          "memory, for which Blender would export the scene for each variant; export it as .glb for that");
    }
    for (const std::string& line : report_.left_out) context_.Note("left out: " + line);
    SCUMBLE_RETURN_IF_ERROR(OpenStyles(variants));
    // Guides that differ only in how they are rounded take one time.
    std::map<std::string, bool> jobs;
    for (std::size_t i = 0; i < variants.size(); ++i) jobs[GuidesKey(variants[i], layers_[i], false)] = true;
    const double runs = setup_.repeats + 1;
    work_ = static_cast<double>(jobs.size()) * runs * kGuidesWork +
            static_cast<double>(variants.size()) * (runs + kMeasureWork + (asks_for_memory_ ? kMemoryWork : 0.0));
    SCUMBLE_RETURN_IF_ERROR(MakeReference());
    SCUMBLE_RETURN_IF_ERROR(TimeGuides(variants));
    report_.scene = std::filesystem::path(setup_.scene.scene).stem().string();
    report_.style = stage_.style.name.empty() ? setup_.style.style : stage_.style.name;
    report_.frame = setup_.frame;
    report_.width = stage_.width, report_.height = stage_.height;
    report_.machine = MachineName(context_.threads), report_.repeats = setup_.repeats;
    report_.lambda = EnergyOptions().lambda, report_.command = TradeCommand(setup_, context_);
    for (std::size_t begin = 0; begin < variants.size(); begin += kTogether) {
      SCUMBLE_RETURN_IF_ERROR(MeasureTogether(variants, begin, std::min(variants.size(), begin + kTogether)));
    }
    return std::move(report_);
  }

 private:
  // Shares of the bar, a transfer being 1.
  static constexpr int kReferenceSeed = 1 << 20;  // added to --seed; no variant has it
  static constexpr double kGuidesWork = 2.0, kMeasureWork = 20.0, kMemoryWork = 10.0;

  // kCancelled where the progress callback asks to stop.
  Status Finished(double work) {
    done_ += work;
    SCUMBLE_RETURN_IF_ERROR(context_.CheckNotCancelled());
    return progress_ && !progress_(std::min(1.0, done_ / work_)) ? Status(CancelledError()) : Ok();
  }

  Expected<std::vector<Variant>> ChosenVariants() const {
    auto chosen = ChooseVariants(stage_.grid.variants, setup_.only);
    if (chosen.ok() || !setup_.quick) return chosen;
    const TradeGrid whole =
        MakeTradeGrid(stage_.style, {stage_.width, stage_.height, false, stage_.chance, GivenSamples(setup_)});
    if (!ChooseVariants(whole.variants, setup_.only).ok()) return chosen;
    return UsageError("--only " + setup_.only + ": --quick leaves that out; leave out --quick");
  }

  // Guides larger than the picture, and exemplars that fit them, may be too large to be made. That is found before
  // minutes of work.
  Status LeaveOutWhatIsTooLarge(std::vector<Variant>& variants) {
    std::vector<Variant> left;
    for (const Variant& variant : variants) {
      if (SupersampleOf(variant) > 1) {
        SCUMBLE_ASSIGN(const Style style, StyleOfVariant(setup_, variant, context_));
        const Status fits = TryVariant(variant, style, variants);
        if (!fits.ok() && fits.error().kind == ErrorKind::kCancelled) return fits;
        if (!fits.ok()) {
          report_.left_out.push_back(variant.name + ", as " + fits.error().message);
          continue;
        }
      }
      left.push_back(variant);
    }
    variants = std::move(left);
    return Ok();
  }

  // Sizes and memory, beside as many variants as may be at work with it, without a ray.
  Status TryVariant(const Variant& variant, const Style& style, const std::vector<Variant>& variants) {
    SCUMBLE_ASSIGN(const LayerSet layers, LayersOverTime(style));
    const int factor = SupersampleOf(variant);
    const Size size{stage_.width * factor, stage_.height * factor};
    SCUMBLE_RETURN_IF_ERROR(CheckSize(size, SizeToText(size)));
    SCUMBLE_ASSIGN(MemoryNeed need, NeedOfAll(variants));
    for (std::size_t i = 0; i < kTogether; ++i)
      memory_.AddVariant(variants.front(), stage_.style, stage_.scene.layers, false, need);
    memory_.AddVariant(variant, style, layers, true, need);
    SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, context_, "take a smaller --size"));
    PrepareOptions options;
    options.threads = context_.threads;
    options.is_cancelled = context_.is_cancelled;
    SCUMBLE_RETURN_IF_ERROR(scumble::Prepare(style, stage_.height * factor, options));
    return Ok();
  }

  // What there is whichever variants are at work: among others the guides of the exact variant and those of the style
  // itself.
  Expected<MemoryNeed> NeedOfAll(const std::vector<Variant>& variants) {
    const LayerSet& layers = stage_.scene.layers;
    SceneGuides plan = PlanScene(stage_.scene.scene, setup_.scene, layers, silent_);
    if (GuidesKey(ConvergedVariant(), layers, true) != GuidesKey(variants.front(), layers, true)) {
      AddGuides({stage_.width, stage_.height}, layers, setup_.scene, plan.memory);
    }
    memory_.AddReport(variants.size(), plan.memory);
    return std::move(plan.memory);
  }

  // Each style is opened once, so that a mistake in one, or memory that is short, is found before minutes of work. None
  // is kept: their pictures take memory.
  Status OpenStyles(const std::vector<Variant>& variants) {
    SCUMBLE_ASSIGN(const MemoryNeed all, NeedOfAll(variants));
    MemoryNeed most = all, together;
    std::set<std::string> guides;
    for (std::size_t i = 0; i < variants.size(); ++i) {
      SCUMBLE_ASSIGN(const Style style, StyleOfVariant(setup_, variants[i], context_));
      SCUMBLE_ASSIGN(const LayerSet layers, LayersOverTime(style));
      layers_.push_back(layers);
      if (i % kTogether == 0) {
        together = all;
        guides = {GuidesKey(variants.front(), layers_.front(), true)};
        if (i > 0) memory_.AddVariant(variants.front(), stage_.style, layers_.front(), false, together);
      }
      memory_.AddVariant(variants[i], style, layers, guides.insert(GuidesKey(variants[i], layers, true)).second,
                         together);
      if (together.peak() > most.peak()) most = together;
    }
    return CheckMemory(most, context_, "take a smaller --size, or fewer variants by --only");
  }

  // What the others are measured against. Noise of its own: guides of as many samples would be compared with
  // themselves, and those of fewer with their own beginning.
  Variant ConvergedVariant() const {
    Variant variant = *std::find_if(stage_.grid.variants.begin(), stage_.grid.variants.end(),
                                    [](const Variant& one) { return one.axis == kExactAxis; });
    if (stage_.chance) variant.more_seed = kReferenceSeed;
    return variant;
  }

  // Kept as long as some variant needs them.
  Expected<std::shared_ptr<const VariantGuides>> GuidesOf(const Variant& variant, const LayerSet& layers) {
    const std::string key = GuidesKey(variant, layers, true);
    if (auto known = guides_[key].lock()) return known;
    SCUMBLE_ASSIGN(VariantGuides made, MakeVariantGuides(stage_.scene, setup_.scene, variant, layers, silent_));
    auto shared = std::make_shared<const VariantGuides>(std::move(made));
    guides_[key] = shared;
    return std::shared_ptr<const VariantGuides>(shared);
  }

  Status MakeReference() {
    const Variant converged = ConvergedVariant();
    SCUMBLE_ASSIGN(const Style style, StyleOfVariant(setup_, converged, context_));
    SCUMBLE_ASSIGN(const LayerSet layers, LayersOverTime(style));
    SCUMBLE_ASSIGN(exact_guides_, GuidesOf(converged, layers));
    const GuideSet& guides = exact_guides_->guides;
    SCUMBLE_RETURN_IF_ERROR(guides.Validate(setup_.scene.scene));
    const auto coverage = guides.Plane(Layer::kCoverage);
    const float least = EnergyOptions().least_coverage;
    const bool nothing = std::none_of(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; });
    if (!nothing && std::none_of(coverage.begin(), coverage.end(), [least](float a) { return a >= least; })) {
      return InputError(
          setup_.scene.scene +
          ": no pixel is covered fully, so there is no paint to measure; take a larger --size, or go nearer");
    }
    if (nothing) {
      return InputError(setup_.scene.scene +
                        ": the camera sees nothing, so there is nothing to measure; try --view or another "
                        "--camera");
    }
    SCUMBLE_ASSIGN(const VariantPainter painter,
                   VariantPainter::Prepare(setup_, converged, style, exact_guides_, context_));
    reference_.emplace(std::shared_ptr<const GuideSet>(exact_guides_, &guides), painter.prepared(), painter.exposure(),
                       context_.threads);
    return Ok();
  }

  Status TimeGuides(const std::vector<Variant>& variants) {
    for (int run = 0; run <= setup_.repeats; ++run) {
      std::map<std::string, bool> made;
      for (std::size_t i = 0; i < variants.size(); ++i) {
        const std::string key = GuidesKey(variants[i], layers_[i], false);
        if (!std::exchange(made[key], true))
          SCUMBLE_RETURN_IF_ERROR(TimeGuides(variants[i], layers_[i], run, guides_ms_[key]));
      }
    }
    return Ok();
  }

  // The first run warms up, and counts only where it is slow.
  Status TimeGuides(const Variant& variant, const LayerSet& layers, int run, std::vector<double>& times) {
    SCUMBLE_RETURN_IF_ERROR(Finished(kGuidesWork));
    if (run > 0 && !times.empty() && times.front() > kSlowMs) return Ok();
    SCUMBLE_ASSIGN(const VariantGuides made, MakeVariantGuides(stage_.scene, setup_.scene, variant, layers, silent_));
    if (run > 0 || made.ms > kSlowMs) times.push_back(made.ms);
    return Ok();
  }

  Status MeasureTogether(const std::vector<Variant>& variants, std::size_t begin, std::size_t end) {
    std::vector<VariantPainter> painters;
    std::vector<double> first_ms;
    std::vector<std::vector<double>> times(end - begin);
    // Most variants have the style's own guides, and it has turns with all: they are cast once.
    SCUMBLE_ASSIGN(style_guides_, GuidesOf(variants.front(), layers_.front()));
    for (std::size_t i = begin; i < end; ++i) {
      SCUMBLE_ASSIGN(const Style style, StyleOfVariant(setup_, variants[i], context_));
      SCUMBLE_ASSIGN(auto guides, GuidesOf(variants[i], layers_[i]));
      SCUMBLE_ASSIGN(VariantPainter painter,
                     VariantPainter::Prepare(setup_, variants[i], style, std::move(guides), context_));
      painters.push_back(std::move(painter));
      SCUMBLE_ASSIGN(const double ms, painters.back().Paint(true));
      first_ms.push_back(ms);
      if (ms > kSlowMs) times[i - begin].push_back(ms);
      SCUMBLE_RETURN_IF_ERROR(MeasureVariant(variants[i], painters.back()));
    }
    // The style as it is has turns with all others, so that it is compared with each at the same moments.
    const bool again = begin > 0 && style_first_ms_ <= kSlowMs;
    if (begin == 0) style_first_ms_ = first_ms.front();
    if (begin == 0 && LooksAtLight(stage_.style)) report_.exposure = painters.front().exposure();
    if (again) {
      SCUMBLE_ASSIGN(VariantPainter painter,
                     VariantPainter::Prepare(setup_, variants.front(), stage_.style, style_guides_, context_));
      painters.push_back(std::move(painter));
      SCUMBLE_ASSIGN(const double ms, painters.back().Paint());
      first_ms.push_back(ms);
      times.emplace_back();
    }
    // Slow variants have turns of their own: after them a quick one would find the processor's caches cold.
    const double quick_ms = 4.0 * *std::min_element(first_ms.begin(), first_ms.end());
    for (const bool slow : {false, true}) {
      for (int run = 1; run <= setup_.repeats; ++run) {
        for (std::size_t i = 0; i < painters.size(); ++i) {
          if ((first_ms[i] > quick_ms) != slow) continue;
          SCUMBLE_RETURN_IF_ERROR(Finished(1.0));
          if (first_ms[i] > kSlowMs) continue;
          SCUMBLE_ASSIGN(const double ms, painters[i].Paint());
          times[i].push_back(ms);
        }
      }
    }
    painters.clear();
    if (again) {
      style_ms_.insert(style_ms_.end(), times.back().begin(), times.back().end());
      SetTimes(report_.variants.front(), guides_ms_[GuidesKey(variants.front(), layers_.front(), false)], style_ms_);
    } else if (begin == 0) {
      style_ms_ = times.front();
    }
    for (std::size_t i = begin; i < end; ++i) {
      const std::vector<double>& guides = guides_ms_[GuidesKey(variants[i], layers_[i], false)];
      TradeMeasure& measure = report_.variants[i];
      SetTimes(measure, guides, times[i - begin]);
      const bool once = guides.size() == 1 || times[i - begin].size() == 1;
      if (once && setup_.repeats > 1) AddNote(measure, "what takes more than 5 s ran once");
      if (!asks_for_memory_) continue;
      if (measure.total_ms.median > kMostForMemoryMs) {
        AddNote(measure, "its memory was not measured, as it takes more than a minute");
      } else {
        SCUMBLE_ASSIGN(measure.memory_bytes, AskForPeak(setup_, variants[i].name, context_));
        if (measure.memory_bytes == 0) {
          AddNote(measure, "the process that was to tell its memory failed");
        }
      }
      SCUMBLE_RETURN_IF_ERROR(Finished(kMemoryWork));
    }
    return Ok();
  }

  static void SetTimes(TradeMeasure& measure, const std::vector<double>& guides, const std::vector<double>& transfers) {
    measure.guides_ms = QuartilesOf(guides), measure.transfer_ms = QuartilesOf(transfers);
    measure.total_ms = TotalOf(guides, transfers);
  }

  // All but times and memory.
  Status MeasureVariant(const Variant& variant, VariantPainter& painter) {
    TradeMeasure measure;
    measure.name = variant.name, measure.axis = variant.axis, measure.value = variant.value;
    measure.chosen = variant.axis == kStyleAxis, measure.exact = variant.axis == kExactAxis;
    measure.by_chance = variant.more_seed != 0;
    measure.prepare_ms = painter.prepare_ms();
    RepeatOptions repeat = RepeatVariant(setup_, stage_, variant);
    measure.options = std::move(repeat.options), measure.note = std::move(repeat.note);
    const GuideSet& guides = painter.guides().guides;
    SCUMBLE_ASSIGN(const GuideDifference off, DifferenceOf(guides, variant));
    measure.guide_rms = off.rms, measure.guide_flip = off.flip;
    SCUMBLE_ASSIGN(const std::vector<std::byte> png, EncodePng(painter.picture()));
    measure.picture_png.resize(png.size());
    std::transform(png.begin(), png.end(), measure.picture_png.begin(),
                   [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
    SCUMBLE_RETURN_IF_ERROR(MeasurePaint(painter, measure));
    report_.variants.push_back(std::move(measure));
    SCUMBLE_RETURN_IF_ERROR(Finished(kMeasureWork));
    return Ok();
  }

  // From the exact ones; those of another size are brought to it for that.
  Expected<GuideDifference> DifferenceOf(const GuideSet& guides, const Variant& variant) const {
    if (SupersampleOf(variant) > 1) return reference_->Compare(AveragedGuides(guides, SupersampleOf(variant)));
    if (PictureFactorOf(variant) == 1) return reference_->Compare(guides);
    SCUMBLE_ASSIGN(const GuideSet larger, UpsampleGuides(guides, PictureFactorOf(variant), context_.threads));
    return reference_->Compare(larger);
  }

  Status MeasurePaint(VariantPainter& painter, TradeMeasure& measure) {
    std::optional<Picture> bare;
    if (!painter.is_bare()) {
      SCUMBLE_ASSIGN(bare, painter.PaintBare());
    }
    const Picture& picture = bare ? *bare : painter.picture();
    if (painter.field()) {
      SCUMBLE_RETURN_IF_ERROR(reference_->MeasureMosaic(picture, *painter.field(), measure));
    } else {
      AddNote(measure, "its chunks are those of a picture of another size, and were not measured");
    }
    // At some sizes settings round to the same: the same picture has the same energy.
    const std::string_view bytes(reinterpret_cast<const char*>(picture.rgba.data()),
                                 picture.rgba.size() * sizeof picture.rgba[0]);
    const auto [known, is_new] = pictures_.try_emplace(std::hash<std::string_view>()(bytes), report_.variants.size());
    if (!is_new) {
      const TradeMeasure& same = report_.variants[known->second];
      measure.both = same.both, measure.energy = same.energy, measure.missing = same.missing;
      measure.texture = same.texture;
      measure.same_as = known->second;
      AddNote(measure, "the same picture as " + same.name);
      return Ok();
    }
    if (!texture_) {
      SCUMBLE_ASSIGN(GuidedTexture texture, reference_->Texture());
      report_.texture_floor = texture.floor();
      texture_.emplace(std::move(texture));
    }
    SCUMBLE_RETURN_IF_ERROR(reference_->MeasureTexture(*texture_, picture, measure));
    EnergyOptions options;
    options.seed = setup_.scene.seed;
    return reference_->MeasurePaint(picture, painter.field(), options, measure);
  }

  const TradeSetup& setup_;
  const RunContext& context_;
  RunContext silent_;
  bool asks_for_memory_ = true;  // not of a .blend, which every process would have to export again
  Progress progress_;
  double work_ = 1.0, done_ = 0.0;
  TradeStage stage_;
  TradeMemory memory_{setup_, stage_, context_};
  std::vector<LayerSet> layers_;  // by variant
  std::map<std::string, std::weak_ptr<const VariantGuides>> guides_;
  std::map<std::string, std::vector<double>> guides_ms_;
  std::shared_ptr<const VariantGuides> exact_guides_, style_guides_;
  std::optional<TradeReference> reference_;
  std::optional<GuidedTexture> texture_;         // of the reference's exemplars
  std::map<std::size_t, std::size_t> pictures_;  // of variants, by a hash of 64 bits
  double style_first_ms_ = 0.0;                  // of the style as it is, the first variant
  std::vector<double> style_ms_;                 // all its transfers
  TradeReport report_;
};

}  // namespace

Expected<TradeReport> MeasureTradeoff(const TradeSetup& setup, const RunContext& context) {
  return Trade(setup, context).Measure();
}

std::string TradeCommand(const TradeSetup& setup, const RunContext& context) {
  std::string command = "scumble";
  for (const std::string& word : TradeArguments(setup, context)) command += " " + Quoted(word);
  return command;
}

Expected<std::size_t> PeakOfVariant(const TradeSetup& setup, const std::string& name, const RunContext& context) {
  SCUMBLE_ASSIGN(TradeStage stage, OpenTradeStage(setup, context));
  const auto variant = std::find_if(stage.grid.variants.begin(), stage.grid.variants.end(),
                                    [&](const Variant& one) { return one.name == name; });
  if (variant == stage.grid.variants.end()) return UsageError("--peak-of " + name + ": there is no such variant");
  stage.style = Style();  // the variant has its own: a run of stylize has its pictures once
  SCUMBLE_ASSIGN(const Style style, StyleOfVariant(setup, *variant, context));
  SCUMBLE_ASSIGN(const LayerSet layers, LayersOverTime(style));
  // What opening scene and style took for a moment is the same for all variants, and may hide theirs. Memory that is
  // given back stays with the process until it is trimmed, and would count as there.
  malloc_trim(0);
  ForgetPeakMemory();
  SCUMBLE_ASSIGN(VariantGuides made, MakeVariantGuides(stage.scene, setup.scene, *variant, layers, context));
  auto guides = std::make_shared<const VariantGuides>(std::move(made));
  SCUMBLE_ASSIGN(VariantPainter painter, VariantPainter::Prepare(setup, *variant, style, std::move(guides), context));
  SCUMBLE_RETURN_IF_ERROR(painter.Paint());
  return static_cast<std::size_t>(PeakMemory());
}

}  // namespace scumble
