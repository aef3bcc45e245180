// A tile's guides in vectors against the plain code, FindSurfacePoint, pixel by pixel and bit by bit.
#include "guidegen/cast/tile_surface.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/image/plane_allocator.h"
#include "guidegen/cast/tile_store.h"
#include "guidegen/rays/camera_rays.h"
#include "guidegen/surface/shading_normal.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

// Objects before a camera, a tile of its picture, and given hits of its rays. The plain code needs only a triangle's
// number, so hits may be wilder than Embree's ever are.
struct Case {
  std::vector<Mesh> meshes;
  Material material;
  std::vector<PlacedObject> objects;
  CameraRays camera;
  Tile tile{32, 16, kTileSide, kTileSide};
  TileHits hits;
  TileRays rays;

  void Look(const Camera& from) {
    camera = CameraRays::Make(from, 96, 64).value();
    rays.orthographic = camera.orthographic();
    for (int i = 0; i < kTileSide; ++i) {
      const ViewRay ray = camera.Through(tile.x0 + i + 0.5, tile.y0 + i + 0.5);
      rays.across[i] = (rays.orthographic ? ray.origin : ray.direction).x;
      rays.up[i] = (rays.orthographic ? ray.origin : ray.direction).y;
    }
  }

  void PlaceAt(const std::vector<glm::dmat4>& view_from_object) {
    for (std::size_t i = 0; i < view_from_object.size(); ++i) {
      objects.push_back(Place(&meshes[i % meshes.size()], &material, {}, view_from_object[i]));
      objects.back().object_id = std::uint32_t(100 + i);
      objects.back().material_id = std::uint32_t(7 * i);
    }
  }

  ViewRay RayOf(int pixel) const {
    return camera.Through(tile.x0 + TileColumn(pixel) + 0.5, tile.y0 + TileRow(pixel) + 0.5);
  }
};

template <class T>
::testing::AssertionResult SameBits(const char* a_text, const char* b_text, T a, T b) {
  if (std::memcmp(&a, &b, sizeof(T)) == 0) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << a_text << " is " << a << ", " << b_text << " is " << b;
}
#define EXPECT_SAME_BITS(a, b) EXPECT_PRED_FORMAT2(SameBits, a, b)

void ExpectPlainPixel(const Case& scene, int pixel, const TileGuides& guides, const TilePoints* points) {
  SCOPED_TRACE("pixel " + std::to_string(pixel));
  if (!scene.hits.Met(pixel)) {
    EXPECT_EQ(guides.depth[pixel], kInfinity);
    for (const auto* plane :
         {&guides.object, &guides.material, &guides.normal[0], &guides.normal[1], &guides.normal[2]})
      EXPECT_SAME_BITS((*plane)[pixel], 0.0f);
    return;
  }
  const PlacedObject& object = scene.objects[scene.hits.object[pixel]];
  const SurfacePoint plain = FindSurfacePoint(object, scene.hits.primitive[pixel], scene.RayOf(pixel));
  EXPECT_SAME_BITS(guides.depth[pixel], float(std::max(-plain.position.z, 0.0)));
  EXPECT_EQ(guides.object[pixel], float(object.object_id));
  EXPECT_EQ(guides.material[pixel], float(object.material_id));
  for (int i = 0; i < 3; ++i) EXPECT_SAME_BITS(guides.normal[i][pixel], float(plain.normal[i]));
  if (!points) return;
  const SurfacePoint found = points->At(pixel);
  for (int i = 0; i < 3; ++i) {
    EXPECT_SAME_BITS(found.position[i], plain.position[i]);
    EXPECT_SAME_BITS(found.normal[i], plain.normal[i]);
    EXPECT_SAME_BITS(found.facing[i], plain.facing[i]);
    EXPECT_SAME_BITS(RestPosition(object, scene.hits.primitive[pixel], found.barycentric)[i], plain.rest_position[i]);
  }
  for (int i = 0; i < 2; ++i) EXPECT_SAME_BITS(found.barycentric[i], plain.barycentric[i]);
  EXPECT_SAME_BITS(found.largest_coordinate, plain.largest_coordinate);
}

// Where normals are bent, the pixels that the vector code does are those without a bend, and it does most of these.
void ExpectBentLeftOver(const Case& scene) {
  const std::vector<ObjectRecord> records = MakeObjectRecords(scene.objects);
  TriangleCache triangles(scene.objects, records, false);
  TileGuides guides, unbent;
  FindTileSurface(scene.hits, scene.rays, triangles, false, unbent, nullptr);
  FindTileSurface(scene.hits, scene.rays, triangles, true, guides, nullptr);
  std::vector<bool> plain(kTilePixels);
  for (int i = 0; i < guides.left_over_count; ++i) plain[guides.left_over[i]] = true;
  int bent = 0;
  for (int pixel = 0; pixel < kTilePixels; ++pixel) {
    if (!scene.hits.Met(pixel)) continue;
    const PlacedObject& object = scene.objects[scene.hits.object[pixel]];
    const SurfacePoint raw = FindSurfacePoint(object, scene.hits.primitive[pixel], scene.RayOf(pixel));
    SurfacePoint point = raw;
    BendShadingNormal(object, scene.RayOf(pixel), point);
    bent += point.normal != raw.normal;
    if (plain[pixel]) continue;
    for (int i = 0; i < 3; ++i) EXPECT_SAME_BITS(guides.normal[i][pixel], float(point.normal[i])) << pixel;
  }
  EXPECT_LE(guides.left_over_count, unbent.left_over_count + bent + kTilePixels / 20);
}

// Returns how many pixels were left to the plain code.
int ExpectPlain(const Case& scene) {
  const std::vector<ObjectRecord> records = MakeObjectRecords(scene.objects);
  int left_over = 0;
  for (const bool with_points : {false, true}) {
    TriangleCache triangles(scene.objects, records, with_points);
    TileGuides guides;
    TilePoints points;
    FindTileSurface(scene.hits, scene.rays, triangles, false, guides, with_points ? &points : nullptr);
    std::vector<bool> plain(kTilePixels);
    for (int i = 0; i < guides.left_over_count; ++i) {
      EXPECT_TRUE(scene.hits.Met(guides.left_over[i]));
      plain[guides.left_over[i]] = true;
    }
    for (int pixel = 0; pixel < kTilePixels; ++pixel) {
      if (!plain[pixel]) ExpectPlainPixel(scene, pixel, guides, with_points ? &points : nullptr);
    }
    left_over = guides.left_over_count;
  }
  ExpectBentLeftOver(scene);
  return left_over;
}

bool Crosses(const ViewRay& ray, const Triangle& triangle) {
  int left = 0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 from = triangle.corner[i] - ray.origin, to = triangle.corner[(i + 1) % 3] - ray.origin;
    left += glm::dot(ray.direction, glm::cross(from, to)) > 0.0;
  }
  return left == 0 || left == 3;
}

// Pixels whose ray does not cross its given hit.
int CountMisses(const Case& scene) {
  int count = 0;
  for (int pixel = 0; pixel < kTilePixels; ++pixel) {
    if (!scene.hits.Met(pixel)) continue;
    const PlacedObject& object = scene.objects[scene.hits.object[pixel]];
    count += !Crosses(scene.RayOf(pixel), ViewTriangle(object, scene.hits.primitive[pixel]));
  }
  return count;
}

template <class Test>
void OnEveryInstructionSet(const Test& test) {
  int tried = 0;
  for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
    const std::int64_t target = targets & -targets;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    test();
    hwy::SetSupportedTargetsForTest(0);
    ++tried;
  }
  EXPECT_GT(tried, 1);
}

Mesh RandomTriangles(std::mt19937& random, int count) {
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  const auto vector = [&] { return glm::vec3(place(random), place(random), place(random)); };
  Mesh mesh;
  for (int i = 0; i < 3 * count; ++i) {
    mesh.positions.push_back(vector());
    mesh.normals.push_back(glm::normalize(vector()));
  }
  for (unsigned i = 0; i < unsigned(count); ++i) mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  return mesh;
}

// Runs of one triangle, as in pictures, of `longest` pixels at most. The first pixel's ray crosses it, if such a one is
// soon found; the others' may not.
void RandomHits(std::mt19937& random, int longest, double empty, Case& scene) {
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  for (int pixel = 0; pixel < kTilePixels;) {
    const int end = std::min(kTilePixels, pixel + 1 + int(chance(random) * longest));
    const auto object = std::uint32_t(chance(random) * double(scene.objects.size()));
    const std::size_t count = scene.objects[object].mesh ? scene.objects[object].mesh->triangles.size() : 1;
    const bool is_mesh = scene.objects[object].mesh;
    auto primitive = std::uint32_t(chance(random) * double(count));
    for (int tries = 0; is_mesh && tries < 100; ++tries) {
      if (Crosses(scene.RayOf(pixel), ViewTriangle(scene.objects[object], primitive))) break;
      primitive = std::uint32_t(chance(random) * double(count));
    }
    const bool met = chance(random) >= empty;
    for (; pixel < end; ++pixel) {
      scene.hits.object[pixel] = met ? object : TileHits::kNothing;
      scene.hits.primitive[pixel] = primitive;
    }
  }
}

Case RandomCase(unsigned seed, bool orthographic, int longest, double empty) {
  std::mt19937 random(seed);
  Case scene;
  scene.meshes = {RandomTriangles(random, 700), RandomTriangles(random, 3), BallMesh(8)};
  scene.Look(orthographic ? FlatCamera(0.0, 2.0) : FrontCamera(0.0, 60.0));
  const glm::dmat4 turned = glm::rotate(Moved(0.3, -0.2, -3.0), 0.7, glm::dvec3(0.3, 0.8, -0.5));
  scene.PlaceAt({turned, glm::scale(turned, glm::dvec3(-1.5, 0.4, 1.0)), glm::scale(turned, glm::dvec3(1.1)),
                 Moved(0.0, 0.0, -2.0), glm::scale(turned, glm::dvec3(1e-3, -1e3, 1.0))});
  RandomHits(random, longest, empty, scene);
  return scene;
}

TEST(TileSurface, RandomTrianglesGiveThePlainBitsOnEveryInstructionSet) {
  OnEveryInstructionSet([] {
    int crossed = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
      for (const int longest : {1, 6, 300}) {
        const Case scene = RandomCase(seed, seed % 2 == 1, longest, seed % 3 == 0 ? 0.0 : 0.4);
        // Normals that have cancelled out are the plain code's as well, but they are few.
        const int misses = CountMisses(scene);
        EXPECT_LT(ExpectPlain(scene), kTilePixels / 16 + misses);
        if (::testing::Test::HasFailure()) return;
        for (int pixel = 0; pixel < kTilePixels; ++pixel) crossed += scene.hits.Met(pixel);
        crossed -= misses;
      }
    }
    EXPECT_GT(crossed, 12 * 3 * kTilePixels / 8);  // so the vectors had something to do
  });
}

TEST(TileSurface, EmptyFullAndSinglePixels) {
  OnEveryInstructionSet([] {
    for (int only = -1; only < kTilePixels; ++only) {
      Case scene = RandomCase(5, false, 4, only < 0 ? 1.0 : 0.0);
      for (int pixel = 0; only >= 0 && pixel < kTilePixels; ++pixel) {
        if (pixel != only) scene.hits.object[pixel] = TileHits::kNothing;
      }
      ExpectPlain(scene);
      if (::testing::Test::HasFailure()) return;
    }
  });
}

// NaN, zero and cancelling normals, triangles without area and edge on, huge and tiny ones, corners at the eye: pixels
// not left to the plain code have its bits.
TEST(TileSurface, WildGeometry) {
  OnEveryInstructionSet([] {
    Case scene = RandomCase(9, false, 3, 0.1);
    Mesh& mesh = scene.meshes[0];
    const std::vector<glm::vec3> wild_normals = {
        {kNan, 0, 1}, {0, 0, 0}, {1e-30f, 0, 0}, {kInfinity, 0, 0}, {-0.0f, 1, -0.0f}};
    for (std::size_t i = 0; i < mesh.normals.size(); i += 4)
      mesh.normals[i] = wild_normals[i / 4 % wild_normals.size()];
    for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 15) {
      mesh.positions[i + 1] = mesh.positions[i];
      if (i % 2 == 0) mesh.positions[i + 2] = mesh.positions[i] * 1.0000001f;
    }
    for (std::size_t i = 5; i < mesh.positions.size(); i += 21) mesh.positions[i] *= i % 2 ? 1e30f : 1e-30f;
    const int left_over = ExpectPlain(scene);
    EXPECT_GT(left_over, 0);
    EXPECT_LT(left_over, kTilePixels);
  });
}

TEST(TileSurface, SpheresAndMeshesWithoutNormalsAreLeftOver) {
  Case scene = RandomCase(3, false, 5, 0.0);
  scene.objects[0].mesh = nullptr;
  scene.meshes[1].normals.clear();
  for (std::uint32_t& primitive : scene.hits.primitive) primitive = 0;
  int theirs = 0;
  for (const std::uint32_t object : scene.hits.object) theirs += object == 0 || object == 1 || object == 4;
  EXPECT_GE(ExpectPlain(scene), theirs);
  EXPECT_GT(theirs, 0);
}

TEST(TileSurface, TheCacheForgetsWithoutHarm) {
  const Case scene = RandomCase(1, false, 1, 0.0);
  const std::vector<ObjectRecord> records = MakeObjectRecords(scene.objects);
  TriangleCache used(scene.objects, records, false);
  for (std::uint32_t i = 0; i < 5000; ++i) {
    if (i % TriangleCache::kMost == 0) used.Begin();
    const std::uint32_t primitive = i * 7919u % 700u;
    const TriangleRecord& record = used.Find(0, primitive);
    const Triangle triangle = ViewTriangle(scene.objects[0], primitive);
    for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(record.corner[axis], triangle.corner[0][axis]);
  }
}

// Triangles that share one place in the cache, as many as may be requested at once.
TEST(TileSurface, TheCacheKeepsWhatWasFoundSinceItBegan) {
  const Case scene = RandomCase(2, false, 1, 0.0);
  const std::vector<ObjectRecord> records = MakeObjectRecords(scene.objects);
  TriangleCache cache(scene.objects, records, false);
  for (int round = 0; round < 3; ++round) {
    cache.Begin();
    std::vector<std::pair<std::uint32_t, const TriangleRecord*>> found;
    for (std::uint32_t i = 0; i < TriangleCache::kMost; ++i) {
      const std::uint32_t primitive = i % 2 ? 512u + i / 2 : i / 2;
      found.push_back({primitive, &cache.Find(0, primitive)});
    }
    for (const auto& [primitive, record] : found) {
      EXPECT_EQ(record, &cache.Find(0, primitive));
      const Triangle triangle = ViewTriangle(scene.objects[0], primitive);
      for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(record->corner[axis], triangle.corner[0][axis]) << primitive;
    }
  }
}

TEST(TileSurface, PixelsOfATileAreItsSquaresInOrder) {
  std::vector<int> met(kTilePixels, 0);
  for (int row = 0; row < kTileSide; ++row) {
    for (int column = 0; column < kTileSide; ++column) {
      const int pixel = TilePixel(column, row);
      ++met[pixel];
      EXPECT_EQ(TileColumn(pixel), column);
      EXPECT_EQ(TileRow(pixel), row);
    }
  }
  for (const int count : met) EXPECT_EQ(count, 1);
}

// Every width and place of tiles, one to all of a strip, and rows that begin on a line of the cache and elsewhere.
TEST(TileStore, WritesTheTilesAndNothingElse) {
  std::array<std::array<float, kTilePixels>, kStripTiles> values;
  for (int i = 0; i < kStripTiles * kTilePixels; ++i) values[i / kTilePixels][i % kTilePixels] = float(i + 1);
  OnEveryInstructionSet([&] {
    for (const std::size_t stride : {std::size_t(80), std::size_t(91), std::size_t(128)}) {
      for (const Tile first : {Tile{16, 16, 16, 16}, Tile{16, 0, 16, 5}, Tile{32, 16, 5, 16}, Tile{0, 32, 1, 1}}) {
        for (int count = 1; count <= (first.width < kTileSide || first.x0 > 16 ? 1 : kStripTiles); ++count) {
          for (const bool past_caches : {false, true}) {
            // The last of several is narrow.
            std::vector<Tile> tiles;
            std::vector<const float*> each;
            for (int i = 0; i < count; ++i) {
              tiles.push_back({first.x0 + i * kTileSide, first.y0, first.width, first.height});
              each.push_back(values[i].data());
            }
            if (count > 1) tiles.back().width = 7;
            std::vector<float, PlaneAllocator<float>> plane(stride * 64, -1.0f);
            StoreTiles(tiles, each, plane.data(), stride, past_caches);
            PublishTiles();
            for (int y = 0; y < 64; ++y) {
              for (int x = 0; x < int(stride); ++x) {
                float expected = -1.0f;
                for (int i = 0; i < count; ++i) {
                  const int column = x - tiles[i].x0, row = y - tiles[i].y0;
                  const bool inside = column >= 0 && column < tiles[i].width && row >= 0 && row < tiles[i].height;
                  if (inside) expected = values[i][TilePixel(column, row)];
                }
                ASSERT_EQ(plane[std::size_t(y) * stride + std::size_t(x)], expected) << x << ", " << y;
              }
            }
          }
        }
      }
    }
  });
}

TEST(PlaneAllocator, LargePlanesKeepTheirMemoryAndNoneIsSharedWhileInUse) {
  const std::size_t bytes = std::size_t(5) << 20;
  void* const first = AllocatePlane(bytes);
  void* const second = AllocatePlane(bytes);
  EXPECT_NE(first, second);
  FreePlane(first, bytes);
  void* const other = AllocatePlane(bytes + 64);
  EXPECT_NE(other, first);
  EXPECT_EQ(AllocatePlane(bytes), first);
  for (void* const memory : {first, second}) FreePlane(memory, bytes);
  FreePlane(other, bytes + 64);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(first) % 64, 0u);
  std::vector<float, PlaneAllocator<float>> filled(1 << 20, 2.0f);
  for (const float value : filled) ASSERT_EQ(value, 2.0f);
}

}  // namespace
}  // namespace scumble::testing
