// Bitmasks from vectors of floats. Included once for each set of vector instructions, after <hwy/highway.h>.
#if defined(SCUMBLE_FLOAT_MARKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCUMBLE_FLOAT_MARKS_INL_H_
#undef SCUMBLE_FLOAT_MARKS_INL_H_
#else
#define SCUMBLE_FLOAT_MARKS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes, so that any number of whole vectors makes a word.
const hn::CappedTag<float, 16> kFloat;
using F = hn::Vec<hn::CappedTag<float, 16>>;

// Bit i: lane i of a mask.
template <class Mask>
HWY_INLINE std::uint64_t BitsOf(const Mask& mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloat, mask, bytes);
  return unsigned(bytes[0] | bytes[1] << 8) & ((1u << hn::MaxLanes(kFloat)) - 1);
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
