// The effect of `variety` on a flat wall: repetition, autocorrelation, tone, seams and time, for the bundled styles.
// Prints the tables of docs/variety.md.
//   variety_bench [FOLDER]             a table of walls; keeps the pictures in an existing folder
//   variety_bench --cost GUIDES.exr…   match + vote with and without, on a wall and on guides of scenes
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/wall_measures.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "measure/repetition.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr int kWindow = 160;  // four of them are measured

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
  double repetition = 0, peak = 0, tone_spread = 0, seam_excess = 0, border_share = 0;
};

Figures Measure(Style style, double variety, const GuideSet& guides, const std::string& keep) {
  style.transfer.variety = variety;
  style.transfer.reference_height = 0;
  style.paper = {};
  const auto prepared = Prepare(style, guides.height());
  if (!prepared) return std::fprintf(stderr, "%s\n", prepared.error().message.c_str()), Figures{};
  TransferScratch scratch;
  Picture picture;
  TransferOptions options;
  options.keep_field = true;
  if (const Status done = Transfer(*prepared, guides, options, scratch, picture); !done) {
    return std::fprintf(stderr, "%s\n", done.error().message.c_str()), Figures{};
  }
  if (!keep.empty()) {
    if (const Status kept = WritePicture(keep, picture); !kept) {
      return std::fprintf(stderr, "%s\n", kept.error().message.c_str()), Figures{};
    }
  }
  Figures figures;
  const SourceField& field = scratch.field;
  const std::vector<std::uint8_t> covered(guides.pixel_count(), 1);
  const SourcePlanes planes{field.width, field.height, field.x, field.y, covered, field.exemplar};
  figures.repetition = SourceRepetition(planes);
  const SeamStrength seams = MeasureSeams(picture, planes, guides);
  figures.seam_excess = seams.excess;
  figures.border_share = double(seams.border_pairs) / double(seams.border_pairs + seams.inside_pairs);
  figures.tone_spread = ToneSpread(picture, {0, 0, field.width, field.height}, 16.0);
  // The mean over windows: the places of single seeds decide a window's peak.
  const int side = std::min(kWindow, field.width / 2);
  AutocorrelationOptions high;
  high.subtract_sigma = 8.0;
  int windows = 0;
  for (int y = 0; y < 2 * side; y += side) {
    for (int x = 0; x < 2 * side; x += side) {
      figures.peak += HighestAutocorrelation(picture, {x, y, side, side}, high).value;
      ++windows;
    }
  }
  figures.peak /= windows;
  return figures;
}

}  // namespace
}  // namespace scumble

namespace scumble {
namespace {

constexpr double kDegrees = 20.0;
const std::vector<std::string> kStyles = {"charcoal", "graphite", "oil", "watercolour"};

Expected<Style> Bundled(const std::string& name) {
  return LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name, {});
}

int PrintWalls(const std::string& pictures) {
  std::printf(
      "| style | wall | variety | repetition | repeated strokes | tone spread | seam excess | pairs on borders |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : kStyles) {
    const auto style = Bundled(name);
    if (!style) return std::fprintf(stderr, "%s\n", style.error().message.c_str()), 1;
    for (const int size : {256, 512, 1024}) {
      const GuideSet guides = Wall(size);
      for (const double variety : {0.0, 10.0, kDegrees, 30.0}) {
        const std::string stem = name + "-" + std::to_string(size) + "-" + std::to_string(static_cast<int>(variety));
        const Figures f = Measure(*style, variety, guides, pictures.empty() ? "" : pictures + "/" + stem + ".png");
        std::printf("| %s | %d² | %g° | %.1f | %.2f | %.1f | %+.0f%% | %.1f%% |\n", name.c_str(), size, variety,
                    f.repetition, f.peak, 100.0 * f.tone_spread, 100.0 * f.seam_excess, 100.0 * f.border_share);
        std::fflush(stdout);
      }
    }
  }
  return 0;
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Match and vote with `variety` against without, alternately in one run, and the changed pixels.
Status PrintCost(const std::string& name, const GuideSet& guides) {
  constexpr int kRuns = 15;
  SCUMBLE_ASSIGN(Style style, Bundled("charcoal"));
  SCUMBLE_ASSIGN(PreparedStyle plain, Prepare(style, guides.height()));
  PreparedStyle varied = plain;
  varied.settings.variety = kDegrees;
  TransferScratch scratch;
  Picture before, after;
  std::vector<double> plain_ms, varied_ms, ratios, match_ratios, vote_ratios;
  for (int run = -1; run < kRuns; ++run) {  // the first pair warms up
    SCUMBLE_RETURN_IF_ERROR(Transfer(plain, guides, {}, scratch, before));
    const StageTimes one = scratch.times;
    const double a = one.match_ms + one.vote_ms;
    SCUMBLE_RETURN_IF_ERROR(Transfer(varied, guides, {}, scratch, after));
    const double b = scratch.times.match_ms + scratch.times.vote_ms;
    if (run < 0) continue;
    plain_ms.push_back(a), varied_ms.push_back(b), ratios.push_back(b / a);
    match_ratios.push_back(scratch.times.match_ms / one.match_ms);
    vote_ratios.push_back(scratch.times.vote_ms / one.vote_ms);
  }
  std::printf("| %s | %.0f | %.0f | %.2f | %.2f | %.2f |\n", name.c_str(), Median(plain_ms), Median(varied_ms),
              Median(ratios), Median(match_ratios), Median(vote_ratios));
  std::fflush(stdout);
  std::map<float, std::pair<double, double>> changed;  // by object: of that many pixels
  const auto object = guides.Plane(Layer::kObject);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
    auto& [pixels, of] = changed[object[i]];
    of += 1.0, pixels += !std::equal(&before.rgba[4 * i], &before.rgba[4 * i] + 4, &after.rgba[4 * i]);
  }
  for (const auto& [id, share] : changed) {
    const auto known = guides.object_names.find(static_cast<std::uint32_t>(id));
    std::fprintf(stderr, "  %-24s %6.0f pixels, %5.1f%% changed\n",
                 known == guides.object_names.end() ? "?" : known->second.c_str(), share.second,
                 100.0 * share.first / share.second);
  }
  return Ok();
}

int PrintCosts(int count, char** files) {
  std::printf("| guides | without, ms | with, ms | ratio | of match | of vote |\n|---|---|---|---|---|---|\n");
  const auto print = [](const std::string& name, const GuideSet& guides) {
    const Status done = PrintCost(name, guides);
    if (!done) std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return done.ok();
  };
  if (!print("wall 1024²", Wall(1024))) return 1;
  for (int i = 0; i < count; ++i) {
    const auto guides = ReadGuides(files[i]);
    if (!guides) return std::fprintf(stderr, "%s\n", guides.error().message.c_str()), 1;
    if (!print(std::filesystem::path(files[i]).stem().string(), *guides)) return 1;
  }
  return 0;
}

}  // namespace
}  // namespace scumble

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--cost") return scumble::PrintCosts(argc - 2, argv + 2);
  return scumble::PrintWalls(argc > 1 ? argv[1] : "");
}
