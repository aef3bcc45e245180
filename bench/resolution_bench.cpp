// The cost and the effect of coarse matching and upsampled guides, against matching every pixel of a picture of equal
// size: time of the match, guide error, and the number of pixels with an equal source. Prints the figures of
// docs/resolution.md.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "bench/or_stop.h"
#include "core/image/stopwatch.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "transfer/transfer.h"
#include "transfer/upsample_guides.h"

namespace scumble {
namespace {

constexpr int kWidth = 1920, kHeight = 1080, kRuns = 7;

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Made {
  GuideSet guides;
  double ms = 0.0;
};

Made Render(const std::string& name, int factor) {
  Scene scene = OrStop(LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/" + name + ".glb"));
  const PreparedView view = OrStop(PrepareView(scene, "", std::nullopt, double(kWidth) / kHeight, false));
  GuidegenOptions options;
  options.width = kWidth / factor, options.height = kHeight / factor;
  options.aa = 4;
  options.threads = 1;
  GuidegenResult rendered = OrStop(RenderGuides(scene, view.camera, options));
  return {std::move(rendered.guides), rendered.render_ms};
}

// Angles between a pixel's normal and its source's, by the guides of the full size.
struct Error {
  double mean = 0.0, most = 0.0;  // degrees; the second: 99 of 100 pixels have less
};
Error GuideError(const GuideSet& truth, const PreparedExemplar& exemplar, const SourceField& field) {
  std::vector<double> degrees;
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
    if (field.level[i] == SourceField::kNoSource || !(truth.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
    const glm::dvec3 a = truth.Vec3(Layer::kNormal, i), b = exemplar.Normal(field.x[i], field.y[i]);
    degrees.push_back(std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * 180.0 / 3.14159265358979);
    sum += degrees.back();
  }
  const auto place = degrees.begin() + std::ptrdiff_t(degrees.size() * 99 / 100);
  std::nth_element(degrees.begin(), place, degrees.end());
  return {sum / double(degrees.size()), *place};
}

double SameSources(const SourceField& a, const SourceField& b) {
  double same = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    if (a.level[i] == SourceField::kNoSource || b.level[i] == SourceField::kNoSource) continue;
    count += 1.0, same += a.x[i] == b.x[i] && a.y[i] == b.y[i];
  }
  return 100.0 * same / count;
}

// One variant of painting the picture.
struct Variant {
  std::string name;
  const GuideSet* guides;
  int step = 1;
  double guides_ms = 0.0;
  std::vector<double> match_ms = {};
  SourceField field = {};
};

void Measure(const std::string& scene, const std::string& style_name) {
  Style style = OrStop(LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + style_name, {}));
  std::map<int, PreparedStyle> prepared;  // by step
  for (const int step : {1, 2, 4, 8}) {
    style.transfer.match_step = step;
    prepared.emplace(step, OrStop(Prepare(style, kHeight)));
  }
  const Made full = Render(scene, 1);
  std::vector<Made> upsampled;
  for (const int factor : {2, 4}) {
    const Made small = Render(scene, factor);
    Stopwatch watch;
    GuideSet larger = OrStop(UpsampleGuides(small.guides, factor, 1));
    upsampled.push_back({std::move(larger), small.ms + watch.Lap()});
  }
  std::vector<Variant> ways;
  for (const int step : {1, 2, 4, 8})
    ways.push_back({"match_step " + std::to_string(step), &full.guides, step, full.ms});
  ways.push_back({"--upsample 2, match_step 2", &upsampled[0].guides, 2, upsampled[0].ms});
  ways.push_back({"--upsample 4, match_step 4", &upsampled[1].guides, 4, upsampled[1].ms});
  TransferScratch scratch;
  Picture picture;
  for (int run = 0; run < kRuns; ++run) {  // in turns, so that other load of the machine affects all of them alike
    for (Variant& way : ways) {
      TransferOptions options;
      options.threads = 1;
      options.keep_field = true;
      OrStop(Transfer(prepared.at(way.step), *way.guides, options, scratch, picture));
      way.match_ms.push_back(scratch.times.match_ms);
      way.field = scratch.field;
    }
  }
  const double base = Median(ways[0].match_ms);
  for (const Variant& way : ways) {
    const Error error = GuideError(full.guides, *prepared.at(1).exemplar, way.field);
    std::printf("| %s | %s | %s | %.0f | %.2f | %.0f | %.1f° | %.1f° | %.1f%% |\n", scene.c_str(), style_name.c_str(),
                way.name.c_str(), Median(way.match_ms), Median(way.match_ms) / base, way.guides_ms, error.mean,
                error.most, SameSources(ways[0].field, way.field));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace scumble

int main() {
  std::printf(
      "| scene | style | way | match, ms | of step 1 | guides, ms | error, mean | 99%% below | same source |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  for (const char* scene : {"suzanne", "stilllife"}) {
    for (const char* style : {"charcoal", "oil"}) scumble::Measure(scene, style);
  }
  return 0;
}
