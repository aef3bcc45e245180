#include "guidegen/load/loader_util.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

#include "core/io/atomic_file.h"

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

// The remaining polygon while its ears are cut off.
class Ears {
 public:
  explicit Ears(std::span<const glm::vec3> corners)
      : points_(Project(corners)), cleared_(points_.size(), 0), gone_(points_.size(), false), ring_(points_.size()) {
    for (std::size_t i = 0; i < ring_.size(); ++i) ring_[i] = static_cast<unsigned>(i);
  }

  const std::vector<unsigned>& ring() const { return ring_; }
  std::uint64_t looks() const { return looks_; }

  glm::uvec3 Triangle(std::size_t at) const {
    const std::size_t n = ring_.size();
    return {ring_[(at + n - 1) % n], ring_[at], ring_[(at + 1) % n]};
  }

  // Whether no remaining corner lies in the triangle. If asked again for one triangle, it continues with the corner
  // that was inside: those before it are outside for good. So all calls together visit at most three triangles a
  // corner.
  bool IsEar(std::size_t at) {
    const glm::uvec3 triangle = Triangle(at);
    const glm::dvec2 &a = points_[triangle.x], &b = points_[triangle.y], &c = points_[triangle.z];
    if (Cross(a, b, c) <= 0.0) return false;
    for (unsigned& i = cleared_[triangle.y]; i < points_.size(); ++i) {
      ++looks_;
      if (gone_[i] || i == triangle.x || i == triangle.y || i == triangle.z) continue;
      const glm::dvec2& p = points_[i];
      if (p == a || p == b || p == c) continue;
      if (InTriangle(p, a, b, c)) return false;
    }
    return true;
  }

  void Cut(std::size_t at) {
    const glm::uvec3 triangle = Triangle(at);
    gone_[triangle.y] = true;
    cleared_[triangle.x] = cleared_[triangle.z] = 0;
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(at));
  }

 private:
  const std::vector<glm::dvec2> points_;
  std::vector<unsigned> cleared_;  // of the triangle at each corner, how many points are known to be outside it
  std::vector<bool> gone_;
  std::vector<unsigned> ring_;
  std::uint64_t looks_ = 0;
};

bool IsPlain(const Material& material) {
  return material.base_color == glm::vec4(1.0f) && material.base_color_texture.texture < 0 &&
         material.normal_texture.texture < 0 && material.double_sided;
}

// The first of "default", "default#2", … that no material has, or that a plain one has: `found` is then its index.
std::string DefaultName(const Scene& scene, int& found) {
  std::map<std::string_view, int> named;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const std::string& name = scene.materials[i].name;
    if (name.rfind("default", 0) == 0) named.try_emplace(name, static_cast<int>(i));
  }
  std::string name = "default";
  for (int number = 2;; ++number) {
    const auto taken = named.find(name);
    found = taken == named.end() ? -1 : taken->second;
    if (found < 0 || IsPlain(scene.materials[std::size_t(found)])) return name;
    name = "default#" + std::to_string(number);
  }
}

// As iconv calls it, by the byte order mark or, without one, by the zeros beside plain letters; empty for anything
// else. UTF-16 and UTF-32 mean that a mark follows.
std::optional<std::string> WideEncodingOf(std::span<const unsigned char> begin) {
  const auto matches = [&](std::string_view pattern) {  // '0': a zero, 'x': any other byte, else the byte itself
    if (begin.size() < pattern.size()) return false;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
      const char p = pattern[i];
      const bool fits = p == '0' ? begin[i] == 0 : p == 'x' ? begin[i] != 0 : begin[i] == static_cast<unsigned char>(p);
      if (!fits) return false;
    }
    return true;
  };
  if (matches("\xFF\xFE"
              "00") ||
      matches("00\xFE\xFF"))
    return "UTF-32";
  if (matches("\xFF\xFE") || matches("\xFE\xFF")) return "UTF-16";
  if (matches("x000x000")) return "UTF-32LE";
  if (matches("000x000x")) return "UTF-32BE";
  if (matches("x0x0")) return "UTF-16LE";
  if (matches("0x0x")) return "UTF-16BE";
  return std::nullopt;
}

}  // namespace

Expected<std::vector<std::byte>> ReadRegularFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return InputError("cannot read " + path.string() + ": it is no regular file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return ReadWholeFile(path, 0);  // reports the reason
  constexpr std::uintmax_t kMostBytes = std::uintmax_t(8) << 30;
  if (size > kMostBytes) return InputError(path.string() + " is larger than " + std::to_string(kMostBytes) + " bytes");
  return ReadWholeFile(path, size, ", which is what the system says it has: copy it to a plain file once it is whole");
}

std::span<const unsigned char> AsChars(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
}

std::string AsText(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Status CheckTextEncoding(const std::string& file, std::span<const std::byte> bytes) {
  const std::optional<std::string> encoding =
      WideEncodingOf(AsChars(bytes.first(std::min<std::size_t>(bytes.size(), 8))));
  if (!encoding) return Ok();
  return InputError(file + " is text in " + *encoding + "; expected UTF-8: save it so, for example with iconv -f " +
                    *encoding + " -t UTF-8");
}

std::string AsTextWithoutMark(std::span<const std::byte> bytes) {
  const std::string text = AsText(bytes);
  return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
}

Error NoTrianglesError(const std::string& file, std::uint64_t points, const std::string& others) {
  return InputError(file + " has " + std::to_string(points) + (points == 1 ? " point" : " points") + others +
                    " and no triangles; expected a mesh, because points and lines are not drawn: make a surface of "
                    "them, for example in MeshLab or Blender");
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

std::vector<bool> UsedMaterials(const Scene& scene) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const Mesh& mesh : scene.meshes) used[std::size_t(mesh.material)] = true;
  return used;
}

void WarnOfCutAlpha(const Material& material, const std::string& where, WarningCounter& warnings) {
  const float alpha = material.base_color.a;
  if (material.alpha_mode != AlphaMode::kBlend || alpha <= 0.0f || alpha >= 1.0f) return;
  if (alpha < kBlendCutoff) {
    warnings.Add(
        "surfaces with an alpha below one half are left out: guides are never partly transparent; give them 0.5 or "
        "more",
        where);
  } else {
    warnings.Add("partly transparent surfaces are solid where their alpha is one half or more", where);
  }
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
  return is_first ? Ok() : Take(file, mesh.positions.size(), mesh.triangles.size() + mesh.curves.segments.size());
}

std::uint64_t TriangulatePolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles) {
  if (corners.size() <= 3 || corners.size() > kMaxEarCorners) {
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.emplace_back(0, i, i + 1);
    return 0;
  }
  Ears ears(corners);
  const std::vector<unsigned>& ring = ears.ring();
  // Starting after the last ear spreads the cuts, and makes a convex polygon's triangles less thin.
  std::size_t at = 1, misses = 0;
  while (ring.size() > 3 && misses < ring.size()) {
    at %= ring.size();
    if (!ears.IsEar(at)) {
      ++at;
      ++misses;
      continue;
    }
    triangles.push_back(ears.Triangle(at));
    ears.Cut(at);
    ++at;
    misses = 0;
  }
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) triangles.emplace_back(ring[0], ring[i], ring[i + 1]);
  return ears.looks();
}

glm::dvec3 OriginOf(const PlaceBox& box) {
  if (box.low.x > box.high.x) return glm::dvec3(0.0);
  const glm::dvec3 size = box.high - box.low;
  constexpr double kFar = 16.0;
  const glm::dvec3 middle = glm::round(0.5 * box.low + 0.5 * box.high);
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

int FindDefaultMaterial(const Scene& scene) {
  if (!scene.materials.empty()) {
    const Material& last = scene.materials.back();
    const bool named = last.name == "default" || last.name.rfind("default#", 0) == 0;
    if (named && IsPlain(last)) return static_cast<int>(scene.materials.size()) - 1;
  }
  int found = -1;
  DefaultName(scene, found);
  return found;
}

int DefaultMaterial(Scene& scene) {
  int found = FindDefaultMaterial(scene);
  if (found >= 0) return found;
  Material material;
  material.name = DefaultName(scene, found);
  scene.materials.push_back(std::move(material));
  return static_cast<int>(scene.materials.size()) - 1;
}

}  // namespace scumble
