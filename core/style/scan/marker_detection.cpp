#include "core/style/scan/marker_detection.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/style/scan/mark_edges.h"

namespace scumble {
namespace {

// Any two markers differ in five bits, so one wrong bit is still unambiguous.
constexpr int kMostWrongBits = 1;

template <auto Destroy>
struct Destroyer {
  void operator()(auto* what) const { Destroy(what); }
};
using Family = std::unique_ptr<apriltag_family_t, Destroyer<tag16h5_destroy>>;
using Detector = std::unique_ptr<apriltag_detector_t, Destroyer<apriltag_detector_destroy>>;
using Detections = std::unique_ptr<zarray_t, Destroyer<apriltag_detections_destroy>>;

// The picture's brightness at 1 / `factor` of its size, each pixel the mean of factor² encoded ones. The library's own
// reduction takes a single pixel, with all its noise.
std::vector<std::uint8_t> Reduced(const Picture& picture, int width, int height, int factor) {
  std::vector<std::uint8_t> grey;
  grey.reserve(std::size_t(width) * std::size_t(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint64_t sum = 0;
      for (int j = 0; j < factor; ++j) {
        const std::uint16_t* pixel = picture.At(x * factor, y * factor + j);
        for (int i = 0; i < factor; ++i, pixel += 4) sum += std::uint64_t(2 * pixel[0] + 5 * pixel[1] + pixel[2]);
      }
      grey.push_back(static_cast<std::uint8_t>(sum / (8 * 257 * std::uint64_t(factor * factor))));
    }
  }
  return grey;
}

glm::dvec2 Middle(const FoundMark& mark) {
  return (mark.corners[0] + mark.corners[1] + mark.corners[2] + mark.corners[3]) / 4.0;
}

// All marks at one scale of the picture.
void SearchAt(const Picture& picture, int factor, apriltag_detector_t* detector, std::vector<FoundMark>& marks) {
  const int width = picture.width / factor, height = picture.height / factor;
  std::vector<std::uint8_t> grey = Reduced(picture, width, height, factor);
  image_u8_t image{width, height, width, grey.data()};
  const Detections detections(apriltag_detector_detect(detector, &image));
  for (int i = 0; i < zarray_size(detections.get()); ++i) {
    const apriltag_detection_t* seen = nullptr;
    zarray_get(detections.get(), i, &seen);
    if (seen->id >= kFiducialCount) continue;
    FoundMark mark;
    mark.id = seen->id;
    // The library begins at the lower left and goes on to the lower right.
    for (std::size_t c = 0; c < 4; ++c)
      mark.corners[c] = double(factor) * glm::dvec2(seen->p[3 - c][0], seen->p[3 - c][1]);
    const bool known = std::any_of(marks.begin(), marks.end(), [&](const FoundMark& other) {
      return glm::length(Middle(mark) - Middle(other)) < 2.0 * other.module_pixels;
    });
    if (!known && RefineMark(picture, mark)) marks.push_back(mark);
  }
}

}  // namespace

std::vector<FoundMark> FindMarks(const Picture& picture, int finest) {
  constexpr int kLeastSide = 32;  // the library thresholds in tiles
  const Family family(tag16h5_create());
  const Detector detector(apriltag_detector_create());
  detector->nthreads = 1;
  detector->quad_decimate = 1;
  detector->refine_edges = true;
  apriltag_detector_add_family_bits(detector.get(), family.get(), kMostWrongBits);
  std::vector<FoundMark> marks;
  int last_factor = 0;
  // From small to large: most marks are found in a small picture, where noise is averaged out; small marks need more
  // pixels.
  for (int longest = kCoarsestSearch; longest <= finest; longest *= 2) {
    const int factor = (std::max(picture.width, picture.height) + longest - 1) / longest;
    if (factor == last_factor || std::min(picture.width, picture.height) < kLeastSide * factor) continue;
    last_factor = factor;
    SearchAt(picture, factor, detector.get(), marks);
    if (marks.size() >= std::size_t(kFiducialCount)) break;
  }
  std::sort(marks.begin(), marks.end(), [](const FoundMark& a, const FoundMark& b) {
    return std::pair(a.corners[0].y, a.corners[0].x) < std::pair(b.corners[0].y, b.corners[0].x);
  });
  return marks;
}

}  // namespace scumble
