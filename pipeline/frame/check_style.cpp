#include "pipeline/check_style.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/place_sphere.h"
#include "core/style/rectify.h"
#include "core/style/sphere_template.h"
#include "pipeline/machine/file_cache.h"
#include "pipeline/prepare_frame.h"
#include "pipeline/style/kit_template.h"
#include "pipeline/style_locations.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

using Weight = PaintFault::Weight;

std::vector<PaintFault> AmbiguityFaults(const AmbiguityReport& report) {
  // A floor and a wall are flat too, and do no harm beside rounder objects.
  constexpr double kLeastCovered = 50.0, kMostFlat = 50.0, kRound = 80.0;
  if (report.flat_percent > kMostFlat && report.covered_percent < kRound) {
    return {
        {"flat-faces", Weight::kMistake,
         fmt::format("{:.0f}% of the painting shows flat faces: {} of {} directions, the fullest on {} pixels; curved "
                     "surfaces will be flat patches",
                     report.flat_percent, report.cells_shown, report.cells, report.most_repeats),
         "use a rounded shape", std::nullopt}};
  }
  if (report.covered_percent < kLeastCovered) {
    return {
        {"few-directions", Weight::kMistake,
         fmt::format("the painting shows {:.0f}% of the directions that face the viewer; surfaces that face elsewhere "
                     "take paint that is up to {:.0f}° off",
                     report.covered_percent, report.largest_error_degrees),
         "paint a rounder shape, or a larger picture of it", std::nullopt}};
  }
  return {};
}

// Of a painted template, whose margin was cut off when it was read.
std::optional<MarkedSphere> FindMarkedSphere(const Exemplar& exemplar) {
  if (exemplar.margin == 0) return std::nullopt;
  Expected<Picture> file = ReadPicture(exemplar.name);
  const auto fit = file ? FindTemplate(*std::move(file)) : std::nullopt;
  if (!fit) return std::nullopt;
  const glm::dvec2 centre = fit->map.ToPicture({0.5, 0.5}) - double(exemplar.margin);
  return MarkedSphere{centre.x, centre.y, 0.5 * fit->map.SpherePixels(), fit->map.Turn()};
}

// Of a sphere that does not fill its file.
std::vector<PaintFault> PlaceFaults(const Exemplar& exemplar) {
  if (!exemplar.cut) return {};
  return {
      {"taken-as-it-lies", Weight::kRemark, DescribeCut(*exemplar.cut),
       "if that is not where it is, crop it to the sphere; if the sphere fills the square, write fills = true under "
       "its [[exemplar]]",
       std::nullopt}};
}

// An exemplar for more light that is darker than one for less is legal, and most often a mistake.
std::vector<PaintFault> OppositeLights(const Style& style, std::span<const float> luminances,
                                       const std::vector<PaintTraits>& traits, std::size_t a) {
  constexpr double kClearly = 2.0;  // L*
  std::vector<PaintFault> faults;
  for (std::size_t b = 0; b < luminances.size(); ++b) {
    const ToneReport &more = traits[a].tone, &less = traits[b].tone;
    // Strong light makes deep shades too, so the lightest paint must be darker as well.
    const bool darker = more.mean + kClearly < less.mean && more.brightest < less.brightest;
    if (!(luminances[a] > luminances[b] && darker)) continue;
    faults.push_back({"opposite-light", Weight::kMistake,
                      fmt::format("it is for more light than {} ({:.4g} and {:.4g}), and its paint is darker",
                                  style.exemplars[b].name, luminances[a], luminances[b]),
                      "see whether the luminances in style.toml are the wrong way round", std::nullopt});
  }
  return faults;
}

// A layer's value in all pixels of all guides, channel by channel: "0.20, 0.50, 0.90", or "1.00" where all channels are
// alike. Empty where a channel varies.
std::string UniformValue(const GuideSpace& space, Layer layer, int exemplars) {
  std::vector<std::string> values;
  for (int c = 0; c < ChannelCount(layer); ++c) {
    GuideSpace::Range range = space.RangeOf(0, layer, c);
    for (int k = 1; k < exemplars; ++k) {
      const GuideSpace::Range more = space.RangeOf(k, layer, c);
      range = {std::min(range.least, more.least), std::max(range.largest, more.largest)};
    }
    if (range.least < range.largest) return {};
    values.push_back(fmt::format("{:.2f}", range.least));
  }
  const bool are_alike = std::count(values.begin(), values.end(), values.front()) == std::ssize(values);
  return are_alike ? values.front() : fmt::format("{}", fmt::join(values, ", "));
}

// Layers that choose no paint: they have a weight, and one value in all guides.
std::vector<PaintFault> UniformLayers(const GuideSpace& space, int exemplars) {
  std::vector<PaintFault> faults;
  for (const Layer layer : space.layers()) {
    const std::string value = UniformValue(space, layer, exemplars);
    if (value.empty()) continue;
    const std::string name = Info(layer).name;
    faults.push_back({"uniform-layer", Weight::kMistake,
                      fmt::format("{} has a weight, and is {} all over its guides", name, value),
                      "set transfer.guide_weights." + name + " to 0, or make guides in which it varies", std::nullopt});
  }
  return faults;
}

void FindFaults(CheckedStyle& checked) {
  const Style& style = checked.style;
  const auto luminances = checked.prepared.illumination.luminances();
  PaintFaultContext context;
  context.several = style.exemplars.size() > 1;
  context.has_paper = style.paper.color || style.paper.picture;
  double darkest = 100.0, brightest = 0.0, most_light = 0.0;
  for (std::size_t k = 0; k < checked.traits.size(); ++k) {
    const PaintTraits& traits = checked.traits[k];
    context.largest_size = std::max({context.largest_size, traits.width, traits.height});
    darkest = std::min(darkest, traits.tone.darkest), brightest = std::max(brightest, traits.tone.brightest);
    if (context.several) most_light = std::max(most_light, double(luminances[k]));
  }
  context.tonal_range = brightest - darkest;
  for (std::size_t k = 0; k < checked.traits.size(); ++k) {
    const Exemplar& exemplar = style.exemplars[k];
    context.brightest = !context.several || luminances[k] == most_light;
    context.knows_guides = !exemplar.guides_file.empty();
    context.shows_marks = exemplar.is_sphere && LooksLikeTemplate(exemplar.picture);
    context.origin = exemplar.Origin();
    context.marked = FindMarkedSphere(exemplar);
    std::vector<PaintFault> faults = FindPaintFaults(checked.traits[k], context);
    for (PaintFault& fault : PlaceFaults(exemplar)) faults.push_back(std::move(fault));
    if (context.several) {
      for (PaintFault& fault : OppositeLights(style, luminances, checked.traits, k)) faults.push_back(std::move(fault));
    }
    for (PaintFault& fault : faults) checked.faults.push_back({exemplar.name, std::move(fault)});
  }
  for (EqualLight& equal : EqualLights(style, checked.prepared)) {
    checked.faults.push_back(
        {equal.image, {"equal-light", Weight::kMistake, "it " + equal.what, equal.fix, std::nullopt}});
  }
  std::vector<PaintFault> of_guides = AmbiguityFaults(checked.directions);
  if (checked.prepared.space) {
    for (PaintFault& fault : UniformLayers(*checked.prepared.space, static_cast<int>(style.exemplars.size())))
      of_guides.push_back(std::move(fault));
  }
  for (PaintFault& fault : of_guides) checked.faults.push_back({style.exemplars.front().name, std::move(fault)});
}

}  // namespace

std::size_t CheckedStyle::Count(PaintFault::Weight weight) const {
  return static_cast<std::size_t>(std::count_if(faults.begin(), faults.end(),
                                                [&](const FoundFault& found) { return found.fault.weight == weight; }));
}

Expected<CheckedStyle> CheckStyle(const StyleRequest& request, const RunContext& context) {
  CheckedStyle checked;
  SCUMBLE_ASSIGN(checked.style, OpenStyle(request, context));
  if (!checked.style.unpainted.empty()) return checked;  // its exemplar is made up
  FileCache cache(context.cache_folder);
  PrepareOptions options;
  options.cache = &cache;
  options.threads = context.threads;
  options.is_cancelled = context.is_cancelled;
  SCUMBLE_ASSIGN(checked.prepared, Prepare(checked.style, 1080, options));
  const PreparedStyle& prepared = checked.prepared;
  for (const Exemplar& exemplar : checked.style.exemplars) {
    SCUMBLE_ASSIGN(const std::optional<BareTemplates> bare, FindBareTemplates(exemplar, context.threads));
    checked.traits.push_back(MeasurePaint(exemplar, checked.style.transfer.rim, bare ? &bare->drawn : nullptr,
                                          bare ? &bare->printed : nullptr));
  }
  checked.directions = MeasureAmbiguity(*prepared.exemplar);
  if (prepared.space) {
    const GuideTest test(checked.style.transfer.threshold, checked.style.transfer.threshold_metric);
    checked.space = MeasureAmbiguity(*prepared.space, *prepared.exemplar, 0, test);
  }
  FindFaults(checked);
  return checked;
}

}  // namespace scumble
