// Scenes that are broken, by accident or on purpose: each loads or is refused with an error that names the file. Most
// of these tests are most useful under AddressSanitizer.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <limits>
#include <memory>
#include <set>

#include "core/image/hash.h"
#include "core/io/picture_file.h"
#include "guidegen/load/texture_budget.h"
#include "guidegen/load_scene.h"
#include "guidegen/scene_textures.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Hostile : public RefusedScenes {
 protected:
  // Loads, whatever it is. True where it loaded; every index in it must then be right.
  bool Survives(const std::filesystem::path& path) {
    const Expected<Scene> scene = LoadScene(path);
    if (!scene) {
      EXPECT_EQ(scene.error().kind, ErrorKind::kInput) << scene.error().message;
      EXPECT_THAT(scene.error().message, HasSubstr(path.filename().string()));
      return false;
    }
    for (const Mesh& mesh : scene->meshes) {
      EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
      EXPECT_TRUE(mesh.tangents.empty() || mesh.tangents.size() == mesh.positions.size());
      for (const glm::uvec3& triangle : mesh.triangles) {
        EXPECT_LT(std::max({triangle.x, triangle.y, triangle.z}), mesh.positions.size());
      }
      for (const glm::vec3& normal : mesh.normals) EXPECT_NEAR(glm::length(normal), 1.0f, 1e-4f);
    }
    return true;
  }

  // A file with one of everything.
  GltfBuilder Everything() {
    GltfBuilder b;
    Picture picture(2, 2);
    EXPECT_TRUE(WritePicture(Path("made.png"), picture).ok());
    std::ifstream stream(Path("made.png"), std::ios::binary);
    const std::vector<unsigned char> png{std::istreambuf_iterator<char>(stream), {}};
    const int triangle = b.Triangle("Leaf");
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["NORMAL"] = b.Floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    attributes["TEXCOORD_0"] = b.Floats({0, 0, 1, 0, 0, 1}, 2);
    attributes["COLOR_0"] = b.Floats({1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, 4);
    b.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.View(std::vector<std::uint16_t>{2})}, {"componentType", kUshort}}},
        {"values", {{"bufferView", b.View(std::vector<float>{0, 2, 0})}}}};
    b.Append("images", {{"bufferView", b.View(png)}, {"mimeType", "image/png"}});
    b.Append("samplers", {{"wrapS", 33071}});
    b.Append("textures", {{"source", 0}, {"sampler", 0}});
    b.Append("materials",
             {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}, {"baseColorTexture", {{"index", 0}}}}},
              {"normalTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}},
              {"alphaMode", "MASK"}});
    b.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}});
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"color", {1, 1, 1}}, {"spot", {{"outerConeAngle", 0.5}}}}};
    b.json["extensionsUsed"] = {"KHR_lights_punctual"};
    b.Root({{"camera", 0}, {"rotation", {0, 0, 0, 1}}, {"scale", {1, 1, 1}}});
    b.Root({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
            {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.json["nodes"][triangle]["extras"] = {{"a", {1, 2, {{"b", "c"}}}}};
    return b;
  }
};

TEST_F(Hostile, NotAFile) {
  EXPECT_THAT(Refusal(Path("nowhere.glb")), HasSubstr("no such file"));
  std::filesystem::create_directory(Path("folder.glb"));
  Refusal(Path("folder.glb"));
  for (const char* name : {"empty.glb", "empty.gltf", "empty.obj", "empty.ply"}) Refusal(Write(name, std::string()));
  for (const char* name : {"text.glb", "text.gltf", "text.ply"}) Refusal(Write(name, std::string("hello, world\n")));
  const std::string message = Refusal(Write("scene.fbx", std::string("x")));
  EXPECT_THAT(message, HasSubstr(".glb, .gltf, .obj or .ply"));
  const Expected<Scene> blend = LoadScene(Write("scene.BLEND", std::string("BLENDER")));
  ASSERT_FALSE(blend.ok());
  EXPECT_EQ(blend.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(blend.error().message, HasSubstr("export"));
}

TEST_F(Hostile, IndexBeyondTheVertices) {
  GltfBuilder b;
  b.Triangle();
  b.json["meshes"][0]["name"] = "Cube";
  b.json["meshes"][0]["primitives"][0]["indices"] = b.Indices({0, 1, 3});
  const std::string message = Refusal(b);
  EXPECT_THAT(message, HasSubstr("'Cube'"));
  EXPECT_THAT(message, HasSubstr("accessor 2 has the index 3 at place 2, but there are only 3 vertices"));
}

TEST_F(Hostile, AccessorsBeyondTheirData) {
  const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
  for (const std::uint64_t value :
       {std::uint64_t(4), std::uint64_t(1) << 32, std::uint64_t(1) << 61, huge / 12 + 1, huge}) {
    GltfBuilder b;
    b.Triangle();
    b.json["accessors"][0]["count"] = value;
    Refusal(b);
    b.json["accessors"][0]["count"] = 3;
    b.json["accessors"][0]["byteOffset"] = value;
    Refusal(b);
    b.json["accessors"][0]["byteOffset"] = 0;
    b.json["bufferViews"][0]["byteOffset"] = value == 4 ? 40 : value;
    Refusal(b);
    b.json["bufferViews"][0]["byteOffset"] = 0;
    b.json["bufferViews"][0]["byteLength"] = value == 4 ? 400 : value;
    Refusal(b);
  }
  GltfBuilder b;
  b.Triangle();
  b.json["accessors"][0].erase("bufferView");
  b.json["accessors"][0]["count"] = 400'000'000;
  Refusal(b);
}

TEST_F(Hostile, PositionsThatAreNoNumbers) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    GltfBuilder b;
    b.Triangle();
    b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = b.Floats({0, 0, 0, 1, bad, 0, 0, 1, 0}, 3);
    const std::string message = Refusal(b);
    EXPECT_THAT(message, HasSubstr("mesh 0, POSITION: accessor 2"));
    EXPECT_THAT(message, HasSubstr("vertex 1"));
  }
  Refusal(Write("nan.ply", std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                                       "property float z\nend_header\nnan 0 0\n")));
}

TEST_F(Hostile, NodesThatAreNoTree) {
  GltfBuilder b;
  const int node = b.Triangle();
  b.json["nodes"][node]["children"] = {node};
  EXPECT_THAT(Refusal(b), HasSubstr("reached twice"));
  b.Append("nodes", {{"children", {node}}});
  b.json["nodes"][node]["children"] = {1};
  EXPECT_THAT(Refusal(b), HasSubstr("reached twice"));
  b.json["nodes"][node].erase("children");
  b.json["scenes"][0]["nodes"] = {0, 0};
  EXPECT_THAT(Refusal(b), HasSubstr("reached twice"));
  b.json["scenes"][0]["nodes"] = {7};
  EXPECT_THAT(Refusal(b), HasSubstr("does not exist"));
}

TEST_F(Hostile, DeepNesting) {
  GltfBuilder b;
  for (int i = 0; i < 100'000; ++i) b.json["nodes"].push_back({{"children", {i + 1}}});
  b.json["nodes"].push_back(json::object());
  b.json["scenes"][0]["nodes"] = {0};
  EXPECT_THAT(Refusal(b), HasSubstr("levels deep"));
  const std::string deep =
      "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}";
  EXPECT_THAT(Refusal(Write("deep.gltf", deep)), HasSubstr("levels deep"));
}

TEST_F(Hostile, WrongReferences) {
  const GltfBuilder whole = Everything();
  ASSERT_TRUE(Survives(Write("whole.glb", whole.Glb())));
  for (const char* pointer :
       {"/meshes/0/primitives/0/attributes/POSITION", "/meshes/0/primitives/0/attributes/NORMAL",
        "/meshes/0/primitives/0/indices", "/meshes/0/primitives/0/material", "/accessors/0/bufferView",
        "/accessors/0/sparse/indices/bufferView", "/accessors/0/sparse/values/bufferView", "/bufferViews/0/buffer",
        "/materials/0/normalTexture/index", "/textures/0/source", "/images/0/bufferView", "/nodes/0/mesh",
        "/nodes/1/camera", "/nodes/2/extensions/KHR_lights_punctual/light", "/scene", "/scenes/0/nodes/0"}) {
    GltfBuilder b = whole;
    b.json[json::json_pointer(pointer)] = 99;
    EXPECT_NE(Refusal(b), "") << pointer;
  }
}

TEST_F(Hostile, WrongVersionsAndContainers) {
  GltfBuilder b;
  b.Triangle();
  std::vector<unsigned char> glb = b.Glb();
  b.json["asset"]["version"] = "1.0";
  EXPECT_THAT(Refusal(b), HasSubstr("expected glTF 2.0"));
  glb[4] = 1;
  EXPECT_THAT(Refusal(Write("one.glb", glb)), HasSubstr("is binary glTF 1;"));
  // The BIN chunk declares eight bytes more than the file has.
  glb[4] = 2;
  const std::size_t chunk = 20 + (glb[12] | glb[13] << 8);
  glb[chunk] = static_cast<unsigned char>(glb[chunk] + 8);
  EXPECT_THAT(Refusal(Write("long.glb", glb)), HasSubstr("does not fit"));
}

TEST_F(Hostile, GltfCutShortAnywhere) {
  const std::vector<unsigned char> glb = Everything().Glb();
  for (std::size_t length = 0; length < glb.size(); length += 7) {
    EXPECT_FALSE(Survives(Write("cut.glb", std::span(glb).first(length)))) << length;
  }
}

TEST_F(Hostile, GltfWithFlippedBytes) {
  const std::vector<unsigned char> glb = Everything().Glb();
  int loaded = 0;
  for (int round = 0; round < 700; ++round) {
    std::vector<unsigned char> bytes = glb;
    const int flips = 1 + static_cast<int>(Hash(round, 0) % 4);
    for (int i = 1; i <= flips; ++i) {
      bytes[Hash(round, i, 0) % bytes.size()] ^= static_cast<unsigned char>(1 + Hash(round, i, 1) % 255);
    }
    loaded += Survives(Write("flip.glb", bytes));
  }
  EXPECT_GT(loaded, 0);
}

// Every value of the JSON in turn, and every list and object, becomes something that it should not be.
TEST_F(Hostile, GltfWithEveryValueReplaced) {
  const GltfBuilder whole = Everything();
  const json junk = {nullptr, -1, 4294967296, 1e300, "x", json::array(), json::object()};
  const json flat = whole.json.flatten();
  std::set<std::string> pointers;
  for (const auto& [pointer, value] : flat.items()) {
    for (json::json_pointer at(pointer); !at.empty(); at = at.parent_pointer()) pointers.insert(at.to_string());
  }
  for (const std::string& pointer : pointers) {
    for (const json& replacement : junk) {
      GltfBuilder b = whole;
      b.json[json::json_pointer(pointer)] = replacement;
      Survives(Write("junk.glb", b.Glb()));
    }
  }
}

TEST_F(Hostile, ObjAndPlyCutShortAndFlipped) {
  std::string obj =
      "mtllib none.mtl\no A\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\nv 0.5 2 0 1 0 0\n";
  obj +=
      "vt 0 0\nvt 1 0\nvn 0 0 1\ns 1\nusemtl m\nf 1/1/1 2/2/1 3/1/1 4/2/1 5/1/1\nf -5 -4 -3\ng B\ns off\nf 1//1 2//1 "
      "3//1\n";
  std::string ascii = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  ascii +=
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int "
      "vertex_indices\n";
  ascii += "end_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n4 0 1 2 3\n";
  std::string binary = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n";
  binary += "property float z\nelement face 1\nproperty list uint8 uint32 vertex_indices\nend_header\n";
  const float xyz[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  binary.append(reinterpret_cast<const char*>(xyz), sizeof xyz);
  binary += std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  const std::pair<std::string, std::string> files[] = {{"a.obj", obj}, {"a.ply", ascii}, {"b.ply", binary}};
  for (const auto& [name, whole] : files) {
    EXPECT_TRUE(Survives(Write(name, whole))) << name;
    for (std::size_t length = 0; length < whole.size(); length += 3) Survives(Write(name, whole.substr(0, length)));
    for (int round = 0; round < 300; ++round) {
      std::string bytes = whole;
      for (int i = 0; i < 3; ++i) {
        bytes[Hash(round, i, 2) % bytes.size()] = static_cast<char>(Hash(round, i, 3));
      }
      Survives(Write(name, bytes));
    }
  }
}

TEST_F(Hostile, ObjIndicesBeyondTheVertices) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nvn 0 0 1\n";
  for (const char* face : {"f 1 2 9", "f 1 2 3 4 9", "f 1 2 -9", "f 1/7 2 3", "f 1//2 2 3", "f 0 1 2",
                           "f 1 2 3 4 5 99999999999999", "f 1 2 3 4 -99"}) {
    EXPECT_NE(Refusal(Write("bad.obj", vertices + face + "\n")), "") << face;
  }
}

TEST_F(Hostile, PlyWithVerticesTwice) {
  const std::string element = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  for (const std::string& second : {element + normals, element, std::string("element vertex 0\n")}) {
    const std::string header = "ply\nformat ascii 1.0\n" + element + second + face + "end_header\n";
    EXPECT_THAT(Refusal(Write("twice.ply", header + "0 0 0\n0 0 0 0 0 1\n3 0 1 1\n")),
                HasSubstr("second 'element vertex'"));
  }
}

// A pipe without a writer: reading it would never end.
TEST_F(Hostile, ObjTexturesThatAreNoFiles) {
  ASSERT_EQ(mkfifo(Path("pipe.png").c_str(), 0600), 0);
  std::filesystem::create_directory(Path("folder.png"));
  for (const std::string name : {"pipe.png", "folder.png"}) {
    Write("paint.mtl", "newmtl paint\nmap_Kd " + name + "\n");
    const Expected<Scene> scene =
        LoadScene(Write("a.obj", std::string("mtllib paint.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")));
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_THAT(scene->warnings, ::testing::ElementsAre(::testing::AllOf(HasSubstr("texture"), HasSubstr(name))));
    ASSERT_EQ(scene->textures.size(), 1u);
    EXPECT_TRUE(scene->textures[0].empty());
  }
}

// A thousand nodes show one mesh, a million triangles without data: a file of some kilobytes, a thousand million
// triangles.
TEST_F(Hostile, InstancesCountEachAgainstTheLimits) {
  GltfBuilder b;
  b.Triangle();
  b.json["accessors"].push_back({{"componentType", kFloat}, {"count", 3'000'000}, {"type", "VEC3"}});
  b.json["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 2}}}};
  for (int i = 1; i < 1000; ++i) b.Root({{"mesh", 0}});
  EXPECT_THAT(Refusal(b), HasSubstr("at least 501000000 vertices, each instance counted; expected at most 500000000"));
  b.json["meshes"][0]["primitives"][0]["mode"] = 5;
  EXPECT_THAT(Refusal(b), HasSubstr("at least 500999666 triangles, each instance counted; expected at most 500000000"));
}

TEST_F(Hostile, InstancesOfNextToNothingCountToo) {
  GltfBuilder b;
  b.Triangle();
  const json primitive = b.json["meshes"][0]["primitives"][0];
  for (int i = 1; i < 1001; ++i) b.json["meshes"][0]["primitives"].push_back(primitive);
  for (int i = 1; i < 1000; ++i) b.Root({{"mesh", 0}});
  EXPECT_THAT(Refusal(b), HasSubstr("at least 1000001 instances"));
}

TEST_F(Hostile, PlyPromisesMoreThanItHas) {
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  Refusal(Write("a.ply", head + "element vertex 4000000000\n" + xyz + "end_header\n" + std::string(100, '\0')));
  Refusal(Write("b.ply", head + "element vertex 18446744073709551615\n" + xyz + "end_header\n"));
  Refusal(Write("c.ply", head + "element vertex -1\n" + xyz + "end_header\n"));
  Refusal(Write("d.ply", head + "element vertex 1\nproperty float x\nend_header\n0000"));
  Refusal(Write("e.ply", head + "element face 1\nproperty list int int vertex_indices\nend_header\n" +
                             std::string("\xff\xff\xff\x7f", 4)));
  Refusal(Write("f.ply", "ply\nformat binary_middle_endian 1.0\nend_header\n"));
  Refusal(Write("g.ply", "ply\nelement vertex 0\nend_header\n"));
}

// Pictures are counted together, to the last pixel, and one that is refused is not counted: 3 of 100 × 50 fit into
// 15,000 pixels, and nothing but an empty one does beside them.
TEST(PictureBudget, CountsAllPicturesOfAScene) {
  Picture picture;
  picture.width = 100;
  picture.height = 50;
  PictureBudget budget(15'000);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(budget.Take("a.glb", picture)) << i;
  picture.width = picture.height = 1;
  const Status refused = budget.Take("a.glb", picture);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  EXPECT_EQ(refused.error().message,
            "a.glb has textures of at least 15001 pixels together; expected at most 15000: make them smaller");
  EXPECT_TRUE(budget.Take("a.glb", Picture()));
  // The largest that can be read: four of them, 8 bytes a pixel.
  picture.width = picture.height = 1 << 14;
  PictureBudget whole;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(whole.Take("a.glb", picture)) << i;
  EXPECT_FALSE(whole.Take("a.glb", picture));
}

// Four textures of 2^28 pixels are taken, a fifth is refused, whether the others were decoded at once or before. Their
// pixels are not there: only the sizes count.
TEST(PictureBudget, HoldsForAScenesTextures) {
  const auto encoded = std::make_shared<EncodedTexture>();
  encoded->decode = []() -> Expected<Picture> {
    Picture picture;
    picture.width = picture.height = 1 << 14;
    return picture;
  };
  Scene scene;
  scene.name = "bomb.glb";
  for (int more = 0; more < 2; ++more) {
    for (int i = 0; i < 2; ++i) {
      scene.textures.emplace_back();
      scene.encoded_textures.push_back(encoded);
    }
    EXPECT_TRUE(DecodeAllTextures(scene)) << more;
  }
  scene.textures.emplace_back();
  scene.encoded_textures.push_back(encoded);
  const auto refused = DecodeAllTextures(scene);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  EXPECT_THAT(refused.error().message, HasSubstr("bomb.glb has textures of at least 1342177280 pixels together"));
}

// If the header shows an excess, nothing is decoded.
TEST(PictureBudget, RefusesByTheHeader) {
  const auto encoded = std::make_shared<EncodedTexture>();
  int decoded = 0;
  encoded->count_pixels = [] { return Expected<std::uint64_t>(std::uint64_t(1) << 29); };
  encoded->decode = [&]() -> Expected<Picture> {
    Picture picture;  // the pixels are not there: only the sizes count
    picture.width = 1 << 14, picture.height = 1 << 15;
    return ++decoded, picture;
  };
  Scene scene;
  scene.name = "bomb.glb";
  scene.textures.resize(3);
  scene.encoded_textures.assign(3, encoded);
  const auto refused = DecodeAllTextures(scene);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("bomb.glb has textures of at least 1610612736 pixels together"));
  EXPECT_EQ(decoded, 2);
}

}  // namespace
}  // namespace scumble
