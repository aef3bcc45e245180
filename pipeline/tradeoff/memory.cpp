#include "pipeline/tradeoff/memory.h"

#include "pipeline/memory_estimate.h"
#include "transfer/prepared_exemplar.h"

namespace scumble {
namespace {

// Of a pixel of picture and exemplars: TradeReference, measure/energy.h.
constexpr std::uint64_t kReference = 100, kEnergy = 250;
constexpr std::uint64_t kPng = 4;   // of a pixel, of which no compression makes less
constexpr std::uint64_t kPage = 4;  // of a byte of a PNG: in Base64 it is 4/3, and text that grows is there three times
constexpr std::uint64_t kPaint = 8;                  // of a pixel of a Picture
constexpr std::uint64_t kCell = 4, kTreePoint = 32;  // of a look-up table, and of the tree that it is filled by

}  // namespace

// What the energy looks at.
std::uint64_t TradeMemory::Places() const {
  std::uint64_t places = Pixels();
  const TransferSettings& settings = stage_.style.transfer;
  for (const Exemplar& exemplar : stage_.style.exemplars) {
    const auto side = [&](int length) {
      return std::uint64_t(ScaledSize(length, settings.scale, settings.reference_height, stage_.height));
    };
    places += side(exemplar.picture.width) * side(exemplar.picture.height);
  }
  return places;
}

void TradeMemory::AddReport(std::size_t variants, MemoryNeed& need) const {
  const Size size{stage_.width, stage_.height};
  AddPicture({{&stage_.style, 1}, false, size, stage_.scene.layers, false, true, context_.threads}, {}, need);
  const std::uint64_t pictures = kPng * Pixels() * variants;
  need.Take("reference", kReference * Places());
  need.Take("pictures of all variants", pictures);
  if (setup_.writes) need.TakeTransient("page", kPage * pictures);
}

void TradeMemory::AddVariant(const Variant& variant, const Style& style, const LayerSet& layers, bool own_guides,
                             MemoryNeed& need) const {
  const int super = SupersampleOf(variant), up = GuideFactorOf(variant), scaled = PictureFactorOf(variant);
  const Size size{stage_.width * super / scaled, stage_.height * super / scaled};  // as it is painted
  if (own_guides) AddGuides(size, layers, setup_.scene, need);
  if (scaled > 1) AddGuides({stage_.width, stage_.height}, layers, setup_.scene, need);  // for comparing them
  if (own_guides && up > 1) AddGuides({size.width / up, size.height / up}, layers, setup_.scene, need);
  AddPicture({{&style, 1}, false, size, layers, false, true, context_.threads}, {}, need);
  if (super > 1 || scaled > 1) need.Take("picture", kPaint * Pixels());  // averaged, or scaled up
  if (style.transfer.nearest == NearestSearch::kTable) {
    need.Take("exemplars", kCell * std::uint64_t(variant.table_resolution) * std::uint64_t(variant.table_resolution));
    need.TakeTransient("preparing exemplars", kTreePoint * Places());
  }
  need.TakeTransient("energy", kEnergy * Places());
}

}  // namespace scumble
