// Helpers of the scene loaders: reading files, unique names, counted warnings, limits, polygons.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/image/status.h"
#include "guidegen/scene.h"

namespace scumble {

// Reads a file of a scene completely. Only regular files are read, and at most as many bytes as the system reports. A
// scene is untrusted data: it may name a pipe or a device that never ends, or one of the system's files under /proc,
// which report size 0 and need not end either.
Expected<std::vector<std::byte>> ReadRegularFile(const std::filesystem::path& path);

std::span<const unsigned char> AsChars(std::span<const std::byte> bytes);
std::string AsText(std::span<const std::byte> bytes);

// Fails for text in UTF-16 or UTF-32, with a byte order mark or without, and names the encoding: a reader of bytes
// finds nothing in it, or an error that misleads. Only for formats that are text.
Status CheckTextEncoding(const std::string& file, std::span<const std::byte> bytes);
// AsText without the byte order mark of UTF-8.
std::string AsTextWithoutMark(std::span<const std::byte> bytes);

// The error for a scene of points or lines alone, whose picture would be empty. `others`: what else it has, as
// ", lines".
Error NoTrianglesError(const std::string& file, std::uint64_t points, const std::string& others);

// Makes names unique: the wanted one, or with "#2", "#3", … appended.
class UniqueNames {
 public:
  std::string Take(const std::string& wanted);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_number_;
};

// Collects warnings of one kind into one line, so that a file with a thousand flaws prints few lines.
class WarningCounter {
 public:
  // `kind` is the sentence, `where` the place of this occurrence.
  void Add(const std::string& kind, const std::string& where);
  // One line a kind, in the order of their first occurrence.
  void MoveTo(std::vector<std::string>& lines);

 private:
  struct Entry {
    std::string kind;
    std::string first;
    std::size_t count = 0;
  };
  std::vector<Entry> entries_;
};

// Limits geometry, because a file of a few bytes can ask for any amount of it: refuses before anything is allocated.
// Geometry that is shown more than once counts each time, because the ray caster holds each instance's triangles.
// glTF's geometry without data has a lower limit besides: ZeroBudget of guidegen/load/gltf/accessor.h.
class GeometryBudget {
 public:
  static constexpr std::uint64_t kMaxTriangles = 500'000'000;
  static constexpr std::uint64_t kMaxVertices = 500'000'000;
  static constexpr std::uint64_t kMaxInstances = 1'000'000;

  Status Take(const std::string& file, std::uint64_t vertices, std::uint64_t triangles);
  // Takes one more instance of a mesh. The first one's triangles were taken when the mesh was loaded.
  Status TakeInstance(const std::string& file, const Mesh& mesh, bool is_first);

 private:
  struct Account {
    const char* what;
    std::uint64_t limit;
    std::uint64_t taken = 0;
  };
  static Status TakeFrom(Account& account, const std::string& file, std::uint64_t more);

  Account vertices_{"vertices", kMaxVertices};
  Account triangles_{"triangles", kMaxTriangles};
  Account instances_{"instances", kMaxInstances};
};

// Cuts a simple polygon into corners - 2 triangles of corner numbers, winding kept: ear clipping in the plane of its
// Newell normal. Where there is no proper ear (self-intersecting, collinear or overly long polygons), the remaining
// corners become a fan. Fewer than three corners give nothing. Returns the number of tests of a corner in a triangle:
// at most 4 times the square of the corners, for any shape.
std::uint64_t TriangulatePolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles);

// A bounding box of places; empty at first.
struct PlaceBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};

  void Add(const glm::dvec3& place) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
};

// The origin of positions in the box, so that floats can hold them. If the box is so far from 0 that floats would lose
// four bits or more of the shape, its middle, in whole metres; else 0. The box is that of the vertices in faces: files
// list unused vertices, often at 0.
glm::dvec3 OriginOf(const PlaceBox& box);

bool IsFinite(const glm::vec2& v);
bool IsFinite(const glm::vec3& v);
bool IsFinite(const glm::vec4& v);

// At most `max_bytes` of a file's text, on one line, for use inside a message.
std::string Excerpt(const std::string& text, std::size_t max_bytes = 200);

// Of each material, whether one of the scene's meshes has it.
std::vector<bool> UsedMaterials(const Scene& scene);

// Warns if the base colour's alpha makes the surface partly transparent, which is cut at kBlendCutoff. Alpha 0 hides it
// on purpose. `where`: the material, for the message.
void WarnOfCutAlpha(const Material& material, const std::string& where, WarningCounter& warnings);

// The colour of surfaces without one: Blender's own for faces without a material.
inline constexpr glm::vec4 kPlainColor{0.8f, 0.8f, 0.8f, 1.0f};

// The index of an opaque white material named "default", or "default#2", … where other materials have the earlier
// names; -1 where there is none. The last material is checked first, whatever its number: a default that was made is
// there, and is found at once.
int FindDefaultMaterial(const Scene& scene);
// FindDefaultMaterial, or a new material at the end of the list.
int DefaultMaterial(Scene& scene);

}  // namespace scumble
