// Compares two files channel by channel: the differences, their places, and whether they exceed thresholds.
//
// The options are those of OpenImageIO's idiff with the meaning that its documentation gives them. Where idiff 2.4
// deviates we follow the documentation: every threshold is tested, whether or not another one was exceeded,
// channels are matched by name, differing sizes are an error, and NaN is a difference.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/image/channel_image.h"
#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

// A value differs if |a − b| > absolute and |a − b| / ((|a| + |b|) / 2) > relative. A pixel differs if any of its
// values does. The picture differs if more than `percent` of its pixels do, or if any value's |a − b| > hard.
struct DifferenceThresholds {
  double absolute = 1e-6;
  double relative = 0.0;
  double percent = 0.0;  // 0 … 100
  double hard = std::numeric_limits<double>::infinity();
};

struct CompareOptions {
  DifferenceThresholds fail;        // -fail -failrelative -failpercent -hardfail
  DifferenceThresholds warn;        // -warn -warnrelative -warnpercent -hardwarn
  std::size_t allow_failures = 0;   // -allowfailures: that many pixels may fail by any amount, `hard` included
  std::vector<std::string> layers;  // compare these alone ("normal", "lpe.LDE"); empty for all
};

enum class Verdict {
  kEqual,  // within the thresholds
  kWarn,
  kFail,
};
const char* VerdictName(Verdict verdict);  // "equal", "warn", "fail"

// The largest difference. A NaN on either side, or an infinity that the other side does not equal, counts as infinite.
// Among equal differences the first counts, in the order of channels, then rows.
struct WorstValue {
  std::string channel;
  int x = 0;  // in the whole picture, so that cropped renders name the pixel that a viewer shows
  int y = 0;
  float a = 0.0f;
  float b = 0.0f;
  double difference = 0.0;
};

// Statistics of |a − b| over one or more channels. The mean, RMS and PSNR leave out the incomparable values, which
// `incomparable` counts: those with a NaN on either or both sides, or an infinity that the other does not equal.
struct DifferenceStats {
  std::size_t values = 0;
  std::size_t different = 0;  // a != b, at any distance
  std::size_t incomparable = 0;
  double mean = 0.0;
  double rms = 0.0;
  double psnr_db = std::numeric_limits<double>::infinity();  // 20·log10(peak / rms)
  double peak = 1.0;                                         // the largest finite |a| or |b|, at least 1
  std::optional<WorstValue> worst;                           // empty where all values are equal
};

// Angles between the normals of two files, over the pixels where both are unit within 0.002. Percentiles are by nearest
// rank: the smallest angle that is at least as large as that share of them.
struct AngularStats {
  std::size_t pixels = 0;
  std::size_t unmatched = 0;  // pixels where one of the two is unit and the other is not
  double mean_degrees = 0.0;
  double p50_degrees = 0.0;
  double p99_degrees = 0.0;
  double p99_9_degrees = 0.0;
  double max_degrees = 0.0;
  int worst_x = 0;
  int worst_y = 0;
};

struct ChannelReport {
  std::string name;
  DifferenceStats stats;
};

// The number of pixels beyond each threshold.
struct PixelCounts {
  std::size_t over_warn = 0;
  std::size_t over_fail = 0;
  std::size_t over_hardwarn = 0;
  std::size_t over_hardfail = 0;
};

struct LayerReport {
  std::string name;
  std::vector<ChannelReport> channels;
  DifferenceStats stats;
  PixelCounts pixels;
  std::optional<AngularStats> angles;  // for layers of normals
};

struct CompareReport {
  std::string name_a;
  std::string name_b;
  int width = 0;
  int height = 0;
  CompareOptions options;
  std::vector<LayerReport> layers;  // in the order of the first file
  DifferenceStats stats;            // of all channels together
  PixelCounts pixels;
  std::vector<std::string> only_in_a;  // channels without a partner: they make the verdict kFail
  std::vector<std::string> only_in_b;
  Verdict verdict = Verdict::kEqual;
  std::vector<std::string> reasons;  // why the verdict is not kEqual, one sentence each
};

// The layer of a channel: the text before the last dot ("ViewLayer.Normal" of "ViewLayer.Normal.X"). Without a dot R, G
// and B make up "color", and any other channel is a layer of its own.
std::string LayerOfChannel(const std::string& channel);

// Compares all channels that both have under the same name. Errors: sizes or positions differ, no name in common, a
// layer asked for that neither has, thresholds that are negative or NaN, a percentage above 100. O(values).
Expected<CompareReport> Compare(const ChannelImage& a, const ChannelImage& b, const CompareOptions& options = {});

// A guide set as channels under their file names, to compare guides in memory. `name` stands for it in reports.
ChannelImage ChannelsOf(const GuideSet& guides, const std::string& name);

// The report as JSON, two spaces of indentation, ending in a newline. NaN and infinities, which JSON lacks, are the
// texts "nan", "inf" and "-inf". Keys are those of the structs above.
std::string CompareToJson(const CompareReport& report);

// The report as a table for a terminal, verdict last.
std::string CompareToText(const CompareReport& report);

}  // namespace scumble
