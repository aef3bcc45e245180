#include "transfer/vote/chunk_masks.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/chunk_masks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SCUMBLE_CHUNK_MASKS_ONCE
#define SCUMBLE_CHUNK_MASKS_ONCE
namespace scumble::internal {

// One row of a picture, from its column 0 on.
struct ChunkRow {
  const std::int16_t* x;
  const std::int16_t* y;
  const std::uint8_t* exemplar;  // null: there is only one
  const std::uint8_t* active;
  int width;
  bool last;              // no row below
  std::int64_t readable;  // values from column 0 to the end of the plane
  int size;               // of the exemplar; 0: no pixel is interior
  int radius;
  std::int64_t limit;  // (|2x + 1 - size| + 2·radius)² + the same of y must not be beyond it
};

// Bit i of the word of columns [begin, begin + 64), which are in the picture: whether mark(column).
template <class Mark>
std::uint64_t MarksOneByOne(const ChunkRow& row, int begin, const Mark& mark) {
  std::uint64_t bits = 0;
  for (int i = 0; i < std::min(64, row.width - begin); ++i) bits |= std::uint64_t(mark(begin + i) ? 1 : 0) << i;
  return bits;
}

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

const hn::ScalableTag<std::int16_t> kShort;
const hn::ScalableTag<std::uint8_t> kByte;

// `lanes` bits of a mask.
template <class D, class Mask>
HWY_INLINE std::uint64_t Bits(D d, const Mask& mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::uint64_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return hn::Lanes(d) < 64 ? bits & ((std::uint64_t{1} << (hn::Lanes(d) & 63)) - 1) : bits;
}

// A vector of columns is only loaded where this many lanes make whole vectors of a word.
HWY_INLINE bool Fits(const ChunkRow& row, int begin) {
  return hn::Lanes(kByte) <= 64 && hn::Lanes(kByte) > 1 && row.width - begin >= 64 && row.readable - begin >= 65;
}

void ActiveRow(const ChunkRow& row, int first_word, int words, std::uint64_t* active) {
  for (int w = 0; w < words; ++w) {
    const int begin = 64 * (first_word + w);
    active[w] = 0;
    if (begin < 0 || begin >= row.width) continue;
    if (!Fits(row, begin)) {
      active[w] = MarksOneByOne(row, begin, [&](int x) { return row.active[x] != 0; });
      continue;
    }
    for (int i = 0; i < 64; i += int(hn::Lanes(kByte))) {
      active[w] |= Bits(kByte, hn::Ne(hn::LoadU(kByte, row.active + begin + i), hn::Zero(kByte))) << i;
    }
  }
}

// Bit i: the exemplar there is the one `step` values further on.
HWY_INLINE std::uint64_t OneExemplar(const ChunkRow& row, int begin, std::ptrdiff_t step) {
  if (!row.exemplar) return BitMaskRows::kAll;
  std::uint64_t bits = 0;
  for (int i = 0; i < 64; i += int(hn::Lanes(kByte))) {
    const std::uint8_t* at = row.exemplar + begin + i;
    bits |= Bits(kByte, hn::Eq(hn::LoadU(kByte, at), hn::LoadU(kByte, at + step))) << i;
  }
  return bits;
}

HWY_INLINE std::uint64_t Interior(const ChunkRow& row, int begin) {
  const hn::ScalableTag<std::int32_t> wide;
  const hn::Rebind<std::int16_t, decltype(wide)> narrow;
  const auto size = hn::Set(wide, row.size - 1), reach = hn::Set(wide, 2 * row.radius);
  const auto limit = hn::Set(wide, static_cast<std::int32_t>(std::min<std::int64_t>(row.limit, 0x7fffffff)));
  const auto squared = [&](const std::int16_t* at) HWY_ATTR {
    const auto value = hn::PromoteTo(wide, hn::LoadU(narrow, at));
    const auto length = hn::Add(hn::Abs(hn::Sub(hn::Add(value, value), size)), reach);
    return hn::Mul(length, length);
  };
  std::uint64_t bits = 0;
  for (int i = 0; i < 64; i += int(hn::Lanes(wide))) {
    const auto sum = hn::Add(squared(row.x + begin + i), squared(row.y + begin + i));
    bits |= Bits(wide, hn::Not(hn::Gt(sum, limit))) << i;
  }
  return bits;
}

void LinkRow(const ChunkRow& row, int first_word, int words, const std::uint64_t* active,
             const std::uint64_t* active_below, std::uint64_t* right, std::uint64_t* below, std::uint64_t* interior) {
  for (int w = 0; w < words; ++w) {
    const int begin = 64 * (first_word + w);
    if (begin < 0 || begin >= row.width) continue;
    const std::uint64_t beyond = ~BitRange(0, row.width - begin), at_end = ~BitRange(0, row.width - 1 - begin);
    right[w] = at_end, below[w] = row.last ? BitMaskRows::kAll : beyond, interior[w] = 0;
    if (!active[w]) continue;
    if (!Fits(row, begin)) {
      const auto one = [&](int x, std::ptrdiff_t step, int dx, int dy) {
        return row.x[x + step] - row.x[x] == dx && row.y[x + step] - row.y[x] == dy && row.active[x] &&
               row.active[x + step] && (!row.exemplar || row.exemplar[x] == row.exemplar[x + step]);
      };
      right[w] |= MarksOneByOne(row, begin, [&](int x) { return x + 1 < row.width && one(x, 1, 1, 0); });
      if (!row.last) below[w] |= MarksOneByOne(row, begin, [&](int x) { return one(x, row.width, 0, 1); });
      if (row.size == 0) continue;
      interior[w] = active[w] & MarksOneByOne(row, begin, [&](int x) {
                      const std::int64_t dx = std::abs(2 * row.x[x] + 1 - row.size) + 2 * row.radius;
                      const std::int64_t dy = std::abs(2 * row.y[x] + 1 - row.size) + 2 * row.radius;
                      return dx * dx + dy * dy <= row.limit;
                    });
      continue;
    }
    const auto one = hn::Set(kShort, 1);
    std::uint64_t same_right = 0, same_below = 0;
    for (int i = 0; i < 64; i += int(hn::Lanes(kShort))) {
      const std::int16_t *x = row.x + begin + i, *y = row.y + begin + i;
      const auto here_x = hn::LoadU(kShort, x), here_y = hn::LoadU(kShort, y);
      const auto next_x = hn::LoadU(kShort, x + 1), next_y = hn::LoadU(kShort, y + 1);
      same_right |= Bits(kShort, hn::And(hn::Eq(hn::Sub(next_x, here_x), one), hn::Eq(next_y, here_y))) << i;
      if (row.last) continue;
      const auto low_x = hn::LoadU(kShort, x + row.width), low_y = hn::LoadU(kShort, y + row.width);
      same_below |= Bits(kShort, hn::And(hn::Eq(low_x, here_x), hn::Eq(hn::Sub(low_y, here_y), one))) << i;
    }
    const std::uint64_t active_right = active[w] >> 1 | active[w + 1] << 63;
    right[w] |= same_right & active[w] & active_right & OneExemplar(row, begin, 1);
    if (!row.last) below[w] |= same_below & active[w] & active_below[w] & OneExemplar(row, begin, row.width);
    if (row.size > 0) interior[w] = active[w] & Interior(row, begin);
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(ActiveRow);
HWY_EXPORT(LinkRow);

namespace {

// Without an exemplar, LinkRow's values of it are unset.
ChunkRow RowAt(const SourceField& field, std::span<const std::uint8_t> active, const PreparedExemplar* exemplar,
               int radius, int y) {
  const std::size_t begin = field.Index(0, y);
  ChunkRow row{field.x.data() + begin,
               field.y.data() + begin,
               nullptr,
               active.data() + begin,
               field.width,
               y + 1 == field.height,
               std::int64_t(active.size() - begin),
               0,
               radius,
               0};
  if (!exemplar) return row;
  if (exemplar->count() > 1) row.exemplar = field.exemplar.data() + begin;
  if (exemplar->is_sphere()) row.size = exemplar->size(), row.limit = exemplar->usable_limit();
  return row;
}

}  // namespace

void MaskActive(const SourceField& field, std::span<const std::uint8_t> active, const MaskedTile& tile,
                BitMaskRows& marks) {
  marks.Reset(tile, 0);
  const int first = std::max(0, tile.first_row), end = std::min(field.height, tile.first_row + tile.rows);
  for (int y = first; y < end; ++y) {
    HWY_DYNAMIC_DISPATCH(ActiveRow)
    (RowAt(field, active, nullptr, 0, y), tile.first_word, tile.words, marks.Row(y));
  }
}

bool MarkChunks(const SourceField& field, std::span<const std::uint8_t> active, const PreparedExemplar& exemplar,
                int radius, const MaskedTile& tile, ChunkMasks& marks) {
  MaskActive(field, active, tile, marks.active);
  const int first = std::max(0, tile.first_row), last = std::min(field.height, tile.first_row + tile.rows) - 1;
  const auto any = [&](int y) {
    const std::uint64_t* row = marks.active.Row(y);
    return std::any_of(row, row + tile.words, [](std::uint64_t bits) { return bits != 0; });
  };
  bool some = false;
  for (int y = first; y <= last && !some; ++y) some = any(y);
  if (!some) return false;
  marks.right.Reset(tile, BitMaskRows::kAll);
  marks.below.Reset(tile, BitMaskRows::kAll);
  marks.interior.Reset(tile, 0);
  for (int y = first; y <= last; ++y) {
    ChunkRow row = RowAt(field, active, &exemplar, radius, y);
    const std::uint64_t* below = nullptr;
    if (y < last) {
      below = marks.active.Row(y + 1);
    } else if (!row.last) {
      row.last = true;  // links to rows below the tile are not needed
    }
    HWY_DYNAMIC_DISPATCH(LinkRow)
    (row, tile.first_word, tile.words, marks.active.Row(y), below, marks.right.Row(y), marks.below.Row(y),
     marks.interior.Row(y));
  }
  return true;
}

}  // namespace scumble::internal
#endif
