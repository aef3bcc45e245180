// The light layers of the cross-check: means with their errors, noise against samples, pictures.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "core/image/color.h"
#include "measure/crosscheck.h"
#include "measure/crosscheck/parts.h"

namespace scumble {
namespace {

using internal::PutColor;

constexpr Layer kLightLayers[] = {Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLpeLDDE, Layer::kLpeLD12E, Layer::kLpeFull};
constexpr double kNoiseFree = 1e-3;      // NRMSE below which a layer's noise has no useful slope
constexpr double kBaselineFloor = 0.01;  // percent
constexpr double kTileLimit = 5.0;       // percent

// A layer, or a sum of several, in both sets.
struct LightMeasure {
  std::string name;
  double limit;  // percent
  std::function<glm::dvec3(const GuideSet&, std::size_t)> value;
  std::vector<std::size_t> mask;
};

LayerSet LayersInAll(const std::vector<CrosscheckLight>& light) {
  LayerSet there;
  for (const Layer layer : kLightLayers) {
    const bool everywhere = std::all_of(light.begin(), light.end(), [layer](const CrosscheckLight& count) {
      return count.reference.guides.Has(layer) && count.ours.Has(layer);
    });
    if (everywhere) there.Add(layer);
  }
  return there;
}

std::vector<LightMeasure> LightMeasures(const std::vector<std::size_t>& mask, const CrosscheckLight& last,
                                        const LayerSet& there) {
  const auto limit = [&](Layer layer) {
    if (layer == Layer::kLpeLDE) return 0.5;
    return layer == Layer::kLpeLSE || last.reference.glossy ? 2.0 : 1.5;
  };
  std::vector<LightMeasure> measures;
  for (const Layer layer : kLightLayers) {
    if (!there.Has(layer)) continue;
    measures.push_back({Info(layer).name, limit(layer),
                        [layer](const GuideSet& g, std::size_t i) { return glm::dvec3(g.Vec3(layer, i)); }, mask});
  }
  if (!there.Contains({Layer::kLpeFull, Layer::kLpeLDE, Layer::kLpeLSE})) return measures;
  std::vector<std::size_t> dark;  // where the surface itself does not emit
  for (const std::size_t i : mask) {
    if (!last.reference.emits[i]) dark.push_back(i);
  }
  measures.push_back({"indirect", limit(Layer::kLpeFull),
                      [](const GuideSet& g, std::size_t i) {
                        return glm::dvec3(g.Vec3(Layer::kLpeFull, i)) - glm::dvec3(g.Vec3(Layer::kLpeLDE, i)) -
                               glm::dvec3(g.Vec3(Layer::kLpeLSE, i));
                      },
                      std::move(dark)});
  return measures;
}

// Sums over the mask, in its order.
struct LightSums {
  glm::dvec3 reference{0.0}, ours{0.0};
  glm::dvec3 difference{0.0}, difference_squared{0.0};
  bool reference_zero = true, ours_zero = true;
};

LightSums SumUp(const LightMeasure& measure, const CrosscheckLight& light) {
  LightSums sums;
  for (const std::size_t i : measure.mask) {
    const glm::dvec3 a = measure.value(light.reference.guides, i), b = measure.value(light.ours, i);
    sums.reference += a, sums.ours += b;
    sums.difference += b - a, sums.difference_squared += (b - a) * (b - a);
    sums.reference_zero = sums.reference_zero && a == glm::dvec3(0.0);
    sums.ours_zero = sums.ours_zero && b == glm::dvec3(0.0);
  }
  return sums;
}

double Total(const glm::dvec3& v) { return v.x + v.y + v.z; }

// Removes the remainder of full − LDE − LSE where there is no other light: differences of rounded floats.
void ForgetRounding(const LightMeasure& measure, const CrosscheckLight& light, LightSums& sums) {
  if (measure.name != "indirect") return;
  double full_reference = 0, full_ours = 0;
  for (const std::size_t i : measure.mask) {
    full_reference += Total(glm::dvec3(light.reference.guides.Vec3(Layer::kLpeFull, i)));
    full_ours += Total(glm::dvec3(light.ours.Vec3(Layer::kLpeFull, i)));
  }
  constexpr double kRounding = 1e-6;
  sums.reference_zero = std::fabs(Total(sums.reference)) <= kRounding * full_reference;
  sums.ours_zero = std::fabs(Total(sums.ours)) <= kRounding * full_ours;
}

// The noise's part of the square of each masked pixel's difference, by channel, in the mask's order. A pixel's mean of
// N samples includes its mean of M earlier samples. So the two differ by noise alone, whose variance is σ²(1/M − 1/N);
// that of the pixel itself is σ²/N. Real differences of both sides are constant and cancel.
std::vector<glm::dvec3> NoiseVariances(const LightMeasure& measure, const std::vector<CrosscheckLight>& light) {
  std::vector<glm::dvec3> variances;
  variances.reserve(measure.mask.size());
  const CrosscheckLight& last = light.back();
  const auto difference = [&](const CrosscheckLight& count, std::size_t i) {
    return measure.value(count.ours, i) - measure.value(count.reference.guides, i);
  };
  if (light.size() > 1) {
    const CrosscheckLight& before = light[light.size() - 2];
    const double ratio = static_cast<double>(last.samples) / before.samples;
    for (const std::size_t i : measure.mask) {
      const glm::dvec3 change = difference(last, i) - difference(before, i);
      variances.push_back(change * change / (ratio - 1.0));
    }
    return variances;
  }
  glm::dvec3 sum{0.0}, squares{0.0};
  for (const std::size_t i : measure.mask) {
    const glm::dvec3 d = difference(last, i);
    sum += d, squares += d * d;
  }
  const double count = static_cast<double>(measure.mask.size());
  variances.assign(measure.mask.size(), glm::max(squares / count - (sum / count) * (sum / count), 0.0));
  return variances;
}

CrosscheckFigure MeanFigure(const LightMeasure& measure, const LightSums& sums,
                            const std::vector<glm::dvec3>& variances) {
  CrosscheckFigure figure{measure.name, "mean difference", "%", 0.0, measure.limit, 0.0, kBaselineFloor};
  if (measure.mask.empty() || (sums.reference_zero && sums.ours_zero)) {
    figure.note = measure.mask.empty() ? "every surface shines by itself" : "no such light";
    return figure;
  }
  const double total = Total(sums.reference);
  if (sums.reference_zero || sums.ours_zero || total <= 0.0) {
    figure.value = std::numeric_limits<double>::infinity();
    figure.note = sums.ours_zero ? "zero in ours, not in the reference" : "zero in the reference, not in ours";
    return figure;
  }
  glm::dvec3 variance{0.0};
  for (const glm::dvec3& one : variances) variance += one;
  figure.value = 100.0 * Total(glm::abs(sums.difference)) / total;
  figure.error = 100.0 * Total(glm::sqrt(variance)) / total;
  return figure;
}

// Light in the wrong place: the differences of tiles' means less the noise's part.
CrosscheckFigure TileFigure(const LightMeasure& measure, const LightSums& sums, const CrosscheckLight& light,
                            const std::vector<glm::dvec3>& variances) {
  constexpr int kTile = 8;
  struct Tile {
    glm::dvec3 difference{0.0}, variance{0.0};
    double pixels = 0;
  };
  const int width = light.ours.width(), columns = (width + kTile - 1) / kTile;
  std::map<int, Tile> tiles;
  for (std::size_t m = 0; m < measure.mask.size(); ++m) {
    const int x = static_cast<int>(measure.mask[m]) % width, y = static_cast<int>(measure.mask[m]) / width;
    Tile& tile = tiles[y / kTile * columns + x / kTile];
    const std::size_t i = measure.mask[m];
    tile.difference += measure.value(light.ours, i) - measure.value(light.reference.guides, i);
    tile.variance += variances[m];
    tile.pixels += 1.0;
  }
  // Σ weight · (mean² − noise) over Σ weight, weight the tile's pixels; and the error of that mean from its spread.
  const double all = static_cast<double>(measure.mask.size());
  double sum = 0.0;
  for (const auto& [index, tile] : tiles) {
    sum += Total(tile.difference * tile.difference - tile.variance) / tile.pixels;
  }
  const double mean = sum / all;
  double spread = 0.0;
  for (const auto& [index, tile] : tiles) {
    const double off = Total(tile.difference * tile.difference - tile.variance) / tile.pixels - mean * tile.pixels;
    spread += off * off;
  }
  const double error = std::sqrt(spread) / all;
  const double scale = 100.0 / (Total(sums.reference) / all / std::sqrt(3.0));
  CrosscheckFigure figure{measure.name, "8x8 tiles", "%", 0.0, kTileLimit, 0.0, kBaselineFloor};
  figure.must_prove = false;
  figure.value = scale * std::sqrt(std::max(mean, 0.0));
  // Twice the figure's error reaches to the root of the least value of the square. If that is below 0, or the noise
  // exceeds everything, it reaches to the greatest.
  const double least = scale * std::sqrt(std::max(mean - 2.0 * error, 0.0));
  figure.error = 0.5 * (mean > 0.0 ? figure.value - least : scale * std::sqrt(2.0 * error));
  if (std::isnan(mean)) figure.value = mean;
  return figure;
}

double Nrmse(const LightMeasure& measure, const LightSums& sums) {
  const double values = 3.0 * static_cast<double>(measure.mask.size());
  return std::sqrt(Total(sums.difference_squared) / values) / (Total(sums.reference) / values);
}

// Least squares through (log samples, log NRMSE).
double LogLogSlope(const std::vector<int>& samples, const std::vector<double>& nrmse) {
  double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  const double n = static_cast<double>(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double x = std::log(static_cast<double>(samples[i])), y = std::log(nrmse[i]);
    sum_x += x, sum_y += y, sum_xx += x * x, sum_xy += x * y;
  }
  return (n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
}

void FindWorst(const LightMeasure& measure, const CrosscheckLight& light, CrosscheckNoise& noise) {
  for (const std::size_t i : measure.mask) {
    const glm::dvec3 a = measure.value(light.reference.guides, i), b = measure.value(light.ours, i);
    for (int c = 0; c < 3; ++c) {
      const double difference = std::fabs(b[c] - a[c]);
      if (!(difference > noise.worst)) continue;
      const auto width = static_cast<std::size_t>(light.ours.width());
      noise.worst = difference, noise.worst_reference = a[c], noise.worst_ours = b[c];
      noise.worst_x = static_cast<int>(i % width), noise.worst_y = static_cast<int>(i / width);
    }
  }
}

CrosscheckNoise NoiseOf(const LightMeasure& measure, const std::vector<CrosscheckLight>& light) {
  CrosscheckNoise noise;
  noise.layer = measure.name;
  FindWorst(measure, light.back(), noise);
  for (const CrosscheckLight& count : light) {
    noise.samples.push_back(count.samples);
    noise.nrmse.push_back(Nrmse(measure, SumUp(measure, count)));
  }
  noise.free_of_noise = noise.nrmse.back() < kNoiseFree;
  const bool measurable = std::all_of(noise.nrmse.begin(), noise.nrmse.end(),
                                      [](double value) { return std::isfinite(value) && value > 0.0; });
  if (!noise.free_of_noise && measurable && light.size() > 1) noise.slope = LogLogSlope(noise.samples, noise.nrmse);
  return noise;
}

// Our values that are not finite or negative, over the whole picture and all sample counts.
CrosscheckFigure ImpossibleValues(const std::vector<CrosscheckLight>& light, const LayerSet& there) {
  CrosscheckFigure figure{"lpe", "NaN, inf or < 0", "values", 0.0, 0.0};
  for (const Layer layer : kLightLayers) {
    if (!there.Has(layer)) continue;
    std::size_t impossible = 0;
    for (const CrosscheckLight& count : light) {
      for (int c = 0; c < 3; ++c) {
        for (const float value : count.ours.Plane(layer, c)) impossible += !(std::isfinite(value) && value >= 0.0f);
      }
    }
    if (impossible == 0) continue;
    figure.value += static_cast<double>(impossible);
    figure.note += (figure.note.empty() ? "in " : ", ") + std::string(Info(layer).name);
  }
  return figure;
}

// 1 over the 99th percentile of the reference's brightest channel, which becomes white.
double ExposureFor(const LightMeasure& measure, const CrosscheckLight& light) {
  std::vector<double> values;
  for (const GuideSet* side : {&light.reference.guides, &light.ours}) {
    values.clear();
    for (const std::size_t i : measure.mask) {
      const glm::dvec3 v = measure.value(*side, i);
      const double brightest = std::max({v.x, v.y, v.z});
      if (std::isfinite(brightest) && brightest > 0.0) values.push_back(brightest);
    }
    if (!values.empty()) break;  // ours decides only where the reference is black
  }
  if (values.empty()) return 1.0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return 1.0 / *place;
}

// Black where equal, to orange where ours is brighter, to blue where it is darker, magenta for NaN.
glm::vec3 SignedColor(double difference) {
  if (!std::isfinite(difference)) return {1.0f, 0.0f, 1.0f};
  const auto share = static_cast<float>(std::min(1.0, std::fabs(difference) * 10.0));
  return share * (difference > 0.0 ? glm::vec3(1.0f, 0.45f, 0.03f) : glm::vec3(0.05f, 0.35f, 1.0f));
}

CrosscheckPictures LightPictures(const LightMeasure& measure, const GuideSet& reference, const CrosscheckLight& light) {
  const int width = light.ours.width(), height = light.ours.height();
  const double exposure = ExposureFor(measure, light);
  CrosscheckPictures pictures{measure.name,
                              Picture(width, height),
                              Picture(width, height),
                              Picture(width, height),
                              fmt::format("both exposed by {:+.2f} stops, clipped at white", std::log2(exposure)),
                              "orange: ours is brighter, blue: darker; full colour is a tenth of white",
                              {"#40a0ff", "#000000", "#ffb431"},
                              {"ours darker by a tenth of white", "equal", "brighter by a tenth"}};
  for (std::size_t i = 0; i < light.ours.pixel_count(); ++i) {
    PutColor(pictures.difference, i, glm::vec3(0.02f));
    if (!(reference.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
    PutColor(pictures.reference, i, glm::vec3(exposure * measure.value(light.reference.guides, i)));
    PutColor(pictures.ours, i, glm::vec3(exposure * measure.value(light.ours, i)));
  }
  for (const std::size_t i : measure.mask) {
    const glm::dvec3 d = exposure * (measure.value(light.ours, i) - measure.value(light.reference.guides, i));
    PutColor(pictures.difference, i, SignedColor(Total(d) / 3.0));
  }
  return pictures;
}

Status CheckSizes(const GuideSet& data, const std::vector<CrosscheckLight>& light, const std::string& scene) {
  for (const CrosscheckLight& count : light) {
    for (const GuideSet* side : {&count.reference.guides, &count.ours}) {
      if (side->width() == data.width() && side->height() == data.height()) continue;
      return InputError(
          fmt::format("{}: the light layers of {} samples are {}×{}, the data layers {}×{}: render all at one size",
                      scene, count.samples, side->width(), side->height(), data.width(), data.height()));
    }
  }
  return Ok();
}

}  // namespace

Status CrosscheckLightLayers(const GuideSet& reference, const GuideSet& ours, const std::vector<CrosscheckLight>& light,
                             const CrosscheckOptions& options, CrosscheckReport& report) {
  if (light.empty()) return Ok();
  SCUMBLE_RETURN_IF_ERROR(CheckSizes(reference, light, report.scene));
  report.setup.samples = light.back().samples;
  const LayerSet there = LayersInAll(light);
  for (const Layer layer : kLightLayers) {
    if (!there.Has(layer)) report.skipped.push_back(Info(layer).name);
  }
  const CrosscheckLight& last = light.back();
  report.glossy = last.reference.glossy;
  report.figures.push_back(ImpossibleValues(light, there));
  const std::vector<std::size_t> mask = internal::ErodedMask(reference, ours, options.erode_pixels);
  if (mask.empty()) return Ok();
  for (const LightMeasure& measure : LightMeasures(mask, last, there)) {
    LightSums sums = SumUp(measure, last);
    ForgetRounding(measure, last, sums);
    const std::vector<glm::dvec3> variances = NoiseVariances(measure, light);
    const CrosscheckFigure mean = MeanFigure(measure, sums, variances);
    report.figures.push_back(mean);
    if (measure.mask.empty()) continue;
    if (sums.reference_zero && sums.ours_zero) {
      CrosscheckNoise none;
      none.layer = measure.name, none.no_such_light = true;
      report.noise.push_back(std::move(none));
      continue;
    }
    if (!std::isinf(mean.value)) report.figures.push_back(TileFigure(measure, sums, last, variances));
    report.noise.push_back(NoiseOf(measure, light));
    if (options.make_pictures) report.pictures.push_back(LightPictures(measure, reference, last));
  }
  return Ok();
}

}  // namespace scumble
