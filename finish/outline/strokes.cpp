#include "finish/outline/strokes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/image/exact_math.h"
#include "core/image/hash.h"
#include "finish/area/noise.h"
#include "finish/outline/piece_rows.h"

namespace scumble::internal {
namespace {

constexpr float kPieceError = 0.1f;  // pixels
constexpr int kBandRows = 32;
constexpr float kOverlap = 1.0f;  // pixels: a line beside a border covers half a pixel of its other side, mixed ones
constexpr double kGapEnd = 0.25;  // of noise: over which a stroke thins into a gap

// Widths before the taper.
std::vector<float> WidthsOf(const OutlinePass& pass, const FinishFrame& frame, const NoiseField* gaps,
                            const LineChain& chain) {
  const LineWidth width(pass, frame, gaps);
  std::vector<float> widths;
  for (const LinePoint& point : chain.points) widths.push_back(width.At(point.owner, point.line));
  SmoothAlong(chain, widths);
  return widths;
}

// The value that a share of noise lies below.
double NoiseBelow(double share) {
  constexpr int kSide = 64;
  static const std::vector<float> sorted = [] {
    std::vector<float> values;
    for (int i = 0; i < kSide * kSide; ++i) {
      values.push_back(Noise(Hash(1, 1), glm::vec2(float(i % kSide) * 0.37f, float(i / kSide) * 0.37f)));
    }
    std::sort(values.begin(), values.end());
    return values;
  }();
  if (share >= 1.0) return 2.0;
  return sorted[static_cast<std::size_t>(share * double(sorted.size()))];
}

// Makes free ends thin.
void Taper(double length, const LineChain& chain, std::vector<float>& widths) {
  if (!(length > 0.0) || chain.closed) return;
  std::vector<float> along(chain.points.size());  // from the beginning
  for (std::size_t i = 1; i < along.size(); ++i) {
    along[i] = along[i - 1] + glm::length(chain.points[i].at - chain.points[i - 1].at);
  }
  const auto per_length = static_cast<float>(1.0 / length);
  for (std::size_t i = 0; i < along.size(); ++i) {
    const float to_end = std::min(chain.begin == LineEnd::kFree ? along[i] : 1e9f,
                                  chain.end == LineEnd::kFree ? along.back() - along[i] : 1e9f);
    const float share = std::min(to_end * per_length, 1.0f);
    widths[i] *= share * (2.0f - share);
  }
}

float Dot(glm::vec2 a, glm::vec2 b) { return a.x * b.x + a.y * b.y; }

float DistanceToSegment(glm::vec2 p, glm::vec2 a, glm::vec2 b) {
  const glm::vec2 along = b - a;
  const float squared = Dot(along, along);
  const float t = squared > 0.0f ? std::clamp(Dot(p - a, along) / squared, 0.0f, 1.0f) : 0.0f;
  const glm::vec2 off = p - a - along * t;
  return std::sqrt(Dot(off, off));
}

// Where the stroke's middle runs: the line, moved to its side and by the wobble. Open lines get their ends.
struct Middle {
  std::vector<glm::vec2> at;
  std::vector<float> width;
  std::vector<std::uint32_t> owner;
};

// Towards which side of a line its owners lie, as a factor of the line's width, -1 … 1, 1 being the left. Where the
// nearer surface changes, owners count over a stretch of the line, so that it passes from one side to the other. Where
// two objects meet neither is nearer, and the rest of the line decides, if it has any. A line on a surface, as a
// crease, keeps to its middle. So does each towards a junction, where the others meet it; but a contour that passes
// goes on, and the others end at that.
// A line shorter than `share` of its width. Below 1 it has no direction to speak of.
bool IsStub(const LineChain& chain, const std::vector<float>& widths, float share = 1.0f) {
  if (chain.closed) return false;
  float length = 0.0f;
  for (std::size_t i = 1; i < chain.points.size(); ++i) {
    length += glm::length(chain.points[i].at - chain.points[i - 1].at);
  }
  return length < share * widths.front();
}

std::vector<float> SidesOf(const LineChain& chain, const std::vector<float>& widths) {
  const auto& points = chain.points;
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  const auto at = [&](std::ptrdiff_t i) {
    return static_cast<std::size_t>(chain.closed ? (i % count + count) % count
                                                 : std::clamp<std::ptrdiff_t>(i, 0, count - 1));
  };
  const bool all_meet =
      std::ranges::all_of(points, [](const LinePoint& point) { return point.meets || !point.has_side; });
  std::vector<float> own(points.size());
  float most = 0.0f;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (!points[std::size_t(i)].has_side || (points[std::size_t(i)].meets && !all_meet)) continue;
    const glm::vec2 along = points[at(i + 1)].at - points[at(i - 1)].at;
    own[std::size_t(i)] = Dot(glm::vec2(-along.y, along.x), points[std::size_t(i)].to_owner) < 0.0f ? -1.0f : 1.0f;
    most += own[std::size_t(i)];
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].has_side && points[i].meets) own[i] = most < 0.0f ? -1.0f : 1.0f;
  }
  constexpr std::ptrdiff_t kStretch = 8;
  std::vector<float> sides(points.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    float sum = 0.0f;
    for (std::ptrdiff_t k = -kStretch; k <= kStretch; ++k) sum += own[at(i + k)];
    sides[std::size_t(i)] = std::clamp(2.0f * sum / (2 * kStretch + 1), -1.0f, 1.0f);
  }
  if (chain.closed) return sides;
  const auto run_back = [&](const auto& nth) {
    float along = 0.0f;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (k > 0) along += glm::length(points[nth(k)].at - points[nth(k - 1)].at);
      if (along >= widths[nth(k)]) break;
      sides[nth(k)] *= along / widths[nth(k)];
    }
  };
  const bool is_stub = IsStub(chain, widths);
  if (chain.begin == LineEnd::kJunction && (is_stub || !chain.begin_contour)) run_back([](std::size_t k) { return k; });
  if (chain.end == LineEnd::kJunction && (is_stub || !chain.end_contour)) {
    run_back([&](std::size_t k) { return points.size() - 1 - k; });
  }
  return sides;
}

// How far the middle of a stroke is moved to the line's owners.
float Shift(const OutlinePass& pass, float width) {
  if (pass.side == OutlinePass::Side::kCentre) return 0.0f;
  return (pass.side == OutlinePass::Side::kInside ? 0.5f : -0.5f) * std::max(0.0f, width - kOverlap);
}

// Lets a line end in the middle of the contour's stroke that passes there, so that it neither sticks out beyond that
// nor falls short of it. `from`, `to`: which of the line's points are left.
void EndInContours(const OutlinePass& pass, const LineWidth& width, LineChain& chain, std::size_t& from,
                   std::size_t& to) {
  const auto end_in = [&](const PassingContour& contour, glm::vec2& end, const auto& drop) {
    const float shift = Shift(pass, width.At(contour.owner, contour.line));
    const glm::vec2 towards = contour.to_owner * (shift < 0.0f ? -1.0f : 1.0f);
    const glm::vec2 corner = end;
    end += contour.to_owner * shift;
    drop([&](glm::vec2 at) { return Dot(at - corner, towards) > 0.0f && Dot(at - end, towards) < 0.0f; });
  };
  const auto& points = chain.points;
  if (chain.begin_contour && !chain.begins_in_contour) {
    end_in(*chain.begin_contour, chain.first, [&](const auto& is_beyond) {
      while (from < to && is_beyond(points[from].at)) ++from;
    });
  }
  if (chain.end_contour && !chain.ends_in_contour) {
    end_in(*chain.end_contour, chain.last, [&](const auto& is_beyond) {
      while (from < to && is_beyond(points[to - 1].at)) --to;
    });
  }
}

Middle MiddleOf(const OutlinePass& pass, const FinishFrame& frame, const LineNoise& noise, LineChain& chain,
                const std::vector<float>& widths) {
  const auto& points = chain.points;
  const std::size_t count = points.size();
  const bool has_side = pass.side != OutlinePass::Side::kCentre;
  const std::vector<float> to_side = has_side ? SidesOf(chain, widths) : std::vector<float>();
  std::size_t from = 0, to = count;
  if (has_side && !chain.closed && !IsStub(chain, widths))
    EndInContours(pass, LineWidth(pass, frame, noise.gaps), chain, from, to);
  const auto wobble = static_cast<float>(pass.wobble * frame.scale);
  const auto per_wave = static_cast<float>(1.0 / (pass.wobble_length * frame.scale));
  const auto moved = [&](glm::vec2 at, std::size_t i) {
    if (has_side) {
      const std::size_t before = i > 0 ? i - 1 : chain.closed ? count - 1 : 0;
      const std::size_t after = i + 1 < count ? i + 1 : chain.closed ? 0 : i;
      const glm::vec2 along = points[after].at - points[before].at;
      const float length = std::sqrt(Dot(along, along));
      const glm::vec2 left = length > 0.0f ? glm::vec2(-along.y, along.x) / length : points[i].to_owner;
      at += left * (to_side[i] * Shift(pass, widths[i]));
    }
    if (wobble > 0.0f && noise.across) {
      const auto width = static_cast<std::uint32_t>(frame.guides->width());
      const int x = static_cast<int>(points[i].owner % width), y = static_cast<int>(points[i].owner / width);
      at += wobble * glm::vec2(noise.across->At(x, y), noise.down->At(x, y));
    } else if (wobble > 0.0f) {
      const glm::vec2 cell = at * per_wave;
      at += wobble * glm::vec2(Noise(Hash(frame.seed, 1), cell), Noise(Hash(frame.seed, 2), cell));
    }
    return at;
  };
  Middle middle;
  const auto add = [&](glm::vec2 at, std::size_t i) {
    middle.at.push_back(moved(at, i));
    middle.width.push_back(widths[i]);
    middle.owner.push_back(points[i].owner);
  };
  if (!chain.closed) add(chain.first, std::min(from, count - 1));
  for (std::size_t i = from; i < to; ++i) add(points[i].at, i);
  chain.closed ? add(points[0].at, 0) : add(chain.last, to > 0 ? to - 1 : 0);
  return middle;
}

// Whether a straight piece from i to j keeps to all points between.
bool IsStraight(const Middle& middle, std::size_t i, std::size_t j) {
  const float from = middle.width[i], step = (middle.width[j] - from) / static_cast<float>(j - i);
  for (std::size_t k = i + 1; k < j; ++k) {
    if (DistanceToSegment(middle.at[k], middle.at[i], middle.at[j]) > kPieceError) return false;
    if (std::fabs(middle.width[k] - from - step * static_cast<float>(k - i)) > kPieceError) return false;
  }
  return true;
}

// Draws a piece into the rows [y0, y1).
void Draw(const StrokePiece& piece, int y0, int y1, int width, StrokeCover& cover) {
  const float most = std::max(1.0f, std::max(piece.from_width, piece.to_width)) * 0.5f + 0.5f;
  const auto low = [](float value) { return static_cast<int>(std::floor(value)); };
  const int left = std::max(0, low(std::min(piece.from.x, piece.to.x) - most));
  const int right = std::min(width - 1, low(std::max(piece.from.x, piece.to.x) + most));
  y0 = std::max(y0, low(std::min(piece.from.y, piece.to.y) - most));
  y1 = std::min(y1, low(std::max(piece.from.y, piece.to.y) + most) + 1);
  const glm::vec2 along = piece.to - piece.from;
  const float squared = Dot(along, along), per_squared = squared > 0.0f ? 1.0f / squared : 0.0f;
  // A row is covered only by the part of the piece that lies at most `most` above or below it, and only up to `most`
  // beside that part.
  const float per_down = std::fabs(along.y) > 1e-3f ? 1.0f / along.y : 0.0f;
  for (int y = y0; y < y1; ++y) {
    const float down = static_cast<float>(y) + 0.5f - piece.from.y;
    float begin = 0.0f, end = 1.0f;
    if (per_down != 0.0f) {
      const float a = (down - most) * per_down, b = (down + most) * per_down;
      begin = std::clamp(std::min(a, b), 0.0f, 1.0f), end = std::clamp(std::max(a, b), 0.0f, 1.0f);
    }
    const float x0 = piece.from.x + along.x * begin, x1 = piece.from.x + along.x * end;
    int from = std::max(left, low(std::min(x0, x1) - most)), to = std::min(right, low(std::max(x0, x1) + most));
    if (to < from) continue;
    // Whole blocks are quickest, and pixels beside the piece are not covered.
    constexpr int kBlock = kCoverBlock;
    to = std::min(width - 1, from + (to - from) / kBlock * kBlock + kBlock - 1);
    const PieceAtRow at{along,      per_squared,      static_cast<float>(from) + 0.5f - piece.from.x,
                        down,       piece.from_width, piece.to_width - piece.from_width,
                        piece.owner};
    const std::size_t first = std::size_t(y) * std::size_t(width) + std::size_t(from);
    CoverRow(at, std::size_t(to - from) + 1, cover.share.data() + first,
             cover.owner.empty() ? nullptr : cover.owner.data() + first);
  }
}

}  // namespace

LineWidth::LineWidth(const OutlinePass& pass, const FinishFrame& frame, const NoiseField* gaps)
    : pass_(pass),
      scale_(frame.scale),
      bright_(frame.measures.bright),
      thin_at_(pass.thin_at > 0.0 ? pass.thin_at : frame.measures.middle),
      depth_(frame.guides->Plane(Layer::kDepth)),
      gaps_(gaps),
      width_(std::size_t(frame.guides->width())) {
  if (pass.light != 0.0) light_ = frame.guides->Plane(Layer::kLuminance);
  if (gaps) gap_from_ = NoiseBelow(pass.gaps);
}

float LineWidth::At(std::size_t owner, LineClass line) const {
  double width = pass_.width;
  if (pass_.thin > 0.0 && thin_at_ > 0.0) width *= Exp2(pass_.thin * Log2(thin_at_ / std::max(depth_[owner], 1e-9f)));
  if (!light_.empty()) {
    const double share = std::clamp(double(light_[owner]) / bright_, 0.0, 1.0);
    width *= std::max(0.0, 1.0 + pass_.light * (0.5 - share));
  }
  width = std::clamp(width, std::min(pass_.min_width, pass_.width), 64.0);
  if (gaps_) {
    const double above = double(gaps_->At(int(owner % width_), int(owner / width_))) - gap_from_;
    width *= std::clamp(0.5 + above / kGapEnd, 0.0, 1.0);
  }
  return static_cast<float>(width * pass_.of_class[std::size_t(line)] * scale_);
}

std::vector<StrokePiece> StrokeOf(const OutlinePass& pass, const FinishFrame& frame, const LineNoise& noise,
                                  LineChain chain) {
  std::vector<float> widths = WidthsOf(pass, frame, noise.gaps, chain);
  Taper(pass.taper * frame.scale, chain, widths);
  // Between two junctions the other lines' ends cover it; in the middle of lines that run beside theirs it would show.
  const bool joins = chain.begin == LineEnd::kJunction && chain.end == LineEnd::kJunction;
  if (pass.side != OutlinePass::Side::kCentre && joins && IsStub(chain, widths, 0.5f)) return {};
  const Middle middle = MiddleOf(pass, frame, noise, chain, widths);
  std::vector<StrokePiece> pieces;
  const std::size_t last = middle.at.size() - 1;
  for (std::size_t i = 0; i < last;) {
    const auto most = std::max<std::size_t>(2, std::size_t(0.5f * middle.width[i]));
    std::size_t j = i + 1;
    while (j < last && j - i < most && IsStraight(middle, i, j + 1)) ++j;
    pieces.push_back({middle.at[i], middle.at[j], middle.width[i], middle.width[j], middle.owner[i]});
    i = j;
  }
  return pieces;
}

StrokeCover CoverOf(std::span<const StrokePiece> pieces, int width, int height, bool with_owner) {
  StrokeCover cover;
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  cover.share.assign(pixels, 0.0f);
  if (with_owner) cover.owner.assign(pixels, 0);
  const int bands = (height + kBandRows - 1) / kBandRows;
  std::vector<std::vector<std::uint32_t>> of_band(static_cast<std::size_t>(bands));
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const StrokePiece& piece = pieces[i];
    if (!(std::max(piece.from_width, piece.to_width) > 0.0f)) continue;
    const float most = std::max(1.0f, std::max(piece.from_width, piece.to_width)) * 0.5f + 1.5f;
    const auto band = [&](float y) { return std::clamp(static_cast<int>(std::floor(y / kBandRows)), 0, bands - 1); };
    const int to = band(std::max(piece.from.y, piece.to.y) + most);
    for (int b = band(std::min(piece.from.y, piece.to.y) - most); b <= to; ++b)
      of_band[std::size_t(b)].push_back(static_cast<std::uint32_t>(i));
  }
  tbb::parallel_for(0, bands, [&](int b) {
    const int y0 = b * kBandRows, y1 = std::min(height, y0 + kBandRows);
    for (const std::uint32_t i : of_band[std::size_t(b)]) Draw(pieces[i], y0, y1, width, cover);
  });
  return cover;
}

}  // namespace scumble::internal
