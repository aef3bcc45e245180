// A scene that is cast many times: the bytes equal those of a fresh one, it is built once, and it works after a
// cancelled cast.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "guidegen/guidegen.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

// Every kind of object that Embree's filters handle: single-sided, with holes, emissive, and a ground that reaches far.
// Two objects stand at one place.
Scene MixedScene() {
  Scene scene = SceneOf(CubeMesh(), Moved(-1.2, 0.0, 0.0));
  scene.materials.resize(4);
  scene.materials[1].name = "thin";
  scene.materials[1].double_sided = false;
  scene.materials[2].name = "leaf";
  scene.materials[2].alpha_mode = AlphaMode::kMask;
  scene.materials[3].name = "glow";
  scene.materials[3].emission = glm::vec3(2.0f, 1.5f, 1.0f);
  const auto add = [&](const std::string& name, Mesh mesh, int material, const glm::dmat4& placed) {
    mesh.material = material;
    AddObject(scene, name, std::move(mesh), placed);
  };
  add("ball", BallMesh(24), 1, Moved(1.2, 0.0, 0.0));
  Mesh leaf = QuadMesh();
  leaf.colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};
  add("leaf", leaf, 2, Moved(0.0, 0.5, 1.5));
  add("lamp", QuadMesh(), 3, Moved(0.0, 3.0, 0.0) * glm::rotate(glm::dmat4(1.0), glm::half_pi<double>(), {1, 0, 0}));
  const glm::dmat4 ground = Moved(0, -1, 0) * glm::rotate(glm::dmat4(1.0), -glm::half_pi<double>(), {1, 0, 0}) *
                            glm::scale(glm::dmat4(1.0), glm::dvec3(100.0));
  add("ground", QuadMesh(), 0, ground);
  add("ground again", QuadMesh(), 1, ground);
  scene.lights.push_back(PointLight({2.0, 4.0, 4.0}, 40.0));
  scene.lights.push_back(PointLight({-3.0, 2.0, 3.0}, 20.0));
  scene.lights.back().radius = 0.5;
  return scene;
}

Camera MixedCamera() { return LookingAt({2.0, 1.5, 7.0}, {0.0, 0.0, 0.0}); }

GuidegenOptions Drawn(int width, int height, LayerSet layers, int aa = 1) {
  GuidegenOptions options = Sized(width, height, layers);
  options.aa = aa;
  options.samples = 4;
  return options;
}

// Casts of every kind, in an order in which the needs of the acceleration structure grow.
std::vector<GuidegenOptions> AllCasts() {
  std::vector<GuidegenOptions> casts = {
      Drawn(96, 64, {}),
      Drawn(33, 50, {Layer::kPosition, Layer::kPref, Layer::kAlbedo}, 3),
      Drawn(96, 64, {Layer::kLpeLDE, Layer::kLpeFull}),
      Drawn(70, 40, {Layer::kLuminance, Layer::kShadow}, 2),
      Drawn(96, 64, {}, 4),
      Drawn(64, 64, {Layer::kLuminance, Layer::kLpeFull}),
  };
  GuidegenOptions other = casts.back();
  other.seed = 7;
  other.samples = 3;
  other.threads = 3;
  casts.push_back(other);
  other = casts.front();
  other.normal_frame = NormalFrame::kEye;
  casts.push_back(other);
  return casts;
}

// What must agree beside the planes; times may not.
void ExpectSame(const GuidegenResult& a, const GuidegenResult& b) {
  EXPECT_TRUE(SameBytes(a.guides, b.guides));
  EXPECT_EQ(a.guides.attributes, b.guides.attributes);
  EXPECT_EQ(a.guides.object_names, b.guides.object_names);
  EXPECT_EQ(a.guides.material_names, b.guides.material_names);
  EXPECT_EQ(a.guides.object_styles, b.guides.object_styles);
  EXPECT_EQ(a.rays.primary, b.rays.primary);
  EXPECT_EQ(a.rays.coverage, b.rays.coverage);
  EXPECT_EQ(a.rays.shadow, b.rays.shadow);
  EXPECT_EQ(a.rays.bounce, b.rays.bounce);
  EXPECT_EQ(a.work.filtered_hits, b.work.filtered_hits);
  EXPECT_EQ(a.samples, b.samples);
}

template <class T>
T OrThrow(Expected<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(result).value();
}

RayScene Ready(const Scene& scene, const Camera& camera) { return OrThrow(RayScene::Make(scene, camera)); }

TEST(RayScene, CastsTheBytesOfAFreshScene) {
  const Scene scene = MixedScene();
  for (const std::string isa : {"sse2", "avx", "avx2", ""}) {
    SCOPED_TRACE("isa " + isa);
    const RayScene reused = Ready(scene, MixedCamera());
    for (GuidegenOptions options : AllCasts()) {
      options.isa = isa;
      const GuidegenResult fresh = Render(scene, MixedCamera(), options);
      EXPECT_EQ(fresh.builds, 1);
      ExpectSame(TakeValid(RenderGuides(reused, options)), fresh);
    }
  }
}

TEST(RayScene, BuildsOnceUntilMoreIsNeeded) {
  const Scene scene = MixedScene();
  const RayScene reused = Ready(scene, MixedCamera());
  const auto builds = [&](const GuidegenOptions& options) {
    const GuidegenResult result = TakeValid(RenderGuides(reused, options));
    EXPECT_EQ(result.build_ms > 0.0, result.builds > 0);
    return result.builds;
  };
  EXPECT_EQ(builds(Drawn(32, 32, {})), 1);
  EXPECT_EQ(builds(Drawn(48, 20, {Layer::kPosition}, 2)), 0);
  EXPECT_EQ(builds(Drawn(32, 32, {Layer::kLuminance})), 1) << "light is asked for";
  EXPECT_EQ(builds(Drawn(32, 32, {Layer::kLpeFull})), 0);
  EXPECT_EQ(builds(Drawn(32, 32, {})), 0);
  EXPECT_EQ(builds(Drawn(32, 32, {Layer::kShadow})), 0);
  GuidegenOptions other = Drawn(32, 32, {});
  other.isa = "sse2";
  EXPECT_EQ(builds(other), 1);
  EXPECT_EQ(builds(other), 0);
  other.robust = false;
  EXPECT_EQ(builds(other), 1);
  other.layers = {Layer::kLuminance};
  EXPECT_EQ(builds(other), 0) << "light has been asked for before";
}

TEST(RayScene, SeesLightsAndStylesThatChangeBetweenCasts) {
  Scene scene = MixedScene();
  const RayScene reused = Ready(scene, MixedCamera());
  const GuidegenOptions options = Drawn(48, 32, {Layer::kLuminance});
  (void)TakeValid(RenderGuides(reused, options));
  scene.lights.front().intensity = 3.0;
  scene.lights.pop_back();
  scene.world_radiance = glm::vec3(0.25f);
  scene.instances.front().style = "ink";
  const GuidegenResult result = TakeValid(RenderGuides(reused, options));
  EXPECT_EQ(result.builds, 0);
  ExpectSame(result, Render(scene, MixedCamera(), options));
}

TEST(RayScene, CastsMotion) {
  const Scene scene = MixedScene();
  Scene later = scene;
  later.instances.front().world_from_object = Moved(-1.0, 0.2, 0.0);
  const Camera camera = MixedCamera();
  const NextFrame next{later, camera};
  const RayScene reused = Ready(scene, camera);
  const GuidegenOptions options = Drawn(48, 32, {Layer::kMotion});
  EXPECT_EQ(RenderGuides(reused, options).error().kind, ErrorKind::kUnavailable);
  ExpectSame(TakeValid(RenderGuides(reused, next, options)), TakeValid(RenderGuides(scene, camera, next, options)));
}

// Exporters merge vertices of equal normals and sort the others by normal: both may differ between frames.
TEST(RayScene, MotionFollowsTrianglesWhateverTheirVerticesAreCalled) {
  Mesh joint;
  joint.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  joint.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh split = joint, other_diagonal = joint, turned = joint;
  split.positions = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
  split.triangles = {{5, 4, 3}, {2, 0, 1}};
  other_diagonal.triangles = {{0, 1, 3}, {1, 2, 3}};
  turned.triangles = {{0, 1, 2}, {2, 3, 0}};
  const Camera camera = LookingAt({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0});
  const GuidegenOptions options = Drawn(32, 32, {Layer::kMotion});
  const auto middle = [&](const Mesh& now, const Mesh& next) {
    const Scene scene = SceneOf(now), later = SceneOf(next, Moved(0.5, 0.0, 0.0));
    const GuidegenResult result = TakeValid(RenderGuides(scene, camera, {later, camera}, options));
    return result.guides.Plane(Layer::kMotion)[16 * 32 + 16];
  };
  const float moved = middle(joint, joint);
  EXPECT_GT(moved, 1.0f);
  EXPECT_FLOAT_EQ(middle(joint, split), moved);
  EXPECT_FLOAT_EQ(middle(split, joint), moved);
  EXPECT_EQ(middle(joint, other_diagonal), 0.0f);
  EXPECT_EQ(middle(joint, turned), 0.0f);
  split.positions[3].x = 2.0f;  // torn open
  EXPECT_EQ(middle(joint, split), 0.0f);
  joint.rest_positions = joint.positions;
  split.rest_positions = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
  EXPECT_GT(middle(joint, split), 1.0f) << "one place at rest";
  other_diagonal.rest_positions = joint.positions;
  EXPECT_FLOAT_EQ(middle(joint, other_diagonal), moved) << "polygons are cut by the deformed shape";
  other_diagonal.rest_positions[0].x = -9.0f;
  EXPECT_EQ(middle(joint, other_diagonal), 0.0f) << "a corner is gone";
  other_diagonal.rest_positions = joint.positions;
  other_diagonal.rest_positions.push_back(joint.positions[0]);
  other_diagonal.positions.emplace_back(-1, -1, 1);
  EXPECT_EQ(middle(joint, other_diagonal), 0.0f) << "a corner is torn apart";
}

// Each frame is an export of its own, whose meshes are numbered anew.
TEST(RayScene, MotionFollowsAnObjectWhenOthersAppearOrVanish) {
  Mesh square;
  square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh upper = square, lower = square;
  upper.triangles = {{0, 2, 3}};
  lower.triangles = {{0, 1, 2}};
  Scene scene = SceneOf(lower);  // two materials, and so two meshes
  scene.meshes.push_back(upper);
  scene.instances.push_back(scene.instances.front());
  scene.instances.back().mesh = 1;
  Scene more = scene;
  more.meshes.insert(more.meshes.begin(), square);
  for (Instance& instance : more.instances) ++instance.mesh;
  more.instances.insert(more.instances.begin(), {"other", 0, Moved(0.0, 0.0, -9.0)});
  const auto motion = [&](const Scene& now, Scene next, int column, int row) {
    for (Instance& instance : next.instances) instance.world_from_object *= Moved(0.5, 0.0, 0.0);
    const Camera camera = LookingAt({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0});
    const GuidegenResult result = TakeValid(RenderGuides(now, camera, {next, camera}, Drawn(32, 32, {Layer::kMotion})));
    return result.guides.Plane(Layer::kMotion)[std::size_t(row) * 32 + std::size_t(column)];
  };
  const float moved = motion(scene, scene, 16, 16);
  EXPECT_GT(moved, 1.0f);
  for (const auto& [column, row] : {std::pair(14, 12), std::pair(18, 19)}) {
    EXPECT_FLOAT_EQ(motion(scene, more, column, row), moved);
    EXPECT_FLOAT_EQ(motion(more, scene, column, row), moved);
  }
  more.instances.front().world_from_object = Moved(0.0, 0.0, 1.0);
  EXPECT_EQ(motion(more, scene, 16, 16), 0.0f) << "gone in the next frame";
}

TEST(RayScene, CastsFromSeveralThreadsAtOnce) {
  const Scene scene = MixedScene();
  const RayScene reused = Ready(scene, MixedCamera());
  const std::vector<GuidegenOptions> casts = AllCasts();
  std::vector<GuidegenResult> results(casts.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < casts.size(); ++i) {
    threads.emplace_back([&, i] { results[i] = OrThrow(RenderGuides(reused, casts[i])); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < casts.size(); ++i) ExpectSame(results[i], Render(scene, MixedCamera(), casts[i]));
}

TEST(RayScene, NamesACameraThatSeesNothing) {
  const Scene scene = MixedScene();
  Camera camera = MixedCamera();
  camera.yfov_degrees = 180.0;
  EXPECT_EQ(RayScene::Make(scene, camera).error().kind, ErrorKind::kInput);
}

TEST(RayScene, SurvivesEveryCancelledCast) {
  const Scene scene = MixedScene();
  const RayScene reused = Ready(scene, MixedCamera());
  for (GuidegenOptions options : AllCasts()) {
    const GuidegenResult fresh = Render(scene, MixedCamera(), options);
    for (const int allowed : {0, 1, 2, 3, 5, 8}) {  // calls that say yes
      std::atomic<int> calls{0};
      options.progress = [&](double) { return calls++ < allowed; };
      const auto cancelled = RenderGuides(reused, options);
      EXPECT_EQ(cancelled.ok(), calls <= allowed);
      if (!cancelled) {
        EXPECT_EQ(cancelled.error().kind, ErrorKind::kCancelled);
      }
      options.progress = {};
      ExpectSame(TakeValid(RenderGuides(reused, options)), fresh);
    }
  }
}

TEST(RayScene, SurvivesErrors) {
  const Scene scene = MixedScene();
  const RayScene reused = Ready(scene, MixedCamera());
  GuidegenOptions options = Drawn(32, 32, {});
  for (int i = 0; i < 2; ++i) {
    options.isa = "none";
    EXPECT_EQ(RenderGuides(reused, options).error().kind, ErrorKind::kUsage);
    options.isa = "";
    ExpectSame(TakeValid(RenderGuides(reused, options)), Render(scene, MixedCamera(), options));
  }
}

TEST(RayScene, CanBeCancelledWhileItBuilds) {
  const Scene scene = SceneOf(BallMesh(200));
  const RayScene reused = Ready(scene, FrontCamera(3.0));
  GuidegenOptions options = Sized(32, 32);
  std::vector<double> shares;
  options.progress = [&](double share) {
    shares.push_back(share);
    return shares.size() < 2;
  };
  for (int i = 0; i < 2; ++i) {
    shares.clear();
    EXPECT_EQ(RenderGuides(reused, options).error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(shares, std::vector<double>({0.0, 0.0})) << "the second call comes from the build";
  }
  options.progress = {};
  const GuidegenResult result = TakeValid(RenderGuides(reused, options));
  EXPECT_EQ(result.builds, 1);
  EXPECT_TRUE(SameBytes(result.guides, Render(scene, FrontCamera(3.0), options).guides));
}

TEST(RayScene, CanBeCancelledWhileAnotherThreadBuilds) {
  const Scene scene = SceneOf(BallMesh(200));
  const RayScene reused = Ready(scene, FrontCamera(3.0));
  std::promise<void> builds, cancelled;
  std::thread other([&] {
    GuidegenOptions options = Sized(32, 32);
    int calls = 0;
    options.progress = [&](double) {
      if (++calls != 2) return true;  // the second call comes from the build
      builds.set_value();
      cancelled.get_future().wait();
      return true;
    };
    EXPECT_EQ(TakeValid(RenderGuides(reused, options)).builds, 1);
  });
  builds.get_future().wait();
  GuidegenOptions options = Sized(32, 32);
  int calls = 0;
  options.progress = [&](double) { return ++calls < 3; };
  const auto result = RenderGuides(reused, options);
  cancelled.set_value();
  other.join();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kCancelled);
  options.progress = {};
  EXPECT_EQ(TakeValid(RenderGuides(reused, options)).builds, 0);
}

// One tile of these would take minutes.
TEST(RayScene, CanBeCancelledInsideATile) {
  const Scene scene = MixedScene();
  const RayScene reused = Ready(scene, MixedCamera());
  for (const LayerSet layers : {LayerSet{Layer::kLpeFull}, LayerSet{Layer::kLuminance}}) {
    GuidegenOptions options = Drawn(16, 16, layers);
    const GuidegenResult fresh = Render(scene, MixedCamera(), options);
    for (int i = 0; i < 3; ++i) {
      GuidegenOptions endless = options;
      endless.samples = kMaxSamples;
      std::atomic<bool> stop{false};
      endless.progress = [&](double) { return !stop; };
      std::thread other([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        stop = true;
      });
      const auto cancelled = RenderGuides(reused, endless);
      other.join();
      ASSERT_FALSE(cancelled);
      EXPECT_EQ(cancelled.error().kind, ErrorKind::kCancelled);
      ExpectSame(TakeValid(RenderGuides(reused, options)), fresh);
    }
  }
}

}  // namespace
}  // namespace scumble::testing
