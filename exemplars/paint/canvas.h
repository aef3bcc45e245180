// What libmypaint paints on, and what comes off it.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "image/picture.h"

struct MyPaintFixedTiledSurface;
struct MyPaintSurface;

namespace scumble::paint {

// Every length in this program is in units of a picture of this side; canvases of other sizes scale their strokes.
inline constexpr float kSide = 1024.0f;

// A square of pixels; row 0 is the top row.
template <class T>
struct Raster {
  int size = 0;
  std::vector<T> pixels;

  explicit Raster(int side, T value = T{}) : size(side), pixels(std::size_t(side) * side, value) {}
  T& At(int x, int y) { return pixels[std::size_t(y) * size + x]; }
  const T& At(int x, int y) const { return pixels[std::size_t(y) * size + x]; }
  // The nearest pixel inside.
  const T& Near(int x, int y) const { return At(glm::clamp(x, 0, size - 1), glm::clamp(y, 0, size - 1)); }
  // Where the pixel's centre lies, in units of kSide.
  glm::vec2 Place(int x, int y) const { return glm::vec2(x + 0.5f, y + 0.5f) * (kSide / static_cast<float>(size)); }
};

using Colors = Raster<glm::vec3>;  // sRGB-encoded, in [0, 1]
using Layer = Raster<glm::vec4>;   // the same, premultiplied by the alpha in w
using Field = Raster<float>;

// A libmypaint surface of size × size pixels, transparent when new. Neither copied nor moved.
class Canvas {
 public:
  explicit Canvas(int size);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  int size() const { return size_; }
  float pixels_per_unit() const { return static_cast<float>(size_) / kSide; }
  void Fill(glm::vec3 color);
  Layer Read() const;

  // For Brush.
  MyPaintSurface* surface() const { return surface_; }

 private:
  // Calls visit(x, y, four 15-bit premultiplied channels) for every pixel.
  template <class Visit>
  void ForEachPixel(bool readonly, Visit visit) const;

  int size_;
  MyPaintFixedTiledSurface* tiles_;
  MyPaintSurface* surface_;
};

// Opaque picture of the colours.
Picture ToPicture(const Colors& colors);

}  // namespace scumble::paint
