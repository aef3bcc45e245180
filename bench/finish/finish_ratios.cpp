#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/finish/contenders.h"
#include "bench/finish/finish_reports.h"
#include "tests/support/finish_chains.h"

namespace scumble::bench {
namespace {

constexpr const char* kItem = "9";
constexpr int kEveryRow = 8;  // of the plain loop, which takes seconds for all

class Ratios {
 public:
  Ratios(const FinishWork& work, const RepeatOptions& repeats, Report& report)
      : work_(work), repeats_(repeats), report_(report), picture_(work.painted()) {
    repeats_.before = [this] {
      picture_ = work_.painted();
      other_.Touch();
    };
    frame_ = "stilllife " + std::to_string(picture_.width) + "×" + std::to_string(picture_.height);
  }

  std::function<void()> Applying(std::vector<FinishPass> passes) {
    return [this, passes = std::move(passes)] { work_.Apply(passes, picture_); };
  }

  // `ours` against `other`, times `factor`.
  void Against(const std::string& what, const std::function<void()>& ours, const std::function<void()>& other,
               double most, double factor = 1.0, const std::string& note = "") {
    report_.Say(what);
    const auto times = TakeTurns(std::array{ours, other}, repeats_);
    report_.Add({.item = kItem,
                 .what = what,
                 .frame = frame_,
                 .unit = "×",
                 .value = Ratio(times[0], times[1], Clock::kWall, factor),
                 .target = most,
                 .note = note,
                 .more = {{"ours_ms", times[0].Milliseconds(Clock::kWall).median},
                          {"other_ms", times[1].Milliseconds(Clock::kWall).median}}});
  }

  void Alone(const std::string& what, const std::function<void()>& ours, double most_ms) {
    report_.Say(what);
    const auto times = TakeTurns(std::array{ours}, repeats_);
    report_.Add({.item = kItem,
                 .what = what,
                 .frame = frame_,
                 .unit = "ms",
                 .value = times[0].Milliseconds(Clock::kWall),
                 .target = most_ms});
  }

 private:
  const FinishWork& work_;
  RepeatOptions repeats_;
  Report& report_;
  Picture picture_;
  OtherMemory other_;
  std::string frame_;
};

}  // namespace

Status MeasureFinishRatios(const FinishWork& work, RepeatOptions repeats, Report& report) {
  Ratios ratios(work, repeats, report);
  using Filter = Contender::Filter;
  Copies copies(work, FusedPasses());
  ratios.Against(
      "tones, shadows, depth, grade against copies", ratios.Applying(FusedPasses()), [&] { copies.Run(); }, 4.0);
  ratios.Against("outline 32 pixels wide against 2", ratios.Applying(Outlining(32.0)), ratios.Applying(Outlining(2.0)),
                 1.2);

  const std::vector<float> rgb = work.Colors();
  const int width = work.painted().width, height = work.painted().height;
  const std::vector<Contender> contenders = OpenCvContenders(width, height, rgb);
  const auto against = [&](Filter filter, const std::string& what, std::vector<FinishPass> passes, double most) {
    const auto has_it = [&](const Contender& contender) { return contender.filter == filter; };
    const auto found = std::find_if(contenders.begin(), contenders.end(), has_it);
    if (found == contenders.end()) return report.Note("not measured, OpenCV has it not on this system: " + what);
    ratios.Against(what, ratios.Applying(std::move(passes)), found->run, most);
  };
  against(Filter::kBilateral, "smooth bilateral, 4 passes, against OpenCV's, d 13",
          Smoothing(SmoothPass::Filter::kBilateral, 3.0, 4), 1.0);
  against(Filter::kGuided, "smooth guided against OpenCV's ximgproc", Smoothing(SmoothPass::Filter::kGuided, 4.0, 1),
          1.0);
  ratios.Against("smooth kuwahara, radius 6, against a plain loop",
                 ratios.Applying(Smoothing(SmoothPass::Filter::kKuwahara, 6.0, 1)),
                 PlainKuwahara(width, height, rgb, kEveryRow).run, 0.25, 1.0 / kEveryRow,
                 "the plain loop does every " + std::to_string(kEveryRow) + "th row, its time counted as often");
  against(Filter::kGaussians, "edges of light against two of OpenCV's Gaussians", Edging(EdgesPass::Tone::kLight), 1.5);

  SCUMBLE_ASSIGN(const std::vector<FinishedChain> presets, PresetChains(SCUMBLE_SOURCE_DIR));
  for (const FinishedChain& preset : presets) {
    if (preset.name == "preset comic") ratios.Alone(preset.name, ratios.Applying(preset.passes), 60.0);
  }
  return Ok();
}

}  // namespace scumble::bench
