#include "apps/cli/verbs/paint_report.h"

#include <fmt/format.h>

namespace scumble {
namespace {

nlohmann::ordered_json LightToJson(const PaintedLight& light) {
  return {{"azimuth", light.azimuth}, {"elevation", light.elevation}, {"correlation", light.correlation}};
}

nlohmann::ordered_json PatchesToJson(const Patches& patches, glm::ivec2 origin) {
  nlohmann::ordered_json json{{"count", patches.count}, {"pixels", patches.pixels}};
  if (patches.count > 0)
    json["largest"] = {{"pixels", patches.largest}, {"x", patches.x + origin.x}, {"y", patches.y + origin.y}};
  return json;
}

nlohmann::ordered_json RegularityToJson(const RegularityReport& report, glm::ivec2 origin) {
  nlohmann::ordered_json json{{"windows", report.windows},
                              {"autocorrelation_peak", report.peak},
                              {"echo", report.echo},
                              {"local_echo", report.local_echo}};
  if (report.period > 0.0) {
    json["period"] = report.period;
    json["direction"] = report.direction;
    json["kind"] = report.grid ? "grid" : "lines";
    json["x"] = report.x + origin.x, json["y"] = report.y + origin.y;
  }
  return json;
}

}  // namespace

nlohmann::ordered_json TraitsToJson(const PaintTraits& traits, const Exemplar& exemplar) {
  const glm::ivec2 origin = exemplar.Origin();
  nlohmann::ordered_json json{{"width", traits.width},
                              {"height", traits.height},
                              {"margin", exemplar.margin},
                              {"covered_percent", traits.covered_percent},
                              {"transparent_percent", traits.alpha.transparent_percent},
                              {"translucent_percent", traits.alpha.translucent_percent},
                              {"premultiplied", traits.alpha.premultiplied},
                              {"holes", PatchesToJson(traits.alpha.holes, origin)},
                              {"lightness",
                               {{"darkest", traits.tone.darkest},
                                {"brightest", traits.tone.brightest},
                                {"mean", traits.tone.mean},
                                {"range", traits.tone.range()}}},
                              {"painted_light", LightToJson(traits.light)},
                              {"anisotropy", traits.texture.anisotropy},
                              {"regularity", RegularityToJson(traits.texture.regularity, origin)}};
  if (!traits.is_sphere) return json;
  if (exemplar.cut) json["sphere"] = {{"x", exemplar.cut->x}, {"y", exemplar.cut->y}, {"radius", exemplar.cut->radius}};
  json["ground_known"] = traits.ground_known;
  if (traits.disc.found) {
    json["disc"] = {{"x", traits.disc.x + origin.x},
                    {"y", traits.disc.y + origin.y},
                    {"radius", traits.disc.radius},
                    {"outline_share", traits.disc.outline}};
  }
  json["soft_edge"] = traits.alpha.soft_edge;
  json["fringe_percent"] = traits.fringe_percent;
  json["bare_shade"] = PatchesToJson(traits.bare_shade, origin);
  if (traits.template_light) {
    json["template_percent"] = traits.template_percent;
    json["bare_template"] = PatchesToJson(traits.bare_template, origin);
    json["template_light"] = LightToJson(*traits.template_light);
  }
  return json;
}

std::string TraitsToText(const PaintTraits& traits) {
  std::string text = fmt::format("  {:.1f}% covered; lightness {:.0f} to {:.0f} of 100", traits.covered_percent,
                                 traits.tone.darkest, traits.tone.brightest);
  if (traits.light.correlation > 0.0) {
    text += fmt::format("; light from azimuth {:.0f}°, elevation {:.0f}° (correlation {:.2f})", traits.light.azimuth,
                        traits.light.elevation, traits.light.correlation);
  }
  const RegularityReport& regularity = traits.texture.regularity;
  return text + fmt::format("\n  strokes: anisotropy {:.2f}; regularity {:.2f}, in places {:.2f}\n",
                            traits.texture.anisotropy, regularity.peak, regularity.local_echo);
}

nlohmann::ordered_json FaultToJson(const std::string& image, const PaintFault& fault) {
  nlohmann::ordered_json json{{"code", fault.code},
                              {"weight", fault.weight == PaintFault::Weight::kMistake ? "mistake" : "remark"},
                              {"image", image},
                              {"what", fault.what},
                              {"fix", fault.remedy}};
  if (fault.place) json["x"] = fault.place->first, json["y"] = fault.place->second;
  return json;
}

std::string FaultToText(const std::string& image, const PaintFault& fault) {
  return fmt::format("{}: {}; {}", image, fault.what, fault.remedy);
}

}  // namespace scumble
