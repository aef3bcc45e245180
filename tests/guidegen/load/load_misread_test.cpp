// Files that would silently become an empty or a plainer picture: points or lines alone, text that is not UTF-8, glTF
// 1.0, textures without an index. Each is refused or warned of, by what the file really has.
#include <gmock/gmock.h>

#include <map>
#include <string>

#include "core/io/picture_file.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/load_scene.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

using namespace std::string_literals;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Misread : public RefusedScenes {
 protected:
  Scene Load(const std::filesystem::path& path) {
    Expected<Scene> scene = LoadScene(path);
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return scene ? std::move(*scene) : Scene{};
  }
};

TEST_F(Misread, PlyOfPointsAlone) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\n";
  const std::string places = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_THAT(Refusal(Write("cloud.ply", header + "end_header\n" + places)),
              AllOf(HasSubstr("has 3 points and no triangles"), HasSubstr("make a surface")));
  // Faces in a list of another name, and other kinds of elements, are named.
  EXPECT_THAT(Refusal(Write("strips.ply", header +
                                              "element face 1\nproperty list uchar int corners\n"
                                              "element edge 2\nproperty int vertex1\nend_header\n" +
                                              places + "3 0 1 2\n0\n1\n")),
              HasSubstr("has 3 points, 1 of 'face', 2 of 'edge' and no triangles"));
  EXPECT_THAT(Load(Write("none.ply",
                         "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                         "property float z\nend_header\n"))
                  .warnings,
              ElementsAre(HasSubstr("no geometry")));
}

TEST_F(Misread, ObjOfPointsAndLinesAlone) {
  EXPECT_THAT(Refusal(Write("cloud.obj", std::string("v 0 0 0\nv 1 0 0\n"))),
              HasSubstr("has 2 points and no triangles"));
  EXPECT_THAT(Refusal(Write("dot.obj", std::string("v 0 0 0\np 1\n"))), HasSubstr("has 1 point and no triangles"));
  EXPECT_THAT(Refusal(Write("wire.obj", std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n"))),
              HasSubstr("has 3 points, lines and no triangles"));
}

const std::string kObjTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

// Shapes of subdivision libraries name a normal at each corner, but hold none; some writers keep the slash of an index
// that they leave out.
TEST_F(Misread, ObjCornersThatNameWhatTheFileLacks) {
  const Scene none = Load(Write("none.obj", kObjTriangle + "vt 0 0\nf 1/1/1 2/1/2 3/1/3\n"));
  EXPECT_THAT(none.warnings, ElementsAre(HasSubstr("faces name normals, but the file has none")));
  EXPECT_THAT(none.notes, ElementsAre(HasSubstr("1 triangle without normals")));
  EXPECT_THAT(Refusal(Write("few.obj", kObjTriangle + "vn 0 0 1\nf 1//1 2//1 3//2\n")), HasSubstr("uses normal 2"));
  const Scene slashes = Load(Write("slashes.obj", kObjTriangle + "vt 0 0\nvt 1 0\nf 1/1/ 2/2/ 3//\n"));
  EXPECT_THAT(slashes.warnings, IsEmpty());
  EXPECT_EQ(slashes.meshes.at(0).triangles.size(), 1u);
  EXPECT_THAT(Refusal(Write("zero.obj", kObjTriangle + "f 0 1 2\n")),
              AllOf(HasSubstr("line 4 is 'f 0 1 2'"), HasSubstr("count from 1")));
}

// tinyobjloader takes for 0 what is no number: a program set to a language with decimal commas writes such files.
TEST_F(Misread, ObjWordsThatAreNoNumbers) {
  const auto refusal = [&](const std::string& line) { return Refusal(Write("a.obj", "# a\r\n\n" + line + "\n")); };
  EXPECT_THAT(refusal("v -1,5 0 0"), AllOf(HasSubstr("a.obj, line 3, is 'v -1,5 0 0', where '-1,5' is no finite"),
                                           HasSubstr("expected digits with a decimal point"), HasSubstr("export it")));
  for (const char* line : {"v 0 0 1e", "v 0 0 0x1", "\tv\t0 . 0", "v 0 0 nan", "v 0 -inf 0", "v 0 0 -1.#IND",
                           "v 0 0 ++1", "v 0 0 0 1,0", "vn 0 0 1,0", "vt 0 x"}) {
    EXPECT_THAT(refusal(line), HasSubstr("line 3, is")) << line;
  }
  const Scene scene = Load(Write("b.obj",
                                 "v +0 0. -.0e+0 # 0,5\nv 1 0 0\nv 0 1 0 #,\nvn -nan(ind) NaN -1.#IND\nvn 0 0 1\n"
                                 "vt 0 0 0,5\nvt inf 0\nf 1/1/1 2/1/2 3/1/2\n"s));
  EXPECT_EQ(scene.meshes.at(0).triangles.size(), 1u);
  EXPECT_THAT(Refusal(Write("far.obj", "v 1e999 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"s)), HasSubstr("vertex 1 is NaN"));
}

TEST_F(Misread, MtlWordsThatAreNoNumbers) {
  const auto path = Write("a.obj", "mtllib a.mtl\n" + kObjTriangle + "usemtl m\nf 1 2 3\n");
  for (const char* line :
       {"Kd 0,5 0,5 0,5", "Kd 0.5 x 0.5", "Ks 0 0 .5f", "Ke nan 0 0", " Ns ten", "d -.", "d O.2", "Tr 0,25"}) {
    Write("a.mtl", "newmtl m\n"s + line + "\n");
    const auto scene = LoadScene(path);
    ASSERT_FALSE(scene) << line;
    EXPECT_EQ(scene.error().kind, ErrorKind::kInput);
    EXPECT_THAT(scene.error().message, AllOf(HasSubstr("a.mtl, line 2, is '"), HasSubstr("decimal point"))) << line;
  }
  Write("a.mtl", "newmtl m\nKd spectral a.rfl 1,0\nKs xyz 0 0 0\nd -halo 0.5\nNs 10 # a,b\nNi 1,5\n"s);
  EXPECT_EQ(Load(path).materials.size(), 1u);
  EXPECT_THAT(Refusal(Write("mac.obj", "v 0 0 0\rv 1 0 0\r\nv 0 x 0\rf 1 2 3\r"s)), HasSubstr("line 3, is 'v 0 x 0'"));
}

// MeshLab writes `Tr 1` for what is opaque; to the letter it is what cannot be seen.
TEST_F(Misread, MtlThatMeansOpacityByTr) {
  Write("scene.mtl", std::string("newmtl opaque\nKd 1 0 0\nTr 1.000000\nnewmtl glass\nTr 0.75\n"
                                 "newmtl hidden\nTr 1\nd 0\n"));
  const Scene scene = Load(Write("scene.obj", "mtllib scene.mtl\n" + kObjTriangle +
                                                  "usemtl opaque\nf 1 2 3\nusemtl glass\nf 1 2 3\n"
                                                  "usemtl hidden\nf 1 2 3\n"));
  EXPECT_THAT(scene.warnings,
              ElementsAre(AllOf(HasSubstr("'Tr 1' is taken for opaque"), HasSubstr("'opaque'")),
                          AllOf(HasSubstr("below one half are left out"), HasSubstr("(material 'glass')"))));
  std::map<std::string, float> alphas;
  for (const Material& material : scene.materials) alphas[material.name] = material.base_color.a;
  EXPECT_EQ(alphas["opaque"], 1.0f);
  EXPECT_EQ(alphas["glass"], 0.25f);
  EXPECT_EQ(alphas["hidden"], 0.0f);
}

// Rhinoceros ends the lines of a header by a carriage return alone, also before binary values.
TEST_F(Misread, PlyWithLinesThatEndInACarriageReturn) {
  const std::string header =
      "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\rproperty uchar y\r"
      "property uchar z\relement face 1\rproperty list uchar uchar vertex_indices\rend_header\r";
  // The first value is a line feed.
  const std::string body{'\n', 0, 0, 12, 0, 0, '\n', 2, 0, 3, 0, 1, 2};
  const Scene scene = Load(Write("rhino.ply", header + body));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions.at(0).x, 10.0f);
}

TEST_F(Misread, GltfOfPointsAndLinesAlone) {
  GltfBuilder b;
  const int positions = b.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  const auto primitive = [&](int mode) { return json{{"attributes", {{"POSITION", positions}}}, {"mode", mode}}; };
  b.Root({{"mesh", b.Mesh(json::array({primitive(0)}))}});
  b.Root({{"mesh", 0}});
  EXPECT_THAT(Refusal(b), HasSubstr("has 3 points and no triangles"));
  b.Root({{"mesh", b.Mesh(json::array({primitive(1), primitive(2), primitive(3)}))}});
  EXPECT_THAT(Refusal(b), HasSubstr("has 12 points, lines and no triangles"));
  b.Root({{"mesh", b.Mesh(json::array({primitive(4)}))}});
  EXPECT_THAT(Load(Write("scene.glb", b.Glb())).warnings, ElementsAre(HasSubstr("points and lines are left out")));
}

// Plain letters in one of UTF-16's and UTF-32's forms.
std::string Wide(const std::string& text, int bytes, bool big, bool mark) {
  std::string wide;
  const auto put = [&](unsigned code) {
    for (int i = 0; i < bytes; ++i) wide += static_cast<char>(code >> 8 * (big ? bytes - 1 - i : i) & 0xFF);
  };
  if (mark) put(0xFEFF);
  for (const char c : text) put(static_cast<unsigned char>(c));
  return wide;
}

TEST_F(Misread, TextInWideEncodings) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  GltfBuilder b;
  b.Root({{"name", "Nothing"}});
  for (const int bytes : {2, 4}) {
    for (const bool big : {false, true}) {
      for (const bool mark : {false, true}) {
        const std::string name = "UTF-" + std::to_string(8 * bytes) + (mark ? "" : big ? "BE" : "LE");
        const auto names_it =
            AllOf(HasSubstr("is text in " + name + "; expected UTF-8"), HasSubstr("iconv -f " + name + " -t UTF-8"));
        EXPECT_THAT(Refusal(Write("wide.obj", Wide(triangle, bytes, big, mark))), names_it);
        EXPECT_THAT(Refusal(Write("wide.gltf", Wide(b.json.dump(), bytes, big, mark))), names_it);
        Write("wide.mtl", Wide("newmtl m\nKd 1 0 0\n", bytes, big, mark));
        const auto scene = LoadScene(Write("a.obj", "mtllib wide.mtl\n" + triangle));
        ASSERT_FALSE(scene);
        EXPECT_EQ(scene.error().kind, ErrorKind::kInput);
        EXPECT_THAT(scene.error().message, AllOf(HasSubstr("wide.mtl"), names_it));
      }
    }
  }
}

// What a wrong guess would refuse: short files, and letters of other languages.
TEST_F(Misread, OrdinaryTextIsNotWide) {
  for (const std::string text : {"", "v", "v ", "v 0", "# ä", "\xC3\xA4", "\xFE", "\xFF"}) {
    EXPECT_TRUE(CheckTextEncoding("a", std::as_bytes(std::span(text)))) << text;
  }
}

// Blender writes `mtllib my model.mtl` beside "my model.obj"; others, materials with blanks in their names.
TEST_F(Misread, NamesWithBlanksAreWhole) {
  Write("my model.mtl", std::string("newmtl Red Paint\nKd 0.5 0 0\n"));
  Write("two.mtl", std::string("newmtl Red\nKd 0 0.5 0\n"));
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto colors = [](const Scene& scene) {
    std::map<std::string, glm::vec4> of;
    for (const Material& material : scene.materials) of[material.name] = material.base_color;
    return of;
  };
  const Scene scene = Load(Write(
      "a.obj", "mtllib my model.mtl\nmtllib two.mtl\n" + points + "usemtl Red Paint \nf 1 2 3\nusemtl Red\nf 1 2 3\n"));
  EXPECT_THAT(scene.warnings, IsEmpty());
  ASSERT_EQ(colors(scene).count("Red Paint"), 1u);
  EXPECT_EQ(colors(scene)["Red Paint"].x, 0.5f);
  EXPECT_EQ(colors(scene)["Red"].y, 0.5f);
  EXPECT_EQ(colors(scene).count("default"), 0u);
  // Several libraries in one line are all read, and what is missing is named.
  const Scene several = Load(Write("b.obj", "mtllib two.mtl gone.mtl\n" + points + "usemtl Red\nf 1 2 3\n"));
  EXPECT_THAT(several.warnings, ElementsAre(HasSubstr("gone.mtl")));
  EXPECT_EQ(colors(several)["Red"].y, 0.5f);
  EXPECT_THAT(Load(Write("c.obj", "mtllib no such.mtl\n" + points + "f 1 2 3\n")).warnings,
              ElementsAre(HasSubstr("(no such.mtl)")));
  EXPECT_THAT(
      Load(Write("d.obj", "mtllib two.mtl\n" + points + "usemtl Blue Paint\nf 1 2 3\nusemtl None\nf 1 2 3\n")).warnings,
      ElementsAre(AllOf(HasSubstr("in no library"), HasSubstr("'Blue Paint'"))));
}

TEST_F(Misread, ALineOfAnObjGoesOnBehindABackslash) {
  const Scene scene = Load(Write("a.obj", std::string("# C:\\\nv 0 0 0\nv 1 \\\n 0 0\nv 0 1 \\\r\n0\nf 1 2 \\\n3\n")));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(scene.meshes[0].positions, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)));
  const auto wrong = LoadScene(Write("b.obj", std::string("v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf a b c\n")));
  ASSERT_FALSE(wrong.ok());
  EXPECT_THAT(wrong.error().message, HasSubstr("line 5 is 'f a b c'"));
}

// A leaf's picture cuts it out by its alpha; other pictures of what is opaque are told, except of a material
// without faces.
TEST_F(Misread, WhatAnMtlCutsOut) {
  Write("leaf.mtl", std::string("newmtl leaf\nmap_Kd leaf.png\nmap_d leaf.png\nnewmtl wing\nmap_d other.png\n"
                                "newmtl bark\nmap_Bump bark.png\nnewmtl spare\nd 0.3\nmap_d other.png\n"));
  ASSERT_TRUE(WritePicture(Path("leaf.png").string(), Picture(2, 2), {}).ok());
  const Scene scene = Load(Write("a.obj", "mtllib leaf.mtl\n" + kObjTriangle +
                                              "usemtl leaf\nf 1 2 3\nusemtl wing\nf 1 2 3\nusemtl bark\nf 1 2 3\n"));
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::kBlend);
  EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::kOpaque);
  EXPECT_THAT(scene.warnings, ::testing::UnorderedElementsAre(AllOf(HasSubstr("map_d"), HasSubstr("'wing'")),
                                                              AllOf(HasSubstr("map_Bump"), HasSubstr("'bark'"))));
}

TEST_F(Misread, AGroupOfAnObjGoesOnUnderItsName) {
  const auto objects = [&](const std::string& sections) {
    std::vector<std::string> names;
    for (const Instance& instance : Load(Write("a.obj", kObjTriangle + sections)).instances) {
      names.push_back(instance.object);
    }
    return names;
  };
  const std::string f = "\nf 1 2 3\n";
  EXPECT_THAT(objects("g body" + f + "g trim" + f + "f 1 2 3\ng\tbody" + f + "g none\ng trim" + f),
              ElementsAre("body", "trim", "body", "trim"));
  EXPECT_THAT(objects("f 1 2 3\no A" + f + "o A" + f + "g A" + f), ElementsAre("shape_0", "A", "A#2", "A#3"));
  EXPECT_THAT(objects("o A\ng x" + f + "g y" + f + "g x" + f + "o B\ng x" + f + "g x" + f),
              ElementsAre("x", "y", "x", "x#2", "x#2"));
}

TEST_F(Misread, FilesOfAnObjInFolders) {
  for (const char* folder : {"tex", "maps"}) std::filesystem::create_directory(Path(folder));
  Write("tex/m.mtl", std::string("newmtl near\nmap_Kd a.png\nnewmtl far\nmap_Kd maps\\b.png\nmap_d maps\\b.png\n"
                                 "newmtl gone\nmap_Kd c.png\n"));
  ASSERT_TRUE(WritePicture(Path("tex/a.png").string(), Picture(2, 1), {}).ok());
  ASSERT_TRUE(WritePicture(Path("a.png").string(), Picture(1, 1), {}).ok());
  ASSERT_TRUE(WritePicture(Path("maps/b.png").string(), Picture(3, 1), {}).ok());
  const Scene scene = Load(Write("a.obj", "mtllib tex\\m.mtl\n" + kObjTriangle +
                                              "usemtl near\nf 1 2 3\nusemtl far\nf 1 2 3\nusemtl gone\nf 1 2 3\n"));
  EXPECT_THAT(scene.warnings, ElementsAre(AllOf(HasSubstr("cannot be read"), HasSubstr("tex/c.png"))));
  ASSERT_EQ(scene.textures.size(), 3u);
  EXPECT_EQ(scene.textures[0].width, 2) << "beside the library first";
  EXPECT_EQ(scene.textures[1].width, 3) << "then beside the scene";
  EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::kBlend);
}

// As MeshLab writes them: a quad and a triangle, whose corners and faces have values of their own.
TEST_F(Misread, PlyWithValuesOfCornersAndFaces) {
  const auto ply = [&](const std::string& comments) {
    return Write("a.ply", "ply\nformat ascii 1.0\n" + comments +
                              "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
                              "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                              "element face 3\nproperty list uchar int vertex_indices\n"
                              "property list uchar float texcoord\nproperty int texnumber\nproperty uchar red\n"
                              "property uchar green\nproperty uchar blue\nend_header\n"
                              "0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 0 9 9 9\n2 0 0 9 9 9\n"
                              "4 0 1 2 3 8 0 0 0.5 0 0.5 1 0 1 0 255 0 0\n3 1 4 2 6 0.5 0 1 0 0.5 1 0 0 0 255\n"
                              "3 4 2 1 2 0 0 0 0 0 0\n");
  };
  const Scene plain = Load(ply(""));
  EXPECT_THAT(plain.warnings, ElementsAre(HasSubstr("not two for each corner"), HasSubstr("those of the faces")));
  ASSERT_EQ(plain.meshes.size(), 1u);
  const Mesh& mesh = plain.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 4u);
  for (std::size_t t = 0; t < 3; ++t) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t v = mesh.triangles[t][i];
      EXPECT_EQ(mesh.colors[v], t < 2 ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 0, 1, 1));
      EXPECT_EQ(mesh.uvs[0][v], glm::vec2(mesh.positions[v].x / 2, 1 - mesh.positions[v].y));
    }
  }
  EXPECT_EQ(mesh.colors[mesh.triangles[3].x], glm::vec4(0, 0, 0, 1));
  EXPECT_TRUE(plain.textures.empty());
  ASSERT_TRUE(WritePicture(Path("my paint.png").string(), Picture(2, 1), {}).ok());
  // Several lists of faces, of which one has colours.
  const Scene lists =
      Load(Write("b.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                      "element face 1\nproperty list uchar int vertex_indices\nproperty float red\n"
                                      "property float green\nproperty float blue\nend_header\n"
                                      "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n3 0 1 2 0 0 1\n")));
  EXPECT_EQ(lists.meshes.at(0).colors.at(lists.meshes[0].triangles.at(0).x), glm::vec4(1, 1, 1, 1));
  EXPECT_EQ(lists.meshes.at(0).colors.at(lists.meshes[0].triangles.at(1).x), glm::vec4(0, 0, 1, 1));
  const Scene textured = Load(ply("comment TextureFile my paint.png \t\n"));
  ASSERT_EQ(textured.textures.size(), 1u);
  EXPECT_EQ(textured.textures[0].width, 2);
  EXPECT_EQ(textured.materials[0].base_color_texture.texture, 0);
  EXPECT_TRUE(textured.meshes[0].colors.empty());
  const Scene missing = Load(ply("comment TextureFile gone.png\ncomment TextureFile b.png\n"));
  EXPECT_THAT(missing.warnings, ElementsAre(HasSubstr("only the first is read"), HasSubstr("not two for each corner"),
                                            HasSubstr("gone.png")));
  EXPECT_EQ(missing.materials[0].base_color_texture.texture, -1);
  EXPECT_EQ(missing.materials[0].base_color, glm::vec4(1.0f)) << "colours are the surface's then";
  EXPECT_EQ(missing.meshes[0].colors, plain.meshes[0].colors);
  // One that is there, but damaged.
  Write("damaged.ora", std::string("PK\x03\x04 and nothing else"));
  const Scene damaged = Load(ply("comment TextureFile damaged.ora\n"));
  EXPECT_THAT(damaged.warnings, ElementsAre(HasSubstr("not two for each corner"), HasSubstr("damaged.ora")));
  EXPECT_EQ(damaged.materials[0].base_color_texture.texture, -1);
  EXPECT_EQ(damaged.materials[0].base_color, glm::vec4(1.0f));
  EXPECT_EQ(damaged.meshes[0].colors, plain.meshes[0].colors);
}

// Red vertices; faces of two lists, of which the second has colours.
TEST_F(Misread, PlyWithColorsOfVerticesAndFaces) {
  const std::string rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const auto load = [&](const std::string& color) {
    return Load(Write("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                      "property float z\nproperty float s\nproperty float t\n" +
                          rgb +
                          "element face 1\nproperty list uchar int vertex_indices\n"
                          "element face 1\nproperty list uchar int vertex_indices\n"
                          "property list uchar float texcoord\n" +
                          rgb +
                          "end_header\n0 0 0 0.5 1 255 0 0\n1 0 0 0.5 1 255 0 0\n1 1 0 0.5 1 255 0 0\n"
                          "3 0 1 2\n3 0 1 2 6 0 1 0 1 0 1 " +
                          color + "\n"));
  };
  const glm::vec4 red(1, 0, 0, 1), blue(0, 0, 1, 1);
  const Scene white = load("255 255 255");
  EXPECT_THAT(white.warnings, IsEmpty());
  EXPECT_THAT(white.meshes.at(0).colors, Each(red));
  const Scene colored = load("0 0 255");
  EXPECT_THAT(colored.warnings, ElementsAre(HasSubstr("those of the faces")));
  const Mesh& mesh = colored.meshes.at(0);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(mesh.colors.at(mesh.triangles[0][i]), red) << "its list has none";
    EXPECT_EQ(mesh.uvs[0].at(mesh.triangles[0][i]), glm::vec2(0.5f, 0.0f));
    EXPECT_EQ(mesh.colors.at(mesh.triangles[1][i]), blue);
    EXPECT_EQ(mesh.uvs[0].at(mesh.triangles[1][i]), glm::vec2(0.0f, 0.0f));
  }
}

TEST_F(Misread, FacesOfAPlyBeforeItsVertices) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n";
  EXPECT_EQ(Load(Write("a.ply", header + "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n")).meshes[0].positions.size(), 3u);
  const auto wrong = LoadScene(Write("b.ply", header + "3 0 1 3\n0 0 0\n1 0 0\n0 1 0\n"));
  ASSERT_FALSE(wrong.ok());
  EXPECT_THAT(wrong.error().message, HasSubstr("uses vertex 3, but there are 3"));
  const auto none =
      LoadScene(Write("c.ply", std::string("ply\nformat ascii 1.0\nelement vertex 4\nelement face 1\n"
                                           "property list uchar int vertex_indices\nend_header\n4 0 1 2 3\n")));
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(none.error().message, HasSubstr("no properties"));
}

// tinyobjloader would lose the first line: here the library, whose own first line is the material's name.
TEST_F(Misread, TheMarkOfUtf8IsNoText) {
  Write("m.mtl", std::string("\xEF\xBB\xBFnewmtl red\nKd 1 0 0\n"));
  const Scene scene = Load(Write("a.obj", std::string("\xEF\xBB\xBFmtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                                      "usemtl red\nf 1 2 3\n")));
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].name, "red");
  EXPECT_EQ(scene.materials[0].base_color, glm::vec4(1, 0, 0, 1));
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST_F(Misread, Gltf1IsNamedFirst) {
  // With much that would otherwise be named before: an extension, a buffer that is gone, nested values.
  const json keyed = {{"scene", "s"},
                      {"scenes", {{"s", {{"nodes", {"n"}}}}}},
                      {"nodes", {{"n", {{"meshes", {"m"}}}}}},
                      {"buffers", {{"b", {{"uri", "gone.bin"}, {"byteLength", 9}}}}},
                      {"extensionsRequired", {"KHR_draco_mesh_compression"}}};
  const auto refusal = [&](json file) { return Refusal(Write("old.gltf", file.dump())); };
  const auto remedy = AllOf(HasSubstr("expected glTF 2.0: convert it"), HasSubstr("gltf-pipeline"));
  json old = keyed;
  old["asset"] = {{"generator", "x"}, {"profile", {{"version", "7.0"}}}, {"version", "1.0"}};
  EXPECT_THAT(refusal(old), AllOf(HasSubstr("is glTF 1.0, whose "), HasSubstr("names instead of numbers"), remedy));
  EXPECT_THAT(refusal(keyed), AllOf(HasSubstr("is glTF 1.0, whose "), remedy)) << "its version is optional";
  EXPECT_THAT(refusal({{"asset", {{"version", "1.1"}}}}), AllOf(HasSubstr("is glTF 1.1;"), remedy));
  GltfBuilder binary;
  binary.Triangle();
  std::vector<unsigned char> glb = binary.Glb();
  glb[4] = 1;
  EXPECT_THAT(Refusal(Write("old.glb", glb)), AllOf(HasSubstr("is binary glTF 1;"), remedy));
  // Another version is no glTF 1.0, nor is a key of that name elsewhere.
  json new_one = keyed;
  new_one["asset"] = {{"version", "2.0"}, {"minVersion", "1.0"}, {"extras", {{"version", "1.0"}}}};
  EXPECT_THAT(refusal(new_one), Not(HasSubstr("glTF 1.0")));
}

TEST_F(Misread, GltfMaterialsThatAreSeenThrough) {
  GltfBuilder b;
  b.Triangle();
  const auto add = [&](const char* name, const char* mode, double alpha, const json& extensions) {
    b.Append("materials", {{"name", name},
                           {"alphaMode", mode},
                           {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}},
                           {"extensions", extensions}});
  };
  const json glass = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
  add("thin", "BLEND", 0.4, json::object());
  add("thick", "BLEND", 0.6, json::object());
  add("hidden", "BLEND", 0.0, json::object());
  add("mask", "MASK", 0.4, json::object());
  add("opaque", "OPAQUE", 0.4, {{"KHR_materials_transmission", {{"transmissionFactor", 0}}}});
  add("glass", "OPAQUE", 1.0, glass);
  add("flat", "OPAQUE", 1.0, {{"KHR_materials_unlit", json::object()}});
  json& primitives = b.json["meshes"][0]["primitives"];
  const json primitive = primitives[0];
  for (std::size_t i = 0; i < b.json["materials"].size(); ++i) {
    primitives[i] = primitive;
    primitives[i]["material"] = i;
  }
  add("thin and without faces", "BLEND", 0.4, {{"KHR_materials_unlit", json::object()}});
  EXPECT_THAT(Load(Write("scene.glb", b.Glb())).warnings,
              ElementsAre(AllOf(HasSubstr("below one half are left out"), HasSubstr("(material 0 'thin')")),
                          AllOf(HasSubstr("are solid"), HasSubstr("(material 1 'thick')")),
                          AllOf(HasSubstr("transmission"), HasSubstr("(material 5 'glass')")),
                          AllOf(HasSubstr("unlit"), HasSubstr("(material 6 'flat')"))));
}

TEST_F(Misread, TexturesWithoutAnIndex) {
  GltfBuilder b;
  b.Triangle();
  const json below = {{"index", -1}}, absent = {{"texCoord", 0}};
  b.Append("materials", {{"name", "Red"},
                         {"pbrMetallicRoughness", {{"baseColorTexture", below}, {"metallicRoughnessTexture", absent}}},
                         {"normalTexture", json::object()},
                         {"emissiveTexture", below}});
  b.Append("materials", {{"name", "Sound"}});
  const auto warnings = [&] { return Load(Write("scene.glb", b.Glb())).warnings; };
  EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("textures whose index is missing or below 0 are left out"),
                                            HasSubstr("first: material 0 'Red', baseColorTexture, 4 in all"))));
  b.json["materials"][0] = {
      {"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseTexture", {{"index", -2}}}}}}}};
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("SpecularGlossiness"), HasSubstr("(material 0, diffuseTexture)")));
  b.json["materials"][0] = {
      {"extras", {{"scumble", {{"normal", {{"space", "TANGENT"}, {"strength", 1}, {"texture", {{"index", -1}}}}}}}}}};
  EXPECT_THAT(warnings(), ::testing::Contains(HasSubstr("(material 0, normal)")));
}

}  // namespace
}  // namespace scumble
