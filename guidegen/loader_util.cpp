#include "guidegen/loader_util.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include "io/atomic_file.h"

namespace scumble {
namespace {

// Ear clipping is quadratic; a polygon with more corners than this is cut as a fan.
constexpr std::size_t kMaxEarCorners = 2000;

double Cross(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool InTriangle(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return Cross(a, b, p) >= 0.0 && Cross(b, c, p) >= 0.0 && Cross(c, a, p) >= 0.0;
}

// Drops the axis along which the polygon's Newell normal is longest; keeps the winding counter-clockwise.
std::vector<glm::dvec2> Project(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0.0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a(corners[i]), b(corners[(i + 1) % corners.size()]);
    normal += glm::dvec3((a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y));
  }
  int axis = 2;
  if (std::abs(normal.x) > std::abs(normal.y) && std::abs(normal.x) > std::abs(normal.z)) axis = 0;
  if (axis == 2 && std::abs(normal.y) > std::abs(normal.z)) axis = 1;
  const bool flip = normal[axis] < 0.0;
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  for (const glm::vec3& corner : corners) {
    glm::dvec2 p(corner[(axis + 1) % 3], corner[(axis + 2) % 3]);
    flat.push_back(flip ? glm::dvec2(p.y, p.x) : p);
  }
  return flat;
}

bool IsEar(const std::vector<glm::dvec2>& points, const std::vector<unsigned>& ring, std::size_t at) {
  const std::size_t n = ring.size();
  const unsigned ia = ring[(at + n - 1) % n], ib = ring[at], ic = ring[(at + 1) % n];
  const glm::dvec2 &a = points[ia], &b = points[ib], &c = points[ic];
  if (Cross(a, b, c) <= 0.0) return false;
  for (unsigned i : ring) {
    if (i == ia || i == ib || i == ic) continue;
    const glm::dvec2& p = points[i];
    if (p == a || p == b || p == c) continue;
    if (InTriangle(p, a, b, c)) return false;
  }
  return true;
}

}  // namespace

Expected<std::vector<std::byte>> ReadRegularFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return InputError("cannot read " + path.string() + ": it is no regular file");
  }
  return ReadWholeFile(path);
}

std::span<const unsigned char> AsChars(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
}

std::string AsText(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string UniqueNames::Take(const std::string& wanted) {
  if (taken_.insert(wanted).second) return wanted;
  int& number = last_number_.try_emplace(wanted, 1).first->second;
  while (true) {
    std::string name = wanted + "#" + std::to_string(++number);
    if (taken_.insert(name).second) return name;
  }
}

void WarningCounter::Add(const std::string& kind, const std::string& where) {
  for (Entry& entry : entries_) {
    if (entry.kind == kind) {
      ++entry.count;
      return;
    }
  }
  entries_.push_back({kind, where, 1});
}

void WarningCounter::MoveTo(std::vector<std::string>& lines) {
  for (const Entry& entry : entries_) {
    std::string line = entry.kind;
    if (!entry.first.empty()) line += entry.count > 1 ? " (first: " + entry.first : " (" + entry.first;
    if (!entry.first.empty() && entry.count > 1) line += ", " + std::to_string(entry.count) + " in all";
    if (!entry.first.empty()) line += ")";
    lines.push_back(std::move(line));
  }
  entries_.clear();
}

Status GeometryBudget::TakeFrom(Account& account, const std::string& file, std::uint64_t more) {
  if (more <= account.limit - account.taken) {
    account.taken += more;
    return Ok();
  }
  const std::uint64_t found = more > ~account.taken ? ~std::uint64_t(0) : account.taken + more;
  return InputError(file + " has at least " + std::to_string(found) + " " + account.what +
                    ", each instance counted; expected at most " + std::to_string(account.limit) +
                    ": simplify the scene");
}

Status GeometryBudget::Take(const std::string& file, std::uint64_t vertices, std::uint64_t triangles) {
  SCUMBLE_RETURN_IF_ERROR(TakeFrom(triangles_, file, triangles));
  return TakeFrom(vertices_, file, vertices);
}

Status GeometryBudget::TakeInstance(const std::string& file, const Mesh& mesh, bool is_first) {
  SCUMBLE_RETURN_IF_ERROR(TakeFrom(instances_, file, 1));
  return is_first ? Ok() : Take(file, mesh.positions.size(), mesh.triangles.size());
}

void TriangulatePolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles) {
  if (corners.size() < 3) return;
  if (corners.size() == 3) {
    triangles.emplace_back(0, 1, 2);
    return;
  }
  std::vector<unsigned> ring(corners.size());
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = static_cast<unsigned>(i);
  if (corners.size() <= kMaxEarCorners) {
    const std::vector<glm::dvec2> points = Project(corners);
    // Starting behind the last ear spreads the cuts, and makes a convex polygon's triangles less thin.
    std::size_t at = 1, misses = 0;
    while (ring.size() > 3 && misses < ring.size()) {
      at %= ring.size();
      if (!IsEar(points, ring, at)) {
        ++at;
        ++misses;
        continue;
      }
      const std::size_t n = ring.size();
      triangles.emplace_back(ring[(at + n - 1) % n], ring[at], ring[(at + 1) % n]);
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
      ++at;
      misses = 0;
    }
  }
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) triangles.emplace_back(ring[0], ring[i], ring[i + 1]);
}

glm::dvec3 OriginOf(std::span<const glm::dvec3> places) {
  if (places.empty()) return glm::dvec3(0.0);
  glm::dvec3 low = places[0], high = places[0];
  for (const glm::dvec3& place : places) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  const glm::dvec3 size = high - low;
  constexpr double kFar = 16.0;
  const glm::dvec3 middle = glm::round(0.5 * low + 0.5 * high);
  const glm::dvec3 away = glm::abs(middle);
  const bool far = std::max({away.x, away.y, away.z}) > kFar * std::max({size.x, size.y, size.z});
  return far ? middle : glm::dvec3(0.0);
}

bool IsFinite(const glm::vec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }
bool IsFinite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool IsFinite(const glm::vec4& v) { return IsFinite(glm::vec3(v)) && std::isfinite(v.w); }

std::string Excerpt(const std::string& text, std::size_t max_bytes) {
  std::string line = text.substr(0, max_bytes);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
  return text.size() > max_bytes ? line + "…" : line;
}

int DefaultMaterial(Scene& scene) {
  std::string name = "default";
  for (int number = 2;; ++number) {
    bool taken = false;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      const Material& material = scene.materials[i];
      if (material.name != name) continue;
      const bool plain = material.base_color == glm::vec4(1.0f) && material.base_color_texture.texture < 0 &&
                         material.normal_texture.texture < 0 && material.double_sided;
      if (plain) return static_cast<int>(i);
      taken = true;
    }
    if (!taken) break;
    name = "default#" + std::to_string(number);
  }
  Material material;
  material.name = name;
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

}  // namespace scumble
