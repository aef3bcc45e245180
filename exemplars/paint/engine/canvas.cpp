#include "exemplars/paint/engine/canvas.h"

extern "C" {
#include <mypaint-fixed-tiled-surface.h>
}

#include <algorithm>
#include <cmath>

#include "core/image/check.h"

namespace scumble::paint {
namespace {
constexpr int kTile = MYPAINT_TILE_SIZE;
constexpr float kOne = 1 << 15;  // full scale of a tile's channels

// The function by which the library's own surface finds its pixels.
MyPaintTileRequestStartFunction PlainRequest() {
  static const MyPaintTileRequestStartFunction kPlain = [] {
    MyPaintFixedTiledSurface* surface = mypaint_fixed_tiled_surface_new(kTile, kTile);
    const auto start = reinterpret_cast<MyPaintTiledSurface*>(surface)->tile_request_start;
    mypaint_surface_unref(mypaint_fixed_tiled_surface_interface(surface));
    return start;
  }();
  return kPlain;
}

// The same for a repeating sheet: both the dabs and the colours that a brush picks up use it.
void RequestRound(MyPaintTiledSurface* surface, MyPaintTileRequest* request) {
  const int tiles = mypaint_fixed_tiled_surface_get_width(reinterpret_cast<MyPaintFixedTiledSurface*>(surface)) / kTile;
  const auto round = [tiles](int tile) { return ((tile % tiles) + tiles) % tiles; };
  request->tx = round(request->tx);
  request->ty = round(request->ty);
  PlainRequest()(surface, request);
}
}  // namespace

Sheet TileFor(int picture_pixels) {
  const int pixels = std::max(1, (picture_pixels / 2 + kTile / 2) / kTile) * kTile;
  return {pixels, static_cast<float>(pixels) * kSide / static_cast<float>(picture_pixels), true};
}

Canvas::Canvas(const Sheet& sheet)
    : sheet_(sheet), tiles_(mypaint_fixed_tiled_surface_new(sheet.pixels, sheet.pixels)) {
  surface_ = mypaint_fixed_tiled_surface_interface(tiles_);
  if (sheet_.tile) {
    SCUMBLE_CHECK_EQ(sheet_.pixels % kTile, 0);
    reinterpret_cast<MyPaintTiledSurface*>(tiles_)->tile_request_start = RequestRound;
  }
  // The library's memory is not cleared.
  ForEachPixel(false, [](int, int, std::uint16_t* pixel) { pixel[0] = pixel[1] = pixel[2] = pixel[3] = 0; });
}

Canvas::~Canvas() { mypaint_surface_unref(surface_); }

template <class Visit>
void Canvas::ForEachPixel(bool readonly, Visit visit) const {
  auto* tiled = reinterpret_cast<MyPaintTiledSurface*>(tiles_);
  const int size = sheet_.pixels;
  const int tiles = (size + kTile - 1) / kTile;
  for (int tile_y = 0; tile_y < tiles; ++tile_y) {
    for (int tile_x = 0; tile_x < tiles; ++tile_x) {
      MyPaintTileRequest request;
      mypaint_tile_request_init(&request, 0, tile_x, tile_y, readonly);
      tiled->tile_request_start(tiled, &request);
      for (int y = 0; y < kTile && tile_y * kTile + y < size; ++y) {
        for (int x = 0; x < kTile && tile_x * kTile + x < size; ++x) {
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

void Canvas::Put(const Colors& colors) {
  ForEachPixel(false, [&](int x, int y, std::uint16_t* pixel) {
    const glm::vec3 color = glm::clamp(colors.At(x, y), 0.0f, 1.0f);
    for (int k = 0; k < 3; ++k) pixel[k] = static_cast<std::uint16_t>(std::lround(color[k] * kOne));
    pixel[3] = static_cast<std::uint16_t>(kOne);
  });
}

Layer Canvas::Read() const {
  Layer layer(sheet_);
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
