// What the scene loaders share: reading files, unique names, counted warnings, limits, polygons.
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
#include "guidegen/scene/scene.h"

namespace scumble {

// A file that a scene consists of, whole. Only regular files are read, and no more of one than the system says it has:
// a scene is other people's data, and may name a pipe or a device that never ends, or one of the system's own files
// under /proc, which say that they are empty and need not end either.
Expected<std::vector<std::byte>> ReadRegularFile(const std::filesystem::path& path);

std::span<const unsigned char> AsChars(std::span<const std::byte> bytes);
std::string AsText(std::span<const std::byte> bytes);

// Hands out names that differ from each other: the wanted one, or with "#2", "#3", … behind it.
class UniqueNames {
 public:
  std::string Take(const std::string& wanted);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_number_;
};

// Collects warnings of one kind into one line, so that a file with a thousand flaws does not drown its user.
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

// A file of a few bytes can ask for any amount of geometry; this refuses before anything is allocated. What is shown
// more than once counts each time, because the ray caster holds each instance's triangles. glTF's geometry without any
// data has a lower limit besides: ZeroBudget of guidegen/load/gltf/accessor.h.
class GeometryBudget {
 public:
  static constexpr std::uint64_t kMaxTriangles = 500'000'000;
  static constexpr std::uint64_t kMaxVertices = 500'000'000;
  static constexpr std::uint64_t kMaxInstances = 1'000'000;

  Status Take(const std::string& file, std::uint64_t vertices, std::uint64_t triangles);
  // One more instance of a mesh. The first one's triangles were taken when the mesh was loaded.
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
// Newell normal. Where there is no proper ear (self-intersecting, collinear or overly long polygons) the rest becomes a
// fan. Fewer than three corners give nothing. Returns how often it looked whether a corner lies in a triangle: no more
// than 4 times the square of the corners, whatever their shape.
std::uint64_t TriangulatePolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles);

// What encloses places; empty at first.
struct PlaceBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};

  void Add(const glm::dvec3& place) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
};

// The place that positions in the box are stored relative to, so that floats can hold them: the middle of the box, in
// whole metres, where it is so far from 0 that floats would lose four bits or more of the shape; else 0. The box is
// that of what faces use: files list vertices that none does, often at 0.
glm::dvec3 OriginOf(const PlaceBox& box);

bool IsFinite(const glm::vec2& v);
bool IsFinite(const glm::vec3& v);
bool IsFinite(const glm::vec4& v);

// At most `max_bytes` of a text that comes from a file, on one line, for use inside a message.
std::string Excerpt(const std::string& text, std::size_t max_bytes = 200);

// The colour of what no file gives a colour: Blender's own for faces without a material.
inline constexpr glm::vec4 kPlainColor{0.8f, 0.8f, 0.8f, 1.0f};

// The index of an opaque white material named "default", or "default#2", … where the names before it are others'; -1
// where there is none. The last material is looked at first, whatever its number: there one stands that was made, and
// is found again at once.
int FindDefaultMaterial(const Scene& scene);
// The same, made at the end of the list where there is none yet.
int DefaultMaterial(Scene& scene);

}  // namespace scumble
