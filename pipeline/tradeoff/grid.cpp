#include "pipeline/tradeoff/grid.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/image/exact_math.h"
#include "pipeline/style/assignments.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr int kConverged = 1024;  // samples

const char* NameOf(Method method) {
  switch (method) {
    case Method::kLitSphere:
      return "litsphere";
    case Method::kStyleBlit:
      return "styleblit";
    case Method::kBruteForce:
      return "bruteforce";
  }
  return "";
}

class Grid {
 public:
  Grid(const Style& style, const TradeGridOptions& options) : style_(style.transfer), options_(options) {
    sphere_ = !style.exemplars.empty() && style.exemplars.front().is_sphere;
  }

  TradeGrid Make() {
    grid_.variants.push_back({"the style", kStyleAxis, "", {}});
    AddExact();
    AddMethods();
    AddChunks();
    AddVotes();
    AddNearest();
    AddGuides();
    AddSeeds();
    if (!options_.quick) AddCombinations();
    return std::move(grid_);
  }

 private:
  bool BruteForceFits() const {
    return std::size_t(options_.width) * std::size_t(options_.height) <= kMostBruteForcePixels;
  }
  bool HalfFits() const { return options_.width % 2 == 0 && options_.height % 2 == 0; }
  bool IsPlain() const { return style_.guide_weights.ArePlain(); }

  Variant& Add(const std::string& axis, const std::string& value, std::vector<StyleOverride> settings = {}) {
    Variant variant;
    variant.name = axis + " " + value, variant.axis = axis, variant.value = value,
    variant.settings = std::move(settings);
    return grid_.variants.emplace_back(std::move(variant));
  }
  // One key, which gives the axis its name.
  void AddKey(const std::string& axis, const KeyValue& value) {
    Add(axis, BareText(value), {MakeOverride("transfer." + axis, value)});
  }

  void AddExact() {
    Variant variant;
    variant.name = "the exact variant", variant.axis = kExactAxis, variant.value = "";
    if (style_.method == Method::kStyleBlit) {
      if (BruteForceFits()) {
        variant.settings.push_back(MakeOverride("transfer.method", std::string("bruteforce")));
      } else {
        grid_.left_out.push_back(fmt::format(
            "brute force in the exact variant, which is for pictures of at most {} pixels", kMostBruteForcePixels));
      }
    }
    // The nearest by comparison: a ball's formula is exact to a pixel only.
    if (IsPlain() && style_.nearest != NearestSearch::kTree)
      variant.settings.push_back(MakeOverride("transfer.nearest", std::string("tree")));
    if (style_.nearest_error > 0.0) variant.settings.push_back(MakeOverride("transfer.nearest_error", 0.0));
    if (style_.match_step > 1) variant.settings.push_back(MakeOverride("transfer.match_step", std::int64_t(1)));
    if (options_.chance && options_.samples < kConverged) variant.samples = kConverged;
    grid_.variants.push_back(std::move(variant));
  }

  void AddMethods() {
    for (const Method method : {Method::kLitSphere, Method::kStyleBlit, Method::kBruteForce}) {
      if (method == style_.method) continue;
      if (method == Method::kBruteForce && (options_.quick || !BruteForceFits())) {
        if (!options_.quick) {
          grid_.left_out.push_back(
              fmt::format("method bruteforce, which is for pictures of at most {} pixels", kMostBruteForcePixels));
        }
        continue;
      }
      AddKey("method", std::string(NameOf(method)));
    }
  }

  // What only chunks have.
  void AddChunks() {
    if (style_.method == Method::kLitSphere) return;
    if (style_.method == Method::kStyleBlit) {
      for (int levels = 1; levels <= 9; ++levels) {
        if (levels != style_.levels && (!options_.quick || levels % 2)) AddKey("levels", std::int64_t(levels));
      }
    }
    for (const double factor : {0.25, 0.5, 2.0, 4.0}) {
      const double threshold = factor * style_.threshold;
      if (!(threshold > 0.0) || !std::isfinite(threshold) || (options_.quick && (factor < 0.5 || factor > 2.0)))
        continue;
      AddKey("threshold", RoundToDigits(threshold, 6));
    }
  }

  void AddVotes() {
    for (const int radius : {0, 1, 2, 4, 8}) {
      if (radius != style_.blend_radius && (!options_.quick || radius % 4 == 0))
        AddKey("blend_radius", std::int64_t(radius));
    }
    if (!options_.quick) AddKey("edge_aware", !style_.edge_aware);
    for (const int step : {1, 2, 4}) {
      if (step != style_.match_step && (!options_.quick || step != 4)) AddKey("match_step", std::int64_t(step));
    }
  }

  // Of a tree, which may be off by such shares.
  void AddErrors(const std::vector<StyleOverride>& settings) {
    for (const double error : {0.1, 0.5, 2.0}) {
      if (error == style_.nearest_error || (options_.quick && error != 0.5)) continue;
      std::vector<StyleOverride> all = settings;
      all.push_back(MakeOverride("transfer.nearest_error", error));
      Add("nearest", fmt::format("tree within {:g}%", 100.0 * error), std::move(all));
    }
  }

  void AddNearest() {
    // Where light is weighed, the tree is used in any case.
    if (!IsPlain()) return AddErrors({});
    NearestSearch own = style_.nearest;
    if (own == NearestSearch::kAuto) own = sphere_ ? NearestSearch::kAnalytic : NearestSearch::kTable;
    if (sphere_ && own != NearestSearch::kAnalytic) AddKey("nearest", std::string("analytic"));
    for (const int resolution : {32, 64, 128, 256, 512, 1024}) {
      const bool usual = resolution == LookUpTable::kResolution;
      if ((own == NearestSearch::kTable && usual) || (options_.quick && resolution != 64 && !usual)) continue;
      Variant& variant =
          Add("nearest", fmt::format("table {}", resolution), {MakeOverride("transfer.nearest", std::string("table"))});
      variant.table_resolution = resolution;
    }
    if (own != NearestSearch::kTree) AddKey("nearest", std::string("tree"));
    AddErrors({MakeOverride("transfer.nearest", std::string("tree"))});
  }

  void AddGuides() {
    Add("precision", "8 bits").precision = GuidePrecision::kEightBits;
    if (!options_.quick) Add("precision", "half floats").precision = GuidePrecision::kHalf;
    if (HalfFits()) {
      Add("resolution", "0.5").guide_scale = 0.5;
    } else {
      grid_.left_out.push_back("resolution 0.5, which needs a picture whose sides are even");
    }
    if (options_.quick) return;
    if (HalfFits()) {
      Variant& scaled = Add("resolution", "0.5 scaled up");
      scaled.guide_scale = 0.5, scaled.upscale = true;
    }
    Add("resolution", "2").guide_scale = 2.0;
    Add("robust", "no").robust = false;
    if (!options_.chance) return;
    for (const int samples : {1, 4, 16, 64, 256, 1024}) {
      if (samples != options_.samples) Add("samples", std::to_string(samples)).samples = samples;
    }
  }

  // Other patterns of the same kind: what they differ by is chance.
  void AddSeeds() {
    if (style_.method != Method::kStyleBlit && !options_.chance) return;  // nothing is left to it
    for (int more = 1; more <= (options_.quick ? 1 : 3); ++more) Add("seed", fmt::format("+{}", more)).more_seed = more;
  }

  void AddCombinations() {
    for (const double scale : {1.0, 0.5}) {
      if (scale < 1.0 && !HalfFits()) continue;
      for (const Method method : {Method::kLitSphere, Method::kStyleBlit}) {
        for (const int levels : {3, 5, 7}) {
          if (method == Method::kLitSphere && levels != 7) continue;  // has none
          for (const int radius : {0, 1, 4}) AddCombination(scale, method, levels, radius);
        }
      }
    }
  }

  // Unless it differs in one thing only, and stands on that axis already.
  void AddCombination(double scale, Method method, int levels, int radius) {
    const bool blit = method == Method::kStyleBlit;
    const int differences =
        (scale < 1.0) + (method != style_.method) + (blit && levels != style_.levels) + (radius != style_.blend_radius);
    if (differences < 2) return;
    std::vector<StyleOverride> settings = {MakeOverride("transfer.method", std::string(NameOf(method)))};
    if (blit) settings.push_back(MakeOverride("transfer.levels", std::int64_t(levels)));
    settings.push_back(MakeOverride("transfer.blend_radius", std::int64_t(radius)));
    std::string value = NameOf(method);
    if (blit) value += fmt::format(" {} levels", levels);
    value += fmt::format(" radius {}", radius);
    if (scale < 1.0) value += " half size";
    Add("grid", value, std::move(settings)).guide_scale = scale;
  }

  const TransferSettings& style_;
  const TradeGridOptions& options_;
  bool sphere_ = true;
  TradeGrid grid_;
};

}  // namespace

TradeGrid MakeTradeGrid(const Style& style, const TradeGridOptions& options) {
  TradeGrid grid = Grid(style, options).Make();
  if (!options.quick) return grid;
  TradeGridOptions all = options;
  all.quick = false;
  const TradeGrid whole = Grid(style, all).Make();
  const std::vector<std::string> kept = AxesOf(grid.variants);
  std::vector<std::string> gone = AxesOf(whole.variants);
  std::erase_if(gone, [&](const std::string& axis) { return std::find(kept.begin(), kept.end(), axis) != kept.end(); });
  grid.left_out.push_back(fmt::format("by --quick {} of {} variants: the axes {}, and values of the others",
                                      whole.variants.size() - grid.variants.size(), whole.variants.size(),
                                      fmt::join(gone, ", ")));
  return grid;
}

std::vector<std::string> AxesOf(const std::vector<Variant>& variants) {
  std::vector<std::string> axes;
  for (const Variant& variant : variants) {
    if (std::find(axes.begin(), axes.end(), variant.axis) == axes.end()) axes.push_back(variant.axis);
  }
  return axes;
}

Expected<std::vector<Variant>> ChooseVariants(const std::vector<Variant>& variants, const std::string& only) {
  if (only.empty()) return variants;
  std::vector<bool> chosen(variants.size(), false);
  for (std::size_t begin = 0; begin <= only.size();) {
    const std::size_t end = std::min(only.find(',', begin), only.size());
    const std::string part = only.substr(begin, end - begin);
    begin = end + 1;
    bool any = false;
    const NamePattern pattern(part);
    for (std::size_t i = 0; i < variants.size(); ++i) {
      if (variants[i].axis != part && !pattern.Fits(variants[i].name)) continue;
      chosen[i] = any = true;
    }
    if (!any) {
      return UsageError(
          fmt::format("--only {}: no axis and no variant is called '{}'; the axes of this style and scene are {}", only,
                      part, fmt::join(AxesOf(variants), ", ")));
    }
  }
  std::vector<Variant> result;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    if (chosen[i] || variants[i].axis == kStyleAxis) result.push_back(variants[i]);
  }
  return result;
}

}  // namespace scumble
