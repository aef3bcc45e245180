// Smooth borders between objects: every surface of a pixel is painted by itself, then they are mixed by coverage.
//
// The chunks of the pixels in the style's window vote on the colour of a fragment (core/image/fragments.h), as on a
// pixel's. So a border shows what its surface would show there. Where votes are cut at edges, pixels of the fragment's
// own object whose normals are within the crease vote. Without a window, or where votes are not cut, each of its cells
// (core/image/fragments.h) takes the nearest of the eight pixels around that shows its surface. Without a window, these
// are averaged in linear light. Where none shows it, and always for Lit Sphere, the fragment takes its own nearest
// neighbour.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/image/fragments.h"
#include "scumble/picture.h"
#include "transfer/frame/frame_setup.h"
#include "transfer/match/match.h"
#include "transfer/tint/colorize.h"
#include "transfer/vote/vote.h"

namespace scumble::internal {

// A style's settings for fragments.
struct FragmentStyle {
  const MatchInput& match;   // of the picture's pixels
  bool own_sources = false;  // Lit Sphere: no pixel has a chunk
  bool edge_aware = false;
  float crease_cosine = -2.0f;             // with edge_aware; else no normals are too far apart
  const PreparedExemplar* base = nullptr;  // base layers of the hybrid; null: none
  Tint tint;
};

// The colours of a frame's fragments. Different fragments may be painted by different threads.
class FragmentPaint {
 public:
  // Pixels around a fragment's whose sources count, whatever the style's window.
  static constexpr int kReach = 1;

  // The frame outlives it. Without fragments all calls do nothing.
  explicit FragmentPaint(const FrameInput& frame);

  bool empty() const { return !fragments_; }

  // Paints the style's fragments in rows y0 … y1 - 1 of the frame's region. `votes` are the input of the style's vote:
  // its field and `active` hold these rows, those of the window around, and kReach rows at least.
  void Paint(const FragmentStyle& style, int number, const VoteInput& votes, int y0, int y1);

  // Calls paint(x, y, texel) for each fragment of the region that catches shadows. Runs in the caller's arena.
  void PaintShadows(const std::function<void(int x, int y, std::uint16_t* texel)>& paint);

  // Mixes the colours into the painted pixels, in linear light, by coverage. Fragments that are left as they are add
  // nothing. Afterwards alpha is the share of the pixel's coverage that is painted. `kept`, if not null, gets the
  // colours. Runs in the caller's arena.
  void Mix(Picture& out, FragmentColors* kept = nullptr) const;

 private:
  using Texel = FragmentColors::Texel;

  std::uint16_t StyleOf(std::size_t fragment) const;
  bool ShowsSurface(std::size_t q, std::size_t fragment, float crease_cosine) const;
  bool IsWithinCrease(std::size_t q, std::size_t fragment, float crease_cosine) const;
  template <class Cast>
  void ForEachVote(const FragmentStyle& style, const VoteInput& votes, std::size_t fragment, int x, int y,
                   const Cast& vote) const;
  template <class Sum>
  Texel Painted(const FragmentStyle& style, const VoteInput& votes, std::size_t fragment, int x, int y) const;
  template <class Visit>
  void ForAll(const Visit& visit) const;
  void MixPixel(std::size_t first, std::size_t end, std::uint16_t* pixel) const;

  const FrameInput& frame_;
  const Fragments* fragments_;  // null: none
  std::vector<Texel> colors_;   // straight alpha
};

}  // namespace scumble::internal
