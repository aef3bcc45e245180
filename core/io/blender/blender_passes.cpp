#include "core/io/blender/blender_passes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/io/blender/solve_camera.h"

namespace scumble {
namespace {

constexpr float kBackgroundDepth = 1e9f;  // Blender writes 1e10
constexpr float kShortestNormal = 1e-3f;  // a shorter average has no direction

glm::dvec3 GltfFromBlender(glm::dvec3 v) { return {v.x, v.z, -v.y}; }

void Set(GuideSet& guides, Layer layer, std::size_t i, glm::vec3 value) {
  for (int c = 0; c < 3; ++c) guides.Plane(layer, c)[i] = value[c];
}

float SquaredLength(glm::vec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

// NaN counts as a normal, so that Validate refuses it.
bool HasNormal(const GuideSet& guides, std::size_t i) {
  return !(SquaredLength(guides.Vec3(Layer::kNormal, i)) <= kShortestNormal * kShortestNormal);
}

bool HasDepth(const GuideSet& guides, std::size_t i) { return guides.Plane(Layer::kDepth)[i] < kBackgroundDepth; }

// Alpha of an opaque film is 1 everywhere, background included, and 0 outside a render border.
void FindCoverage(const BlenderMattes& mattes, GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  if (std::any_of(coverage.begin(), coverage.end(), [](float a) { return a != 0.0f && !(a >= 0.9999f); })) return;
  std::vector<float> shown(coverage.size());
  if (!mattes.empty()) {
    MatteCoverage(mattes.begin()->second.ranks, shown);
  } else {
    for (std::size_t i = 0; i < shown.size(); ++i) {
      shown[i] = (guides.Has(Layer::kDepth) ? HasDepth(guides, i) : HasNormal(guides, i)) ? 1.0f : 0.0f;
    }
  }
  for (std::size_t i = 0; i < shown.size(); ++i) coverage[i] = coverage[i] > 0.0f ? shown[i] : 0.0f;
}

// The objects' shares of a pixel: their Cryptomatte's sum, without one the length of the normals' sum.
float SumOfShares(const BlenderMattes& mattes, const GuideSet& guides, std::size_t i) {
  if (mattes.empty()) return std::sqrt(SquaredLength(guides.Vec3(Layer::kNormal, i)));
  float sum = 0.0f;
  for (std::size_t r = 1; r < mattes.begin()->second.ranks.size(); r += 2) {
    const std::vector<float>& rank = mattes.begin()->second.ranks[r];
    if (!rank.empty() && rank[i] > 0.0f) sum += rank[i];
  }
  return sum;
}

// Adds what shadow catchers cover to the coverage, and returns it. `mattes` may be empty.
std::vector<float> CoverCatchers(const BlenderMattes& mattes, GuideSet& guides) {
  constexpr float kNoise = 0.01f;  // of the sums
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::vector<float> sums(coverage.size()), caught(coverage.size(), 0.0f);
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = SumOfShares(mattes, guides, i);
  // Catchers count twice in Cycles 3, once in Cycles 4.
  const bool twice = std::any_of(sums.begin(), sums.end(), [](float sum) { return sum > 1.5f; });
  for (std::size_t i = 0; i < caught.size(); ++i) {
    const float film = coverage[i];
    float beyond = sums[i] - film;  // an opaque film's coverage has objects and catchers
    if (mattes.empty()) {           // averaged normals are shorter
      const bool beside = twice ? sums[i] > 1.5f : beyond > 0.5f;
      beyond = beside ? (twice ? 2.0f - film : 1.0f - film) : 0.0f;
    }
    if (!(beyond > kNoise)) continue;
    caught[i] = std::min(1.0f, film >= 1.0f || !twice ? beyond : 0.5f * beyond);
    coverage[i] = std::min(1.0f, film + caught[i]);
  }
  return caught;
}

Expected<GuideCamera> FindCamera(const std::string& name, const GuideSet& guides) {
  for (const auto& [layer, pass] : {std::pair{Layer::kPosition, "Position"}, {Layer::kDepth, "Z (Depth)"}}) {
    if (guides.Has(layer)) continue;
    return InputError(
        name + " is a Blender render whose header holds no camera, and it lacks the pass " + pass +
        ", from which the camera could be found: switch on Position and Z in View Layer > Passes, or give "
        "the .camera file that blender_scripts/render_guides.py writes, with --camera FILE");
  }
  SolveCameraInput input;
  input.width = guides.width(), input.height = guides.height();
  for (int c = 0; c < 3; ++c) input.position[c] = guides.Plane(Layer::kPosition, c);
  input.depth = guides.Plane(Layer::kDepth);
  SCUMBLE_ASSIGN(SolvedCamera solved, SolveCamera(input, name));
  return std::move(solved.camera);
}

void ConvertPositions(GuideSet& guides) {
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    Set(guides, Layer::kPosition, i, glm::vec3(GltfFromBlender(guides.Vec3(Layer::kPosition, i))));
  }
}

void ConvertNormals(const GuideCamera& camera, GuideSet& guides) {
  const glm::dmat3 view_from_world(camera.view_from_world);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!HasNormal(guides, i)) {
      Set(guides, Layer::kNormal, i, glm::vec3(0.0f));
      continue;
    }
    const glm::dvec3 view = view_from_world * GltfFromBlender(guides.Vec3(Layer::kNormal, i));
    const double length = glm::length(view);
    const bool averaged = std::fabs(length - 1.0) > 1e-5 && std::isfinite(length);  // unit normals keep their digits
    Set(guides, Layer::kNormal, i, glm::vec3(averaged ? view / length : view));
  }
}

// Ids of pass indices.
void NameIndices(std::span<float> ids, std::map<std::uint32_t, std::string>& names) {
  const auto index_of = [](float value) {
    return value > 0.0f && value < 1e9f ? static_cast<std::uint32_t>(value) : 0u;
  };
  std::map<std::uint32_t, std::size_t> place;  // of an index in `texts`
  std::vector<std::string> texts;
  for (const float value : ids) {
    const std::uint32_t index = index_of(value);
    if (index == 0 || !place.try_emplace(index, texts.size()).second) continue;
    texts.push_back("index " + std::to_string(index));
  }
  const std::vector<std::uint32_t> hashed = IdsForNames(texts);
  for (std::size_t n = 0; n < texts.size(); ++n) names[hashed[n]] = texts[n];
  for (float& value : ids) {
    const std::uint32_t index = index_of(value);
    value = index == 0 ? 0.0f : static_cast<float>(hashed[place[index]]);
  }
}

Status NameIds(const BlenderMattes& mattes, const std::string& name, GuideSet& guides) {
  for (const auto& [layer, names] :
       {std::pair{Layer::kObject, &guides.object_names}, {Layer::kMaterial, &guides.material_names}}) {
    if (!guides.Has(layer)) continue;
    const auto matte = mattes.find(layer);
    if (matte == mattes.end())
      NameIndices(guides.Plane(layer), *names);
    else
      SCUMBLE_RETURN_IF_ERROR(
          NameMattes(matte->second.ranks, matte->second.manifest, name, guides.Plane(layer), *names));
  }
  return Ok();
}

// Steps to the pixels within two of one, nearest first.
constexpr std::array<std::pair<int, int>, 24> kNearby = {
    {{0, -1},  {-1, 0}, {1, 0},   {0, 1},  {-1, -1}, {1, -1}, {-1, 1}, {1, 1}, {0, -2},  {-2, 0}, {2, 0},  {0, 2},
     {-1, -2}, {1, -2}, {-2, -1}, {2, -1}, {-2, 1},  {2, 1},  {-1, 2}, {1, 2}, {-2, -2}, {2, -2}, {-2, 2}, {2, 2}}};

// The nearest pixel that has a value, of the same object if there is one. Without any such pixel, the pixel itself.
std::size_t Nearest(const GuideSet& guides, std::size_t i, const std::vector<char>& has) {
  const int x = static_cast<int>(i % guides.width()), y = static_cast<int>(i / guides.width());
  std::size_t other = i;
  for (const auto& [dx, dy] : kNearby) {
    if (x + dx < 0 || y + dy < 0 || x + dx >= guides.width() || y + dy >= guides.height()) continue;
    const std::size_t j = guides.Index(x + dx, y + dy);
    if (!has[j]) continue;
    if (!guides.Has(Layer::kObject) || guides.Plane(Layer::kObject)[j] == guides.Plane(Layer::kObject)[i]) return j;
    if (other == i) other = j;
  }
  return other;
}

// Completes the partly covered pixels.
void FillEdges(GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::vector<char> has_normal(guides.pixel_count()), has_depth(guides.pixel_count());
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const bool covered = coverage[i] > 0.0f;
    has_normal[i] = covered && HasNormal(guides, i);
    has_depth[i] = covered && guides.Has(Layer::kDepth) && HasDepth(guides, i);
  }
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(coverage[i] > 0.0f)) continue;
    if (!has_normal[i]) {
      const std::size_t from = Nearest(guides, i, has_normal);
      Set(guides, Layer::kNormal, i, guides.Vec3(Layer::kNormal, from));
      if (from == i) coverage[i] = 0.0f;
    }
    if (!has_depth[i] && guides.Has(Layer::kDepth)) {
      const std::size_t from = Nearest(guides, i, has_depth);
      guides.Plane(Layer::kDepth)[i] = guides.Plane(Layer::kDepth)[from];
      if (guides.Has(Layer::kPosition)) Set(guides, Layer::kPosition, i, guides.Vec3(Layer::kPosition, from));
    }
  }
}

// Blender's Z is 10^10 where there is nothing.
void ClearDistance(GuideSet& guides) {
  if (!guides.Has(Layer::kDepth)) return;
  for (float& depth : guides.Plane(Layer::kDepth)) {
    if (depth >= kBackgroundDepth) depth = BackgroundValue(Layer::kDepth);
  }
}

// What Cycles averages over a pixel with nothing where nothing is hit: divided by the coverage it is the surface's.
// Shadow catchers are not in these passes.
void UndoCoverage(Layer layer, std::span<const float> catchers, GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (int c = 0; guides.Has(layer) && c < ChannelCount(layer); ++c) {
    const auto plane = guides.Plane(layer, c);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      const bool catches = !catchers.empty() && catchers[i] > 0.0f;
      if (coverage[i] > 0.0f && coverage[i] < 1.0f && !catches) plane[i] /= coverage[i];
    }
  }
}

}  // namespace

Status ConvertBlenderPasses(const std::optional<GuideCamera>& camera, const BlenderMattes& mattes,
                            const BlenderLight& light, const std::string& name, GuideSet& guides) {
  if (guides.Has(Layer::kPosition)) ConvertPositions(guides);
  guides.camera = camera;
  if (!camera) {
    SCUMBLE_ASSIGN(guides.camera, FindCamera(name, guides));
  }
  FindCoverage(mattes, guides);
  std::vector<float> catchers;
  if (guides.Has(Layer::kShadow) && light.count(LightPass::kShadowCatcher)) catchers = CoverCatchers(mattes, guides);
  ConvertNormals(*guides.camera, guides);
  SCUMBLE_RETURN_IF_ERROR(NameIds(mattes, name, guides));
  FillEdges(guides);
  ClearDistance(guides);
  UndoCoverage(Layer::kAlbedo, catchers, guides);
  UndoCoverage(Layer::kUv, catchers, guides);
  ConvertBlenderLight(light, catchers, guides);
  return Ok();
}

std::string BlenderPassesFor(const LayerSet& missing) {
  constexpr std::pair<Layer, const char*> kPasses[] = {{Layer::kCoverage, "Combined"},
                                                       {Layer::kNormal, "Normal"},
                                                       {Layer::kDepth, "Z"},
                                                       {Layer::kObject, "Cryptomatte Object"},
                                                       {Layer::kMaterial, "Cryptomatte Material"},
                                                       {Layer::kPosition, "Position"},
                                                       {Layer::kAlbedo, "Diffuse Color"},
                                                       {Layer::kLuminance, "Diffuse Direct"},
                                                       {Layer::kShadow, "Shadow"},
                                                       {Layer::kUv, "UV"}};
  std::string passes;
  LayerSet left = missing;
  for (const auto& [layer, pass] : kPasses) {
    if (!missing.Has(layer)) continue;
    left.Remove(layer);
    passes += (passes.empty() ? "" : ", ") + std::string(pass);
  }
  std::string text;
  if (!passes.empty()) text += ". In Blender switch on View Layer > Passes > " + passes;
  if (!left.empty()) text += ". No pass of Blender is " + left.ToString() + ": make guides with `scumble guidegen`";
  return text;
}

}  // namespace scumble
