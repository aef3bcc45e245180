// Small scene files that ask for much memory or time, by naming one object many times or by compact encodings: these
// are counted beforehand, kept once or left out.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cmath>
#include <ctime>
#include <iterator>

#include "core/image/hash.h"
#include "core/io/picture_file.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/scene_textures.h"
#include "tests/support/animation_fixtures.h"

namespace scumble {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Greedy : public RefusedScenes {
 protected:
  Scene Load(const std::filesystem::path& path, TextureLoading textures = TextureLoading::kNow) {
    Expected<Scene> scene = LoadScene(path, {textures, {}});
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return scene ? std::move(*scene) : Scene{};
  }
  Scene Load(const GltfBuilder& builder) { return Load(Write("scene.glb", builder.Glb())); }

  // An accessor that needs no byte of the file.
  static int Zeros(GltfBuilder& b, std::size_t count, const std::string& type) {
    return b.Append("accessors", {{"componentType", kFloat}, {"count", count}, {"type", type}});
  }

  // The most that this process has held at a time.
  static double PeakMegabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024;
  }
};

// 600 leaves of one name, 1000 nodes deep, each of those with a name of 1000 bytes: paths of 1,001,001 bytes, of which
// 537 are more than 2^29. A file of 1 MB; the paths of the 100,000 leaves that fit into 4 MB would be 100 GB, kept
// twice.
TEST_F(Greedy, PathsAreCountedBeforeTheyAreMade) {
  GltfBuilder b;
  b.Triangle("A");
  constexpr int kDeep = 1000, kLeaves = 600;
  for (int i = 1; i < kDeep; ++i) b.Append("nodes", {{"name", std::string(1000, 'n')}, {"children", {i + 1}}});
  json leaves = json::array();
  for (int i = 0; i < kLeaves; ++i) leaves.push_back(kDeep + 1 + i);
  b.Append("nodes", {{"name", std::string(1000, 'n')}, {"children", leaves}});
  for (int i = 0; i < kLeaves; ++i) b.Append("nodes", {{"name", "A"}, {"mesh", 0}});
  b.json["scenes"][0]["nodes"] = {0, 1};
  EXPECT_THAT(Refusal(b), ::testing::AllOf(HasSubstr("names"), HasSubstr("536870912 bytes"), HasSubstr("'A'")));
}

// Names of 1 MB: one object of 600 primitives, 600 cameras, 600 lights.
TEST_F(Greedy, NamesCountWhereverTheyAreKept) {
  const std::string name(1'000'000, 'n');
  GltfBuilder object;
  object.Triangle(name);
  const json primitive = object.json["meshes"][0]["primitives"][0];
  for (int i = 1; i < 600; ++i) object.json["meshes"][0]["primitives"].push_back(primitive);
  EXPECT_THAT(Refusal(object), HasSubstr("536870912 bytes"));
  GltfBuilder cameras;
  cameras.Append("cameras",
                 {{"type", "perspective"}, {"name", name}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}});
  for (int i = 0; i < 600; ++i) cameras.Root({{"camera", 0}});
  EXPECT_THAT(Refusal(cameras), HasSubstr("536870912 bytes"));
  GltfBuilder lights;
  const json light = {{"type", "point"}, {"name", name}};
  lights.json["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
  for (int i = 0; i < 600; ++i) lights.Root({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  EXPECT_THAT(Refusal(lights), HasSubstr("536870912 bytes"));
}

TEST_F(Greedy, PathsGoFromTheRootToTheObject) {
  GltfBuilder b;
  b.Triangle("Leaf");
  b.Append("nodes", {{"name", "Leaf"}, {"mesh", 0}});
  b.Append("nodes", {{"children", {1}}});
  b.Append("nodes", {{"name", "Tree"}, {"children", {2}}});
  b.json["scenes"][0]["nodes"] = {0, 3};
  const Scene scene = Load(b);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].object, "Leaf");
  EXPECT_EQ(scene.instances[1].object, "Tree/node_2/Leaf");
}

// One accessor of three million elements without data, named by six primitives: 18 million, before one is read.
TEST_F(Greedy, GeometryWithoutDataIsCounted) {
  GltfBuilder b;
  b.Triangle();
  const json primitive = {{"attributes", {{"POSITION", Zeros(b, 3'000'000, "VEC3")}}}};
  b.json["meshes"][0]["primitives"] = json(6, primitive);
  EXPECT_THAT(Refusal(b), ::testing::AllOf(HasSubstr("without data comes to 18000000 elements with accessor 2"),
                                           HasSubstr("at most 16000000")));
}

// Targets that do nothing are written without data, and may have more of it: 64 million.
TEST_F(Greedy, MorphTargetsWithoutDataAreCounted) {
  const auto with_targets = [](std::size_t targets, std::size_t vertices) {
    GltfBuilder b;
    b.Triangle();
    const json target = {{"POSITION", Zeros(b, vertices, "VEC3")}};
    b.json["meshes"][0]["primitives"][0]["targets"] = json(targets, target);
    b.json["meshes"][0]["weights"] = json(targets, 1.0);
    return b;
  };
  EXPECT_THAT(Refusal(with_targets(65, 1'000'000)), ::testing::AllOf(HasSubstr("65000000"), HasSubstr("64000000")));
  EXPECT_EQ(Load(with_targets(65, 3)).meshes[0].positions[1], glm::vec3(1, 0, 0));
}

// A value of a sparse accessor stands for 16 elements, so two of them make room for 32.
TEST_F(Greedy, SparseAccessorsCountLess) {
  GltfBuilder b;
  b.Triangle();
  const int zeros = Zeros(b, 16'000'032, "VEC3");
  b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = zeros;
  EXPECT_THAT(Refusal(b), HasSubstr("without data comes to 16000032"));
  b.json["accessors"][zeros]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", b.View(std::vector<std::uint16_t>{1, 2})}, {"componentType", kUshort}}},
      {"values", {{"bufferView", b.View(std::vector<float>{5, 0, 0, 0, 7, 0})}}}};
  EXPECT_THAT(Refusal(b), HasSubstr("has 16000032 elements and no data"))
      << "what one accessor may have does not change";
}

// Where a primitive uses few vertices of a list, only those are read, but all values of a sparse accessor are looked
// through, and count: 501 times a million and three vertices. What it claims is counted before it is read, and found to
// be too many.
TEST_F(Greedy, SparseValuesCountForEachReading) {
  GltfBuilder b;
  b.Triangle();
  json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["POSITION"] = b.Floats(std::vector<float>(3 * 8, 1.0f), 3);
  const int sparse = Zeros(b, 8, "VEC3");
  b.json["accessors"][sparse]["sparse"] = {
      {"count", 1'000'000},
      {"indices", {{"bufferView", b.View(std::vector<std::uint16_t>{1})}, {"componentType", kUshort}}},
      {"values", {{"bufferView", b.View(std::vector<float>{5, 0, 0})}}}};
  const json target = {{"POSITION", sparse}};
  primitive["targets"] = json(501, target);
  b.json["meshes"][0]["weights"] = json(501, 1.0);
  EXPECT_THAT(Refusal(b), HasSubstr("at least 501000003 vertices, each instance counted; expected at most 500000000"));
}

// A target of two bytes is a weight for each node that shows its mesh: 985 nodes have 64,025,000.
TEST_F(Greedy, MorphTargetsCountForEachNode) {
  GltfBuilder b;
  b.Triangle();
  b.json["meshes"][0]["primitives"][0]["targets"] = json(65'000, json::object());
  for (int i = 1; i < 1000; ++i) b.Root({{"mesh", 0}});
  EXPECT_THAT(Refusal(b),
              ::testing::AllOf(HasSubstr("at least 64025000 morph targets"), HasSubstr("at most 64000000")));
}

// 100,000 empty targets for 300,000 vertices without data. Looked at for each vertex, once for its place and once for
// its normal, they were 6·10¹⁰ steps, twelve seconds at one in each cycle of 5 GHz.
TEST_F(Greedy, TargetsThatHoldNothingCostNoVertexAnything) {
  GltfBuilder b;
  b.Triangle();
  const int zeros = Zeros(b, 300'000, "VEC3");
  b.json["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", zeros}}}};
  b.json["meshes"][0]["primitives"][0]["targets"] = json(100'000, json::object());
  b.json["meshes"][0]["weights"] = json(100'000, 1);
  const std::filesystem::path file = Write("scene.glb", b.Glb());
  const std::clock_t before = std::clock();
  const Scene scene = Load(file);
  EXPECT_LT(double(std::clock() - before) / CLOCKS_PER_SEC, 6.0 * SCUMBLE_TESTS_SLOWER);
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 300'000u);
}

// `{}` became a material of 2 KB, a node of half a KB. As many as may be are left to the parser, which here finds a
// bracket too many.
TEST_F(Greedy, ListsAreCountedBeforeTheyAreMade) {
  const auto refusal = [&](const std::string& list, std::size_t elements, const std::string& behind = "") {
    std::string text = R"({"asset":{"version":"2.0"},")" + list + R"(":[{})";
    for (std::size_t i = 1; i < elements; ++i) text += ",{}";
    return Refusal(Write("scene.gltf", text + "]" + behind + "}"));
  };
  EXPECT_THAT(refusal("materials", 100'001),
              ::testing::AllOf(HasSubstr("100001 elements in 'materials'"), HasSubstr("at most 100000")));
  EXPECT_THAT(refusal(R"(mat\u0065rials)", 100'001), HasSubstr("at most 100000"));
  EXPECT_THAT(refusal("nodes", 2'000'001),
              ::testing::AllOf(HasSubstr("2000001 elements in 'nodes'"), HasSubstr("at most 2000000")));
  EXPECT_THAT(refusal("materials", 100'000, "]"), HasSubstr("cannot be read as glTF 2.0"));
}

// tinygltf gives each sampler the extensions of its animation: 4002 copies of 4000 numbers, 150 bytes each, from 100
// KB. The look ahead counts brackets and commas, 4002 of them, once for each of the 4001 commas between samplers and
// once more.
TEST_F(Greedy, ExtensionsThatAreCopiedAreCounted) {
  const auto scene = [&](int samplers) {
    GltfBuilder b;
    b.Triangle();
    const json sampler = {{"input", 0}, {"output", 0}};
    b.Append("animations", {{"channels", json::array()},
                            {"extensions", {{"EXT_own", {{"list", json(4000, 0)}}}}},
                            {"samplers", json(samplers, sampler)}});
    return b;
  };
  EXPECT_THAT(Refusal(scene(4002)), ::testing::AllOf(HasSubstr("16016004 values in extras and extensions"),
                                                     HasSubstr("expected at most 16000000")));
  EXPECT_EQ(Load(scene(10)).meshes.size(), 1u);
}

// Channels that name one accessor each keep it: the second is one too many. One alone is refused before it is read.
TEST_F(Greedy, AnimationsWithoutDataAreCounted) {
  const auto refusal = [&](std::size_t channels, std::size_t elements) -> std::string {
    GltfBuilder b;
    const int zeros = Zeros(b, elements, "SCALAR");
    for (std::size_t i = 0; i < channels; ++i) {
      b.Animate(b.Root({{"name", "Node"}}), "weights", {0}, {0});
      b.json["animations"][0]["samplers"][i]["output"] = zeros;
    }
    const Expected<AnimatedScene> scene = AnimatedScene::Load(Write("scene.glb", b.Glb()), {""});
    return scene ? "" : scene.error().message;
  };
  EXPECT_THAT(refusal(1, 4'000'001), ::testing::AllOf(HasSubstr("without data"), HasSubstr("at most 4000000")));
  EXPECT_THAT(refusal(2, 2'000'001), HasSubstr("without data comes to 4000002"));
  EXPECT_EQ(refusal(2, 1000), "");
}

// As many matrices as joints are of use. The list may be longer, but not so long that reading it costs more than all
// else: 16 million without data took 3 GB before they were refused as matrices of zeros.
TEST_F(Greedy, SkinsHaveNoMoreMatricesThanTheyNeed) {
  for (const std::size_t count : {std::size_t(2 + 1025), std::size_t(16'000'000)}) {
    Bar bar;
    bar.b.json["skins"][0]["inverseBindMatrices"] = Zeros(bar.b, count, "MAT4");
    EXPECT_THAT(Refusal(bar.b), HasSubstr(std::to_string(count) + " inverse bind matrices for 2 joints"));
  }
  const Bar bar;
  const Scene scene = Load(bar.b);
  Bar longer;
  longer.b.json["skins"][0]["inverseBindMatrices"] =
      longer.b.Matrices({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1,  //
                         2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 9,  0, 1});
  EXPECT_EQ(Load(longer.b).meshes[0].positions, scene.meshes[0].positions);
}

// What many images name is kept once; what lies on each other cannot be pictures, and is more than the buffers hold.
TEST_F(Greedy, PicturesInBuffersAreKeptOnce) {
  Picture picture(2, 2);
  ASSERT_TRUE(WritePicture(Path("made.png"), picture).ok());
  std::ifstream stream(Path("made.png"), std::ios::binary);
  const std::vector<unsigned char> png{std::istreambuf_iterator<char>(stream), {}};
  constexpr int kImages = 40;
  const auto with_views = [&](auto change) {
    GltfBuilder b;
    b.Triangle();
    const json whole = b.json["bufferViews"][b.View(png)];
    for (int i = 0; i < kImages; ++i) {
      json view = whole;
      change(view, i);
      b.Append("images", {{"bufferView", b.Append("bufferViews", view)}, {"mimeType", "image/png"}});
      b.Append("textures", {{"source", i}});
      b.Append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    }
    return b;
  };
  const Scene scene = Load(with_views([](json&, int) {}));
  ASSERT_EQ(scene.textures.size(), std::size_t(kImages));
  for (const Picture& texture : scene.textures) EXPECT_EQ(texture.rgba, picture.rgba);
  const GltfBuilder nested =
      with_views([](json& view, int i) { view["byteLength"] = view["byteLength"].get<int>() - i; });
  EXPECT_THAT(Refusal(nested), HasSubstr("lie on each other"));
}

// A .glb of any JSON and binary chunk.
std::vector<unsigned char> GlbOf(std::string json, std::vector<unsigned char> data) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4);
  std::vector<unsigned char> glb;
  const auto put = [&](std::size_t value) {
    for (int i = 0; i < 4; ++i) glb.push_back(static_cast<unsigned char>(value >> (8 * i)));
  };
  for (const std::size_t value : {std::size_t(0x46546C67), std::size_t(2), 28 + json.size() + data.size()}) put(value);
  put(json.size());
  put(0x4E4F534A);
  glb.insert(glb.end(), json.begin(), json.end());
  put(data.size());
  put(0x004E4942);
  glb.insert(glb.end(), data.begin(), data.end());
  return glb;
}

// One buffer is the binary chunk. Copied for each of 10,000, a chunk of 1 MB in a file of 1.3 MB would be 10 GB. Keys
// may have escapes, the last of equal ones counts, and a uri is a text with something in it.
TEST_F(Greedy, BuffersShareNoChunk) {
  GltfBuilder b;
  b.Triangle(R"("buffers":[{},{}])");
  b.json["extras"]["buffers"] = json(3, json::object());
  const auto scene = [&](const std::string& others, const std::string& key = "buffers") {
    const std::string first = "{\"" + key + R"(":[{"byteLength":42})";
    return Write("scene.glb", GlbOf(first + others + "]," + b.json.dump().substr(1), b.bin));
  };
  const std::string inside = R"("uri":"data:application/octet-stream;base64,AAAA")";
  const std::string extras = R"("extras":{"uri":""})";
  for (const std::string& more : {inside, inside + "," + extras, extras + "," + inside}) {
    EXPECT_EQ(Load(scene(R"(,{"byteLength":3,)" + more + "}")).meshes.size(), 1u) << more;
  }
  const std::string second = R"(,{"byteLength":42)";
  for (const std::string more : {"", R"(,"uri":"")", R"(,"uri":7,"name":"a.bin")", R"(,"extras":{"uri":"a.bin"})",
                                 R"(,"uri":"a.bin","uri":"")", R"(,"uri":"a.bin","\u0075ri":"")"}) {
    EXPECT_THAT(Refusal(scene(second + more + "}")), HasSubstr("2 buffers without a uri; expected one")) << more;
  }
  EXPECT_THAT(Refusal(scene(second + "}", R"(b\u0075ffers)")), HasSubstr("2 buffers without a uri"));
  std::string many;
  for (int i = 1; i < 10'000; ++i) many += second + "}";
  EXPECT_THAT(Refusal(scene(many)), HasSubstr("10000 buffers without a uri"));
}

// A file is itself whatever it is called. One of 2^20 bytes may be read 64 times again, which makes 2^26.
TEST_F(Greedy, FilesOfManyBuffersAreReadAgainUpToALimit) {
  GltfBuilder b;
  b.Triangle();
  Write("geo.bin", b.bin);
  std::filesystem::create_symlink("geo.bin", Path("link.bin"));
  const auto scene = [&](std::size_t buffers) {
    const std::string names[] = {"geo.bin", "./geo.bin", "link.bin", "%67eo.bin"};
    b.json["buffers"] = json::array();
    for (std::size_t i = 0; i < buffers; ++i) {
      b.Append("buffers", {{"byteLength", b.bin.size()}, {"uri", names[i % std::size(names)]}});
    }
    return Write("scene.gltf", b.json.dump());
  };
  EXPECT_EQ(Load(scene(5)).meshes.size(), 1u);
  b.bin.resize(1 << 20);
  Write("geo.bin", b.bin);
  EXPECT_THAT(Refusal(scene(1 + 64 + 1)),
              ::testing::AllOf(HasSubstr("geo.bin"), HasSubstr("more than 67108864 bytes")));
}

// Each of 1000 primitives would compare 10,000 names with 10,000 materials.
TEST_F(Greedy, TheDefaultMaterialIsLookedForOnce) {
  constexpr int kMaterials = 10'000, kPrimitives = 1000;
  GltfBuilder b;
  b.Triangle();
  for (int i = 1; i <= kMaterials; ++i) {
    b.Append("materials", {{"name", i == 1 ? std::string("default") : "default#" + std::to_string(i)}});
  }
  const json primitive = b.json["meshes"][0]["primitives"][0];
  b.json["meshes"][0]["primitives"] = json(kPrimitives, primitive);
  const Scene scene = Load(b);
  ASSERT_EQ(scene.materials.size(), std::size_t(kMaterials) + 1);
  EXPECT_EQ(scene.materials.back().name, "default#10001") << "glTF's own are single-sided, which the default is not";
  ASSERT_EQ(scene.meshes.size(), std::size_t(kPrimitives));
  for (const Mesh& mesh : scene.meshes) EXPECT_EQ(mesh.material, kMaterials);
}

TEST_F(Greedy, ADefaultMaterialOfTheFilesOwnServes) {
  GltfBuilder b;
  b.Triangle();
  b.Append("materials", {{"name", "first"}});
  b.Append("materials", {{"name", "default"}, {"doubleSided", true}});
  b.Append("materials", {{"name", "last"}});
  const json primitive = b.json["meshes"][0]["primitives"][0];
  b.json["meshes"][0]["primitives"] = json(2, primitive);
  const Scene scene = Load(b);
  EXPECT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.meshes[0].material, 1);
  EXPECT_EQ(scene.meshes[1].material, 1);
}

// Ear clipping written down plainly, for polygons in the plane z = 0.
std::vector<glm::uvec3> PlainEars(const std::vector<glm::vec3>& corners) {
  double area = 0.0;
  std::vector<glm::dvec2> points;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a(corners[i]), b(corners[(i + 1) % corners.size()]);
    area += (a.x - b.x) * (a.y + b.y);
    points.emplace_back(a);
  }
  if (area < 0.0) {
    for (glm::dvec2& p : points) p = {p.y, p.x};
  }
  const auto cross = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  std::vector<unsigned> ring;
  for (unsigned i = 0; i < corners.size(); ++i) ring.push_back(i);
  std::vector<glm::uvec3> triangles;
  std::size_t at = 1, misses = 0;
  while (ring.size() > 3 && misses < ring.size()) {
    const std::size_t n = ring.size();
    at %= n;
    const glm::uvec3 ear(ring[(at + n - 1) % n], ring[at], ring[(at + 1) % n]);
    const glm::dvec2 a = points[ear.x], b = points[ear.y], c = points[ear.z];
    bool is_ear = cross(a, b, c) > 0.0;
    for (unsigned i : ring) {
      const glm::dvec2 p = points[i];
      const bool inside = cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0;
      if (inside && p != a && p != b && p != c) is_ear = false;
    }
    misses = is_ear ? 0 : misses + 1;
    if (is_ear) {
      triangles.push_back(ear);
      ring.erase(ring.begin() + std::ptrdiff_t(at));
    }
    ++at;
  }
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) triangles.emplace_back(ring[0], ring[i], ring[i + 1]);
  return triangles;
}

// Out along one spiral and back along another.
std::vector<glm::vec3> Spiral(int corners, double turns) {
  std::vector<glm::vec3> spiral;
  for (int i = 0; i < corners; ++i) {
    const int half = corners / 2;
    const bool back = i >= half;
    const double angle = 2 * 3.14159265358979323846 * turns * (back ? corners - 1 - i : i) / half;
    const double radius = angle + (back ? 3.0 : 1.0);
    spiral.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  return spiral;
}

// The same triangles as by plain clipping, on polygons that touch and cross themselves, too. Each cut makes two new
// triangles to look into, so there are at most 3 n, each of which looks at n corners once; and n²/2 corners found
// before are looked at again. Plain clipping takes 72 n² of the last spiral: a file of 125 such faces took minutes.
TEST(GreedyPolygons, EarsCostTheSquareOfTheCorners) {
  const auto expect_same = [](const std::vector<glm::vec3>& polygon, bool compare = true) {
    std::vector<glm::uvec3> triangles;
    const std::uint64_t looks = TriangulatePolygon(polygon, triangles);
    EXPECT_LE(looks, 4 * polygon.size() * polygon.size());
    EXPECT_EQ(triangles.size(), polygon.size() - 2);
    if (compare) {
      EXPECT_EQ(triangles, PlainEars(polygon));
    }
  };
  for (int round = 0; round < 1000; ++round) {
    std::vector<glm::vec3> polygon(4 + Hash(round, 0) % 30);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      polygon[i] = glm::vec3(Hash(round, i, 1) % 6, Hash(round, i, 2) % 6, 0);
    }
    expect_same(polygon);
  }
  for (const double turns : {1.0, 3.0, 10.0, 30.0}) expect_same(Spiral(300, turns));
  expect_same(Spiral(2000, 60.0), false);
}

// A tag of 19 bytes became 360 KB, twice. 6000 changes of material would copy 3000 lines of two corners: 430 MB.
TEST_F(Greedy, ObjLinesThatNobodyLooksAtTakeNoMemory) {
  Write("m.mtl", std::string("newmtl m\nKd 1 0 0\n"));
  std::string tags, lines, changes;
  for (int i = 0; i < 1000; ++i) tags += i % 2 == 0 ? "t a 8192/8192/8192\n" : " \tt\ta 8192/8192/8192\r\n";
  for (int i = 0; i < 3000; ++i) lines += "l 1 2\np 1 2\n", changes += "usemtl m\nusemtl None\n";
  const double before = PeakMegabytes();
  const Scene scene = Load(Write("a.obj", "mtllib m.mtl\n" + tags + "o A\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" +
                                              lines + changes + "o B\nf 1 2 3\no C\nl 1 2 3\nf 3 2 1\n"));
  EXPECT_LT(PeakMegabytes() - before, 200);
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[2].object, "C");
  EXPECT_THAT(scene.warnings,
              ElementsAre(HasSubstr("points and lines are left out, only faces are seen (first: 'A', 2")));
}

// A library is itself whatever it is called; before, each of its names read it anew, its materials too.
TEST_F(Greedy, ObjLibrariesAreReadOnce) {
  Write("a.mtl", std::string("newmtl m\nKd 1 0 0\n"));
  std::filesystem::create_symlink("a.mtl", Path("link.mtl"));
  const Scene scene =
      Load(Write("a.obj", std::string("mtllib a.mtl\nmtllib ./a.mtl\nmtllib ././a.mtl\nmtllib link.mtl\n"
                                      "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")));
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].name, "m");
  EXPECT_EQ(scene.meshes[0].material, 0);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

// Where a texture is missing, its own materials do without it, and no other is made anew.
TEST_F(Greedy, MissingTexturesConcernTheirOwnMaterials) {
  Write("lib.mtl", std::string("newmtl a\nmap_Kd gone.png\nnewmtl b\nKd 1 0 0\nnewmtl c\nmap_Kd gone.png\n"));
  Scene scene = Load(Write("a.obj", std::string("mtllib lib.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n")),
                     TextureLoading::kWhenNeeded);
  ASSERT_EQ(scene.materials.size(), 3u);
  for (Material& material : scene.materials) material.roughness = 0.25f;
  const Expected<DecodedTextures> decoded = DecodeAllTextures(scene);
  ASSERT_TRUE(decoded.ok());
  EXPECT_THAT(decoded->warnings, ElementsAre(HasSubstr("gone.png")));
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, -1);
  EXPECT_EQ(scene.materials[0].roughness, 1.0f);
  EXPECT_EQ(scene.materials[1].roughness, 0.25f);
  EXPECT_EQ(scene.materials[2].base_color_texture.texture, -1);
  EXPECT_EQ(scene.materials[2].roughness, 1.0f);
}

// Files of the system's say that they are empty and need not end, as /proc/self/pagemap does not. An empty file is
// read.
TEST_F(Greedy, FilesThatHaveMoreThanTheySayAreRefused) {
  const Expected<std::vector<std::byte>> empty = ReadRegularFile(Write("empty", std::string()));
  ASSERT_TRUE(empty.ok());
  EXPECT_TRUE(empty->empty());
  const std::string text(100'000, 't');
  const Expected<std::vector<std::byte>> whole = ReadRegularFile(Write("whole", text));
  ASSERT_TRUE(whole.ok());
  EXPECT_EQ(AsText(*whole), text);
  std::error_code failed;
  if (std::filesystem::file_size("/proc/version", failed) != 0 || failed) GTEST_SKIP() << "no files of that kind";
  const Expected<std::vector<std::byte>> more = ReadRegularFile("/proc/version");
  ASSERT_FALSE(more.ok());
  EXPECT_THAT(more.error().message, HasSubstr("/proc/version is larger than 0 bytes, which is what the system says"));
  const Scene scene = Load(Write("a.obj", std::string("mtllib /proc/version\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")));
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("a material library is missing")));
}

}  // namespace
}  // namespace scumble
