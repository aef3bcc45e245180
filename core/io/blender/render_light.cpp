#include "core/io/blender/render_light.h"

#include <utility>

#include "core/image/color.h"

namespace scumble {
namespace {

constexpr std::pair<std::string_view, LightPass> kLightPasses[] = {{"DiffDir", LightPass::kDiffuseDirect},
                                                                   {"Shadow", LightPass::kShadow},
                                                                   {"Shadow Catcher", LightPass::kShadowCatcher}};

float LuminanceAt(const std::array<std::vector<float>, 3>& pass, std::size_t i) {
  return Luminance(pass[0][i], pass[1][i], pass[2][i]);
}

// A comparison with NaN is false: it stays, and Validate refuses it.
float NotBelowZero(float value) { return value < 0.0f ? 0.0f : value; }

}  // namespace

std::optional<LightChannel> ParseLightChannel(std::string_view name) {
  constexpr std::string_view kComponents = "RGB";
  if (name.size() < 3 || name[name.size() - 2] != '.') return std::nullopt;
  const std::size_t component = kComponents.find(name.back());
  if (component == std::string_view::npos) return std::nullopt;
  name.remove_suffix(2);
  const std::size_t dot = name.rfind('.');
  const std::string_view pass = dot == std::string_view::npos ? name : name.substr(dot + 1);
  for (const auto& [known, meaning] : kLightPasses) {
    if (pass != known) continue;
    return LightChannel{std::string(dot == std::string_view::npos ? "" : name.substr(0, dot)), meaning,
                        static_cast<int>(component)};
  }
  return std::nullopt;
}

std::vector<LightPass> LightPassesFor(Layer layer) {
  if (layer == Layer::kLuminance) return {LightPass::kDiffuseDirect};
  if (layer == Layer::kShadow) return {LightPass::kShadow, LightPass::kShadowCatcher};
  return {};
}

void ConvertBlenderLight(const BlenderLight& light, std::span<const float> catchers, GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  const auto find = [&](LightPass pass) {
    const auto found = light.find(pass);
    return found == light.end() ? nullptr : &found->second;
  };
  const auto* const direct = find(LightPass::kDiffuseDirect);
  const auto* const reached = find(LightPass::kShadow);
  const auto* const caught = find(LightPass::kShadowCatcher);
  if (guides.Has(Layer::kLuminance) && direct) {
    const auto plane = guides.Plane(Layer::kLuminance);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      plane[i] = coverage[i] > 0.0f ? NotBelowZero(LuminanceAt(*direct, i)) : 0.0f;
    }
  }
  if (!guides.Has(Layer::kShadow) || !(reached || caught)) return;
  const auto plane = guides.Plane(Layer::kShadow);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const bool catches = caught && !catchers.empty() && 2.0f * catchers[i] > coverage[i];
    float left = 1.0f;
    if (catches)
      left = LuminanceAt(*caught, i);
    else if (reached)
      left = LuminanceAt(*reached, i) / coverage[i];
    plane[i] = coverage[i] > 0.0f ? NotBelowZero(1.0f - NotBelowZero(left)) : 0.0f;
  }
}

}  // namespace scumble
