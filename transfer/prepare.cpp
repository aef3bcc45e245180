#include <algorithm>
#include <cmath>

#include "transfer/colorize.h"
#include "transfer/resample.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr int kMaxExemplarSize = 16384;

// Lengths follow the height; the seed grids are powers of two, so levels follow in whole steps, to the nearest octave.
// In integers: height / reference ≥ √2 is one level more, ≥ 2√2 two, < 1/√2 one less.
int ScaledLevels(int levels, int reference_height, int output_height) {
  if (reference_height == 0) return levels;
  const std::int64_t reference = reference_height, output = output_height;
  std::int64_t reference_squared = reference * reference, output_squared = output * output;
  for (; output_squared >= 2 * reference_squared && levels < 16; reference_squared *= 4) ++levels;
  for (; 2 * output_squared < reference_squared && levels > 1; output_squared *= 4) --levels;
  return levels;
}

int ScaledRadius(int radius, int reference_height, int output_height) {
  if (reference_height == 0) return radius;
  const double scaled = static_cast<double>(radius) * output_height / reference_height;
  // A style that blends goes on doing so in a small preview: without it patches would show hard edges there alone.
  return static_cast<int>(std::clamp(std::floor(scaled + 0.5), radius > 0 ? 1.0 : 0.0, 1024.0));
}

Status CheckSettings(const TransferSettings& settings) {
  if (!(settings.threshold >= 0.0f)) return UsageError("transfer.threshold must be 0 or more, infinity included");
  if (settings.levels < 1 || settings.levels > 16) return UsageError("transfer.levels must be 1 to 16");
  if (!(settings.jitter >= 0.0f && settings.jitter <= 1.0f)) return UsageError("transfer.jitter must be 0 to 1");
  if (settings.blend_radius < 0 || settings.blend_radius > 64) {
    return UsageError("transfer.blend_radius must be 0 to 64");
  }
  if (!(settings.crease >= 0.0 && settings.crease <= 180.0)) return UsageError("transfer.crease must be 0 to 180 degrees");
  if (!(settings.depth_tolerance >= 0.0 && settings.depth_tolerance <= 1.0)) {
    return UsageError("transfer.depth_tolerance must be 0 to 1");
  }
  if (!(settings.luminance_weight >= 0.0f)) return UsageError("transfer.luminance_weight must be 0 or more");
  if (!(settings.colorize >= 0.0 && settings.colorize <= 1.0)) return UsageError("transfer.colorize must be 0 to 1");
  if (!(settings.variety >= 0.0 && settings.variety <= 90.0)) return UsageError("transfer.variety must be 0 to 90 degrees");
  if (!(settings.scale > 0.0 && settings.scale <= 64.0)) return UsageError("transfer.scale must be above 0, at most 64");
  if (!(settings.rim >= 0.0 && std::isfinite(settings.rim))) return UsageError("transfer.rim must be 0 or more");
  if (settings.reference_height < 0) return UsageError("transfer.reference_height must be 0 or more");
  return Ok();
}

Picture ScaledPaper(const Picture& paper, int reference_height, int output_height) {
  const auto scaled = [&](int side) {
    return std::min(kMaxExemplarSize, ScaledSize(side, 1.0, reference_height, output_height));
  };
  return Resample(paper, scaled(paper.width), scaled(paper.height));
}

Status CheckExemplars(const Style& style) {
  if (style.exemplars.empty() || style.exemplars.size() > std::size_t(kMaxExemplars)) {
    return InputError("style " + style.name + " has " + std::to_string(style.exemplars.size()) +
                      " exemplars: a style has one, or up to " + std::to_string(kMaxExemplars) +
                      " for different light");
  }
  for (const Exemplar& exemplar : style.exemplars) {
    if (exemplar.picture.empty() || exemplar.picture.width != exemplar.picture.height) {
      return InputError(exemplar.name + " is " + std::to_string(exemplar.picture.width) + "×" +
                        std::to_string(exemplar.picture.height) + ": an exemplar is a square that its sphere fills");
    }
    if (exemplar.luminance && !(*exemplar.luminance >= 0.0 && std::isfinite(*exemplar.luminance))) {
      return UsageError(exemplar.name + ": exemplar.luminance must be 0 or more");
    }
  }
  return Ok();
}

}  // namespace

Expected<PreparedStyle> Prepare(const Style& style, int output_height) {
  const TransferSettings& settings = style.transfer;
  SCUMBLE_RETURN_IF_ERROR(CheckSettings(settings));
  SCUMBLE_RETURN_IF_ERROR(CheckExemplars(style));
  const Exemplar& first = style.exemplars.front();
  const int size = ScaledSize(first.picture.width, settings.scale, settings.reference_height, output_height);
  if (size > kMaxExemplarSize) {
    return UsageError(first.name + " would be resized from " + std::to_string(first.picture.width) + " to " +
                      std::to_string(size) + " pixels by transfer.scale and the output's height: at most " +
                      std::to_string(kMaxExemplarSize) + " are possible; lower transfer.scale");
  }
  std::vector<const Picture*> pictures;
  std::vector<double> luminances;
  for (const Exemplar& exemplar : style.exemplars) {
    pictures.push_back(&exemplar.picture);
    luminances.push_back(exemplar.luminance ? *exemplar.luminance : MeasuredLuminance(exemplar.picture, settings.rim));
  }
  PreparedStyle prepared;
  prepared.settings = settings;
  prepared.required = RequiredLayers(style);
  prepared.output_height = output_height;
  prepared.levels = ScaledLevels(settings.levels, settings.reference_height, output_height);
  prepared.blend_radius = ScaledRadius(settings.blend_radius, settings.reference_height, output_height);
  prepared.exemplar = std::make_shared<PreparedExemplar>(pictures, settings.rim, size);
  prepared.illumination = Illumination(luminances, settings.luminance_weight, settings.luminance_error);
  if (settings.colorize > 0.0 && settings.colorize_mode == ColorizeMode::kOklab) {
    for (int k = 0; k < prepared.exemplar->count(); ++k) {
      prepared.mean_lightness.push_back(internal::MeanLightness(*prepared.exemplar, k));
    }
  }
  if (settings.shadow == ShadowMode::kPaint) prepared.dark = DarkestPlace(*prepared.exemplar);
  if (settings.edge == EdgeMode::kExemplar) {
    for (const Exemplar& exemplar : style.exemplars) prepared.rims.emplace_back(exemplar.picture, style.paper, size);
    const auto has_edge = [](const RimPaint& rim) { return rim.HasEdge(); };
    if (!std::all_of(prepared.rims.begin(), prepared.rims.end(), has_edge)) prepared.rims.clear();
  }
  prepared.paper = style.paper;
  if (style.paper.picture) {
    prepared.paper.picture = ScaledPaper(*style.paper.picture, settings.reference_height, output_height);
  }
  return prepared;
}

std::int64_t JitterStep(double jitter_fps, std::int64_t frame, std::int64_t fps_numerator,
                        std::int64_t fps_denominator) {
  if (jitter_fps < 0.0) return frame;
  // 128 bits: frame numbers that carry a date, times a rate in thousandths, leave 64 behind.
  __extension__ using Int128 = __int128;
  const Int128 numerator = static_cast<Int128>(frame) * std::llround(jitter_fps * 1000.0) * fps_denominator;
  const Int128 denominator = static_cast<Int128>(fps_numerator) * 1000;
  const Int128 quotient = numerator / denominator;
  return static_cast<std::int64_t>(numerator % denominator < 0 ? quotient - 1 : quotient);
}

}  // namespace scumble
