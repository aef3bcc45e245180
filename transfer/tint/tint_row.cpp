#include "transfer/tint/tint_row.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/tint/tint_row.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

#include "transfer/tint/tint-inl.h"

constexpr std::size_t kMostLanes = 16;
constexpr std::size_t kVectors = 16;  // pixels of a row that are tinted together

HWY_INLINE LaneColor Load(const float* const* planes, std::size_t i) {
  const Floats d;
  return {hn::LoadU(d, planes[0] + i), hn::LoadU(d, planes[1] + i), hn::LoadU(d, planes[2] + i)};
}

HWY_INLINE bool Same(LaneColor a, LaneColor b) {
  return All(hn::And(hn::And(hn::Eq(a.r.v, b.r.v), hn::Eq(a.g.v, b.g.v)), hn::Eq(a.b.v, b.b.v)));
}

// Sets a tint's albedo where it differs from the last one.
template <class AnyTint>
class Scene {
 public:
  explicit Scene(const Tint& tint) : tint_(tint) { tint_.SetAlbedo(albedo_); }

  HWY_INLINE const AnyTint& Of(LaneColor albedo) {
    if (HWY_UNLIKELY(!Same(albedo, albedo_))) tint_.SetAlbedo(albedo_ = albedo);
    return tint_;
  }

 private:
  LaneColor albedo_{0.0f, 0.0f, 0.0f};
  AnyTint tint_;
};

void TintBlock(Scene<MultiplyingTint>& scene, const float* const* albedo, std::size_t count, std::uint16_t* texels) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
    StoreTexels(scene.Of(Load(albedo, i)).Tinted(LoadTexels(texels + 4 * i)), texels + 4 * i);
  }
}

void TintBlock(Scene<OklabTint>& scene, const float* const* albedo, std::size_t count, std::uint16_t* texels) {
  const std::size_t lanes = hn::Lanes(Floats());
  LaneColor colors[kVectors];
  LaneColor* const end = colors + count / lanes;
  std::size_t i = 0;
  for (LaneColor* color = colors; color < end; ++color, i += lanes)
    *color = OklabTint::RootsOfPaint(LoadTexels(texels + 4 * i));
  i = 0;
  for (LaneColor* color = colors; color < end; ++color, i += lanes) *color = scene.Of(Load(albedo, i)).Linear(*color);
  i = 0;
  for (LaneColor* color = colors; color < end; ++color, i += lanes)
    StoreTexels(OklabTint::Encoded(*color), texels + 4 * i);
}

// Blocks of whole vectors; the rest of a row is tinted in a copy.
template <class AnyTint>
void TintBlocks(const Tint& tint, const float* const* albedo, std::size_t count, std::uint16_t* texels) {
  Scene<AnyTint> scene(tint);
  const std::size_t lanes = hn::Lanes(Floats()), left = count % lanes, whole = count - left;
  const std::size_t block = kVectors * lanes;
  for (std::size_t from = 0; from < whole; from += block) {
    const float* const planes[3] = {albedo[0] + from, albedo[1] + from, albedo[2] + from};
    TintBlock(scene, planes, std::min(block, whole - from), texels + 4 * from);
  }
  if (left == 0) return;
  float rest[3][kMostLanes] = {};
  std::uint16_t last[4 * kMostLanes] = {};
  for (int c = 0; c < 3; ++c) std::copy_n(albedo[c] + whole, left, rest[c]);
  std::copy_n(texels + 4 * whole, 4 * left, last);
  const float* const planes[3] = {rest[0], rest[1], rest[2]};
  TintBlock(scene, planes, lanes, last);
  std::copy_n(last, 4 * left, texels + 4 * whole);
}

void TintRowHere(const Tint& tint, const float* const* albedo, std::size_t count, std::uint16_t* texels) {
  if (tint.mode == ColorizeMode::kMultiply)
    TintBlocks<MultiplyingTint>(tint, albedo, count, texels);
  else
    TintBlocks<OklabTint>(tint, albedo, count, texels);
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(TintRowHere);

void TintRow(const Tint& tint, const float* const albedo[3], std::size_t count, std::uint16_t* texels) {
  HWY_DYNAMIC_DISPATCH(TintRowHere)(tint, albedo, count, texels);
}

}  // namespace scumble::internal
#endif
