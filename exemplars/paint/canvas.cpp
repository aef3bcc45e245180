#include "exemplars/paint/canvas.h"

extern "C" {
#include <mypaint-fixed-tiled-surface.h>
}

#include <cmath>

namespace scumble::paint {
namespace {
constexpr int kTile = MYPAINT_TILE_SIZE;
constexpr float kOne = 1 << 15;  // full scale of a tile's channels
}  // namespace

Canvas::Canvas(int size) : size_(size), tiles_(mypaint_fixed_tiled_surface_new(size, size)) {
  surface_ = mypaint_fixed_tiled_surface_interface(tiles_);
  // The library hands out memory that it has not cleared.
  ForEachPixel(false, [](int, int, std::uint16_t* pixel) { pixel[0] = pixel[1] = pixel[2] = pixel[3] = 0; });
}

Canvas::~Canvas() { mypaint_surface_unref(surface_); }

template <class Visit>
void Canvas::ForEachPixel(bool readonly, Visit visit) const {
  auto* tiled = reinterpret_cast<MyPaintTiledSurface*>(tiles_);
  const int tiles = (size_ + kTile - 1) / kTile;
  for (int tile_y = 0; tile_y < tiles; ++tile_y) {
    for (int tile_x = 0; tile_x < tiles; ++tile_x) {
      MyPaintTileRequest request;
      mypaint_tile_request_init(&request, 0, tile_x, tile_y, readonly);
      tiled->tile_request_start(tiled, &request);
      for (int y = 0; y < kTile && tile_y * kTile + y < size_; ++y) {
        for (int x = 0; x < kTile && tile_x * kTile + x < size_; ++x) {
          visit(tile_x * kTile + x, tile_y * kTile + y, request.buffer + 4 * (y * kTile + x));
        }
      }
      tiled->tile_request_end(tiled, &request);
    }
  }
}

void Canvas::Fill(glm::vec3 color) {
  ForEachPixel(false, [&](int, int, std::uint16_t* pixel) {
    for (int k = 0; k < 3; ++k) pixel[k] = static_cast<std::uint16_t>(std::lround(color[k] * kOne));
    pixel[3] = static_cast<std::uint16_t>(kOne);
  });
}

Layer Canvas::Read() const {
  Layer layer(size_);
  ForEachPixel(true, [&](int x, int y, const std::uint16_t* pixel) {
    layer.At(x, y) = glm::vec4(pixel[0], pixel[1], pixel[2], pixel[3]) / kOne;
  });
  return layer;
}

Picture ToPicture(const Colors& colors) {
  Picture picture(colors.size, colors.size);
  for (int y = 0; y < colors.size; ++y) {
    for (int x = 0; x < colors.size; ++x) {
      const glm::vec3 color = glm::clamp(colors.At(x, y), 0.0f, 1.0f);
      std::uint16_t* out = picture.At(x, y);
      for (int k = 0; k < 3; ++k) out[k] = static_cast<std::uint16_t>(std::lround(color[k] * 65535.0f));
      out[3] = 65535;
    }
  }
  return picture;
}

}  // namespace scumble::paint
