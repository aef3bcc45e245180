// The effect of `hybrid` on a picture of large chunks: seams, and the difference of its tone from the Lit Sphere's,
// which is the surface's own. Prints the table of docs/hybrid.md.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "bench/or_stop.h"
#include "core/filter/masked_blur.h"
#include "core/style/style_file.h"
#include "guidegen/guidegen.h"
#include "guidegen/load/load_scene.h"
#include "guidegen/scene/framing.h"
#include "measure/mosaic/repetition.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

struct Painted {
  Picture picture;
  SourceField field;
  double guide_error = 0.0;  // degrees, mean
};

Painted Paint(Style style, const GuideSet& guides) {
  style.paper = {};
  const PreparedStyle prepared = OrStop(Prepare(style, guides.height()));
  TransferScratch scratch;
  Painted painted;
  TransferOptions options;
  options.keep_field = true;
  OrStop(Transfer(prepared, guides, options, scratch, painted.picture));
  painted.field = std::move(scratch.field);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (painted.field.level[i] == SourceField::kNoSource) continue;
    const glm::dvec3 a = guides.Vec3(Layer::kNormal, i);
    const glm::dvec3 b = prepared.exemplar->Normal(painted.field.x[i], painted.field.y[i]);
    sum += std::acos(std::min(1.0, glm::dot(a, b))) * 180.0 / 3.14159265358979, count += 1.0;
  }
  painted.guide_error = sum / count;
  return painted;
}

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

// The amount of texture: root mean square of the difference between a picture and its own blur.
double Texture(const Picture& picture, const std::vector<std::uint8_t>& covered) {
  const Picture smooth = internal::MaskedBlur(picture, covered, 4.0);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    if (!covered[i]) continue;
    for (int c = 0; c < 3; ++c) {
      const double d = (double(picture.rgba[4 * i + c]) - smooth.rgba[4 * i + c]) / 257.0;
      sum += d * d, count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

void Measure(const GuideSet& guides, const std::string& name) {
  Style style = OrStop(LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name, {}));
  std::vector<std::uint8_t> covered(guides.pixel_count());
  for (std::size_t i = 0; i < covered.size(); ++i) covered[i] = guides.Plane(Layer::kCoverage)[i] >= 1.0f;
  const double own = std::exchange(style.transfer.hybrid, 0.0);
  style.transfer.method = Method::kLitSphere;
  const Painted sphere = Paint(style, guides);
  style.transfer.method = Method::kStyleBlit;
  const auto row = [&](const std::string& what, const Painted& made) {
    const SourceField& field = made.field;
    const SourcePlanes planes{field.width, field.height, field.x, field.y, covered, field.exemplar};
    std::printf("| %s | %s | %+.0f%% | %.1f | %.1f | %.1f° |\n", name.c_str(), what.c_str(),
                100.0 * MeasureSeams(made.picture, planes).excess,
                ToneDifference(made.picture, sphere.picture, covered), Texture(made.picture, covered),
                made.guide_error);
    std::fflush(stdout);
  };
  row("Lit Sphere", sphere);
  style.transfer.hybrid = own;
  row("as it is", Paint(style, guides));
  style.transfer.hybrid = 0.0;
  style.transfer.threshold = 0.4f;
  row("threshold 0.4", Paint(style, guides));
  for (const double sigma : {8.0, 16.0, 32.0}) {
    style.transfer.hybrid = sigma;
    char text[60];
    std::snprintf(text, sizeof text, "threshold 0.4, hybrid %g", sigma);
    row(text, Paint(style, guides));
  }
}

}  // namespace
}  // namespace scumble

int main() {
  using namespace scumble;
  Scene scene = OrStop(LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/suzanne.glb"));
  const PreparedView view = OrStop(PrepareView(scene, "", std::nullopt, 16.0 / 9.0, false));
  GuidegenOptions options;
  options.width = 1280, options.height = 720;
  const GuideSet guides = std::move(OrStop(RenderGuides(scene, view.camera, options)).guides);
  std::printf(
      "| style | way | seam excess | tone off the Lit Sphere's | texture | guide error |\n|---|---|---|---|---|---|\n");
  for (const char* name : {"charcoal", "graphite", "oil", "watercolour"}) Measure(guides, name);
  return 0;
}
