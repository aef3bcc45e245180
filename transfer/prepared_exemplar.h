// A prepared exemplar: resized, its paint extended past the rim, with the guides of the painted object and the search
// for the nearest of them.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/image/check.h"
#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/image/style.h"
#include "scumble/picture.h"
#include "transfer/source.h"
#include "transfer/table_cache.h"

namespace scumble {

class SourceVariation;
class ExemplarSearch;

// An exemplar's guides by rows, for code that reads sixteen pixels at once. kPad values before the first and after the
// last of each array may be read too; they are undefined. Valid as long as the exemplar.
struct ExemplarRows {
  static constexpr int kPad = 16;
  int width = 0, height = 0;
  bool is_sphere = false;
  // Spheres: pixel index → [-1, 1], as x of the normal and as -y; and a row's first and last usable pixel (first >
  // last: there is none).
  const float* coordinate = nullptr;
  const std::int16_t* first = nullptr;
  const std::int16_t* last = nullptr;
  // Scenes: planes of width × height.
  const float* normal[3] = {};
  const std::uint8_t* usable = nullptr;
};

// Either the sphere that fills the N × N picture (centre N/2, radius N/2), whose positions inside radius 1 - rim are
// usable. Or any scene with its own guides, in a picture of any shape, whose usable part is the guides' coverage less
// the rim. All other positions are never shown. Immutable once made; concurrent reads are safe.
class PreparedExemplar {
 public:
  // A sphere. One picture or several, the same sphere under different light; all are resized to N = `size`, 1 … 32767.
  // `rim` is in pixels of each picture; all must be square. The rim of a sphere that is cut out of its picture is at
  // least as wide as its SoftEdge. Paint is extended outward from the rim before resizing, so that no colour from
  // outside the painted disc reaches a usable texel.
  PreparedExemplar(std::span<const Picture* const> pictures, double rim, int size);
  PreparedExemplar(const Picture& picture, double rim, int size)
      : PreparedExemplar(std::vector<const Picture*>{&picture}, rim, size) {}

  // A painted scene: pictures of the size of its guides, resized to width × height, 1 … 32767 each. Guides are sampled
  // at pixel centres, never averaged. The guides must pass Validate. SearchBy must be called before NearestNeighbour.
  // Fails if no pixel is usable; `name` is the exemplar's in that message.
  static Expected<PreparedExemplar> OfScene(std::span<const Picture* const> pictures, const GuideSet& guides,
                                            double rim, int width, int height, const std::string& name);

  // This exemplar with other pictures of its size and count.
  PreparedExemplar WithPictures(std::vector<Picture> pictures) const;

  // The search of NearestNeighbour from now on; call it before the exemplar is shared. kAuto is the formula for a
  // sphere and a table for a scene. kAnalytic is a kUsage error for a scene. Tables have `resolution`² cells and are
  // searched for in `cache` first, which may be null. Sources of a tree may be (1 + error) times as far as the nearest.
  // O(usable pixels · log) if something is built.
  Status SearchBy(NearestSearch search, int resolution, TableCache* cache, double error = 0.0);

  bool is_sphere() const { return !scene_; }
  int width() const { return scene_ ? scene_->width : size_; }
  int height() const { return scene_ ? scene_->height : size_; }
  int size() const { return size_; }  // the longer side
  std::int64_t usable_limit() const {
    return limit_;
  }  // of a sphere: squared radius of the usable disc, in half pixels
  int count() const { return static_cast<int>(pictures_.size()); }
  const Picture& picture(int index = 0) const { return pictures_[std::size_t(index)]; }

  bool Usable(int x, int y) const {
    if (scene_) return scene_->Usable(x, y);
    if (static_cast<unsigned>(x) >= static_cast<unsigned>(size_)) return false;
    if (static_cast<unsigned>(y) >= static_cast<unsigned>(size_)) return false;
    const std::int64_t dx = 2 * x + 1 - size_, dy = 2 * y + 1 - size_;
    return dx * dx + dy * dy <= limit_;
  }

  // The view-space normal at the centre of a usable pixel.
  glm::vec3 Normal(int x, int y) const {
    if (scene_) return scene_->Normal(x, y);
    const float nx = Coordinate(x), ny = -Coordinate(y);
    return {nx, ny, std::sqrt(std::fmax(0.0f, 1.0f - nx * nx - ny * ny))};
  }

  // The nearest neighbour u* = argmin ‖normal - Normal(u)‖ over usable pixels, by the search that was chosen:
  // - analytic: within one pixel of the exact one; ties to the lowest (y, x). A normal beyond the rim, or with z < 0,
  //   takes the usable pixel nearest to the point of the rim along its (x, y), and (0, 0, -1) that at +Y. (The exact
  //   argmin would jump along the rim's pixel steps there, by many at once, for no visible gain.)
  // - tree: exact for FacingDirection(normal), unless an error was allowed; ties to the lowest (y, x).
  // - table: at most LookUpTable::Quantisation farther away than the tree's.
  // Any finite or NaN input gives a usable pixel.
  Source NearestNeighbour(glm::vec3 normal) const { return search_ ? Searched(normal) : Analytic(normal); }

  // The place of a normal on the sphere, x and y of the unit disc, y up, before the analytic search rounds it to
  // pixels: never beyond the usable disc. For spheres only.
  glm::vec2 OnDisc(glm::vec3 normal) const {
    SCUMBLE_DCHECK(is_sphere());
    float nx = normal.x, ny = normal.y;
    float length = std::sqrt(nx * nx + ny * ny);
    if (!(length <= 3.0e38f)) nx = 0.0f, ny = 0.0f, length = 0.0f;  // NaN and infinity take the centre
    if (normal.z < 0.0f && !(length > 0.0f)) nx = 0.0f, ny = 1.0f, length = 1.0f;
    if (length > usable_radius_ || normal.z < 0.0f) {
      nx = nx / length * usable_radius_;
      ny = ny / length * usable_radius_;
    }
    return {nx, ny};
  }

  // The normal that is compared with those of the exemplar. A sphere shows none beyond its usable rim, and none that
  // points away from the eye: that of the rim which is nearest stands for these, or no source would be within the
  // threshold of a surface seen almost edge-on. Scenes: the normal as it is.
  glm::vec3 WithinRim(glm::vec3 normal) const {
    if (scene_ || (!(normal.x * normal.x + normal.y * normal.y > squared_rim()) && !(normal.z < 0.0f))) return normal;
    const glm::vec2 at = OnDisc(normal);
    return {at.x, at.y, std::sqrt(std::fmax(0.0f, 1.0f - at.x * at.x - at.y * at.y))};
  }
  // Of a sphere of radius 1: x² + y² of the normals at its usable rim.
  float squared_rim() const { return usable_radius_ * usable_radius_; }

  // Other sources for a normal; computed by the first call, on whichever thread.
  const SourceVariation& source_variation() const;

  ExemplarRows Rows() const;

  // The usable pixels in row order.
  std::vector<Source> UsablePixels() const;

 private:
  struct Scene {
    int width = 0, height = 0;
    // Planes with ExemplarRows::kPad values on either side.
    std::vector<float> normal[3];
    std::vector<std::uint8_t> usable;
    std::size_t Index(int x, int y) const { return std::size_t(y) * width + x + ExemplarRows::kPad; }
    bool Usable(int x, int y) const {
      if (static_cast<unsigned>(x) >= static_cast<unsigned>(width)) return false;
      if (static_cast<unsigned>(y) >= static_cast<unsigned>(height)) return false;
      return usable[Index(x, y)] != 0;
    }
    glm::vec3 Normal(int x, int y) const {
      const std::size_t i = Index(x, y);
      return {normal[0][i], normal[1][i], normal[2][i]};
    }
  };

  struct LazySourceVariation;

  PreparedExemplar();
  float Coordinate(int index) const { return coordinate_[std::size_t(index) + ExemplarRows::kPad]; }
  Source Analytic(glm::vec3 normal) const;
  Source Searched(glm::vec3 normal) const;
  // The usable pixel nearest to (nx, ny) of the unit disc, near pixel (x, y).
  Source NearestUsable(float nx, float ny, int x, int y) const;
  std::string TableKey(std::span<const Source> sources, int resolution) const;

  int size_ = 0;
  std::int64_t limit_ = 0;                                // squared usable radius in half pixels
  float usable_radius_ = 0;                               // the same as a fraction of the sphere's
  std::vector<float> coordinate_;                         // pixel index → [-1, 1], padded
  std::vector<std::int16_t> first_usable_, last_usable_;  // by row, of a sphere
  std::vector<Picture> pictures_;
  std::shared_ptr<const Scene> scene_;            // null: the sphere
  std::shared_ptr<const ExemplarSearch> search_;  // null: analytic
  std::shared_ptr<LazySourceVariation> source_variation_;
};

// N for a picture of `size` pixels at `scale`, for an output of `output_height` pixels; `reference_height` 0 means that
// the height does not matter. At least 1.
int ScaledSize(int size, double scale, int reference_height, int output_height);

}  // namespace scumble
