// The surface for libmypaint, and its pixels.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scumble/picture.h"

struct MyPaintFixedTiledSurface;
struct MyPaintSurface;

namespace scumble::paint {

// Every length in this program is in units of a picture of this side; canvases of other sizes scale their strokes.
inline constexpr float kSide = 1024.0f;

// The size of a canvas: a square of pixels. A tile repeats: strokes that leave it on one side enter on the other.
struct Sheet {
  int pixels = 1024;
  float units = kSide;  // along a side
  bool tile = false;    // then `pixels` is a multiple of libmypaint's own tiles of 64
};
// A tile whose marks have the size of those in a picture of `picture_pixels`; half as wide as that, or nearly so.
Sheet TileFor(int picture_pixels);

// The pixels of a sheet; row 0 is the top row.
template <class T>
struct Raster {
  Sheet sheet;
  int size = 0;
  std::vector<T> pixels;

  explicit Raster(const Sheet& on, T value = T{})
      : sheet(on), size(on.pixels), pixels(std::size_t(size) * size, value) {}
  T& At(int x, int y) { return pixels[std::size_t(y) * size + x]; }
  const T& At(int x, int y) const { return pixels[std::size_t(y) * size + x]; }
  // The nearest pixel inside; on a tile, where at most one width outside is allowed, the repeated one.
  const T& Near(int x, int y) const {
    if (sheet.tile) return At((x + size) % size, (y + size) % size);
    return At(glm::clamp(x, 0, size - 1), glm::clamp(y, 0, size - 1));
  }
  // The place of the pixel's centre, in units.
  glm::vec2 Place(int x, int y) const {
    return glm::vec2(x + 0.5f, y + 0.5f) * (sheet.units / static_cast<float>(size));
  }
};

using Colors = Raster<glm::vec3>;  // sRGB-encoded, in [0, 1]
using Layer = Raster<glm::vec4>;   // the same, premultiplied by the alpha in w
using Field = Raster<float>;

// A libmypaint surface over a sheet, transparent when new. Strokes that leave a tile enter on its other side. Neither
// copied nor moved.
class Canvas {
 public:
  explicit Canvas(const Sheet& sheet);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  const Sheet& sheet() const { return sheet_; }
  float pixels_per_unit() const { return static_cast<float>(sheet_.pixels) / sheet_.units; }
  void Fill(glm::vec3 color);
  void Put(const Colors& colors);  // of the same sheet
  Layer Read() const;

  // For Brush.
  MyPaintSurface* surface() const { return surface_; }

 private:
  // Calls visit(x, y, four 15-bit premultiplied channels) for every pixel.
  template <class Visit>
  void ForEachPixel(bool readonly, Visit visit) const;

  Sheet sheet_;
  MyPaintFixedTiledSurface* tiles_;
  MyPaintSurface* surface_;
};

// Opaque picture of the colours.
Picture ToPicture(const Colors& colors);

}  // namespace scumble::paint
