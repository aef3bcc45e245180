#include "pipeline/finish_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include "core/io/guide_file.h"
#include "core/style/finish_keys.h"
#include "core/style/nearest_name.h"
#include "finish/mask.h"
#include "pipeline/frame_range.h"
#include "pipeline/style/assignments.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> PresetFiles(const RunContext& context) {
  std::vector<fs::path> files;
  for (const fs::path& folder : context.DataFolders("finish/presets")) {
    for (const fs::path& file : FindFinishPresets(folder)) files.push_back(file);
  }
  return files;
}

Expected<FinishChain> PassesOf(const std::string& name, const RunContext& context) {
  if (FindFinishEffect(name)) {
    SCUMBLE_ASSIGN(FinishPass pass, MakeFinishPass(name));
    return FinishChain{{std::move(pass)}, {}};
  }
  std::vector<std::string> names;
  for (const fs::path& file : PresetFiles(context)) {
    if (file.stem() == name) {
      SCUMBLE_ASSIGN(FinishPreset preset, LoadFinishPreset(file));
      return static_cast<FinishChain&&>(std::move(preset));
    }
    names.push_back(file.stem().string());
  }
  if (std::error_code failed; fs::is_regular_file(name, failed)) {
    SCUMBLE_ASSIGN(FinishPreset preset, LoadFinishPreset(name));
    return static_cast<FinishChain&&>(std::move(preset));
  }
  for (const FinishEffect& effect : FinishEffects()) names.push_back(effect.name);
  const std::string meant = NearestName(name, names);
  return InputError(fmt::format("--finish {}: there is no such effect, preset or file; there are {}, none{}", name,
                                fmt::join(names, ", "), meant.empty() ? "" : "; did you mean " + meant + "?"));
}

// The ids whose name fits one of the patterns.
std::set<std::uint32_t> IdsThatFit(const std::vector<std::string>& patterns,
                                   const std::map<std::uint32_t, std::string>& names) {
  std::set<std::uint32_t> ids;
  for (const std::string& text : patterns) {
    const NamePattern pattern(text);
    for (const auto& [id, name] : names) {
      if (pattern.Fits(name)) ids.insert(id);
    }
  }
  return ids;
}

// Takes pixels out of `only` that are not of the objects and materials which the pass names.
void LimitToNames(const FinishPass& pass, const GuideSet& guides, const TellFinish& tell,
                  std::vector<std::uint8_t>& only) {
  if (pass.objects.empty() && pass.materials.empty()) return;
  std::vector<std::uint8_t> named(guides.pixel_count(), 0);
  const auto add = [&](Layer layer, const std::vector<std::string>& patterns, const auto& names) {
    if (patterns.empty() || !guides.Has(layer)) return;
    const std::set<std::uint32_t> ids = IdsThatFit(patterns, names);
    if (ids.empty()) {
      std::vector<std::string> known;
      for (const auto& [id, name] : names) known.push_back(name);
      std::string meant;
      for (const std::string& pattern : patterns) meant += meant.empty() ? NearestName(pattern, known) : "";
      tell({{Message::Kind::kWarning,
             fmt::format("finish {}: no {} has the name {}{}", pass.name,
                         layer == Layer::kObject ? "object" : "material", fmt::join(patterns, ", "),
                         meant.empty() ? "" : "; did you mean " + meant + "?")}});
      return;
    }
    const auto plane = guides.Plane(layer);
    for (std::size_t i = 0; i < plane.size(); ++i) named[i] |= std::uint8_t(ids.count(IdOf(plane[i])) > 0);
  };
  add(Layer::kObject, pass.objects, guides.object_names);
  add(Layer::kMaterial, pass.materials, guides.material_names);
  if (only.empty()) {
    only = std::move(named);
  } else {
    for (std::size_t i = 0; i < only.size(); ++i) only[i] &= named[i];
  }
}

// The depth that half of the pixels of these objects are nearer than; 0: there are none.
double MiddleDepth(const std::string& pattern, const GuideSet& guides) {
  if (!guides.Has(Layer::kObject) || !guides.Has(Layer::kDepth)) return 0.0;
  const std::set<std::uint32_t> ids = IdsThatFit({pattern}, guides.object_names);
  const auto object = guides.Plane(Layer::kObject), depth = guides.Plane(Layer::kDepth),
             coverage = guides.Plane(Layer::kCoverage);
  std::vector<float> depths;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (coverage[i] > 0.0f && depth[i] > 0.0f && std::isfinite(depth[i]) && ids.count(IdOf(object[i])))
      depths.push_back(depth[i]);
  }
  if (depths.empty()) return 0.0;
  const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

// Puts the focus of a depth effect on the object that it names.
void Focus(const GuideSet& guides, const TellFinish& tell, FinishPass& pass) {
  auto* const depth = std::get_if<DepthPass>(&pass.effect);
  if (!depth || depth->focus_on.empty()) return;
  const double middle = MiddleDepth(depth->focus_on, guides);
  if (middle > 0.0) {
    depth->focus = middle;
    return;
  }
  const std::string text =
      fmt::format("finish {}: no object in the picture has the name {}, so the focus ", pass.name, depth->focus_on);
  if (depth->focus > 0.0) {
    tell({{Message::Kind::kWarning, text + fmt::format("stays at {} m", depth->focus)}});
  } else {
    const std::string fix = fmt::format(
        "is near: where it leaves the view, say how the focus goes on, with --set "
        "'finish.{}.focus=[[FRAME, METRES], ...]'",
        pass.name);
    tell({{Message::Kind::kWarning, text + fix}, true});
  }
}

// Without perspective nothing gets smaller with distance.
void LeaveOutThin(const GuideSet& guides, const TellFinish& tell, FinishPass& pass) {
  auto* const outline = std::get_if<OutlinePass>(&pass.effect);
  if (!outline || !(outline->thin > 0.0) || outline->thin_is_given) return;
  if (!guides.camera || !guides.camera->IsOrthographic()) return;
  outline->thin = 0.0;
  tell({{Message::Kind::kNote, fmt::format("finish {}: its thin is left out, because in an orthographic view nothing "
                                           "gets smaller with distance",
                                           pass.name)}});
}

// Makes the step fit the frame.
void Fit(const GuideSet& guides, const TellFinish& tell, FinishStep& step) {
  Focus(guides, tell, step.pass);
  LeaveOutThin(guides, tell, step.pass);
  LimitToNames(step.pass, guides, tell, step.only);
}

}  // namespace

void FinishRemarks::Tell(const FinishRemark& remark, std::optional<int> frame, const std::string& place,
                         const RunContext& context) {
  bool is_new = is_first_;
  std::string start = place.empty() ? "" : place + ": ";
  if (remark.is_of_frame && frame) {
    is_new = frames_[remark.message.text].insert(*frame).second && frames_[remark.message.text].size() == 1;
    if (place.empty()) start = fmt::format("frame {}: ", *frame);
  }
  if (is_new && context.on_message) context.on_message({remark.message.kind, start + remark.message.text});
}

void FinishRemarks::WarnOfFrames(const RunContext& context) const {
  for (const auto& [text, frames] : frames_) {
    if (frames.size() < 2) continue;
    const std::vector<int> numbers(frames.begin(), frames.end());
    context.Warn("frames " + FramesToText(numbers) + ": " + text);
  }
}

Expected<std::vector<FinishPreset>> FinishPresets(const RunContext& context) {
  std::vector<FinishPreset> presets;
  for (const fs::path& file : PresetFiles(context)) {
    SCUMBLE_ASSIGN(FinishPreset preset, LoadFinishPreset(file));
    presets.push_back(std::move(preset));
  }
  return presets;
}

Expected<FinishChain> OpenFinish(const std::vector<std::string>& names, const RunContext& context) {
  FinishChain chain;
  for (const std::string& name : names) {
    if (name == kNoFinish) continue;
    SCUMBLE_ASSIGN(FinishChain more, PassesOf(name, context));
    Append(std::move(more), chain);
  }
  return chain;
}

Status SetFinish(const std::vector<StyleOverride>& sets, FinishChain& chain) {
  for (const StyleOverride& set : sets) {
    SCUMBLE_ASSIGN(const std::size_t count, OverrideFinish(chain, set));
    if (count == 0) return NoSuchFinish(set, chain.passes);
  }
  return Ok();
}

FinishMeasures MeasuresOf(std::span<const FinishPass> passes, const std::optional<FinishMeasures>& given,
                          const GuideSet& guides) {
  if (given) return *given;
  return LooksAtMeasures(passes) ? MeasureFinish(guides) : FinishMeasures();
}

std::vector<FinishPass> AllPasses(const StyleSet& styles) {
  std::vector<FinishPass> passes;
  for (const Style& style : styles.styles) passes.insert(passes.end(), style.finish.begin(), style.finish.end());
  passes.insert(passes.end(), styles.finish.passes.begin(), styles.finish.passes.end());
  return passes;
}

bool EverLooksAtMeasures(const FinishChain& chain) {
  for (std::size_t i = 0; i < chain.passes.size(); ++i) {
    if (LooksAtMeasures(MomentsOf(chain, i))) return true;
  }
  return false;
}

bool EverLooksAtMeasures(const StyleSet& styles) {
  const auto looks = [](const Style& style) { return EverLooksAtMeasures(FinishOf(style)); };
  return EverLooksAtMeasures(styles.finish) || std::any_of(styles.styles.begin(), styles.styles.end(), looks);
}

bool MeasuresColors(std::span<const FinishPass> passes) {
  return std::any_of(passes.begin(), passes.end(), [](const FinishPass& pass) {
    const auto* palette = std::get_if<PalettePass>(&pass.effect);
    return palette && palette->from.empty();
  });
}

void PaletteColors::TellNew(std::optional<int> frame, const RunContext& context) {
  for (auto& [place, one] : palettes_) {
    if (!one.colors || std::exchange(one.is_told, true)) continue;
    if (place.second > 0) {
      context.Note("finish: several palettes go by " + place.first +
                   ": give each a name, so that what is measured can be given to it");
      continue;
    }
    const std::string where =
        frame ? fmt::format(" on frame {}: give it to each run where a sequence is cut into several", *frame) : "";
    const auto& [mean, covariance] = *one.colors;
    context.Note(fmt::format("finish: --set '{}={}{:.6g} {:.6g}' repeats what was measured{}", place.first,
                             kMeasuredPalette, fmt::join(mean, " "), fmt::join(covariance, " "), where));
  }
}

namespace {

// Lets a palette keep what it measures. `style`: that --set needs before the key, or empty.
class ColorKeeper {
 public:
  explicit ColorKeeper(PaletteColors* colors) : colors_(colors) {}
  void Fit(const std::string& style, FinishStep& step) {
    if (!colors_ || !std::holds_alternative<PalettePass>(step.pass.effect)) return;
    const std::string key = (style.empty() ? "" : style + ":") + kFinishKeys + step.pass.name + ".from";
    step.colors = colors_->Of(key, counts_[key]++);
  }

 private:
  PaletteColors* colors_;
  std::map<std::string, int> counts_;
};

}  // namespace

std::vector<FinishStep> FinishStepsOf(const StyleSet& styles, const GuideSet& guides, const StyleMap* map, bool over,
                                      const TellFinish& tell, PaletteColors* colors) {
  std::vector<FinishStep> steps;
  ColorKeeper keeper(colors);
  for (std::size_t i = 0; i < styles.styles.size(); ++i) {
    if (styles.styles[i].finish.empty()) continue;
    std::vector<std::uint8_t> own;
    if (map) {
      own.resize(map->style.size());
      for (std::size_t p = 0; p < own.size(); ++p) own[p] = map->style[p] == i;
    }
    for (const FinishPass& pass : styles.styles[i].finish) {
      FinishStep& step = steps.emplace_back(FinishStep{pass, own});
      step.reference_height = styles.styles[i].transfer.reference_height;
      Fit(guides, tell, step);
      keeper.Fit(styles.given[i], step);
      step.share = MaskShares(pass.mask, &guides, guides.width(), guides.height());
    }
  }
  std::vector<std::uint8_t> shows;
  if (map && !styles.finish.passes.empty()) {
    shows.resize(map->style.size());
    for (std::size_t p = 0; p < shows.size(); ++p) {
      shows[p] = map->style[p] != StyleMap::kShadowCatcher && (over || map->style[p] != StyleMap::kPassThrough);
    }
    if (std::find(shows.begin(), shows.end(), 0) == shows.end()) shows.clear();
  }
  for (const FinishPass& pass : styles.finish.passes) {
    // What lies on the sheet and reads no guides is also of what shows behind.
    const bool is_of_all = pass.at == FinishPass::Stage::kSheet && RequiredLayers(pass).empty();
    FinishStep& step = steps.emplace_back(FinishStep{pass, is_of_all ? std::vector<std::uint8_t>() : shows});
    step.reference_height = styles.first().transfer.reference_height;
    Fit(guides, tell, step);
    keeper.Fit("", step);
    step.share = MaskShares(pass.mask, &guides, guides.width(), guides.height());
  }
  return steps;
}

std::vector<FinishStep> FinishStepsOf(const std::vector<FinishPass>& passes, const Size& size, const GuideSet* guides,
                                      const TellFinish& tell, PaletteColors* colors) {
  std::vector<FinishStep> steps;
  ColorKeeper keeper(colors);
  for (const FinishPass& pass : passes) {
    FinishStep& step = steps.emplace_back(FinishStep{pass, {}});
    if (guides) Fit(*guides, tell, step);
    keeper.Fit("", step);
    step.share = MaskShares(pass.mask, guides, size.width, size.height);
  }
  return steps;
}

FinishMeasures MeasureAndTell(const GuideSet& guides, const LayerSet& read, std::optional<int> frame,
                              const RunContext& context) {
  FinishMeasures measures = MeasureFinish(guides);
  const FinishMeasures unmeasured;
  if (!read.Has(Layer::kLuminance)) measures.bright = unmeasured.bright;
  if (!read.Has(Layer::kLpeFull)) measures.full = unmeasured.full;
  if (CoveredShare(guides) == 0.0) {
    context.Warn(
        "finish: the picture shows no surface, so neither depths nor light were measured: where it is one of a "
        "sequence, give --finish-measures of a frame that shows something");
    return measures;
  }
  const std::string where =
      frame ? fmt::format(" on frame {}: give it to each run where a sequence is cut into several", *frame) : "";
  const std::string text = "finish: --finish-measures " + MeasuresText(measures) + " repeats what was measured" + where;
  frame ? context.Warn(text) : context.Note(text);
  return measures;
}

bool FrameToMeasure::IsEnough(int frame, const GuideSet& guides) {
  const double shown = CoveredShare(guides);
  if (shown > share) best = frame, share = shown;
  return shown >= kEnoughToMeasure;
}

Error CannotMeasure(const Error& error, int frame, const std::string& option) {
  if (error.kind != ErrorKind::kInput) return error;
  const std::string text = fmt::format("{}; all frames are painted by what frame {} shows", error.message, frame);
  return {error.kind, option.empty() ? text : text + ": fix it, or give " + option};
}

bool IsBroken(const std::string& guides) {
  const auto info = InspectGuides(guides);
  if (!info) return true;
  if (info->layers.empty()) return false;
  GuideReadOptions what_it_has;
  std::tie(what_it_has.view_layer, what_it_has.required) = *info->layers.begin();
  return !ReadGuides(guides, what_it_has);
}

std::string NothingToMeasure(const std::vector<int>& frames, const std::string& options) {
  return fmt::format("no surface shows in frames {}, so nothing was measured: give {} of a frame that shows one",
                     FramesToText(frames), options);
}

std::string MeasuresText(const FinishMeasures& measures) {
  const auto& [near, middle, far, bright, full] = measures;
  return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", near, middle, far, bright, full);
}

}  // namespace scumble
