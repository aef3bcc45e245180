#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/filter/resample.h"
#include "core/image/check.h"
#include "transfer/exemplar/usable_mask.h"
#include "transfer/tint/colorize.h"
#include "transfer/transfer.h"
#include "transfer/vote/tone_texture_split.h"

namespace scumble {
namespace {

constexpr int kMaxExemplarSize = 16384;
constexpr int kMaxTableResolution = 16384;

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

// This many pixels around a seed must be flat before `variety` may change its source, at the reference height.
constexpr int kFlatReach = 16;

int ScaledRadius(int radius, int reference_height, int output_height) {
  if (reference_height == 0) return radius;
  const double scaled = static_cast<double>(radius) * output_height / reference_height;
  // A style that blends does so in a small preview too: otherwise chunks would show hard edges in previews only.
  return static_cast<int>(std::clamp(std::floor(scaled + 0.5), radius > 0 ? 1.0 : 0.0, 1024.0));
}

Status CheckWeights(const GuideWeights& weights) {
  for (const LayerInfo& info : AllLayers()) {
    const std::string key = "transfer.guide_weights." + std::string(info.name);
    if (!(weights[info.layer] >= 0.0f && std::isfinite(weights[info.layer]))) {
      return UsageError(key + " must be 0 or more, and finite");
    }
    if (weights[info.layer] > 0.0f && !GuideWeights::CanWeigh(info.layer)) {
      return UsageError(key + ": only normals, albedo, luminance, shadow and light paths can have a weight");
    }
  }
  if (weights.Layers().empty()) return UsageError("transfer.guide_weights are all 0: nothing is left to match by");
  return Ok();
}

Status CheckSettings(const TransferSettings& settings) {
  if (!(settings.threshold >= 0.0f)) return UsageError("transfer.threshold must be 0 or more, infinity included");
  if (!(settings.nearest_error >= 0.0 && settings.nearest_error <= 10.0)) {
    return UsageError("transfer.nearest_error must be 0 to 10");
  }
  SCUMBLE_RETURN_IF_ERROR(CheckWeights(settings.guide_weights));
  if (settings.levels < 1 || settings.levels > 16) return UsageError("transfer.levels must be 1 to 16");
  if (!(settings.jitter >= 0.0f && settings.jitter <= 1.0f)) return UsageError("transfer.jitter must be 0 to 1");
  if (settings.blend_radius < 0 || settings.blend_radius > 64) {
    return UsageError("transfer.blend_radius must be 0 to 64");
  }
  if (!(settings.crease >= 0.0 && settings.crease <= 180.0))
    return UsageError("transfer.crease must be 0 to 180 degrees");
  if (!(settings.depth_tolerance >= 0.0 && settings.depth_tolerance <= 1.0)) {
    return UsageError("transfer.depth_tolerance must be 0 to 1");
  }
  if (!(settings.luminance_weight >= 0.0f)) return UsageError("transfer.luminance_weight must be 0 or more");
  if (!(settings.colorize >= 0.0 && settings.colorize <= 1.0)) return UsageError("transfer.colorize must be 0 to 1");
  if (!(settings.variety >= 0.0 && settings.variety <= 90.0))
    return UsageError("transfer.variety must be 0 to 90 degrees");
  if (!(settings.hybrid >= 0.0)) return UsageError("transfer.hybrid must be 0 or more, infinity included");
  if (settings.match_step < 1 || settings.match_step > kMaxMatchStep) {
    return UsageError("transfer.match_step must be 1 to " + std::to_string(kMaxMatchStep));
  }
  if (!(settings.scale > 0.0 && settings.scale <= 64.0))
    return UsageError("transfer.scale must be above 0, at most 64");
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

// The painted scene must be one: the exemplars of a style differ in light and paint only.
Status CheckSameScene(const Exemplar& first, const Exemplar& other) {
  const std::string both = first.name + " and " + other.name;
  if (first.is_sphere != other.is_sphere) {
    return InputError(both +
                      ": one is a sphere and the other has guides of another scene; the exemplars of a style show "
                      "one scene in different light");
  }
  if (first.is_sphere) return Ok();
  const GuideSet &a = *first.guides, &b = *other.guides;
  if (a.width() != b.width() || a.height() != b.height()) {
    return InputError("the guides of " + both + " are " + std::to_string(a.width()) + "×" + std::to_string(a.height()) +
                      " and " + std::to_string(b.width()) + "×" + std::to_string(b.height()) +
                      ": the exemplars of a style show one scene in different light; render them with one camera");
  }
  constexpr float kSame = 1e-3f;  // half floats and other renderers round
  for (std::size_t i = 0; i < a.pixel_count(); ++i) {
    const bool covered = a.Plane(Layer::kCoverage)[i] > 0.0f;
    bool same = covered == (b.Plane(Layer::kCoverage)[i] > 0.0f);
    if (same && covered) {
      const glm::vec3 d = glm::abs(a.Vec3(Layer::kNormal, i) - b.Vec3(Layer::kNormal, i));
      same = d.x <= kSame && d.y <= kSame && d.z <= kSame;
    }
    if (same) continue;
    const auto width = static_cast<std::size_t>(a.width());
    return InputError("the guides of " + both + " differ at (" + std::to_string(i % width) + ", " +
                      std::to_string(i / width) +
                      "): the exemplars of a style show one scene in different light; move lights only");
  }
  return Ok();
}

Status CheckExemplar(const Exemplar& exemplar, double rim) {
  const auto size = [](int width, int height) { return std::to_string(width) + "×" + std::to_string(height); };
  const Picture& picture = exemplar.picture;
  const std::string is = exemplar.name + " is " + size(picture.width, picture.height);
  if (exemplar.luminance && !(*exemplar.luminance >= 0.0 && std::isfinite(*exemplar.luminance))) {
    return UsageError(exemplar.name + ": exemplar.luminance must be 0 or more");
  }
  if (picture.empty() || (exemplar.is_sphere && picture.width != picture.height)) {
    return InputError(is + ": an exemplar is a square that its sphere fills, or has guides that say what it shows");
  }
  if (std::max(picture.width, picture.height) > kMaxExemplarSize) {
    return InputError(is + ": exemplars have at most " + std::to_string(kMaxExemplarSize) +
                      " pixels a side; shrink it");
  }
  // Of a few pixels the default may be more.
  const double most_rim = std::max(TransferSettings().rim, 0.25 * picture.width);
  if (exemplar.is_sphere && rim > most_rim) {
    char text[120];
    std::snprintf(text, sizeof text,
                  ": transfer.rim = %g leaves too little of the sphere: expected at most %g, half of "
                  "its radius",
                  rim, most_rim);
    return InputError(is + text);
  }
  SCUMBLE_CHECK(exemplar.is_sphere || exemplar.guides);
  if (!exemplar.guides) return Ok();
  const GuideSet& guides = *exemplar.guides;
  if (guides.width() != picture.width || guides.height() != picture.height) {
    return InputError(is + ", its guides are " + size(guides.width(), guides.height()) + ": both must have one size");
  }
  return guides.Validate("the guides of " + exemplar.name);
}

Status CheckExemplars(const Style& style) {
  if (style.exemplars.empty() || style.exemplars.size() > std::size_t(kMaxExemplars)) {
    return InputError("style " + style.name + " has " + std::to_string(style.exemplars.size()) +
                      " exemplars: a style has one, or up to " + std::to_string(kMaxExemplars) +
                      " for different light");
  }
  for (const Exemplar& exemplar : style.exemplars) {
    SCUMBLE_RETURN_IF_ERROR(CheckExemplar(exemplar, style.transfer.rim));
    SCUMBLE_RETURN_IF_ERROR(CheckSameScene(style.exemplars.front(), exemplar));
  }
  return Ok();
}

Status CheckNotCancelled(const PrepareOptions& options) {
  return options.is_cancelled && options.is_cancelled() ? Status(CancelledError()) : Ok();
}

Expected<std::shared_ptr<const PreparedExemplar>> PrepareExemplar(const Style& style, int output_height,
                                                                  const PrepareOptions& options) {
  const TransferSettings& settings = style.transfer;
  const Exemplar& first = style.exemplars.front();
  const auto scaled = [&](int side) {
    return ScaledSize(side, settings.scale, settings.reference_height, output_height);
  };
  const int longer = std::max(first.picture.width, first.picture.height);
  if (scaled(longer) > kMaxExemplarSize) {
    return UsageError(first.name + " would be resized from " + std::to_string(longer) + " to " +
                      std::to_string(scaled(longer)) + " pixels by transfer.scale and the output's height: at most " +
                      std::to_string(kMaxExemplarSize) + " are possible; lower transfer.scale");
  }
  std::vector<const Picture*> pictures;
  for (const Exemplar& exemplar : style.exemplars) pictures.push_back(&exemplar.picture);
  std::shared_ptr<PreparedExemplar> prepared;
  if (first.is_sphere) {
    prepared = std::make_shared<PreparedExemplar>(pictures, settings.rim, scaled(longer));
  } else {
    const int width = scaled(first.picture.width), height = scaled(first.picture.height);
    SCUMBLE_ASSIGN(PreparedExemplar scene,
                   PreparedExemplar::OfScene(pictures, *first.guides, settings.rim, width, height, first.name));
    prepared = std::make_shared<PreparedExemplar>(std::move(scene));
  }
  SCUMBLE_RETURN_IF_ERROR(CheckNotCancelled(options));
  SCUMBLE_RETURN_IF_ERROR(
      prepared->SearchBy(settings.nearest, options.table_resolution, options.cache, settings.nearest_error));
  return std::shared_ptr<const PreparedExemplar>(std::move(prepared));
}

Expected<PreparedStyle> PrepareInArena(const Style& style, int output_height, const PrepareOptions& options) {
  const TransferSettings& settings = style.transfer;
  SCUMBLE_RETURN_IF_ERROR(CheckSettings(settings));
  if (options.table_resolution < 1 || options.table_resolution > kMaxTableResolution) {
    return UsageError("a look-up table has 1 to " + std::to_string(kMaxTableResolution) + " cells a side");
  }
  SCUMBLE_RETURN_IF_ERROR(CheckExemplars(style));
  std::vector<double> luminances;
  for (const Exemplar& exemplar : style.exemplars) {
    SCUMBLE_RETURN_IF_ERROR(CheckNotCancelled(options));
    luminances.push_back(LuminanceOf(exemplar, settings.rim));
  }
  PreparedStyle prepared;
  prepared.settings = settings;
  prepared.required = TransferLayers(style);
  prepared.output_height = output_height;
  prepared.levels = ScaledLevels(settings.levels, settings.reference_height, output_height);
  prepared.blend_radius = ScaledRadius(settings.blend_radius, settings.reference_height, output_height);
  // Here each pixel is a chunk of its own, and votes reach over one (vote.h).
  if (settings.method == Method::kLitSphere) prepared.blend_radius = std::min(prepared.blend_radius, 1);
  prepared.flat_reach = ScaledSize(kFlatReach, 1.0, settings.reference_height, output_height);
  SCUMBLE_ASSIGN(prepared.exemplar, PrepareExemplar(style, output_height, options));
  SCUMBLE_RETURN_IF_ERROR(CheckNotCancelled(options));
  if (!settings.guide_weights.ArePlain()) {
    const double height_ratio =
        settings.reference_height > 0 ? static_cast<double>(output_height) / settings.reference_height : 1.0;
    SCUMBLE_ASSIGN(GuideSpace space, GuideSpace::Build(settings.guide_weights, style.exemplars, prepared.exemplar,
                                                       settings.nearest_error, height_ratio));
    prepared.space = std::make_shared<GuideSpace>(std::move(space));
  }
  prepared.illumination = Illumination(luminances, settings.luminance_weight, settings.luminance_error);
  if (settings.colorize > 0.0 && settings.colorize_mode == ColorizeMode::kOklab) {
    prepared.reference_lightness = internal::ReferenceLightness(*prepared.exemplar);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckNotCancelled(options));
  if (settings.hybrid > 0.0) {
    // In pixels of the file; the exemplar was resized by scale and height, and the base layer with it.
    const Picture& file = style.exemplars.front().picture;
    const double ratio = static_cast<double>(prepared.exemplar->size()) / std::max(file.width, file.height);
    prepared.base_layers =
        std::make_shared<PreparedExemplar>(MakeBaseLayers(*prepared.exemplar, settings.hybrid * ratio));
  }
  SCUMBLE_RETURN_IF_ERROR(CheckNotCancelled(options));
  if (settings.shadow == ShadowMode::kPaint) {
    std::vector<const Picture*> pictures;
    for (const Exemplar& exemplar : style.exemplars) pictures.push_back(&exemplar.picture);
    prepared.shadow.emplace(prepared.exemplar, pictures);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckNotCancelled(options));
  if (settings.edge == EdgeMode::kExemplar) {
    if (!style.exemplars.front().is_sphere) {
      return UsageError("transfer.edge = \"exemplar\" continues the painted edge of a sphere; " +
                        style.exemplars.front().name + " is another scene: set it to \"exact\"");
    }
    const int size = prepared.exemplar->size();
    for (const Exemplar& exemplar : style.exemplars) prepared.rims.emplace_back(exemplar.picture, size);
    const auto has_edge = [](const RimPaint& rim) { return rim.HasEdge(); };
    if (!std::all_of(prepared.rims.begin(), prepared.rims.end(), has_edge)) prepared.rims.clear();
  }
  SCUMBLE_RETURN_IF_ERROR(CheckNotCancelled(options));
  prepared.paper.color = style.paper.color;
  if (style.paper.picture) {
    prepared.paper.picture = ScaledPaper(*style.paper.picture, settings.reference_height, output_height);
  }
  return prepared;
}

}  // namespace

double LuminanceOf(const Exemplar& exemplar, double rim) {
  if (exemplar.luminance) return *exemplar.luminance;
  if (!exemplar.guides) return MeasuredLuminance(exemplar.picture, rim);
  const std::vector<std::uint8_t> mask = internal::UsableMask(*exemplar.guides, rim);
  if (!exemplar.guides->Has(Layer::kLuminance)) return MeasuredLuminance(exemplar.picture, mask);
  const auto luminance = exemplar.guides->Plane(Layer::kLuminance);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i]) sum += std::max(0.0, static_cast<double>(luminance[i])), count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

Expected<PreparedStyle> Prepare(const Style& style, int output_height, const PrepareOptions& options) {
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return PrepareInArena(style, output_height, options); });
}

}  // namespace scumble
