// Figures of pictures that anything may have made, by the measures of `scumble tradeoff`: for bench/paint_pairs.py.
//
//   paint_figures STYLE GUIDES PICTURE…                    a line of JSON for each picture
//   paint_figures STYLE GUIDES --part X Y SIDE PICTURE…    of a square part
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "bench/or_stop.h"
#include "core/image/fragments.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "measure/outline_error.h"
#include "pipeline/variant/variant_error.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

constexpr std::size_t kPatches = 512;  // all patches are searched for, as no sources are known

// Every layer that the file has.
std::shared_ptr<const GuideSet> ReadAll(const std::string& file) {
  GuideReadOptions options;
  options.optional = OrStop(InspectGuides(file)).layers.at("");
  return std::make_shared<const GuideSet>(OrStop(ReadGuides(file, options)));
}

// A square part of a picture, or all of it.
struct Part {
  int x = 0, y = 0, side = 0;  // 0: all

  Picture Of(const Picture& whole) const {
    if (side == 0) return whole;
    Picture part(side, side);
    for (int v = 0; v < side; ++v) std::copy_n(whole.At(x, y + v), 4 * side, part.At(0, v));
    return part;
  }

  std::shared_ptr<const GuideSet> Of(const std::shared_ptr<const GuideSet>& whole) const {
    if (side == 0) return whole;
    auto part = std::make_shared<GuideSet>(side, side);
    for (const LayerInfo& info : AllLayers()) {
      if (!whole->Has(info.layer)) continue;
      part->AddUnset(info.layer);
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        const float* const from = whole->Plane(info.layer, c).data();
        for (int v = 0; v < side; ++v) {
          std::copy_n(from + whole->Index(x, y + v), side, part->Plane(info.layer, c).data() + part->Index(0, v));
        }
      }
    }
    part->attributes = whole->attributes, part->camera = whole->camera;
    if (whole->fragments) part->fragments = Of(*whole->fragments, *whole);
    return part;
  }

 private:
  std::shared_ptr<const Fragments> Of(const Fragments& all, const GuideSet& whole) const {
    auto part = std::make_shared<Fragments>();
    std::vector<std::size_t> kept;
    for (std::size_t f = 0; f < all.count(); ++f) {
      const int u = int(all.pixel[f]) % whole.width() - x, v = int(all.pixel[f]) / whole.width() - y;
      if (u < 0 || v < 0 || u >= side || v >= side) continue;
      kept.push_back(f);
      part->pixel.push_back(std::uint32_t(v * side + u));
    }
    part->values = GuideSet(int(kept.size()), 1);
    for (const LayerInfo& info : AllLayers()) {
      if (!all.values.Has(info.layer)) continue;
      part->values.AddUnset(info.layer);
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        for (std::size_t k = 0; k < kept.size(); ++k) {
          part->values.Plane(info.layer, c)[k] = all.values.Plane(info.layer, c)[kept[k]];
        }
      }
    }
    return part;
  }
};

void PrintFigures(const TradeReference& reference, const GuidedTexture& texture, const Part& part,
                  const std::string& file) {
  const Picture picture = part.Of(OrStop(ReadPicture(file)));
  TradeMeasure measure;
  EnergyOptions patches;
  patches.samples = kPatches;
  OrStop(reference.MeasurePaint(picture, nullptr, patches, measure));
  OrStop(reference.MeasureTexture(texture, picture, measure));
  const double outlines = OrStop(MeasureOutlines(picture, reference.guides())).error;
  const double with_outlines = measure.texture.value_or(NAN);
  const nlohmann::ordered_json line = {{"picture", file},
                                       {"both", measure.both.mean},
                                       {"energy", measure.energy.mean},
                                       {"missing", measure.missing.mean},
                                       {"texture", with_outlines},
                                       {"paint", with_outlines / (1.0 + kOutlinesInTexture * outlines)},
                                       {"outlines", outlines}};
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

void PrintAll(const std::string& style_folder, const std::string& guide_file, const Part& part, int count,
              char** files) {
  const auto guides = ReadAll(guide_file);
  Style style = OrStop(LoadStyle(style_folder, {}));
  style.paper = {};
  PreparedStyle prepared = OrStop(Prepare(style, guides->height()));
  const double exposure = MeasureExposure({&prepared, 1}, *guides).value_or(0.0);
  const TradeReference reference(part.Of(guides), std::move(prepared), exposure, 0);
  const GuidedTexture texture = OrStop(reference.Texture());
  for (int k = 0; k < count; ++k) PrintFigures(reference, texture, part, files[k]);
}

}  // namespace
}  // namespace scumble

int main(int argc, char** argv) {
  scumble::Part part;
  int first = 3;
  if (argc > 7 && std::string_view(argv[3]) == "--part") {
    part = {std::atoi(argv[4]), std::atoi(argv[5]), std::atoi(argv[6])};
    first = 7;
  }
  if (argc <= first) {
    std::fprintf(stderr, "usage: paint_figures STYLE GUIDES [--part X Y SIDE] PICTURE...\n");
    return 2;
  }
  scumble::PrintAll(argv[1], argv[2], part, argc - first, argv + first);
  return 0;
}
