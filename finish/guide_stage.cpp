// Passes of the stage kGuides.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/image/color.h"
#include "finish/finish.h"

namespace scumble {
namespace {

using Stage = FinishPass::Stage;

// A guide as a picture: base colours, or light as a grey whose white is the picture's brightest tenth. Brighter light
// is white and keeps its excess as a factor.
class GuidePicture {
 public:
  GuidePicture(FinishPass::Guide guide, double bright, GuideSet& guides)
      : white_(guide == FinishPass::Guide::kLuminance ? static_cast<float>(bright) : 1.0f),
        coverage_(guides.Plane(Layer::kCoverage)),
        picture_(guides.width(), guides.height()) {
    const Layer layer = ChangedLayer(guide);
    for (int c = 0; c < 3; ++c) planes_[std::size_t(c)] = guides.Plane(layer, ChannelCount(layer) == 3 ? c : 0);
    count_ = std::size_t(ChannelCount(layer));
    ForEach([&](std::size_t i, std::uint16_t* texel) {
      for (std::size_t c = 0; c < 3; ++c) texel[c] = CodeOf(planes_[c][i]);
      texel[3] = coverage_[i] > 0.0f ? 65535 : 0;
    });
  }

  Picture& picture() { return picture_; }

  // Puts back what has changed. Values whose code is the same keep their bits.
  void PutBack() {
    ForEach([&](std::size_t i, const std::uint16_t* texel) {
      if (!(coverage_[i] > 0.0f)) return;
      if (count_ == 1) {
        const std::uint16_t code = CodeOf(planes_[0][i]);
        if (texel[0] == code && texel[1] == code && texel[2] == code) return;
        const float light = 0.2126f * Srgb16ToLinear(texel[0]) + 0.7152f * Srgb16ToLinear(texel[1]) +
                            0.0722f * Srgb16ToLinear(texel[2]);
        planes_[0][i] = light * std::max(white_, planes_[0][i]);
        return;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        if (texel[c] != CodeOf(planes_[c][i])) planes_[c][i] = Srgb16ToLinear(texel[c]);
      }
    });
  }

 private:
  std::uint16_t CodeOf(float value) const { return Srgb16FromLinear(std::min(value / white_, 1.0f)); }

  template <class Visit>
  void ForEach(const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, coverage_.size(), 1 << 14), [&](const auto& part) {
      for (std::size_t i = part.begin(); i != part.end(); ++i) visit(i, picture_.rgba.data() + 4 * i);
    });
  }

  float white_;
  std::span<const float> coverage_;
  std::array<std::span<float>, 3> planes_;
  std::size_t count_ = 0;
  Picture picture_;
};

}  // namespace

bool ChangesGuides(std::span<const FinishStep> steps) {
  return std::any_of(steps.begin(), steps.end(),
                     [](const FinishStep& step) { return step.pass.at == Stage::kGuides && step.pass.strength > 0.0; });
}

Status ApplyToGuides(std::span<const FinishStep> steps, const FinishFrame& frame, int threads, const Progress& progress,
                     GuideSet& guides) {
  std::vector<FinishStep> of_stage;
  for (const FinishStep& step : steps) {
    if (step.pass.at == Stage::kGuides && step.pass.strength > 0.0) of_stage.push_back(step);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckFinish(of_stage, &guides, frame.measures));
  FinishFrame own = frame;
  own.guides = &guides;
  const double share = of_stage.empty() ? 1.0 : 1.0 / static_cast<double>(of_stage.size());
  for (std::size_t i = 0; i < of_stage.size();) {
    const FinishPass::Guide guide = of_stage[i].pass.guide;
    std::size_t end = i + 1;
    while (end < of_stage.size() && of_stage[end].pass.guide == guide) ++end;
    tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
    GuidePicture one = arena.execute([&] { return GuidePicture(guide, frame.measures.bright, guides); });
    SCUMBLE_RETURN_IF_ERROR(ApplyFinish(std::span(of_stage).subspan(i, end - i), Stage::kGuides, own, threads,
                                        Within(progress, share * double(i), share * double(end)), one.picture()));
    arena.execute([&] { one.PutBack(); });
    i = end;
  }
  return Ok();
}

}  // namespace scumble
