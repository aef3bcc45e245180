#include "measure/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/image/check.h"
#include "core/image/layers.h"

namespace scumble {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum PixelFlag : std::uint8_t { kOverWarn = 1, kOverFail = 2, kOverHardWarn = 4, kOverHardFail = 8 };

// Sums from which DifferenceStats follow; sums of several channels merge in the order of the channels.
struct Sums {
  std::size_t values = 0;
  std::size_t different = 0;
  std::size_t incomparable = 0;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  double peak = 1.0;
  std::optional<WorstValue> worst;

  void Merge(const Sums& other) {
    values += other.values;
    different += other.different;
    incomparable += other.incomparable;
    sum += other.sum;
    sum_of_squares += other.sum_of_squares;
    peak = std::max(peak, other.peak);
    if (other.worst && (!worst || other.worst->difference > worst->difference)) worst = other.worst;
  }

  DifferenceStats Stats() const {
    DifferenceStats stats;
    stats.values = values;
    stats.different = different;
    stats.incomparable = incomparable;
    stats.peak = peak;
    stats.worst = worst;
    const std::size_t comparable = values - incomparable;
    if (comparable == 0) return stats;
    stats.mean = sum / static_cast<double>(comparable);
    stats.rms = std::sqrt(sum_of_squares / static_cast<double>(comparable));
    if (stats.rms > 0.0) stats.psnr_db = 20.0 * std::log10(peak / stats.rms);
    return stats;
  }
};

// |a − b|, infinite where the two cannot be compared. Equal infinities are equal; NaN equals nothing.
double Difference(float a, float b) {
  if (a == b) return 0.0;
  const double difference = std::abs(static_cast<double>(a) - static_cast<double>(b));
  return std::isnan(difference) ? kInfinity : difference;
}

bool Exceeds(const DifferenceThresholds& thresholds, double difference, float a, float b) {
  if (!(difference > thresholds.absolute)) return false;
  if (difference == kInfinity) return true;
  const double mean = (std::abs(static_cast<double>(a)) + std::abs(static_cast<double>(b))) / 2.0;
  return difference > thresholds.relative * mean;
}

std::uint8_t FlagsOf(const CompareOptions& options, double difference, float a, float b) {
  int flags = 0;
  if (Exceeds(options.warn, difference, a, b)) flags |= kOverWarn;
  if (Exceeds(options.fail, difference, a, b)) flags |= kOverFail;
  if (difference > options.warn.hard) flags |= kOverHardWarn;
  if (difference > options.fail.hard) flags |= kOverHardFail;
  return static_cast<std::uint8_t>(flags);
}

// One channel of both files; the flags of its pixels are added to `flags`.
Sums CompareChannel(const ChannelImage& a, const ChannelImage& b, const std::string& channel,
                    const CompareOptions& options, std::span<std::uint8_t> flags) {
  const std::vector<float>& plane_a = *a.Find(channel);
  const std::vector<float>& plane_b = *b.Find(channel);
  Sums sums;
  sums.values = plane_a.size();
  std::size_t worst = 0;
  double worst_difference = 0.0;
  for (std::size_t i = 0; i < plane_a.size(); ++i) {
    const float value_a = plane_a[i];
    const float value_b = plane_b[i];
    if (std::isfinite(value_a)) sums.peak = std::max(sums.peak, std::abs(static_cast<double>(value_a)));
    if (std::isfinite(value_b)) sums.peak = std::max(sums.peak, std::abs(static_cast<double>(value_b)));
    const double difference = Difference(value_a, value_b);
    if (difference == 0.0) continue;
    ++sums.different;
    flags[i] |= FlagsOf(options, difference, value_a, value_b);
    if (difference > worst_difference) {
      worst = i;
      worst_difference = difference;
    }
    if (difference == kInfinity) {
      ++sums.incomparable;
    } else {
      sums.sum += difference;
      sums.sum_of_squares += difference * difference;
    }
  }
  if (sums.different > 0) {
    const int x = a.x + static_cast<int>(worst % static_cast<std::size_t>(a.width));
    const int y = a.y + static_cast<int>(worst / static_cast<std::size_t>(a.width));
    sums.worst = WorstValue{channel, x, y, plane_a[worst], plane_b[worst], worst_difference};
  }
  return sums;
}

PixelCounts CountPixels(std::span<const std::uint8_t> flags) {
  PixelCounts counts;
  for (const std::uint8_t flag : flags) {
    counts.over_warn += (flag & kOverWarn) != 0;
    counts.over_fail += (flag & kOverFail) != 0;
    counts.over_hardwarn += (flag & kOverHardWarn) != 0;
    counts.over_hardfail += (flag & kOverHardFail) != 0;
  }
  return counts;
}

// The three planes of a layer of normals, X, Y, Z; empty for other layers.
std::optional<std::array<std::string, 3>> NormalChannels(const std::vector<std::string>& channels) {
  std::array<std::string, 3> found;
  for (const std::string& channel : channels) {
    const auto meaning = ParseChannelName(channel);
    if (meaning && meaning->layer == Layer::kNormal) found[static_cast<std::size_t>(meaning->component)] = channel;
  }
  if (found[0].empty() || found[1].empty() || found[2].empty()) return std::nullopt;
  return found;
}

double Percentile(std::vector<double>& values, double share) {
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const std::size_t index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

AngularStats CompareNormals(const ChannelImage& a, const ChannelImage& b, const std::array<std::string, 3>& channels) {
  const auto is_unit = [](const glm::dvec3& normal) { return std::abs(glm::length(normal) - 1.0) <= 0.002; };
  std::array<const float*, 3> planes_a;
  std::array<const float*, 3> planes_b;
  for (std::size_t c = 0; c < 3; ++c) {
    planes_a[c] = a.Find(channels[c])->data();
    planes_b[c] = b.Find(channels[c])->data();
  }
  AngularStats stats;
  std::vector<double> angles;
  double sum = 0.0;
  stats.max_degrees = -1.0;
  for (std::size_t i = 0; i < a.pixel_count(); ++i) {
    const glm::dvec3 normal_a(planes_a[0][i], planes_a[1][i], planes_a[2][i]);
    const glm::dvec3 normal_b(planes_b[0][i], planes_b[1][i], planes_b[2][i]);
    const bool unit_a = is_unit(normal_a);
    const bool unit_b = is_unit(normal_b);
    if (unit_a != unit_b) ++stats.unmatched;
    if (!unit_a || !unit_b) continue;
    // The arc cosine of the dot product would lose every angle below 0.02 degrees to rounding.
    const double sine = glm::length(glm::cross(normal_a, normal_b));
    const double angle = glm::degrees(std::atan2(sine, glm::dot(normal_a, normal_b)));
    angles.push_back(angle);
    sum += angle;
    if (angle > stats.max_degrees) {
      stats.max_degrees = angle;
      stats.worst_x = a.x + static_cast<int>(i % static_cast<std::size_t>(a.width));
      stats.worst_y = a.y + static_cast<int>(i / static_cast<std::size_t>(a.width));
    }
  }
  stats.pixels = angles.size();
  stats.max_degrees = std::max(stats.max_degrees, 0.0);
  if (angles.empty()) return stats;
  stats.mean_degrees = sum / static_cast<double>(angles.size());
  stats.p50_degrees = Percentile(angles, 0.50);
  stats.p99_degrees = Percentile(angles, 0.99);
  stats.p99_9_degrees = Percentile(angles, 0.999);
  return stats;
}

std::string SizeText(const ChannelImage& image) {
  std::string text = image.name + " is " + std::to_string(image.width) + "×" + std::to_string(image.height);
  if (image.x != 0 || image.y != 0) text += " at (" + std::to_string(image.x) + ", " + std::to_string(image.y) + ")";
  return text;
}

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

Status CheckThresholds(const DifferenceThresholds& thresholds, const std::string& set) {
  const auto refuse = [&](const std::string& key, double value, const std::string& expected) {
    return UsageError("the " + set + " threshold '" + key + "' is " + std::to_string(value) + ": expected " + expected);
  };
  if (!(thresholds.absolute >= 0.0)) return refuse("absolute", thresholds.absolute, "0 or more");
  if (!(thresholds.relative >= 0.0)) return refuse("relative", thresholds.relative, "0 or more");
  if (!(thresholds.hard >= 0.0)) return refuse("hard", thresholds.hard, "0 or more");
  if (!(thresholds.percent >= 0.0 && thresholds.percent <= 100.0)) {
    return refuse("percent", thresholds.percent, "0 to 100");
  }
  return Ok();
}

// The layers of a file in its order, each once.
std::vector<std::string> LayersOf(const ChannelImage& image) {
  std::vector<std::string> layers;
  for (const std::string& channel : image.names) {
    const std::string layer = LayerOfChannel(channel);
    if (std::find(layers.begin(), layers.end(), layer) == layers.end()) layers.push_back(layer);
  }
  return layers;
}

Status CheckInputs(const ChannelImage& a, const ChannelImage& b, const CompareOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckThresholds(options.fail, "fail"));
  SCUMBLE_RETURN_IF_ERROR(CheckThresholds(options.warn, "warn"));
  for (const ChannelImage* image : {&a, &b}) {
    SCUMBLE_CHECK_EQ(image->names.size(), image->planes.size());
    for (const auto& plane : image->planes) SCUMBLE_CHECK_EQ(plane.size(), image->pixel_count());
  }
  if (a.width != b.width || a.height != b.height || a.x != b.x || a.y != b.y) {
    return InputError(SizeText(a) + ", " + SizeText(b) + ": render both at one size and position to compare them");
  }
  const std::vector<std::string> layers_a = LayersOf(a);
  const std::vector<std::string> layers_b = LayersOf(b);
  for (const std::string& wanted : options.layers) {
    const bool known = std::find(layers_a.begin(), layers_a.end(), wanted) != layers_a.end() ||
                       std::find(layers_b.begin(), layers_b.end(), wanted) != layers_b.end();
    if (!known) {
      return InputError("neither " + a.name + " nor " + b.name + " has a layer '" + wanted + "': the first has " +
                        Joined(layers_a) + "; the second has " + Joined(layers_b));
    }
  }
  return Ok();
}

// Whether `count` of `total` pixels beyond a threshold make the picture differ.
bool TooMany(const DifferenceThresholds& thresholds, std::size_t count, std::size_t total, std::size_t allowed) {
  return count > allowed && static_cast<double>(count) > thresholds.percent / 100.0 * static_cast<double>(total);
}

void MeasureError(CompareReport& report) {
  const CompareOptions& options = report.options;
  const std::size_t total = std::size_t(report.width) * report.height;
  const auto reason = [&](Verdict verdict, std::string text) {
    report.verdict = std::max(report.verdict, verdict);
    report.reasons.push_back(std::move(text));
  };
  const auto over = [&](std::size_t count, const char* option, const std::string& allowed) {
    return std::to_string(count) + (count == 1 ? " pixel is over '" : " pixels are over '") + option + "', " + allowed;
  };
  const auto share = [](double percent) {
    return percent > 0.0 ? "allowed " + std::to_string(percent) + " %" : std::string("allowed none");
  };
  const std::size_t allow = options.allow_failures;
  const std::string failures_allowed = allow > 0 ? "allowed " + std::to_string(allow) : share(options.fail.percent);
  if (!report.only_in_a.empty()) reason(Verdict::kFail, "only in " + report.name_a + ": " + Joined(report.only_in_a));
  if (!report.only_in_b.empty()) reason(Verdict::kFail, "only in " + report.name_b + ": " + Joined(report.only_in_b));
  const PixelCounts& counts = report.pixels;
  if (TooMany(options.fail, counts.over_fail, total, allow)) {
    reason(Verdict::kFail, over(counts.over_fail, "fail", failures_allowed));
  }
  if (counts.over_hardfail > allow) {
    reason(Verdict::kFail,
           over(counts.over_hardfail, "hardfail", allow > 0 ? "allowed " + std::to_string(allow) : share(0.0)));
  }
  if (TooMany(options.warn, counts.over_warn, total, 0)) {
    reason(Verdict::kWarn, over(counts.over_warn, "warn", share(options.warn.percent)));
  }
  if (counts.over_hardwarn > 0) reason(Verdict::kWarn, over(counts.over_hardwarn, "hardwarn", share(0.0)));
}

}  // namespace

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kEqual:
      return "equal";
    case Verdict::kWarn:
      return "warn";
    case Verdict::kFail:
      return "fail";
  }
  return "fail";
}

std::string LayerOfChannel(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  if (dot != std::string::npos) return channel.substr(0, dot);
  return channel == "R" || channel == "G" || channel == "B" ? "color" : channel;
}

Expected<CompareReport> Compare(const ChannelImage& a, const ChannelImage& b, const CompareOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckInputs(a, b, options));
  const auto wanted = [&](const std::string& layer) {
    return options.layers.empty() ||
           std::find(options.layers.begin(), options.layers.end(), layer) != options.layers.end();
  };
  CompareReport report;
  report.name_a = a.name;
  report.name_b = b.name;
  report.width = a.width;
  report.height = a.height;
  report.options = options;
  for (const std::string& channel : b.names) {
    if (wanted(LayerOfChannel(channel)) && !a.Find(channel)) report.only_in_b.push_back(channel);
  }
  Sums all;
  std::vector<std::uint8_t> all_flags(a.pixel_count(), 0);
  for (const std::string& layer_name : LayersOf(a)) {
    if (!wanted(layer_name)) continue;
    LayerReport layer;
    layer.name = layer_name;
    Sums layer_sums;
    std::vector<std::uint8_t> flags(a.pixel_count(), 0);
    std::vector<std::string> shared;
    for (const std::string& channel : a.names) {
      if (LayerOfChannel(channel) != layer_name) continue;
      if (!b.Find(channel)) {
        report.only_in_a.push_back(channel);
        continue;
      }
      const Sums sums = CompareChannel(a, b, channel, options, flags);
      layer.channels.push_back({channel, sums.Stats()});
      layer_sums.Merge(sums);
      shared.push_back(channel);
    }
    if (shared.empty()) continue;
    layer.stats = layer_sums.Stats();
    layer.pixels = CountPixels(flags);
    if (const auto normals = NormalChannels(shared)) layer.angles = CompareNormals(a, b, *normals);
    all.Merge(layer_sums);
    for (std::size_t i = 0; i < flags.size(); ++i) all_flags[i] |= flags[i];
    report.layers.push_back(std::move(layer));
  }
  if (report.layers.empty()) {
    return InputError(a.name + " and " + b.name + " have no channel in common: the first has " + Joined(a.names) +
                      "; the second has " + Joined(b.names));
  }
  report.stats = all.Stats();
  report.pixels = CountPixels(all_flags);
  MeasureError(report);
  return report;
}

ChannelImage ChannelsOf(const GuideSet& guides, const std::string& name) {
  ChannelImage image;
  image.name = name;
  image.width = guides.width();
  image.height = guides.height();
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto plane = guides.Plane(info.layer, c);
      image.names.emplace_back(info.channels[static_cast<std::size_t>(c)]);
      image.planes.emplace_back(plane.begin(), plane.end());
    }
  }
  return image;
}

}  // namespace scumble
