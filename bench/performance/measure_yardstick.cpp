#include <algorithm>
#include <cstring>
#include <limits>

#include "bench/performance/performance.h"
#include "bench/performance/yardstick.h"
#include "core/image/stopwatch.h"
#include "measure/coherence.h"

namespace scumble::bench {
namespace {

YardstickGuides Planes(const GuideSet& guides) {
  return {guides.width(),
          guides.height(),
          guides.Plane(Layer::kCoverage).data(),
          guides.Plane(Layer::kNormal, 0).data(),
          guides.Plane(Layer::kNormal, 1).data(),
          guides.Plane(Layer::kNormal, 2).data()};
}

// The yardstick and its frames: it paints a frame and its mirror image in turn.
class YardstickRun {
 public:
  YardstickRun(const Frame& frame, const Engine& engine)
      : frame_(frame),
        yardstick_(frame.guides.width(), frame.guides.height(), ExemplarOf(engine), SettingsOf(engine)),
        picture_(frame.guides.width(), frame.guides.height()) {
    yardstick_.RenewJitter(0);
  }

  void Paint(bool mirrored) {
    yardstick_.Paint(Planes(mirrored ? frame_.mirrored : frame_.guides), picture_.rgba.data());
  }
  void RenewJitter(std::int64_t step) { yardstick_.RenewJitter(step); }
  std::function<void()> Frozen() {
    return [this, turn = 0]() mutable { Paint(turn++ % 2 == 1); };
  }
  std::function<void()> Renewed() {
    return [this, turn = 0]() mutable {
      RenewJitter(turn);
      Paint(turn++ % 2 == 1);
    };
  }

  const Picture& picture() const { return picture_; }
  const std::vector<YardstickSource>& sources() const { return yardstick_.sources(); }

 private:
  static YardstickExemplar ExemplarOf(const Engine& engine) {
    const PreparedExemplar& exemplar = *engine.prepared().exemplar;
    return {exemplar.size(), engine.prepared().settings.rim, exemplar.picture().rgba.data()};
  }
  static YardstickSettings SettingsOf(const Engine& engine) {
    return {engine.prepared().levels, engine.prepared().settings.threshold, engine.options.seed};
  }

  const Frame& frame_;
  Yardstick yardstick_;
  Picture picture_;
};

double CoherencePercent(const GuideSet& guides, const std::vector<std::int16_t>& x,
                        const std::vector<std::int16_t>& y) {
  std::vector<std::uint8_t> covered;
  for (const float a : guides.Plane(Layer::kCoverage)) covered.push_back(a > 0.0f);
  return 100.0 * MeasureCoherence({guides.width(), guides.height(), x, y, covered, {}}).share;
}

double CoherencePercent(const GuideSet& guides, const std::vector<YardstickSource>& sources) {
  std::vector<std::int16_t> x, y;
  for (const YardstickSource source : sources) x.push_back(source.x), y.push_back(source.y);
  return CoherencePercent(guides, x, y);
}

// Different pictures are not measured.
void StopUnlessEqual(const Frame& frame, const Picture& engine, const Picture& other, const std::string& whose) {
  if (engine.rgba == other.rgba) return;
  std::size_t i = 0;
  while (engine.rgba[i] == other.rgba[i]) ++i;
  const std::size_t pixel = i / 4, width = static_cast<std::size_t>(engine.width);
  std::fprintf(stderr, "%s: the engine's picture is not %s: channel %zu of pixel (%zu, %zu) is %d, not %d\n",
               frame.name.c_str(), whose.c_str(), i % 4, pixel % width, pixel / width, int(engine.rgba[i]),
               int(other.rgba[i]));
  std::exit(1);
}

// The frame with its first jitter, its mirror image with renewed jitter.
void CheckSamePictures(const Frame& frame, YardstickRun& yardstick, Engine& one, Engine& two, Engine& renewed) {
  renewed.Paint(frame, true);
  yardstick.RenewJitter(renewed.options.frame);
  yardstick.Paint(true);
  StopUnlessEqual(frame, renewed.picture(), yardstick.picture(), "the yardstick's where jitter is renewed");
  yardstick.RenewJitter(0);
  yardstick.Paint(false);
  one.Paint(frame), two.Paint(frame);
  StopUnlessEqual(frame, one.picture(), yardstick.picture(), "the yardstick's");
  StopUnlessEqual(frame, two.picture(), one.picture(), "that of one thread on two");
}

// The minimum cost of a frame: one copy of the planes that a transfer reads, and of the picture that it writes.
class PlainCopy {
 public:
  explicit PlainCopy(const Frame& frame)
      : frame_(frame),
        planes_(4 * frame.guides.pixel_count(), 1.0f),
        made_(4 * frame.guides.pixel_count(), 1),
        out_(made_) {}

  void Run() {
    const std::size_t count = frame_.guides.pixel_count();
    float* to = planes_.data();
    std::memcpy(to, frame_.guides.Plane(Layer::kCoverage).data(), count * sizeof(float));
    for (int c = 0; c < 3; ++c) {
      to += count;
      std::memcpy(to, frame_.guides.Plane(Layer::kNormal, c).data(), count * sizeof(float));
    }
    std::memcpy(out_.data(), made_.data(), made_.size() * sizeof(std::uint16_t));
  }

 private:
  const Frame& frame_;
  std::vector<float> planes_;
  std::vector<std::uint16_t> made_, out_;
};

// Nanoseconds a pixel of each stage, in the fastest of some frames; the remainder is the time outside the stages.
std::vector<std::pair<std::string, double>> Stages(Engine& engine, const Frame& frame) {
  constexpr int kFrames = 5;
  StageTimes best;
  double least = std::numeric_limits<double>::infinity();
  Stopwatch watch;
  for (int k = 0; k < kFrames; ++k) {
    watch.Lap();
    engine.Paint(frame, k % 2 == 1);
    const double whole = watch.Lap();
    if (whole < least) least = whole, best = engine.stages();
  }
  const double per_pixel = 1e6 / static_cast<double>(frame.covered);
  return {{"match", best.match_ms * per_pixel},
          {"vote", best.vote_ms * per_pixel},
          {"compose", best.compose_ms * per_pixel},
          {"the rest", (least - best.match_ms - best.vote_ms - best.compose_ms) * per_pixel}};
}

Style Renewed(Style style) {
  style.transfer.jitter_fps = -1.0;
  return style;
}

void MeasureFrame(const Frame& frame, const PerformanceOptions& options, Report& report) {
  report.Say("yardstick: " + frame.name);
  const int height = frame.guides.height();
  Engine one(PlainStyle(), height, 1), two(PlainStyle(), height, 2), renewed(Renewed(PlainStyle()), height, 1);
  YardstickRun yardstick(frame, one);
  CheckSamePictures(frame, yardstick, one, two, renewed);
  one.options.keep_field = true;
  one.Paint(frame);
  const double coherence = CoherencePercent(frame.guides, one.field().x, one.field().y);
  one.options.keep_field = false;
  const double yardstick_coherence = CoherencePercent(frame.guides, yardstick.sources());

  PlainCopy copy(frame);
  YardstickRun yardstick_renewed(frame, one);
  const std::function<void()> contestants[] = {yardstick.Frozen(),          Painting(one, frame),
                                               yardstick_renewed.Renewed(), Painting(renewed, frame),
                                               Painting(two, frame),        [&copy] { copy.Run(); }};
  RepeatOptions repeats = options.repeats;
  if (height > 1080) repeats.least_rounds = std::min(3, repeats.least_rounds);  // a round takes seconds
  const std::vector<Times> times = TakeTurns(contestants, repeats);
  const double per_pixel = 1e6 / static_cast<double>(frame.covered);
  const auto ns = [&](int contestant) {
    const Spread spread = times[std::size_t(contestant)].Milliseconds(Clock::kThread);
    return Spread{spread.median * per_pixel, spread.low * per_pixel, spread.high * per_pixel, spread.least * per_pixel,
                  spread.count};
  };
  const bool whole = frame.covered == frame.guides.pixel_count();
  const double target = whole ? 15.0 : 10.0;
  const Spread plain_ns = ns(0), engine_ns = ns(1), plain_renewed_ns = ns(2), renewed_ns = ns(3), copy_ns = ns(5);
  report.Add({"1",
              "engine against the yardstick, one thread",
              frame.name,
              "×",
              Ratio(times[0], times[1], Clock::kThread),
              target,
              true,
              {},
              {{"yardstick_ns", plain_ns.median},
               {"engine_ns", engine_ns.median},
               {"memcpy_ns", copy_ns.median},
               {"covered_percent", frame.CoveredPercent()}}});
  report.Add({"1",
              "the same, jitter renewed every frame",
              frame.name,
              "×",
              Ratio(times[2], times[3], Clock::kThread),
              {},
              true,
              {},
              {{"yardstick_ns", plain_renewed_ns.median}, {"engine_ns", renewed_ns.median}}});
  report.Add({"1", "two threads against one", frame.name, "×", Ratio(times[1], times[4], Clock::kWall), 1.8, true});
  std::optional<double> most_ns;
  if (whole) most_ns = 15.0;
  report.Add({"2", "engine, one thread", frame.name, "ns/px", engine_ns, most_ns, false, {}, Stages(one, frame)});
  report.Add({"2", "the same, jitter renewed every frame", frame.name, "ns/px", renewed_ns, most_ns, false});
  report.Add({"2",
              "engine against memcpy of guides in, colour out",
              frame.name,
              "×",
              Ratio(times[1], times[5], Clock::kThread),
              {},
              false});
  report.Add({"2", "coherence: neighbours of equal offset", frame.name, "%", Exactly(coherence), yardstick_coherence,
              true, "the yardstick's is the target"});
  if (times[1].Waiting() > 1.15) {
    report.Note(frame.name + ": one thread waited " + std::to_string(int(100.0 * (times[1].Waiting() - 1.0))) +
                "% of its time for the processor: the machine was not quiet, figures of two threads are too low");
  }
}

}  // namespace

void MeasureYardstick(const PerformanceOptions& options, Report& report) {
  for (const auto& [width, height] : options.sizes) {
    MeasureFrame(WithMirrorImage(HillsFrame(width, height, false)), options, report);
    MeasureFrame(CloseUp(width, height), options, report);
    for (const char* scene : {"suzanne", "stilllife", "toys"}) {
      MeasureFrame(SceneFrame(scene, width, height), options, report);
    }
  }
}

void MeasureFrameRates(const PerformanceOptions& options, Report& report) {
  const auto [width, height] = options.sizes.front();
  const auto measure = [&](const Frame& frame, double target) {
    report.Say("frames a second: " + frame.name);
    Engine frozen(PlainStyle(), height, 2), renewed(Renewed(PlainStyle()), height, 2);
    const std::function<void()> contestants[] = {Painting(frozen, frame), Painting(renewed, frame)};
    const std::vector<Times> times = TakeTurns(contestants, options.repeats);
    const auto rate = [](const Times& taken) {
      const Spread ms = taken.Milliseconds(Clock::kWall);
      return Spread{1e3 / ms.median, 1e3 / ms.high, 1e3 / ms.low, 1e3 / ms.least, ms.count};
    };
    report.Add({"2", "transfers a second, two threads", frame.name, "frames/s", rate(times[0]), target, true});
    report.Add({"2", "the same, jitter renewed every frame", frame.name, "frames/s", rate(times[1]), {}, true});
  };
  measure(WithMirrorImage(HillsFrame(width, height, false)), 60.0);
  measure(CloseUp(width, height), 60.0);
  measure(EighthFrame(width, height), 200.0);
}

}  // namespace scumble::bench
