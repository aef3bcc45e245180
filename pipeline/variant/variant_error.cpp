#include "pipeline/variant/variant_error.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>

#include "core/image/exact_math.h"
#include "measure/coherence.h"
#include "measure/flat_surfaces.h"
#include "measure/flip.h"
#include "measure/repetition.h"

namespace scumble {
namespace {

// What light counts, at most, in the choice between lighting conditions: beyond, a wrong one is beyond redemption
// anyway.
constexpr float kMostOfLight = 4.0f;

std::size_t PixelsOf(const PreparedExemplar& exemplar) { return std::size_t(exemplar.width()) * exemplar.height(); }

Picture NormalsAsPicture(const GuideSet& guides) {
  Picture picture(guides.width(), guides.height());
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(coverage[i] > 0.0f)) continue;
    const glm::vec3 normal = guides.Vec3(Layer::kNormal, i);
    for (int c = 0; c < 3; ++c) {
      const float share = std::clamp(0.5f * normal[c] + 0.5f, 0.0f, 1.0f);
      picture.rgba[4 * i + std::size_t(c)] = static_cast<std::uint16_t>(share * 65535.0f + 0.5f);
    }
    picture.rgba[4 * i + 3] = 65535;
  }
  return picture;
}

LinearColors LightAsColors(const GuideSet& guides, Layer layer, float factor) {
  LinearColors colors{guides.width(), guides.height(), {}};
  for (int c = 0; c < 3; ++c) {
    const auto plane = guides.Plane(layer, std::min(c, ChannelCount(layer) - 1));
    auto& to = colors.planes[std::size_t(c)];
    to.resize(plane.size());
    std::transform(plane.begin(), plane.end(), to.begin(),
                   [factor](float value) { return value > 0.0f ? std::min(1.0f, factor * value) : 0.0f; });
  }
  return colors;
}

// A field as measures take it.
struct Mosaic {
  explicit Mosaic(const SourceField& field) {
    covered.reserve(field.level.size());
    for (const std::int8_t level : field.level) covered.push_back(level != SourceField::kNoSource);
    planes = {field.width, field.height, field.x, field.y, covered, field.exemplar};
  }
  Mosaic(const Mosaic&) = delete;
  Mosaic& operator=(const Mosaic&) = delete;

  std::vector<std::uint8_t> covered;
  SourcePlanes planes;
};

// The root of the mean of off(i) over pixels that both cover.
template <class Off>
double RootMean(const GuideSet& a, const GuideSet& b, const Off& off) {
  const auto covered = a.Plane(Layer::kCoverage), also = b.Plane(Layer::kCoverage);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.pixel_count(); ++i) {
    if (covered[i] > 0.0f && also[i] > 0.0f) sum += off(i), count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace

TradeReference::TradeReference(std::shared_ptr<const GuideSet> guides, PreparedStyle style, double exposure,
                               int threads)
    : guides_(std::move(guides)), style_(std::move(style)), exposure_(exposure), threads_(threads) {
  const PreparedExemplar& exemplar = *style_.exemplar;
  for (auto& plane : normal_) plane.resize(PixelsOf(exemplar));
  usable_.resize(PixelsOf(exemplar));
  for (const Source& at : exemplar.UsablePixels()) {
    const std::size_t i = std::size_t(at.y) * exemplar.width() + at.x;
    const glm::vec3 normal = exemplar.Normal(at.x, at.y);
    usable_[i] = 1;
    for (int c = 0; c < 3; ++c) normal_[std::size_t(c)][i] = normal[c];
  }
  more_of_exemplars_.resize(static_cast<std::size_t>(exemplar.count()));
  if (style_.space) AddWeighedGuides();
  if (style_.illumination.active()) AddConditions();
  if (style_.settings.variety > 0.0) AddFreedom();
}

// Coordinates are what the transfer compares: weighed, so their squares are what they count.
void TradeReference::AddWeighedGuides() {
  const GuideSpace& space = *style_.space;
  const PreparedExemplar& exemplar = *style_.exemplar;
  const auto count = static_cast<std::size_t>(space.extra_dimensions());
  more_.assign(count, std::vector<float>(guides_->pixel_count()));
  const auto brightness = static_cast<float>(Exp2(exposure_));
  const auto coverage = guides_->Plane(Layer::kCoverage);
  float extra_values[GuideSpace::kMaxExtra];
  for (std::size_t i = 0; i < guides_->pixel_count(); ++i) {
    if (!(coverage[i] > 0.0f)) continue;
    space.Read(*guides_, i, brightness, extra_values);
    for (std::size_t d = 0; d < count; ++d) more_[d][i] = extra_values[d];
  }
  for (int k = 0; k < exemplar.count(); ++k) {
    auto& planes = more_of_exemplars_[std::size_t(k)];
    planes.assign(count, std::vector<float>(PixelsOf(exemplar)));
    for (const Source& at : exemplar.UsablePixels()) {
      const float* there = space.ExtraValuesAt(k, at);
      for (std::size_t d = 0; d < count; ++d) planes[d][std::size_t(at.y) * exemplar.width() + at.x] = there[d];
    }
  }
}

// Of several lighting conditions a pixel's is the one that suits its light; another counts by how much its light
// differs.
void TradeReference::AddConditions() {
  const Illumination& light = style_.illumination;
  const float weight = std::min(light.weight(), kMostOfLight);
  const auto luminance = guides_->Plane(Layer::kLuminance);
  const auto factor = static_cast<float>(Exp2(exposure_));
  std::vector<float>& wanted = more_.emplace_back(guides_->pixel_count());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    wanted[i] = weight * light.luminances()[std::size_t(light.Choose(luminance[i] * factor))];
  }
  for (std::size_t k = 0; k < more_of_exemplars_.size(); ++k) {
    more_of_exemplars_[k].emplace_back(PixelsOf(*style_.exemplar), weight * light.luminances()[k]);
  }
}

// On flat surfaces a style's variety takes paint from so many degrees off, which is what the artist asks for.
void TradeReference::AddFreedom() {
  const auto chord = static_cast<float>(2.0 * std::sin(0.5 * glm::radians(style_.settings.variety)));
  const std::vector<std::uint8_t> flat = FlatSurfaces(*guides_, style_.flat_reach);
  free_.resize(flat.size());
  std::transform(flat.begin(), flat.end(), free_.begin(),
                 [chord](std::uint8_t is_flat) { return is_flat ? chord : 0.0f; });
}

EnergyTarget TradeReference::Target(const Picture& picture) const {
  return {&picture,
          {guides_->Plane(Layer::kNormal, 0), guides_->Plane(Layer::kNormal, 1), guides_->Plane(Layer::kNormal, 2)},
          guides_->Plane(Layer::kCoverage),
          {more_.begin(), more_.end()},
          free_};
}

std::vector<EnergyExemplar> TradeReference::Exemplars() const {
  std::vector<EnergyExemplar> exemplars;
  for (std::size_t k = 0; k < more_of_exemplars_.size(); ++k) {
    exemplars.push_back({&style_.exemplar->picture(static_cast<int>(k)),
                         {normal_[0], normal_[1], normal_[2]},
                         usable_,
                         {more_of_exemplars_[k].begin(), more_of_exemplars_[k].end()}});
  }
  return exemplars;
}

Status TradeReference::MeasurePaint(const Picture& picture, const SourceField* field, EnergyOptions options,
                                    TradeMeasure& measure) const {
  options.threads = threads_;
  std::optional<Mosaic> mosaic;
  if (field) mosaic.emplace(*field), options.sources = &mosaic->planes;
  SCUMBLE_ASSIGN(const EnergyReport report, MeasureEnergy(Target(picture), Exemplars(), options));
  measure.both = report.both, measure.energy = report.energy, measure.missing = report.missing;
  return Ok();
}

Status TradeReference::MeasureTexture(const GuidedTexture& exemplars, const Picture& picture,
                                      TradeMeasure& measure) const {
  const std::vector<float> one(guides_->Has(Layer::kObject) ? 0 : guides_->pixel_count());
  const std::span<const float> surface = one.empty() ? guides_->Plane(Layer::kObject) : std::span(one);
  SCUMBLE_ASSIGN(const GuidedTextureReport paint, exemplars.Measure(Target(picture), surface, threads_));
  SCUMBLE_ASSIGN(const OutlineReport outlines, MeasureOutlines(picture, *guides_, threads_));
  if (paint.measured > 0) measure.texture = paint.distance * (1.0 + kOutlinesInTexture * outlines.error);
  return Ok();
}

Status TradeReference::MeasureMosaic(const Picture& picture, const SourceField& field, TradeMeasure& measure) const {
  const Mosaic mosaic(field);
  SCUMBLE_ASSIGN(measure.guide_degrees, MeanSourceDegrees(Target(picture), Exemplars(), mosaic.planes));
  const CoherenceReport coherence = MeasureCoherence(mosaic.planes);
  measure.coherence = coherence.share, measure.chunk_area = coherence.mean_chunk_area;
  measure.seam_excess = MeasureSeams(picture, mosaic.planes, *guides_).excess;
  measure.repetition = SourceRepetition(mosaic.planes);
  return Ok();
}

Expected<GuideDifference> TradeReference::Compare(const GuideSet& guides) const {
  const GuideSpace* const space = style_.space.get();
  if (space && space->has_radiance()) {  // the layer that is farthest off: light that needs chance, where some does
    GuideDifference worst;
    for (const LayerInfo& info : AllLayers()) {
      if (!GuideWeights::IsRadiance(info.layer) || !(style_.settings.guide_weights[info.layer] > 0.0f)) continue;
      SCUMBLE_ASSIGN(const GuideDifference off, CompareLight(guides, info.layer, space->white()));
      if (off.rms > worst.rms) worst = off;
    }
    return worst;
  }
  if (!style_.illumination.active()) return CompareNormals(guides);
  const auto luminances = style_.illumination.luminances();
  const float brightest = *std::max_element(luminances.begin(), luminances.end());
  return CompareLight(guides, Layer::kLuminance, brightest > 0.0f ? brightest : 1.0f);
}

Expected<GuideDifference> TradeReference::CompareNormals(const GuideSet& guides) const {
  FlipOptions options;
  options.threads = threads_;
  SCUMBLE_ASSIGN(const FlipReport flip, MeasureFlip(NormalsAsPicture(*guides_), NormalsAsPicture(guides), options));
  const double rms = RootMean(*guides_, guides, [&](std::size_t i) {
    const glm::dvec3 off = glm::dvec3(guides_->Vec3(Layer::kNormal, i)) - glm::dvec3(guides.Vec3(Layer::kNormal, i));
    return glm::dot(off, off);
  });
  return GuideDifference{rms, flip.mean};
}

Expected<GuideDifference> TradeReference::CompareLight(const GuideSet& guides, Layer layer, float white) const {
  // One exposure for both: each one's own is rounded to a hundredth of a stop, which is more than the noise of many
  // samples.
  const auto factor = static_cast<float>(Exp2(exposure_)) / white;
  const LinearColors exact = LightAsColors(*guides_, layer, factor), other = LightAsColors(guides, layer, factor);
  FlipOptions options;
  options.threads = threads_;
  SCUMBLE_ASSIGN(const FlipReport flip, MeasureFlip(exact, other, options));
  const double rms = RootMean(*guides_, guides, [&](std::size_t i) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double off = double(exact.planes[c][i]) - other.planes[c][i];
      sum += off * off / 3.0;
    }
    return sum;
  });
  return GuideDifference{rms, flip.mean};
}

}  // namespace scumble
