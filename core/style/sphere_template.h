// The picture that an artist paints over: a lit sphere on white paper, with marks in the margin around it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "scumble/picture.h"

namespace scumble {

// One lighting condition: the sphere's guides with the luminance layer of that light.
struct KitLight {
  double azimuth = 0;     // degrees, from +Z towards +X
  double elevation = 0;   // degrees
  GuideSet guides;        // N × N, the sphere fills it; needs luminance
  std::string name = {};  // of its painting, "shade" for shade.png; empty: lit, and lit-2, lit-3 … for further ones
};

// The light's direction: "azimuth -40, elevation 40 degrees", and "the upper left".
std::string AnglesInWords(const KitLight& light);
std::string PlaceInWords(const KitLight& light);

// Pixels of margin around the sphere's square in the template of an N × N kit.
int TemplateMargin(int size);

// The margin that is recorded in the attributes of a sphere's guides; nothing if they are not from WriteSphereKit.
std::optional<int> SphereMargin(const GuideSet& guides);

// The attribute that it is recorded in.
inline constexpr const char* kMarginAttribute = "scumble:sphereMargin";

// The plain marks of the margin besides the fiducials (core/style/fiducials.h), in pixels of the template: ticks
// where the square's sides begin, and crosses in the corners of a template that is too small for fiducials. Pixels [x0,
// x1) × [y0, y1).
struct TemplateMark {
  int x0, y0, x1, y1;
  std::uint16_t grey;  // sRGB-encoded
};
std::vector<TemplateMark> PlainMarks(int size);

// The parts of the template, each of its whole size and transparent where it shows nothing: the lit sphere, opaque up
// to the last pixel of its edge, which is mixed with white paper; and the marks.
Picture DrawLitSphere(const KitLight& light);
Picture DrawMarks(int size);

// How a pixel of DrawLitSphere is printed to be painted over on paper: encoded grey, 0.82 … 1, 1 the paper.
double PaleGrey(const std::uint16_t* lit);

// The picture to paint over: white paper, the lit sphere filling the inner square, and the marks in the margin.
Picture DrawTemplate(const KitLight& light);

// Whether a picture still shows the template's marks, margin included: most of its fiducials, also of a template that
// was scaled or mirrored as a whole, or the four crosses of small templates and of those that were drawn before there
// were fiducials. Templates of spheres smaller than 63 pixels are not recognised.
bool LooksLikeTemplate(const Picture& picture);

// The template with crosses instead of fiducials, of earlier versions: a picture equal to it holds no paint.
Picture DrawTemplateWithCrosses(const KitLight& light);

}  // namespace scumble
