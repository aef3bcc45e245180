// Embree traces in float, in another order for each instruction set. Two effects show in the guides: the triangle that
// a ray hits where two are within float's resolution of it, and whether light reaches a place on a shadow's edge. All
// other values are computed in double from the triangle's number, with equal bits everywhere.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "guidegen/framing.h"
#include "guidegen/load_scene.h"
#include "tests/support/exact_rays.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

constexpr std::array<const char*, 5> kInstructionSets = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
struct Sample {
  std::string name;
  Scene scene;
  Camera camera;
  int width = 0, height = 0;
};

Sample Load(const std::string& name, int width, int height) {
  auto scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/" + name + ".glb");
  if (!scene) throw std::runtime_error(scene.error().message);
  const auto view = PrepareView(*scene, "", ViewAngles{35, 25, 0}, double(width) / height, true);
  if (!view) throw std::runtime_error(view.error().message);
  return {name, std::move(*scene), view->camera, width, height};
}

GuidegenOptions Wanted(const Sample& sample, const std::string& isa) {
  GuidegenOptions options = Sized(sample.width, sample.height,
                                  {Layer::kPosition, Layer::kPref, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow});
  options.isa = isa;
  options.samples = 4;
  return options;
}

// Of the sets that this machine has. Each gives valid guides, whatever their differences: no NaN, no length of 0.
std::map<std::string, GuidegenResult> OnEachSet(const Sample& sample, GuidegenOptions options,
                                                std::span<const char* const> sets) {
  std::map<std::string, GuidegenResult> results;
  for (const char* isa : sets) {
    options.isa = isa;
    auto result = RenderGuides(sample.scene, sample.camera, options);
    if (result) results.emplace(isa, TakeValid(std::move(result)));
  }
  EXPECT_GE(results.size(), 2u) << "of " << sets.size() << " instruction sets";
  return results;
}

// Floats between two, 0 and −0 being one.
std::int64_t Ulps(float a, float b) {
  const auto place = [](float v) {
    std::int32_t bits;
    std::memcpy(&bits, &v, sizeof(bits));
    return bits < 0 ? -std::int64_t(bits & 0x7fffffff) : std::int64_t(bits);
  };
  return std::abs(place(a) - place(b));
}

struct Difference {
  int pixels = 0;
  std::int64_t ulps = 0;  // the worst
};

Difference Compare(const GuideSet& a, const GuideSet& b, Layer layer, std::vector<bool>& differs) {
  Difference difference;
  for (std::size_t i = 0; i < differs.size(); ++i) {
    std::int64_t worst = 0;
    for (int c = 0; c < ChannelCount(layer); ++c) {
      worst = std::max(worst, Ulps(a.Plane(layer, c)[i], b.Plane(layer, c)[i]));
    }
    if (worst == 0) continue;
    ++difference.pixels;
    difference.ulps = std::max(difference.ulps, worst);
    differs[i] = true;
  }
  return difference;
}

// The same bytes for one set, for any threads, and so for any order of tiles.
TEST(InstructionSets, OneSetGivesTheSameBytesForAnyThreads) {
  const Sample sample = Load("stilllife", 203, 151);
  int sets = 0;
  for (const char* isa : kInstructionSets) {
    GuidegenOptions options = Wanted(sample, isa);
    options.layers.Add(Layer::kLpeFull);
    options.aa = 2;
    options.threads = 1;
    const auto one = RenderGuides(sample.scene, sample.camera, options);
    if (!one) continue;
    ++sets;
    EXPECT_EQ(one->guides.attributes.at("scumble:isa"), isa);
    for (const int threads : {2, 3, 7}) {
      options.threads = threads;
      EXPECT_TRUE(SameBytes(one->guides, Render(sample.scene, sample.camera, options).guides))
          << isa << ", " << threads << " threads";
    }
  }
  EXPECT_GT(sets, 1);
}

// Between two sets a pixel may differ in what it shows only where the exact ray is within float's sight of an edge or
// of another surface (exact_rays.h derives how near that is). Where they meet the same triangle there is not one ulp
// between them: a pixel that float could not doubt has the same bits in every layer of the surface. Where it could,
// each of the two shows a place on the pixel's ray, to float's sight, with a unit normal. Its light may differ where
// its way to a light passes an edge within float's sight: of a pixel's width that is 2^-19 of the distance to both
// sides, so of all pixels no more than that share, though a shadow's edge ran through each of them. Returns how many
// pixels differ.
int ExpectNoOthersToDiffer(const Sample& sample, std::span<const char* const> sets) {
  const std::map<std::string, GuidegenResult> results = OnEachSet(sample, Wanted(sample, ""), sets);
  int all = 0;
  const GuideSet& plain = results.begin()->second.guides;
  const double pixel = 2.0 * std::tan(glm::radians(sample.camera.yfov_degrees / 2.0)) / sample.height;
  for (const auto& [isa, result] : results) {
    const GuideSet& other = result.guides;
    if (&other == &plain) continue;
    const auto size = std::size_t(sample.width) * std::size_t(sample.height);
    std::vector<bool> differs(size), lit_differs(size);
    std::string table;
    for (const Layer layer : {Layer::kCoverage, Layer::kObject, Layer::kMaterial, Layer::kNormal, Layer::kDepth,
                              Layer::kPosition, Layer::kPref, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow}) {
      const bool of_light = layer == Layer::kLuminance || layer == Layer::kShadow;
      const Difference found = Compare(plain, other, layer, of_light ? lit_differs : differs);
      if (found.pixels == 0) continue;
      table += " " + LayerSet{layer}.ToString() + " " + std::to_string(found.pixels) + " (" +
               std::to_string(found.ulps) + ")";
    }
    int others = 0;
    for (std::size_t i = 0; i < size; ++i) {
      if (differs[i]) {
        SCOPED_TRACE(sample.name + ", " + isa + ", pixel " + std::to_string(i));
        const ExactRay ray = PixelRay(sample.camera, sample.width, sample.height, double(int(i) % sample.width),
                                      double(int(i) / sample.width));
        const ExactHit hit = MeetExactly(sample.scene, sample.camera, ray);
        EXPECT_TRUE(hit.Undecided());
        for (const GuideSet* guides : {&plain, &other}) ExpectOnRay(sample.camera, *guides, i, ray, hit);
      }
      all += differs[i] || lit_differs[i];
      others += lit_differs[i] && !differs[i];
    }
    EXPECT_LE(others, std::ldexp(1.0, -19) / pixel * double(size)) << sample.name << ", " << isa;
    std::printf("%s, %s against %s, pixels (worst ulps):%s\n", sample.name.c_str(), isa.c_str(),
                results.begin()->first.c_str(), table.empty() ? " none" : table.c_str());
  }
  return all;
}

TEST(InstructionSets, SampleScenesDifferOnlyWhereFloatMayChoose) {
  for (const char* name : {"ball", "snail", "stilllife", "suzanne", "toys"}) {
    ExpectNoOthersToDiffer(Load(name, 203, 151), kInstructionSets);
  }
}

// Large enough that some pixels are ambiguous: those of AVX2 multiply and add in one rounding.
TEST(InstructionSets, LargePicturesDifferOnlyWhereFloatMayChoose) {
  constexpr std::array<const char*, 2> kMostUnlike = {"sse2", "avx2"};
  for (const char* name : {"snail", "stilllife"}) {
    EXPECT_GT(ExpectNoOthersToDiffer(Load(name, 1280, 720), kMostUnlike), 0) << name;
  }
}

// Rays laid along the very edges show that the test above can fail: there the sets do disagree, and only there.
TEST(InstructionSets, RaysAlongEdgesAreWhereTheyDisagree) {
  // A board of squares, each its own object, before a camera that is turned with it. Pixels' centres are odd sixteenths
  // of a metre; the camera is moved by one, which puts every eighth row and column on edges.
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(0.2, 0.3, 1.0));
  Scene scene = SceneOf(QuadMesh(), Moved(-50, -50, 0));
  for (int i = 0; i < 64; ++i) {
    AddObject(scene, "square" + std::to_string(i), QuadMesh(),
              turned * glm::scale(Moved(i % 8 - 3.5, i / 8 - 3.5, 0), glm::dvec3(0.5)));
  }
  Camera camera = FlatCamera(3.0, 4.0);
  camera.world_from_camera = turned * Moved(1.0 / 16.0, 1.0 / 16.0, 3.0);
  std::map<std::string, GuideSet> guides;
  for (const char* isa : kInstructionSets) {
    GuidegenOptions options = Sized(64, 64);
    options.isa = isa;
    auto result = RenderGuides(scene, camera, options);
    if (result) guides.emplace(isa, std::move(result->guides));
  }
  ASSERT_GE(guides.size(), 2u);
  const GuideSet& plain = guides.begin()->second;
  int disagreed = 0;
  for (const auto& [isa, other] : guides) {
    for (int i = 0; i < 64 * 64; ++i) {
      const ExactHit hit = MeetExactly(scene, camera, PixelRay(camera, 64, 64, i % 64, i / 64));
      const bool same = plain.Plane(Layer::kObject)[std::size_t(i)] == other.Plane(Layer::kObject)[std::size_t(i)];
      disagreed += !same;
      EXPECT_TRUE(same || hit.Undecided()) << isa << ", pixel " << i;
    }
  }
  std::printf("a board seen along its edges: %d of %d pixels with another object\n", disagreed,
              int(guides.size() - 1) * 64 * 64);
  EXPECT_GT(disagreed, 0);
}

// An open room of 2 m, with a cube and a light with extent in it, seen through the missing wall, with sky around.
Sample OpenRoom() {
  Mesh walls = CubeMesh();
  walls.triangles.resize(walls.triangles.size() - 2);  // the wall at +Z is the last
  Scene scene = SceneOf(walls);
  scene.materials[0] = Painted(Bsdf::kMetallicRoughness, 0.5f, 0.4f);
  AddObject(scene, "cube", CubeMesh(),
            glm::scale(glm::rotate(Moved(0.2, -0.4, -0.3), 0.7, glm::dvec3(0.3, 1, 0.2)), glm::dvec3(0.3)));
  scene.lights = {PointLight({-0.4, 0.5, 0.1}, 2.0)};
  scene.lights[0].radius = 0.1;
  scene.world_radiance = glm::vec3(0.1f);
  return {"room", std::move(scene), LookingAt({0.3, 0.4, 4}, {0, 0, 0}, 50.0), 48, 36};
}

// The share of the rays of light in that room that float may doubt. Lines that are spread evenly, as those of diffuse
// light in a room are, meet a convex body in it as often as its surface is of the room's (Crofton): within float's
// sight of an edge they pass as often as the edge's tube is of the 24 m². What is missing of a wall, and rays that end
// before, make it fewer. The sum takes the edges that two triangles share twice. Rays do not begin evenly: where the
// eye looks there are more of them, and towards the light. Half a metre from an edge they are 2.4 times as dense as in
// the mean, and nothing is nearer to the light; with the edges that are taken twice, twice the sum allows for four
// times. No bound is as strict as that of the surfaces, where the plain caster tells pixel by pixel: of a path's
// decisions only the engine knows.
double DoubtfulShare(const Sample& room) {
  double edges = 0.0, farthest = 0.0;
  for (const Instance& instance : room.scene.instances) {
    const Mesh& mesh = room.scene.meshes[std::size_t(instance.mesh)];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto c = CornersFromEye(room.scene, room.camera, instance, t);
      for (std::size_t k = 0; k < 3; ++k) {
        edges += glm::distance(c[k], c[(k + 1) % 3]);
        farthest = std::max(farthest, glm::length(c[k]));
      }
    }
  }
  return 2.0 * edges * 2.0 * kPi * farthest * kFloatSight / 24.0;
}

// How many rays of a pixel, through its centre and through its 2 × 2 subsamples, are float's to decide.
int DoubtfulRays(const Sample& sample, int pixel) {
  int doubtful = 0;
  for (const glm::dvec2 offset : {glm::dvec2(0.0), {-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}) {
    const ExactRay ray = PixelRay(sample.camera, sample.width, sample.height, pixel % sample.width + offset.x,
                                  pixel / sample.width + offset.y);
    doubtful += MeetExactly(sample.scene, sample.camera, ray).Undecided();
  }
  return doubtful;
}

// Subsamples and paths. A pixel's coverage differs by no more subsamples than float may decide of it, and its surface
// only where there is one. Paths are drawn by the same numbers, so a pixel's light differs only where one of the rays
// that made it was decided otherwise: there are no more such pixels than rays in doubt, whose number, as that of any
// rare events, has its root for a deviation; five are allowed.
TEST(InstructionSets, SubsamplesAndPathsDifferOnlyByTheirDecisions) {
  const Sample room = OpenRoom();
  GuidegenOptions options = Wanted(room, "");
  options.layers.Add(kAllPaths);
  options.aa = 2;
  options.samples = 2;
  const std::map<std::string, GuidegenResult> results = OnEachSet(room, options, kInstructionSets);
  const GuidegenResult& plain = results.begin()->second;
  for (const Layer layer : {Layer::kLpeFull, Layer::kLpeLSE, Layer::kLpeLDDE}) EXPECT_GT(Mean(plain, layer), 0.0);
  const double doubtful = double(plain.rays.shadow + plain.rays.bounce) * DoubtfulShare(room);
  for (const auto& [isa, other] : results) {
    std::vector<bool> differs(plain.guides.pixel_count()), lit_differs(differs.size());
    for (const LayerInfo& info : AllLayers()) {
      if (!plain.guides.Has(info.layer)) continue;
      const bool of_light = info.is_color && info.layer != Layer::kAlbedo;
      Compare(plain.guides, other.guides, info.layer, of_light ? lit_differs : differs);
    }
    int lit = 0;
    for (std::size_t i = 0; i < differs.size(); ++i) {
      lit += lit_differs[i] && !differs[i];
      if (!differs[i]) continue;
      const auto coverage = [&](const GuidegenResult& result) { return result.guides.Plane(Layer::kCoverage)[i]; };
      const int rays = DoubtfulRays(room, int(i));
      EXPECT_GT(rays, 0) << isa << ", pixel " << i;
      EXPECT_LE(4.0f * std::abs(coverage(plain) - coverage(other)), float(rays)) << isa << ", pixel " << i;
    }
    EXPECT_LE(lit, doubtful + 5.0 * std::sqrt(doubtful) + 1.0) << isa;
    std::printf("room, %s against %s: light of %d of %d pixels differs; of %zu rays %.1f may be in doubt\n",
                isa.c_str(), results.begin()->first.c_str(), lit, int(differs.size()),
                plain.rays.shadow + plain.rays.bounce, doubtful);
  }
}

}  // namespace
}  // namespace scumble::testing
