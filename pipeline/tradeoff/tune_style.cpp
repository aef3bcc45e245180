#include "pipeline/tune_style.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "core/image/exact_math.h"
#include "pipeline/tradeoff/stage.h"
#include "pipeline/variant/variant_error.h"

namespace scumble {
namespace {

constexpr int kOtherSeeds = 2;                          // for what chance makes
constexpr int kTimedRuns = 5;                           // of each proposal, in turns; the quickest counts
constexpr double kThresholds[] = {0.5, 0.7, 1.4, 2.0};  // times the style's own

struct TunedKey {
  std::string key;
  std::vector<KeyValue> values;
};

// The values to try, the style's own ones left out.
std::vector<TunedKey> KeysOf(const Style& style, const std::vector<StyleOverride>& sets) {
  const TransferSettings& own = style.transfer;
  const auto other_than = [](double value, const std::vector<int>& values) {
    std::vector<KeyValue> others;
    for (const int one : values) {
      if (one != value) others.emplace_back(std::int64_t(one));
    }
    return others;
  };
  TunedKey threshold{"transfer.threshold", {}};
  for (const double factor : kThresholds) threshold.values.emplace_back(RoundToDigits(factor * own.threshold, 3));
  std::vector<TunedKey> keys = {std::move(threshold),
                                {"transfer.hybrid", other_than(own.hybrid, {0, 4, 8, 16})},
                                {"transfer.variety", other_than(own.variety, {0, 8, 15, 25})},
                                {"transfer.blend_radius", other_than(own.blend_radius, {0, 1, 2, 4})}};
  std::erase_if(keys, [&](const TunedKey& one) {
    const bool moves = std::any_of(style.tracks.begin(), style.tracks.end(),
                                   [&](const StyleTrack& track) { return track.name == one.key; });
    return moves || std::any_of(sets.begin(), sets.end(),
                                [&](const StyleOverride& set) { return set.style.empty() && set.key == one.key; });
  });
  return keys;
}

// A scene with its guides, and what the exemplar's paint looks like under them.
class TuneScene {
 public:
  static Expected<std::unique_ptr<TuneScene>> Open(const TuneRequest& request, const std::string& file,
                                                   const RunContext& context) {
    auto scene = std::unique_ptr<TuneScene>(new TuneScene(context));
    scene->setup_.style = request.style;
    scene->setup_.scene.scene = file, scene->setup_.scene.size = request.size, scene->setup_.scene.seed = request.seed;
    scene->setup_.quick = true;
    SCUMBLE_ASSIGN(TradeStage stage, OpenTradeStage(scene->setup_, context));
    const LayerSet layers = stage.scene.layers;
    SCUMBLE_ASSIGN(VariantGuides made, MakeVariantGuides(stage.scene, scene->setup_.scene, {}, layers, scene->silent_));
    SCUMBLE_RETURN_IF_ERROR(made.guides.Validate(file));
    scene->guides_ = std::make_shared<const VariantGuides>(std::move(made));
    SCUMBLE_ASSIGN(VariantPainter own, scene->PainterOf({}));
    scene->reference_.emplace(std::shared_ptr<const GuideSet>(scene->guides_, &scene->guides_->guides), own.prepared(),
                              own.exposure(), context.threads);
    SCUMBLE_ASSIGN(GuidedTexture texture, scene->reference_->Texture());
    scene->texture_.emplace(std::move(texture));
    return scene;
  }

  // Of bare paint, which is measured.
  Expected<VariantPainter> PainterOf(const Variant& variant) const {
    SCUMBLE_ASSIGN(Style style, StyleOfVariant(setup_, variant, silent_));
    style.transfer.colorize = 0.0;
    style.finish.clear();
    return VariantPainter::Prepare(setup_, variant, style, guides_, silent_);
  }
  // Of the picture as stylize paints it, with paper, base colours and finishing effects, which is timed and shown.
  Expected<VariantPainter> ShownPainterOf(const Variant& variant) const {
    SCUMBLE_ASSIGN(const Style style, StyleOnPaper(setup_, variant, silent_));
    return VariantPainter::Prepare(setup_, variant, style, guides_, silent_);
  }

  Expected<double> TextureOf(const Picture& picture) const {
    TradeMeasure measure;
    SCUMBLE_RETURN_IF_ERROR(reference_->MeasureTexture(*texture_, picture, measure));
    if (!measure.texture || !(*measure.texture > 0.0)) {
      return InputError(setup_.scene.scene + ": too few pixels show paint to be measured; take a larger --size");
    }
    return *measure.texture;
  }

 private:
  explicit TuneScene(const RunContext& context) : silent_(context.WithoutNotes()) {}

  TradeSetup setup_;
  RunContext silent_;
  std::shared_ptr<const VariantGuides> guides_;
  std::optional<TradeReference> reference_;
  std::optional<GuidedTexture> texture_;
};

class Tuner {
 public:
  Tuner(const TuneRequest& request, const RunContext& context)
      : request_(request), context_(context), progress_(context.StartProgress("tune")) {}

  Expected<TuneReport> Tune() {
    SCUMBLE_RETURN_IF_ERROR(Open());
    SCUMBLE_ASSIGN(const double own, LogTextureOf({}, 0));
    own_ = own;
    for (int seed = 1; seed <= kOtherSeeds; ++seed) {
      SCUMBLE_ASSIGN(const double other, LogTextureOf({}, seed));
      report_.chance = std::max(report_.chance, std::expm1(std::abs(other - own_)));
    }
    SCUMBLE_RETURN_IF_ERROR(Search());
    SCUMBLE_RETURN_IF_ERROR(Propose());
    return std::move(report_);
  }

 private:
  using Settings = std::map<std::string, KeyValue>;  // by key

  Status Open() {
    StyleRequest plain = request_.style;
    plain.scene_styles = false;
    SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(plain, context_));
    const Style& style = styles.styles.front();
    if (!style.unpainted.empty()) {
      return UsageError(request_.style.style + ": method = \"" + style.unpainted +
                        "\" has no paint that could look like an exemplar's, so there is nothing to tune");
    }
    if (style.transfer.method == Method::kLitSphere) {
      return UsageError(request_.style.style +
                        ": method = \"litsphere\" looks up each pixel by itself, so there is "
                        "nothing to tune; take \"styleblit\"");
    }
    report_.style = style.name.empty() ? request_.style.style : style.name;
    keys_ = KeysOf(style, request_.style.sets);
    if (keys_.empty()) return UsageError(request_.style.style + ": every key that could be tuned is given or moves");
    for (const std::string& file : request_.scenes) {
      SCUMBLE_ASSIGN(auto scene, TuneScene::Open(request_, file, context_));
      scenes_.push_back(std::move(scene));
      report_.scenes.push_back(std::filesystem::path(file).stem().string());
    }
    return Ok();
  }

  static Variant VariantOf(const Settings& settings, int more_seed) {
    Variant variant;
    for (const auto& [key, value] : settings) variant.settings.push_back(MakeOverride(key, value));
    variant.more_seed = more_seed;
    return variant;
  }

  // Mean over the scenes of the logarithm, so that each counts by its own.
  Expected<double> LogTextureOf(const Settings& settings, int more_seed) {
    SCUMBLE_RETURN_IF_ERROR(Step());
    double sum = 0.0;
    for (const auto& scene : scenes_) {
      SCUMBLE_ASSIGN(VariantPainter painter, scene->PainterOf(VariantOf(settings, more_seed)));
      SCUMBLE_RETURN_IF_ERROR(painter.Paint());
      SCUMBLE_ASSIGN(const double texture, scene->TextureOf(painter.picture()));
      sum += std::log(texture);
    }
    ++report_.tried;
    return sum / static_cast<double>(scenes_.size());
  }

  // Threshold and hybrid together first: larger chunks show steps of tone, which the hybrid takes away, and small ones
  // leave it nothing to do. One after the other, neither would change. Then each key by itself.
  Status Search() {
    std::vector<TunedKey> together, others;
    for (const TunedKey& key : keys_) {
      const bool is_of_chunks = key.key == "transfer.threshold" || key.key == "transfer.hybrid";
      (is_of_chunks ? together : others).push_back(key);
    }
    std::vector<std::vector<TunedKey>> groups = {together};
    for (const std::vector<TunedKey>& keys : {others, keys_}) {
      for (const TunedKey& key : keys) groups.push_back({key});
    }
    double work = kOtherSeeds + 1 + kTimedRuns;
    for (const std::vector<TunedKey>& group : groups) work += static_cast<double>(Ways({}, group).size());
    work_ = work;
    Settings best;
    double least = own_;
    for (const std::vector<TunedKey>& group : groups) {
      for (const Settings& one : Ways(best, group)) {
        if (one.empty()) {
          SCUMBLE_RETURN_IF_ERROR(Step());
          continue;
        }
        if (!tried_.contains(one)) {
          SCUMBLE_ASSIGN(tried_[one], LogTextureOf(one, 0));
        } else {
          SCUMBLE_RETURN_IF_ERROR(Step());
        }
        if (tried_[one] < least) least = tried_[one], best = one;
      }
    }
    return Ok();
  }

  // The settings with each combination of these keys' values, those of the style among them.
  static std::vector<Settings> Ways(const Settings& settings, const std::vector<TunedKey>& keys) {
    std::vector<Settings> ways = {settings};
    for (const TunedKey& key : keys) {
      std::vector<Settings> more;
      for (Settings one : ways) {
        one.erase(key.key);
        more.push_back(one);
        for (const KeyValue& value : key.values) {
          one[key.key] = value;
          more.push_back(one);
        }
      }
      ways = std::move(more);
    }
    return ways;
  }

  static int KeysThatDiffer(const Settings& a, const Settings& b) {
    int count = 0;
    for (const auto& [key, value] : a) count += !b.contains(key) || b.at(key) != value;
    for (const auto& [key, value] : b) count += !a.contains(key);
    return count;
  }

  // The nearest of all that were tried, and not one twice.
  Status Propose() {
    std::vector<std::pair<double, Settings>> order;
    for (const auto& [settings, off] : tried_) order.emplace_back(off, settings);
    std::sort(order.begin(), order.end());
    std::vector<Settings> chosen = {{}};
    for (const auto& [off, settings] : order) {
      const double share = std::exp(off - own_);
      if (share > 1.0 / (1.0 + report_.chance) || chosen.size() > kMostProposals) break;
      const bool is_known =
          std::any_of(chosen.begin() + 1, chosen.end(), [&, off = off, &settings = settings](const Settings& better) {
            const double farther = std::expm1(off - tried_.at(better));
            return farther == 0.0 || (farther <= report_.chance && KeysThatDiffer(settings, better) < 2);
          });
      if (!is_known) chosen.push_back(settings);
    }
    std::vector<std::vector<double>> ms(chosen.size(), std::vector<double>(scenes_.size(), 0.0));
    std::vector<TunedStyle> styles(chosen.size());
    for (std::size_t s = 0; s < scenes_.size(); ++s) {
      std::vector<VariantPainter> painters;
      for (const Settings& settings : chosen) {
        SCUMBLE_ASSIGN(VariantPainter painter, scenes_[s]->ShownPainterOf(VariantOf(settings, 0)));
        painters.push_back(std::move(painter));
      }
      for (int run = 0; run < kTimedRuns; ++run) {
        if (s == 0) SCUMBLE_RETURN_IF_ERROR(Step());
        for (std::size_t i = 0; i < painters.size(); ++i) {
          SCUMBLE_RETURN_IF_ERROR(context_.CheckNotCancelled());
          SCUMBLE_ASSIGN(const double took, painters[i].Paint());
          ms[i][s] = run == 0 ? took : std::min(ms[i][s], took);
        }
      }
      for (std::size_t i = 0; i < painters.size(); ++i) styles[i].pictures.push_back(painters[i].picture());
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      styles[i].settings = VariantOf(chosen[i], 0).settings;
      styles[i].texture = i == 0 ? 1.0 : std::exp(tried_[chosen[i]] - own_);
      double sum = 0.0;
      for (std::size_t s = 0; s < scenes_.size(); ++s) sum += std::log(ms[i][s] / ms[0][s]);
      styles[i].time = std::exp(sum / static_cast<double>(scenes_.size()));
    }
    report_.own = std::move(styles.front());
    report_.proposals.assign(std::make_move_iterator(styles.begin() + 1), std::make_move_iterator(styles.end()));
    return Ok();
  }

  Status Step() {
    SCUMBLE_RETURN_IF_ERROR(context_.CheckNotCancelled());
    return progress_ && !progress_(std::min(1.0, done_++ / work_)) ? Status(CancelledError()) : Ok();
  }

  const TuneRequest& request_;
  const RunContext& context_;
  Progress progress_;
  double work_ = 1.0, done_ = 0.0;
  std::vector<TunedKey> keys_;
  std::vector<std::unique_ptr<TuneScene>> scenes_;
  std::map<Settings, double> tried_;  // and the logarithm of their texture
  double own_ = 0.0;                  // that of the style as it is
  TuneReport report_;
};

}  // namespace

Expected<TuneReport> TuneStyle(const TuneRequest& request, const RunContext& context) {
  return Tuner(request, context).Tune();
}

}  // namespace scumble
