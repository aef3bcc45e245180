#include "measure/crosscheck.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "core/image/color.h"
#include "core/image/hash.h"
#include "measure/crosscheck/parts.h"

namespace scumble {
namespace internal {

std::vector<std::size_t> ErodedMask(const GuideSet& a, const GuideSet& b, int reach) {
  const int width = a.width(), height = a.height();
  std::vector<std::size_t> mask;
  const auto covered_a = a.Plane(Layer::kCoverage), covered_b = b.Plane(Layer::kCoverage);
  const auto object_a = a.Plane(Layer::kObject), object_b = b.Plane(Layer::kObject);
  for (int y = reach; y < height - reach; ++y) {
    for (int x = reach; x < width - reach; ++x) {
      const std::size_t centre = a.Index(x, y);
      bool inside = true;
      for (int v = y - reach; v <= y + reach && inside; ++v) {
        for (int u = x - reach; u <= x + reach && inside; ++u) {
          const std::size_t i = a.Index(u, v);
          inside = covered_a[i] > 0.0f && covered_b[i] > 0.0f && object_a[i] == object_a[centre] &&
                   object_b[i] == object_b[centre];
        }
      }
      if (inside) mask.push_back(centre);
    }
  }
  return mask;
}

void PutColor(Picture& picture, std::size_t i, glm::vec3 linear) {
  for (int c = 0; c < 3; ++c) picture.rgba[4 * i + c] = Srgb16FromLinear(linear[c]);
  picture.rgba[4 * i + 3] = 65535;
}

std::string Counted(int count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

}  // namespace internal

namespace {

using internal::PutColor;

// By nearest rank: the smallest value that is at least as large as that share of all. NaN counts as infinite.
double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  for (double& value : values) {
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  }
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// In double, by both products: acos alone does not resolve small angles.
double AngleDegrees(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * (180.0 / 3.14159265358979323846);
}

// The distance of a layer's pixels, and the display of its values.
struct LayerMeasure {
  Layer layer;
  std::function<double(std::size_t)> difference;
  std::function<glm::vec3(const GuideSet&, std::size_t)> look;  // linear colour
  double full_scale;
  const char* full_scale_words;
};

glm::vec3 LookOfId(const GuideSet& guides, std::size_t i) {
  const std::uint64_t hash = Hash(IdOf(guides.Plane(Layer::kObject)[i]));
  const glm::vec3 color(UnitFloat(hash), UnitFloat(Mix64(hash)), UnitFloat(Mix64(hash + 1)));
  return 0.05f + 0.7f * color * color;
}

std::vector<LayerMeasure> Measures(const GuideSet& a, const GuideSet& b) {
  const auto relative = [](double x, double y) { return std::fabs(x - y) / std::max(std::fabs(x), 1e-30); };
  const auto depth_a = a.Plane(Layer::kDepth), depth_b = b.Plane(Layer::kDepth);
  float nearest = std::numeric_limits<float>::infinity(),
        farthest = 0.0f;  // of the distances below the one that counts as infinite
  for (const float z : depth_a) {
    if (z < 1e30f) nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  std::vector<LayerMeasure> measures = {
      {Layer::kNormal,
       [&a, &b](std::size_t i) { return AngleDegrees(a.Vec3(Layer::kNormal, i), b.Vec3(Layer::kNormal, i)); },
       [](const GuideSet& g, std::size_t i) {
         return glm::pow(g.Vec3(Layer::kNormal, i) * 0.5f + 0.5f, glm::vec3(2.2f));
       },
       0.1, "0.1 degrees"},
      {Layer::kDepth, [=](std::size_t i) { return relative(depth_a[i], depth_b[i]); },
       [=](const GuideSet& g, std::size_t i) {
         const float z = g.Plane(Layer::kDepth)[i];
         return glm::vec3(0.9f - 0.8f * (z - nearest) / std::max(farthest - nearest, 1e-6f));
       },
       1e-4, "1e-4 relative"},
      {Layer::kObject,
       [&a, &b](std::size_t i) { return a.Plane(Layer::kObject)[i] == b.Plane(Layer::kObject)[i] ? 0.0 : 1.0; },
       LookOfId, 1.0, "another object"},
  };
  if (a.Has(Layer::kPosition) && b.Has(Layer::kPosition)) {
    glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < a.pixel_count(); ++i) {
      if (!(a.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      low = glm::min(low, a.Vec3(Layer::kPosition, i)), high = glm::max(high, a.Vec3(Layer::kPosition, i));
    }
    measures.push_back(
        {Layer::kPosition,
         [&a, &b, depth_a](std::size_t i) {
           const glm::dvec3 d = glm::dvec3(a.Vec3(Layer::kPosition, i)) - glm::dvec3(b.Vec3(Layer::kPosition, i));
           return glm::length(d) / std::max<double>(std::fabs(depth_a[i]), 1e-30);
         },
         [=](const GuideSet& g, std::size_t i) {
           return (g.Vec3(Layer::kPosition, i) - low) / glm::max(high - low, glm::vec3(1e-6f)) * 0.8f + 0.05f;
         },
         1e-4, "1e-4 of the distance"});
  }
  if (a.Has(Layer::kAlbedo) && b.Has(Layer::kAlbedo)) {
    measures.push_back({Layer::kAlbedo,
                        [&a, &b](std::size_t i) {
                          const glm::vec3 d = glm::abs(a.Vec3(Layer::kAlbedo, i) - b.Vec3(Layer::kAlbedo, i));
                          return static_cast<double>(d.x + d.y + d.z) / 3.0;
                        },
                        [](const GuideSet& g, std::size_t i) { return g.Vec3(Layer::kAlbedo, i); }, 0.02, "0.02"});
  }
  return measures;
}

void AddFigures(const LayerMeasure& measure, const std::vector<double>& differences, CrosscheckReport& report) {
  const std::string layer = Info(measure.layer).name;
  double sum = 0;
  for (const double d : differences) sum += d;
  const double mean = sum / static_cast<double>(differences.size());
  switch (measure.layer) {
    case Layer::kNormal:
      report.figures.push_back({layer, "99% within", "degrees", Percentile(differences, 0.99), 0.01, 0, 1e-4});
      report.figures.push_back({layer, "99.9% within", "degrees", Percentile(differences, 0.999), 0.1, 0, 1e-4});
      break;
    case Layer::kObject:
      report.figures.push_back({layer, "differing", "pixels", sum, 0.0});
      break;
    case Layer::kAlbedo:
      report.figures.push_back({layer, "mean difference", "", mean, 0.002, 0, 1e-6});
      break;
    default:
      report.figures.push_back({layer, "99.9% within", "relative", Percentile(differences, 0.999), 1e-5, 0, 1.2e-7});
  }
}

CrosscheckPictures MakePictures(const LayerMeasure& measure, const GuideSet& a, const GuideSet& b,
                                const std::vector<std::size_t>& mask, const std::vector<double>& differences) {
  CrosscheckPictures pictures{Info(measure.layer).name,
                              Picture(a.width(), a.height()),
                              Picture(a.width(), a.height()),
                              Picture(a.width(), a.height()),
                              "",
                              std::string("yellow is ") + measure.full_scale_words,
                              {"#00001c", "#ffe03f"},
                              {"equal", measure.full_scale_words}};
  for (std::size_t i = 0; i < a.pixel_count(); ++i) {
    if (a.Plane(Layer::kCoverage)[i] > 0.0f) PutColor(pictures.reference, i, measure.look(a, i));
    if (b.Plane(Layer::kCoverage)[i] > 0.0f) PutColor(pictures.ours, i, measure.look(b, i));
    PutColor(pictures.difference, i, glm::vec3(0.02f));
  }
  for (std::size_t m = 0; m < mask.size(); ++m) {
    const auto heat = static_cast<float>(std::min(1.0, differences[m] / measure.full_scale));
    PutColor(pictures.difference, mask[m],
             glm::mix(glm::vec3(0.0f, 0.01f, 0.06f), glm::vec3(1.0f, 0.75f, 0.05f), heat));
  }
  return pictures;
}

std::vector<std::size_t> Without(const std::vector<std::uint8_t>& flags, const std::vector<std::size_t>& mask) {
  if (flags.empty()) return mask;
  std::vector<std::size_t> rest;
  for (const std::size_t i : mask) {
    if (!flags[i]) rest.push_back(i);
  }
  return rest;
}

CrosscheckPictures CoveragePictures(const GuideSet& a, const GuideSet& b) {
  const auto covered_a = a.Plane(Layer::kCoverage), covered_b = b.Plane(Layer::kCoverage);
  std::vector<std::size_t> everywhere(a.pixel_count());
  std::vector<double> differences(a.pixel_count());
  for (std::size_t i = 0; i < everywhere.size(); ++i) {
    everywhere[i] = i;
    differences[i] = (covered_a[i] >= 0.5f) != (covered_b[i] >= 0.5f) ? 1.0 : 0.0;
  }
  const LayerMeasure measure{Layer::kCoverage, nullptr, [](const GuideSet&, std::size_t) { return glm::vec3(0.8f); },
                             1.0, "covered on one side alone"};
  return MakePictures(measure, a, b, everywhere, differences);
}

void AddCoverage(const GuideSet& a, const GuideSet& b, CrosscheckReport& report) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < a.pixel_count(); ++i) {
    differing += (a.Plane(Layer::kCoverage)[i] >= 0.5f) != (b.Plane(Layer::kCoverage)[i] >= 0.5f);
  }
  const double percent = 100.0 * static_cast<double>(differing) / static_cast<double>(a.pixel_count());
  // In a baseline one pixel may differ either way.
  const double one_pixel = 100.0 / static_cast<double>(a.pixel_count());
  report.figures.push_back({"A", "differing", "% of pixels", percent, 0.02, 0, one_pixel});
}

// Names objects without a compared pixel: the erosion removes wires and leaves.
void CountCovered(const GuideSet& a, const GuideSet& b, const std::vector<std::size_t>& mask,
                  CrosscheckReport& report) {
  const auto covered_a = a.Plane(Layer::kCoverage), covered_b = b.Plane(Layer::kCoverage);
  const auto object = b.Plane(Layer::kObject);
  std::set<std::uint32_t> seen, compared;
  for (std::size_t i = 0; i < a.pixel_count(); ++i) {
    if (!(covered_a[i] > 0.0f && covered_b[i] > 0.0f)) continue;
    ++report.covered;
    seen.insert(IdOf(object[i]));
  }
  for (const std::size_t i : mask) compared.insert(IdOf(object[i]));
  std::string names;
  std::size_t thin = 0;
  for (const std::uint32_t id : seen) {
    if (compared.count(id)) continue;
    if (++thin > 5) continue;
    const auto name = b.object_names.find(id);
    names += (names.empty() ? "" : ", ") + (name != b.object_names.end() ? name->second : fmt::format("id {}", id));
  }
  if (thin == 0) return;
  report.too_thin = names + (thin > 5 ? fmt::format(" and {} more", thin - 5) : "");
}

}  // namespace

double CrosscheckFigure::LimitInForce() const { return TightenedByBaseline() ? *baseline_limit : limit; }

CrosscheckOutcome CrosscheckReport::Outcome() const {
  if (!failure.empty()) return CrosscheckOutcome::kNotCompared;
  const auto any = [this](auto is) { return std::any_of(figures.begin(), figures.end(), is); };
  if (!skipped.empty() || !problems.empty() || compared < kLeastCompared ||
      any([](const CrosscheckFigure& figure) { return figure.broken(); })) {
    return CrosscheckOutcome::kDiffers;
  }
  return any([](const CrosscheckFigure& figure) { return figure.TooNoisy(); }) ? CrosscheckOutcome::kNotProved
                                                                               : CrosscheckOutcome::kAgrees;
}

bool CrosscheckReport::KeepsBuiltInLimits() const {
  CrosscheckReport alone;
  alone.failure = failure, alone.compared = compared, alone.skipped = skipped, alone.figures = figures;
  for (CrosscheckFigure& figure : alone.figures) figure.baseline_limit.reset();
  return alone.passed();
}

Expected<CrosscheckReport> Crosscheck(const std::string& scene, const GuideSet& reference, const GuideSet& ours,
                                      const CrosscheckOptions& options) {
  const LayerSet needed{Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject};
  if (!reference.layers().Contains(needed) || !ours.layers().Contains(needed)) {
    return InputError(scene + ": a cross-check needs " + needed.ToString() + "; the reference holds " +
                      reference.layers().ToString() + ", ours " + ours.layers().ToString());
  }
  if (reference.width() != ours.width() || reference.height() != ours.height()) {
    return InputError(fmt::format("{}: the reference is {}×{}, ours {}×{}: render both at one size", scene,
                                  reference.width(), reference.height(), ours.width(), ours.height()));
  }
  CrosscheckReport report;
  report.scene = scene;
  report.setup.width = ours.width(), report.setup.height = ours.height();
  for (const Layer layer : {Layer::kPosition, Layer::kAlbedo}) {
    if (ours.Has(layer) && !reference.Has(layer)) report.skipped.push_back(Info(layer).name);
  }
  AddCoverage(reference, ours, report);
  if (options.make_pictures) report.pictures.push_back(CoveragePictures(reference, ours));
  const std::vector<std::size_t> mask = internal::ErodedMask(reference, ours, options.erode_pixels);
  report.compared = mask.size();
  CountCovered(reference, ours, mask, report);
  if (mask.empty()) return report;
  for (const LayerMeasure& measure : Measures(reference, ours)) {
    const bool is_albedo = measure.layer == Layer::kAlbedo;
    const std::vector<std::size_t> places = is_albedo ? Without(options.without_albedo, mask) : mask;
    std::vector<double> differences;
    differences.reserve(places.size());
    for (const std::size_t i : places) differences.push_back(measure.difference(i));
    if (places.empty()) {
      CrosscheckFigure none{Info(measure.layer).name, "mean difference", "", 0.0, 0.002, 0, 1e-6};
      none.note = "every surface only shines";
      report.figures.push_back(std::move(none));
      continue;
    }
    AddFigures(measure, differences, report);
    if (options.make_pictures) {
      report.pictures.push_back(MakePictures(measure, reference, ours, places, differences));
    }
  }
  return report;
}

}  // namespace scumble
