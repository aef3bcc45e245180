// Normals that a file lacks: flat, smooth up to an angle, or as its format says.
#include "guidegen/load/auto_smooth.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "guidegen/load/mesh_normals.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/numbers.h"

namespace scumble {
namespace auto_smooth_cases {  // other tests of the loaders have cubes and balls, too
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Mesh Smoothed(Mesh mesh, double degrees, const std::vector<std::uint32_t>& faces = {}) {
  const std::vector<std::uint32_t> weld = WeldByPosition(mesh.positions);
  SetCornerNormals(AutoSmoothNormals({mesh.positions, mesh.triangles, weld, faces}, degrees), mesh);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  return mesh;
}

glm::vec3 NormalOf(const Mesh& mesh, std::size_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  return glm::vec3(glm::normalize(glm::cross(b - a, c - a)));
}

// The largest angle between a corner's normal and that of its triangle, degrees.
double LargestBend(const Mesh& mesh) {
  double least = 1.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      least = std::min(least, glm::dot(glm::dvec3(mesh.normals[mesh.triangles[t][i]]), glm::dvec3(NormalOf(mesh, t))));
    }
  }
  return std::acos(least) * 180.0 / kPi;
}

void AddQuad(Mesh& mesh, unsigned a, unsigned b, unsigned c, unsigned d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

// The cube from -1 to 1 with eight vertices.
Mesh Cube() {
  Mesh mesh;
  for (unsigned i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  const unsigned faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) AddQuad(mesh, f[0], f[1], f[2], f[3]);
  return mesh;
}

// Sides of a prism about Y, its ends left open or not; corners rounded to text of six decimals.
Mesh Prism(unsigned sides, bool closed) {
  Mesh mesh;
  for (unsigned i = 0; i < sides; ++i) {
    const double angle = 2.0 * kPi * i / sides;
    const auto rounded = [](double x) { return static_cast<float>(std::round(x * 1e6) / 1e6); };
    for (const float y : {-1.0f, 1.0f})
      mesh.positions.emplace_back(rounded(std::sin(angle)), y, rounded(std::cos(angle)));
  }
  for (unsigned i = 0; i < sides; ++i) {
    const unsigned a = 2 * i, b = 2 * ((i + 1) % sides);
    AddQuad(mesh, a, b, b + 1, a + 1);
  }
  for (unsigned i = 1; closed && i + 1 < sides; ++i) {
    mesh.triangles.emplace_back(1, 2 * i + 1, 2 * i + 3);
    mesh.triangles.emplace_back(0, 2 * i + 2, 2 * i);
  }
  return mesh;
}

// Radius 1; the first meridian is there twice, the poles once for every meridian.
Mesh Ball(int rows) {
  Mesh mesh;
  const int columns = 2 * rows;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const double theta = kPi * r / rows, phi = 2 * kPi * (c % columns) / columns;
      const double ring = r == 0 || r == rows ? 0.0 : std::sin(theta);
      mesh.positions.emplace_back(ring * std::sin(phi), std::cos(theta), ring * std::cos(phi));
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const unsigned a = unsigned(r * (columns + 1) + c), b = a + unsigned(columns) + 1;
      AddQuad(mesh, a, b, b + 1, a + 1);
    }
  }
  return mesh;
}

TEST(AutoSmooth, ABoxIsABoxUpToTheAngleOfItsEdges) {
  for (const double degrees : {0.0, 1.0, 60.0, 89.9}) {
    const Mesh mesh = Smoothed(Cube(), degrees);
    EXPECT_EQ(LargestBend(mesh), 0.0) << degrees;
    EXPECT_EQ(mesh.positions.size(), 24u) << degrees;
  }
  // A limit that is the angle smooths.
  for (const double degrees : {90.0, 120.0, 180.0}) {
    const Mesh mesh = Smoothed(Cube(), degrees);
    EXPECT_EQ(mesh.positions.size(), 8u) << degrees;
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_LT(glm::distance(mesh.normals[i], glm::normalize(mesh.positions[i])), 1e-6f) << degrees;
    }
  }
}

TEST(AutoSmooth, PolygonsAreFaces) {
  // A quad that is bent by 90° at its diagonal is one face, with one normal, whatever the limit.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
  for (const double degrees : {0.0, 30.0}) {
    const Mesh one = Smoothed(mesh, degrees, {0, 0});
    EXPECT_EQ(one.positions.size(), 4u);
    for (const glm::vec3& normal : one.normals) EXPECT_EQ(normal, one.normals[0]);
    EXPECT_EQ(Smoothed(mesh, degrees).positions.size(), 6u);
  }
}

TEST(AutoSmooth, AnExactAngleIsSmoothOnEveryEdgeDespiteRounding) {
  for (const unsigned sides : {3u, 5u, 6u, 7u, 12u}) {
    const double angle = 360.0 / sides;
    // The ends are sharp, at 90°, or the sides are.
    if (angle < 90.0) {
      EXPECT_EQ(Smoothed(Prism(sides, true), angle).positions.size(), 4u * sides);
      EXPECT_LT(std::abs(LargestBend(Smoothed(Prism(sides, true), angle)) - angle / 2), 0.001);
    }
    EXPECT_EQ(Smoothed(Prism(sides, false), angle).positions.size(), 2u * sides);
    EXPECT_EQ(Smoothed(Prism(sides, false), angle - 0.1).positions.size(), 4u * sides);
  }
}

TEST(AutoSmooth, ABallIsSmoothAcrossItsSeam) {
  for (const double degrees : {30.0, 60.0}) {
    const Mesh before = Ball(24), mesh = Smoothed(before, degrees);
    EXPECT_EQ(mesh.positions, before.positions);
    EXPECT_EQ(mesh.triangles, before.triangles);
    const std::vector<glm::vec3> smooth =
        SmoothNormals(before.positions, before.triangles, WeldByPosition(before.positions));
    for (std::size_t i = 0; i < smooth.size(); ++i) EXPECT_LT(glm::distance(mesh.normals[i], smooth[i]), 1e-6f);
  }
}

TEST(AutoSmooth, BothSidesOfASheetKeepTheirOwn) {
  Mesh sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  AddQuad(sheet, 0, 1, 2, 3);
  AddQuad(sheet, 0, 3, 2, 1);
  const Mesh mesh = Smoothed(sheet, 60.0);
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(LargestBend(mesh), 0.0);
}

// A quarter of a tube of `rows` × 8 quads, flat in Y, its axis Y.
Mesh Arch(int rows) {
  Mesh mesh;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= 8; ++c) {
      const double angle = kPi / 16 * c;
      mesh.positions.emplace_back(std::sin(angle), double(r) / rows, std::cos(angle));
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < 8; ++c) {
      const unsigned a = unsigned(9 * r + c);
      AddQuad(mesh, a, a + 1, a + 10, a + 9);
    }
  }
  return mesh;
}

TEST(AutoSmooth, SliversHaveNoSay) {
  // A box, and an arch, with slivers along edges: of no area, with two corners in one place, and of rounding noise that
  // looks sideways.
  for (const bool is_box : {true, false}) {
    Mesh mesh = is_box ? Cube() : Arch(1);
    const std::size_t real = mesh.triangles.size();
    // An edge between two faces that meet at 90°, or at 11.25°.
    const unsigned a = is_box ? 0 : 4, b = is_box ? 1 : 13;
    const glm::vec3 middle = 0.5f * (mesh.positions[a] + mesh.positions[b]);
    // The faces at one side are cut at the middle, those at the other are not: a sliver fills the gap.
    for (std::size_t t = 0; t < real; ++t) {
      glm::uvec3& triangle = mesh.triangles[t];
      for (int i = 0; i < 3; ++i) {
        if (triangle[i] != a || triangle[(i + 1) % 3] != b) continue;
        const auto m = static_cast<unsigned>(mesh.positions.size());
        mesh.positions.push_back(middle + (is_box ? glm::vec3(0, 0, 3e-8f) : glm::vec3(6e-8f, 0, 6e-8f)));
        const unsigned c = triangle[(i + 2) % 3];
        triangle = {a, m, c};
        mesh.triangles.emplace_back(m, b, c);
        mesh.triangles.emplace_back(a, b, m);
        i = 3;
        t = real;
      }
    }
    ASSERT_EQ(mesh.triangles.size(), real + 2);
    mesh.triangles.emplace_back(a, a, b);
    const Mesh smoothed = Smoothed(mesh, 60.0);
    for (std::size_t t = 0; t < smoothed.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        const glm::uvec3& corners = smoothed.triangles[t];
        const glm::dvec3 p(smoothed.positions[corners[i]]), n(smoothed.normals[corners[i]]);
        EXPECT_NEAR(glm::length(n), 1.0, 1e-6);
        if (t >= real + 1) continue;  // the slivers'
        const glm::dvec3 expected = is_box ? glm::dvec3(NormalOf(smoothed, t)) : glm::dvec3(p.x, 0.0, p.z);
        // The arch's borders lean as its last faces do, and the cut is a corner of one side's faces alone.
        const bool is_inside = is_box || (p.x > 0.01 && p.z > 0.01 && p.y != 0.5);
        EXPECT_LT(is_inside ? glm::distance(n, expected) : 0.0, 1e-3) << t << " " << i;
      }
    }
  }
}

TEST(AutoSmooth, SurfacesThatMeetWithOtherVerticesBetweenAreSmooth) {
  // Two arches end to end; the upper one's border has every second vertex of the lower one's.
  Mesh mesh = Arch(1);
  const auto first = unsigned(mesh.positions.size());
  for (const float y : {1.0f, 2.0f}) {
    for (int c = 0; c <= 8; c += 2)
      mesh.positions.emplace_back(mesh.positions[9 + unsigned(c)].x, y, mesh.positions[9 + unsigned(c)].z);
  }
  for (unsigned c = 0; c < 4; ++c) AddQuad(mesh, first + c, first + c + 1, first + c + 6, first + c + 5);
  const Mesh smoothed = Smoothed(mesh, 60.0);
  EXPECT_EQ(smoothed.positions.size(), mesh.positions.size());
  EXPECT_EQ(smoothed.normals[9 + 4], smoothed.normals[first + 2]);
}

// The groups by their definition: corners of one place are neighbours if they share an edge, or both have an edge of
// their own, and their faces are within the limit.
std::vector<glm::vec3> PlainNormals(const Mesh& mesh, double degrees) {
  const std::size_t corners = 3 * mesh.triangles.size();
  const auto vertex = [&](std::size_t corner, std::size_t turn) {
    return mesh.triangles[corner / 3][int((corner % 3 + turn) % 3)];
  };
  std::multiset<std::pair<unsigned, unsigned>> edges;
  for (std::size_t c = 0; c < corners; ++c) edges.insert(std::minmax({vertex(c, 0), vertex(c, 1)}));
  const auto edges_at = [&](std::size_t c) {
    std::vector<std::pair<unsigned, unsigned>> found;
    for (const std::size_t turn : {1, 2}) {
      const std::pair<unsigned, unsigned> edge = std::minmax({vertex(c, 0), vertex(c, turn)});
      found.push_back(edges.count(edge) == 1 ? std::pair{~0u, ~0u} : edge);
    }
    return found;
  };
  const auto are_neighbours = [&](std::size_t c, std::size_t d) {
    if (vertex(c, 0) != vertex(d, 0)) return false;
    const double cosine = glm::dot(glm::dvec3(NormalOf(mesh, c / 3)), glm::dvec3(NormalOf(mesh, d / 3)));
    if (std::acos(std::clamp(cosine, -1.0, 1.0)) > (degrees + 0.01) * kPi / 180.0) return false;
    for (const auto& e : edges_at(c)) {
      for (const auto& f : edges_at(d)) {
        if (e == f) return true;
      }
    }
    return false;
  };
  std::vector<glm::vec3> normals(corners, glm::vec3(0.0f));
  for (std::size_t start = 0; start < corners; ++start) {
    if (normals[start] != glm::vec3(0.0f)) continue;
    std::vector<std::size_t> group = {start};
    for (std::size_t g = 0; g < group.size(); ++g) {
      for (std::size_t c = 0; c < corners; ++c) {
        if (are_neighbours(group[g], c) && std::find(group.begin(), group.end(), c) == group.end()) group.push_back(c);
      }
    }
    glm::dvec3 sum(0.0);
    for (const std::size_t c : group) {
      const glm::dvec3 p(mesh.positions[vertex(c, 0)]);
      const glm::dvec3 a = glm::normalize(glm::dvec3(mesh.positions[vertex(c, 1)]) - p);
      const glm::dvec3 b = glm::normalize(glm::dvec3(mesh.positions[vertex(c, 2)]) - p);
      sum += std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::dvec3(NormalOf(mesh, c / 3));
    }
    for (const std::size_t c : group) normals[c] = glm::vec3(glm::normalize(sum));
  }
  return normals;
}

TEST(AutoSmooth, RoughSurfacesAsTheDefinitionSays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> height(0.0f, 1.0f);
  for (int round = 0; round < 6; ++round) {
    // Heights over a grid of squares, a part of them missing, so that borders meet in corners.
    Mesh mesh;
    constexpr unsigned kSide = 6;
    for (unsigned y = 0; y <= kSide; ++y) {
      for (unsigned x = 0; x <= kSide; ++x) mesh.positions.emplace_back(x, y, height(random));
    }
    for (unsigned y = 0; y < kSide; ++y) {
      for (unsigned x = 0; x < kSide; ++x) {
        const unsigned a = y * (kSide + 1) + x;
        if (height(random) < 0.8f) AddQuad(mesh, a, a + 1, a + kSide + 2, a + kSide + 1);
      }
    }
    for (const double degrees : {10.0, 30.0, 45.0, 60.0}) {
      const Mesh smoothed = Smoothed(mesh, degrees);
      const std::vector<glm::vec3> plain = PlainNormals(mesh, degrees);
      for (std::size_t c = 0; c < plain.size(); ++c) {
        const unsigned vertex = smoothed.triangles[c / 3][int(c % 3)];
        EXPECT_LT(glm::distance(smoothed.normals[vertex], plain[c]), 1e-5f) << round << " " << degrees << " " << c;
      }
    }
  }
}

TEST(AutoSmooth, ManyFacesOnOneEdgeOrAtOnePlaceTakeNoQuadraticTime) {
  constexpr unsigned kPages = 200'000;
  for (const bool is_book : {true, false}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 1, 0}};
    for (unsigned i = 0; i <= kPages; ++i) {
      const double angle = 2.0 * kPi * i / kPages;
      mesh.positions.emplace_back(std::sin(angle), is_book ? 0.5 : -0.1, std::cos(angle));
    }
    for (unsigned i = 0; i < kPages; ++i) mesh.triangles.emplace_back(is_book ? 1 : i + 3, 0, i + 2);
    for (const double degrees : {0.0, 60.0}) EXPECT_EQ(Smoothed(mesh, degrees).triangles.size(), kPages);
  }
}

class MissingNormalsTest : public LoaderTest {
 protected:
  Scene Load(const std::filesystem::path& path, std::optional<double> degrees = std::nullopt) {
    Expected<Scene> scene = LoadScene(path, {TextureLoading::kNow, degrees});
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return scene ? std::move(*scene) : Scene{};
  }
  // Two squares that meet at an angle; `lines` stand before the first and the second.
  std::filesystem::path Roof(double degrees, const std::string& first, const std::string& second) {
    const double angle = degrees * kPi / 180.0;
    return Write("roof.obj", "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\nv " + std::to_string(1 + std::cos(angle)) + " " +
                                 std::to_string(std::sin(angle)) + " 0\nv " + std::to_string(1 + std::cos(angle)) +
                                 " " + std::to_string(std::sin(angle)) + " -1\n" + first + "f 1 2 3 4\n" + second +
                                 "f 2 5 6 3\n");
  }
  static GltfBuilder Box(bool with_zero_normals = false) {
    const Mesh cube = Cube();
    std::vector<float> places;
    std::vector<std::uint16_t> indices;
    for (const glm::vec3& p : cube.positions) places.insert(places.end(), {p.x, p.y, p.z});
    for (const glm::uvec3& t : cube.triangles) {
      for (int i = 0; i < 3; ++i) indices.push_back(static_cast<std::uint16_t>(t[i]));
    }
    GltfBuilder b;
    nlohmann::json attributes = {{"POSITION", b.Floats(places, 3)}};
    if (with_zero_normals) attributes["NORMAL"] = b.Floats(std::vector<float>(24, 0.0f), 3);
    b.Root({{"name", "Box"}, {"mesh", b.Mesh({{{"attributes", attributes}, {"indices", b.Indices(indices)}}})}});
    return b;
  }
};

TEST_F(MissingNormalsTest, EachFormatHasItsRule) {
  // What says nothing is smooth up to 60°.
  EXPECT_NEAR(LargestBend(Load(Roof(50, "", "")).meshes[0]), 25.0, 0.01);
  EXPECT_LT(LargestBend(Load(Roof(70, "", "")).meshes[0]), 0.03);
  // `s off` and what stands before any `s` are flat; groups are smooth whatever the angle.
  EXPECT_LT(LargestBend(Load(Roof(50, "s off\n", "")).meshes[0]), 0.03);
  EXPECT_LT(LargestBend(Load(Roof(50, "s 0\n", "")).meshes[0]), 0.03);
  EXPECT_LT(LargestBend(Load(Roof(50, "", "s 1\n")).meshes[0]), 0.03);
  EXPECT_LT(LargestBend(Load(Roof(50, "s 1\n", "s 2\n")).meshes[0]), 0.03);
  EXPECT_NEAR(LargestBend(Load(Roof(70, "s 3\n", "")).meshes[0]), 35.0, 0.01);
  // A group's name, a material and a comment are no smoothing groups.
  EXPECT_NEAR(LargestBend(Load(Roof(50, "# s off\ng s off\nusemtl s\n", "")).meshes[0]), 25.0, 0.01);
  // The user goes before all of that.
  EXPECT_NEAR(LargestBend(Load(Roof(70, "s off\n", ""), 70.0).meshes[0]), 35.0, 0.01);
  EXPECT_LT(LargestBend(Load(Roof(70, "s 3\n", ""), 0.0).meshes[0]), 0.03);

  EXPECT_LT(LargestBend(Load(Write("box.glb", Box().Glb())).meshes[0]), 0.03);
  EXPECT_NEAR(LargestBend(Load(Write("box.glb", Box().Glb()), 180.0).meshes[0]), 54.7356, 0.001);
  EXPECT_EQ(Load(Write("box.glb", Box().Glb()), 180.0).meshes[0].positions.size(), 8u);

  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 0 -1\n0 0 -1\n1 1 0\n1 1 -1\n4 0 1 2 3\n4 1 4 5 2\n";
  EXPECT_LT(LargestBend(Load(Write("box.ply", ply)).meshes[0]), 0.03);
  EXPECT_NEAR(LargestBend(Load(Write("box.ply", ply), 90.0).meshes[0]), 45.0, 0.001);
}

// Two-sided surfaces are often modelled by each face twice, in one smoothing group: the two would cancel each other.
TEST_F(MissingNormalsTest, FacesThatLieOnOthersAreSmoothAsThose) {
  for (const char* again : {"f 4 3 2 1\n", "f 2 1 4 3\n", "f 1 2 3 4\n"}) {
    EXPECT_NEAR(LargestBend(Load(Roof(70, "s 3\n", again)).meshes[0]), 35.0, 0.01) << again;
    EXPECT_NEAR(LargestBend(Load(Roof(50, "", again)).meshes[0]), 25.0, 0.01) << again;
    EXPECT_LT(LargestBend(Load(Roof(70, "s off\n", again)).meshes[0]), 0.03) << again;
  }
  EXPECT_NEAR(LargestBend(Load(Roof(50, "", "f 4 3 2 1\n"), 180.0).meshes[0]), 25.0, 0.01);
  EXPECT_EQ(Load(Roof(70, "s 3\n", "f 4 3 2 1\n")).meshes[0].triangles.size(), 6u);
}

TEST_F(MissingNormalsTest, TheNotesSayWhatWasDone) {
  EXPECT_THAT(Load(Write("box.glb", Box().Glb())).notes,
              ElementsAre("12 triangles without normals are flat, as glTF demands; --auto-smooth DEGREES changes it"));
  EXPECT_THAT(Load(Write("box.glb", Box().Glb()), 30.5).notes,
              ElementsAre("12 triangles without normals are smooth up to 30.5°, as --auto-smooth says"));
  EXPECT_THAT(Load(Write("box.glb", Box().Glb()), 180.0).notes, ElementsAre(HasSubstr("smooth everywhere")));
  EXPECT_THAT(Load(Roof(50, "", "")).notes,
              ElementsAre(HasSubstr("4 triangles without normals are smooth up to 60°; ")));
  EXPECT_THAT(Load(Roof(50, "s 1\n", "")).notes, ElementsAre(HasSubstr("smoothing groups")));
  // A file that gives them all.
  const std::string given = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 0\nf 1//1 2//1 3//1\n";
  EXPECT_THAT(Load(Write("a.obj", given)).notes, IsEmpty());
  EXPECT_THAT(Load(Write("a.obj", given), 0.0).notes, ElementsAre(HasSubstr("--auto-smooth changes nothing")));
  // A normal without a direction is none.
  EXPECT_THAT(Load(Write("a.obj", given + "f 1//1 2//1 3//2\n")).notes, ElementsAre(HasSubstr("1 triangle without")));
}

TEST_F(MissingNormalsTest, NormalsThatAreAllZeroAreNone) {
  const Scene scene = Load(Write("box.glb", Box(true).Glb()));
  EXPECT_EQ(LargestBend(scene.meshes[0]), 0.0);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("without a direction")));
}

TEST_F(MissingNormalsTest, ADeformedMeshStaysFlatOrSmooth) {
  // The box's upper side moves by 1, and by 3 with the joint; both tilt its walls.
  GltfBuilder b = Box();
  std::vector<float> raised(24, 0.0f), weights;
  std::vector<std::uint16_t> joints(32, 0);
  const Mesh cube = Cube();
  for (std::size_t i = 0; i < 8; ++i) {
    const bool top = cube.positions[i].y > 0.0f;
    raised[3 * i] = top ? 1.0f : 0.0f;
    weights.insert(weights.end(), {top ? 0.0f : 1.0f, top ? 1.0f : 0.0f, 0.0f, 0.0f});
    joints[4 * i + 1] = 1;
  }
  nlohmann::json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["targets"] = {{{"POSITION", b.Floats(raised, 3)}}};
  primitive["attributes"]["WEIGHTS_0"] = b.Floats(weights, 4);
  primitive["attributes"]["JOINTS_0"] = b.Accessor(b.View(joints), kUshort, 8, "VEC4");
  b.json["meshes"][0]["weights"] = {0.0};
  const int still = b.Root({{"name", "Still"}}), moved = b.Root({{"name", "Moved"}});
  b.Append("skins", {{"joints", {still, moved}}});
  b.json["nodes"][0]["skin"] = 0;
  b.Animate(0, "weights", {0, 1}, {0, 1});
  b.Animate(moved, "translation", {1, 2}, {0, 0, 0, 0, 0, 3});
  const std::filesystem::path file = Write("box.glb", b.Glb());
  for (const double degrees : {0.0, 60.0}) {
    const auto animated = AnimatedScene::Load(file, {"", {TextureLoading::kNow, degrees}});
    ASSERT_TRUE(animated.ok()) << animated.error().message;
    for (const double seconds : {0.0, 1.0, 2.0}) {
      const Mesh mesh = animated->SceneAt(seconds)->meshes[0];
      EXPECT_EQ(mesh.positions.size(), degrees == 0.0 ? 36u : 24u);
      float highest = 0.0f;
      for (const glm::vec3& p : mesh.positions) highest = std::max(highest, p.x + p.z);
      EXPECT_EQ(highest, 2.0f + std::min(1.0f, float(seconds)) + 3.0f * std::max(0.0f, float(seconds) - 1.0f));
      // Sheared walls are still planes.
      EXPECT_LT(LargestBend(mesh), 0.02) << degrees << " " << seconds;
    }
  }
  const auto smooth = AnimatedScene::Load(file, {"", {TextureLoading::kNow, 180.0}});
  EXPECT_EQ(smooth->SceneAt(2.0)->meshes[0].positions.size(), 8u);
  const Mesh mesh = smooth->SceneAt(2.0)->meshes[0];
  const std::vector<glm::vec3> expected = SmoothNormals(mesh.positions, mesh.triangles, WeldByPosition(mesh.positions));
  EXPECT_EQ(mesh.normals, expected);
}

TEST_F(MissingNormalsTest, SplitVerticesKeepTheirAttributes) {
  GltfBuilder b = Box();
  std::vector<float> uvs, colors;
  for (int i = 0; i < 8; ++i) {
    uvs.insert(uvs.end(), {0.1f * float(i), 0.5f});
    colors.insert(colors.end(), {0.1f * float(i), 0.2f, 0.3f});
  }
  nlohmann::json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = b.Floats(uvs, 2);
  attributes["COLOR_0"] = b.Floats(colors, 3);
  attributes["_SCUMBLE_REST"] = attributes["POSITION"];
  const Mesh mesh = Load(Write("box.glb", b.Glb())).meshes[0];
  ASSERT_EQ(mesh.positions.size(), 24u);
  const Mesh cube = Cube();
  for (std::size_t t = 0; t < 12; ++t) {
    for (int i = 0; i < 3; ++i) {
      const unsigned now = mesh.triangles[t][i], then = cube.triangles[t][i];
      EXPECT_EQ(mesh.positions[now], cube.positions[then]);
      EXPECT_EQ(mesh.rest_positions[now], cube.positions[then]);
      EXPECT_EQ(mesh.uvs[0][now].x, 0.1f * float(then));
      EXPECT_EQ(mesh.colors[now].x, 0.1f * float(then));
    }
  }
}

}  // namespace
}  // namespace auto_smooth_cases
}  // namespace scumble
