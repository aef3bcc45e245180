// Plain Blender renders: names from Cryptomatte, coverage from an opaque film, the camera solved or from its file.
// Scenes are made here, so the truth is known; tests/blender/render_test.cpp compares with Blender itself.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <string>
#include <vector>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/blender/blender_passes.h"
#include "core/io/blender/render_light.h"
#include "core/io/blender_camera.h"
#include "core/io/guide_file.h"
#include "core/io/guides/cryptomatte.h"
#include "tests/core/io/true_camera.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// ---- the .camera file ------------------------------------------------------------------------------------------

TEST(BlenderCamera, ReadsItsTextAndRefusesOthers) {
  const TemporaryFolder folder;
  const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
  const std::string text = "camera The one\nviewFromWorld " + identity + "clipFromView " + identity;
  ASSERT_TRUE(WriteFileAtomically(folder / "a.camera", text));
  const auto camera = ReadBlenderCamera(folder / "a.camera");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->name, "The one");
  for (const std::string& wrong :
       {std::string(), std::string("nonsense\n"), std::string("viewFromWorld 1 2 3\n"), text + "object 3 A name\n"}) {
    ASSERT_TRUE(WriteFileAtomically(folder / "b.camera", wrong));
    ExpectRefusal(ReadBlenderCamera(folder / "b.camera"), {"b.camera", "render_guides.py"});
  }
}

// ---- Cryptomatte -----------------------------------------------------------------------------------------------

TEST(Cryptomatte, HashesAsBlenderDoes) {
  // From a file of Blender 3.4.1.
  EXPECT_EQ(MatteHash("Crate"), 0x94ff5ab7u);
  EXPECT_EQ(MatteHash("Käse 球"), 0x9996b136u);
  EXPECT_EQ(MatteHash("tab\tline\nend"), 0xedfb1575u);
  EXPECT_EQ(MatteHash("default_volume"), 0xb331280eu);
  EXPECT_EQ(MatteHash(""), 0u);
  EXPECT_EQ(MatteBits(0x94ff5ab7u), 0x94ff5ab7u);
  EXPECT_EQ(MatteBits(0x7fa00001u), 0x7f200001u) << "no NaN";
  EXPECT_EQ(MatteBits(0x80000005u), 0x80800005u) << "no denormal";
}

TEST(Cryptomatte, ReadsManifestsAsBlenderWritesThem) {
  // Blender 3.4 escapes nothing: this is what it wrote for a scene with such names.
  const auto names = ReadManifest(
      "{\"quo\"te\":\"10010381\",\"back\\slash\":\"aa5ce9ed\",\"comma\":\"00000000\",\"y\":"
      "\"64178b6c\",\"Käse 球\":\"9996b136\",\"tab\tline\nend\":\"edfb1575\"}",
      "a.exr");
  ASSERT_TRUE(names) << names.error().message;
  EXPECT_EQ(names->size(), 5u);
  EXPECT_EQ(names->at(0x10010381), "quo\"te");
  EXPECT_EQ(names->at(0xaa5ce9ed), "back\\slash");
  EXPECT_EQ(names->at(0x64178b6c), "comma\":\"00000000\",\"y");
  EXPECT_EQ(names->at(0x9996b136), "Käse 球");
  EXPECT_EQ(names->at(0xedfb1575), "tab\tline\nend");
}

TEST(Cryptomatte, ReadsManifestsInProperJson) {
  const auto hex = [](const std::string& name) {
    char text[16];
    std::snprintf(text, sizeof text, "%08X", MatteHash(name));
    return std::string(text);
  };
  const std::string odd = "a\"b\\c/\n\xc3\xa4\xf0\x9f\x8e\xa8";
  const auto names = ReadManifest(
      " { \"a\\\"b\\\\c\\/\\n\\u00e4\\ud83c\\udfa8\" : \"" + hex(odd) + "\" ,\n \"other hash\": \"0000002a\"} ",
      "a.exr");
  ASSERT_TRUE(names) << names.error().message;
  EXPECT_EQ(names->at(MatteBits(MatteHash(odd))), odd);
  EXPECT_EQ(names->at(MatteBits(0x2a)), "other hash") << "a hash of another kind is taken at its word";
  for (const char* empty : {"", " ", "}", "{}", "{ }"})
    EXPECT_TRUE(ReadManifest(empty, "a.exr").value().empty()) << empty;
}

TEST(Cryptomatte, DamagedManifestsAreRefused) {
  for (const char* text : {"{", "[]", "{\"a\"}", "{\"a\":1}", "{\"a\":\"12345\"}", "{\"a\":\"1234567g\"}", "null",
                           "{\"a\":\"12345678\"", "{\"a\":\"12345678\",}"}) {
    ExpectRefusal(ReadManifest(text, "a.exr"), {"a.exr", "manifest is damaged"});
  }
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    std::string text = "{";
    for (int k = 0; k < 60; ++k) text += "\"\\:,{}u0189afdc \n\xff"[Hash(seed, k) % 18];
    ReadManifest(text, "a.exr").ok();  // any answer, no crash
  }
  std::string marks = "{";  // quotation marks without end, and an entry whose name could be any length
  for (int k = 0; k < 20000; ++k) marks += "\":\"00000001\",";
  ReadManifest(marks, "a.exr").ok();
}

// ---- whole files -----------------------------------------------------------------------------------------------

constexpr float kCube = 1.0f, kBall = 2.0f;  // which of the two things a pixel of the picture below shows

// A 40×30 picture of Blender's channels: a wavy ground, its left half one object, a strip of background at the right.
class BlenderFile {
 public:
  BlenderFile() {
    camera_.width = 40, camera_.height = 30, camera_.scale = 50.0;
    camera_.view_from_world = RandomRotation(1);
    camera_.depth = [](double u, double v) { return 5.0 + std::sin(0.3 * u) + 0.7 * std::cos(0.3 * v); };
    const Render render(camera_);
    for (const char* name : {"Combined.R", "Combined.G", "Combined.B", "Combined.A", "Normal.X", "Normal.Y", "Normal.Z",
                             "Depth.Z", "Position.X", "Position.Y", "Position.Z", "IndexOB.X"}) {
      Channel(name);
    }
    // Blender's world is turned against glTF's: what Solve is to see as (x, y, z) is (x, -z, y) in the file.
    for (std::size_t i = 0; i < Pixels(); ++i) {
      const bool covered = render.depth[i] < 1e9f;
      Channel("Combined.A")[i] = 1.0f;  // opaque film
      Channel("Depth.Z")[i] = render.depth[i];
      Channel("Position.X")[i] = render.position[0][i];
      Channel("Position.Y")[i] = -render.position[2][i];
      Channel("Position.Z")[i] = render.position[1][i];
      const glm::dvec3 n = glm::transpose(camera_.view_from_world) * glm::dvec3(0, 0, 1);  // towards the viewer
      if (covered)
        Channel("Normal.X")[i] = float(n.x), Channel("Normal.Y")[i] = float(-n.z), Channel("Normal.Z")[i] = float(n.y);
      Channel("IndexOB.X")[i] = covered ? (i % 40 < 20 ? kCube : kBall) : 0.0f;
    }
  }
  std::size_t Pixels() const { return 1200; }
  std::vector<float>& Channel(const std::string& name) {
    auto& plane = channels_[name];
    plane.resize(Pixels());
    return plane;
  }
  void Drop(const std::string& name) { channels_.erase(name); }

  // The two halves as mattes, one rank full; the manifest as given.
  void AddMatte(const std::string& kind, const std::string& cube, const std::string& ball,
                const std::string& manifest) {
    for (const char* component : {"r", "g", "b", "a"}) Channel(kind + "00." + component);
    for (std::size_t i = 0; i < Pixels(); ++i) {
      if (Channel("Depth.Z")[i] > 1e9f) continue;
      const std::uint32_t hash = MatteHash(i % 40 < 20 ? cube : ball);
      Channel(kind + "00.r")[i] = std::bit_cast<float>(MatteBits(hash));
      Channel(kind + "00.g")[i] = 1.0f;
    }
    header_["cryptomatte/1234567/name"] = "Layer A." + kind;
    header_["cryptomatte/1234567/manifest"] = manifest;
  }
  void Header(const std::string& key, const std::string& value) { header_[key] = value; }

  void Write(const std::filesystem::path& path, OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT) const {
    OIIO::ImageSpec spec(40, 30, static_cast<int>(channels_.size()), type);
    spec.channelnames.clear();
    for (const auto& [name, plane] : channels_) {
      spec.channelnames.push_back(name.starts_with("Layer B.") ? name : "Layer A." + name);
    }
    spec.alpha_channel = -1;
    for (const auto& [key, value] : header_) spec.attribute(key, value);
    std::vector<float> pixels;
    for (std::size_t i = 0; i < Pixels(); ++i) {
      for (const auto& [name, plane] : channels_) pixels.push_back(plane[i]);
    }
    auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output && output->open(path.string(), spec)) << path;
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) << output->geterror();
    ASSERT_TRUE(output->close());
  }
  const TrueCamera& camera() const { return camera_; }

 private:
  TrueCamera camera_;
  std::map<std::string, std::vector<float>> channels_;
  std::map<std::string, std::string> header_;
};

GuideReadOptions WithObjects() {
  GuideReadOptions options;
  options.required = {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject};
  options.optional = {Layer::kPosition, Layer::kMaterial};
  return options;
}

float IdOf(const std::string& name) { return static_cast<float>(IdsForNames(std::span(&name, 1))[0]); }

TEST(BlenderFile, IsReadWithoutACameraFile) {
  const TemporaryFolder folder;
  BlenderFile file;
  file.Write(folder / "shot.exr");
  const auto guides = ReadGuides(folder / "shot.exr", WithObjects());
  ASSERT_TRUE(guides) << guides.error().message;
  ASSERT_TRUE(guides->camera);
  EXPECT_LT(AngleBetween(glm::dmat3(guides->camera->view_from_world), file.camera().view_from_world), 0.01);
  for (std::size_t i = 0; i < file.Pixels(); ++i) {
    const bool covered = file.Channel("Depth.Z")[i] < 1e9f;
    EXPECT_EQ(guides->Plane(Layer::kCoverage)[i], covered ? 1.0f : 0.0f) << "an opaque film: alpha was 1 everywhere";
    EXPECT_EQ(std::isinf(guides->Plane(Layer::kDepth)[i]), !covered);
    if (!covered) continue;
    EXPECT_NEAR(guides->Vec3(Layer::kNormal, i).z, 1.0f, 1e-5f);
    EXPECT_EQ(guides->Plane(Layer::kPosition, 1)[i], file.Channel("Position.Z")[i]);
    EXPECT_EQ(guides->Plane(Layer::kObject)[i], IdOf(i % 40 < 20 ? "index 1" : "index 2"));
  }
  GuideReadOptions few;
  few.required = {Layer::kCoverage, Layer::kNormal};
  const auto without = ReadGuides(folder / "shot.exr", few);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_EQ(without->layers().ToString(), "A, normal") << "what only the camera needed is gone";
}

TEST(BlenderFile, ACameraFileWins) {
  const TemporaryFolder folder;
  BlenderFile file;
  file.Drop("Position.X");
  file.Write(folder / "shot.exr");
  ASSERT_TRUE(WriteFileAtomically(folder / "shot.camera",
                                  "camera Eye\nviewFromWorld 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"
                                  "clipFromView 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"));
  GuideReadOptions options = WithObjects();
  options.blender_camera = folder / "shot.camera";
  const auto guides = ReadGuides(folder / "shot.exr", options);
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(guides->camera->name, "Eye");
  EXPECT_EQ(guides->camera->view_from_world, glm::dmat4(1.0));
}

TEST(BlenderFile, SaysWhatItNeedsToFindTheCamera) {
  const TemporaryFolder folder;
  for (const auto& [channel, pass] : {std::pair{"Position.Y", "Position"}, {"Depth.Z", "Z (Depth)"}}) {
    BlenderFile file;
    file.Drop(channel);
    file.Write(folder / "shot.exr");
    GuideReadOptions options;
    options.required = {Layer::kCoverage, Layer::kNormal};
    ExpectRefusal(ReadGuides(folder / "shot.exr", options), {"shot.exr", "Blender render", pass, "--camera FILE"});
  }
  BlenderFile file;
  file.Drop("Normal.X"), file.Drop("Normal.Y"), file.Drop("Normal.Z"), file.Drop("IndexOB.X");
  file.Write(folder / "shot.exr");
  ExpectRefusal(ReadGuides(folder / "shot.exr", WithObjects()),
                {"no layer normal, object.", "View Layer > Passes > Normal, Cryptomatte Object"});
}

TEST(BlenderFile, NamesComeFromCryptomatte) {
  const TemporaryFolder folder;
  BlenderFile file;
  const auto entry = [](const std::string& name) {
    char text[80];
    std::snprintf(text, sizeof text, "\"%s\":\"%08x\"", name.c_str(), MatteHash(name));
    return std::string(text);
  };
  file.AddMatte("CryptoObject", "Cube", "Ball \"2\"",
                "{" + entry("Ball \"2\"") + "," + entry("Unseen") + "," + entry("Cube") + "}");
  auto& r = file.Channel("CryptoObject00.r");
  auto& g = file.Channel("CryptoObject00.g");
  r[900] = std::bit_cast<float>(0x3f812345u);  // of no name
  // An edge of the first thing's: the second rank covers more, in a file that is not sorted.
  g[901] = 0.25f;
  file.Channel("CryptoObject00.b")[901] = std::bit_cast<float>(MatteBits(MatteHash("Unseen")));
  file.Channel("CryptoObject00.a")[901] = 0.5f;
  file.Channel("CryptoObject00.a")[902] = g[902] = 0.25f;
  for (const char* component : {"r", "g", "b", "a"}) file.Channel(std::string("CryptoObject01.") + component);
  file.Channel("CryptoObject01.a")[902] = 0.125f;
  file.Write(folder / "shot.exr");
  const auto guides = ReadGuides(folder / "shot.exr", WithObjects());
  ASSERT_TRUE(guides) << guides.error().message;
  const auto ids = guides->Plane(Layer::kObject);
  EXPECT_EQ(ids[1179], IdOf("Cube"));
  EXPECT_EQ(ids[1199], IdOf("Ball \"2\""));
  EXPECT_EQ(ids[0], 0.0f);
  EXPECT_EQ(guides->object_names.at(static_cast<std::uint32_t>(ids[900])), "unnamed 3f812345");
  EXPECT_EQ(ids[901], IdOf("Unseen"));
  EXPECT_EQ(guides->object_names.size(), 4u);
  EXPECT_FALSE(guides->Has(Layer::kMaterial));
  EXPECT_EQ(guides->Plane(Layer::kCoverage)[901], 0.75f) << "an opaque film's edge";
  EXPECT_EQ(guides->Plane(Layer::kCoverage)[902], 1.0f) << "all ranks are in use, there may be more";
  EXPECT_EQ(guides->Plane(Layer::kCoverage)[0], 0.0f);
}

TEST(BlenderFile, AnotherViewLayersCryptomatteIsNotTaken) {
  const TemporaryFolder folder;
  BlenderFile file;
  file.AddMatte("CryptoMaterial", "Red", "Blue", "{}");
  file.Header("cryptomatte/7654321/name", "Layer B.CryptoMaterial");
  file.Header("cryptomatte/7654321/manifest", "nonsense");
  file.Write(folder / "shot.exr");
  const auto guides = ReadGuides(folder / "shot.exr", WithObjects());
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(guides->object_names.begin()->second.substr(0, 6), "index ");
  EXPECT_EQ(guides->material_names.size(), 2u);
  for (const auto& [id, name] : guides->material_names) EXPECT_EQ(name.substr(0, 8), "unnamed ");
  file.Header("cryptomatte/1234567/manifest", "nonsense");
  file.Write(folder / "shot.exr");
  ExpectRefusal(ReadGuides(folder / "shot.exr", WithObjects()), {"shot.exr", "manifest is damaged"});
  file.Header("cryptomatte/1234567/manifest", "{}");
  file.Write(folder / "half.exr", OIIO::TypeDesc::HALF);
  ExpectRefusal(ReadGuides(folder / "half.exr", WithObjects()), {"half.exr", "half floats", "32-bit"});
}

// pxr24 rounds ids, dwaa what ends in .r, .g, .b and .Y; b44 only half floats.
TEST(BlenderFile, LossyCompressionKeepsNamesOrIsNamed) {
  const TemporaryFolder folder;
  BlenderFile file;
  const auto hex = [](const std::string& name) { return fmt::format("{:08x}", MatteHash(name)); };
  const std::string cube = R"({"Cube":")" + hex("Cube") + "\"", ball = R"("Ball":")" + hex("Ball") + "\"";
  file.AddMatte("CryptoObject", "Cube", "Ball", cube + "," + ball + "}");
  for (const char* codec : {"zip", "piz", "pxr24", "b44", "b44a"}) {
    file.Header("compression", codec);
    file.Write(folder / "shot.exr");
    const auto guides = ReadGuides(folder / "shot.exr", WithObjects());
    ASSERT_TRUE(guides) << codec << ": " << guides.error().message;
    for (std::size_t i = 0; i < file.Pixels(); ++i) {
      if (file.Channel("Depth.Z")[i] > 1e9f) continue;
      EXPECT_EQ(guides->Plane(Layer::kObject)[i], IdOf(i % 40 < 20 ? "Cube" : "Ball")) << codec;
    }
  }
  for (const char* codec : {"dwaa", "dwab"}) {
    file.Header("compression", codec);
    file.Write(folder / "dwa.exr");
    ExpectRefusal(ReadGuides(folder / "dwa.exr", WithObjects()), {"dwa.exr", codec, "lossy", "codec ZIP"});
  }
}

TEST(Cryptomatte, RoundsIdsAsOpenExrDoes) {
  const auto rounded = RoundedAsPxr24(
      {{0x10010381, "up"}, {0xaa5ce97f, "down"}, {0x7f7fffff, "the largest"}, {0x00800000, "exact"}}, "a.exr");
  ASSERT_TRUE(rounded) << rounded.error().message;
  EXPECT_EQ(rounded->at(0x10010400), "up");
  EXPECT_EQ(rounded->at(0xaa5ce900), "down");
  EXPECT_EQ(rounded->at(0x7f7fff00), "the largest") << "not infinite";
  EXPECT_EQ(rounded->at(0x00800000), "exact");
  ExpectRefusal(RoundedAsPxr24({{0x10010381, "a"}, {0x10010401, "b"}}, "a.exr"), {"a.exr", "pxr24", "'a' and 'b'"});
}

TEST(BlenderFile, NothingIsOutsideARenderBorder) {
  const TemporaryFolder folder;
  BlenderFile file;
  for (std::size_t i = 0; i < 600; ++i) {
    file.Channel("Combined.A")[i] = 0.0f;
    for (const char* axis : {"X", "Y", "Z"}) {
      file.Channel(std::string("Normal.") + axis)[i] = file.Channel(std::string("Position.") + axis)[i] = 0.0f;
    }
    file.Channel("Depth.Z")[i] = 0.0f;  // Blender writes zeros there
  }
  file.Channel("Depth.Z")[1199] = 1e10f;  // background inside the border
  for (const char* axis : {"X", "Y", "Z"}) file.Channel(std::string("Normal.") + axis)[1199] = 0.0f;
  file.Write(folder / "shot.exr");
  const auto guides = ReadGuides(folder / "shot.exr", WithObjects());
  ASSERT_TRUE(guides) << guides.error().message;
  for (std::size_t i = 0; i < file.Pixels(); ++i) {
    ASSERT_EQ(guides->Plane(Layer::kCoverage)[i], i < 600 || i == 1199 ? 0.0f : 1.0f) << i;
  }
}

TEST(BlenderFile, ATransparentFilmKeepsItsAlpha) {
  const TemporaryFolder folder;
  BlenderFile file;
  for (std::size_t i = 0; i < file.Pixels(); ++i)
    file.Channel("Combined.A")[i] = file.Channel("Depth.Z")[i] < 1e9f ? 0.75f : 0.0f;
  file.Write(folder / "shot.exr");
  const auto guides = ReadGuides(folder / "shot.exr", WithObjects());
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(guides->Plane(Layer::kCoverage)[1199], 0.75f);
}

// The first sample of a filtered pixel may miss the surface that covers most of it.
// ---- light -----------------------------------------------------------------------------------------------------

void AddColor(const std::string& pass, const std::function<float(std::size_t, int)>& value, BlenderFile& file) {
  for (int c = 0; c < 3; ++c) {
    auto& plane = file.Channel(pass + "." + "RGB"[c]);
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = value(i, c);
  }
}

GuideReadOptions WithLight() {
  GuideReadOptions options = WithObjects();
  options.required.Add({Layer::kLuminance, Layer::kShadow});
  return options;
}

TEST(BlenderFile, UvIsReadAndItsThirdChannelIsNoCoverage) {
  const TemporaryFolder folder;
  BlenderFile file;
  GuideReadOptions options = WithObjects();
  options.required.Add(Layer::kUv);
  file.Write(folder / "none.exr");
  ExpectRefusal(ReadGuides(folder / "none.exr", options), {"no layer uv", "switch on View Layer > Passes > UV"});
  for (std::size_t i = 0; i < file.Pixels(); ++i) {
    file.Channel("UV.U")[i] = 0.25f, file.Channel("UV.V")[i] = 0.75f, file.Channel("UV.A")[i] = 0.0f;
  }
  file.Write(folder / "shot.exr");
  const auto guides = ReadGuides(folder / "shot.exr", options);
  ASSERT_TRUE(guides) << guides.error().message;
  int covered = 0;
  for (std::size_t i = 0; i < file.Pixels(); ++i) {
    const bool is_covered = file.Channel("Depth.Z")[i] < 1e9f;
    covered += is_covered;
    ASSERT_EQ(guides->Plane(Layer::kCoverage)[i], is_covered ? 1.0f : 0.0f);
    ASSERT_EQ(guides->Plane(Layer::kUv, 0)[i], is_covered ? 0.25f : 0.0f);
    ASSERT_EQ(guides->Plane(Layer::kUv, 1)[i], is_covered ? 0.75f : 0.0f);
  }
  EXPECT_GT(covered, 0);
  options.required = WithObjects().required, options.required.Add(Layer::kCosine);
  ExpectRefusal(ReadGuides(folder / "shot.exr", options), {"No pass of Blender is cosine"});
}

TEST(RenderLight, ChannelsAreKnownByTheEndOfTheirNames) {
  const auto found = ParseLightChannel("My.Layer.Shadow Catcher.G");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->prefix, "My.Layer");
  EXPECT_EQ(found->pass, LightPass::kShadowCatcher);
  EXPECT_EQ(found->component, 1);
  EXPECT_EQ(ParseLightChannel("Shadow.R")->pass, LightPass::kShadow);
  EXPECT_EQ(ParseLightChannel("A.DiffDir.B")->component, 2);
  for (const char* name : {"", ".R", "R", "DiffDir", "DiffDir.A", "DiffDir.r", "GlossDir.R", "shadow.Y", "XShadow.R"}) {
    EXPECT_FALSE(ParseLightChannel(name)) << name;
  }
}

TEST(BlenderFile, LightComesFromDiffuseDirectAndShadow) {
  const TemporaryFolder folder;
  BlenderFile file;
  const auto light = [](std::size_t i, int c) { return (0.25f + 0.5f * float(c)) * float(i % 7); };
  const auto reached = [](std::size_t i, int) { return i % 3 == 0 ? 1.1f : 0.2f * float(i % 3); };
  AddColor("DiffDir", light, file);
  AddColor("Shadow", reached, file);
  for (std::size_t i = 0; i < file.Pixels(); ++i) file.Channel("Combined.A")[i] = i % 5 == 0 ? 0.5f : 1.0f;
  for (std::size_t i = 0; i < file.Pixels(); ++i) {
    if (file.Channel("Depth.Z")[i] > 1e9f) file.Channel("Combined.A")[i] = 0.0f;
  }
  file.Write(folder / "a.exr");
  const auto guides = ReadGuides(folder / "a.exr", WithLight());
  ASSERT_TRUE(guides) << guides.error().message;
  for (std::size_t i = 0; i < guides->pixel_count(); ++i) {
    const float coverage = guides->Plane(Layer::kCoverage)[i];
    const float luminance = guides->Plane(Layer::kLuminance)[i], shadow = guides->Plane(Layer::kShadow)[i];
    if (coverage == 0.0f) {
      ASSERT_EQ(luminance, 0.0f);
      ASSERT_EQ(shadow, 0.0f);
      continue;
    }
    ASSERT_NEAR(luminance, 0.2126f * light(i, 0) + 0.7152f * light(i, 1) + 0.0722f * light(i, 2), 1e-5f) << i;
    ASSERT_NEAR(shadow, std::max(0.0f, 1.0f - reached(i, 0) / coverage), 1e-5f) << i << ": the rest is no shadow";
  }
  const auto info = InspectGuides(folder / "a.exr");
  ASSERT_TRUE(info);
  EXPECT_TRUE(info->layers.at("Layer A").Contains({Layer::kLuminance, Layer::kShadow}));
}

// Cycles counts what it knows of a shadow catcher twice, and a transparent film has none of its alpha. Here the left
// half is one, a stretch between the halves is seen half on it.
TEST(BlenderFile, ShadowCatchersAreCoveredAndKnowTheirShadows) {
  const TemporaryFolder folder;
  for (const bool with_mattes : {true, false}) {
    for (const bool opaque : {false, true}) {
      BlenderFile file;
      AddColor(
          "Shadow", [](std::size_t, int) { return 0.5f; }, file);
      AddColor(
          "Shadow Catcher", [](std::size_t i, int) { return i % 4 ? 0.25f : 1.3f; }, file);
      if (with_mattes) file.AddMatte("CryptoObject", "Floor", "Ball", "");
      const auto catcher_share = [](std::size_t i) { return i % 40 < 18 ? 1.0f : i % 40 < 20 ? 0.75f : 0.0f; };
      const auto covered = [&](std::size_t i) { return file.Channel("Depth.Z")[i] < 1e9f; };
      for (std::size_t i = 0; i < file.Pixels(); ++i) {
        if (!covered(i)) continue;
        const float share = catcher_share(i);
        file.Channel("Combined.A")[i] = opaque ? 1.0f : 1.0f - share;
        if (with_mattes) file.Channel("CryptoObject00.g")[i] = 1.0f + share;
        for (const char* axis : {"Normal.X", "Normal.Y", "Normal.Z"}) file.Channel(axis)[i] *= 1.0f + share;
      }
      for (std::size_t i = 0; i < file.Pixels(); ++i) {
        if (!covered(i) && !opaque) file.Channel("Combined.A")[i] = 0.0f;
      }
      file.Write(folder / "a.exr");
      GuideReadOptions options = WithObjects();
      options.required.Add(Layer::kShadow);
      const auto guides = ReadGuides(folder / "a.exr", options);
      ASSERT_TRUE(guides) << guides.error().message;
      for (std::size_t i = 0; i < guides->pixel_count(); ++i) {
        SCOPED_TRACE(testing::Message() << i << (with_mattes ? " mattes" : "") << (opaque ? " opaque" : ""));
        ASSERT_EQ(guides->Plane(Layer::kCoverage)[i], covered(i) ? 1.0f : 0.0f);
        const float caught = i % 4 ? 0.75f : 0.0f;
        ASSERT_EQ(guides->Plane(Layer::kShadow)[i], !covered(i) ? 0.0f : catcher_share(i) > 0.0f ? caught : 0.5f);
      }
      // Without shadows the film says what is seen.
      const auto plain = ReadGuides(folder / "a.exr", WithObjects());
      ASSERT_TRUE(plain) << plain.error().message;
      EXPECT_EQ(plain->Plane(Layer::kCoverage)[600], opaque ? 1.0f : 0.0f);
    }
  }
}

TEST(BlenderFile, LightMayComeFromAnotherViewLayer) {
  const TemporaryFolder folder;
  BlenderFile file;
  AddColor(
      "DiffDir", [](std::size_t, int) { return 0.5f; }, file);
  AddColor(
      "Layer B.DiffDir", [](std::size_t, int) { return 0.75f; }, file);
  file.Write(folder / "a.exr");
  GuideReadOptions options = WithObjects();
  options.required.Add(Layer::kLuminance);
  const auto first = [&] {
    const auto guides = ReadGuides(folder / "a.exr", options);
    EXPECT_TRUE(guides) << guides.error().message;
    return guides ? guides->Plane(Layer::kLuminance)[610] : -1.0f;
  };
  EXPECT_NEAR(first(), 0.5f, 1e-6f);
  options.light_layer = "Layer B";
  EXPECT_NEAR(first(), 0.75f, 1e-6f);
  options.light_layer = "Layer C";
  ExpectRefusal(ReadGuides(folder / "a.exr", options),
                {"no view layer 'Layer C' with passes of light; there are 'Layer A', 'Layer B'"});
  BlenderFile().Write(folder / "dark.exr");
  ExpectRefusal(ReadGuides(folder / "dark.exr", options), {"none has", "View Layer > Passes > Diffuse Direct, Shadow"});
}

TEST(BlenderFile, MissingOrBrokenLightIsNamed) {
  const TemporaryFolder folder;
  BlenderFile file;
  file.Write(folder / "a.exr");
  ExpectRefusal(ReadGuides(folder / "a.exr", WithLight()),
                {"has no layer luminance, shadow", "View Layer > Passes > Diffuse Direct, Shadow"});
  AddColor(
      "DiffDir", [](std::size_t i, int) { return i == 50 ? std::nanf("") : 1.0f; }, file);
  AddColor(
      "Shadow", [](std::size_t, int) { return 1.0f; }, file);
  file.Write(folder / "b.exr");
  ExpectRefusal(ReadGuides(folder / "b.exr", WithLight()), {"b.exr", "luminance"});
  file.Drop("Shadow.B");
  file.Write(folder / "c.exr");
  ExpectRefusal(ReadGuides(folder / "c.exr", WithLight()), {"has no layer shadow", "View Layer > Passes > Shadow"});
}

TEST(BlenderFile, EdgesAreCompletedFromTheirNeighbours) {
  const TemporaryFolder folder;
  BlenderFile file;
  for (std::size_t i = 0; i < file.Pixels(); ++i)
    file.Channel("Combined.A")[i] = file.Channel("Depth.Z")[i] < 1e9f ? 1.0f : 0.0f;
  const std::size_t missed = 15 * 40 + 30, blank = 20 * 40 + 30, lonely = 0;
  file.Channel("Combined.A")[missed] = 0.25f;
  file.Channel("Depth.Z")[missed] = 1e10f;
  for (const char* axis : {"X", "Y", "Z"}) {
    file.Channel(std::string("Position.") + axis)[missed] = 0.0f;
    file.Channel(std::string("Normal.") + axis)[missed] *= 0.02f;  // an average with background
    file.Channel(std::string("Normal.") + axis)[blank] = 0.0f;
  }
  file.Channel("Combined.A")[lonely] = 0.5f;  // a volume: something, but no surface anywhere near
  file.Write(folder / "shot.exr");
  const auto guides = ReadGuides(folder / "shot.exr", WithObjects());
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(guides->Plane(Layer::kCoverage)[missed], 0.25f);
  EXPECT_EQ(guides->Plane(Layer::kDepth)[missed], file.Channel("Depth.Z")[missed - 40]);
  EXPECT_EQ(guides->Vec3(Layer::kPosition, missed), guides->Vec3(Layer::kPosition, missed - 40));
  EXPECT_NEAR(guides->Vec3(Layer::kNormal, missed).z, 1.0f, 1e-4f);
  EXPECT_NEAR(guides->Vec3(Layer::kNormal, blank).z, 1.0f, 1e-5f);
  EXPECT_EQ(guides->Plane(Layer::kCoverage)[lonely], 0.0f);
}

TEST(BlenderPasses, BecomeGuidesInOurSpaces) {
  GuideSet passes(2, 1);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kPosition}) passes.Add(layer);
  passes.Plane(Layer::kCoverage)[0] = 1.0f;
  passes.Plane(Layer::kNormal, 2)[0] = 1.0f;  // up, in Blender's axes
  passes.Plane(Layer::kDepth)[0] = 3.0f, passes.Plane(Layer::kDepth)[1] = 1e10f;
  for (int c = 0; c < 3; ++c) passes.Plane(Layer::kPosition, c)[0] = float(c + 1);  // x 1, y 2, z 3
  GuideCamera camera;  // looks straight down from above: world +Y is towards the viewer
  camera.view_from_world = glm::dmat4(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
  ASSERT_TRUE(ConvertBlenderPasses(camera, {}, {}, "a.exr", passes));
  EXPECT_EQ(passes.Vec3(Layer::kNormal, 0), glm::vec3(0, 0, 1));
  EXPECT_EQ(passes.Vec3(Layer::kPosition, 0), glm::vec3(1, 3, -2));
  EXPECT_TRUE(std::isinf(passes.Plane(Layer::kDepth)[1]));
}

}  // namespace
}  // namespace scumble
