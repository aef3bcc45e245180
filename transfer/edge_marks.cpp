#include "transfer/edge_marks.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/edge_marks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SCUMBLE_EDGE_MARKS_ONCE
#define SCUMBLE_EDGE_MARKS_ONCE
namespace scumble::internal {

// What the test reads of one row of the picture, each from column 0 on. Depth and slopes are ours and have 64 values
// more on either side of the tile: depth is NaN where nothing is covered, which neither has a slope nor passes a test.
struct EdgeRow {
  const float* depth;
  const float* slope_x;
  const float* slope_y;
  const float* object;
  const float* normal[3];
  std::int64_t before, readable;  // values of the guides before column 0, and from it to the end
};

// Lanes that are within [begin, end) of what `from` points to; 0 for the others.
inline const float* CopyInside(const float* from, std::int64_t begin, std::int64_t end, int lanes, float* copy) {
  for (int i = 0; i < lanes; ++i) copy[i] = i >= begin && i < end ? from[i] : 0.0f;
  return copy;
}

struct EdgePair {
  EdgeRow here, there;
  int dx = 0, dy = 0;
  int width = 0;
  float crease_cosine = 0, depth_tolerance = 0;
  const std::uint64_t* needed = nullptr;  // words of a row; only where one is not 0 something is told
  std::uint64_t* same = nullptr;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

const hn::CappedTag<float, 16> kFloat;
using F = hn::Vec<hn::CappedTag<float, 16>>;

// Depth where coverage is above 0, NaN elsewhere. One of the two tells coverage.
void DepthRow(const float* depth, const float* coverage, const std::uint8_t* covered, std::size_t count, float* out) {
  const hn::Rebind<std::uint8_t, decltype(kFloat)> byte;
  const hn::RebindToUnsigned<decltype(kFloat)> word;
  const F none = hn::Set(kFloat, std::numeric_limits<float>::quiet_NaN());
  std::size_t i = 0;
  for (; i + hn::Lanes(kFloat) <= count; i += hn::Lanes(kFloat)) {
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

// A word of a row, of which `needed` marks what is asked for: bit i, whether that pixel and the one a step further on are
// the same surface.
HWY_INLINE std::uint64_t TestWord(const EdgePair& pair, int word, std::uint64_t needed) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const std::uint64_t whole = lanes < 64 ? (std::uint64_t{1} << lanes) - 1 : ~std::uint64_t{0};
  const float x = static_cast<float>(pair.dx), y = static_cast<float>(pair.dy);
  const F step_x = hn::Set(kFloat, x), step_y = hn::Set(kFloat, y), half = hn::Set(kFloat, 0.5f);
  const F far_x = hn::Set(kFloat, std::abs(x)), far_y = hn::Set(kFloat, std::abs(y));
  const F tolerance = hn::Set(kFloat, pair.depth_tolerance), crease = hn::Set(kFloat, pair.crease_cosine);
  const EdgeRow &p = pair.here, &q = pair.there;
  std::uint64_t bits = 0;
  for (int i = 0; i < 64; i += lanes) {
    if (!(needed >> i & whole)) continue;
    const int a = 64 * word + i, b = a + pair.dx;
    if (a >= pair.width) break;
    const F depth_p = hn::LoadU(kFloat, p.depth + a), depth_q = hn::LoadU(kFloat, q.depth + b);
    const F slope_px = hn::LoadU(kFloat, p.slope_x + a), slope_qx = hn::LoadU(kFloat, q.slope_x + b);
    const F slope_py = hn::LoadU(kFloat, p.slope_y + a), slope_qy = hn::LoadU(kFloat, q.slope_y + b);
    const F expected = hn::Mul(
        half, hn::Add(hn::Mul(hn::Add(slope_px, slope_qx), step_x), hn::Mul(hn::Add(slope_py, slope_qy), step_y)));
    const F leeway = hn::Add(hn::Mul(Least(hn::Abs(slope_px), hn::Abs(slope_qx)), far_x),
                             hn::Mul(Least(hn::Abs(slope_py), hn::Abs(slope_qy)), far_y));
    const F most = hn::Add(leeway, hn::Mul(tolerance, Least(depth_p, depth_q)));
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
    const auto product = [&](int k) HWY_ATTR {
      return hn::Mul(hn::LoadU(kFloat, guide_p[k]), hn::LoadU(kFloat, guide_q[k]));
    };
    const F along = product(1), across = product(2), forth = product(3);
    one = hn::And(one, hn::Gt(hn::Add(hn::Add(along, across), forth), crease));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kFloat, one, bytes);
    bits |= (std::uint64_t(bytes[0] | bytes[1] << 8) & whole) << i;
  }
  return bits;
}

// All steps of a word before the next word, so that what they read stays in the nearest cache.
void TestRow(const EdgePair* pairs, std::size_t count, int first_word, int words) {
  for (int w = 0; w < words; ++w) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint64_t needed = pairs[k].needed[w];
      if (needed) pairs[k].same[w] = TestWord(pairs[k], first_word + w, needed);
    }
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(DepthRow);
HWY_EXPORT(SlopeWord);
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
  for (int y = 0; y < tile.rows; ++y) {
    for (int v = std::max(0, y - reach); v <= std::min(tile.rows - 1, y + reach); ++v) {
      for (int w = 0; w < tile.words; ++w) {
        for (int dx = -reach; dx <= reach; ++dx) {
          out.At(tile.first_row + y, tile.first_word + w) |= marks.Shifted(tile.first_row + v, tile.first_word + w, dx);
        }
      }
    }
  }
}

// Makes depths and slopes as rows are asked for.
class EdgeRows {
 public:
  EdgeRows(const EdgeRules& rules, int radius, const MarkedTile& tile)
      : rules_(rules),
        tile_(tile),
        depth_(radius + 3, tile.first_word, tile.words, std::numeric_limits<float>::quiet_NaN()),
        slope_x_(radius + 1, tile.first_word, tile.words, 0.0f),
        slope_y_(radius + 1, tile.first_word, tile.words, 0.0f),
        next_depth_(tile.first_row - 1),
        next_slope_(tile.first_row) {}

  // Slopes are there up to row y; `wanted` tells in which words of a row.
  template <class Wanted>
  void Reach(int y, const Wanted& wanted) {
    for (; next_slope_ <= y; ++next_slope_) {
      for (; next_depth_ <= next_slope_ + 1; ++next_depth_) MakeDepth(next_depth_);
      for (int w = tile_.first_word; w < tile_.first_word + tile_.words; ++w) {
        if (!wanted(next_slope_, w)) continue;
        const int x = 64 * w;
        HWY_DYNAMIC_DISPATCH(SlopeWord)
        (depth_.Row(next_slope_ - 1) + x, depth_.Row(next_slope_) + x, depth_.Row(next_slope_ + 1) + x,
         slope_x_.Row(next_slope_) + x, slope_y_.Row(next_slope_) + x);
      }
    }
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
  void MakeDepth(int y) {
    const GuideSet& guides = rules_.guides;
    if (y < 0 || y >= guides.height()) {
      depth_.Fill(y, std::numeric_limits<float>::quiet_NaN());
      return;
    }
    const int x0 = std::max(0, 64 * tile_.first_word - 1);
    const int x1 = std::min(guides.width(), 64 * (tile_.first_word + tile_.words) + 1);
    const std::size_t begin = guides.Index(x0, y);
    HWY_DYNAMIC_DISPATCH(DepthRow)
    (guides.Plane(Layer::kDepth).data() + begin, guides.Plane(Layer::kCoverage).data() + begin,
     rules_.covered.empty() ? nullptr : rules_.covered.data() + begin, std::size_t(x1 - x0), depth_.Row(y) + x0);
  }

  const EdgeRules& rules_;
  MarkedTile tile_;
  PassingRows depth_, slope_x_, slope_y_;
  int next_depth_, next_slope_;
};

}  // namespace

void MarkEdges(const EdgeRules& rules, int radius, const MarkedTile& tile, const BitRows& centres,
               std::vector<BitRows>& same) {
  const std::vector<PixelStep> steps = ForwardSteps(radius);
  same.resize(steps.size());
  for (BitRows& marks : same) marks.Reset(tile.first_row, tile.rows, tile.first_word, tile.words, 0);
  BitRows dilated;
  if (radius > 1) Dilate(tile, centres, radius - 1, dilated);
  const BitRows& near = radius > 1 ? dilated : centres;
  const auto has = [&](int y) { return y >= tile.first_row && y < tile.first_row + tile.rows; };
  const auto wanted = [&](int y, int word) {
    for (int v = y - 1; v <= y + 1; ++v) {
      if (has(v) && (near.At(v, word - 1) | near.At(v, word) | near.At(v, word + 1))) return true;
    }
    return false;
  };
  EdgeRows rows(rules, radius, tile);
  const float crease_cosine = rules.CreaseCosine();
  std::vector<std::uint64_t> needed_words(steps.size() * tile.words);
  std::vector<EdgePair> pairs;
  const int end = std::min(tile.first_row + tile.rows, rules.guides.height());
  for (int y = tile.first_row; y < end; ++y) {
    rows.Reach(std::min(y + radius, end - 1), wanted);
    if (y < 0) continue;
    pairs.clear();
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const PixelStep step = steps[k];
      if (y + step.dy >= end) continue;
      const BitRows& about = std::max(std::abs(step.dx), step.dy) == 1 ? near : centres;
      std::uint64_t* needed = needed_words.data() + k * tile.words;
      std::uint64_t any = 0;
      for (int w = 0; w < tile.words; ++w) {
        const int word = tile.first_word + w;
        needed[w] = word < 0 ? 0 : about.At(y, word) | about.Shifted(y + step.dy, word, step.dx);
        any |= needed[w];
      }
      if (!any) continue;
      pairs.push_back({rows.At(y), rows.At(y + step.dy), step.dx, step.dy, rules.guides.width(), crease_cosine,
                       rules.DepthTolerance(), needed, same[k].Row(y)});
    }
    if (!pairs.empty()) HWY_DYNAMIC_DISPATCH(TestRow)(pairs.data(), pairs.size(), tile.first_word, tile.words);
  }
}

JoinedWays::JoinedWays(int radius) : radius_(radius) {
  const auto index = [&](PixelStep at) {
    for (std::size_t k = 0; k < ways.size(); ++k) {
      if (ways[k].dx == at.dx && ways[k].dy == at.dy) return static_cast<int>(k);
    }
    return -1;
  };
  for (int ring = 1; ring <= radius; ++ring) {
    for (int dy = -ring; dy <= ring; ++dy) {
      for (int dx = -ring; dx <= ring; ++dx) {
        if (std::max(std::abs(dx), std::abs(dy)) != ring) continue;
        const PixelStep before = StepBefore({dx, dy});
        tests_.push_back({index(before), TestOf(before, {dx, dy}), TestOf({0, 0}, {dx, dy})});
        ways.push_back({dx, dy});
      }
    }
  }
}

JoinedWays::Test JoinedWays::TestOf(PixelStep from, PixelStep to) const {
  if (to.dy < from.dy || (to.dy == from.dy && to.dx < from.dx)) std::swap(from, to);
  const int dx = to.dx - from.dx, dy = to.dy - from.dy;
  // The order of ForwardSteps.
  const int step = dy == 0 ? dx - 1 : radius_ + (dy - 1) * (2 * radius_ + 1) + dx + radius_;
  return {step, from.dx, from.dy};
}

void JoinedWays::Join(const std::vector<BitRows>& same, int row, int word, std::span<std::uint64_t> joined) const {
  std::uint64_t reached[48];
  const auto passed = [&](const Test& test) {
    return same[std::size_t(test.step)].Shifted(row + test.dy, word, test.dx);
  };
  for (std::size_t k = 0; k < tests_.size(); ++k) {
    const Way& way = tests_[k];
    reached[k] = passed(way.step) & (way.before < 0 ? BitRows::kAll : reached[way.before]);
    joined[k] = reached[k] & passed(way.whole);
  }
}

}  // namespace scumble::internal
#endif
