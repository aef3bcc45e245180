// Meshes, objects and files of glTF. load_gltf_looks_test.cpp has materials, cameras and lights.
#include "tests/guidegen/load/load_gltf.h"

#include <cmath>

#include "tests/support/numbers.h"

namespace scumble {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST_F(LoadGltf, TriangleWithoutNormalsOrMaterial) {
  GltfBuilder b;
  b.Triangle();
  const Scene scene = Load(b);
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 3u);
  ASSERT_EQ(scene.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(scene.meshes[0].triangles[0], glm::uvec3(0, 1, 2));
  for (const glm::vec3& normal : scene.meshes[0].normals) ExpectClose(normal, {0, 0, 1}, 0);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].object, "Tri");
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].base_color, glm::vec4(1.0f));
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(scene.meshes[0].tangents.empty());
}

TEST_F(LoadGltf, HierarchyComposesInDouble) {
  GltfBuilder b;
  const int child = b.Triangle("Child");
  b.json["scenes"][0]["nodes"] = json::array();
  b.json["nodes"][child]["matrix"] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1};
  const double half = std::sqrt(0.5);
  b.Root({{"translation", {1e8, 0, 0}}, {"rotation", {0, 0, half, half}}, {"scale", {1, 2, 3}}, {"children", {child}}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.instances.size(), 1u);
  // The child's (1, 0, 0) turns to +Y, gets 0.1 added in x, is scaled to (0.1, 2, 0), turns to (-2, 0.1, 0).
  const glm::dvec4 p = scene.instances[0].world_from_object * glm::dvec4(1, 0, 0, 1);
  EXPECT_NEAR(p.x, 1e8 - 2.0, 1e-6);
  EXPECT_NEAR(p.y, 0.1, 1e-12);
  const glm::dvec4 z = scene.instances[0].world_from_object * glm::dvec4(0, 0, 1, 0);
  EXPECT_NEAR(z.z, 3.0, 1e-12);
}

TEST_F(LoadGltf, EveryIndexTypeAndNoneGiveTheSameMesh) {
  const std::vector<float> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  for (int type : {kUbyte, kUshort, kUint}) {
    GltfBuilder b;
    const int position = b.Floats(square, 3);
    const int view = type == kUbyte    ? b.View(std::vector<std::uint8_t>{0, 1, 2, 0, 2, 3})
                     : type == kUshort ? b.View(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})
                                       : b.View(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3});
    const int index = b.Accessor(view, type, 6, "SCALAR");
    b.Root({{"mesh", b.Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", index}}})}});
    const Scene scene = Load(b);
    ASSERT_EQ(scene.meshes.size(), 1u) << type;
    EXPECT_EQ(scene.meshes[0].triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}})) << type;
    EXPECT_EQ(scene.instances[0].object, "node_0");
  }
  GltfBuilder b;
  const int position = b.Floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  b.Root({{"mesh", b.Mesh({{{"attributes", {{"POSITION", position}}}}})}});
  const Scene scene = Load(b);
  EXPECT_EQ(scene.meshes[0].triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}}));
}

TEST_F(LoadGltf, StripsAndFansKeepTheirWinding) {
  for (int mode : {5, 6}) {
    GltfBuilder b;
    const int position = mode == 5 ? b.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, 3)
                                   : b.Floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0}, 3);
    b.Root({{"mesh", b.Mesh({{{"attributes", {{"POSITION", position}}}, {"mode", mode}}})}});
    const Scene scene = Load(b);
    ASSERT_EQ(scene.meshes[0].triangles.size(), 3u);
    for (const glm::uvec3& t : scene.meshes[0].triangles) {
      const auto& p = scene.meshes[0].positions;
      EXPECT_GT(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]).z, 0.0f);
    }
  }
}

TEST_F(LoadGltf, InterleavedAndNormalizedAttributes) {
  GltfBuilder b;
  // Per vertex: three floats, normal as three signed bytes with a pad, UV as two unsigned shorts.
  std::vector<unsigned char> bytes;
  const auto put = [&](const auto& value) {
    const auto* raw = reinterpret_cast<const unsigned char*>(&value);
    bytes.insert(bytes.end(), raw, raw + sizeof value);
  };
  const float xs[3] = {0, 1, 0}, ys[3] = {0, 0, 1};
  for (int i = 0; i < 3; ++i) {
    put(xs[i]), put(ys[i]), put(0.0f);
    put(std::int8_t(0)), put(std::int8_t(-127)), put(std::int8_t(-128)), put(std::int8_t(0));
    put(std::uint16_t(65535)), put(std::uint16_t(13107));
  }
  const int view = b.View(bytes, 20);
  const int position = b.Accessor(view, kFloat, 3, "VEC3", 0);
  const int normal = b.Accessor(view, kByte, 3, "VEC3", 12);
  const int uv = b.Accessor(view, kUshort, 3, "VEC2", 16);
  b.json["accessors"][normal]["normalized"] = true;
  b.json["accessors"][uv]["normalized"] = true;
  b.Root({{"mesh", b.Mesh({{{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}}}})}});
  const Scene scene = Load(b);
  EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(1, 0, 0));
  ExpectClose(scene.meshes[0].normals[2], glm::vec3(0, -std::sqrt(0.5f), -std::sqrt(0.5f)));
  EXPECT_EQ(scene.meshes[0].uvs[0][0].x, 1.0f);
  EXPECT_NEAR(scene.meshes[0].uvs[0][0].y, 0.2f, 1e-7f);
}

TEST_F(LoadGltf, SparseAccessors) {
  GltfBuilder b;
  b.Triangle();
  const int places = b.View(std::vector<std::uint16_t>{1, 2});
  const int values = b.View(std::vector<float>{5, 0, 0, 0, 7, 0});
  const json sparse = {{"count", 2},
                       {"indices", {{"bufferView", places}, {"componentType", kUshort}}},
                       {"values", {{"bufferView", values}}}};
  b.json["accessors"][0]["sparse"] = sparse;
  EXPECT_EQ(Load(b).meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {5, 0, 0}, {0, 7, 0}}));
  // Without a buffer view everything else is zero.
  b.json["accessors"][0].erase("bufferView");
  b.json["accessors"][0].erase("byteOffset");
  EXPECT_EQ(Load(b).meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {5, 0, 0}, {0, 7, 0}}));
}

TEST_F(LoadGltf, PrimitivesShareAnObjectAndDropWhatTheyDoNotUse) {
  GltfBuilder b;
  std::vector<float> many(3 * 100, 0.0f);
  for (int i = 0; i < 100; ++i) many[3 * i] = float(i * i), many[3 * i + 1] = float(i);
  const int position = b.Floats(many, 3);
  const json attributes = {{"POSITION", position}};
  const int mesh = b.Mesh({{{"attributes", attributes}, {"indices", b.Indices({7, 50, 99})}},
                           {{"attributes", attributes}, {"indices", b.Indices({0, 1, 2})}}});
  b.Root({{"name", "Pair"}, {"mesh", mesh}});
  b.Root({{"name", "Again"}, {"mesh", mesh}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.meshes.size(), 2u);
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.instances[0].object, "Pair");
  EXPECT_EQ(scene.instances[1].object, "Pair");
  EXPECT_EQ(scene.instances[3].mesh, 1);
  EXPECT_EQ(scene.meshes[0].positions, (std::vector<glm::vec3>{{49, 7, 0}, {2500, 50, 0}, {9801, 99, 0}}));
}

// A primitive's part of a shared list equals what a list of its own would give, in the order in which its triangles use
// it. No other part of the list is read: it may be NaN.
TEST_F(LoadGltf, SharedListsGiveWhatListsOfTheirOwnWould) {
  constexpr int kLong = 40;
  const std::vector<std::uint16_t> used = {31, 7, 12};
  const float nan = std::nanf("");
  // 17 is prime and divides no factor, so none is 0 and weights and directions can be used.
  const auto value = [](int attribute, int vertex, int c) {
    return float((attribute + 1) * (3 * vertex + 1) * (c + 2) % 17) / 16;
  };
  const auto build = [&](bool shared) {
    GltfBuilder b;
    const auto list = [&](int attribute, int components) {
      std::vector<float> values(std::size_t(kLong * components), nan);
      std::vector<float> own;
      for (const int vertex : used) {
        for (int c = 0; c < components; ++c) {
          own.push_back(values[std::size_t(vertex * components + c)] = value(attribute, vertex, c));
        }
      }
      return b.Floats(shared ? values : own, components);
    };
    const json attributes = {{"POSITION", list(0, 3)},
                             {"NORMAL", list(1, 3)},
                             {"TEXCOORD_0", list(2, 2)},
                             {"TEXCOORD_1", list(3, 2)},
                             {"COLOR_0", list(4, 4)},
                             {"TANGENT", list(5, 4)},
                             {"JOINTS_0", 0},
                             {"WEIGHTS_0", list(6, 4)},
                             {"_SCUMBLE_REST", list(7, 3)}};
    json primitive = {{"attributes", attributes}};
    const std::vector<std::uint8_t> joints((shared ? kLong : used.size()) * 4, 0);
    primitive["attributes"]["JOINTS_0"] = b.Accessor(b.View(joints), kUbyte, joints.size() / 4, "VEC4");
    primitive["indices"] = b.Indices(shared ? used : std::vector<std::uint16_t>{0, 1, 2});
    primitive["targets"] = {{{"POSITION", list(8, 3)}, {"NORMAL", list(9, 3)}, {"TANGENT", list(10, 3)}}};
    primitive["material"] = 0;
    b.Append("images", {{"bufferView", b.View(Png())}, {"mimeType", "image/png"}});
    b.Append("textures", {{"source", 0}});
    b.Append("materials", {{"normalTexture", {{"index", 0}}}});
    b.Mesh(json::array({primitive}));
    b.Root({{"mesh", 0}});
    b.Root({{"mesh", 0}, {"weights", {0.5}}});
    b.Append("skins", {{"joints", {0}}});
    b.Root({{"mesh", 0}, {"skin", 0}, {"weights", {0.25}}});
    return b;
  };
  GltfBuilder shared = build(true);
  const Scene expected = Load(build(false)), scene = Load(shared);
  ASSERT_EQ(scene.meshes.size(), 3u) << ::testing::PrintToString(scene.warnings);
  ASSERT_EQ(expected.meshes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Mesh &mesh = scene.meshes[i], &own = expected.meshes[i];
    EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}})) << i;
    EXPECT_EQ(mesh.positions, own.positions) << i;
    EXPECT_EQ(mesh.normals, own.normals) << i;
    EXPECT_EQ(mesh.uvs, own.uvs) << i;
    EXPECT_EQ(mesh.colors, own.colors) << i;
    EXPECT_FALSE(mesh.tangents.empty()) << i;
    EXPECT_EQ(mesh.tangents, own.tangents) << i;
    EXPECT_EQ(mesh.rest_positions, own.rest_positions) << i;
  }
  EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(value(0, 31, 0), value(0, 31, 1), value(0, 31, 2)));
  EXPECT_THAT(scene.warnings, ::testing::IsEmpty());
  shared.json["meshes"][0]["primitives"][0]["indices"] = shared.Indices({31, 7, 13});
  EXPECT_THAT(ErrorOf(shared), HasSubstr("NaN or infinity at vertex 13;")) << "as the file counts them";
}

// A choice is made anew for each primitive; values of sparse accessors stand at their vertices in the file.
TEST_F(LoadGltf, SharedListsMayBeSparse) {
  GltfBuilder b;
  std::vector<float> many(3 * 100, 0.0f);
  for (int i = 0; i < 100; ++i) many[std::size_t(3 * i)] = float(i), many[std::size_t(3 * i + 1)] = float(i * i);
  const int position = b.Floats(many, 3);
  b.json["accessors"][position]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", b.View(std::vector<std::uint16_t>{5, 60})}, {"componentType", kUshort}}},
      {"values", {{"bufferView", b.View(std::vector<float>{0, 0, 9, 0, 0, 8})}}}};
  const json attributes = {{"POSITION", position}};
  b.Root({{"mesh", b.Mesh({{{"attributes", attributes}, {"indices", b.Indices({60, 7, 8})}},
                           {{"attributes", attributes}, {"indices", b.Indices({8, 5, 60, 8, 60, 5})}}})}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 8}, {7, 49, 0}, {8, 64, 0}}));
  // Both sides of a triangle, each with its own normal.
  EXPECT_EQ(scene.meshes[1].positions,
            (std::vector<glm::vec3>{{8, 64, 0}, {0, 0, 9}, {0, 0, 8}, {8, 64, 0}, {0, 0, 8}, {0, 0, 9}}));
  EXPECT_EQ(scene.meshes[1].triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}}));
}

TEST_F(LoadGltf, NamesOfObjectsDiffer) {
  GltfBuilder b;
  const int a = b.Triangle("Leaf"), c = b.Triangle("Leaf"), d = b.Triangle("Leaf");
  const int lone = b.Triangle("Stone");
  const int e = b.Triangle("Leaf");
  b.Append("nodes", {{"name", "Tree"}, {"children", {a, c, e}}});
  b.Append("nodes", {{"name", "Bush"}, {"children", {d}}});
  b.json["scenes"][0]["nodes"] = {6, 5, lone};
  EXPECT_EQ(ObjectNames(Load(b)), (std::vector<std::string>{"Bush/Leaf", "Leaf", "Tree/Leaf", "Tree/Leaf#2", "Stone"}));
}

TEST_F(LoadGltf, AnAddedObjectRenamesNobody) {
  GltfBuilder b;
  b.Triangle("Leaf");
  const int rock = b.Triangle("Rock");
  EXPECT_EQ(ObjectNames(Load(b)), (std::vector<std::string>{"Leaf", "Rock"}));
  b.Triangle("Leaf");
  EXPECT_EQ(ObjectNames(Load(b)), (std::vector<std::string>{"Leaf", "Rock", "Leaf#2"}));
  // Before the others in the hierarchy, behind them in the file.
  const int child = b.Triangle("Rock");
  b.json["scenes"][0]["nodes"] = {b.Append("nodes", {{"name", "Heap"}, {"children", {child}}}), 0, rock, 2};
  EXPECT_EQ(ObjectNames(Load(b)), (std::vector<std::string>{"Heap/Rock", "Leaf", "Rock", "Leaf#2"}));
  // A name that is somebody's own is not given away.
  b.Triangle("Leaf#2");
  b.Triangle("Heap/Rock");
  EXPECT_EQ(ObjectNames(Load(b)),
            (std::vector<std::string>{"Heap/Rock#2", "Leaf", "Rock", "Leaf#3", "Leaf#2", "Heap/Rock"}));
}

TEST_F(LoadGltf, StylesAndPassIndicesOfObjects) {
  GltfBuilder gltf;
  gltf.Triangle("A");
  gltf.Root({{"name", "B"}, {"mesh", 0}, {"extras", {{"scumble", {{"style", "oil"}, {"pass_index", 7}}}}}});
  gltf.Root({{"name", "C"}, {"mesh", 0}, {"extras", {{"scumble", {{"pass_index", 32767}}}}}});
  const auto scene = LoadScene(Write("a.glb", gltf.Glb()));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->instances.size(), 3u);
  EXPECT_EQ(scene->instances[0].style, "");
  EXPECT_EQ(scene->instances[0].pass_index, 0);
  EXPECT_EQ(scene->instances[1].style, "oil");
  EXPECT_EQ(scene->instances[1].pass_index, 7);
  EXPECT_EQ(scene->instances[2].style, "");
  EXPECT_EQ(scene->instances[2].pass_index, 32767);
  // The custom property itself, as other exporters write it; ours goes before it.
  gltf.json["nodes"][0]["extras"] = {{"scumble_style", "../ink"}};
  gltf.json["nodes"][1]["extras"]["scumble_style"] = "wax";
  gltf.json["materials"] = {{{"name", "M"}, {"extras", {{"scumble_style", "chalk"}}}},
                            {{"name", "N"}, {"extras", {{"scumble", {{"style", "coal"}}}}}}};
  const auto styled = LoadScene(Write("b.glb", gltf.Glb()));
  ASSERT_TRUE(styled) << styled.error().message;
  EXPECT_EQ(styled->instances[0].style, "../ink");
  EXPECT_EQ(styled->instances[1].style, "oil");
  EXPECT_EQ(styled->materials[0].style, "chalk");
  EXPECT_EQ(styled->materials[1].style, "coal");
  for (const nlohmann::json& bad : {nlohmann::json{{"style", 3}}, nlohmann::json{{"pass_index", -1}},
                                    nlohmann::json{{"pass_index", "7"}}, nlohmann::json{{"pass_index", 32768}}}) {
    gltf.json["nodes"][1]["extras"]["scumble"] = bad;
    const auto refused = LoadScene(Write("bad.glb", gltf.Glb()));
    ASSERT_FALSE(refused) << bad;
    EXPECT_THAT(refused.error().message, HasSubstr("bad.glb"));
    EXPECT_THAT(refused.error().message, HasSubstr("'B'"));
    EXPECT_THAT(refused.error().message, HasSubstr(bad.begin().key()));
  }
}

TEST_F(LoadGltf, TheDefaultSceneIsLoaded) {
  GltfBuilder b;
  b.Triangle("First");
  b.Triangle("Second");
  b.json["scenes"] = {{{"nodes", {0}}}, {{"name", "Stage"}, {"nodes", {1}}}};
  b.json["scene"] = 1;
  const Scene scene = Load(b);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].object, "Second");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0], HasSubstr("'Stage'"));
  // A file without scenes shows every node that has no parent.
  b.json.erase("scenes");
  b.json.erase("scene");
  EXPECT_EQ(Load(b).instances.size(), 2u);
}

TEST_F(LoadGltf, TextFilesWithBuffersBesideThemAndInside) {
  GltfBuilder b = TexturedSquare();
  const std::vector<unsigned char> png = Png();
  std::filesystem::create_directories(Path("my data"));
  Write("my data/geo.bin", b.bin);
  Write("my data/a b.png", png);
  b.json["buffers"] = {{{"byteLength", b.bin.size()}, {"uri", "my%20data/geo.bin"}}};
  b.json["images"][0] = {{"uri", "my%20data/a%20b.png"}};
  Scene scene = Load(Write("side.gltf", b.json.dump()));
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(scene.textures[0].width, 2);

  GltfBuilder inside;
  inside.Triangle();
  inside.bin = std::vector<unsigned char>(42, 0);
  inside.json["buffers"] = {
      {{"byteLength", 42}, {"uri", "data:application/octet-stream;base64," + std::string(56, 'A')}}};
  inside.json["bufferViews"][1]["byteLength"] = 6;
  scene = Load(Write("inside.gltf", "\xEF\xBB\xBF" + inside.json.dump()));
  EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(0.0f));

  std::filesystem::remove(Path("my data/a b.png"));
  EXPECT_THAT(ErrorOf(Path("side.gltf")), HasSubstr("a%20b.png"));
  b.json["materials"][0] = {{"name", "Plain"}};  // the picture is not needed now
  EXPECT_EQ(Load(Write("side.gltf", b.json.dump())).textures.size(), 0u);
  std::filesystem::remove(Path("my data/geo.bin"));
  EXPECT_THAT(ErrorOf(Path("side.gltf")), HasSubstr("geo.bin"));
}

TEST_F(LoadGltf, RequiredExtensions) {
  GltfBuilder b;
  b.Triangle();
  b.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  Load(b);
  b.json["extensionsRequired"] = {"KHR_texture_transform", "KHR_draco_mesh_compression", "EXT_unheard_of"};
  const std::string message = ErrorOf(b);
  EXPECT_THAT(message, HasSubstr("KHR_draco_mesh_compression, EXT_unheard_of"));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("KHR_texture_transform")));
  EXPECT_THAT(message, HasSubstr("export it again with the compression of meshes (Draco, meshopt) switched off"));
  b.json["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_THAT(ErrorOf(b), HasSubstr("requires KHR_texture_basisu, which cannot be read: export it without, with "
                                    "textures as PNG or JPEG"));
}

// Files as gltfpack and Draco's exporters write them lack, in the core format's terms, most of their data.
TEST_F(LoadGltf, RequiredExtensionsAreNamedBeforeAnythingElse) {
  const auto expect_named = [&](const nlohmann::json& packed_json, const std::string& extension) {
    for (const bool is_glb : {true, false}) {
      GltfBuilder packed;
      packed.json = packed_json;
      packed.json["extensionsRequired"] = {extension};
      const auto file = is_glb ? Write("packed.glb", packed.Glb()) : Write("packed.gltf", packed.json.dump());
      EXPECT_THAT(ErrorOf(file), HasSubstr("requires " + extension)) << packed_json.dump();
    }
  };
  GltfBuilder b;
  b.Triangle();
  nlohmann::json gone = b.json, far = b.json, two = b.json, deep = b.json, old = b.json;
  gone["buffers"] = {{{"byteLength", 100}, {"uri", "gone.bin"}}};
  expect_named(gone, "KHR_draco_mesh_compression");
  far["buffers"] = {{{"byteLength", 4}}};
  far["bufferViews"][0]["byteLength"] = 1000;
  for (nlohmann::json& accessor : far["accessors"]) accessor.erase("bufferView");
  expect_named(far, "KHR_draco_mesh_compression");
  two["buffers"] = {{{"byteLength", 4}},
                    {{"byteLength", 4}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  expect_named(two, "EXT_meshopt_compression");
  deep["extras"] = nlohmann::json::parse(std::string(300, '[') + std::string(300, ']'));
  expect_named(deep, "KHR_draco_mesh_compression");
  old["asset"]["version"] = "3.1";
  expect_named(old, "EXT_of_later_days");
  old["asset"] = 1;
  expect_named(old, "EXT_of_later_days");
}

TEST_F(LoadGltf, WhatIsIgnoredIsSaid) {
  GltfBuilder b;
  b.Triangle();
  json& primitives = b.json["meshes"][0]["primitives"];
  primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  b.json["nodes"][0]["skin"] = 0;
  b.Append("skins", {{"joints", {0}}});
  b.Append("animations", {{"channels", json::array()}, {"samplers", json::array()}});
  b.Root({{"mesh", 0}, {"scale", {1, 0, 1}}});
  const Scene scene = Load(b);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_THAT(scene.warnings, ::testing::UnorderedElementsAre(
                                  HasSubstr("points and lines"), HasSubstr("without JOINTS_0"),
                                  HasSubstr("animations are not played without a frame"), HasSubstr("flattens")));
}

TEST_F(LoadGltf, ASceneWithoutGeometryIsLegal) {
  GltfBuilder b;
  b.Root({{"name", "Nothing"}});
  const Scene scene = Load(b);
  EXPECT_TRUE(scene.instances.empty());
  EXPECT_EQ(scene.materials.size(), 1u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0], HasSubstr("no geometry"));
}

TEST_F(LoadGltf, UnusableNormalsAreComputed) {
  GltfBuilder b;
  b.Triangle();
  const float nan = std::nanf("");
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.Floats({0, 3, 0, 0, 0, 0, nan, 0, 1}, 3);
  const Scene scene = Load(b);
  EXPECT_EQ(scene.meshes[0].normals, (std::vector<glm::vec3>{{0, 1, 0}, {0, 0, 1}, {0, 0, 1}}));
  EXPECT_THAT(scene.warnings, ::testing::ElementsAre(HasSubstr("computed anew")));
}

}  // namespace
}  // namespace scumble
