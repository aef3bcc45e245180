// What `variety` does on a flat wall: repetition, autocorrelation, seams and time, for the bundled styles. Prints the
// table of docs/variety.md.
#include <cstdio>
#include <string>
#include <vector>

#include "image/stopwatch.h"
#include "measure/repetition.h"
#include "style/style_file.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

// A wall that looks to the upper left, with one normal everywhere.
GuideSet Wall(int size) {
  GuideSet guides(size, size);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  const glm::vec3 normal = glm::normalize(glm::vec3(-0.2f, 0.25f, 1.0f));
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kCoverage)[i] = 1.0f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = normal[c];
    guides.Plane(Layer::kDepth)[i] = 10.0f;
    guides.Plane(Layer::kObject)[i] = 1.0f;
  }
  return guides;
}

struct Figures {
  double repetition = 0, peak = 0, seam_excess = 0, milliseconds = 0;
};

Figures Measure(Style style, double variety, const GuideSet& guides) {
  style.transfer.variety = variety;
  style.transfer.reference_height = 0;
  style.paper = {};
  const auto prepared = Prepare(style, guides.height());
  if (!prepared) return std::fprintf(stderr, "%s\n", prepared.error().message.c_str()), Figures{};
  TransferScratch scratch;
  Picture picture;
  Figures figures{0, 0, 0, 1e30};
  for (int run = 0; run < 5; ++run) {
    if (const Status done = Transfer(*prepared, guides, {}, scratch, picture); !done) {
      return std::fprintf(stderr, "%s\n", done.error().message.c_str()), Figures{};
    }
    figures.milliseconds = std::min(figures.milliseconds, scratch.times.match_ms + scratch.times.vote_ms);
  }
  const SourceField& field = scratch.field;
  const std::vector<std::uint8_t> covered(guides.pixel_count(), 1);
  const SourcePlanes planes{field.width, field.height, field.x, field.y, covered, field.exemplar};
  figures.repetition = SourceRepetition(planes);
  figures.seam_excess = MeasureSeams(picture, planes).excess;
  const int side = std::min(160, field.width);
  figures.peak = HighestAutocorrelation(picture, {(field.width - side) / 2, (field.height - side) / 2, side, side}).value;
  return figures;
}

}  // namespace
}  // namespace scumble

int main() {
  using namespace scumble;
  std::printf("| style | wall | variety | repetition | highest autocorrelation | seam excess | match + vote, ms |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  for (const std::string name : {"charcoal", "graphite", "oil", "watercolour"}) {
    const auto style = LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name, {});
    if (!style) return std::fprintf(stderr, "%s\n", style.error().message.c_str()), 1;
    for (const int size : {256, 512, 1024}) {
      const GuideSet guides = Wall(size);
      for (const double variety : {0.0, 10.0, 20.0}) {
        const Figures f = Measure(*style, variety, guides);
        std::printf("| %s | %d² | %g° | %.1f | %.2f | %+.0f%% | %.1f |\n", name.c_str(), size, variety, f.repetition, f.peak,
                    100.0 * f.seam_excess, f.milliseconds);
        std::fflush(stdout);
      }
    }
  }
  return 0;
}
