#include "pipeline/frame/explain_frame.h"

#include "core/image/exact_math.h"

namespace scumble {
namespace {

// What the match compares with the threshold, at the source that each pixel got.
std::vector<float> GuideErrors(const ShownTransfer& shown) {
  const SourceField& field = shown.field;
  std::vector<float> errors(field.level.size(), 0.0f);
  const float exposure = static_cast<float>(Exp2(shown.exposure));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (field.level[i] == SourceField::kNoSource) continue;
    const PreparedStyle& style = shown.styles[shown.map.style.empty() ? 0 : shown.map.style[i]];
    const glm::vec3 normal = shown.guides.Vec3(Layer::kNormal, i);
    const GuideTest test(style.settings.threshold, style.settings.threshold_metric);
    if (style.space) {
      float extra_values[GuideSpace::kMaxExtra];
      style.space->Read(shown.guides, i, exposure, extra_values);
      errors[i] = style.space->Distance(test, field.exemplar[i], normal, extra_values, {field.x[i], field.y[i]});
    } else {
      errors[i] = test.Distance(normal, style.exemplar->Normal(field.x[i], field.y[i]));
    }
    if (!style.illumination.active()) continue;
    const float luminance = shown.guides.Plane(Layer::kLuminance)[i] * exposure;
    errors[i] += style.illumination.Error(luminance, field.exemplar[i]);
  }
  return errors;
}

}  // namespace

Picture Show(Explanation what, const ShownTransfer& shown) {
  const SourceField& field = shown.field;
  ExplainPlanes planes{field.width,
                       field.height,
                       shown.guides.Plane(Layer::kCoverage),
                       field.x,
                       field.y,
                       field.level,
                       field.exemplar,
                       shown.map.style,
                       {},
                       {},
                       {},
                       {},
                       &shown.result};
  for (const PreparedStyle& style : shown.styles) {
    planes.exemplar_size.push_back(style.exemplar->size());
    planes.exemplar_count.push_back(style.exemplar->count());
    planes.threshold.push_back(style.settings.threshold);
  }
  std::vector<float> errors;
  if (what == Explanation::kError) errors = GuideErrors(shown);
  planes.error = errors;
  return Explain(what, planes);
}

}  // namespace scumble
