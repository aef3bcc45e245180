// What `hybrid` does to pictures of large chunks: their seams, their distance from the painting, and how far their tone
// is off. Prints the tables of docs/hybrid.md.
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/or_stop.h"
#include "core/filter/masked_blur.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "pipeline/variant/variant_error.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

using SharedGuides = std::shared_ptr<const GuideSet>;

const std::vector<std::string> kStyles = {"oil", "watercolour", "pastel", "gouache", "charcoal", "graphite"};

struct Way {
  const char* name;
  Method method;
  float threshold;
  double hybrid;
};
constexpr std::array kWays = {
    Way{"Lit Sphere", Method::kLitSphere, 0.08f, 0.0},     Way{"threshold 0.08", Method::kStyleBlit, 0.08f, 0.0},
    Way{"threshold 0.16", Method::kStyleBlit, 0.16f, 0.0}, Way{"0.16, hybrid 16", Method::kStyleBlit, 0.16f, 16.0},
    Way{"threshold 0.4", Method::kStyleBlit, 0.4f, 0.0},   Way{"0.4, hybrid 8", Method::kStyleBlit, 0.4f, 8.0},
    Way{"0.4, hybrid 16", Method::kStyleBlit, 0.4f, 16.0}, Way{"0.4, hybrid 32", Method::kStyleBlit, 0.4f, 32.0},
};

// Root mean square of the differences of two blurred pictures, in steps of 8-bit sRGB.
double ToneDifference(const Picture& a, const Picture& b, const std::vector<std::uint8_t>& covered) {
  constexpr double kSigma = 12.0;
  const Picture x = internal::MaskedBlur(a, covered, kSigma), y = internal::MaskedBlur(b, covered, kSigma);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    if (!covered[i]) continue;
    for (int c = 0; c < 3; ++c) {
      const double d = (double(x.rgba[4 * i + c]) - y.rgba[4 * i + c]) / 257.0;
      sum += d * d, count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

// A style's cells of the table, by way.
std::vector<std::string> CellsOf(const std::string& name, const SharedGuides& guides) {
  Style style = OrStop(LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name, {}));
  style.paper = {};
  PreparedStyle own = OrStop(Prepare(style, guides->height()));
  const double exposure = MeasureExposure({&own, 1}, *guides).value_or(0.0);
  const TradeReference reference(guides, std::move(own), exposure, 0);
  const GuidedTexture paint = OrStop(reference.Texture());
  std::vector<std::uint8_t> covered(guides->pixel_count());
  for (std::size_t i = 0; i < covered.size(); ++i) covered[i] = guides->Plane(Layer::kCoverage)[i] >= 1.0f;
  std::vector<std::string> cells;
  Picture sphere;
  for (const Way& way : kWays) {
    style.transfer.method = way.method, style.transfer.threshold = way.threshold, style.transfer.hybrid = way.hybrid;
    TransferOptions options;
    options.keep_field = true, options.exposure = exposure;
    TransferScratch scratch;
    Picture picture;
    OrStop(Transfer(OrStop(Prepare(style, guides->height())), *guides, options, scratch, picture));
    if (way.method == Method::kLitSphere) sphere = picture;
    TradeMeasure measure;
    OrStop(reference.MeasureTexture(paint, picture, measure));
    OrStop(reference.MeasureMosaic(picture, scratch.field, measure));
    char cell[64];
    std::snprintf(cell, sizeof cell, "%+.0f%%, %.3f, %.1f", 100.0 * measure.seam_excess.value(),
                  measure.texture.value(), ToneDifference(picture, sphere, covered));
    cells.emplace_back(cell);
  }
  return cells;
}

SharedGuides GuidesOfSuzanne() {
  Scene scene = OrStop(LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/suzanne.glb"));
  const PreparedView view = OrStop(PrepareView(scene, "", std::nullopt, 16.0 / 9.0, false));
  GuidegenOptions options;
  options.width = 1280, options.height = 720;
  options.layers.Add(Layer::kLuminance), options.samples = 16;  // for styles with several exemplars
  return std::make_shared<const GuideSet>(std::move(OrStop(RenderGuides(scene, view.camera, options)).guides));
}

}  // namespace
}  // namespace scumble

int main() {
  using namespace scumble;
  const SharedGuides guides = GuidesOfSuzanne();
  std::vector<std::vector<std::string>> columns;
  for (const std::string& style : kStyles) columns.push_back(CellsOf(style, guides));
  for (std::size_t first = 0; first < kStyles.size(); first += 3) {
    std::printf("| seams, texture, tone off | %s | %s | %s |\n|---|---|---|---|\n", kStyles[first].c_str(),
                kStyles[first + 1].c_str(), kStyles[first + 2].c_str());
    for (std::size_t w = 0; w < kWays.size(); ++w) {
      std::printf("| %s | %s | %s | %s |\n", kWays[w].name, columns[first][w].c_str(), columns[first + 1][w].c_str(),
                  columns[first + 2][w].c_str());
    }
    std::printf("\n");
  }
  return 0;
}
