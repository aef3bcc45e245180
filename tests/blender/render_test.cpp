// Guides from renders that a user makes by hand in Blender, through the real Blender: the solved camera against the one
// that Blender had, names and coverage. tests/blender/render_plain.py renders them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "core/io/blender_camera.h"
#include "core/io/channel_file.h"
#include "tests/blender/blender_version.h"
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// Rendered once for all tests; render_plain.py explains the names of the shots.
class Shots : public testing::Environment {
 public:
  void SetUp() override {
    folder_ = new TemporaryFolder;
    const std::string log = (*folder_ / "log").string();
    const std::string command =
        "blender -b -noaudio --factory-startup -P " SCUMBLE_SOURCE_DIR "/tests/blender/render_plain.py -- --output " +
        folder_->path().string() +
        " --shot landscape-opaque-filtered landscape-clear-filtered landscape-clear-sharp "
        "portrait-shifted-clear-filtered "
        "shifted-clear-sharp ortho-shifted-clear-sharp ortho-opaque-filtered far-clear-sharp landscape-slightdof "
        "landscape-lens landscape-dof landscape-nopos landscape-clear-sharp-lit landscape-clear-sharp-catcher "
        "landscape-clear-filtered-painted landscape-opaque-filtered-painted > " +
        log + " 2>&1";
    std::string text;
    if (std::system(command.c_str()) != 0) {
      std::ifstream stream(log);
      text.assign(std::istreambuf_iterator<char>(stream), {});
      FAIL() << command << "\n" << text;
    }
  }
  void TearDown() override { delete folder_; }
  static fs::path File(const std::string& name) { return *folder_ / name; }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

const auto* const kShots = testing::AddGlobalTestEnvironment(new Shots);

GuideSet Read(const std::string& shot, bool with_camera, const LayerSet& more = {}) {
  GuideReadOptions options;
  options.required.Add(more);
  options.required.Add(Layer::kPosition).Remove(Layer::kMaterial);
  options.optional = {Layer::kMaterial};
  if (with_camera) options.blender_camera = Shots::File(shot + ".camera");
  auto guides = ReadGuides(Shots::File(shot + ".exr"), options);
  EXPECT_TRUE(guides) << guides.error().message;
  return guides ? std::move(*guides) : GuideSet(1, 1);
}

glm::dvec2 Project(const GuideSet& guides, const GuideCamera& camera, glm::dvec3 world) {
  const glm::dvec4 clip = camera.clip_from_view * camera.view_from_world * glm::dvec4(world, 1.0);
  return {0.5 * guides.width() * (1.0 + clip.x / clip.w), 0.5 * guides.height() * (1.0 - clip.y / clip.w)};
}

TEST(BlenderRender, TheSolvedCameraIsBlendersOwn) {
  for (const char* shot :
       {"landscape-opaque-filtered", "landscape-clear-sharp", "portrait-shifted-clear-filtered", "shifted-clear-sharp",
        "ortho-shifted-clear-sharp", "ortho-opaque-filtered", "far-clear-sharp"}) {
    const GuideSet solved = Read(shot, false), told = Read(shot, true);
    ASSERT_EQ(solved.pixel_count(), told.pixel_count());
    double angle = 0.0, pixels = 0.0;
    std::size_t covered = 0;
    for (std::size_t i = 0; i < solved.pixel_count(); ++i) {
      if (!(solved.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      ++covered;
      const glm::dvec3 a = glm::normalize(glm::dvec3(solved.Vec3(Layer::kNormal, i)));
      const glm::dvec3 b = glm::normalize(glm::dvec3(told.Vec3(Layer::kNormal, i)));
      angle = std::max(angle, std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 57.29577951308232);
      const glm::dvec3 world(solved.Vec3(Layer::kPosition, i));
      pixels =
          std::max(pixels, glm::length(Project(solved, *solved.camera, world) - Project(solved, *told.camera, world)));
    }
    EXPECT_GT(covered, 10000u) << shot;
    EXPECT_LT(angle, 0.01) << shot;
    EXPECT_LT(pixels, 0.01) << shot;
  }
}

// A circle of confusion below a pixel scatters positions and still determines the camera.
TEST(BlenderRender, ALittleDepthOfFieldIsNoHindrance) {
  const GuideSet solved = Read("landscape-slightdof", false);
  const auto told = ReadBlenderCamera(Shots::File("landscape-slightdof.camera"));
  ASSERT_TRUE(told) << told.error().message;
  ASSERT_TRUE(solved.camera);
  const glm::dmat3 turn(solved.camera->view_from_world * glm::inverse(told->view_from_world));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(turn[k][k], 1.0, 1e-7) << "0.03° at most";
}

TEST(BlenderRender, NamesAreThoseOfTheScene) {
  for (const char* shot : {"landscape-opaque-filtered", "landscape-clear-sharp"}) {
    const GuideSet guides = Read(shot, false);
    std::set<std::string> names;
    for (const auto& [id, name] : guides.object_names) names.insert(name);
    EXPECT_EQ(names, (std::set<std::string>{"Ball", "Floor", "The \"ring\""})) << shot;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const bool covered = guides.Plane(Layer::kCoverage)[i] > 0.0f;
      const auto id = static_cast<std::uint32_t>(guides.Plane(Layer::kObject)[i]);
      ASSERT_EQ(covered, guides.object_names.count(id) == 1) << shot << " at " << i;
    }
  }
  const GuideSet sharp = Read("landscape-clear-sharp", false);
  ASSERT_EQ(sharp.material_names.size(), 1u);
  EXPECT_EQ(sharp.material_names.begin()->second, "Red \"paint\"");
}

GuideSet ReadLit(const std::string& shot, const LayerSet& light) {
  GuideReadOptions options;
  options.required.Remove(Layer::kMaterial).Add(light);
  const auto guides = ReadGuides(Shots::File(shot + ".exr"), options);
  EXPECT_TRUE(guides) << guides.error().message;
  return guides ? *guides : GuideSet(1, 1);
}

// The direction to the sun of render_plain.py, turned by 0.6 about x and then 0.3 about y, in glTF's world; its
// strength is 2, and its colour's luminance 0.2126 · 1 + 0.7152 · 0.5 + 0.0722 · 0.25.
const glm::dvec3 kToSun(std::sin(0.3) * std::cos(0.6), std::cos(0.3) * std::cos(0.6), std::sin(0.6));
constexpr double kSunOnWhite = 2.0 * 0.588250 / 3.14159265358979323846;

double Facing(const GuideSet& guides, std::size_t i) {
  const glm::dmat3 world_from_view = glm::transpose(glm::dmat3(guides.camera->view_from_world));
  return glm::dot(world_from_view * glm::dvec3(guides.Vec3(Layer::kNormal, i)), kToSun);
}

// Cycles of Blender 4 has no Shadow pass.
LayerSet LitLayers() {
  return IsBlender4() ? LayerSet{Layer::kLuminance} : LayerSet{Layer::kLuminance, Layer::kShadow};
}

// The pass, or what is missing of the sun's light.
double ShadowOf(const GuideSet& guides, std::size_t i) {
  if (guides.Has(Layer::kShadow)) return guides.Plane(Layer::kShadow)[i];
  const double facing = Facing(guides, i);
  return facing > 0.0 ? 1.0 - guides.Plane(Layer::kLuminance)[i] / (facing * kSunOnWhite) : 1.0;
}

// Under one hard lamp the light is what the formula says, times what the shadow leaves of it.
TEST(BlenderRender, LightIsThatOfTheFormula) {
  const GuideSet guides = ReadLit("landscape-clear-sharp-lit", LitLayers());
  std::size_t compared = 0, shadowed = 0, wrong = 0, away = 0;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (guides.Plane(Layer::kCoverage)[i] < 1.0f) continue;
    const double facing = Facing(guides, i);
    const double luminance = guides.Plane(Layer::kLuminance)[i], shadow = ShadowOf(guides, i);
    if (std::fabs(facing) < 0.1) continue;  // smooth normals and flat triangles disagree about what faces the sun
    ++compared;
    shadowed += facing > 0.0 && shadow > 0.99;
    away += facing < 0.0 && (shadow < 0.99 || luminance > 1e-4);
    wrong += facing > 0.0 && (std::fabs(luminance - (1.0 - shadow) * facing * kSunOnWhite) > 2e-3 ||
                              std::min(std::fabs(shadow), std::fabs(1.0 - shadow)) > 0.05);
  }
  EXPECT_GT(compared, 10000u);
  EXPECT_GT(shadowed, 500u);
  EXPECT_LE(wrong, compared / 500);
  EXPECT_EQ(away, 0u) << "what no lamp faces has no light, and counts as shadowed";
}

// A catcher's shadows are those that the same floor has as an object, but for the light that other things throw on it.
TEST(BlenderRender, AShadowCatcherIsCoveredAndShadowed) {
  const GuideSet floor = ReadLit("landscape-clear-sharp-lit", LitLayers());
  const GuideSet caught = ReadLit("landscape-clear-sharp-catcher", {Layer::kShadow});
  std::size_t compared = 0, dark = 0;
  double difference = 0.0;
  for (std::size_t i = 0; i < floor.pixel_count(); ++i) {
    ASSERT_NEAR(floor.Plane(Layer::kCoverage)[i], caught.Plane(Layer::kCoverage)[i], 1e-4f) << i;
    const auto name = floor.object_names.find(IdOf(floor.Plane(Layer::kObject)[i]));
    ASSERT_EQ(floor.Plane(Layer::kObject)[i], caught.Plane(Layer::kObject)[i]) << i;
    if (floor.Plane(Layer::kCoverage)[i] < 1.0f) continue;
    if (name->second != "Floor") {
      ASSERT_EQ(caught.Plane(Layer::kShadow)[i], 0.0f) << i << ": nothing says what falls on objects";
      continue;
    }
    ++compared, dark += caught.Plane(Layer::kShadow)[i] > 0.8f;
    difference += std::fabs(ShadowOf(floor, i) - caught.Plane(Layer::kShadow)[i]);
  }
  EXPECT_GT(compared, 5000u);
  EXPECT_GT(dark, 300u);
  EXPECT_LT(difference / double(compared), 0.05);
}

// An opaque film's alpha is 1 everywhere; Cryptomatte has the coverage of a transparent film.
TEST(BlenderRender, CoverageIsThatOfATransparentFilm) {
  const GuideSet opaque = Read("landscape-opaque-filtered", false), clear = Read("landscape-clear-filtered", false);
  std::size_t partial = 0;
  for (std::size_t i = 0; i < opaque.pixel_count(); ++i) {
    const float a = opaque.Plane(Layer::kCoverage)[i], b = clear.Plane(Layer::kCoverage)[i];
    ASSERT_NEAR(a, b, 1e-4f) << i;
    partial += a > 0.0f && a < 1.0f;
    ASSERT_EQ(a > 0.0f, opaque.Plane(Layer::kDepth)[i] < 100.0f) << "an edge has the depth of what it is the edge of";
  }
  EXPECT_GT(partial, 100u);
}

// Cycles averages base colours and UV over a pixel with zeros where it sees nothing; a silhouette is no darker for
// that.
TEST(BlenderRender, ColoursOfSilhouettesAreThoseOfTheirSurfaces) {
  for (const char* shot : {"landscape-clear-filtered-painted", "landscape-opaque-filtered-painted"}) {
    SCOPED_TRACE(shot);
    const GuideSet guides = Read(shot, false, {Layer::kAlbedo, Layer::kUv});
    std::size_t partial = 0;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const float coverage = guides.Plane(Layer::kCoverage)[i];
      if (!(coverage > 0.01f)) continue;
      partial += coverage < 0.99f;
      const glm::vec3 albedo = guides.Vec3(Layer::kAlbedo, i);
      ASSERT_NEAR(albedo.r, 0.4f, 1e-3f) << coverage;
      ASSERT_NEAR(albedo.g, 0.2f, 1e-3f) << coverage;
      ASSERT_NEAR(albedo.b, 0.1f, 1e-3f) << coverage;
      ASSERT_NEAR(guides.Plane(Layer::kUv, 0)[i], 0.3f, 1e-3f) << coverage;
      ASSERT_NEAR(guides.Plane(Layer::kUv, 1)[i], 0.7f, 1e-3f) << coverage;
    }
    EXPECT_GT(partial, 100u);
  }
}

// Blender's compositor shows our guides under their names, ids as numbers and as Cryptomatte.
class BlenderCompositor : public CliTest {};

TEST_F(BlenderCompositor, ShowsOurGuidesAndTheirMattes) {
  GuideSet guides = Ball(48);
  guides.attributes["scumble:generator"] = "test";
  const std::vector<std::string> names = {"The \"ring\"", "Back\\slash β"};
  const std::vector<std::uint32_t> ids = IdsForNames(names);
  guides.object_names = {{ids[0], names[0]}, {ids[1], names[1]}};
  guides.material_names = {{5, "Red \"paint\""}};
  for (const LayerInfo& info : AllLayers()) guides.Add(info.layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const bool covered = guides.Plane(Layer::kCoverage)[i] > 0.0f;
    if (covered && i % 3 == 0) guides.Plane(Layer::kCoverage)[i] = 0.25f;
    guides.Plane(Layer::kObject)[i] = covered ? float(ids[i % 48 < 20 ? 0 : 1]) : 0.0f;
    guides.Plane(Layer::kMaterial)[i] = covered && i > 600 ? 5.0f : 0.0f;
  }
  GuideWriteOptions options;
  options.cryptomatte = true;
  ASSERT_TRUE(WriteGuides(At("g.exr"), guides, options));
  const std::string command = "blender -b -noaudio --factory-startup -P " SCUMBLE_SOURCE_DIR
                              "/tests/blender/read_guides.py -- --input " +
                              At("g.exr").string() + " --output " + Work().string() +
                              " --matte 'CryptoObject:The \"ring\"' 'CryptoObject:Back\\slash β' "
                              "'CryptoMaterial:Red \"paint\"' 'CryptoObject:Nobody' > " +
                              At("log").string() + " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << Bytes("log");
  const auto json = nlohmann::json::parse(Bytes("read.json"), nullptr, false);
  const auto passes = json.at("passes").get<std::vector<std::string>>();
  for (const LayerInfo& info : AllLayers()) {
    if (LayerSet{Layer::kCoverage, Layer::kObject, Layer::kMaterial}.Has(info.layer)) continue;
    EXPECT_EQ(std::count(passes.begin(), passes.end(), info.name), 1) << info.name << " " << json;
  }
  const auto read = ReadChannels(At("read0001.exr"));
  ASSERT_TRUE(read) << read.error().message;
  const auto plane = [&](const std::string& name) {
    const std::vector<float>* const found = read->Find(name);
    EXPECT_TRUE(found) << name << ": " << testing::PrintToString(read->names);
    return found ? *found : std::vector<float>(guides.pixel_count());
  };
  const auto expect_matte = [&](const std::string& matte, Layer layer, std::uint32_t id) {
    const auto found = plane(matte);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool is = id != 0 && guides.Plane(layer)[i] == float(id);
      ASSERT_EQ(found[i], is ? guides.Plane(Layer::kCoverage)[i] : 0.0f) << matte << " at " << i;
    }
  };
  expect_matte("matte0.V", Layer::kObject, ids[0]);
  expect_matte("matte1.V", Layer::kObject, ids[1]);
  expect_matte("matte2.V", Layer::kMaterial, 5);
  expect_matte("matte3.V", Layer::kObject, 0);
  for (const Layer layer : {Layer::kObject, Layer::kMaterial}) {
    const auto found = std::find(passes.begin(), passes.end(), std::string(Info(layer).name) + "_id");
    ASSERT_NE(found, passes.end());
    const auto shown = plane("pass" + std::to_string(found - passes.begin()) + ".V");
    EXPECT_TRUE(std::ranges::equal(shown, guides.Plane(layer))) << *found;
  }
}

class BlenderTransfer : public CliTest {};

TEST_F(BlenderTransfer, APlainRenderBecomesAPicture) {
  RunOk({"transfer", Shots::File("landscape-opaque-filtered.exr"), "--style", "oil", "-o", "a.png"});
  RunOk({"transfer", Shots::File("landscape-opaque-filtered.exr"), "--style", "oil", "-o", "b.png", "--camera",
         Shots::File("landscape-opaque-filtered.camera")});
  // Cameras that differ in the seventh digit settle a few pixels on another chunk.
  RunOk({"compare", "a.png", "b.png", "--fail", "0.02", "--failpercent", "2"});
  // Several lights, and a catcher; what is missing is named as Blender's menus name it.
  const std::string lit = Shots::File("landscape-clear-sharp-lit.exr");
  RunOk({"transfer", lit, "--style", "chiaroscuro", "-o", "l.png"});
  RunOk({"transfer", lit, "--style", "chiaroscuro", "--light-layer", "ViewLayer", "-o", "m.png"});
  EXPECT_EQ(Pixels("l.png"), Pixels("m.png"));
  const Arguments caught = {"--style", "oil",  "--assign", "Floor=catcher", "--set", "transfer.shadow=paint",
                            "-o",      "s.png"};
  RunOk(With({"transfer", Shots::File("landscape-clear-sharp-catcher.exr")}, caught));
  const std::string dark = Shots::File("landscape-clear-sharp.exr");
  ExpectError({"transfer", dark, "--style", "chiaroscuro", "-o", "c.png"}, 3,
              {"has no layer luminance", "View Layer > Passes > Diffuse Direct"});
  ExpectError(With({"transfer", dark}, caught), 3, {"has no layer shadow", "View Layer > Passes > Shadow"});
  ExpectError({"transfer", lit, "--style", "chiaroscuro", "--light-layer", "Clay", "-o", "c.png"}, 3,
              {"no view layer 'Clay' with passes of light; there are 'ViewLayer'"});
  WriteGuideFile("own.exr", Ball(32));
  ExpectError({"transfer", "own.exr", "--style", "oil", "--light-layer", "Clay", "-o", "c.png"}, 3,
              {"no Blender render", "--light-layer"});
  ExpectError({"transfer", lit, "--style", "oil", "--light-layer", "", "-o", "c.png"}, 2, {"--light-layer"});
  ExpectError({"transfer", Shots::File("landscape-nopos.exr"), "--style", "oil", "-o", "c.png"}, 3,
              {"landscape-nopos.exr", "pass Position", "--camera FILE"});
  ExpectError({"transfer", Shots::File("landscape-lens.exr"), "--style", "oil", "-o", "c.png"}, 3,
              {"landscape-lens.exr", "not planar", "panoramic", "--camera FILE"});
  ExpectError({"transfer", Shots::File("landscape-dof.exr"), "--style", "oil", "-o", "c.png"}, 3,
              {"landscape-dof.exr", "depth of field", "--camera FILE"});
}

}  // namespace
}  // namespace scumble
