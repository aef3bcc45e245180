// A workspace pays for what changed and nothing else, and paints what `scumble stylize` paints.
#include "pipeline/workspace.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/io/format_dispatch.h"
#include "pipeline/file_stamp.h"
#include "scumble/stylizer.h"
#include "tests/pipeline/workspace_fixtures.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

TEST(Workspace, PaintsWhatTheProgramPaints) {
  Workspace workspace(Context());
  const std::string scenes = kSource + "/scenes/";
  EXPECT_EQ(Painted(workspace, SceneOf("suzanne"), StyleOf("oil")).rgba,
            Stylized(scenes + "suzanne.glb --style oil --size 96x54").rgba);
  // A style that looks at light, and its measured exposure.
  EXPECT_EQ(Painted(workspace, SceneOf("suzanne"), StyleOf("chiaroscuro")).rgba,
            Stylized(scenes + "suzanne.glb --style chiaroscuro --size 96x54").rgba);
  PictureRequest picture;
  picture.frame = 13, picture.upsample = 2, picture.seed = 7;
  EXPECT_EQ(Painted(workspace, SceneOf("toys"), StyleOf("pastel", {"transfer.scale=0.5"}), picture).rgba,
            Stylized(scenes + "toys.glb --style pastel --set transfer.scale=0.5 --size 96x54 --frame 13 --upsample 2 "
                              "--seed 7")
                .rgba);
}

// What finishing effects measure is measured on the guides that are there.
TEST(Workspace, FinishingEffectsAreMeasuredAnewOnNewGuides) {
  Workspace workspace(Context());
  StyleRequest style = StyleOf("oil");
  style.finishes = {"storybook"};
  SceneRequest scene = SceneOf("suzanne");
  Painted(workspace, scene, style);
  const std::string options = kSource + "/scenes/suzanne.glb --style oil --finish storybook --size 96x54 ";
  scene.light = LightAngles{-60.0, 20.0};
  EXPECT_EQ(Painted(workspace, scene, style).rgba, Stylized(options + "--light -60,20").rgba);
  scene.view = ViewAngles{70.0, 10.0, 0.0};
  EXPECT_EQ(Painted(workspace, scene, style).rgba, Stylized(options + "--light -60,20 --view 70,10").rgba);
}

TEST(Workspace, AChangedKeyCastsNoRay) {
  Workspace workspace(Context());
  const Picture before = Painted(workspace, SceneOf("suzanne"), StyleOf("oil"));
  EXPECT_EQ(workspace.counters().guides_cast, 1u);
  EXPECT_EQ(workspace.counters().styles_prepared, 1u);
  // The transfer reads the threshold from the settings: exemplars stay as they are.
  const Picture coarse = Painted(workspace, SceneOf("suzanne"), StyleOf("oil", {"transfer.threshold=0.4"}));
  EXPECT_NE(coarse.rgba, before.rgba);
  EXPECT_EQ(workspace.counters().styles_prepared, 1u);
  // The exemplar's size is prepared.
  const Picture fine = Painted(workspace, SceneOf("suzanne"), StyleOf("oil", {"transfer.scale=0.5"}));
  EXPECT_NE(fine.rgba, before.rgba);
  EXPECT_EQ(workspace.counters().styles_prepared, 2u);
  EXPECT_EQ(workspace.counters().guides_cast, 1u);
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
  EXPECT_EQ(Painted(workspace, SceneOf("suzanne"), StyleOf("oil")).rgba, before.rgba);
  EXPECT_EQ(workspace.counters().styles_loaded, 4u);
  EXPECT_EQ(workspace.counters().pictures_decoded, 2u) << "the painting and the paper";
}

TEST(Workspace, AStyleThatReadsAnotherLayerCastsIt) {
  Workspace workspace(Context());
  Painted(workspace, SceneOf("suzanne"), StyleOf("chiaroscuro"));
  Painted(workspace, SceneOf("suzanne"), StyleOf("oil"));  // reads less: the guides have it
  EXPECT_EQ(workspace.counters().guides_cast, 1u);
  Painted(workspace, SceneOf("suzanne"), StyleOf("tinted-oil"));  // reads base colours
  EXPECT_EQ(workspace.counters().guides_cast, 2u);
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
}

TEST(Workspace, AChangedViewLoadsNoFile) {
  Workspace workspace(Context());
  const Picture before = Painted(workspace, SceneOf("suzanne"), StyleOf("oil"));
  SceneRequest turned = SceneOf("suzanne");
  turned.view = ViewAngles{70.0, 10.0, 0.0};
  EXPECT_NE(Painted(workspace, turned, StyleOf("oil")).rgba, before.rgba);
  SceneRequest larger = turned;
  larger.size = {128, 72};
  EXPECT_EQ(Painted(workspace, larger, StyleOf("oil")).width, 128);
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
  EXPECT_EQ(workspace.counters().styles_loaded, 1u);
  EXPECT_EQ(workspace.counters().guides_cast, 3u);
  EXPECT_EQ(Painted(workspace, SceneOf("suzanne"), StyleOf("oil")).rgba, before.rgba);
}

TEST(Workspace, AnotherSizeOrSeedBuildsNoAccelerationStructure) {
  Workspace workspace(Context());
  SceneRequest scene = SceneOf("ball");
  const Picture small = Painted(workspace, scene, StyleOf("chiaroscuro"));
  EXPECT_EQ(workspace.counters().structures_built, 1u);
  PictureRequest picture;
  picture.seed = 5;
  EXPECT_NE(Painted(workspace, scene, StyleOf("chiaroscuro"), picture).rgba, small.rgba);
  scene.size = {192, 108};
  const Picture large = Painted(workspace, scene, StyleOf("chiaroscuro"));
  EXPECT_EQ(workspace.counters().guides_cast, 3u);
  EXPECT_EQ(workspace.counters().structures_built, 1u);
  Workspace fresh(Context());
  EXPECT_EQ(large.rgba, Painted(fresh, scene, StyleOf("chiaroscuro")).rgba);
  scene.raw_normals = true;
  Painted(workspace, scene, StyleOf("chiaroscuro"));
  EXPECT_EQ(workspace.counters().guides_cast, 4u);
  EXPECT_EQ(workspace.counters().structures_built, 1u);
}

TEST(Workspace, LightConcernsOnlyTheLayersThatDependOnIt) {
  Workspace workspace(Context());
  SceneRequest scene = SceneOf("ball");
  const auto counts = [&] {
    return std::pair(workspace.counters().structures_built, workspace.counters().guides_cast);
  };
  PictureRequest picture;
  const Picture plain = Painted(workspace, scene, StyleOf("oil"));
  for (const double azimuth : {0.0, 20.0}) {
    scene.light = LightAngles{azimuth, 30.0}, scene.samples = 3, picture.seed = std::uint64_t(azimuth);
    const Picture painted = Painted(workspace, scene, StyleOf("oil"), picture);
    if (azimuth == 0.0) {
      EXPECT_EQ(painted.rgba, plain.rgba);
    }
    EXPECT_EQ(counts(), std::pair(std::size_t(1), std::size_t(1)));
  }
  Painted(workspace, scene, StyleOf("chiaroscuro"));
  const auto lit = counts();
  EXPECT_LE(lit.first, 2u) << "it is built once more for rays to lights";
  EXPECT_EQ(lit.second, 2u);
  scene.light->azimuth = 40.0;
  Painted(workspace, scene, StyleOf("chiaroscuro"));
  scene.light.reset();
  Painted(workspace, scene, StyleOf("chiaroscuro"));
  EXPECT_EQ(counts(), std::pair(lit.first, std::size_t(4)));
}

// In any order of changes: attributes too, which tell the light and the seed of a file.
// Whatever changes at random. A scene without frames is asked for none.
void ExpectGuidesOfAFreshOne(SceneRequest scene, bool has_frames, int steps) {
  Workspace workspace(Context());
  const std::vector<LayerSet> sets = {{}, {Layer::kAlbedo}, {Layer::kLuminance, Layer::kShadow}, {Layer::kLpeLDE}};
  scene.size = {24, 16};
  std::optional<int> frame;
  std::size_t layers = 0;
  std::mt19937 random(7);
  for (int step = 0; step < steps; ++step) {
    switch (random() % 7) {
      case 0:
        scene.light = LightAngles{double(random() % 3) * 40.0, 20.0};
        break;
      case 1:
        scene.light.reset(), scene.key_light = random() % 2 == 0;
        break;
      case 2:
        scene.seed = random() % 2;
        break;
      case 3:
        scene.samples = 1 + int(random() % 2);
        break;
      case 4:
        frame = !has_frames || random() % 2 ? std::nullopt : std::optional(int(random() % 3));
        break;
      case 5:
        scene.view = random() % 2 ? std::nullopt : std::optional(ViewAngles{double(random() % 2) * 30.0, 10.0});
        break;
      default:
        layers = random() % sets.size();
    }
    const auto kept = workspace.Guides(scene, frame, sets[layers]);
    ASSERT_TRUE(kept.ok()) << kept.error().message;
    Workspace fresh(Context());
    const auto made = fresh.Guides(scene, frame, (*kept)->layers());  // which may be more than were asked for
    ASSERT_TRUE(made.ok()) << made.error().message;
    EXPECT_EQ((*kept)->attributes, (*made)->attributes) << step;
    for (const LayerInfo& info : AllLayers()) {
      for (int c = 0; (*kept)->Has(info.layer) && c < ChannelCount(info.layer); ++c) {
        EXPECT_TRUE(std::ranges::equal((*kept)->Plane(info.layer, c), (*made)->Plane(info.layer, c)))
            << step << " " << info.name;
      }
    }
  }
  EXPECT_LT(workspace.counters().guides_cast, std::size_t(steps));
}

TEST(Workspace, GuidesAreThoseOfAFreshOne) { ExpectGuidesOfAFreshOne(SceneOf("toys"), true, 40); }

// Its meshes glow, and keep their place in the structure while lights come and go.
TEST(Workspace, GuidesOfAGlowingSceneAreThoseOfAFreshOne) {
  const TemporaryFolder folder;
  SceneRequest scene = SceneOf("ball");
  scene.scene = (folder.path() / "lamp.obj").string();
  std::ofstream(folder.path() / "lamp.mtl") << "newmtl glow\nKd 1 1 1\nKe 3 2 1\nnewmtl grey\nKd 0.5 0.5 0.5\n";
  std::ofstream(scene.scene) << "mtllib lamp.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -1 1 -1\nv 1 1 -1\n"
                                "v 1 2 -1\nv -1 2 -1\nusemtl grey\nf 4 3 2 1\nusemtl glow\nf 5 6 7 8\n";
  ExpectGuidesOfAFreshOne(scene, false, 30);
}

TEST(Workspace, TellsOfASceneOnce) {
  RunContext context = Context();
  std::vector<std::string> told;
  context.on_message = [&](const Message& message) { told.push_back(message.text); };
  const TemporaryFolder folder;
  SceneRequest scene = SceneOf("ball");
  scene.scene = (folder.path() / "a.obj").string();
  std::ofstream(scene.scene) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  Workspace workspace(context);
  Painted(workspace, scene, StyleOf("oil"));
  EXPECT_THAT(told, ::testing::Contains(::testing::HasSubstr("without normals")).Times(1));
}

TEST(Workspace, AFrameOfAnAnimationLoadsNoFile) {
  Workspace workspace(Context());
  PictureRequest first, later;
  first.frame = 1, later.frame = 20;
  const Picture one = Painted(workspace, SceneOf("toys"), StyleOf("pastel"), first);
  EXPECT_NE(Painted(workspace, SceneOf("toys"), StyleOf("pastel"), later).rgba, one.rgba);
  EXPECT_EQ(Painted(workspace, SceneOf("toys"), StyleOf("pastel"), first).rgba, one.rgba);
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
  EXPECT_EQ(workspace.counters().styles_loaded, 1u);
}

TEST(Workspace, ASavedPaintingIsReadAgain) {
  const TemporaryFolder folder;
  fs::copy(kSource + "/exemplars/oil", folder.path() / "mine", fs::copy_options::recursive);
  std::this_thread::sleep_for(std::chrono::milliseconds(2 * kFileTimeLagMs));  // what is just written is read twice
  Workspace workspace(Context());
  const StyleRequest style = StyleOf((folder.path() / "mine").string());
  const Picture before = Painted(workspace, SceneOf("suzanne"), style);
  EXPECT_EQ(Painted(workspace, SceneOf("suzanne"), style).rgba, before.rgba);
  EXPECT_EQ(workspace.counters().styles_loaded, 1u);
  EXPECT_EQ(workspace.counters().pictures_decoded, 2u);
  fs::copy_file(kSource + "/exemplars/charcoal/lit.png", folder.path() / "mine" / "lit.png",
                fs::copy_options::overwrite_existing);
  EXPECT_NE(Painted(workspace, SceneOf("suzanne"), style).rgba, before.rgba);
  EXPECT_EQ(workspace.counters().styles_loaded, 2u);
  EXPECT_EQ(workspace.counters().styles_prepared, 2u);
  EXPECT_EQ(workspace.counters().guides_cast, 1u);
  EXPECT_EQ(workspace.counters().pictures_decoded, 3u) << "the paper is the one of before";
}

TEST(Workspace, CanBeCancelledAgainAndAgain) {
  RunContext context = Context();
  std::atomic<int> calls = 0;
  std::atomic<bool> cancels = true;
  Workspace* at_work = nullptr;
  context.on_progress = [&](const std::string&) -> Progress {
    return [&](double) {
      ++calls;
      if (cancels && at_work) std::thread([&] { at_work->Cancel(); }).join();
      return true;
    };
  };
  Workspace workspace(context);
  at_work = &workspace;
  SceneRequest scene = SceneOf("suzanne");
  scene.size = {320, 180};
  for (int i = 0; i < 3; ++i) {
    const auto painted = workspace.Paint(scene, StyleOf("oil"), {});
    ASSERT_FALSE(painted.ok());
    EXPECT_EQ(painted.error().kind, ErrorKind::kCancelled);
  }
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);  // what was whole is kept
  cancels = false;
  workspace.Cancel();  // nothing is at work: the next call is not meant
  const Picture painted = Painted(workspace, scene, StyleOf("oil"));
  Workspace fresh(Context());
  EXPECT_EQ(painted.rgba, Painted(fresh, scene, StyleOf("oil")).rgba);
  EXPECT_GT(calls, 3);
}

TEST(Workspace, AGivenExposureIsThatOfItsRequestAlone) {
  Workspace workspace(Context());
  const Picture measured = Painted(workspace, SceneOf("suzanne"), StyleOf("chiaroscuro"));
  PictureRequest dark;
  dark.exposure = -6.0;
  EXPECT_NE(Painted(workspace, SceneOf("suzanne"), StyleOf("chiaroscuro"), dark).rgba, measured.rgba);
  EXPECT_EQ(Painted(workspace, SceneOf("suzanne"), StyleOf("chiaroscuro")).rgba, measured.rgba);
}

// Also the settings that a picture's file records, of guides that hold more layers by then.
TEST(Workspace, MeasuresForAFinishAreThoseOfARunOfItsOwn) {
  const auto settings = [](Workspace& workspace, const std::string& finish) {
    StyleRequest style = StyleOf("oil");
    style.finishes = {finish};
    const auto painted = workspace.Paint(SceneOf("ball"), style, {});
    EXPECT_TRUE(painted) << painted.error().message;
    return painted ? painted->write.settings : "";
  };
  Workspace used(Context()), fresh(Context());
  settings(used, "comic");
  EXPECT_EQ(settings(used, "depth"), settings(fresh, "depth"));
}

TEST(Workspace, CountsTheMemoryOfPaintingAndRefusesInTime) {
  Workspace workspace(Context());
  const auto painted = workspace.Paint(SceneOf("suzanne"), StyleOf("oil"), {});
  ASSERT_TRUE(painted.ok());
  const std::uint64_t peak = painted->report.memory.peak();
  const auto paint_within = [&](std::uint64_t bytes, const std::string& style) {
    RunContext context = Context();
    context.max_memory = bytes;
    return Workspace(context).Paint(SceneOf("suzanne"), StyleOf(style), {});
  };
  EXPECT_TRUE(paint_within(peak, "oil").ok());
  for (const auto& [bytes, part] :
       {std::pair(peak - 1, "exemplars"), {std::uint64_t(1000), "take smaller exemplars"}}) {
    const auto refused = paint_within(bytes, "oil");
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
    EXPECT_NE(refused.error().message.find(part), std::string::npos) << refused.error().message;
  }
  // What is painted later counts, too, without a ray.
  RunContext context = Context();
  context.max_memory = peak;
  Workspace small(context);
  ASSERT_TRUE(small.Paint(SceneOf("suzanne"), StyleOf("oil"), {}).ok());
  EXPECT_FALSE(small.Paint(SceneOf("suzanne"), StyleOf("oil", {"transfer.scale=8"}), {}).ok());
  EXPECT_TRUE(small.Paint(SceneOf("suzanne"), StyleOf("oil"), {}).ok());
  EXPECT_EQ(small.counters().guides_cast, 1u);
}

TEST(Workspace, IsCancelledBeforeAnyWork) {
  RunContext context = Context();
  context.is_cancelled = [] { return true; };
  Workspace workspace(context);
  const auto painted = workspace.Paint(SceneOf("suzanne"), StyleOf("oil"), {});
  ASSERT_FALSE(painted.ok());
  EXPECT_EQ(painted.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(workspace.counters().styles_loaded, 0u);
}

TEST(Workspace, FilesAreReadWithItsThreads) {
  RunContext context = Context();
  context.threads = 1;
  Workspace one(context), all(Context());
  Painted(one, SceneOf("suzanne"), StyleOf("oil"));
  EXPECT_EQ(internal::IoThreads(), 1);
  Painted(all, SceneOf("suzanne"), StyleOf("oil"));
  EXPECT_EQ(internal::IoThreads(), 0);
}

TEST(Workspace, MistakesAreErrorsAndLeaveItUsable) {
  Workspace workspace(Context());
  PictureRequest upsampled;
  for (const int factor : {0, -1, 5, 9}) {
    upsampled.upsample = factor;
    const auto painted = workspace.Paint(SceneOf("suzanne"), StyleOf("oil"), upsampled);
    ASSERT_FALSE(painted.ok()) << factor;
    EXPECT_EQ(painted.error().kind, ErrorKind::kUsage);
  }
  EXPECT_FALSE(workspace.Paint(SceneOf("nothing"), StyleOf("oil"), {}).ok());
  EXPECT_FALSE(workspace.Paint(SceneOf("suzanne"), StyleOf("no-such-style"), {}).ok());
  EXPECT_FALSE(workspace.Paint(SceneOf("suzanne"), StyleOf("oil", {"transfer.scale=-1"}), {}).ok());
  EXPECT_EQ(Painted(workspace, SceneOf("suzanne"), StyleOf("oil")).width, 96);
}

TEST(Workspace, PaintsByAQualityWhatTheProgramPaints) {
  Workspace workspace(Context());
  BudgetRequest draft;
  draft.quality = Quality::kDraft;
  const std::string options = kSource + "/scenes/suzanne.glb --size 96x56 --style ";
  SceneRequest scene = SceneOf("suzanne");
  scene.size = {96, 56};
  for (const std::string style : {"oil", "chiaroscuro"}) {
    const auto painted = workspace.Paint(scene, StyleOf(style), {}, draft);
    ASSERT_TRUE(painted.ok()) << painted.error().message;
    EXPECT_EQ(painted->picture.rgba, Stylized(options + style + " --quality draft").rgba) << style;
    EXPECT_EQ(painted->choice.value().quality, "draft");
  }
  const WorkspaceCounters before = workspace.counters();
  ASSERT_TRUE(workspace.Paint(scene, StyleOf("chiaroscuro", {"transfer.threshold=0.4"}), {}, draft).ok());
  EXPECT_EQ(workspace.counters().guides_cast, before.guides_cast);
  scene.view = ViewAngles{50, 10};
  ASSERT_TRUE(workspace.Paint(scene, StyleOf("chiaroscuro", {"transfer.threshold=0.4"}), {}, draft).ok());
  EXPECT_EQ(workspace.counters().styles_loaded, before.styles_loaded + 1) << "the choice stays as the view changes";
  scene.view.reset();
  EXPECT_EQ(Painted(workspace, scene, StyleOf("oil")).rgba, Stylized(options + "oil").rgba);
}

TEST(Workspace, ThePictureIsTheSameWithItsField) {
  Workspace workspace(Context());
  PictureRequest picture;
  const Picture plain = Painted(workspace, SceneOf("suzanne"), StyleOf("oil"));
  picture.keep_field = true;
  for (int i = 0; i < 2; ++i) {
    const auto painted = workspace.Paint(SceneOf("suzanne"), StyleOf("oil"), picture);
    ASSERT_TRUE(painted.ok()) << painted.error().message;
    EXPECT_EQ(painted->picture.rgba, plain.rgba);
    ASSERT_TRUE(painted->field);
    EXPECT_EQ(painted->field->width, 96);
    EXPECT_EQ(painted->styles, nullptr);
    ASSERT_EQ(painted->field_styles.size(), 1u);
    const FieldStyle& style = painted->field_styles.front();
    EXPECT_EQ(style.given, "oil");
    EXPECT_GT(style.exemplars.front().width, 0);
    EXPECT_TRUE(fs::exists(style.exemplars.front().file)) << style.exemplars.front().file;
    for (const std::int16_t x : painted->field->x) ASSERT_LT(x, style.width);
  }
  EXPECT_FALSE(workspace.Paint(SceneOf("suzanne"), StyleOf("oil"), {})->field);
}

TEST(Workspace, DescribesTheSceneAndCastsNoRay) {
  Workspace workspace(Context());
  const auto toys = workspace.Describe(SceneOf("toys"), 1);
  ASSERT_TRUE(toys.ok()) << toys.error().message;
  EXPECT_EQ(workspace.counters().guides_cast, 0u);
  EXPECT_EQ(workspace.counters().structures_built, 0u);
  EXPECT_FALSE(toys->objects.empty() || toys->materials.empty());
  ASSERT_TRUE(toys->animation);
  EXPECT_GT(toys->animation->last, 1);
  // A view from the eye is the picture itself.
  SceneRequest scene = SceneOf("suzanne");
  const Picture seen = Painted(workspace, scene, StyleOf("oil"));
  const auto suzanne = workspace.Describe(scene, std::nullopt);
  ASSERT_TRUE(suzanne.ok()) << suzanne.error().message;
  EXPECT_FALSE(suzanne->style_files.empty());
  const WorkspaceCounters before = workspace.counters();
  EXPECT_EQ(Painted(workspace, scene, StyleOf("oil")).rgba, seen.rgba);
  EXPECT_EQ(workspace.counters().structures_built, before.structures_built) << "describing makes nothing stale";
  scene.view = suzanne->eye;
  const Picture orbit = Painted(workspace, scene, StyleOf("oil"));
  std::size_t other = 0;
  for (std::size_t i = 3; i < seen.rgba.size(); i += 4) other += (seen.rgba[i] > 0) != (orbit.rgba[i] > 0);
  EXPECT_LT(other, seen.rgba.size() / 4 / 500);
}

// A unit sphere of fine facets with smooth normals.
void WriteBall(const std::string& path) {
  constexpr int kRings = 64, kSides = 128;
  constexpr double kPi = 3.14159265358979323846;
  std::ofstream file(path);
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const double up = kPi * ring / kRings, around = 2.0 * kPi * side / kSides;
      const double x = std::sin(up) * std::sin(around), y = std::cos(up), z = std::sin(up) * std::cos(around);
      file << "v " << x << " " << y << " " << z << "\nvn " << x << " " << y << " " << z << "\n";
    }
  }
  for (int ring = 0; ring < kRings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      file << "f";
      const int next = (side + 1) % kSides;
      for (const int i :
           {ring * kSides + side, (ring + 1) * kSides + side, (ring + 1) * kSides + next, ring * kSides + next}) {
        file << " " << i + 1 << "//" << i + 1;
      }
      file << "\n";
    }
  }
}

TEST(Workspace, OneSunTakesThePlaceOfTheLights) {
  const TemporaryFolder folder;
  SceneRequest scene = SceneOf("suzanne");
  scene.scene = (folder.path() / "ball.obj").string();
  WriteBall(scene.scene);
  Workspace workspace(Context());
  const auto shade = [&](const LightAngles& light) {
    scene.light = light;
    const auto guides = workspace.Guides(scene, std::nullopt, {Layer::kLuminance, Layer::kNormal, Layer::kShadow});
    EXPECT_TRUE(guides.ok()) << guides.error().message;
    const GuideSet& set = **guides;
    const auto coverage = set.Plane(Layer::kCoverage), luminance = set.Plane(Layer::kLuminance);
    const auto shadow = set.Plane(Layer::kShadow);
    const glm::dvec3 towards = DirectionFromAngles(light.azimuth, light.elevation);
    int compared = 0;
    for (std::size_t i = 0; i < coverage.size(); ++i) {
      if (coverage[i] < 1.0f || shadow[i] > 0.0f) continue;
      const glm::dvec3 normal(set.Plane(Layer::kNormal, 0)[i], set.Plane(Layer::kNormal, 1)[i],
                              set.Plane(Layer::kNormal, 2)[i]);
      const double expected = std::max(0.0, glm::dot(normal, towards));
      if (expected < 0.1) continue;  // where facets and smooth normals do not agree on the terminator
      EXPECT_NEAR(luminance[i], expected, 0.02) << i;
      ++compared;
    }
    EXPECT_GT(compared, 100);
  };
  shade({0.0, 0.0});
  shade({60.0, 30.0});
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
}

// By the names of the library's members, with what was found and what may be.
TEST(Workspace, SettingsOutOfRangeAreNamed) {
  Stylizer stylizer;
  const auto refusal = [&](const SceneSettings& scene, const PaintSettings& paint = {}) {
    const auto painted = stylizer.Paint(scene, {.style = "oil"}, paint);
    return painted ? std::string() : painted.error().message;
  };
  SceneSettings scene{.file = "a.obj"};
  scene.coverage_samples = 0;
  EXPECT_EQ(refusal(scene), "coverage_samples 0 is out of range; expected 1 to 16");
  scene = {.file = "a.obj"}, scene.light_samples = -1;
  EXPECT_EQ(refusal(scene), "light_samples -1 is out of range; expected 0 to 65536");
  scene = {.file = "a.obj"}, scene.auto_smooth = 181.0;
  EXPECT_EQ(refusal(scene), "auto_smooth 181 is out of range; expected 0 to 180 degrees");
  scene = {.file = "a.obj"}, scene.frames_per_second = -1.0;
  EXPECT_EQ(refusal(scene), "frames_per_second -1 is out of range; expected 0.001 to 100000, or 0");
  PaintSettings paint;
  paint.exposure = 65.0;
  EXPECT_EQ(refusal({.file = "a.obj"}, paint), "exposure 65 is out of range; expected -64 to 64 stops");
}

TEST(Workspace, GivesGuidesAlone) {
  Workspace workspace(Context());
  const auto guides = workspace.Guides(SceneOf("suzanne"), std::nullopt, {Layer::kAlbedo});
  ASSERT_TRUE(guides.ok()) << guides.error().message;
  EXPECT_TRUE((*guides)->Has(Layer::kAlbedo));
  EXPECT_EQ((*guides)->width(), 96);
}

}  // namespace
}  // namespace scumble
