// What tints that work on many pixels at once share: reading and writing texels, marks on lanes, and how a run of pixels is
// cut up. Included once for each instruction set, by Highway's rules.
#if defined(SCUMBLE_TRANSFER_TINT_BLOCKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCUMBLE_TRANSFER_TINT_BLOCKS_INL_H_
#undef SCUMBLE_TRANSFER_TINT_BLOCKS_INL_H_
#else
#define SCUMBLE_TRANSFER_TINT_BLOCKS_INL_H_
#endif

#include <hwy/highway.h>

#include "transfer/tint/srgb_encode-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;
using Mask = hn::Mask<Floats>;

// The channels of one vector of texels.
struct Codes {
  Int red, green, blue;
  hn::Vec<Words> alpha;  // in the upper half of each word; the lower means nothing

  explicit HWY_INLINE Codes(const std::uint16_t* HWY_RESTRICT texels) {
    const Words du;
    const Ints di;
    hn::Vec<Words> red_green, blue_alpha;
    hn::LoadInterleaved2(du, reinterpret_cast<const std::uint32_t*>(texels), red_green, blue_alpha);
    red = hn::And(hn::BitCast(di, red_green), hn::Set(di, 0xffff));
    green = hn::BitCast(di, hn::ShiftRight<16>(red_green));
    blue = hn::And(hn::BitCast(di, blue_alpha), hn::Set(di, 0xffff));
    alpha = blue_alpha;
  }
  // Writes others in their place; alpha stays.
  HWY_INLINE void Replace(Int new_red, Int new_green, Int new_blue, std::uint16_t* HWY_RESTRICT texels) const {
    const Words du;
    const auto red_green = hn::Or(hn::BitCast(du, new_red), hn::ShiftLeft<16>(hn::BitCast(du, new_green)));
    const auto blue_alpha = hn::Or(hn::BitCast(du, new_blue), hn::AndNot(hn::Set(du, 0xffff), alpha));
    hn::StoreInterleaved2(red_green, blue_alpha, du, reinterpret_cast<std::uint32_t*>(texels));
  }
};

constexpr std::size_t kBlock = 256;

// Which of up to kBlock pixels are marked. Vectors that were marked are looked through later, all at once: a processor that
// has to guess whether one has marks would guess wrong too often, and late.
class LaneMarks {
 public:
  // Of the vector whose first pixel is `at`, of up to 16 lanes.
  HWY_INLINE void Set(Floats d, std::size_t at, hn::Mask<Floats> mask) {
    std::uint8_t* bytes = bytes_ + 2 * (at / hn::Lanes(d));
    bytes[1] = 0;
    hn::StoreMaskBits(d, mask, bytes);
  }
  // Calls visit(i) for each marked one of the first `count` pixels, which are whole vectors that were all set.
  template <class Visit>
  HWY_INLINE void ForEach(Floats d, std::size_t count, const Visit& visit) const {
    const std::uint8_t* bytes = bytes_;
    for (std::size_t at = 0; at < count; at += hn::Lanes(d), bytes += 2) {
      std::uint32_t left = bytes[0] | std::uint32_t(bytes[1]) << 8;
      for (; left != 0; left &= left - 1) visit(at + hwy::Num0BitsBelowLS1Bit_Nonzero32(left));
    }
  }

 private:
  std::uint8_t bytes_[2 * kBlock + 8];  // storing a mask may ask for eight
};

// Calls block.Make(albedo, n, texels) for stretches of `count` pixels, of whole vectors and at most kBlock each; what is
// left at the end is made in a copy, filled up with the last one's albedo.
template <class Block>
HWY_INLINE void ForEachBlock(Block&& block, const float* const* albedo, std::size_t count, std::uint16_t* texels) {
  const std::size_t lanes = hn::Lanes(Floats()), whole = count - count % lanes, left = count - whole;
  for (std::size_t from = 0; from < whole; from += kBlock) {
    const float* const planes[3] = {albedo[0] + from, albedo[1] + from, albedo[2] + from};
    block.Make(planes, std::min(kBlock, whole - from), texels + 4 * from);
  }
  if (left == 0) return;
  float rest[3][16];
  std::uint16_t last[4 * 16] = {};
  for (int c = 0; c < 3; ++c) {
    std::fill_n(rest[c], 16, albedo[c][count - 1]);
    std::copy_n(albedo[c] + whole, left, rest[c]);
  }
  std::copy_n(texels + 4 * whole, 4 * left, last);
  const float* const planes[3] = {rest[0], rest[1], rest[2]};
  block.Make(planes, lanes, last);
  std::copy_n(last, 4 * left, texels + 4 * whole);
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#endif
