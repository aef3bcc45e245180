// Textures are read and decoded when a layer needs them, and not before: missing or damaged ones are reported then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "guidegen/load_scene.h"
#include "guidegen/scene_textures.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr TextureLoading kLater = TextureLoading::kWhenNeeded;

GuidegenOptions OptionsFor(LayerSet layers) {
  GuidegenOptions options;
  options.width = options.height = 8;
  options.layers = layers;
  return options;
}

class RequiredTextures : public LoaderTest {
 protected:
  // A square whose base colour is the image, without a normal map.
  static GltfBuilder SquareWith(const nlohmann::json& image) {
    GltfBuilder b;
    const int position = b.Floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
    const int uv = b.Floats({0, 1, 1, 1, 1, 0, 0, 0}, 2);
    b.Append("images", image);
    b.Append("textures", {{"source", 0}});
    b.Append("materials", {{"name", "Paint"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    b.Root({{"name", "Square"},
            {"mesh", b.Mesh({{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}},
                              {"indices", b.Indices({0, 1, 2, 0, 2, 3})},
                              {"material", 0}}})}});
    return b;
  }
  std::filesystem::path WriteSquare(const GltfBuilder& b) {
    nlohmann::json json = b.json;
    Write("geo.bin", b.bin);
    json["buffers"] = {{{"byteLength", b.bin.size()}, {"uri", "geo.bin"}}};
    return Write("square.gltf", json.dump());
  }
  void WriteRed(const std::string& name) {
    Picture red(1, 1);
    red.rgba = {65535, 0, 0, 65535};
    ASSERT_TRUE(WritePicture(Path(name), red).ok());
  }
  // Of a scene whose textures wait; the message where these layers need what cannot be read.
  static std::string ErrorFor(const std::filesystem::path& path, LayerSet layers) {
    Expected<Scene> scene = LoadScene(path, {kLater, {}});
    if (!scene) return "not loaded: " + scene.error().message;
    const Expected<DecodedTextures> decoded = DecodeTextures(*scene, OptionsFor(layers));
    if (decoded) return {};
    EXPECT_EQ(static_cast<int>(decoded.error().kind), static_cast<int>(ErrorKind::kInput));
    return decoded.error().message;
  }
};

TEST_F(RequiredTextures, AreDecodedOnceAndForTheLayersThatNeedThem) {
  WriteRed("red.png");
  const std::filesystem::path path = WriteSquare(SquareWith({{"uri", "red.png"}}));
  Expected<Scene> scene = LoadScene(path, {kLater, {}});
  ASSERT_TRUE(scene.ok());
  ASSERT_EQ(scene->textures.size(), 1u);
  EXPECT_TRUE(scene->textures[0].empty());
  const Scene copy = *scene;
  EXPECT_EQ(DecodeTextures(*scene, OptionsFor({Layer::kLuminance}))->count, 0);
  EXPECT_TRUE(scene->textures[0].empty());
  const Expected<DecodedTextures> decoded = DecodeTextures(*scene, OptionsFor({Layer::kAlbedo}));
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->count, 1);
  EXPECT_EQ(decoded->bytes, 8u) << "four channels of two bytes";
  EXPECT_THAT(scene->textures[0].rgba, ElementsAre(65535, 0, 0, 65535));
  EXPECT_EQ(DecodeTextures(*scene, OptionsFor({Layer::kAlbedo}))->count, 0) << "it is there";
  // An earlier copy can still decode its textures.
  Scene other = copy;
  EXPECT_EQ(DecodeAllTextures(other)->count, 1);
  EXPECT_EQ(other.textures[0].rgba, scene->textures[0].rgba);
  // And so has a scene over time.
  const Expected<AnimatedScene> animated = AnimatedScene::Load(path, {"", {kLater, {}}});
  ASSERT_TRUE(animated.ok());
  Expected<Scene> posed = animated->SceneAt(0.0);
  ASSERT_TRUE(posed.ok());
  EXPECT_EQ(DecodeTextures(*posed, OptionsFor({Layer::kAlbedo}))->count, 1);
  EXPECT_EQ(posed->textures[0].rgba, scene->textures[0].rgba);
}

// A style of normals works without a lost picture; a style that needs colours gets an error that names it.
TEST_F(RequiredTextures, AMissingPictureIsAnErrorOnlyWhereItIsNeeded) {
  const std::filesystem::path path = WriteSquare(SquareWith({{"uri", "lost.png"}}));
  EXPECT_EQ(ErrorFor(path, {}), "");
  EXPECT_EQ(ErrorFor(path, {Layer::kLuminance, Layer::kPosition}), "");
  EXPECT_THAT(ErrorFor(path, {Layer::kAlbedo}), HasSubstr("lost.png"));
  EXPECT_THAT(ErrorFor(path, {Layer::kAlbedo}), HasSubstr("put it beside the scene"));
  EXPECT_FALSE(LoadScene(path).ok()) << "who asks for all of the scene asks for its pictures";
}

TEST_F(RequiredTextures, ABrokenPictureIsAnErrorOnlyWhereItIsNeeded) {
  Write("noise.png", std::string("no picture"));
  EXPECT_EQ(ErrorFor(WriteSquare(SquareWith({{"uri", "noise.png"}})), {}), "");
  EXPECT_THAT(ErrorFor(Path("square.gltf"), {Layer::kAlbedo}), HasSubstr("neither PNG, JPEG nor WebP"));
  // Inside the file, and cut short behind its first bytes.
  GltfBuilder b = SquareWith({{"mimeType", "image/png"}});
  b.json["images"][0]["bufferView"] = b.View(std::vector<unsigned char>{0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0});
  const std::filesystem::path glb = Write("square.glb", b.Glb());
  EXPECT_EQ(ErrorFor(glb, {}), "");
  EXPECT_THAT(ErrorFor(glb, {Layer::kAlbedo}), HasSubstr("image 0"));
  // A fault in the file itself is reported at once: the view is not in its buffer.
  b.json["bufferViews"].back()["byteLength"] = 1 << 20;
  EXPECT_FALSE(LoadScene(Write("torn.glb", b.Glb()), {kLater, {}}).ok());
}

// A picture's ending does not make a file a picture: glTF lets buffers be named so.
TEST_F(RequiredTextures, ABufferMayHaveAPicturesName) {
  WriteRed("red.png");
  GltfBuilder b = SquareWith({{"uri", "red.png"}});
  Write("geo.png", b.bin);
  b.json["buffers"] = {{{"byteLength", b.bin.size()}, {"uri", "geo.png"}}};
  const Expected<Scene> scene = LoadScene(Write("square.gltf", b.json.dump()));
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->meshes[0].triangles.size(), 2u);
  EXPECT_THAT(scene->textures[0].rgba, ElementsAre(65535, 0, 0, 65535));
}

TEST_F(RequiredTextures, NamesMayHaveEscapesAndSignsOfTheirOwn) {
  WriteRed("50% a+b.png");
  for (const char* uri : {"50%25%20a+b.png", "50% a+b.png", "50% a%2bb.png", "50% a%2Bb.png"}) {
    EXPECT_EQ(ErrorFor(WriteSquare(SquareWith({{"uri", uri}})), {Layer::kAlbedo}), "") << uri;
  }
}

// Wavefront files are often passed on without their pictures: what cannot be read is left out with a warning, once a
// layer needs it, and the material is what it would be had the picture never been named.
TEST_F(RequiredTextures, WavefrontDoesWithoutThemAndSaysSoWhereTheyAreNeeded) {
  WriteRed("red.png");
  Write("lib.mtl", std::string("newmtl lost\nKd 0 0 0\nKs 0.5 0.25 0.125\nmap_Kd lost.png\n"
                               "newmtl red\nKd 0 1 0\nmap_Kd red.png\n"));
  const std::filesystem::path path =
      Write("a.obj", std::string("mtllib lib.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                 "usemtl lost\nf 1/1 2/2 3/3\nusemtl red\nf 1/1 3/3 2/2\n"));
  Expected<Scene> scene = LoadScene(path, {kLater, {}});
  ASSERT_TRUE(scene.ok());
  EXPECT_THAT(scene->warnings, IsEmpty());
  const Expected<DecodedTextures> none = DecodeTextures(*scene, OptionsFor({}));
  ASSERT_TRUE(none.ok());
  EXPECT_THAT(none->warnings, IsEmpty());
  EXPECT_EQ(none->count, 0);
  const Expected<DecodedTextures> some = DecodeTextures(*scene, OptionsFor({Layer::kAlbedo}));
  ASSERT_TRUE(some.ok());
  EXPECT_EQ(some->count, 1);
  EXPECT_THAT(some->warnings, ElementsAre(HasSubstr("lost.png")));
  const Material& lost = scene->materials[0];
  EXPECT_EQ(lost.name, "lost");
  EXPECT_EQ(lost.base_color_texture.texture, -1);
  EXPECT_EQ(lost.bsdf, Bsdf::kGlossy) << "a black Kd with a highlight is a metal; a texture in its place is not";
  EXPECT_EQ(lost.base_color, glm::vec4(0.5f, 0.25f, 0.125f, 1.0f));
  EXPECT_EQ(scene->materials[1].base_color, glm::vec4(1.0f)) << "the texture stands in place of Kd";
  const int red = scene->materials[1].base_color_texture.texture;
  ASSERT_GE(red, 0);
  EXPECT_THAT(scene->textures[std::size_t(red)].rgba, ElementsAre(65535, 0, 0, 65535));
  // All at once is the same scene with the same warning.
  const Expected<Scene> whole = LoadScene(path);
  ASSERT_TRUE(whole.ok());
  EXPECT_THAT(whole->warnings, ElementsAre(some->warnings.front()));
  EXPECT_EQ(whole->materials[0].base_color, lost.base_color);
}

}  // namespace
}  // namespace scumble
