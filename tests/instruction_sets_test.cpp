// Embree traces in float, in another order for each instruction set. What of that shows in the guides: which triangle a
// ray meets where two are within float's sight of it, and whether light reaches a place on a shadow's edge. All else is
// worked out in double from the triangle's number, by code that has the same bits everywhere.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "guidegen/load_scene.h"
#include "tests/exact_rays.h"
#include "tests/guidegen_checks.h"
#include "tests/guidegen_scenes.h"

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

// Of the sets that this machine has.
std::map<std::string, GuideSet> OnEachSet(const Sample& sample, std::span<const char* const> sets) {
  std::map<std::string, GuideSet> guides;
  for (const char* isa : sets) {
    auto result = RenderGuides(sample.scene, sample.camera, Wanted(sample, isa));
    if (result) guides.emplace(isa, std::move(result->guides));
  }
  return guides;
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

// The same bytes for one set, whatever the threads, and so whatever the order of tiles.
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
// between them: a pixel that float could not doubt has the same bits in every layer of the surface. Its light may
// differ where its way to a lamp passes an edge within float's sight: of a pixel's width that is 2^-19 of the distance
// to both sides, so of all pixels no more than that share, though a shadow's edge ran through each of them.
// Returns how many pixels differ.
int ExpectNoOthersToDiffer(const Sample& sample, std::span<const char* const> sets) {
  const std::map<std::string, GuideSet> guides = OnEachSet(sample, sets);
  int all = 0;
  EXPECT_GE(guides.size(), 2u) << "of " << sets.size() << " instruction sets";
  const GuideSet& plain = guides.begin()->second;
  const double pixel = 2.0 * std::tan(glm::radians(sample.camera.yfov_degrees / 2.0)) / sample.height;
  for (const auto& [isa, other] : guides) {
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
        const ExactRay ray = PixelRay(sample.camera, sample.width, sample.height, double(int(i) % sample.width),
                                      double(int(i) / sample.width));
        EXPECT_TRUE(MeetExactly(sample.scene, sample.camera, ray).Undecided())
            << sample.name << ", " << isa << ", pixel " << i;
      }
      all += differs[i] || lit_differs[i];
      others += lit_differs[i] && !differs[i];
    }
    EXPECT_LE(others, std::ldexp(1.0, -19) / pixel * double(size)) << sample.name << ", " << isa;
    std::printf("%s, %s against %s, pixels (worst ulps):%s\n", sample.name.c_str(), isa.c_str(),
                guides.begin()->first.c_str(), table.empty() ? " none" : table.c_str());
  }
  return all;
}

TEST(InstructionSets, SampleScenesDifferOnlyWhereFloatMayChoose) {
  for (const char* name : {"ball", "snail", "stilllife", "suzanne", "toys"}) {
    ExpectNoOthersToDiffer(Load(name, 203, 151), kInstructionSets);
  }
}

// Large enough for some pixels to be in doubt: those of AVX2 multiply and add in one rounding.
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

}  // namespace
}  // namespace scumble::testing
