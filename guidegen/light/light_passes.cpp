#include "guidegen/light/light_passes.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/image/stopwatch.h"
#include "guidegen/rays/progress_gate.h"
#include "guidegen/surface/bsdf.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

// With fewer samples an estimated error is noise itself, and does not end the sampling.
constexpr int kLeastSamplesForNoise = 16;

// Paths of a pixel between two polls for cancellation: they take far less than a tenth of a second.
constexpr int kSamplesBetweenPolls = 64;

void AddRays(const RayCounts& from, RayCounts& to) {
  to.shadow += from.shadow;
  to.bounce += from.bounce;
}

// Statistics of one list of pixels in one pass, for the estimate of the error: per layer, over the pixels' luminances.
struct PassStatistics {
  std::array<double, kMaxPathLayers> sum{};
  std::array<double, kMaxPathLayers> squared_error{};
  RayCounts rays;
  WorkCounts work;
};

class LightPasses {
 public:
  LightPasses(const LightPathTracer& tracer, const PathFollower& follower,
              const std::vector<std::vector<PathPixel>>& pixels, std::uint64_t seed, GuideSet& guides)
      : tracer_(tracer),
        follower_(follower),
        pixels_(pixels),
        guides_(guides),
        seed_(seed),
        layers_(follower.layers().size()),
        statistics_(pixels.size()) {}

  // Keeps the sums, so that a next pass can continue.
  void KeepSums() {
    kept_.resize(pixels_.size());
    for (std::size_t i = 0; i < pixels_.size(); ++i) kept_[i].assign(pixels_[i].size() * layers_, glm::dvec3(0.0));
  }

  // Brings every pixel from `done` samples to `wanted`, and writes the layers. False if the caller cancelled.
  bool Run(int done, int wanted, ProgressGate& gate) {
    tbb::parallel_for(std::size_t(0), pixels_.size(), [&](std::size_t list) {
      if (gate.cancelled()) return;
      PassStatistics& statistics = statistics_[list] = {};
      const WorkMeter meter;
      for (std::size_t i = 0; i < pixels_[list].size(); ++i) {
        PathSums sums{};
        const auto kept =
            kept_.empty() ? std::span<glm::dvec3>() : std::span(kept_[list]).subspan(i * layers_, layers_);
        std::copy(kept.begin(), kept.end(), sums.begin());
        if (!Shade(pixels_[list][i], done, wanted, sums, statistics, gate)) return;
        std::copy_n(sums.begin(), kept.size(), kept.begin());
      }
      statistics.work = meter.Since();
      gate.TileDone();
    });
    for (const PassStatistics& statistics : statistics_) {
      AddRays(statistics.rays, rays_);
      AddWork(statistics.work, work_);
    }
    return !gate.cancelled();
  }

  // The root of the mean squared error over the mean, of the worst layer.
  double Noise() const {
    std::size_t count = 0;
    for (const auto& list : pixels_) count += list.size();
    double worst = 0.0;
    for (std::size_t layer = 0; layer < follower_.layers().size(); ++layer) {
      double sum = 0.0;
      double squares = 0.0;
      for (const PassStatistics& statistics : statistics_) {
        sum += statistics.sum[layer];
        squares += statistics.squared_error[layer];
      }
      if (sum > 0.0) worst = std::max(worst, std::sqrt(squares / double(count)) / (sum / double(count)));
    }
    return worst;
  }

  const RayCounts& rays() const { return rays_; }
  const WorkCounts& work() const { return work_; }

 private:
  // False if the caller cancelled; nothing is written then.
  bool Shade(const PathPixel& pixel, int done, int wanted, PathSums& sums, PassStatistics& statistics,
             ProgressGate& gate) {
    const LightPathTracer::First first = tracer_.FirstVertex(pixel);
    const Sampler sampler(pixel.index, 0, seed_);
    PathSums exact{};
    RayCounts exact_rays;
    tracer_.AddExact(first, exact, exact_rays);
    if (done == 0) AddRays(exact_rays, statistics.rays);
    const PathSums before = sums;
    for (int sample = done; sample < wanted; ++sample) {
      if ((sample - done) % kSamplesBetweenPolls == 0 && !gate.Continue()) return false;
      tracer_.AddSample(first, sampler, std::uint32_t(sample), sums, statistics.rays);
    }
    for (std::size_t layer = 0; layer < follower_.layers().size(); ++layer) {
      const glm::dvec3 light = exact[layer] + (wanted > 0 ? sums[layer] / double(wanted) : glm::dvec3(0.0));
      Write(follower_.layers()[layer], pixel.index, light);
      statistics.sum[layer] += Brightness(light);
      if (done == 0 || wanted == done) continue;
      // Two means of independent samples differ by their errors; half the difference is the error of their own mean.
      const double old_mean = Brightness(before[layer]) / done;
      const double new_mean = Brightness(sums[layer] - before[layer]) / (wanted - done);
      const double error = (old_mean - new_mean) * std::sqrt(double(done) * (wanted - done)) / wanted;
      statistics.squared_error[layer] += error * error;
    }
    return true;
  }

  void Write(Layer layer, std::size_t index, const glm::dvec3& light) {
    // Values brighter than a float's range become the largest float.
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    for (int c = 0; c < 3; ++c) guides_.Plane(layer, c)[index] = float(std::min(light[c], kMaxFloat));
  }

  const LightPathTracer& tracer_;
  const PathFollower& follower_;
  const std::vector<std::vector<PathPixel>>& pixels_;
  GuideSet& guides_;
  const std::uint64_t seed_;
  const std::size_t layers_;
  std::vector<std::vector<glm::dvec3>> kept_;  // by list; of each pixel its layers' sums
  std::vector<PassStatistics> statistics_;     // by list, so that sums do not depend on the order of work
  RayCounts rays_;
  WorkCounts work_;
};

// The number of samples after the next pass: doubled, or as many as the time allows at the speed so far. `done` if no
// further pass fits.
int NextSamples(int done, double seconds, const GuidegenOptions& options) {
  // The cost of a sample is unknown before the first pass. Without a clock that pass is half of the least number that
  // gives an error estimate, or of the limit.
  if (done == 0) {
    if (options.time_budget_seconds > 0.0) return 1;
    return std::clamp(options.max_samples / 2, 1, kLeastSamplesForNoise / 2);
  }
  int more = std::min(done, options.max_samples - done);
  if (options.time_budget_seconds > 0.0) {
    const double left = options.time_budget_seconds - seconds;
    more = int(std::clamp(left / std::max(seconds, 1e-9) * done, 0.0, double(more)));
  }
  return done + more;
}

}  // namespace

LightPassResult TraceLightPaths(const LightPathTracer& tracer, const PathFollower& follower,
                                const std::vector<std::vector<PathPixel>>& pixels, const GuidegenOptions& options,
                                double progress_begin, GuideSet& guides) {
  LightPasses passes(tracer, follower, pixels, options.seed, guides);
  LightPassResult result;
  const bool open_ended = follower.NeedsSamples() && (options.noise > 0.0 || options.time_budget_seconds > 0.0);
  if (!open_ended) {
    result.samples = follower.NeedsSamples() ? options.samples : 0;
    ProgressGate gate(options.progress, pixels.size(), progress_begin, 1.0);
    result.cancelled = !passes.Run(0, result.samples, gate);
    result.rays = passes.rays();
    result.work = passes.work();
    return result;
  }
  passes.KeepSums();
  Stopwatch watch;
  double seconds = 0.0;
  // The number of passes is unknown, so each one takes half of the remaining progress.
  for (double begin = progress_begin; !result.cancelled; begin = 0.5 * (begin + 1.0)) {
    const int wanted = NextSamples(result.samples, seconds, options);
    if (wanted == result.samples) break;
    ProgressGate gate(options.progress, pixels.size(), begin, 0.5 * (begin + 1.0));
    result.cancelled = !passes.Run(result.samples, wanted, gate);
    const bool told = result.samples > 0;
    result.samples = wanted;
    seconds += watch.Lap() * 1e-3;
    if (!told) continue;
    result.noise = passes.Noise();
    if (result.samples >= kLeastSamplesForNoise && options.noise > 0.0 && result.noise <= options.noise) break;
  }
  result.rays = passes.rays();
  result.work = passes.work();
  return result;
}

}  // namespace scumble
