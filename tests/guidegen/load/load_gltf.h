// What the tests of the glTF reader share.
#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "core/io/picture_file.h"
#include "guidegen/load_scene.h"
#include "tests/support/gltf_builder.h"

namespace scumble {

class LoadGltf : public LoaderTest {
 protected:
  Scene Load(const GltfBuilder& builder) { return Load(Write("scene.glb", builder.Glb())); }
  Scene Load(const std::filesystem::path& path) {
    Expected<Scene> scene = LoadScene(path);
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return scene ? std::move(*scene) : Scene{};
  }
  std::string ErrorOf(const GltfBuilder& builder) { return ErrorOf(Write("scene.glb", builder.Glb())); }
  std::string ErrorOf(const std::filesystem::path& path) {
    const Expected<Scene> scene = LoadScene(path);
    EXPECT_FALSE(scene.ok());
    if (scene) return "";
    EXPECT_EQ(scene.error().kind, ErrorKind::kInput);
    EXPECT_THAT(scene.error().message, ::testing::HasSubstr(path.filename().string()));
    return scene.error().message;
  }

  // A 2 × 1 PNG, red and green.
  std::vector<unsigned char> Png() {
    Picture picture(2, 1);
    picture.rgba = {65535, 0, 0, 65535, 0, 65535, 0, 65535};
    EXPECT_TRUE(WritePicture(Path("made.png"), picture).ok());
    std::ifstream stream(Path("made.png"), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  // A unit square with UVs whose first material has a texture in each of the two slots.
  GltfBuilder TexturedSquare() {
    GltfBuilder b;
    const int position = b.Floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
    const int uv = b.Floats({0, 1, 1, 1, 1, 0, 0, 0}, 2);
    const int uv1 = b.Floats({0, 0, 2, 0, 2, 2, 0, 2}, 2);
    const int index = b.Indices({0, 1, 2, 0, 2, 3});
    b.Append("images", {{"bufferView", b.View(Png())}, {"mimeType", "image/png"}});
    b.Append("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
    b.Append("textures", {{"source", 0}, {"sampler", 0}});
    b.Append("materials", {{"name", "Paint"},
                           {"pbrMetallicRoughness",
                            {{"baseColorFactor", {0.25, 0.5, 0.75, 1.0}}, {"baseColorTexture", {{"index", 0}}}}},
                           {"normalTexture", {{"index", 0}, {"scale", 0.5}}}});
    const int mesh = b.Mesh({{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}, {"TEXCOORD_1", uv1}}},
                              {"indices", index},
                              {"material", 0}}});
    b.Root({{"name", "Square"}, {"mesh", mesh}});
    return b;
  }
};

inline std::vector<std::string> ObjectNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const Instance& instance : scene.instances) names.push_back(instance.object);
  return names;
}

inline void ExpectClose(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

}  // namespace scumble
