#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "core/image/check.h"
#include "finish/finish.h"
#include "finish/ink_layer.h"
#include "finish/points/point_block.h"

namespace scumble {
namespace {

// Passes after which a chain goes on from a picture, whatever comes next: ApplyFinish never joins them with others.
bool StandsAlone(const FinishPass& pass) {
  return std::holds_alternative<OutlinePass>(pass.effect) || std::holds_alternative<EdgesPass>(pass.effect) ||
         std::holds_alternative<HatchPass>(pass.effect) || std::holds_alternative<SmoothPass>(pass.effect) ||
         std::holds_alternative<PigmentPass>(pass.effect);
}

class Layering {
 public:
  Layering(std::span<const FinishStep> steps, const FinishFrame& frame, const FinishLayerOptions& options, int threads,
           Picture& picture)
      : steps_(steps), frame_(frame), options_(options), threads_(threads), picture_(picture) {}

  Status Begin() {
    if (!options_.only.empty()) {
      // A pass that changes guides shows in the paint.
      const auto is_it = [&](const FinishStep& step) {
        return step.pass.name == options_.only && step.pass.at == FinishPass::Stage::kGuides;
      };
      if (std::any_of(steps_.begin(), steps_.end(), is_it)) layers_.push_back({options_.paint, picture_});
      return Ok();
    }
    below_ = Picture(picture_.width, picture_.height);
    SCUMBLE_RETURN_IF_ERROR(PutGround(below_));
    has_ground_ = std::any_of(below_.rgba.begin(), below_.rgba.end(), [](std::uint16_t value) { return value != 0; });
    if (has_ground_) layers_.push_back({options_.ground, Stepped(below_)});
    below_ = has_ground_ ? layers_.front().picture : Picture(picture_.width, picture_.height);
    return AddWhole(options_.paint, FinishPass::Stage::kPaint, picture_);
  }

  // All steps of a stage, and their layers.
  Status Paint(FinishPass::Stage stage, const Progress& progress) {
    std::size_t begin = 0;  // of the steps that the picture has still to get
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const FinishPass& pass = steps_[i].pass;
      if (pass.at != stage) continue;
      if (IsWanted(pass) && internal::LaysInk(pass)) {
        SCUMBLE_RETURN_IF_ERROR(Apply(begin, i, stage, picture_));
        const Picture before = picture_;
        SCUMBLE_RETURN_IF_ERROR(Apply(i, i + 1, stage, picture_));
        GoOn(i + 1, begin);
        SCUMBLE_RETURN_IF_ERROR(AddInk(steps_[i], before));
      } else if (IsWanted(pass)) {
        Picture after = picture_;
        SCUMBLE_RETURN_IF_ERROR(Apply(begin, i + 1, stage, after));
        SCUMBLE_RETURN_IF_ERROR(AddWhole(pass.name, stage, after));
        if (StandsAlone(pass)) picture_ = std::move(after), GoOn(i + 1, begin);
      }
      if (progress && !progress(double(i + 1) / double(steps_.size()))) return CancelledError();
    }
    return Apply(begin, steps_.size(), stage, picture_);
  }

  Status PutGround(Picture& picture) const { return options_.put_ground ? options_.put_ground(picture) : Ok(); }

  std::vector<FinishLayer> Take() { return std::move(layers_); }

 private:
  bool IsWanted(const FinishPass& pass) const {
    return options_.only.empty() ? pass.strength > 0.0 : pass.name == options_.only;
  }

  Status Apply(std::size_t begin, std::size_t end, FinishPass::Stage stage, Picture& picture) const {
    return ApplyFinish(steps_.subspan(begin, end - begin), stage, frame_, threads_, {}, picture);
  }

  // The picture has got the steps before `end`.
  void GoOn(std::size_t end, std::size_t& begin) {
    for (const FinishStep& step : steps_.subspan(begin, end - begin)) {
      if (internal::HidesPaint(step)) frame_.strokes = {};
    }
    begin = end;
  }

  Picture Stepped(Picture picture) const {
    if (options_.bits == 8) {
      for (std::uint16_t& value : picture.rgba) value = static_cast<std::uint16_t>((value + 128u) / 257u * 257u);
    }
    return picture;
  }

  // The picture with its ground instead of all that is below it.
  void AddSheet(const std::string& name, Picture picture) {
    for (FinishLayer& layer : layers_) layer.visible = false;
    layers_.push_back({name, Stepped(std::move(picture))});
    below_ = layers_.back().picture;
  }

  // The picture instead of all that is below it, but for the ground where that is put behind later.
  Status AddWhole(const std::string& name, FinishPass::Stage stage, const Picture& picture) {
    if (!options_.only.empty()) {
      for (FinishLayer& layer : layers_) layer.visible = false;
      layers_.push_back({name, picture});
      return Ok();
    }
    if (!has_ground_ || stage != FinishPass::Stage::kPaint) {
      AddSheet(name, picture);
      return Ok();
    }
    // Over the ground it shows what the exact picture would: colours of soft borders make up for rounded alpha.
    Picture target = picture;
    SCUMBLE_RETURN_IF_ERROR(PutGround(target));
    const Picture nothing(picture.width, picture.height);
    internal::InkChange change{nothing, picture, target, std::nullopt};
    change.shares.resize(picture.rgba.size() / 4);
    for (std::size_t i = 0; i < change.shares.size(); ++i) change.shares[i] = picture.rgba[4 * i + 3];
    below_ = layers_.front().picture;
    internal::InkLayer layer = Solved(change, below_);
    if (!layer.reaches_target) {
      AddSheet(name, std::move(target));
      return Ok();
    }
    for (FinishLayer& one : layers_) one.visible = &one == &layers_.front();
    layers_.push_back({name, std::move(layer.picture)});
    return Ok();
  }

  internal::InkLayer Solved(const internal::InkChange& change, Picture& below) const {
    tbb::task_arena arena(threads_ > 0 ? threads_ : tbb::task_arena::automatic);
    return arena.execute([&] { return internal::InkBetween(change, options_.bits == 8 ? 255 : 65535, below); });
  }

  // Outlines on nothing, in one ink.
  Expected<Picture> LinesOf(FinishStep step) const {
    std::get<OutlinePass>(step.pass.effect).color = OutlinePass::Color::kInk;
    Picture lines(picture_.width, picture_.height);
    SCUMBLE_RETURN_IF_ERROR(ApplyFinish(std::span(&step, 1), step.pass.at, frame_, threads_, {}, lines));
    return lines;
  }

  // The alpha, or the darkness, of the pass's lines drawn with black ink instead of the paint's colours.
  Expected<std::vector<std::uint16_t>> SharesOf(FinishStep step, const Picture& before) const {
    std::vector<std::uint16_t> shares(before.rgba.size() / 4);
    if (std::holds_alternative<OutlinePass>(step.pass.effect)) {
      SCUMBLE_ASSIGN(const Picture lines, LinesOf(step));
      for (std::size_t i = 0; i < shares.size(); ++i) shares[i] = lines.rgba[4 * i + 3];
      return shares;
    }
    auto& edges = std::get<EdgesPass>(step.pass.effect);
    edges.color = OutlinePass::Color::kInk, edges.ink = {};
    Picture inked = before;
    SCUMBLE_RETURN_IF_ERROR(ApplyFinish(std::span(&step, 1), step.pass.at, frame_, threads_, {}, inked));
    for (std::size_t i = 0; i < shares.size(); ++i) {
      double left = 0.0, all = 0.0;
      for (std::size_t c = 4 * i; c < 4 * i + 3; ++c) left += inked.rgba[c], all += before.rgba[c];
      if (all > 0.0) shares[i] = static_cast<std::uint16_t>(std::clamp(1.0 - left / all, 0.0, 1.0) * 65535.0 + 0.5);
    }
    return shares;
  }

  Status AddInk(const FinishStep& step, const Picture& before) {
    const auto* outline = std::get_if<OutlinePass>(&step.pass.effect);
    const bool has_one_ink = outline && outline->color == OutlinePass::Color::kInk;
    if (has_one_ink && !options_.only.empty()) {
      SCUMBLE_ASSIGN(Picture lines, LinesOf(step));
      layers_.push_back({step.pass.name, std::move(lines), true});
      return Ok();
    }
    Picture target = picture_, exact;
    if (!options_.only.empty()) exact = before;
    if (step.pass.at == FinishPass::Stage::kPaint) {
      SCUMBLE_RETURN_IF_ERROR(PutGround(target));
      if (!exact.empty()) SCUMBLE_RETURN_IF_ERROR(PutGround(exact));
    }
    internal::InkChange change{before, picture_, target, std::nullopt};
    const auto* edges = std::get_if<EdgesPass>(&step.pass.effect);
    const auto* hatch = std::get_if<HatchPass>(&step.pass.effect);
    if (has_one_ink) change.ink = outline->ink;
    if (edges && edges->color == OutlinePass::Color::kInk) change.ink = edges->ink;
    if (hatch) change.ink = hatch->ink;
    if (outline || !change.ink) {
      SCUMBLE_ASSIGN(change.shares, SharesOf(step, before));
    }
    internal::InkLayer layer = Solved(change, exact.empty() ? below_ : exact);
    if (exact.empty() && !layer.reaches_target) {
      AddSheet(step.pass.name, std::move(target));
    } else {
      layers_.push_back({step.pass.name, std::move(layer.picture), true, true, layer.atop});
    }
    return Ok();
  }

  std::span<const FinishStep> steps_;
  FinishFrame frame_;  // what is known of the picture so far
  const FinishLayerOptions& options_;
  int threads_;
  Picture& picture_;
  Picture below_;  // the visible layers so far, one over the other
  bool has_ground_ = false;
  std::vector<FinishLayer> layers_;
};

}  // namespace

Expected<std::vector<FinishLayer>> FinishInLayers(std::span<const FinishStep> steps, const FinishFrame& frame,
                                                  const FinishLayerOptions& options, int threads,
                                                  const Progress& progress, Picture& picture) {
  SCUMBLE_CHECK(options.bits == 8 || options.bits == 16);
  Layering layering(steps, frame, options, threads, picture);
  if (picture.empty()) return std::vector<FinishLayer>();
  SCUMBLE_RETURN_IF_ERROR(layering.Begin());
  SCUMBLE_RETURN_IF_ERROR(layering.Paint(FinishPass::Stage::kPaint, progress));
  SCUMBLE_RETURN_IF_ERROR(layering.PutGround(picture));
  SCUMBLE_RETURN_IF_ERROR(layering.Paint(FinishPass::Stage::kSheet, {}));
  return layering.Take();
}

}  // namespace scumble
