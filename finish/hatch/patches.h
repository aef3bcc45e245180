// The patches of hatching: pieces of surfaces whose strokes run one way.
//
// A patch is what lies nearest to one point of a jittered grid: in the picture, or, for strokes that stick to surfaces,
// in the space of the layer pref. Within it each object has its own direction, that of a structure tensor: of the
// normals, of light or of depth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "finish/area/float_plane.h"
#include "finish/area/noise.h"
#include "finish/finish.h"
#include "finish/hatch/axis.h"
#include "finish/hatch/track.h"

namespace scumble::internal {

class Patches {
 public:
  // `tones`: evened light, if strokes go by it. `surface`: null, unless strokes stick to surfaces. Keeps references to
  // both and to the frame's guides. Found by all threads.
  Patches(const HatchPass& pass, const FinishFrame& frame, const FloatPlane& tones, const SurfaceScale* surface,
          int width, int height);

  // The strokes of a pixel.
  struct Strokes {
    Axis axis;
    const Track* track = nullptr;  // null: they do not stick
  };
  Strokes At(std::size_t pixel) const;

 private:
  // Sums of a structure tensor.
  struct Tensor {
    float xx = 0.0f, xy = 0.0f, yy = 0.0f;
  };
  // One object's share of a patch.
  struct Part {
    float object, pixels, flat;  // of the pixels
    Tensor tensor;
    Axis axis, flat_axis;
    glm::vec3 per_x = {}, per_y = {};  // sums of how far pref goes in a pixel
    float steps = 0.0f;                // so many
    Track track = {}, flat_track = {};
  };
  // A pixel's cell of a grid on an object, and the points in that and the cells around it, from the cell's corner.
  struct NearPoints {
    float object = -1.0f;
    int octave = 0;
    glm::vec3 corner = {};
    std::array<glm::vec3, 27> points;
    std::array<std::uint64_t, 27> cells;
  };
  using Parts = std::vector<std::vector<Part>>;  // by patch

  static constexpr int kDirections = 24;  // of strokes: see AllDirections

  static std::array<Axis, kDirections> AllDirections();
  static Axis MainAxis(const Tensor& sum, float least, std::span<const Axis> directions, Axis fixed);
  glm::vec2 PointOf(int column, int row) const;
  void FindPatches(const GuideSet& guides);
  std::uint64_t SurfacePatch(const GuideSet& guides, std::size_t p, float size, NearPoints& near) const;
  int NearestPoint(int x, int y) const;
  void Sum(const GuideSet& guides);
  Parts SumOf(const GuideSet& guides, int first, int last);
  void AddSteps(const GuideSet& guides, std::size_t p, Part& part) const;
  glm::vec3 ValueAt(const GuideSet& guides, std::size_t p) const;
  glm::vec3 Bend(const GuideSet& guides, std::size_t p, int step, int nth, int count) const;
  Part& PartOf(std::vector<Part>& parts, float object) const;

  HatchPass::Along along_;
  int width_, height_, reach_;
  float least_ = 0.0f, cell_;
  int columns_, rows_, patches_ = 0;
  std::uint64_t seed_;
  std::array<Axis, kDirections> directions_;
  Axis fixed_;  // where the surface has no direction
  const SurfaceScale* surface_;
  std::span<const float> object_, value_;  // value_: instead of normals
  std::vector<int> patch_;                 // by pixel; empty: all strokes have one direction
  std::vector<std::uint8_t> is_flat_;
  std::vector<glm::vec2> points_;  // of the grid, in cells, from the cell (-1, -1) on
  Parts of_cell_;
};

}  // namespace scumble::internal
