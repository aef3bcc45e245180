// Figures of pictures that anything may have made, by the measures of `scumble tradeoff`: for bench/paint_pairs.py.
//
//   paint_figures STYLE GUIDES PICTURE…    a line of JSON for each picture
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/or_stop.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "pipeline/variant/variant_error.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr std::size_t kPatches = 512;  // all patches are searched for, as no sources are known

void OrStop(const Status& status) {
  if (status) return;
  std::fprintf(stderr, "%s\n", status.error().message.c_str());
  std::exit(1);
}

// Every layer that the file has.
std::shared_ptr<const GuideSet> ReadAll(const std::string& file) {
  GuideReadOptions options;
  options.optional = OrStop(InspectGuides(file)).layers.at("");
  return std::make_shared<const GuideSet>(OrStop(ReadGuides(file, options)));
}

void PrintFigures(const TradeReference& reference, const GuidedTexture& texture, const std::string& file) {
  const Picture picture = OrStop(ReadPicture(file));
  TradeMeasure measure;
  EnergyOptions patches;
  patches.samples = kPatches;
  OrStop(reference.MeasurePaint(picture, nullptr, patches, measure));
  OrStop(reference.MeasureTexture(texture, picture, measure));
  const nlohmann::ordered_json line = {{"picture", file},
                                       {"both", measure.both.mean},
                                       {"energy", measure.energy.mean},
                                       {"missing", measure.missing.mean},
                                       {"texture", measure.texture.value_or(NAN)}};
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

void PrintAll(const std::string& style_folder, const std::string& guide_file, int count, char** files) {
  const auto guides = ReadAll(guide_file);
  Style style = OrStop(LoadStyle(style_folder, {}));
  style.paper = {};
  PreparedStyle prepared = OrStop(Prepare(style, guides->height()));
  const double exposure = MeasureExposure({&prepared, 1}, *guides).value_or(0.0);
  const TradeReference reference(guides, std::move(prepared), exposure, 0);
  const GuidedTexture texture = OrStop(reference.Texture());
  for (int k = 0; k < count; ++k) PrintFigures(reference, texture, files[k]);
}

}  // namespace
}  // namespace scumble

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: paint_figures STYLE GUIDES PICTURE...\n");
    return 2;
  }
  scumble::PrintAll(argv[1], argv[2], argc - 3, argv + 3);
  return 0;
}
