#include "finish/points/point_loop.h"

#include <algorithm>

#include "core/filter/oklab_rows.h"
#include "finish/points/contour_pixels.h"
#include "finish/points/shared_pixels.h"

namespace scumble::internal {

bool PaintPoints(std::span<const PointStep> steps, const FinishFrame& frame, RowProgress& progress, Picture& picture) {
  const SharedPixels shared(steps, frame);
  const ContourPixels contours(steps, frame);
  return ForEachRow({0, 0, picture.width, picture.height}, progress, [&](int y) {
    const auto width = static_cast<std::size_t>(picture.width), begin = std::size_t(y) * width;
    GivenRow row{y, begin, {}};
    if (contours.any() || shared.any()) row.texels.assign(picture.At(0, y), picture.At(0, y) + 4 * width);
    for (std::size_t x = 0; x < width; x += kOklabBlock) {
      std::uint16_t* const texels = picture.At(static_cast<int>(x), y);
      PaintBlock(steps, {begin + x, std::min(kOklabBlock, width - x), texels}, texels);
    }
    if (contours.any()) contours.PaintRow(row, picture);
    if (shared.any()) shared.PaintRow(row, picture);
  });
}

}  // namespace scumble::internal
