// Tangents of meshes against MikkTSpace's rules.
#include "guidegen/load/tangents.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

void ExpectNear(const glm::vec4& a, const glm::vec4& b) {
  EXPECT_LE(glm::length(a - b), 1e-6f) << a.x << " " << a.y << " " << a.z << " " << a.w << " against " << b.x << " "
                                       << b.y << " " << b.z << " " << b.w;
}

TEST(Tangents, FollowTheTexture) {
  Mesh mesh = QuadMesh();  // u runs along +X, and up in the picture is +Y
  EXPECT_EQ(FillTangents(mesh, 0, glm::mat3(1.0f)).size(), 4u);
  for (const glm::vec4& tangent : mesh.tangents) ExpectNear(tangent, {1, 0, 0, 1});
  FillTangents(mesh, 0, glm::mat3(-1, 0, 0, 0, 1, 0, 0, 0, 1));
  for (const glm::vec4& tangent : mesh.tangents) ExpectNear(tangent, {-1, 0, 0, -1});
}

// Two squares side by side, the right one with the left one's picture mirrored: they share a place, a normal and
// coordinates along the middle, but no tangent.
TEST(Tangents, AMirroredSeamIsSplit) {
  Mesh mesh;
  mesh.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.normals.assign(6, {0, 0, 1});
  mesh.uvs[0] = {{0, 1}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  const std::vector<std::uint32_t> sources = FillTangents(mesh, 0, glm::mat3(1.0f));
  EXPECT_EQ(sources, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 1, 4}));
  ASSERT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(mesh.normals.size(), 8u);
  EXPECT_EQ(mesh.uvs[0].size(), 8u);
  for (std::size_t t = 0; t < 4; ++t) {
    for (int i = 0; i < 3; ++i) {
      ExpectNear(mesh.tangents[mesh.triangles[t][i]], t < 2 ? glm::vec4(1, 0, 0, 1) : glm::vec4(-1, 0, 0, -1));
    }
  }
}

// Three triangles about a point, of 90°, 60° and 30°, in each of which u grows in another direction.
TEST(Tangents, TrianglesCountByTheirAngle) {
  const double angles[] = {90, 60, 30};
  Mesh mesh;
  mesh.positions = {{0, 0, 0}};
  for (const double angle : {0.0, 90.0, 150.0, 180.0}) {
    const double a = glm::radians(angle);
    mesh.positions.emplace_back(2 * std::cos(a), 2 * std::sin(a), 0);
  }
  mesh.normals.assign(5, {0, 0, 1});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  mesh.uvs[0] = {{0, 0}, {1.0f, 0.1f}, {0.2f, -1.0f}, {-0.9f, -0.6f}, {-1.1f, 0.2f}};
  glm::dvec3 sum(0.0);
  for (int t = 0; t < 3; ++t) {
    const glm::dvec2 p1(mesh.positions[std::size_t(t + 1)]), p2(mesh.positions[std::size_t(t + 2)]);
    const glm::dvec2 uv1(mesh.uvs[0][std::size_t(t + 1)]), uv2(mesh.uvs[0][std::size_t(t + 2)]);
    // The direction in which v stays and u grows: a p1 + b p2 with a v1 + b v2 = 0.
    glm::dvec2 along = p1 * uv2.y - p2 * uv1.y;
    if (uv1.x * uv2.y - uv2.x * uv1.y < 0.0) along = -along;
    sum += glm::radians(angles[t]) * glm::normalize(glm::dvec3(along, 0.0));
  }
  FillTangents(mesh, 0, glm::mat3(1.0f));
  ExpectNear(mesh.tangents[0], glm::vec4(glm::normalize(sum), 1.0f));
}

TEST(Tangents, ATriangleWithoutPictureTakesItsNeighbours) {
  Mesh mesh = QuadMesh();
  mesh.positions.emplace_back(2, 0, 0);
  mesh.normals.emplace_back(0, 0, 1);
  mesh.uvs[0].push_back(mesh.uvs[0][1]);
  mesh.triangles.emplace_back(1, 4, 2);
  FillTangents(mesh, 0, glm::mat3(1.0f));
  ExpectNear(mesh.tangents[1], {1, 0, 0, 1});
  ExpectNear(mesh.tangents[2], {1, 0, 0, 1});
  ExpectNear(mesh.tangents[4], {1, 0, 0, -1});  // nobody's
  mesh.uvs[0].assign(mesh.positions.size(), glm::vec2(std::nanf("")));
  FillTangents(mesh, 0, glm::mat3(1.0f));
  for (const glm::vec4& tangent : mesh.tangents) EXPECT_TRUE(std::isfinite(tangent.x + tangent.y + tangent.z));
}

// Two triangles of one square, in meshes of their own.
std::array<Mesh, 2> Halves() {
  std::array<Mesh, 2> halves = {QuadMesh(), QuadMesh()};
  halves[0].triangles = {{0, 1, 2}};
  halves[1].triangles = {{0, 2, 3}};
  for (Mesh& half : halves) half.uvs[0] = {{0, 0.7f}, {1, 0.7f}, {1.2f, 0.1f}, {0, 0.2f}};  // no parallelogram
  return halves;
}

TEST(Tangents, PartsOfOneSurfaceShareThem) {
  std::array<Mesh, 2> halves = Halves();
  Mesh whole = halves[0];
  whole.triangles.push_back(halves[1].triangles[0]);
  FillTangents(whole, 0, glm::mat3(1.0f));
  const std::array<TangentPart, 2> parts = {TangentPart{&halves[0], true, {}}, TangentPart{&halves[1], false, {}}};
  const auto sources = FillTangents(parts, 0, glm::mat3(1.0f));
  EXPECT_EQ(sources[0].size(), 4u);
  EXPECT_TRUE(sources[1].empty());
  for (const std::size_t corner : {0u, 1u, 2u}) EXPECT_EQ(halves[0].tangents[corner], whole.tangents[corner]);
  EXPECT_TRUE(halves[1].tangents.empty()) << "it wants none, and its triangle counts all the same";
  Mesh alone = Halves()[0];
  FillTangents(alone, 0, glm::mat3(1.0f));
  EXPECT_NE(alone.tangents[0], whole.tangents[0]);
}

// Coordinates that differ before they became 1 − v, and not after.
TEST(Tangents, BlendersOwnCoordinatesTellVerticesApart) {
  const float v = 0.1f;
  const float above = std::nextafter(v, 1.0f), below = std::nextafter(v, 0.0f);
  const float other = 1.0f - above == 1.0f - v ? above : below;
  ASSERT_EQ(1.0f - v, 1.0f - other);
  std::array<Mesh, 2> halves = Halves();
  const std::vector<float> heights = {v, v, 0.9f, 0.8f};
  std::array<std::vector<float>, 2> exact = {heights, heights};
  for (Mesh& half : halves) {
    for (std::size_t i = 0; i < 4; ++i) half.uvs[0][i].y = 1.0f - heights[i];
  }
  std::array<Mesh, 2> torn = halves;
  const auto fill = [&](std::array<Mesh, 2>& meshes) {
    FillTangents(std::array{TangentPart{&meshes[0], true, exact[0]}, TangentPart{&meshes[1], true, exact[1]}}, 0,
                 glm::mat3(1.0f));
  };
  fill(halves);
  EXPECT_EQ(halves[0].tangents[0], halves[1].tangents[0]);
  exact[1][0] = other;
  fill(torn);
  EXPECT_NE(torn[0].tangents[0], torn[1].tangents[0]);
  exact[1][0] = 0.4f;  // of another UV set
  std::array<Mesh, 2> again = halves;
  fill(again);
  EXPECT_EQ(again[1].tangents[2], halves[1].tangents[2]);
}

// A stretched mesh has the tangents of the mesh before the stretch.
TEST(Tangents, AStretchIsUndone) {
  Mesh plain = BallMesh(12);
  Mesh stretched = plain;
  const glm::vec3 sizes(2.0f, 0.5f, 3.0f);
  stretched.stretch = glm::dmat3(glm::dvec3(2, 0, 0), glm::dvec3(0, 0.5, 0), glm::dvec3(0, 0, 3));
  for (glm::vec3& position : stretched.positions) position *= sizes;
  for (glm::vec3& normal : stretched.normals) normal = glm::normalize(normal / sizes);
  const auto one = FillTangents(plain, 0, glm::mat3(1.0f)), other = FillTangents(stretched, 0, glm::mat3(1.0f));
  ASSERT_EQ(one, other);
  for (std::size_t i = 0; i < plain.tangents.size(); ++i) {
    if (std::abs(plain.normals[i].y) > 0.99f) continue;  // triangles at the poles are rounding
    EXPECT_LE(glm::length(plain.tangents[i] - stretched.tangents[i]), 2e-5f) << i;
  }
}

}  // namespace
}  // namespace scumble::testing
