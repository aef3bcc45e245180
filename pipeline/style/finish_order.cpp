#include "pipeline/style/finish_order.h"

#include <algorithm>

#include "core/style/finish_keys.h"
#include "pipeline/finish_set.h"

namespace scumble {
namespace {

constexpr FinishPass::Stage kStages[] = {FinishPass::Stage::kGuides, FinishPass::Stage::kPaint,
                                         FinishPass::Stage::kSheet};

bool IsLimited(const FinishPass& pass) {
  return !pass.objects.empty() || !pass.materials.empty() || !pass.mask.empty();
}

bool DrawsLines(const FinishPass& pass) {
  return std::holds_alternative<OutlinePass>(pass.effect) || std::holds_alternative<EdgesPass>(pass.effect) ||
         std::holds_alternative<HatchPass>(pass.effect);
}

// What the pass does to lines that are there; null: nothing.
const char* HarmToLines(const FinishPass& pass) {
  if (std::holds_alternative<SmoothPass>(pass.effect)) return "blurs";
  if (std::holds_alternative<TonesPass>(pass.effect)) return "makes jagged";
  return nullptr;
}

// Whether nothing of what was on an object shows through.
bool Covers(const FinishPass& pass) {
  const auto* toon = std::get_if<ToonPass>(&pass.effect);
  return !(pass.strength < 1.0) &&
         (std::holds_alternative<FillPass>(pass.effect) || std::holds_alternative<RenderPass>(pass.effect) ||
          (toon && (toon->base == ToonPass::Color::kAlbedo || toon->shading == ToonPass::Shading::kRamp)));
}

// Of passes that change a guide which nothing reads.
std::vector<std::string> IdleGuides(const Style& style, std::span<const FinishPass> chain) {
  std::vector<std::string> doubts;
  LayerSet read = TransferLayers(style);
  for (FinishPass pass : chain) {
    if (pass.at != FinishPass::Stage::kGuides) read.Add(RequiredLayers(pass));
  }
  for (const FinishPass& pass : chain) {
    const Layer layer = ChangedLayer(pass.guide);
    if (pass.at != FinishPass::Stage::kGuides || !(pass.strength > 0.0) || read.Has(layer)) continue;
    doubts.push_back("finish " + pass.name + " changes the guide " + Info(layer).name + ", which style " + style.name +
                     " does not look at: set " +
                     (layer == Layer::kAlbedo ? "transfer.colorize, or a weight of albedo in transfer.guide_weights"
                                              : "a weight of luminance in transfer.guide_weights, or give exemplars of "
                                                "several lights") +
                     ", or leave it out");
  }
  return doubts;
}

}  // namespace

std::vector<std::string> OrderDoubts(std::span<const FinishPass> passes) {
  std::vector<std::string> doubts;
  std::vector<FinishPass> chain;
  for (const auto stage : kStages) {
    for (const FinishPass& pass : passes) {
      if (pass.at == stage && pass.strength > 0.0 && !IsLimited(pass)) chain.push_back(pass);
    }
  }
  for (std::size_t later = 1; later < chain.size(); ++later) {
    for (std::size_t i = 0; i < later; ++i) {
      const std::string before = "finish " + chain[i].name, after = chain[later].name;
      if (chain[i].at == FinishPass::Stage::kGuides &&
          (chain[later].at != chain[i].at || chain[later].guide != chain[i].guide)) {
        continue;  // of another picture
      }
      if (const char* harm = HarmToLines(chain[later]); harm && DrawsLines(chain[i])) {
        doubts.push_back(before + " draws lines, which " + after + " then " + harm + ": put " + after + " before it");
      } else if (Covers(chain[later]) && chain[i].at == chain[later].at) {
        doubts.push_back(before + " is covered by " + after + ", which comes after it: put " + after +
                         " first, or leave one out");
      }
    }
  }
  return doubts;
}

std::vector<std::string> OrderDoubts(const StyleSet& styles) {
  std::vector<std::string> doubts;
  const auto add = [&](const std::string& doubt) {
    if (std::find(doubts.begin(), doubts.end(), doubt) == doubts.end()) doubts.push_back(doubt);
  };
  for (const Style& style : styles.styles) {
    std::vector<FinishPass> chain = style.finish;
    chain.insert(chain.end(), styles.finish.passes.begin(), styles.finish.passes.end());
    for (const std::string& doubt : OrderDoubts(chain)) add(doubt);
    for (const std::string& doubt : IdleGuides(style, chain)) add(doubt);
    if (style.transfer.edge != EdgeMode::kExemplar || !style.unpainted.empty()) continue;
    const auto hides_paint = [](const FinishPass& pass) {
      return std::holds_alternative<FillPass>(pass.effect) && pass.at == FinishPass::Stage::kSheet &&
             pass.strength >= 1.0 && pass.objects.empty() && pass.materials.empty() && pass.mask.empty();
    };
    if (std::any_of(chain.begin(), chain.end(), hides_paint)) continue;  // its edge does not show
    for (const FinishPass& pass : chain) {
      const auto* outline = std::get_if<OutlinePass>(&pass.effect);
      if (!outline || !(pass.strength > 0.0) || !(outline->of_class[std::size_t(LineClass::kSilhouette)] > 0.0))
        continue;
      add("finish " + pass.name + " draws exact silhouettes, and transfer.edge of style " + style.name +
          " is \"exemplar\", so the paint ends elsewhere: set transfer.edge to \"exact\", or finish." + pass.name +
          ".silhouette to 0");
    }
  }
  return doubts;
}

}  // namespace scumble
