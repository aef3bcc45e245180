// The marks that are printed around the sphere's template, which align a scan or a photograph with the template's
// pixels. They are AprilTags (E. Olson, "AprilTag: A robust and flexible visual fiducial system", ICRA 2011;
// J. Wang, E. Olson, "AprilTag 2: Efficient and robust fiducial detection", IROS 2016), ids 0 … 11 of the family
// tag16h5, whose bits the library keeps.
//
// Coordinates: the sphere's square is [0, 1]², x to the right, y down from the picture's top; the template's margin
// reaches at least kFiducialMargin further on every side. A picture of the template with `size` pixels across the
// sphere's square and a margin of `margin` pixels has (x, y) at pixel (margin + x · size, margin + y · size), where
// pixel i covers [i, i + 1). Everything lies on a grid of 1/64: at sizes that 64 divides, all edges are pixel edges.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "scumble/picture.h"

namespace scumble {

// A printed sphere of 100 mm has modules of 1.6 mm: 9 pixels in a scan at 150 dpi.
inline constexpr double kFiducialModule = 1.0 / 64.0;
// 4 × 4 bits within a black border of one module.
inline constexpr int kFiducialModules = 6;
inline constexpr double kFiducialSide = kFiducialModules * kFiducialModule;
// White paper around each marker, in which nothing else may be printed.
inline constexpr double kFiducialQuiet = kFiducialModule;
// The part of the margin that the markers take, quiet zones included.
inline constexpr double kFiducialMargin = kFiducialSide + 2 * kFiducialQuiet;

// A marker; (left, top) is the corner of its black border.
struct Fiducial {
  int id = 0;
  double left = 0, top = 0;
};

inline constexpr int kFiducialCount = 12;

// All markers, in the order of their ids: clockwise from the upper left corner. Four are in the corners and two on each
// side. Those stay away from the side's middle, where the sphere is close and paint runs over the margin.
const std::array<Fiducial, kFiducialCount>& Fiducials();

// A marker's place in words: "upper left corner", "right side, lower".
const char* FiducialPlace(int id);
// The places of several markers, with commas between.
std::string FiducialPlaces(const std::vector<int>& ids);

// Whether a module is black; `id` in 0 … kFiducialCount - 1, column and row in 0 … kFiducialModules - 1, the border
// included.
bool FiducialIsBlack(int id, int column, int row);

// Whether the modules are large enough, two pixels, to be drawn in a template with `size` pixels across the sphere.
bool FiducialsFit(int size);

// Draws the markers, black on their white quiet zones, and changes nothing else. Edges between pixels are mixed in
// linear light, so that their place is exact at any size; transparent pixels become opaque under a mark. `margin` in
// pixels, at least kFiducialMargin · size; needs FiducialsFit(size) and a picture of (size + 2 · margin)².
void DrawFiducials(Picture& picture, int size, int margin);

// The number of markers that stand in a picture exactly where DrawFiducials puts them. All twelve in a template, also
// after saving as JPEG; none where the picture has another size than (size + 2 · margin)².
int FiducialsInPlace(const Picture& picture, int size, int margin);

// The number of markers in a square picture that was scaled as a whole, mirrored or not, whose margin is an eighth of
// the sphere. All twelve in a template that was exported at another size, down to modules of two pixels.
int FiducialsInProportion(const Picture& picture);

// Fewest pixels across the sphere in the scan.
inline constexpr int kMinScanSphere = 200;

}  // namespace scumble
