#include "transfer/vote/edge/edge_masks.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "transfer/vote/edge/small_window_bounds.h"
#include "transfer/vote/edge/edge_row.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/edge/edge_masks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/field/mask_lanes-inl.h"

#ifndef SCUMBLE_EDGE_MARKS_ONCE
#define SCUMBLE_EDGE_MARKS_ONCE
namespace scumble::internal {

// Lanes that are within [begin, end) of what `from` points to; 0 for the others.
inline const float* CopyInside(const float* from, std::int64_t begin, std::int64_t end, int lanes, float* copy) {
  for (int i = 0; i < lanes; ++i) copy[i] = i >= begin && i < end ? from[i] : 0.0f;
  return copy;
}

struct EdgePair {
  EdgeRow here, there;
  int dx = 0, dy = 0;
  int width = 0;
  float crease_cosine = 0;
  DepthGive give;
  // Words of a row: pixels to test, and those of which only the normals are in question; others keep their marks.
  const std::uint64_t* asked = nullptr;
  const std::uint64_t* creases = nullptr;
  std::uint64_t* same = nullptr;
};

// What is left to test of a step, by words of a row: pixels that are asked for themselves or for the one `dx` to the
// right in the row `there`, and for which it is not sure.
struct EdgeSplit {
  const std::uint64_t* here;
  const std::uint64_t* there;  // with a word more on either side
  const std::uint64_t* level;
  const std::uint64_t* sure;
  std::uint64_t* full;
  std::uint64_t* creases;
  std::uint64_t* same;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Depth where coverage is above 0, NaN elsewhere. One of the two tells coverage. What is `below` values further on is
// wanted next.
void DepthRow(const float* depth, const float* coverage, const std::uint8_t* covered, std::size_t count,
              std::size_t below, float* out) {
  const hn::Rebind<std::uint8_t, decltype(kFloat)> byte;
  const hn::RebindToUnsigned<decltype(kFloat)> word;
  const F none = hn::Set(kFloat, std::numeric_limits<float>::quiet_NaN());
  std::size_t i = 0;
  for (; i + hn::Lanes(kFloat) <= count; i += hn::Lanes(kFloat)) {
    hwy::Prefetch(depth + below + i);
    const auto there =
        covered ? hn::RebindMask(kFloat, hn::Ne(hn::PromoteTo(word, hn::LoadU(byte, covered + i)), hn::Zero(word)))
                : hn::Gt(hn::LoadU(kFloat, coverage + i), hn::Zero(kFloat));
    hn::StoreU(hn::IfThenElse(there, hn::LoadU(kFloat, depth + i), none), kFloat, out + i);
  }
  for (; i < count; ++i) {
    out[i] = (covered ? covered[i] != 0 : coverage[i] > 0.0f) ? depth[i] : std::numeric_limits<float>::quiet_NaN();
  }
}

HWY_INLINE F Slope(F before, F here, F after) {
  const F back = hn::Sub(here, before), front = hn::Sub(after, here);
  const F gentler = hn::IfThenElse(hn::Lt(hn::Abs(back), hn::Abs(front)), back, front);
  return hn::IfThenElseZero(hn::Gt(hn::Mul(back, front), hn::Zero(kFloat)), gentler);
}

// Of 64 pixels: slopes to their neighbours in the row, and to those above and below.
void SlopeWord(const float* above, const float* here, const float* below, float* slope_x, float* slope_y) {
  for (std::size_t i = 0; i < 64; i += hn::Lanes(kFloat)) {
    const F middle = hn::LoadU(kFloat, here + i);
    hn::StoreU(Slope(hn::LoadU(kFloat, here + i - 1), middle, hn::LoadU(kFloat, here + i + 1)), kFloat, slope_x + i);
    hn::StoreU(Slope(hn::LoadU(kFloat, above + i), middle, hn::LoadU(kFloat, below + i)), kFloat, slope_y + i);
  }
}

// As std::min has it.
HWY_INLINE F Least(F a, F b) { return hn::IfThenElse(hn::Lt(b, a), b, a); }

// A word of a row, of which `asked` marks what is asked for: bit i, whether that pixel and the one a step further on
// are the same surface.
HWY_INLINE std::uint64_t TestWord(const EdgePair& pair, int word, std::uint64_t asked) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const std::uint64_t whole = lanes < 64 ? (std::uint64_t{1} << lanes) - 1 : ~std::uint64_t{0};
  const float x = static_cast<float>(pair.dx), y = static_cast<float>(pair.dy);
  const F step_x = hn::Set(kFloat, x), step_y = hn::Set(kFloat, y), half = hn::Set(kFloat, 0.5f);
  const F far_x = hn::Set(kFloat, std::abs(x)), far_y = hn::Set(kFloat, std::abs(y));
  const F share = hn::Set(kFloat, pair.give.share), fixed = hn::Set(kFloat, pair.give.fixed);
  const F crease = hn::Set(kFloat, pair.crease_cosine);
  const EdgeRow &p = pair.here, &q = pair.there;
  std::uint64_t bits = 0;
  for (int i = 0; i < 64; i += lanes) {
    if (!(asked >> i & whole)) continue;
    const int a = 64 * word + i, b = a + pair.dx;
    if (a >= pair.width) break;
    const F depth_p = hn::LoadU(kFloat, p.depth + a), depth_q = hn::LoadU(kFloat, q.depth + b);
    const F slope_px = hn::LoadU(kFloat, p.slope_x + a), slope_qx = hn::LoadU(kFloat, q.slope_x + b);
    const F slope_py = hn::LoadU(kFloat, p.slope_y + a), slope_qy = hn::LoadU(kFloat, q.slope_y + b);
    const F expected = hn::Mul(
        half, hn::Add(hn::Mul(hn::Add(slope_px, slope_qx), step_x), hn::Mul(hn::Add(slope_py, slope_qy), step_y)));
    const F leeway = hn::Add(hn::Mul(Least(hn::Abs(slope_px), hn::Abs(slope_qx)), far_x),
                             hn::Mul(Least(hn::Abs(slope_py), hn::Abs(slope_qy)), far_y));
    const F most = hn::Add(leeway, hn::Add(fixed, hn::Mul(share, Least(depth_p, depth_q))));
    auto one = hn::Le(hn::Abs(hn::Sub(hn::Sub(depth_q, depth_p), expected)), most);
    // Guides of the last and first pixels of the picture would be read beyond their ends.
    const bool inside = a >= -p.before && b >= -q.before && a + lanes <= p.readable && b + lanes <= q.readable;
    const float* guide_p[4] = {p.object + a, p.normal[0] + a, p.normal[1] + a, p.normal[2] + a};
    const float* guide_q[4] = {q.object + b, q.normal[0] + b, q.normal[1] + b, q.normal[2] + b};
    float copies[8][16];
    if (HWY_UNLIKELY(!inside)) {
      for (int k = 0; k < 4; ++k) {
        guide_p[k] = CopyInside(guide_p[k], -p.before - a, p.readable - a, lanes, copies[k]);
        guide_q[k] = CopyInside(guide_q[k], -q.before - b, q.readable - b, lanes, copies[4 + k]);
      }
    }
    one = hn::And(one, hn::Eq(hn::LoadU(kFloat, guide_p[0]), hn::LoadU(kFloat, guide_q[0])));
    const auto product = [&](int k)
                             HWY_ATTR { return hn::Mul(hn::LoadU(kFloat, guide_p[k]), hn::LoadU(kFloat, guide_q[k])); };
    const F along = product(1), across = product(2), forth = product(3);
    one = hn::And(one, hn::Gt(hn::Add(hn::Add(along, across), forth), crease));
    bits |= BitsOf(one) << i;
  }
  return bits & asked;
}

// The same for all steps of a word, where objects and depths are known to pass. Only calm pixels (calm_marks.h) are
// asked for, which stand so far from the ends of the guides that vectors do not reach beyond.
HWY_INLINE void TestCreases(const EdgePair* pairs, std::size_t count, int first_word, int w) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const std::uint64_t whole = lanes < 64 ? (std::uint64_t{1} << lanes) - 1 : ~std::uint64_t{0};
  const F crease = hn::Set(kFloat, pairs->crease_cosine);
  const float* const* here = pairs->here.normal;
  std::uint64_t asked = 0;
  for (std::size_t k = 0; k < count; ++k) asked |= pairs[k].creases[w];
  for (int i = 0; i < 64; i += lanes) {
    if (!(asked >> i & whole)) continue;
    const int a = 64 * (first_word + w) + i;
    const F x = hn::LoadU(kFloat, here[0] + a), y = hn::LoadU(kFloat, here[1] + a), z = hn::LoadU(kFloat, here[2] + a);
    for (const EdgePair* pair = pairs; pair != pairs + count; ++pair) {
      const std::uint64_t bits = pair->creases[w] & whole << i;
      if (!bits) continue;
      const float* const* there = pair->there.normal;
      const int b = a + pair->dx;
      const F along = hn::Mul(x, hn::LoadU(kFloat, there[0] + b)), across = hn::Mul(y, hn::LoadU(kFloat, there[1] + b));
      const F forth = hn::Mul(z, hn::LoadU(kFloat, there[2] + b));
      pair->same[w] |= BitsOf(hn::Gt(hn::Add(hn::Add(along, across), forth), crease)) << i & bits;
    }
  }
}

// All steps of a word before the next word, so that what they read stays in the nearest cache.
void TestRow(const EdgePair* pairs, std::size_t count, int first_word, int words) {
  for (int w = 0; w < words; ++w) {
    for (std::size_t k = 0; k < count; ++k) {
      if (pairs[k].asked[w]) pairs[k].same[w] |= TestWord(pairs[k], first_word + w, pairs[k].asked[w]);
    }
    TestCreases(pairs, count, first_word, w);
  }
}

// The words moved by dx: bit i is that of column i + dx.
template <class D>
HWY_INLINE hn::Vec<D> Moved(D d, const std::uint64_t* at, int dx) {
  const auto here = hn::LoadU(d, at);
  if (dx == 0) return here;
  if (dx > 0) return hn::Or(hn::ShiftRightSame(here, dx), hn::ShiftLeftSame(hn::LoadU(d, at + 1), 64 - dx));
  return hn::Or(hn::ShiftLeftSame(here, -dx), hn::ShiftRightSame(hn::LoadU(d, at - 1), 64 + dx));
}

template <class D>
HWY_INLINE hn::Vec<D> SplitWords(D d, const EdgeSplit& split, std::size_t w, int dx) {
  const auto sure = hn::LoadU(d, split.sure + w), level = hn::LoadU(d, split.level + w);
  const auto left = hn::AndNot(sure, hn::Or(hn::LoadU(d, split.here + w), Moved(d, split.there + w, dx)));
  hn::StoreU(hn::AndNot(level, left), d, split.full + w);
  hn::StoreU(hn::And(level, left), d, split.creases + w);
  hn::StoreU(sure, d, split.same + w);
  return left;
}

// Marks start as what is sure. True: something is left.
bool SplitRow(const EdgeSplit& split, std::size_t words, int dx) {
  const hn::ScalableTag<std::uint64_t> d;
  const hn::CappedTag<std::uint64_t, 1> single;
  auto any = hn::Zero(d);
  std::size_t w = 0;
  for (; w + hn::Lanes(d) <= words; w += hn::Lanes(d)) any = hn::Or(any, SplitWords(d, split, w, dx));
  auto last = hn::Zero(single);
  for (; w < words; ++w) last = hn::Or(last, SplitWords(single, split, w, dx));
  return hn::GetLane(last) != 0 || !hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(DepthRow);
HWY_EXPORT(SlopeWord);
HWY_EXPORT(SplitRow);
HWY_EXPORT(TestRow);

std::vector<PixelStep> ForwardSteps(int radius) {
  std::vector<PixelStep> steps;
  for (int dy = 0; dy <= radius; ++dy) {
    for (int dx = dy == 0 ? 1 : -radius; dx <= radius; ++dx) steps.push_back({dx, dy});
  }
  return steps;
}

namespace {

// As many rows of floats as are looked at together; a later row takes the place of one that is done with.
class PassingRows {
 public:
  PassingRows(int rows, int first_word, int words, float fill)
      : rows_(rows),
        first_column_(64 * (first_word - 1)),
        stride_(64 * std::size_t(words + 2)),
        values_(rows * stride_, fill) {}
  // From column 0 of the picture; the tile's columns and 64 more on either side are there.
  float* Row(int y) { return values_.data() + std::size_t((y + rows_) % rows_) * stride_ - first_column_; }
  void Fill(int y, float value) {
    float* row = Row(y) + first_column_;
    std::fill(row, row + stride_, value);
  }

 private:
  int rows_, first_column_;
  std::size_t stride_;
  std::vector<float> values_;
};

// The marks of all pixels at most `reach` away.
void Dilate(const MarkedTile& tile, const BitRows& marks, int reach, BitRows& out) {
  out.Reset(tile.first_row, tile.rows, tile.first_word, tile.words, 0);
  std::vector<std::uint64_t> wide(std::size_t(tile.words));
  for (int y = 0; y < tile.rows; ++y) {
    const std::uint64_t* row = marks.Row(tile.first_row + y);
    for (int w = 0; w < tile.words; ++w) {
      std::uint64_t bits = row[w];
      for (int dx = 1; dx <= reach; ++dx) {
        bits |= row[w] << dx | row[w - 1] >> (64 - dx) | row[w] >> dx | row[w + 1] << (64 - dx);
      }
      wide[std::size_t(w)] = bits;
    }
    for (int v = std::max(0, y - reach); v <= std::min(tile.rows - 1, y + reach); ++v) {
      std::uint64_t* to = out.Row(tile.first_row + v);
      for (int w = 0; w < tile.words; ++w) to[w] |= wide[std::size_t(w)];
    }
  }
}

// Makes depths and the marks of calm pixels as rows are come to, slopes when they are asked for.
class EdgeRows {
 public:
  EdgeRows(const EdgeRules& rules, int radius, const MarkedTile& tile, const BitRows& centres)
      : rules_(rules),
        radius_(radius),
        tile_(tile),
        calm_(rules, radius, tile),
        depth_(radius + 3, tile.first_word, tile.words, std::numeric_limits<float>::quiet_NaN()),
        slope_x_(radius + 1, tile.first_word, tile.words, 0.0f),
        slope_y_(radius + 1, tile.first_word, tile.words, 0.0f),
        blocks_(std::size_t(tile.rows) * tile.words),
        busy_(std::size_t(tile.rows)),
        wanted_(std::size_t(tile.words)),
        sloped_(std::size_t(radius + 1) * tile.words),
        next_depth_(tile.first_row - 1),
        next_row_(tile.first_row) {
    for (int y = 0; y < tile.rows; ++y) MarkBlocks(centres.Row(tile.first_row + y), y);
  }

  // Depths and calm pixels are there up to row y.
  void Reach(int y) {
    for (; next_row_ <= y; ++next_row_) {
      for (; next_depth_ <= next_row_ + 1; ++next_depth_) MakeDepth(next_depth_);
      std::fill_n(sloped_.begin() + SlopedAt(next_row_), tile_.words, std::uint8_t{0});
      if (next_row_ > 0 && next_row_ + 1 < rules_.guides.height() && Want(next_row_, radius_)) {
        calm_.Add(next_row_, {depth_.Row(next_row_ - 1), At(next_row_), At(next_row_ + 1), rules_.guides.width()},
                  wanted_.data());
      } else {
        calm_.AddNothing(next_row_);
      }
    }
  }

  CalmMarks& calm() { return calm_; }

  // Whether a centre stands at most `radius` rows away.
  bool Busy(int y) const {
    const int first = std::max(0, y - radius_ - tile_.first_row),
              last = std::min(tile_.rows - 1, y + radius_ - tile_.first_row);
    return std::any_of(busy_.begin() + first, busy_.begin() + last + 1, [](std::uint8_t busy) { return busy != 0; });
  }

  // Slopes are there for the marked columns of a word moved by dx.
  void Slopes(int y, int word, int dx, std::uint64_t marked) {
    if (dx < 0 ? marked >> -dx : marked << dx) SlopesOf(y, word);
    if (dx < 0 && marked << (64 + dx)) SlopesOf(y, word - 1);
    if (dx > 0 && marked >> (64 - dx)) SlopesOf(y, word + 1);
  }

  // Of a row of the picture.
  EdgeRow At(int y) {
    const GuideSet& guides = rules_.guides;
    const std::size_t begin = guides.Index(0, y);
    const auto plane = [&](Layer layer, int channel) { return guides.Plane(layer, channel).data() + begin; };
    return {depth_.Row(y),
            slope_x_.Row(y),
            slope_y_.Row(y),
            plane(Layer::kObject, 0),
            {plane(Layer::kNormal, 0), plane(Layer::kNormal, 1), plane(Layer::kNormal, 2)},
            static_cast<std::int64_t>(begin),
            static_cast<std::int64_t>(guides.pixel_count() - begin)};
  }

 private:
  void MarkBlocks(const std::uint64_t* centres, int row) {
    std::uint8_t* blocks = blocks_.data() + std::size_t(row) * tile_.words;
    for (int w = 0; w < tile_.words; ++w) {
      const std::uint64_t here = centres[w];
      const std::uint64_t wide = here | here << radius_ | here >> radius_ | centres[w - 1] >> (64 - radius_) |
                                 centres[w + 1] << (64 - radius_);
      if (!wide) continue;
      const auto block = [&](int b) { return unsigned((wide >> 16 * b & 0xffff) != 0) << b; };
      blocks[w] = static_cast<std::uint8_t>(block(0) | block(1) | block(2) | block(3));
      busy_[std::size_t(row)] = 1;
    }
  }

  // The same of centres at most `reach` rows away, in wanted_. False: there are none.
  bool Want(int y, int reach) {
    std::fill(wanted_.begin(), wanted_.end(), std::uint8_t{0});
    const int first = std::max(0, y - reach - tile_.first_row),
              last = std::min(tile_.rows - 1, y + reach - tile_.first_row);
    for (int v = first; v <= last; ++v) {
      const std::uint8_t* blocks = blocks_.data() + std::size_t(v) * tile_.words;
      for (std::size_t w = 0; w < wanted_.size(); ++w) wanted_[w] |= blocks[w];
    }
    return std::any_of(busy_.begin() + first, busy_.begin() + last + 1, [](std::uint8_t busy) { return busy != 0; });
  }

  std::ptrdiff_t SlopedAt(int y) const { return std::ptrdiff_t(y + radius_ + 1) % (radius_ + 1) * tile_.words; }

  void SlopesOf(int y, int word) {
    std::uint8_t& sloped = sloped_[std::size_t(SlopedAt(y) + word - tile_.first_word)];
    if (sloped) return;
    sloped = 1;
    const int x = 64 * word;
    HWY_DYNAMIC_DISPATCH(SlopeWord)
    (depth_.Row(y - 1) + x, depth_.Row(y) + x, depth_.Row(y + 1) + x, slope_x_.Row(y) + x, slope_y_.Row(y) + x);
  }

  // Of all words of which slopes may be asked for, and of a column more on either side.
  void MakeDepth(int y) {
    const GuideSet& guides = rules_.guides;
    if (y < 0 || y >= guides.height()) {
      depth_.Fill(y, std::numeric_limits<float>::quiet_NaN());
      return;
    }
    if (!Want(y, radius_ + 1)) return;
    for (int w = 0, end; w < tile_.words; w = end) {
      for (end = w + 1; wanted_[w] && end < tile_.words && wanted_[end];) ++end;
      if (!wanted_[w]) continue;
      const int x0 = std::max(0, 64 * (tile_.first_word + w) - 1);
      const int x1 = std::min(guides.width(), 64 * (tile_.first_word + end) + 1);
      if (x0 >= x1) continue;
      const std::size_t begin = guides.Index(x0, y);
      HWY_DYNAMIC_DISPATCH(DepthRow)
      (guides.Plane(Layer::kDepth).data() + begin, guides.Plane(Layer::kCoverage).data() + begin,
       rules_.covered.empty() ? nullptr : rules_.covered.data() + begin, std::size_t(x1 - x0),
       y + 1 < guides.height() ? std::size_t(guides.width()) : 0, depth_.Row(y) + x0);
    }
  }

  const EdgeRules& rules_;
  int radius_;
  MarkedTile tile_;
  CalmMarks calm_;
  PassingRows depth_, slope_x_, slope_y_;
  // By row of the tile and word: bits of the four blocks of 16 pixels in which, or at most `radius` columns beside
  // which, a centre stands.
  std::vector<std::uint8_t> blocks_;
  std::vector<std::uint8_t> busy_, wanted_, sloped_;
  int next_depth_, next_row_;
};

}  // namespace

namespace {

// The words of a tile that hold centres, and one more on either side.
MarkedTile Cropped(const MarkedTile& tile, const BitRows& centres) {
  int first = tile.words, last = -1;
  for (int y = tile.first_row; y < tile.first_row + tile.rows; ++y) {
    const std::uint64_t* row = centres.Row(y);
    for (int w = 0; w < first; ++w) first = row[w] ? w : first;
    for (int w = tile.words - 1; w > last; --w) last = row[w] ? w : last;
  }
  if (last < 0) return {tile.first_row, tile.rows, tile.first_word, 1};
  return {tile.first_row, tile.rows, tile.first_word + first - 1, last - first + 3};
}

}  // namespace

void MarkEdges(const EdgeRules& rules, int radius, const MarkedTile& whole_tile, const BitRows& all_centres,
               EdgeMarks& marks) {
  const std::vector<PixelStep> steps = ForwardSteps(radius);
  const MarkedTile tile = Cropped(whole_tile, all_centres);
  BitRows centres;
  centres.Reset(tile.first_row, tile.rows, tile.first_word, tile.words, 0);
  for (int y = tile.first_row; y < tile.first_row + tile.rows; ++y) {
    for (int w = 0; w < tile.words; ++w) centres.Row(y)[w] = all_centres.At(y, tile.first_word + w);
  }
  marks.same.resize(steps.size());
  for (BitRows& same : marks.same) same.Reset(tile.first_row, tile.rows, tile.first_word, tile.words, 0);
  marks.sure.Reset(tile.first_row, tile.rows, tile.first_word, tile.words, BitRows::kAll);
  BitRows dilated;
  if (radius > 1) Dilate(tile, centres, radius - 1, dilated);
  const BitRows& near = radius > 1 ? dilated : centres;
  EdgeRows rows(rules, radius, tile, centres);
  const float crease_cosine = rules.CreaseCosine();
  const DepthGive give = rules.Give();
  const std::size_t words = std::size_t(tile.words);
  std::vector<std::uint64_t> asked(steps.size() * words), creases(asked.size());
  std::vector<EdgePair> pairs;
  const int end = std::min(tile.first_row + tile.rows, rules.guides.height());
  for (int y = std::max(0, tile.first_row); y < end; ++y) {
    rows.Reach(std::min(y + radius, end - 1));
    if (!rows.Busy(y)) continue;
    rows.calm().Compare(y, end - 1);
    pairs.clear();
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const auto [dx, dy] = steps[k];
      if (y + dy >= end) continue;
      const BitRows& about = std::max(std::abs(dx), dy) == 1 ? near : centres;
      std::uint64_t *full = asked.data() + k * words, *crease = creases.data() + k * words,
                    *same = marks.same[k].Row(y);
      const EdgeSplit split{about.Row(y), about.Row(y + dy), rows.calm().Level(k), rows.calm().Sure(k), full, crease,
                            same};
      if (!HWY_DYNAMIC_DISPATCH(SplitRow)(split, words, dx)) continue;
      if (tile.first_word < 0) full[0] = crease[0] = 0;
      for (std::size_t w = 0; w < words; ++w) {
        if (!full[w]) continue;
        rows.Slopes(y, tile.first_word + int(w), 0, full[w]);
        rows.Slopes(y + dy, tile.first_word + int(w), dx, full[w]);
      }
      pairs.push_back({rows.At(y), rows.At(y + dy), dx, dy, rules.guides.width(), crease_cosine, give,
                       full, crease, same});
    }
    if (pairs.empty()) continue;
    HWY_DYNAMIC_DISPATCH(TestRow)(pairs.data(), pairs.size(), tile.first_word, tile.words);
    std::uint64_t* passed = marks.sure.Row(y);
    for (const EdgePair& pair : pairs) {
      for (std::size_t w = 0; w < words; ++w) passed[w] &= ~(pair.asked[w] | pair.creases[w]) | pair.same[w];
    }
  }
}

}  // namespace scumble::internal
#endif
