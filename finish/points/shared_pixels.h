// Pixels that several surfaces share.
#pragma once

#include <optional>
#include <span>

#include "finish/points/point_block.h"

namespace scumble::internal {

// Strokes of painted edges are among the surfaces of a pixel.
class SharedPixels {
 public:
  // Keeps references to the steps and the frame.
  SharedPixels(std::span<const PointStep> steps, const FinishFrame& frame);

  bool any() const { return fragments_ != nullptr || !strokes_.empty(); }

  // The row has been painted without them. From several threads.
  void PaintRow(const GivenRow& row, Picture& picture) const;

 private:
  struct Shared {
    std::size_t pixel, first, end;  // with its fragments
  };

  std::optional<std::size_t> LikeOf(std::size_t fragment) const;
  const FragmentColors* ColorsOf(const Shared& shared, const Texel& texel) const;
  void AddParts(const Shared& shared, const Texel& given, Batch& batch) const;
  bool IsBeforeAnother(const EdgeStroke& stroke) const;
  bool IsReplaced(std::size_t pixel) const;
  void AddStroke(const EdgeStroke& stroke, const Shared& shared, const Texel& given, Batch& batch) const;

  std::span<const PointStep> steps_;
  const FinishFrame& frame_;
  const Fragments* fragments_ = nullptr;
  std::span<const EdgeStroke> strokes_ = {};
};

}  // namespace scumble::internal
