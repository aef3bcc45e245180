#include "transfer/prepared_exemplar.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>

#include "core/filter/resample.h"
#include "core/image/check.h"
#include "core/image/hash.h"
#include "core/painting/soft_edge.h"
#include "transfer/exemplar/paint_by_normal.h"
#include "transfer/exemplar/usable_mask.h"
#include "transfer/lookup_table.h"
#include "transfer/nearest/guide_tree.h"

namespace scumble {

// A table or a tree over the normals of the usable pixels.
class ExemplarSearch {
 public:
  std::optional<LookUpTable> table;
  std::vector<Source> sources;  // of the tree's points
  std::optional<PointTree> normals;
  double error = 0.0;  // the error allowed to the tree

  Source Find(glm::vec3 direction) const {
    if (table) return table->Find(direction);
    const float query[3] = {direction.x, direction.y, direction.z};
    std::uint32_t place = 0;
    return sources[normals->Nearest(query, place, error)];
  }
};

namespace {

// The least integer not below a value of 0 or more. With the processor's oldest instructions std::ceil is a function
// call.
int RoundedUp(float value) {
  const int down = static_cast<int>(value);
  return down + (static_cast<float>(down) < value);
}

// (N · usable fraction)² in half pixels, but never without the pixels at the centre.
std::int64_t UsableLimit(int size, double fraction) {
  const double radius = size * std::max(0.0, fraction);
  return std::max<std::int64_t>(2, static_cast<std::int64_t>(std::floor(radius * radius)));
}

// Replaces everything beyond the usable disc by the nearest usable paint along the radius, so that a filter across the
// rim reads paint, and not the surroundings of the sphere.
Picture ExtendPaint(const Picture& picture, std::int64_t limit) {
  Picture extended = picture;
  const int size = picture.width;
  const double radius = std::sqrt(static_cast<double>(limit));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::int64_t dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
      if (dx * dx + dy * dy <= limit) continue;
      const double length = std::sqrt(static_cast<double>(dx * dx + dy * dy));
      // Steps inward until the pixel is usable: rounding to pixels may need one or two steps beyond the exact radius.
      for (double r = radius;; r -= 1.0) {
        const int sx =
            std::clamp(static_cast<int>(std::floor((dx / length * std::max(r, 0.0) + size) / 2)), 0, size - 1);
        const int sy =
            std::clamp(static_cast<int>(std::floor((dy / length * std::max(r, 0.0) + size) / 2)), 0, size - 1);
        const std::int64_t ex = 2 * sx + 1 - size, ey = 2 * sy + 1 - size;
        if (ex * ex + ey * ey > limit && r > 0.0) continue;
        std::copy_n(picture.At(sx, sy), 4, extended.At(x, y));
        break;
      }
    }
  }
  return extended;
}

}  // namespace

struct PreparedExemplar::LazySourceVariation {
  std::once_flag made;
  std::optional<SourceVariation> value;
};

PreparedExemplar::PreparedExemplar() : source_variation_(std::make_shared<LazySourceVariation>()) {}

PreparedExemplar::PreparedExemplar(std::span<const Picture* const> pictures, double rim, int size)
    : PreparedExemplar() {
  size_ = size;
  SCUMBLE_CHECK(!pictures.empty() && size >= 1 && size <= 32767);
  limit_ = std::numeric_limits<std::int64_t>::max();
  std::vector<double> fractions;
  for (const Picture* picture : pictures) {
    SCUMBLE_CHECK_EQ(picture->width, picture->height);
    const double unused = std::max(rim, static_cast<double>(SoftEdge(*picture)));
    fractions.push_back(1.0 - unused / (0.5 * picture->width));
    limit_ = std::min(limit_, UsableLimit(size, fractions.back()));
  }
  usable_radius_ = static_cast<float>(std::sqrt(static_cast<double>(limit_)) / size);
  coordinate_.resize(std::size_t(size) + 2 * ExemplarRows::kPad);
  for (int i = 0; i < size; ++i) {
    coordinate_[std::size_t(i) + ExemplarRows::kPad] = static_cast<float>(2 * i + 1 - size) / static_cast<float>(size);
  }
  for (int y = 0; y < size; ++y) {
    const std::int64_t dy = 2 * std::int64_t(y) + 1 - size, left = limit_ - dy * dy;
    // Every usable row has its middle pixels, or none; the root of an integer below 2^53 rounds down to the right one.
    const int reach = left < 0 ? -1 : static_cast<int>(std::sqrt(static_cast<double>(left)));
    const int first = left < 0 ? 1 : (size - std::min(reach, size)) / 2, last = left < 0 ? 0 : size - 1 - first;
    first_usable_.push_back(static_cast<std::int16_t>(first));
    last_usable_.push_back(static_cast<std::int16_t>(last));
  }
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const Picture& picture = *pictures[k];
    pictures_.push_back(Resample(ExtendPaint(picture, UsableLimit(picture.width, fractions[k])), size, size));
  }
}

Expected<PreparedExemplar> PreparedExemplar::OfScene(std::span<const Picture* const> pictures, const GuideSet& guides,
                                                     double rim, int width, int height, const std::string& name) {
  SCUMBLE_CHECK(!pictures.empty() && width >= 1 && width <= 32767 && height >= 1 && height <= 32767);
  const std::vector<std::uint8_t> mask = internal::UsableMask(guides, rim);
  if (std::find(mask.begin(), mask.end(), 1) == mask.end()) {
    const auto coverage = guides.Plane(Layer::kCoverage);
    if (std::none_of(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; })) {
      return InputError("the guides of " + name + " cover nothing: A is 0 everywhere");
    }
    return UsageError(name + ": no painted pixel is " + std::to_string(rim) +
                      " pixels or more from the edge; lower transfer.rim");
  }
  auto scene = std::make_shared<Scene>();
  scene->width = width, scene->height = height;
  const std::size_t padded = std::size_t(width) * height + 2 * ExemplarRows::kPad;
  for (std::vector<float>& plane : scene->normal) plane.resize(padded);
  scene->usable.resize(padded);
  for (int y = 0; y < height; ++y) {
    const int v = static_cast<int>((2 * std::int64_t(y) + 1) * guides.height() / (2 * std::int64_t(height)));
    for (int x = 0; x < width; ++x) {
      const int u = static_cast<int>((2 * std::int64_t(x) + 1) * guides.width() / (2 * std::int64_t(width)));
      const std::size_t from = guides.Index(u, v), to = scene->Index(x, y);
      scene->usable[to] = mask[from];
      for (int c = 0; c < 3 && mask[from]; ++c) scene->normal[c][to] = guides.Plane(Layer::kNormal, c)[from];
    }
  }
  if (std::find(scene->usable.begin(), scene->usable.end(), 1) == scene->usable.end()) {
    return UsageError(name + ": nothing of what is painted is left at " + std::to_string(width) + "×" +
                      std::to_string(height) + " pixels; raise transfer.scale");
  }
  PreparedExemplar exemplar;
  exemplar.size_ = std::max(width, height);
  for (const Picture* picture : pictures) {
    SCUMBLE_CHECK_EQ(picture->width, guides.width());
    SCUMBLE_CHECK_EQ(picture->height, guides.height());
    exemplar.pictures_.push_back(Resample(internal::ExtendPaint(*picture, mask), width, height));
  }
  exemplar.scene_ = std::move(scene);
  return exemplar;
}

PreparedExemplar PreparedExemplar::WithPictures(std::vector<Picture> pictures) const {
  SCUMBLE_CHECK_EQ(pictures.size(), pictures_.size());
  for (const Picture& picture : pictures) {
    SCUMBLE_CHECK_EQ(picture.width, width());
    SCUMBLE_CHECK_EQ(picture.height, height());
  }
  PreparedExemplar other(*this);
  other.pictures_ = std::move(pictures);
  return other;
}

const SourceVariation& PreparedExemplar::source_variation() const {
  std::call_once(source_variation_->made, [this] { source_variation_->value.emplace(*this); });
  return *source_variation_->value;
}

ExemplarRows PreparedExemplar::Rows() const {
  ExemplarRows rows;
  rows.width = width(), rows.height = height();
  rows.is_sphere = is_sphere();
  if (is_sphere()) {
    rows.coordinate = coordinate_.data() + ExemplarRows::kPad;
    rows.first = first_usable_.data(), rows.last = last_usable_.data();
    return rows;
  }
  for (int c = 0; c < 3; ++c) rows.normal[c] = scene_->normal[c].data() + ExemplarRows::kPad;
  rows.usable = scene_->usable.data() + ExemplarRows::kPad;
  return rows;
}

std::vector<Source> PreparedExemplar::UsablePixels() const {
  std::vector<Source> sources;
  for (int y = 0; y < height(); ++y) {
    for (int x = 0; x < width(); ++x) {
      if (Usable(x, y)) sources.push_back({x, y});
    }
  }
  return sources;
}

// Everything that a table depends on, in 128 bits: no two exemplars share a key by chance.
std::string PreparedExemplar::TableKey(std::span<const Source> sources, int resolution) const {
  constexpr int kFormat = 1;
  std::uint64_t a = Hash(kFormat, resolution, width(), height()), b = ~a;
  for (const Source& source : sources) {
    const glm::vec3 normal = Normal(source.x, source.y);
    std::uint32_t bits[3];
    std::memcpy(bits, &normal, sizeof bits);
    const std::uint64_t place = std::uint64_t(source.y) << 32 | std::uint32_t(source.x);
    const std::uint64_t word = std::uint64_t(bits[0]) << 32 | bits[1];
    a = Mix64(Mix64(a ^ place) ^ word) + bits[2];
    b = Mix64(b + word) ^ (Mix64(place) + bits[2]);
  }
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string key;
  for (const std::uint64_t half : {Mix64(a), Mix64(b)}) {
    for (int shift = 60; shift >= 0; shift -= 4) key += kDigits[half >> shift & 15];
  }
  return key;
}

Status PreparedExemplar::SearchBy(NearestSearch search, int resolution, TableCache* cache, double error) {
  if (search == NearestSearch::kAuto) search = is_sphere() ? NearestSearch::kAnalytic : NearestSearch::kTable;
  if (search == NearestSearch::kAnalytic) {
    if (!is_sphere()) {
      return UsageError(
          "transfer.nearest = \"analytic\" is for spheres; this exemplar has guides of its own: leave it "
          "at \"auto\", or take \"table\" or \"tree\"");
    }
    search_.reset();
    return Ok();
  }
  auto found = std::make_shared<ExemplarSearch>();
  found->sources = UsablePixels();
  found->error = error;
  std::string key;
  if (search == NearestSearch::kTable && cache) {
    key = TableKey(found->sources, resolution);
    if (const auto bytes = cache->Load(key)) found->table = LookUpTable::FromBytes(*bytes, resolution);
    const auto usable = [&](const Source& cell) { return Usable(cell.x, cell.y); };
    if (found->table && std::all_of(found->table->cells().begin(), found->table->cells().end(), usable)) {
      found->sources = {};
      search_ = std::move(found);
      return Ok();
    }
    found->table.reset();
  }
  std::vector<float> coordinates;
  coordinates.reserve(3 * found->sources.size());
  for (const Source& source : found->sources) {
    const glm::vec3 normal = Normal(source.x, source.y);
    coordinates.insert(coordinates.end(), {normal.x, normal.y, normal.z});
  }
  found->normals.emplace(3, std::move(coordinates));
  if (search == NearestSearch::kTable) {
    found->table.emplace(*found->normals, found->sources, resolution);
    if (cache) cache->Store(key, found->table->ToBytes());
    found->normals.reset();
    found->sources = {};
  }
  search_ = std::move(found);
  return Ok();
}

Source PreparedExemplar::Searched(glm::vec3 normal) const { return search_->Find(FacingDirection(normal)); }

Source PreparedExemplar::Analytic(glm::vec3 normal) const {
  const glm::vec2 place = OnDisc(normal);
  const float nx = place.x, ny = place.y;
  // A position on the border of two pixels is equally near to both: the lower index wins, hence ceil - 1.
  const float half = 0.5f * static_cast<float>(size_);
  const int x = std::clamp(RoundedUp(nx * half + half) - 1, 0, size_ - 1);
  const int y = std::clamp(RoundedUp(half - ny * half) - 1, 0, size_ - 1);
  return Usable(x, y) ? Source{x, y} : NearestUsable(nx, ny, x, y);
}

Source PreparedExemplar::NearestUsable(float nx, float ny, int x, int y) const {
  for (int reach = 1; reach <= size_; ++reach) {
    Source best;
    float best_distance = std::numeric_limits<float>::infinity();
    for (int v = y - reach; v <= y + reach; ++v) {
      for (int u = x - reach; u <= x + reach; ++u) {
        if (!Usable(u, v)) continue;
        const float dx = nx - Coordinate(u), dy = ny + Coordinate(v);
        const float distance = dx * dx + dy * dy;
        if (distance < best_distance) best = {u, v}, best_distance = distance;
      }
    }
    if (best_distance < std::numeric_limits<float>::infinity()) return best;
  }
  SCUMBLE_CHECK(!"every exemplar has a usable pixel");
  return {};
}

int ScaledSize(int size, double scale, int reference_height, int output_height) {
  const double height_ratio = reference_height > 0 ? static_cast<double>(output_height) / reference_height : 1.0;
  return static_cast<int>(std::clamp(std::floor(size * scale * height_ratio + 0.5), 1.0, 1e9));
}

}  // namespace scumble
