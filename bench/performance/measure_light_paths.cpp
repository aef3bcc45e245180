#include <array>
#include <cmath>
#include <nanoflann.hpp>

#include "bench/or_stop.h"
#include "bench/performance/performance.h"
#include "core/style/style_file.h"

namespace scumble::bench {
namespace {

constexpr int kDimensions = 15;
constexpr int kRowStep = 16;  // the search is timed on every 16th row, and its time counts 16 times

// The bundled exemplar of a whole scene, matched in fifteen dimensions: the normal and four kinds of light paths.
Style LightPathStyle() {
  std::vector<std::string> settings;
  for (const char* layer : {"luminance", "shadow"}) settings.push_back(std::string("guide_weights.") + layer + "=0");
  for (const char* layer : {"LDE", "LSE", "LDDE", "LD12E"}) {
    settings.push_back(std::string("guide_weights.lpe.") + layer + "=0.5");
  }
  // The keys by which the style is painted may change; the figure is to be of the search.
  settings.insert(settings.end(), {"threshold=0.25", "blend_radius=1", "hybrid=0", "variety=0", "edge_aware=false",
                                   "reference_height=0", "paper=\"\""});
  for (std::string& setting : settings) setting.insert(0, "transfer.");
  return OrStop(
      LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/scene-oil", OrStop(ParseStyleOverrides(settings))));
}

// Points in nanoflann's form: its own Euclidean metric in floats, dimensions known at compile time.
struct Points {
  std::vector<std::array<float, kDimensions>> all;

  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  float kdtree_get_pt(std::uint32_t index, std::size_t dimension) const { return all[index][dimension]; }
  std::size_t kdtree_get_point_count() const { return all.size(); }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points, float, std::uint32_t>,
                                                 Points, kDimensions, std::uint32_t>;

Points ExemplarPoints(const PreparedStyle& style) {
  Points points;
  for (const Source at : style.exemplar->UsablePixels()) {
    float* to = points.all.emplace_back().data();
    style.space->ForEachCoordinate(0, at, [&](float value) { *to++ = value; });
  }
  return points;
}

// Searches the nearest exemplar pixel of every covered pixel of some rows; reading the guides is included.
std::uint64_t AskRows(const Tree& tree, const GuideSpace& space, const GuideSet& guides, float brightness) {
  std::uint64_t sum = 0;
  for (int y = kRowStep / 2; y < guides.height(); y += kRowStep) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      float query[kDimensions];
      const glm::vec3 normal = space.normal_weight() * guides.Vec3(Layer::kNormal, i);
      query[0] = normal.x, query[1] = normal.y, query[2] = normal.z;
      space.Read(guides, i, brightness, query + 3);
      std::uint32_t index = 0;
      float distance = 0.0f;
      tree.knnSearch(query, 1, &index, &distance);
      sum += index;
    }
  }
  return sum;
}

}  // namespace

void MeasureLightPaths(const PerformanceOptions& options, Report& report) {
  const auto [width, height] = options.light_size;
  const LayerSet layers{Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLpeLDDE, Layer::kLpeLD12E};
  const Frame frame = SceneFrame("stilllife", width, height, layers, options.light_samples);
  report.Say("light paths: " + frame.name);
  const Style style = LightPathStyle();
  Engine engine(style, height);
  const PreparedStyle& prepared = engine.prepared();
  engine.options.exposure = MeasureExposure({&prepared, 1}, frame.guides).value_or(0.0);
  const float brightness = static_cast<float>(std::exp2(engine.options.exposure));
  Engine normals(PlainStyle(), height);
  const Points points = ExemplarPoints(prepared);
  const Tree tree(kDimensions, points, nanoflann::KDTreeSingleIndexAdaptorParams(12));

  std::uint64_t sum = 0;
  const std::function<void()> contestants[] = {[&] { sum += AskRows(tree, *prepared.space, frame.guides, brightness); },
                                               [&] { engine.Paint(frame); }, [&] { normals.Paint(frame); }};
  const std::vector<Times> times = TakeTurns(contestants, options.repeats);
  std::size_t asked = 0;
  for (int y = kRowStep / 2; y < height; y += kRowStep) {
    for (int x = 0; x < width; ++x) asked += frame.guides.Plane(Layer::kCoverage)[frame.guides.Index(x, y)] > 0.0f;
  }
  const double more = static_cast<double>(frame.covered) / static_cast<double>(asked);
  const double per_pixel = 1e6 / static_cast<double>(frame.covered);
  report.Add({"4",
              "15 dimensions of light: nanoflann for every pixel against the engine",
              frame.name,
              "×",
              Ratio(times[0], times[1], Clock::kThread, more),
              10.0,
              true,
              "nanoflann asked for every 16th row, its time counted 16 times; the engine's is the whole transfer",
              {{"nanoflann_ns", times[0].Milliseconds(Clock::kThread).median * per_pixel * more},
               {"engine_ns", times[1].Milliseconds(Clock::kThread).median * per_pixel}}});
  report.Add({"4",
              "15 dimensions of light against plain",
              frame.name,
              "×",
              Ratio(times[1], times[2], Clock::kThread),
              {},
              false,
              sum == 0 ? "the search found nothing" : ""});
}

}  // namespace scumble::bench
